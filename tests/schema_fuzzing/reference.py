"""The bytes of messages and frames, worked out a second time and as plainly as possible.

Slow, without checks, and only from values to bytes: just enough to compare the generated codecs
with something that shares no code with them.
"""

from __future__ import annotations

import struct
from collections.abc import Iterable, Iterator, Mapping, Sequence
from typing import Any

from bit_runs import bits_of_number, bytes_of, number_of
from expression_oracle import worked_out

from protogen.model.checksums import ChecksumSpec
from protogen.model.frame import Frame
from protogen.model.messages import Message
from protogen.model.parts import (
    BitsPart,
    ChecksumPart,
    LengthPart,
    LiteralPart,
    NumberPart,
    Part,
    PayloadPart,
    VirtualPart,
)
from protogen.model.transparency import Base16, Cobs, Encoding, Escape, Insertion, Substitution
from protogen.model.types import (
    Array,
    Between,
    Extent,
    Field,
    Fixed,
    Float,
    Integer,
    Octets,
    Struct,
    Switch,
    Text,
    Type,
    Until,
)

Scope = Mapping[str, Any]


def payload_bytes(fields: Sequence[Field], values: Mapping[str, Any], outer: Scope) -> bytes:
    """The bytes of fields, whose values are as `to_dict` shows them."""
    scope = dict(outer)
    found = b""
    for field in fields:
        is_there = field.when is None or worked_out(field.when, scope)
        if is_there and not (field.optional and values[field.name] is None):
            found += b"" if field.part else value_bytes(field.type, values[field.name], scope)
        scope[field.name] = values[field.name]
    return found


def value_bytes(type_: Type, value: Any, scope: Scope) -> bytes:
    """The bytes of a value."""
    match type_:
        case Integer():
            return number_bytes(type_, int(value))
        case Float():
            return _float_bytes(type_, value)
        case Text():
            return _ended(type_.extent, _text_bytes(type_, value))
        case Octets():
            return _ended(type_.extent, bytes.fromhex(value))
        case Struct(packed=str(order)) | Array(packed=str(order)):
            return bytes_of(_bits(type_, value, order), order)
        case Struct():
            return payload_bytes(type_.fields, value or {}, scope)
        case Array():
            return b"".join(value_bytes(type_.element, element, scope) for element in value)
    return _switch_bytes(type_, value, scope)


def _text_bytes(type_: Text, value: str) -> bytes:
    if not isinstance(type_.extent, Fixed):
        return value.encode("latin-1")
    text, form = value.ljust(type_.extent.count, chr(type_.form.padding)), type_.form
    return bytes((ord(character) << form.shift) + form.add for character in text)


def _ended(extent: Extent, data: bytes) -> bytes:
    """Bytes with what fills them up, ends them, or stands in front."""
    match extent:
        case Fixed():
            return data.ljust(extent.count, b"\0")
        case Until():
            return data + bytes([extent.byte])
        case Between(leads=True):
            return bytes([extent.separator]) + data
    return data


def _bits(type_: Type, value: Any, order: str) -> list[int]:
    """The bits of a packed number, or of several."""
    if isinstance(type_, Struct):
        each = (_bits(field.type, value[field.name], order) for field in type_.fields)
        return [bit for bits in each for bit in bits]
    if isinstance(type_, Array):
        return [bit for item in value for bit in _bits(type_.element, item, order)]
    assert isinstance(type_, Integer)
    return bits_of_number(int(value), type_.bits, order)


def _switch_bytes(type_: Switch, value: Any, scope: Scope) -> bytes:
    for case in type_.cases:
        if case.value in (worked_out(type_.selector, scope), None):  # That of all others is last.
            return value_bytes(case.type, value, scope)
    return bytes.fromhex(value)


def number_bytes(type_: Integer, value: int) -> bytes:
    """A number in groups of 7 or 8 bits, or as digits."""
    if type_.is_free:
        return _free_bytes(type_, value)
    if type_.text is not None:
        return _digits(value % (1 << type_.bits), type_.text.size, type_.text.alphabet)
    return _grouped(value % (1 << type_.bits), type_.size, type_.byte_bits, type_.byte_order)


def _free_bytes(type_: Integer, value: int) -> bytes:
    """A number with all digits behind its point, and no needless zeros in front of the others.

    The separator stands in front; nothing follows it where the value is the one that is absent.
    """
    form = type_.text
    front = bytes([form.separator]) if form.leads else b""
    if form.empty and value == form.absent:
        return front
    return front + _characters(type_, value)


def _characters(type_: Integer, value: int) -> bytes:
    form = type_.text
    if form.base == 256:
        return bytes([value])
    if form.base == 16:
        text = f"{value:x}".rjust(form.padded, "0")
        return (text.upper() if form.upper else text).encode()
    whole, part = divmod(abs(value), 10**form.fraction)
    behind = f".{str(part).rjust(form.fraction, '0')}" if form.fraction else ""
    sign = "-" if value < 0 else ""
    return f"{sign}{str(whole).rjust(form.padded, '0')}{behind}".encode()


