"""Findings as a page: each witness as both versions read it, side by side."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import msgspec

from protogen.evolution.compare import Comparison
from protogen.evolution.findings import SHOWN_BY_FRAMES, Finding, Verdict
from protogen.evolution.report import by_subject, place, title
from protogen.evolution.witness import Witness
from protogen.model.protocol import Protocol, Sender
from protogen.model.reading.annotate import annotate
from protogen.model.reading.dissect import Row
from protogen.model.reading.readings import quoted

Cells = tuple[str, ...]


class Reading(msgspec.Struct, frozen=True):
    """A frame as one version reads it."""

    heading: str
    rows: tuple[tuple[Cells, bool], ...]
    """Cells, and whether the other version has no such row."""


class Shown(msgspec.Struct, frozen=True):
    """A frame in words, and both readings of it."""

    words: str
    readings: tuple[Reading, ...]


class Item(msgspec.Struct, frozen=True):
    """A finding in words."""

    category: str
    rule: str
    title: str
    facts: tuple[tuple[str, str], ...]
    frames: tuple[Shown, ...]


class Section(msgspec.Struct, frozen=True):
    """A schema and what changed in it."""

    name: str
    note: str = ""
    subjects: tuple[tuple[str, tuple[Item, ...]], ...] = ()


def page(sections: Sequence[Section]) -> str:
    """The page of several schemas."""
    from protogen.targets.html.shell import printed

    return printed("comparison", sections=sections, heads=_HEADS)


_HEADS = ("byte", "wire", "name", "type", "raw", "meaning")


def section(name: str, comparison: Comparison, found: Sequence[Finding]) -> Section:
    """What changed in a schema."""
    subjects = tuple(
        (subject or "frame and protocol", tuple(_item(comparison, item) for item in items))
        for subject, items in by_subject(found)
    )
    return Section(name, "" if found else "no change", subjects)


def _item(comparison: Comparison, item: Finding) -> Item:
    frames = tuple(
        Shown(witness.words, tuple(_readings(comparison, witness))) for witness in item.witnesses
    )
    facts = tuple(_facts(comparison, item))
    return Item(item.category.value, item.rule.name, title(item), facts, frames)


def _facts(comparison: Comparison, item: Finding) -> Iterator[tuple[str, str]]:
    where = place(comparison, item)
    if where:
        yield "At", where
    if item.category in SHOWN_BY_FRAMES:
        yield "Affects", f"{item.affected}: {item.harm}"
    if item.verdict is not Verdict.PROVED:
        yield "Proof", f"{item.verdict}: no frame was found that shows it: no proof"
    if item.category.value != "NONE":
        yield "Fix", item.rule.fix


# --- both readings --------------------------------------------------------------------------------


def _readings(comparison: Comparison, witness: Witness) -> Iterator[Reading]:
    names = comparison.endpoints
    if witness.old_sends:
        old, new = witness.sender, names.get(witness.sender, witness.sender)
    else:
        back = {new: old for old, new in names.items()}
        old, new = back.get(witness.sender, witness.sender), witness.sender
    sides = (("Old", comparison.old, old), ("New", comparison.new, new))
    read = [_rows(protocol, name, witness.frame) for _, protocol, name in sides]
    for (word, *_), own, other in zip(sides, read, reversed(read), strict=True):
        heading = f"{word} {'sends' if (word == 'Old') is witness.old_sends else 'reads'}"
        yield Reading(heading, tuple((cells, cells not in other) for cells in own))


def _rows(protocol: Protocol, endpoint: str, frame: bytes) -> list[Cells]:
    sender = _sender(protocol, endpoint, frame)
    return [] if sender is None else [*map(_cells, annotate(protocol, sender.name, frame))]


def _sender(protocol: Protocol, endpoint: str, frame: bytes) -> Sender | None:
    """The sender of a frame, in the form that begins so; None if there is no such endpoint."""
    forms = [item for item in protocol.senders if endpoint in (item.name, item.endpoint)]
    begun = (item for item in forms if frame.startswith(item.plan.start_bytes))
    return next(begun, next(iter(forms), None))


def _cells(row: Row) -> Cells:
    value = row.value
    shown = quoted(value) if isinstance(value, str) else "" if value is None else str(value)
    meaning = f"{row.meaning} ! {row.fault}".strip() if row.fault else row.meaning
    wire = row.bits or row.wire.hex(" ").upper()
    return str(row.offset), wire, row.path, row.type, shown, meaning
