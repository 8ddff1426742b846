"""Numbers and literals of a frame, as a receiver reads and checks them."""

from __future__ import annotations

from collections.abc import Iterable

import msgspec

from protogen.c_language.numbers import hexadecimal, unsigned_type
from protogen.model.frame_places import PlacedPart
from protogen.model.frame_plan import FramePlan, StartRule
from protogen.model.parts import (
    BitsPart,
    ChoicePart,
    LiteralPart,
    MirrorBits,
    NumberPart,
    PartType,
    ToldLength,
    ToldPart,
)
from protogen.targets.c.frame.expressions import byte, less_absent
from protogen.targets.c.frame.part_numbers import PartNumbers
from protogen.targets.c.frame.texts import comment_of
from protogen.targets.c.spelling import Names

_WIDE = 16
"""Bits of the smallest type in which C adds numbers."""


class NumberView(msgspec.Struct, frozen=True):
    """A number that is checked as soon as its last byte is there."""

    last: int
    """Index of its last byte, from the head's or the tail's first byte."""
    value: str
    """Its value, read from `content`."""
    seven_bit: tuple[int, ...]
    """Offsets of its bytes, where their most significant bit has to be clear."""
    fault: str
    """The condition that its bytes are no number; empty where each are one."""
    bounds: str
    """The condition that it is out of bounds; empty where nothing bounds it."""
    contradicts: str
    """The condition that another length does not agree with the first; empty where it is none."""
    is_length: bool
    """True if it is the length that tells the payload's size."""
    identifies: bool
    """True if it is the identity's last part, and the identity tells the payload's size."""
    tells_sizes: bool
    """True if with it both identity and length are there, and are held against each other."""
    less: str = ""
    """C behind each index: what is taken off where parts in front of it are absent."""

    @property
    def is_of_use(self) -> bool:
        """True if anything is checked or known when it is there."""
        checks = self.seven_bit or self.fault or self.bounds or self.contradicts
        return bool(checks or self.is_length or self.identifies or self.tells_sizes)

    @property
    def high_bits(self) -> str:
        """All of its bytes in one, for a look at their most significant bits."""
        return f"({' | '.join(f'content[{offset}{self.less}]' for offset in self.seven_bit)})"


class LiteralView(msgspec.Struct, frozen=True):
    """A byte that is fixed."""

    index: int
    byte: str


class PartView(msgspec.Struct, frozen=True):
    """A part that events show."""

    placed: PlacedPart
    member: str
    """The member for it."""
    numbers: PartNumbers

    @property
    def part(self) -> NumberPart:
        """The part itself."""
        assert isinstance(self.placed.part, NumberPart)
        return self.placed.part

    @property
    def name(self) -> str:
        """Name of the part."""
        return self.placed.name

    @property
    def in_head(self) -> bool:
        """True if it stands in front of the payload."""
        return self.placed.in_head

    @property
    def type(self) -> str:
        """Type of its value."""
        return unsigned_type(self.part.type.bits)

    @property
    def comment(self) -> str:
        """What is said of it."""
        return comment_of(self.part.type)

    @property
    def calls(self) -> bool:
        """True if functions read it: of digits, or of bits that lie in several bytes."""
        type_ = self.part.type
        return type_.text is not None or (type_.within is not None and type_.whole.size > 1)

    def value(self, payload: str) -> str:
        """Its value, read from `content` or `tail`; `payload` is the C of the payload's size."""
        at = "content" if self.placed.in_head else "tail"
        less = less_absent(self.placed.place, payload)
        return self.numbers.shown(self.part.type, at, self.placed.offset, less)


