"""Numbers, resolved to bits and bytes."""

from __future__ import annotations

import struct
import sys
from collections.abc import Mapping
from fractions import Fraction
from functools import cache, cached_property
from typing import ClassVar, Literal

import msgspec

from protogen.model.meanings import BitField, Enum, Flags
from protogen.model.sizes import SizeSet
from protogen.runtime.payload.number import BitsNumber, Characters, Number
from protogen.runtime.payload.numerals import FreeNumeral as WrittenFreely
from protogen.runtime.payload.numerals import Numeral as WrittenNumeral
from protogen.runtime.payload.numerals import Separated

ByteOrder = Literal["little", "big"]
IntegerRole = Literal["number", "byte", "char", "bool", "ascii"]
"""Contents of an integer; `ascii`: characters of a part of the frame, the first one the highest."""
MachineKind = Literal["bool", "int", "uint", "float"]
"""Kind of the machine number that holds a value."""

_NO_NAMES: frozenset[str] = frozenset()


def storage_bits(bits: int) -> int:
    """Bits of the smallest machine integer that holds so many: 8, 16, 32 or 64."""
    return max(8, 1 << (bits - 1).bit_length())


def counting_bits(greatest: int) -> int:
    """Bits of the smallest machine integer that counts from 0 to `greatest`."""
    return storage_bits(max(1, greatest.bit_length()))


