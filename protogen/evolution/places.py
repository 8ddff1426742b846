"""Places of changes in the schemas: the line of the field, the value or the part."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import NamedTuple

from protogen.copying import replace
from protogen.evolution.change import Change
from protogen.evolution.compare import Comparison
from protogen.model.messages import Message
from protogen.model.nesting import fields_inside
from protogen.model.origin import About
from protogen.model.protocol import Protocol
from protogen.model.types import Array, Field, is_integer
from protogen.problems.span import Span


class Places(NamedTuple):
    """The places of a change; None where a version does not have it."""

    old: Span | None
    new: Span | None


def places_of(comparison: Comparison, change: Change) -> Places:
    """Places of the change in OLD and in NEW: as close to what changed as there is a place."""
    old = _place(comparison.old, change, change.message, change.path, 0)
    renamed = comparison.messages.get(change.message or "", change.message)
    path = _translated(comparison, change)
    new = _place(comparison.new, _now(comparison, change), renamed, path, 1)
    return Places(_written(old), _written(new))


def _written(span: Span | None) -> Span | None:
    """The span, unless it is one of a lock, which knows of none."""
    return span if span is not None and span.file else None


def _now(comparison: Comparison, change: Change) -> Change:
    """The change with the names of NEW for the sender and the part."""
    sender = comparison.endpoints.get(change.sender or "", change.sender)
    return replace(change, sender=sender, part=change.new_part or change.part)


def _translated(comparison: Comparison, change: Change) -> str | None:
    """The path in NEW; what leads to it may have other names there."""
    if change.path is None or change.now is not None:
        return change.now
    renamed = {
        item.path: item.now
        for item in comparison.changes
        if item.message == change.message and item.now is not None
    }
    steps = change.path.split(".")
    for count in range(len(steps), 0, -1):
        now = renamed.get(".".join(steps[:count]))
        if now is not None:
            return ".".join([now, *steps[count:]])
    return change.path


def _place(
    protocol: Protocol, change: Change, name: str | None, path: str | None, side: int
) -> Span | None:
    if name is None:
        return _part(protocol, change)
    message = next((item for item in protocol.messages if item.name == name), None)
    if message is None:
        return None
    found = list(_abouts(message, path, change, side))
    spans = [item.span for item in found if item.span is not None]
    return spans[-1] if spans else message.span


def _part(protocol: Protocol, change: Change) -> Span | None:
    sender = next((item for item in protocol.senders if item.name == change.sender), None)
    if sender is None:
        return None
    frame = sender.frame
    every = (*frame.parts, *frame.numbers, *frame.mirrors, *frame.checksums)
    parts = [item.about for item in every if item.name == change.part]
    if change.part == "transparency" and sender.frame.transparency is not None:
        parts.append(sender.frame.transparency.about)
    return parts[0].span if parts else None


# --- inside of a message --------------------------------------------------------------------------


def _abouts(message: Message, path: str | None, change: Change, side: int) -> Iterator[About]:
    """Texts about the things that lead to the change, from the outside in."""
    fields: Sequence[Field] = message.fields
    found: Field | None = None
    for step in path.split(".") if path is not None else ():
        found = next((field for field in fields if field.name == step), None)
        if found is None:
            return
        yield found.about
        fields = list(fields_inside(found.type))
    name = change.names[side]
    if found is not None:
        yield from _named(found, change.run, name)


def _named(field: Field, run: str | None, name: str | None) -> Iterator[About]:
    """A run of bits of the field, and a value or a flag."""
    yield from (item.about for item in field.special if item.name == name)
    kind = field.type.element if isinstance(field.type, Array) else field.type
    if not is_integer(kind):
        return
    enum = kind.enum
    for bits in kind.bit_fields:
        if bits.name == run:
            yield bits.about
            enum = bits.enum
    if enum is not None:
        yield from (item.about for item in enum.values if item.name == name)
    if kind.flags is not None:
        yield from (item.about for item in kind.flags.bits if item.name == name)
