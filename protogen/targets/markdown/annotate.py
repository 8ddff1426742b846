"""The bytes of an example, cut into parts and fields, each with its value and meaning."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence

from protogen.model.frame import (
    ChecksumPart,
    Frame,
    IdentityPart,
    LiteralPart,
    NumberPart,
    Part,
    PayloadPart,
)
from protogen.model.messages import Example, Message
from protogen.model.sizes import SizeSet
from protogen.runtime.errors import ByteError
from protogen.runtime.transparency import TransparencyError
from protogen.targets.markdown.cuts import Cut, integer_of_bytes, payload_cuts
from protogen.targets.markdown.layout import part_sizes
from protogen.targets.markdown.parts import identity_value, role
from protogen.targets.markdown.table import Table, table
from protogen.targets.markdown.unstuff import Unit, frame_units, plain
from protogen.targets.markdown.words import code, hex_bytes, hex_number, span

_HEADER = ("Byte", "Bytes", "Decoded", "Name", "Value", "Meaning")
_MOST_BYTES = 16
"""Bytes of one row that are printed."""


def annotated(frame: Frame, message: Message, example: Example) -> Table | None:
    """Return the table of an example's bytes; None if they can't be cut into the frame's parts."""
    try:
        units, parts = _parts_of(frame, example)
        sizes = _sizes(parts, len(units))
        cuts = [] if sizes is None else [*_part_cuts(parts, sizes, units, message)]
    except (TransparencyError, ByteError):
        return None
    return table(_HEADER, _cells(cuts)) if cuts else None


def _parts_of(frame: Frame, example: Example) -> tuple[list[Unit], list[Part]]:
    """Return an example's bytes, and the parts that they hold."""
    if example.covers is None:
        return frame_units(frame, example.bytes), list(frame.parts)
    return plain(example.bytes), [part for part in frame.parts if part.name in example.covers]


def _sizes(parts: Sequence[Part], total: int) -> list[int] | None:
    """Return the size of each part in a frame of `total` bytes; None if there are too few."""
    for payload in (SizeSet.exactly(0), SizeSet.exactly(1)):
        sizes = [part_sizes(part, payload).least for part in parts]
        spare = total - sum(sizes)
        index = next((i for i, part in enumerate(parts) if isinstance(part, PayloadPart)), None)
        if spare == 0:
            return sizes
        if payload.least and index is not None and spare > 0:
            sizes[index] += spare
            return sizes
    return None


def _cells(cuts: Iterable[Cut]) -> Iterator[tuple[str, ...]]:
    position = 0
    for cut in cuts:
        wire, data = cut.wire, cut.data
        unstuffed = "" if wire == data else _bytes_text(data)
        yield (
            span(position, len(wire)),
            _bytes_text(wire),
            unstuffed,
            cut.name,
            cut.value,
            cut.meaning,
        )
        position += len(wire)


def _bytes_text(data: bytes) -> str:
    if len(data) <= _MOST_BYTES:
        return code(hex_bytes(data))
    return f"{code(hex_bytes(data[: _MOST_BYTES - 4]))} ... {code(hex_bytes(data[-2:]))}"


def _part_cuts(
    parts: Sequence[Part], sizes: Sequence[int], units: Sequence[Unit], message: Message
) -> Iterator[Cut]:
    start = 0
    for part, size in zip(parts, sizes, strict=True):
        held = units[start : start + size]
        start += size
        if isinstance(part, PayloadPart):
            yield from payload_cuts(message.fields, held)
        elif held:
            yield _part_cut(part, held, message)


def _part_cut(part: Part, units: Sequence[Unit], message: Message) -> Cut:
    cut = Cut(units, code(part.name))
    if isinstance(part, LiteralPart):
        return Cut(units, cut.name, "", role(part))
    assert isinstance(part, NumberPart | ChecksumPart)
    value = integer_of_bytes(part.type, cut.data)
    if isinstance(part, IdentityPart):
        return Cut(units, cut.name, identity_value(part, value), f"`{message.name}`")
    if isinstance(part, ChecksumPart):
        return Cut(units, cut.name, code(hex_number(value, part.type.bits)), role(part))
    return Cut(units, cut.name, code(value), role(part))
