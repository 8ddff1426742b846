"""Bytes on the wire that carry each byte of a frame's parts."""

from __future__ import annotations

from collections.abc import Iterator

import msgspec

from protogen.model.frame import (
    Base16,
    Cobs,
    Encoding,
    Escape,
    Frame,
    LiteralPart,
    Part,
    Substitution,
)
from protogen.runtime import transparency as stuffing

FULL_GROUP = 254
"""Bytes that one code byte of COBS can stand for."""


class Unit(msgspec.Struct, frozen=True):
    """One byte of a part, and the bytes on the wire that carry it."""

    byte: int
    wire: bytes


class Wire(msgspec.Struct, frozen=True):
    """A frame's bytes, unstuffed as far as that is possible."""

    units: tuple[Unit, ...]
    code: bytes = b""
    """Bytes that the encoding puts in front of its region: the first code byte of COBS."""
    rest: bytes = b""
    """Bytes behind the units that stand for no byte."""
    fault: str = ""
    """Reason that the rest could not be unstuffed."""
    behind: tuple[Unit, ...] = ()
    """Units that follow that."""


def code_size(frame: Frame) -> int:
    """Bytes that the encoding puts in front of its region, whatever that holds.

    COBS puts its first code byte there. The others stand in the places of zeros, except that a
    further one stands behind each `FULL_GROUP` bytes without a zero.
    """
    return int(frame.transparency is not None and isinstance(frame.transparency.encoding, Cobs))


def unstuff(frame: Frame, data: bytes) -> Wire:
    """Take the frame `data` apart into units."""
    if frame.transparency is None:
        return Wire(_plain(data))
    names = [part.name for part in frame.parts]
    first, last = names.index(frame.transparency.first), names.index(frame.transparency.last)
    start = min(len(data), sum(part.size for part in frame.parts[:first]))
    end = max(start, len(data) - _closing(frame, frame.parts[last + 1 :], data))
    unstuffer = _transparency(frame.transparency.encoding, frame.transparency.lenient).decoder()
    code = data[start : min(end, start + code_size(frame))].strip(b"\0")
    units, rest, fault = _region(unstuffer, data[start:end], len(code))
    before, behind = _plain(data[:start]), _plain(data[end:])
    if rest or fault or len(units) < _least(frame.parts[first : last + 1]):
        return Wire((*before, *units), code, rest, fault, behind)
    return Wire((*before, *units, *behind), code)


def _plain(data: bytes) -> tuple[Unit, ...]:
    return tuple(Unit(byte, bytes((byte,))) for byte in data)


def _least(parts: tuple[Part, ...]) -> int:
    """Bytes that parts have even with an empty payload."""
    present = (part for part in parts if not part.is_optional)
    return sum(part.size for part in present)


def _closing(frame: Frame, parts: tuple[Part, ...], data: bytes) -> int:
    """Bytes behind the region; 0 where the closing literal is missing, as the frame is cut."""
    last = frame.parts[-1]
    if isinstance(last, LiteralPart) and not data.endswith(last.bytes):
        return 0
    return sum(part.size for part in parts)


def _region(
    unstuffer: stuffing.Unstuffer, region: bytes, code: int
) -> tuple[tuple[Unit, ...], bytes, str]:
    """Return the units of a region, the bytes behind them that are none, and what is wrong.

    The first `code` bytes belong to no unit.
    """
    units: list[Unit] = []
    done = code
    fault = ""
    try:
        for end, byte in enumerate(region, start=1):
            released = unstuffer.push(byte)
            if released:
                units += _units(released, region[done:end])
                done = end
        units += _units(unstuffer.finish(), region[done:])
    except stuffing.TransparencyError as error:
        fault = str(error)
    carried = code + sum(len(unit.wire) for unit in units)
    return tuple(units), region[carried:], fault


def _units(released: bytes, held: bytes) -> Iterator[Unit]:
    """Share the wire bytes that were held among the bytes that they turned out to be."""
    for index, byte in enumerate(released):
        last = index == len(released) - 1
        yield Unit(byte, held[index:] if last else held[index : index + 1])


def _transparency(encoding: Encoding, lenient: bool) -> stuffing.Transparency:
    match encoding:
        case Substitution(table=table):
            return stuffing.Substitution(dict(table), lenient)
        case Escape(byte=byte, of=of, xor=xor):
            return stuffing.Escape(byte, frozenset(of), xor, lenient)
        case Base16():
            return stuffing.Base16Upper(lenient)
        case Cobs():
            return stuffing.Cobs(lenient)