class _Number(msgspec.Struct, frozen=True, kw_only=True, dict=True, cache_hash=True):
    """A number of `bits` bits in `size` wire bytes of `byte_bits` bits each.

    A protocol has few of them, whose facts are asked for wherever a field is of such a type.
    """

    bits: int
    byte_bits: Literal[7, 8] = 8
    byte_order: ByteOrder = "little"
    """Meaningless, and always `little`, where `size` is 1."""
    extent: ClassVar[None] = None
    holds_values: ClassVar[bool] = True
    needs: ClassVar[frozenset[str]] = _NO_NAMES

    @property
    def unsigned(self) -> Integer:
        """The unsigned integer in the same bytes."""
        return Integer(bits=self.bits, byte_bits=self.byte_bits, byte_order=self.byte_order)

    @cached_property
    def width(self) -> int:
        """Bits of the smallest machine number that holds the value."""
        return storage_bits(self.bits)

    @cached_property
    def size(self) -> int:
        """Wire bytes."""
        return -(-self.bits // self.byte_bits)

    @cached_property
    def sizes(self) -> SizeSet:
        """Wire bytes, as a set."""
        return SizeSet.exactly(self.size)


class Numeral(msgspec.Struct, frozen=True, kw_only=True, cache_hash=True):
    """Text form of an integer: digits, as many each time, the most significant one first."""

    alphabet: bytes
    """Characters of the digits, in the order of their values."""
    size: int
    """Wire bytes."""

    @property
    def base(self) -> int:
        """How many digits there are."""
        return len(self.alphabet)

    @property
    def greatest(self) -> int:
        """The greatest number that has so many digits."""
        return int(self.base**self.size) - 1

    @property
    def known(self) -> str:
        """The name of the digits, such as `base10`; empty for characters in a row."""
        return next((name for name, own in ALPHABETS.items() if own == self.alphabet), "")

    @property
    def name(self) -> str:
        """What the digits are: `base10`, `base16-upper`, or `base64 from 0x30`."""
        return self.known or f"base{self.base} from 0x{self.alphabet[0]:02X}"


class BitPlace(msgspec.Struct, frozen=True, kw_only=True, cache_hash=True):
    """Place of an integer that is some bits of another one."""

    low: int
    """The lowest of these bits, counted from the least significant one."""
    size: int
    """Wire bytes of the other one."""


class FreeNumeral(msgspec.Struct, frozen=True, kw_only=True, cache_hash=True):
    """Text form of an integer: as many digits as it needs, or one character.

    It goes to the end of what is around it, or to the next separator.
    """

    base: Literal[10, 16, 256]
    """That of a character is 256."""
    front: int = 1
    """Digits in front of the point, at most."""
    padded: int = 1
    """Digits in front of the point, at least; with zeros where the number has fewer."""
    fraction: int = 0
    """Digits behind the point. The integer is as many powers of ten greater."""
    upper: bool = True
    """True if hexadecimal digits are written A to F."""
    separator: int | None = None
    """The byte that stands between this and what follows, if one does."""
    leads: bool = False
    """True if the separator also stands in front."""
    empty: bool = False
    """True if there may be no text."""

    @property
    def name(self) -> str:
        """The name in the schema language."""
        return {10: "decimal", 16: "hexadecimal", 256: "char"}[self.base]

    @property
    def label(self) -> str:
        """The form in the words of the schema language."""
        point = f".{self.fraction}" if self.fraction else ""
        case = "" if self.upper else " lower"
        count = "" if self.base == 256 else f"[{self.padded}..{self.front}{point}]{case}"
        place = f" behind {self.separator:02X}" if self.separator is not None and self.leads else ""
        return f"{self.name}{count}{place}{' or nothing' if self.empty else ''}"

    @property
    def greatest(self) -> int:
        """The greatest number that has so many digits."""
        return int(self.base ** (self.front + self.fraction)) - 1

    @property
    def absent(self) -> int:
        """What no text stands for, where there may be none: no digits have this value."""
        return 0 if self.base == 256 else self.greatest + 1

    @property
    def top(self) -> int:
        """The greatest integer that stands for anything."""
        return max(self.greatest, self.absent) if self.empty else self.greatest

    def longest(self, *, signed: bool) -> int:
        """Bytes of the longest text."""
        return signed + self.front + (self.fraction + 1 if self.fraction else 0)

    def sizes(self, *, signed: bool) -> SizeSet:
        """Wire bytes, with those of the separator in front."""
        return SizeSet.between(
            self.leads + (not self.empty), self.leads + self.longest(signed=signed)
        )

    def alphabet(self, *, signed: bool) -> bytes:
        """The characters that a decoder takes, without the separator."""
        if self.base == 256:
            return bytes(item for item in range(256) if item != self.separator)
        digits = b"0123456789" if self.base == 10 else b"0123456789ABCDEFabcdef"
        return digits + (b"." if self.fraction else b"") + (b"+-" if signed else b"")


def are_read_alike(one: Numeral | FreeNumeral | None, other: Numeral | FreeNumeral | None) -> bool:
    """True if a text that is a number in both forms has the same value in both."""
    if not isinstance(one, FreeNumeral) or not isinstance(other, FreeNumeral):
        return one == other
    forms = [
        (form.base, form.fraction, form.separator, form.leads, form.empty) for form in (one, other)
    ]
    return forms[0] == forms[1]


def are_spelled_alike(
    one: Numeral | FreeNumeral | None, other: Numeral | FreeNumeral | None
) -> bool:
    """True if a number that both forms can write has the same text in both."""
    if not isinstance(one, FreeNumeral) or not isinstance(other, FreeNumeral):
        return one == other
    return (one.padded, one.upper) == (other.padded, other.upper)


class Integer(_Number, frozen=True, kw_only=True, dict=True, cache_hash=True):
    """An integer. Bits above its own are zero; signed ones are two's complement in these bits."""

    signed: bool = False
    role: IntegerRole = "number"
    enum: Enum | None = None
    flags: Flags | None = None
    bit_fields: tuple[BitField, ...] = ()
    packed: bool = False
    """True if it has no bytes of its own: its bits lie among those of its neighbours."""
    text: Numeral | FreeNumeral | None = None
    """How it is written as text, if it is."""
    within: BitPlace | None = None
    """Where its bits lie, if they are those of another integer, whose bytes it shares."""

    @cached_property
    def size(self) -> int:
        """Wire bytes; none where it is packed, or where their number varies."""
        if self.within is not None:
            return self.within.size
        if isinstance(self.text, Numeral):
            return self.text.size
        return 0 if self.packed or self.is_free else -(-self.bits // self.byte_bits)

    @cached_property
    def sizes(self) -> SizeSet:
        """Wire bytes, as a set."""
        if isinstance(self.text, FreeNumeral):
            return self.text.sizes(signed=self.signed)
        return SizeSet.exactly(self.size)

    @property
    def whole(self) -> Integer:
        """All bits of the bytes in which its bits lie."""
        bits = self.byte_bits * self.size
        return Integer(bits=bits, byte_bits=self.byte_bits, byte_order=self.byte_order)

    @property
    def is_free(self) -> bool:
        """True if it is written as text of as many characters as it needs."""
        return isinstance(self.text, FreeNumeral)

    @property
    def takes_rest(self) -> bool:
        """True if nothing but the end of what is around it ends it."""
        return isinstance(self.text, FreeNumeral) and self.text.separator is None

    @property
    def characters(self) -> bytes:
        """The characters that its text can have; none where it is no text."""
        if isinstance(self.text, FreeNumeral):
            own = self.text.alphabet(signed=self.signed)
            if self.role == "char" and self.enum is not None and self.enum.closed:
                absent = {self.text.absent} if self.text.empty else set[int]()
                own = bytes(self.enum.characters - absent)
            return own + (bytes((self.text.separator,)) if self.text.separator is not None else b"")
        return b"" if self.text is None else self.text.alphabet

    @cached_property
    def name(self) -> str:
        """The name in the schema language, such as `sint14` or `char`."""
        if isinstance(self.text, FreeNumeral):
            return self.text.name
        kind = "sint" if self.signed else "uint"
        return f"{kind}{self.bits}" if self.role == "number" else self.role

    @property
    def label(self) -> str:
        """The type in the words of the schema language, such as `uint16 big`."""
        if isinstance(self.text, FreeNumeral):
            return self.text.label
        if self.text is not None:
            return f"{self.name} as {self.text.size} digits {self.text.name}"
        if self.within is not None:
            low, high = self.within.low, self.within.low + self.bits - 1
            return f"bit {low}" if low == high else f"bits {low}..{high}"
        plain = self.size <= 1 or self.is_text
        return self.name if plain else f"{self.name} {self.byte_order}"

    @property
    def is_text(self) -> bool:
        """True if people see it as characters."""
        return self.role == "ascii"

    @property
    def kind(self) -> MachineKind:
        """Kind of the machine number that holds the value."""
        if self.role == "bool":
            return "bool"
        return "int" if self.signed else "uint"

    @cached_property
    def machine_bounds(self) -> tuple[int, int]:
        """The least and the greatest value of the machine integer that holds the value."""
        greatest = (1 << (self.width - self.signed)) - 1
        return (-greatest - 1 if self.signed else 0), greatest

    @property
    def is_named(self) -> bool:
        """True if its values or its bits have names of their own type."""
        return self.enum is not None or self.flags is not None

    @cached_property
    def named_types(self) -> tuple[Enum | Flags, ...]:
        """The enums and flags that have names of their own."""
        found = (self.enum, self.flags, *(field.enum for field in self.bit_fields))
        return tuple(item for item in found if item is not None)

    def raw(self, value: float) -> int:
        """The number whose bits lie on the wire."""
        return int(value)

    @property
    def is_closed(self) -> bool:
        """True if only the values of a closed enum are valid."""
        return self.enum is not None and self.enum.closed

    @cached_property
    def least(self) -> int:
        """The least raw value that the wire can hold."""
        if isinstance(self.text, FreeNumeral):
            return -self.text.greatest if self.signed else 0
        return -(1 << (self.bits - 1)) if self.signed else 0

    @cached_property
    def greatest(self) -> int:
        """The greatest raw value that the wire can hold."""
        if isinstance(self.text, FreeNumeral):
            return self.text.top
        greatest = (1 << (self.bits - 1 if self.signed else self.bits)) - 1
        return greatest if self.text is None or self.signed else min(greatest, self.text.greatest)

    @property
    def is_bound_by_text(self) -> bool:
        """True if its digits hold less than its bits."""
        return self.is_free or (not self.signed and self.greatest < (1 << self.bits) - 1)

    def holds(self, value: int) -> bool:
        """True if the wire can hold `value`."""
        return self.least <= value <= self.greatest


class Float(_Number, frozen=True, kw_only=True, dict=True, cache_hash=True):
    """IEEE 754 binary32 or binary64."""

    bits: Literal[32, 64]
    signed: ClassVar[bool] = False
    role: ClassVar[IntegerRole] = "number"
    kind: ClassVar[MachineKind] = "float"
    enum: ClassVar[None] = None
    flags: ClassVar[None] = None
    bit_fields: ClassVar[tuple[()]] = ()
    named_types: ClassVar[tuple[()]] = ()
    is_closed: ClassVar[bool] = False
    text: ClassVar[None] = None
    within: ClassVar[None] = None
    is_text: ClassVar[bool] = False

    @property
    def greatest(self) -> Fraction:
        """The greatest finite number."""
        return Fraction((2 - 2**-23) * 2.0**127 if self.bits == 32 else sys.float_info.max)

    def raw(self, value: float) -> int:
        """The number whose bits lie on the wire."""
        form, size = ("<f", 4) if self.bits == 32 else ("<d", 8)
        return int.from_bytes(struct.pack(form, value)[:size], "little")

    @property
    def name(self) -> str:
        """The name in the schema language."""
        return f"float{self.bits}"

    @property
    def label(self) -> str:
        """The type in the words of the schema language."""
        return f"{self.name} {self.byte_order}"


ALPHABETS: Mapping[str, bytes] = {
    "base10": b"0123456789",
    "base16-upper": b"0123456789ABCDEF",
    "base16-lower": b"0123456789abcdef",
}
"""Digits by their names."""

NumberType = Integer | Float
"""A type of numbers."""


def characters(type_: Integer, between: tuple[int, int] | None = None) -> Characters:
    """Codec of an integer that people see as characters, which may be bound to some."""
    return Characters(type_.size, type_.byte_bits == 7, bytes(between or ()))


Codec = Number | WrittenNumeral | WrittenFreely
"""What encodes raw values and decodes them."""


@cache
def codec(type_: NumberType) -> Codec:
    """Codec of a number's raw value; of a float it is that of its bits."""
    form = type_.text
    if isinstance(form, FreeNumeral):
        between = None
        if form.separator is not None:
            between = Separated(form.separator, form.leads, form.empty)
        return WrittenFreely(
            form.base, form.front, form.padded, form.fraction, type_.signed, form.upper, between
        )
    if form is not None:
        return WrittenNumeral(type_.bits, form.alphabet, form.size, type_.signed)
    if type_.within is not None:
        within, seven_bit = type_.within, type_.byte_bits == 7
        return BitsNumber(type_.bits, within.low, within.size, type_.byte_order, seven_bit)
    return Number(type_.bits, type_.signed, type_.byte_order, seven_bit=type_.byte_bits == 7)