def _digits(raw: int, size: int, alphabet: bytes) -> bytes:
    if alphabet == b"0123456789":
        return f"{raw:0{size}d}".encode()
    if alphabet in (b"0123456789ABCDEF", b"0123456789abcdef"):
        form = "X" if b"A" in alphabet else "x"
        return f"{raw:0{size}{form}}".encode()
    bits = len(alphabet).bit_length() - 1
    return bytes(
        number_of(group, "msb_first") + alphabet[0]
        for group in batched(bits_of_number(raw, size * bits, "msb_first"), bits)
    )


def batched(items: Sequence[int], size: int) -> Iterable[Sequence[int]]:
    return (items[start : start + size] for start in range(0, len(items), size))


def _float_bytes(type_: Float, value: float | str) -> bytes:
    code = ">f" if type_.bits == 32 else ">d"
    raw = int.from_bytes(struct.pack(code, float(value)), "big")
    return _grouped(raw, type_.size, type_.byte_bits, type_.byte_order)


def _grouped(raw: int, size: int, bits: int, order: str) -> bytes:
    groups = [(raw >> (bits * index)) % (1 << bits) for index in range(size)]
    return bytes(groups if order == "little" else reversed(groups))


# --- frames -------------------------------------------------------------------------------------


def frame_bytes(
    frame: Frame, message: Message, payload: bytes, given: Mapping[str, int | str]
) -> bytes:
    """The frame of a payload; `given` holds all counters and values."""
    return _Assembly(frame, message, payload, given).wire()


class _Assembly:
    """One frame."""

    def __init__(
        self, frame: Frame, message: Message, payload: bytes, given: Mapping[str, int | str]
    ) -> None:
        self._frame = frame
        kept = frame.payload.kept
        while kept is not None and payload[kept:].endswith(b"\0"):
            payload = payload[:-1]
        self._payload = payload
        self._message = message
        names = [part.name for part in frame.identity]
        self._numbers = {**dict(zip(names, message.identity, strict=True)), **given}

    def wire(self) -> bytes:
        return self._wire(part.name for part in self._present())

    def _present(self) -> list[Part]:
        optional = [part for part in self._frame.checksums if part.when_payload]
        return [part for part in self._frame.parts if self._payload or part not in optional]

    def _wire(self, names: Iterable[str]) -> bytes:
        """Parts as they stand on the wire; all under transparency are encoded together."""
        covered = self._covered()
        wanted = set(names)
        found, region, is_inside = b"", b"", False
        for part in self._frame.parts:
            inside = part.name in covered
            if is_inside and not inside:
                found += self._encoded(region)
            is_inside = inside
            if part not in self._present() or part.name not in wanted:
                continue
            content = self._content(part)
            region += content if inside else b""
            found += b"" if inside else content
        return found + (self._encoded(region) if is_inside else b"")

    def _encoded(self, region: bytes) -> bytes:
        transparency = self._frame.transparency
        assert transparency is not None
        return encoded(transparency.encoding, region)

    def _covered(self) -> set[str]:
        transparency = self._frame.transparency
        if transparency is None:
            return set()
        names = [part.name for part in self._frame.parts]
        return set(names[names.index(transparency.first) : names.index(transparency.last) + 1])

    def _content(self, part: Part) -> bytes:
        match part:
            case LiteralPart():
                return part.bytes
            case PayloadPart():
                return self._payload
            case ChecksumPart():
                return number_bytes(part.type, self._checksum(part))
            case LengthPart():
                return number_bytes(part.type, self._length(part))
            case BitsPart():
                return number_bytes(part.type, self._joined(part))
            case NumberPart():
                value = self._numbers[part.name]
                if isinstance(value, str):
                    return value.encode("latin-1").ljust(part.type.size, b"\0")
                return number_bytes(part.type, value)
        raise AssertionError(part)

    def _joined(self, part: BitsPart) -> int:
        """The number of some bits, each multiplied to its place."""
        total = part.fixed
        for member in part.members:
            assert member.type.within is not None
            total += self._number(member) * 2**member.type.within.low
        for mirror in part.mirrors:
            assert mirror.type.within is not None
            value = self._number(mirror.of)
            value = 2**mirror.type.bits - 1 - value if mirror.inverted else value
            total += value * 2**mirror.type.within.low
        for part_sum in part.sums:
            assert part_sum.type.within is not None
            taken = self._checksum(part_sum) // 2**part_sum.lowest % 2**part_sum.type.bits
            total += taken * 2**part_sum.type.within.low
        return total

    def _number(self, part: NumberPart) -> int:
        is_length = isinstance(part, LengthPart)
        return self._length(part) if is_length else int(self._numbers[part.name])

    def _length(self, part: LengthPart) -> int:
        """Bytes that it counts; on the wire, of which all that is stuffed is counted."""
        stuffed = self._covered() if part.over_wire else set()
        counted = [other for other in self._present() if other.name in part.counts]
        region = b"".join(self._content(other) for other in counted if other.name in stuffed)
        plain = sum(self._size(other) for other in counted if other.name not in stuffed)
        return plain + (len(self._encoded(region)) if part.over_wire else 0)

    def _size(self, part: Part) -> int:
        match part:
            case LiteralPart():
                return len(part.bytes)
            case PayloadPart():
                return len(self._payload)
            case NumberPart() | ChecksumPart() | BitsPart():
                return part.type.size
        raise AssertionError(part)

    def _checksum(self, part: ChecksumPart) -> int:
        if self._frame.virtual:
            return checksum(part.algorithm, b"".join(self._pieces(part)))
        covered = [other for other in self._present() if other.name in part.covers]
        if not part.over_wire:
            return checksum(part.algorithm, b"".join(map(self._content, covered)))
        names = {other.name for other in covered}
        return checksum(part.algorithm, self._wire_of_some(names))

    def _pieces(self, part: ChecksumPart) -> Iterator[bytes]:
        """What is covered one by one, in the order of the schema, and what is not sent as it is."""
        for other in self._frame.declared:
            if other.name not in part.covers:
                continue
            if isinstance(other, VirtualPart):
                value = dict(self._message.virtual).get(other.name, other.default)
                assert value is not None
                yield number_bytes(other.type, value)
            elif other in self._present():
                inside = part.over_wire and other.name in self._covered()
                yield self._wire_of_some({other.name}) if inside else self._content(other)

    def _wire_of_some(self, names: set[str]) -> bytes:
        """As they stand on the wire. Of a COBS region either all parts are covered or none."""
        if not names & self._covered():
            return b"".join(self._content(self._frame.part(n)) for n in self._ordered(names))
        return self._wire(names)

    def _ordered(self, names: set[str]) -> list[str]:
        return [part.name for part in self._frame.parts if part.name in names]