class ToldView(msgspec.Struct, frozen=True):
    """A part that is not sent. Events show an identity as a decoder was told it."""

    part: ToldPart
    member: str
    """The member for it among an event's parts."""

    in_head = True

    @property
    def name(self) -> str:
        """Name of the part."""
        return self.part.name

    @property
    def type(self) -> str:
        """Type of its value."""
        return unsigned_type(self.part.type.bits)

    @property
    def comment(self) -> str:
        """What is said of it."""
        return "Not sent: as the decoder was told it."

    @property
    def kept(self) -> str:
        """The member of a decoder that keeps what it was told."""
        return f"told_{self.member}"

    @property
    def own(self) -> str:
        """The member that keeps what it was told when the candidate began."""
        return f"own_{self.member}"

    @property
    def is_new(self) -> str:
        """The member that says that it was told since the candidate began."""
        return f"new_{self.member}"

    @property
    def once(self) -> bool:
        """True if what was told is that of one frame."""
        return self.part.telling.once

    @property
    def is_length(self) -> bool:
        """True if it is a length, of which some values are no frame's."""
        return isinstance(self.part, ToldLength)

    @property
    def flips(self) -> str:
        """What the value is kept with, by an exclusive or, so that zeros are the default."""
        default = self.part.telling.default
        return f" ^ {hexadecimal(default)}" if default else ""

    def keeps(self, value: str) -> str:
        """A value as it is kept."""
        return f"({self.type})({value}{self.flips})" if self.flips else value

    def value(self, payload: str) -> str:
        """Its value; where the payload lies tells nothing of it."""
        return self.keeps(f"decoder->{self.own}")


def told_of(plan: FramePlan, names: Names) -> tuple[ToldView, ...]:
    """The views of the parts that are told, and not sent."""
    return tuple(ToldView(part, names.member(part.name)) for part in plan.frame.told)


def numbers_of(
    plan: FramePlan, items: Iterable[PlacedPart], numbers: PartNumbers
) -> tuple[NumberView, ...]:
    """Those of the parts that are numbers of which something is checked or known early."""
    views = (
        _bits(plan, item, numbers)
        if isinstance(item.part, BitsPart)
        else _number(plan, item, numbers)
        for item in items
        if isinstance(item.part, NumberPart | BitsPart)
    )
    return tuple(view for view in views if view.is_of_use)


def _bits(plan: FramePlan, item: PlacedPart, numbers: PartNumbers) -> NumberView:
    """A number whose bits are parts: what is checked of each, and of those that are of none."""
    part = item.part
    assert isinstance(part, BitsPart)
    members = [_number(plan, plan.part(member.name), numbers) for member in part.members]
    less = less_absent(item.place, "decoder->payload")
    value = numbers.whole(part.type.whole, "content", item.offset, less)
    bounds = [view.bounds for view in members if view.bounds]
    bounds += [_is_other(plan, mirror, numbers) for mirror in part.mirrors]
    mask = part.mask
    if mask:
        bounds.insert(0, f"({value} & {hexadecimal(mask)}) != {hexadecimal(part.fixed)}")
    length = next((view for view in members if view.is_length), None)
    # Of one byte, all was seen when it was seen to be a start.
    is_start = plan.start is StartRule.SET and item.in_head and item.end <= plan.start_size
    return NumberView(
        last=item.end - 1,
        value=value if length is None else length.value,
        seven_bit=tuple(range(item.offset, item.end)) if part.type.byte_bits == 7 else (),
        fault="",
        bounds="" if is_start else " || ".join(bounds),
        contradicts=" || ".join(view.contradicts for view in members if view.contradicts),
        is_length=length is not None,
        identifies=any(view.identifies for view in members),
        tells_sizes=any(view.tells_sizes for view in members),
        less=less,
    )


def _is_other(plan: FramePlan, mirror: MirrorBits, numbers: PartNumbers) -> str:
    """The condition that bits do not follow from their number, on the same side of the payload."""

    def value(type_: PartType, placed: PlacedPart) -> str:
        less = less_absent(placed.place, "decoder->payload")
        return numbers.value(type_, "content", placed.offset, less)

    bits = value(mirror.type, plan.part(mirror.name))
    of = value(mirror.of.type, plan.part(mirror.of.name))
    if not mirror.inverted:
        return f"{bits} != {of}"
    # Compilers look twice at a number that is compared with the complement of another.
    type_ = unsigned_type(mirror.type.bits)
    return f"({type_})({bits} ^ {of}) != {hexadecimal(mirror.flips)}"


