"""Bytes on the wire that carry each byte of a frame's parts."""

from __future__ import annotations

from collections.abc import Iterator

import msgspec

from protogen.model.frame_plan import FramePlan
from protogen.model.parts import LiteralPart
from protogen.model.transparency import Base16, Cobs, Encoding, Escape, Insertion, Substitution
from protogen.runtime import transparency as stuffing


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


def unstuff(plan: FramePlan, data: bytes) -> Wire:
    """Take the frame `data` apart into units."""
    region = plan.region
    if region is None:
        return Wire(plain(data))
    start = min(len(data), region.before)
    end = max(start, len(data) - _closing(plan, region.behind, data))
    code = data[start : min(end, start + plan.frame.code_size)].strip(b"\0")
    unstuffer = _transparency(region.encoding, region.lenient).decoder()
    units, rest, fault = _region(unstuffer, data[start:end], len(code))
    before, behind = plain(data[:start]), plain(data[end:])
    parts = [plan.frame.part(name) for name in region.parts]
    if rest or fault or len(units) < sum(part.size for part in parts if not part.is_optional):
        return Wire((*before, *units), code, rest, fault, behind)
    return Wire((*before, *units, *behind), code)


def plain(data: bytes) -> tuple[Unit, ...]:
    """Units of bytes that are not stuffed."""
    return tuple(Unit(byte, bytes((byte,))) for byte in data)


def _closing(plan: FramePlan, behind: int, data: bytes) -> int:
    """Bytes behind the region; 0 where the closing literal is missing, as the frame is cut."""
    last = plan.frame.parts[-1]
    if isinstance(last, LiteralPart) and not data.endswith(last.bytes):
        return 0
    return behind + sum(part.size for part in plan.end_literals)


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
        case Insertion(sequence=sequence, byte=byte):
            return stuffing.Insertion(sequence, byte)
        case Escape(byte=byte, of=of, xor=xor):
            return stuffing.Escape(byte, frozenset(of), xor, lenient)
        case Base16():
            return stuffing.Base16Upper(lenient)
        case Cobs():
            return stuffing.Cobs(lenient)
