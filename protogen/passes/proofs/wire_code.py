"""Wire code of a frame: segments of codewords.

The framing analysis asks of these segments whether a delimiter can occur where it must not.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from functools import cache, reduce
from operator import or_

from protogen.copying import replace
from protogen.model.frame import Frame
from protogen.model.numbers import Numeral
from protogen.model.parts import (
    BitsPart,
    ChecksumPart,
    ChoicePart,
    LiteralPart,
    NumberPart,
    Part,
    PartType,
    TypedPart,
    place_mask,
    place_of,
)
from protogen.model.transparency import Base16, Cobs, Encoding, Escape, Insertion, Substitution
from protogen.passes.proofs.codewords import Inserted, Segment

ByteSet = frozenset[int]
EVERY_BYTE: ByteSet = frozenset(range(256))
SEVEN_BITS: ByteSet = frozenset(range(128))


@cache
def code_of(encoding: Encoding | None) -> Mapping[int, bytes] | None:
    """The codeword of each byte; None for COBS, which does not work byte by byte.

    Where a byte is put in behind several, each stands for itself.
    """
    match encoding:
        case Substitution():
            return {**_plain(), **dict(encoding.table)}
        case Escape():
            escaped = {byte: bytes((encoding.byte, byte ^ encoding.xor)) for byte in encoding.of}
            return {**_plain(), **escaped}
        case Base16():
            return {byte: f"{byte:02X}".encode() for byte in range(256)}
        case Cobs():
            return None
        case Insertion() | None:
            return _plain()


@cache
def _plain() -> Mapping[int, bytes]:
    return {byte: bytes((byte,)) for byte in range(256)}


def part_bytes(part: Part, payload: ByteSet) -> tuple[ByteSet, ...]:
    """Values of each unstuffed byte of a part; for the payload, of any of its bytes."""
    match part:
        case LiteralPart():
            return tuple(frozenset({byte}) for byte in part.bytes)
        case ChoicePart():
            return tuple(map(frozenset, zip(*part.words, strict=True)))
        case BitsPart():
            return bits_bytes(part, {})
        case NumberPart():
            return _number_bytes(part, part.least, part.greatest)
        case ChecksumPart():
            least, greatest = part.algorithm.bounds
            return _number_bytes(part, least, min(greatest, part.type.greatest))
    return (payload,)


def _number_bytes(part: TypedPart, least: int, greatest: int) -> tuple[ByteSet, ...]:
    """The range bounds the number's most significant byte, and all of it if it is one byte.

    Of digits it bounds each, and so it does of the characters of a text.
    """
    type_ = part.type
    if isinstance(type_.text, Numeral):
        return _digits(type_.text, least, greatest)
    if isinstance(part, NumberPart) and part.between is not None:
        return (frozenset(range(part.between[0], part.between[1] + 1)),) * type_.size
    every = SEVEN_BITS if type_.byte_bits == 7 else EVERY_BYTE
    shift = type_.byte_bits * (type_.size - 1)
    top = frozenset(range(least >> shift, (greatest >> shift) + 1))
    rest = (every,) * (type_.size - 1)
    return (top, *rest) if type_.byte_order == "big" else (*rest, top)


def bits_bytes(part: BitsPart, known: Mapping[str, int]) -> tuple[ByteSet, ...]:
    """Values of each byte of a part whose bits are parts, some of which have known values."""
    width = part.type.byte_bits
    numbers: dict[str, NumberPart] = {item.name: item for item in part.members}
    numbers |= {mirror.of.name: mirror.of for mirror in part.mirrors}
    found: list[ByteSet] = []
    for low in range(0, width * part.type.size, width):
        values = {part.fixed >> low & (1 << width) - 1}
        for item in numbers.values():
            own = _bits_in(part, item, known.get(item.name), low)
            values = {one | other for one in values for other in own}
        for checksum in part.sums:
            own = _any_bits_in(checksum.type, low, width)
            values = {one | other for one in values for other in own}
        found.append(frozenset(values))
    return tuple(found if part.type.byte_order == "little" else reversed(found))


def _bits_in(part: BitsPart, item: NumberPart, value: int | None, low: int) -> ByteSet:
    """What a number can make of the byte of a part that has the bits from `low` on.

    It has bits of its own there, or others follow from it.
    """
    width = part.type.byte_bits
    every = (1 << width) - 1
    mirrors = [mirror for mirror in part.mirrors if mirror.of.name == item.name]
    own_type = [item.type for member in part.members if member.name == item.name]

    def in_byte(number: int) -> int:
        placed = [(type_, number) for type_ in own_type]
        placed += [(mirror.type, mirror.follows(number)) for mirror in mirrors]
        moved = (_moved(bits, place_of(type_) - low) for type_, bits in placed)
        return reduce(or_, moved) & every

    if value is not None:
        return frozenset({in_byte(value)})
    if item.type.bits <= width:
        return frozenset(map(in_byte, range(item.least, item.greatest + 1)))
    masks = (place_mask(type_) for type_ in (*own_type, *(mirror.type for mirror in mirrors)))
    own = reduce(or_, masks) >> low & every
    return frozenset(number & own for number in range(every + 1))


def _any_bits_in(type_: PartType, low: int, width: int) -> ByteSet:
    """What any value of some bits can make of the byte that has the bits from `low` on."""
    own = place_mask(type_) >> low & (1 << width) - 1
    return frozenset(number & own for number in range(1 << width))


def _moved(number: int, shift: int) -> int:
    return number << shift if shift >= 0 else number >> -shift


def _digits(form: Numeral, least: int, greatest: int) -> tuple[ByteSet, ...]:
    """The characters of each digit of the numbers in between."""
    found: list[ByteSet] = []
    for _ in range(form.size):
        values = range(least, min(greatest, least + form.base - 1) + 1)
        found.append(frozenset(form.alphabet[value % form.base] for value in values))
        least, greatest = least // form.base, greatest // form.base
    return tuple(reversed(found))


def segments(frame: Frame, payload: ByteSet, delimiters: Iterable[str]) -> list[Segment]:
    """The frame as it can stand on the wire; the parts called `delimiters` are its own literals."""
    transparency, code = frame.transparency, code_of(frame.encoding)
    own, inserts = frozenset(delimiters), None
    if isinstance(frame.encoding, Insertion):
        inserts = Inserted(frame.encoding.sequence, frame.encoding.byte)
    result: list[Segment] = []
    for part in frame.parts:
        stuffed = part.name in frame.stuffed
        if transparency is not None and stuffed and code is None:
            if part.name == transparency.first:
                words = frozenset(bytes((byte,)) for byte in range(1, 256))
                result.append(Segment(words, 1, None))
            continue
        found = _part_segments(part, payload, code if stuffed else _plain(), own)
        result.extend(
            replace(item, inserts=inserts) if stuffed and inserts else item for item in found
        )
    return _joined(result)


def _part_segments(
    part: Part, payload: ByteSet, code: Mapping[int, bytes] | None, own: frozenset[str]
) -> Iterable[Segment]:
    assert code is not None
    if isinstance(part, LiteralPart | ChoicePart):
        literals = part.words if isinstance(part, ChoicePart) else (part.bytes,)
        words = frozenset(b"".join(code[byte] for byte in literal) for literal in literals)
        yield Segment(words, 1, 1, part.name in own)
        return
    for values in part_bytes(part, payload):
        words = frozenset(code[byte] for byte in values)
        if isinstance(part, TypedPart):
            yield Segment(words, 0 if part.is_optional else 1, 1)
        else:
            yield Segment(words, 0, None)


def _joined(parts: list[Segment]) -> list[Segment]:
    """Neighbouring literals that are delimiters are one delimiter."""
    result: list[Segment] = []
    for segment in parts:
        if segment.own and result and result[-1].own:
            word = b"".join((*result[-1].words, *segment.words))
            result[-1] = Segment(frozenset({word}), 1, 1, True)
        else:
            result.append(segment)
    return result


def wire_bytes(frame: Frame, payload: ByteSet) -> Iterable[tuple[Part, ByteSet]]:
    """Each part with all bytes that can stand for it on the wire."""
    covered, code = frame.stuffed, code_of(frame.encoding)
    for part in frame.parts:
        values = frozenset().union(*part_bytes(part, payload))
        if part.name not in covered:
            yield part, values
        elif code is None:
            yield part, EVERY_BYTE - {0}
        else:
            more = {frame.encoding.byte} if isinstance(frame.encoding, Insertion) else set()
            yield part, frozenset(byte for value in values for byte in code[value]) | more
