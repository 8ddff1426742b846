"""The bytes of an example, each with the bytes on the wire that stand for it.

The runtime's own decoders take the transparency off, so that there is no second one.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

from protogen.model.frame import Base16, Cobs, Escape, Frame, LiteralPart, Part, Transparency
from protogen.model.frame import Substitution as ModelSubstitution
from protogen.runtime import transparency as runtime


@dataclass(frozen=True, slots=True)
class Unit:
    """One byte, and what stands for it on the wire (nothing, where an escape gave several)."""

    wire: bytes
    byte: int


def plain(data: bytes) -> list[Unit]:
    """Return the units of bytes that are not stuffed."""
    return [Unit(bytes([byte]), byte) for byte in data]


def frame_units(frame: Frame, data: bytes) -> list[Unit]:
    """Take the transparency off a frame.

    Raises TransparencyError if the frame is not what the transparency makes.
    """
    transparency = frame.transparency
    if transparency is None:
        return plain(data)
    names = [part.name for part in frame.parts]
    first, last = names.index(transparency.first), names.index(transparency.last)
    start = _raw_size(frame.parts[:first])
    end = len(data) - _raw_size(frame.parts[last + 1 :])
    region = _region_units(_decoder(transparency), data[start:end])
    return [*plain(data[:start]), *region, *plain(data[max(start, end) :])]


def _raw_size(parts: tuple[Part, ...]) -> int:
    return sum(len(part.bytes) for part in parts if isinstance(part, LiteralPart))


def _region_units(decoder: runtime.Unstuffer, region: bytes) -> Iterator[Unit]:
    wire = b""
    for byte in region:
        wire += bytes([byte])
        released = decoder.push(byte)
        yield from _units(wire, released)
        wire = b"" if released else wire
    yield from _units(wire, decoder.finish())


def _units(wire: bytes, released: bytes) -> Iterator[Unit]:
    for index, byte in enumerate(released):
        yield Unit(wire if index == 0 else b"", byte)


def _decoder(transparency: Transparency) -> runtime.Unstuffer:
    lenient = transparency.lenient
    match transparency.encoding:
        case ModelSubstitution(table=table):
            return runtime.Substitution(dict(table), lenient).decoder()
        case Escape(byte=byte, of=of, xor=xor):
            return runtime.Escape(byte, frozenset(of), xor, lenient).decoder()
        case Base16():
            return runtime.Base16Upper(lenient).decoder()
        case Cobs():
            return runtime.Cobs(lenient).decoder()