def _number(plan: FramePlan, item: PlacedPart, numbers: PartNumbers) -> NumberView:
    part = item.part
    assert isinstance(part, NumberPart)
    type_ = part.type
    less = less_absent(item.place, "decoder->payload")
    value = numbers.value(type_, "content", item.offset, less)
    is_first = plan.start is StartRule.SET and item.in_head and item.end <= plan.start_size
    starts = isinstance(part, ChoicePart) and is_first
    is_last = part in plan.sent_identity[-1:]
    return NumberView(
        last=item.end - 1,
        value=value,
        seven_bit=tuple(range(item.offset, item.end)) if type_.byte_bits == 7 else (),
        fault=numbers.fault(type_, "content", item.offset, less),
        bounds=_out_of_bounds(item, value, less) if item in plan.bounded and not starts else "",
        contradicts=_contradicts(plan, part, value, numbers),
        is_length=plan.length is not None and part.name == plan.length.part.name,
        identifies=is_last and plan.identity_is_early and plan.length is None,
        tells_sizes=item.in_head and item.end == plan.sizes_told_at,
        less=less,
    )


def _contradicts(plan: FramePlan, part: NumberPart, value: str, numbers: PartNumbers) -> str:
    """The condition that a length does not agree with the first; empty for any other number.

    Both are numbers of the head. Behind the payload, its size stands for the first.
    """
    length = next((item for item in plan.further_lengths if item.part.name == part.name), None)
    if length is None:
        return ""
    first = length.first
    if not length.placed.in_head:
        size, empty = "decoder->payload", 0
        due = _more(size, size, empty, length.base, length.base + length.optional)
        return f"{value} != {due}"
    number = numbers.value(first.part.type, "content", plan.part(first.part.name).offset)
    is_wide = part.type.bits > _WIDE >= first.part.type.bits
    wide = f"({unsigned_type(part.type.bits)}){number}" if is_wide else number
    return f"{value} != {_more(wide, number, first.base, length.more_if_empty, length.more)}"


def _more(number: str, tells: str, base: int, empty: int, more: int) -> str:
    """A number and so much more, which depends on whether `tells` is `base`."""
    if empty == more:
        return f"{number} {'+' if more > 0 else '-'} {abs(more)}U" if more else number
    sums = [_more(number, tells, base, item, item) for item in (empty, more)]
    return f"({tells} == {base}U ? {' : '.join(sums)})"


def _out_of_bounds(item: PlacedPart, value: str, less: str) -> str:
    part = item.part
    assert isinstance(part, NumberPart)
    if isinstance(part, ChoicePart):
        return none_of(part, value)
    if part.between is not None:
        places = range(item.offset, item.end)
        return has_others(part, part.between, [f"content[{at}{less}]" for at in places])
    conditions = [f"{value} < {part.least}U"] if part.least > part.type.least else []
    if part.greatest < part.type.greatest:
        conditions.append(f"{value} > {part.greatest}U")
    return " || ".join(conditions)


def has_others(part: NumberPart, between: tuple[int, int], characters: Iterable[str]) -> str:
    """The condition that some character of a text is not between these two."""
    (first, last), bits, found = between, part.type.byte_bits, []
    for character in characters:
        found += [f"{character} < {hexadecimal(first)}"] if first > 0 else []
        found += [f"{character} > {hexadecimal(last)}"] if last < (1 << bits) - 1 else []
    return " || ".join(found)


