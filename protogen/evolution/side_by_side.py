"""Frames of two versions of a message, field by field, side by side."""

from __future__ import annotations

from collections.abc import Iterator
from difflib import SequenceMatcher

import msgspec
from markupsafe import Markup

from protogen.evolution.compare import Comparison
from protogen.model.messages import Message
from protogen.model.protocol import Protocol
from protogen.targets.emitted import emitted_names
from protogen.targets.html.reference import inline
from protogen.targets.markdown.fields.rows import message_table
from protogen.targets.markdown.fields.values import Anchors
from protogen.targets.markdown.pages.context import Context

COLUMNS = ("Frame byte", "Size", "Type", "Unit", "Range")
"""Columns of the reference that each version has here."""

Cells = tuple[Markup, ...]


class FieldRow(msgspec.Struct, frozen=True):
    """A field or a part of the frame in both versions."""

    name: Markup
    old: Cells | None
    """None where the version does not have it."""
    new: Cells | None

    @property
    def mark(self) -> str:
        """What changed, in a word."""
        if self.old is None:
            return "added"
        if self.new is None:
            return "removed"
        return "" if self.old == self.new else "changed"


def message_fields(comparison: Comparison, name: str) -> tuple[FieldRow, ...]:
    """The rows of a message, which is named as in OLD where it is there, and else as in NEW."""
    old = _message(comparison.old, name)
    new = _message(comparison.new, name if old is None else comparison.messages.get(name))
    return tuple(_aligned(comparison, old, new))


def frame_fields(comparison: Comparison) -> Iterator[tuple[str, tuple[FieldRow, ...]]]:
    """The frames that changed, each by the first message that both versions have in it."""
    seen = []
    for sender in comparison.old.senders:
        names = [item.name for item in sender.messages if item.name in comparison.messages]
        if not names or sender.frame in seen:
            continue
        seen.append(sender.frame)
        rows = message_fields(comparison, names[0])
        if any(row.mark for row in rows):
            yield f"Frames of {sender.name}: {names[0]}", rows


def _message(protocol: Protocol, name: str | None) -> Message | None:
    return next((item for item in protocol.messages if item.name == name), None)


def _aligned(
    comparison: Comparison, old: Message | None, new: Message | None
) -> Iterator[FieldRow]:
    """The rows in wire order; what both have under one name, or a new name, shares a row."""
    before = [] if old is None else _rows(comparison.old, old)
    after = [] if new is None else _rows(comparison.new, new)
    keys = [_renamed(comparison, old, name) for name, _ in before]
    matcher = SequenceMatcher(None, keys, [name for name, _ in after], autojunk=False)
    for kind, first, end, other, other_end in matcher.get_opcodes():
        if kind == "equal":
            for (name, cells), (now, own) in zip(
                before[first:end], after[other:other_end], strict=True
            ):
                shown = name if name == now else f"{name}, now {now}"
                yield FieldRow(inline(shown), cells, own)
            continue
        for name, cells in before[first:end]:
            yield FieldRow(inline(name), cells, None)
        for name, cells in after[other:other_end]:
            yield FieldRow(inline(name), None, cells)


def _rows(protocol: Protocol, message: Message) -> list[tuple[str, Cells]]:
    """Names and cells of all that is in a message's frame."""
    frame = protocol.senders_of(message)[0].frame
    anchors = Anchors("", Context.of(protocol).shared)
    found = message_table(frame, message, anchors, emitted_names(protocol))
    rows = []
    for cells in found.rows:
        by_head = dict(zip(found.header, cells, strict=True))
        rows.append((by_head["Name"], tuple(inline(by_head.get(head, "")) for head in COLUMNS)))
    return rows


def _renamed(comparison: Comparison, message: Message | None, name: str) -> str:
    """The name of a field or of a part of the frame as NEW has it."""
    for change in comparison.changes:
        pairs = [(change.old_part, change.new_part)]
        if message is not None and change.message == message.name:
            pairs.append((change.path, change.now))
        for before, now in pairs:
            if before and now and name.startswith((f"`{before}`", f"`{before}.", f"`{before}[")):
                return f"`{now}{name[len(before) + 1 :]}"
    return name
