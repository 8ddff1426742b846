"""Fields and their types, resolved to bytes.

A type says how a value lies on the wire; what the value means is on the field.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from dataclasses import field as dataclass_field
from fractions import Fraction
from typing import ClassVar, Literal, TypeGuard

import msgspec

from protogen.model.expressions import Expression, names_in
from protogen.model.extents import (
    Between,
    Counted,
    Delimited,
    Extent,
    Fill,
    Fixed,
    Marked,
    Tail,
    Until,
)
from protogen.model.meanings import BitField, NamedValue
from protogen.model.names import free_name
from protogen.model.numbers import (
    ByteOrder,
    Float,
    Integer,
    NumberType,
    characters,
    codec,
    counting_bits,
    storage_bits,
)
from protogen.model.origin import NOTHING, About
from protogen.model.packing import FilledPacking, Packing
from protogen.model.presence import Conditional, Presence, Trailing
from protogen.model.sizes import SizeSet
from protogen.model.texts import PLAIN_TEXT, TextForm
from protogen.runtime.payload.bits import BitOrder
from protogen.runtime.payload.texts import PaddedText

__all__ = [
    "NO_OFFSET",
    "UNSCALED",
    "Array",
    "Between",
    "BitOrder",
    "ByteOrder",
    "Case",
    "Constant",
    "Counted",
    "Delimited",
    "Extent",
    "Field",
    "Fill",
    "Fixed",
    "Float",
    "Integer",
    "Marked",
    "NumberType",
    "Octets",
    "Scalar",
    "Struct",
    "Switch",
    "Tail",
    "Text",
    "TextForm",
    "Type",
    "Until",
    "bits_of",
    "characters",
    "codec",
    "counting_bits",
    "is_integer",
    "is_text",
    "needed_by",
    "packing_of",
    "run_of",
    "storage_bits",
    "total",
]

Constant = int | float | str | bytes | tuple[int, ...]
"""A raw value: a number, a text, bytes, or the numbers of an array."""

UNSCALED = Fraction(1)
NO_OFFSET = Fraction(0)
"""Scale and offset of a field whose physical value is the raw value."""

_NO_NAMES: frozenset[str] = frozenset()


class _Bytes(msgspec.Struct, frozen=True, kw_only=True):
    """So many bytes."""

    extent: Extent
    byte_bits: Literal[7, 8] = 8
    holds_values: ClassVar[bool] = True
    word: ClassVar[str]

    @property
    def needs(self) -> frozenset[str]:
        """The names of the fields that count, if some do."""
        return self.extent.needs

    @property
    def label(self) -> str:
        """The type in the words of the schema language."""
        return f"{self.word}[{self.extent.label}]"

    @property
    def terminator(self) -> bytes:
        """What ends it on the wire and is no part of the value; empty where its size is told."""
        return bytes((self.extent.byte,)) if isinstance(self.extent, Until) else b""

    @property
    def sizes(self) -> SizeSet:
        """Wire bytes, with those of the terminator, or of the separator in front."""
        counts, extent = self.extent.counts, self.extent
        ends = isinstance(extent, Until) or (isinstance(extent, Between) and extent.leads)
        return counts + SizeSet.exactly(1) if ends else counts


class Text(_Bytes, frozen=True, kw_only=True):
    """ASCII text of so many bytes; of a fixed size it has padding at the end."""

    word: ClassVar[str] = "ascii"
    form: TextForm = PLAIN_TEXT

    @property
    def label(self) -> str:
        """The type in the words of the schema language."""
        plain = f"{self.word}[{self.extent.label}]"
        return plain if self.form.is_plain else f"{plain} ({self.form.label})"

    @property
    def padded(self) -> PaddedText | None:
        """What reads and writes a text of a fixed size; None of others, which are their bytes."""
        return self.form.codec(self.extent.count) if isinstance(self.extent, Fixed) else None


class Octets(_Bytes, frozen=True, kw_only=True):
    """Bytes that nobody interprets; in a 7-bit payload each is at most 0x7F."""

    word: ClassVar[str] = "bytes"


@dataclass(frozen=True, slots=True, kw_only=True)
class Struct:
    """Fields one after another."""

    name: str
    """Snake-case name, unique in the protocol."""
    fields: tuple[Field, ...]
    about: About = NOTHING
    packed: BitOrder | None = None
    """Order of the bits, where fields follow each other without byte boundaries."""
    sizes: SizeSet = dataclass_field(init=False, repr=False, compare=False)
    """Wire bytes. Added up once: structs that hold each other are asked at every level."""
    holds_values: bool = dataclass_field(init=False, repr=False, compare=False)
    """True if a record keeps anything of it."""
    needs: frozenset[str] = dataclass_field(init=False, repr=False, compare=False)
    """Names of fields in front of the struct that count or select something inside of it; of a
    member of a struct, `header.count`."""
    extent: ClassVar[None] = None

    @property
    def label(self) -> str:
        """The type in the words of the schema language."""
        return self.name

    def __post_init__(self) -> None:
        stored = any(item.is_stored or item.has_count or item.optional for item in self.fields)
        run = run_of(self)
        sizes = total(self.fields) if run is None else run.sizes
        object.__setattr__(self, "sizes", sizes)
        object.__setattr__(self, "holds_values", stored)
        object.__setattr__(self, "needs", needed_by(self.fields))


class Array(msgspec.Struct, frozen=True, kw_only=True):
    """Elements of one type, one after another."""

    element: Type
    extent: Extent
    packed: BitOrder | None = None
    """Order of the bits, where integers follow each other without byte boundaries."""

    @property
    def label(self) -> str:
        """The type in the words of the schema language, such as `sint14[3]`."""
        order = "" if self.packed is None else f" {self.packed}"
        return f"{self.element.label}[{self.extent.label}]{order}"

    @property
    def holds_values(self) -> bool:
        """True if a record keeps anything of it."""
        return self.element.holds_values

    @property
    def needs(self) -> frozenset[str]:
        """Names of earlier fields that count the elements or something inside of them."""
        return self.extent.needs | self.element.needs

    @property
    def sizes(self) -> SizeSet:
        """Wire bytes."""
        packing, counts = packing_of(self), self.extent.counts
        if isinstance(packing, FilledPacking):
            return packing.sizes_of(counts)
        return self.element.sizes.times(counts) if packing is None else packing.sizes


class Case(msgspec.Struct, frozen=True, kw_only=True):
    """Type for one raw value of a switch's selector. A case of no bytes is an empty struct."""

    value: int | None
    """None: every value that no other case has."""
    name: str
    """The enum's name of the value, else `case_VALUE`; `else` of all other values."""
    type: Type


