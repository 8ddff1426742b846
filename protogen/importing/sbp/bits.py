"""Bits and values of an integer -> `values`, `flags` or `bits` of a schema."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator
from typing import Any

from protogen.importing.names import label, says_all, unique
from protogen.importing.remarks import Kind
from protogen.importing.sbp.spec import BitRange, Value
from protogen.importing.schema_text import Number, paragraphs
from protogen.problems.span import Span

Report = Callable[[Kind, str, Span], None]
"""Takes a remark on the field: what became of it, why, and where that stands."""

_RESERVED = ("reserved", "unused")


def meaning(
    ranges: Iterable[BitRange], width: int, report: Report, *, is_signed: bool = False
) -> dict[str, Any]:
    """Return what a schema says of an integer of `width` bits whose bits are described."""
    described = (item for item in ranges if not _is_reserved(item.desc) or item.values)
    named = list(_apart(described, width, report))
    bounds = range(-(1 << width - 1), 1 << width - 1) if is_signed else range(1 << width)
    if len(named) == 1 and _is_whole(named[0], width, bounds, report):
        values = _values(named[0].values, bounds, report)
        return {"values": values} if values else {}
    if named and is_signed:
        report(Kind.LEFT_OUT, "bits of a signed integer", named[0].span)
    if not named or is_signed:
        return {}
    if all(item.low == item.high and not item.values for item in named):
        return {"flags": _flags(named)}
    return {"bits": _bits(named, report)}


def _apart(ranges: Iterable[BitRange], width: int, report: Report) -> Iterator[BitRange]:
    """Yield the ranges in order of their bits, but none outside of the integer, or twice."""
    end = 0
    for item in sorted(ranges, key=lambda item: (item.low, item.high)):
        if item.high >= width:
            report(Kind.LEFT_OUT, f"{_of(item)} of an integer of {width}", item.span)
        elif item.low < end:
            report(Kind.LEFT_OUT, f"{_of(item)}, as others lie there too", item.span)
        else:
            end = item.high + 1
            yield item


def _of(item: BitRange) -> str:
    return f"bit {item.low}" if item.low == item.high else f"bits {item.low} to {item.high}"


def _is_reserved(text: str) -> bool:
    return text.lower().startswith(_RESERVED)


def _is_whole(item: BitRange, width: int, bounds: range, report: Report) -> bool:
    """True if a range is all of an integer, or its values need more bits than it has."""
    if item.low > 0:
        return False
    if item.high == width - 1:
        return True
    greatest = max((value.number for value in item.values), default=0)
    if greatest < 1 << (item.high + 1) or greatest not in bounds:
        return False
    reason = f"{_of(item)} can't hold {greatest}, so the values are those of the whole integer"
    report(Kind.CHANGED, reason, item.span)
    return True


def _values(values: Iterable[Value], bounds: range, report: Report) -> dict[str, Any]:
    """Return the names of values, without those that are reserved or do not fit."""
    named: dict[str, Any] = {}
    numbers: set[int] = set()
    for value in values:
        text = paragraphs(value.text)
        if _is_reserved(text):
            continue
        if value.number not in bounds:
            report(Kind.LEFT_OUT, f"the value {value.number} does not fit", value.span)
        elif value.number in numbers:
            report(Kind.LEFT_OUT, f"the value {value.number} has a meaning already", value.span)
        else:
            numbers.add(value.number)
            name = unique(label(text), named, str(abs(value.number)))
            named[name] = _explained("value", value.number, name, text)
    return named


def _flags(ranges: Iterable[BitRange]) -> dict[str, Any]:
    named: dict[str, Any] = {}
    for item in ranges:
        text = paragraphs(item.desc)
        name = unique(label(text), named, str(item.low))
        named[name] = _explained("bit", item.low, name, text)
    return named


def _bits(ranges: Iterable[BitRange], report: Report) -> dict[str, Any]:
    named: dict[str, Any] = {}
    for item in ranges:
        text = paragraphs(item.desc)
        bits = _of(item).replace(" to ", "_").replace(" ", "_")
        name = unique(label(text) if text else bits, named, str(item.low))
        place = Number(str(item.low) if item.low == item.high else f"{item.low}..{item.high}")
        values = _values(item.values, range(1 << item.high - item.low + 1), report)
        entry: dict[str, Any] = {"bits": place}
        entry |= {"values": values} if values else {}
        entry |= {"doc": text} if text and not says_all(name, text) else {}
        named[name] = entry if len(entry) > 1 else place
    return named


def _explained(key: str, number: int, name: str, text: str) -> Any:
    """Return a number, with the words that its name lacks."""
    return number if says_all(name, text) else {key: number, "doc": text}