def encoded(encoding: Encoding, region: bytes) -> bytes:
    """A region as its transparency makes it."""
    match encoding:
        case Substitution():
            table = dict(encoding.table)
            return b"".join(table.get(byte, bytes((byte,))) for byte in region)
        case Insertion():
            return _inserted(encoding, region)
        case Escape():
            return b"".join(
                bytes((encoding.byte, byte ^ encoding.xor))
                if byte in encoding.of
                else bytes((byte,))
                for byte in region
            )
        case Base16():
            return region.hex().upper().encode()
        case Cobs():
            return _cobs(region)


def _inserted(encoding: Insertion, region: bytes) -> bytes:
    """A byte behind each sequence, looked for behind the one before."""
    found = b""
    begun = 0
    for byte in region:
        found += bytes((byte,))
        if found[begun:].endswith(encoding.sequence):
            found += bytes((encoding.byte,))
            begun = len(found)
    return found


def _cobs(region: bytes) -> bytes:
    found, block, is_full = b"", b"", False
    for index, byte in enumerate(region):
        is_full = False
        if byte:
            block += bytes((byte,))
        if not byte or len(block) == 254:
            found += bytes((len(block) + 1,)) + block
            is_full = bool(byte) and index == len(region) - 1
            block = b""
    return found if is_full else found + bytes((len(block) + 1,)) + block


# --- checksums ----------------------------------------------------------------------------------


def checksum(spec: ChecksumSpec, data: bytes) -> int:
    """A checksum, bit by bit."""
    match spec.kind:
        case "xor" | "sum":
            return _folded(spec, data)
        case "fletcher":
            modulus = 256 if spec.name.endswith("/256") else 255
            low = high = 0
            for byte in data:
                low = (low + byte) % modulus
                high = (high + low) % modulus
            return high << 8 | low
    return _crc(spec, data)


def _folded(spec: ChecksumSpec, data: bytes) -> int:
    """Byte by byte: in a word, each byte stands so many bits further up."""
    total, count = spec.init, spec.width // 8
    for place, byte in enumerate(data):
        number = byte
        if spec.words == "little":
            number <<= 8 * (place % count)
        elif spec.words == "big":
            number <<= 8 * (count - 1 - place % count)
        total = total ^ number if spec.kind == "xor" else total + number
    modulus = 2**spec.width
    total = (-total if spec.negated else total) % modulus ^ spec.xorout
    if spec.mask is not None:
        total &= spec.mask
    return (total + spec.add) % modulus


def _crc(spec: ChecksumSpec, data: bytes) -> int:
    """The register is shifted once for each bit, as the definition has it."""
    register = spec.init
    for byte in data:
        for place in range(8):
            bit = byte >> (place if spec.refin else 7 - place) & 1
            top = register >> (spec.width - 1) & 1
            register = (register << 1) % (1 << spec.width)
            if bit ^ top:
                register ^= spec.poly
    if spec.refout:
        register = int(f"{register:0{spec.width}b}"[::-1], 2)
    return register ^ spec.xorout