class Switch(msgspec.Struct, frozen=True, kw_only=True):
    """One of several types, chosen by earlier fields.

    A case for all other values is the last one. Without it, a value without a case yields the rest
    of the payload as bytes (at most `rest` of them) where the frame says where the payload ends;
    with `rest` None it is invalid.
    """

    selector: Expression
    cases: tuple[Case, ...]
    rest: int | None
    byte_bits: Literal[7, 8] = 8
    """Bits that each byte of the rest carries."""
    extent: ClassVar[None] = None

    @property
    def label(self) -> str:
        """The type in the words of the schema language."""
        return f"switch({self.selector.text})"

    @property
    def holds_values(self) -> bool:
        """True if a record keeps anything of it."""
        return self.rest is not None or any(case.type.holds_values for case in self.cases)

    @property
    def needs(self) -> frozenset[str]:
        """Names of earlier fields that select the case or count something inside of one."""
        return names_in(self.selector).union(*(case.type.needs for case in self.cases))

    @property
    def rest_name(self) -> str:
        """Name beside the cases' for the bytes of a value without a case."""
        return free_name("other", {case.name for case in self.cases})

    def case(self, value: int) -> Case | None:
        """The case of a value of the selector."""
        return next((case for case in self.cases if case.value == value), self.otherwise)

    @property
    def otherwise(self) -> Case | None:
        """The case of all values that no other one has, if there is one."""
        return self.cases[-1] if self.cases and self.cases[-1].value is None else None

    @property
    def takes_all(self) -> bool:
        """True if no value of the selector is invalid."""
        return self.rest is not None or self.otherwise is not None

    @property
    def values(self) -> tuple[int, ...]:
        """The values that have a case of their own."""
        return tuple(case.value for case in self.cases if case.value is not None)

    @property
    def sizes(self) -> SizeSet:
        """Wire bytes."""
        sizes = self.cases[0].type.sizes
        for case in self.cases[1:]:
            sizes |= case.type.sizes
        return sizes if self.rest is None else sizes | SizeSet.between(0, self.rest)


Scalar = Integer | Float | Text | Octets
"""A type of single values."""
Type = Scalar | Struct | Array | Switch


def is_integer(type_: Type) -> TypeGuard[Integer]:
    """True if the values are integers, whatever they mean."""
    return isinstance(type_, Integer)


def run_of(struct: Struct) -> Packing | None:
    """The run of bits that a struct is, if its numbers are packed."""
    return None if struct.packed is None else Packing(struct.packed, bits_of(struct))


def packing_of(array: Array) -> Packing | FilledPacking | None:
    """The run of bits that an array is, if its numbers are packed."""
    if array.packed is not None and isinstance(array.extent, Fill):
        return FilledPacking(array.packed, bits_of(array.element))
    return None if array.packed is None else Packing(array.packed, bits_of(array))


def bits_of(type_: Type) -> int:
    """Bits of packed numbers, one behind another; of anything else those of its bytes."""
    match type_:
        case Integer():
            return type_.bits
        case Array():
            return type_.extent.counts.greatest * bits_of(type_.element)
        case Struct():
            return sum(bits_of(field.type) for field in type_.fields)
    return 8 * type_.sizes.greatest


def is_text(type_: Type) -> bool:
    """True if the values are integers that are written as text."""
    return isinstance(type_, Integer) and type_.text is not None


