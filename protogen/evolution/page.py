"""Findings as a page: fields and frames of both versions side by side, and a bench."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from itertools import count
from typing import Any

import msgspec

from protogen.evolution.compare import Comparison
from protogen.evolution.findings import SHOWN_BY_FRAMES, Finding, Verdict
from protogen.evolution.report import by_subject, place, title
from protogen.evolution.side_by_side import COLUMNS, FieldRow, frame_fields, message_fields
from protogen.evolution.witness import Witness
from protogen.model.protocol import Protocol, Sender
from protogen.model.reading.annotate import annotate
from protogen.model.reading.dissect import Row
from protogen.model.reading.readings import quoted
from protogen.targets.html.bench import comparison_script, has_codec
from protogen.targets.html.plans import plans
from protogen.targets.html.shell import data, printed

Cells = tuple[str, ...]


class Reading(msgspec.Struct, frozen=True):
    """A frame as one version reads it."""

    heading: str
    endpoint: str | None
    """The sender; None where the version has none of that name."""
    rows: tuple[tuple[Cells, bool], ...]
    """Cells, and whether the other version has no such row."""


class Shown(msgspec.Struct, frozen=True):
    """A frame in words, and both readings of it."""

    words: str
    hex: str
    readings: tuple[Reading, Reading]


class Item(msgspec.Struct, frozen=True):
    """A finding in words."""

    category: str
    rule: str
    title: str
    facts: tuple[tuple[str, str], ...]
    frames: tuple[Shown, ...]


class Subject(msgspec.Struct, frozen=True):
    """A message, or the frame, with tables of its fields and what changed in it."""

    title: str
    tables: tuple[tuple[str, tuple[FieldRow, ...]], ...]
    items: tuple[Item, ...]


class Section(msgspec.Struct, frozen=True):
    """A schema and what changed in it."""

    name: str
    note: str = ""
    subjects: tuple[Subject, ...] = ()
    comparison: Comparison | None = None
    """What the bench of the schema compares; None if it has no bench."""


_HEADS = ("byte", "wire", "name", "type", "raw", "meaning")


def page(schemas: Iterable[tuple[str, str | tuple[Comparison, Sequence[Finding]]]]) -> str:
    """The page of several schemas: of each, its name, and what changed in it or a note."""
    sections = [_section(*item) for item in schemas]
    compared = [item.comparison for item in sections if item.comparison is not None]
    numbers = count()
    numbered = [(None if item.comparison is None else next(numbers), item) for item in sections]
    script = comparison_script([(item.old, item.new) for item in compared]) if compared else None
    return printed(
        "comparison",
        script,
        sections=numbered,
        heads=_HEADS,
        columns=COLUMNS,
        versions=data([_versions(item) for item in compared]),
    )


def _versions(comparison: Comparison) -> dict[str, Any]:
    """What the bench goes by: the plans of both versions, and endpoints by both names."""
    names = {name: comparison.endpoints.get(name) for name in comparison.old.sending}
    pairs = [[name, now if now in comparison.new.sending else None] for name, now in names.items()]
    added = [[None, name] for name in comparison.new.sending if name not in names.values()]
    return {
        "plans": [plans(comparison.old), plans(comparison.new)],
        "endpoints": [*pairs, *added],
    }


def _section(name: str, changed: str | tuple[Comparison, Sequence[Finding]]) -> Section:
    if isinstance(changed, str):
        return Section(name, changed)
    comparison, found = changed
    if not found:
        return Section(name, "no change")
    subjects = tuple(_subject(comparison, *item) for item in by_subject(found))
    has_bench = has_codec(comparison.old) and has_codec(comparison.new)
    return Section(name, "", subjects, comparison if has_bench else None)


def _subject(comparison: Comparison, message: str, found: Sequence[Finding]) -> Subject:
    items = tuple(_item(comparison, item) for item in found)
    if not message:
        return Subject("frame and protocol", tuple(frame_fields(comparison)), items)
    return Subject(message, (("", message_fields(comparison, message)),), items)


def _item(comparison: Comparison, item: Finding) -> Item:
    frames = tuple(
        Shown(witness.words, witness.frame.hex(), _readings(comparison, witness))
        for witness in item.witnesses
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


def _readings(comparison: Comparison, witness: Witness) -> tuple[Reading, Reading]:
    names = comparison.endpoints
    if witness.old_sends:
        old, new = witness.sender, names.get(witness.sender, witness.sender)
    else:
        back = {new: old for old, new in names.items()}
        old, new = back.get(witness.sender, witness.sender), witness.sender
    sides = ((comparison.old, old), (comparison.new, new))
    senders = [_sender(protocol, name, witness.frame) for protocol, name in sides]
    before, after = (
        _rows(protocol, sender, witness.frame)
        for (protocol, _), sender in zip(sides, senders, strict=True)
    )
    verbs = ("sends", "reads") if witness.old_sends else ("reads", "sends")
    return (
        _reading(f"Old {verbs[0]}", senders[0], before, after),
        _reading(f"New {verbs[1]}", senders[1], after, before),
    )


def _reading(
    heading: str, sender: Sender | None, own: Sequence[Cells], other: Sequence[Cells]
) -> Reading:
    rows = tuple((cells, cells not in other) for cells in own)
    return Reading(heading, None if sender is None else sender.endpoint, rows)


def _rows(protocol: Protocol, sender: Sender | None, frame: bytes) -> list[Cells]:
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