def none_of(part: ChoicePart, value: str) -> str:
    """The condition that a number is none of the literals."""
    return " && ".join(f"{value} != {hexadecimal(item)}" for item in part.values)


def literals_of(items: Iterable[PlacedPart]) -> tuple[LiteralView, ...]:
    """The bytes of those of the parts that are literals."""
    return tuple(
        LiteralView(item.offset + index, byte(value))
        for item in items
        if isinstance(item.part, LiteralPart)
        for index, value in enumerate(item.part.bytes)
    )


class LengthView(msgspec.Struct, frozen=True):
    """The length part."""

    least: int
    greatest: int
    bits: int
    base: int
    """The value for a payload of no bytes."""
    optional: int
    """Bytes that it counts only where there is a payload."""
    payload: int
    """The greatest payload."""
    region_end: int | None = None
    """Where it counts stuffed bytes: how many there are up to their end, for the value `base`."""

    @property
    def type(self) -> str:
        """The type of the value."""
        return unsigned_type(max(self.bits, 16))

    @property
    def wrapping(self) -> str:
        """The type in which the size of a payload that is too short turns out too great."""
        is_narrow = self.bits <= 8 and self.base + self.payload < 256
        return "uint8_t" if is_narrow else self.type

    def size_of(self, length: str) -> str:
        """The payload's size, in the wrapping type."""
        return f"({self.wrapping})({length} - {self.base}U)" if self.base else length

    def tests(self, size: str) -> str:
        """The condition that `length`, or the payload's size after it, is none that a frame has."""
        most = (1 << (8 if self.wrapping == "uint8_t" else self.bits)) - 1
        found = self.beyond("length", self.payload)
        if self.payload < most or self.base:
            found.append(f"{size} > {self.payload}U")
        return " || ".join(found)

    def beyond(self, length: str, payload: int) -> list[str]:
        """The conditions that it is out of bounds, with a payload of so many bytes at most."""
        found = [f"{length} < {self.least}U"] if self.least > self.base else []
        if self.greatest < min(self.base + payload, (1 << self.bits) - 1):
            found.append(f"{length} > {self.greatest}U")
        return found

    @property
    def leads_nowhere(self) -> str:
        """The condition that no frame has a `length` that counts stuffed bytes."""
        found = [f"length < {self.base}U"] if self.base else []
        if self.greatest < (1 << self.bits) - 1:
            found.append(f"length > {self.greatest}U")
        return " || ".join(found) or "false"

    @property
    def impossible(self) -> str:
        """The condition that no frame has `length`; empty where each may be one."""
        smallest = self.base + self.optional
        if self.optional and self.least <= self.base:
            found = [f"(length != {self.base}U && length <= {smallest}U)"]
        else:
            least = max(self.least, smallest + bool(self.optional))
            found = [f"length < {least}U"] if least > 0 else []
        greatest = min(self.greatest, smallest + self.payload)
        if greatest < (1 << self.bits) - 1:
            found.append(f"length > {greatest}U")
        return " || ".join(found)

    def told_payload(self, type_: str) -> str:
        """The payload's size that a possible `length` tells, of a C type."""
        if self.optional:
            most = f"{self.base + self.optional}U"
            return f"({type_})(length > {most} ? length - {most} : 0U)"
        if self.base:
            return f"({type_})(length - {self.base}U)"
        return "length" if type_ == self.type else f"({type_})length"


def length_of(plan: FramePlan) -> LengthView | None:
    """The view of a frame's length part."""
    if plan.length is None:
        return None
    part = plan.length.part
    held = part.type.byte_bits * part.type.size
    if part.type.text is not None:
        held = part.type.width
    elif part.type.within is not None:
        held = part.type.bits
    return LengthView(
        least=part.least,
        greatest=min(plan.length.greatest, (1 << held) - 1),
        bits=held,
        base=plan.length.base,
        optional=plan.length.optional,
        payload=plan.payload.greatest,
        region_end=plan.length.region_end,
    )