class Field(msgspec.Struct, frozen=True, kw_only=True):
    """One field of a message or struct.

    For integers `least` and `greatest` are the raw bounds that an encoder allows: the range, else
    what the bits can hold; for floats they are the range or None; for arrays they bound each
    element. The same holds for `special`, `scale`, `offset` and `unit`.
    """

    name: str
    type: Type
    position: int | None
    """Byte offset in the message or struct; None where it varies, and for packed integers."""
    bit: int | None = None
    """Bit offset in a packed struct; None in others."""
    const: Constant | None = None
    default: Constant | None = None
    least: Fraction | None = None
    greatest: Fraction | None = None
    ranged: bool = False
    """True if the schema states the range."""
    scale: Fraction = UNSCALED
    offset: Fraction = NO_OFFSET
    unit: str | None = None
    special: tuple[NamedValue, ...] = ()
    unknown: bool = False
    when: Expression | None = None
    """The condition on which the field is there; None: it always is."""
    optional: bool = False
    """True if only the payload's end says whether it is there: all behind it is such a field."""
    behind: str = ""
    """The optional field in front, without which this one is not there either."""
    region: Fixed | Counted | None = None
    """Bytes that what it holds has to take, just as many, where they are told."""
    part: str = ""
    """The part of the frame whose number it is, so that it takes no bytes of the payload."""
    renamed_from: str | None = None
    """Name in the version before, where that was another one."""
    about: About = NOTHING

    @property
    def sizes(self) -> SizeSet:
        """Wire bytes; none where the field is not there."""
        sizes = self.sizes_there
        return sizes | SizeSet.exactly(0) if self.may_be_absent else sizes

    @property
    def sizes_there(self) -> SizeSet:
        """Wire bytes where the field is there."""
        return self.type.sizes if self.region is None else _within(self.type.sizes, self.region)

    @property
    def sizes_in_front(self) -> SizeSet:
        """Wire bytes in front of the next field, without which nothing optional is left out."""
        return self.sizes_there if self.optional else self.sizes

    @property
    def presence(self) -> Presence | None:
        """What says whether the field is there; None: it always is."""
        if self.optional:
            return Trailing(self.behind)
        return None if self.when is None else Conditional(self.when)

    @property
    def may_be_absent(self) -> bool:
        """True if the field is not always there."""
        return self.when is not None or self.optional

    @property
    def needs(self) -> frozenset[str]:
        """Names of earlier fields that say whether it is there, count or select."""
        needs = self.type.needs if self.when is None else self.type.needs | names_in(self.when)
        return needs if self.region is None else needs | self.region.needs

    @property
    def scaled(self) -> bool:
        """True if the physical value differs from the raw value."""
        if self.scale is UNSCALED and self.offset is NO_OFFSET:  # As nearly all.
            return False
        return self.scale != 1 or self.offset != 0

    @property
    def size(self) -> int | None:
        """Wire bytes, where they do not vary."""
        return self.sizes.fixed

    @property
    def element(self) -> Type:
        """The type of single values: of an array that of its elements."""
        type_ = self.type
        while isinstance(type_, Array):
            type_ = type_.element
        return type_

    @property
    def integer(self) -> Integer | None:
        """The integer that the field holds, or of which it is an array."""
        type_ = self.element
        return type_ if isinstance(type_, Integer) else None

    @property
    def is_bool(self) -> bool:
        """True if the value is false or true."""
        return isinstance(self.type, Integer) and self.type.role == "bool"

    @property
    def bit_fields(self) -> tuple[BitField, ...]:
        """The runs of bits of the number that have names."""
        return self.type.bit_fields if isinstance(self.type, Integer) else ()

    @property
    def is_stored(self) -> bool:
        """True if a record has a member for the value: constants and empty structs have none."""
        return self.const is None and self.type.holds_values

    @property
    def has_count(self) -> bool:
        """True if a record keeps the number of elements or bytes, which no earlier field says."""
        return self.const is None and isinstance(self.type.extent, Delimited)

    @property
    def constant_number(self) -> int | None:
        """The value of a constant integer, which is always there."""
        is_integer_there = isinstance(self.type, Integer) and not self.may_be_absent
        if is_integer_there and isinstance(self.const, int):
            return int(self.const)
        return None


def _within(sizes: SizeSet, region: Fixed | Counted) -> SizeSet:
    """Sizes of what has to take so many bytes; where none does, that was reported."""
    bounds = region.counts
    return sizes.within(bounds.least, bounds.greatest) or bounds


def total(fields: tuple[Field, ...]) -> SizeSet:
    """Sizes of fields that follow each other."""
    sizes = SizeSet.exactly(0)
    for field in reversed(fields):
        sizes += field.sizes_in_front
        if field.optional:  # As is all behind it.
            sizes |= SizeSet.exactly(0)
    return sizes


def needed_by(fields: Sequence[Field]) -> frozenset[str]:
    """The names around that fields ask for."""
    needed = _NO_NAMES
    for field in reversed(fields):
        needed = beyond(needed, field.name) | field.needs
    return needed


def beyond(needed: frozenset[str], name: str) -> frozenset[str]:
    """The names that are needed of what lies around, where one field has this name."""
    return frozenset(path for path in needed if path.partition(".")[0] != name)
