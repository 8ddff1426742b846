"""Types of fields, resolved to bytes.

A type says how a value lies on the wire; what the value means is on the field.
"""

from __future__ import annotations

from dataclasses import dataclass
from dataclasses import field as dataclass_field
from typing import TYPE_CHECKING, Literal

from protogen.model.origin import NOTHING, About
from protogen.model.sizes import SizeSet

if TYPE_CHECKING:
    from protogen.model.fields import Field

ByteOrder = Literal["little", "big"]
IntegerRole = Literal["number", "byte", "char", "bool"]


@dataclass(frozen=True, slots=True, kw_only=True)
class NamedValue:
    """A name for a raw value."""

    name: str
    value: int
    about: About = NOTHING


@dataclass(frozen=True, slots=True, kw_only=True)
class Enum:
    """Names of raw values. Unknown values are kept unless the enum is closed."""

    name: str
    """Snake-case name, unique in the protocol."""
    values: tuple[NamedValue, ...]
    closed: bool = False
    about: About = NOTHING


@dataclass(frozen=True, slots=True, kw_only=True)
class NamedBit:
    """A name for one bit, counted from the least significant bit 0."""

    name: str
    bit: int
    about: About = NOTHING


@dataclass(frozen=True, slots=True, kw_only=True)
class Flags:
    """Names of single bits of one integer. Unknown bits are kept."""

    name: str
    bits: tuple[NamedBit, ...]
    about: About = NOTHING


@dataclass(frozen=True, slots=True, kw_only=True)
class BitField:
    """A named run of bits, `low` to `high`, both included."""

    name: str
    low: int
    high: int
    enum: Enum | None = None
    about: About = NOTHING

    @property
    def mask(self) -> int:
        """The bits of this run, in place."""
        return ((1 << (self.high - self.low + 1)) - 1) << self.low


@dataclass(frozen=True, slots=True, kw_only=True)
class Integer:
    """An integer of `bits` bits in `size` wire bytes of `byte_bits` bits each.

    Bits above `bits` are zero, also for signed integers, which are two's complement in `bits` bits.
    """

    bits: int
    signed: bool = False
    byte_bits: Literal[7, 8] = 8
    byte_order: ByteOrder = "little"
    """Meaningless, and always `little`, where `size` is 1."""
    role: IntegerRole = "number"
    enum: Enum | None = None
    flags: Flags | None = None
    bit_fields: tuple[BitField, ...] = ()

    @property
    def size(self) -> int:
        """Wire bytes."""
        return -(-self.bits // self.byte_bits)

    @property
    def sizes(self) -> SizeSet:
        """Wire bytes, as a set."""
        return SizeSet.exactly(self.size)

    @property
    def least(self) -> int:
        """The least raw value that the bits can hold."""
        return -(1 << (self.bits - 1)) if self.signed else 0

    @property
    def greatest(self) -> int:
        """The greatest raw value that the bits can hold."""
        return (1 << (self.bits - 1 if self.signed else self.bits)) - 1

    def holds(self, value: int) -> bool:
        """Whether the bits can hold `value`."""
        return self.least <= value <= self.greatest


@dataclass(frozen=True, slots=True, kw_only=True)
class Float:
    """IEEE 754 binary32 or binary64."""

    bits: Literal[32, 64]
    byte_bits: Literal[7, 8] = 8
    byte_order: ByteOrder = "little"

    @property
    def size(self) -> int:
        """Wire bytes."""
        return -(-self.bits // self.byte_bits)

    @property
    def sizes(self) -> SizeSet:
        """Wire bytes, as a set."""
        return SizeSet.exactly(self.size)


@dataclass(frozen=True, slots=True, kw_only=True)
class Fixed:
    """A number of elements (or bytes) that never changes."""

    count: int

    @property
    def counts(self) -> SizeSet:
        """Possible numbers of elements."""
        return SizeSet.exactly(self.count)


@dataclass(frozen=True, slots=True, kw_only=True)
class Counted:
    """As many as an earlier field of the same struct or message, or of one around it, says."""

    field: str
    least: int
    greatest: int
    stated: bool = dataclass_field(default=False, compare=False)
    """Whether the schema bounds the number; else `greatest` is what the field or frame can take,
    in a declared type wherever it has the most room."""

    @property
    def counts(self) -> SizeSet:
        """Possible numbers of elements."""
        return SizeSet.between(self.least, self.greatest)


@dataclass(frozen=True, slots=True, kw_only=True)
class Fill:
    """As many as the payload has left, at most `greatest`."""

    greatest: int
    stated: bool = dataclass_field(default=False, compare=False)
    """Whether the schema bounds the number; else `greatest` is what the frame can take, in a
    declared type wherever it has the most room."""

    @property
    def counts(self) -> SizeSet:
        """Possible numbers of elements."""
        return SizeSet.between(0, self.greatest)


Extent = Fixed | Counted | Fill


@dataclass(frozen=True, slots=True, kw_only=True)
class Text:
    """ASCII text of so many bytes. A fixed size is padded with NUL bytes at the end."""

    extent: Extent
    byte_bits: Literal[7, 8] = 8

    @property
    def sizes(self) -> SizeSet:
        """Wire bytes."""
        return self.extent.counts


@dataclass(frozen=True, slots=True, kw_only=True)
class Octets:
    """Bytes that nobody interprets; in a 7-bit payload each is at most 0x7F."""

    extent: Extent
    byte_bits: Literal[7, 8] = 8

    @property
    def sizes(self) -> SizeSet:
        """Wire bytes."""
        return self.extent.counts


@dataclass(frozen=True, slots=True, kw_only=True)
class Struct:
    """Fields one after another."""

    name: str
    """Snake-case name, unique in the protocol."""
    fields: tuple[Field, ...]
    about: About = NOTHING
    sizes: SizeSet = dataclass_field(init=False, repr=False, compare=False)
    """Wire bytes. Added up once: structs that hold each other are asked at every level."""

    def __post_init__(self) -> None:
        object.__setattr__(self, "sizes", total(self.fields))


@dataclass(frozen=True, slots=True, kw_only=True)
class Array:
    """Elements of one type, one after another."""

    element: Type
    extent: Extent

    @property
    def sizes(self) -> SizeSet:
        """Wire bytes."""
        return self.element.sizes.times(self.extent.counts)


@dataclass(frozen=True, slots=True, kw_only=True)
class Case:
    """What a switch is for one raw value of its selector. A case of no bytes is an empty struct."""

    value: int
    name: str
    """The enum's name of the value, else `case_VALUE`."""
    type: Type


@dataclass(frozen=True, slots=True, kw_only=True)
class Switch:
    """One of several types, chosen by an earlier field.

    A value without a case yields the rest of the payload as bytes (at most `rest` of them) where
    the frame says where the payload ends; with `rest` None it is invalid.
    """

    selector: str
    cases: tuple[Case, ...]
    rest: int | None
    byte_bits: Literal[7, 8] = 8
    """Bits that each byte of the rest carries."""

    @property
    def sizes(self) -> SizeSet:
        """Wire bytes."""
        sizes = self.cases[0].type.sizes
        for case in self.cases[1:]:
            sizes |= case.type.sizes
        return sizes if self.rest is None else sizes | SizeSet.between(0, self.rest)


Type = Integer | Float | Text | Octets | Struct | Array | Switch


def total(fields: tuple[Field, ...]) -> SizeSet:
    """Sizes of fields that follow each other."""
    sizes = SizeSet.exactly(0)
    for field in fields:
        sizes += field.type.sizes
    return sizes
