"""Integers of 1 to 64 bits as bytes on the wire."""

from __future__ import annotations

import operator
from collections.abc import Iterable
from typing import Literal

from protogen.runtime.errors import ByteError, EncodeError
from protogen.runtime.values import Frozen

ByteOrder = Literal["little", "big"]

GivenValue = int | str | None
"""Value of a part as callers give it. None: they give none."""

BYTES = tuple(bytes((byte,)) for byte in range(256))
"""Each byte by its value."""


class Number(Frozen):
    """An integer of `bits` bits in as few whole bytes as hold it.

    A byte carries 8 bits, or with `seven_bit` 7 bits below a clear most significant bit. The bits
    above `bits` are zero, also for signed integers, which are two's complement in `bits` bits.
    """

    __slots__ = ("bits", "order", "seven_bit", "signed", "size")

    bits: int
    signed: bool
    order: ByteOrder
    seven_bit: bool
    size: int
    """Bytes on the wire."""

    def __init__(
        self, bits: int, signed: bool = False, order: ByteOrder = "little", seven_bit: bool = False
    ) -> None:
        self._set(bits, signed, order, seven_bit)
        object.__setattr__(self, "size", -(-bits // (7 if seven_bit else 8)))

    @property
    def least(self) -> int:
        """The least value that the bits can hold."""
        return -(1 << (self.bits - 1)) if self.signed else 0

    @property
    def greatest(self) -> int:
        """The greatest value that the bits can hold."""
        return (1 << (self.bits - self.signed)) - 1

    def encode(self, value: int) -> bytes:
        """The bytes for `value`. Raises ValueError if it is no integer that the bits can hold."""
        return _bytes_of(self.raw_of(value), self.size, self.order, self.seven_bit)

    def decode(self, data: bytes) -> int:
        """The value of `size` bytes. Raises ByteError where no value has these bytes."""
        raw = _integer_of(data, self.order, self.seven_bit)
        if raw >> self.bits:
            raise ByteError("value", f"the bits above the lowest {self.bits} have to be zero")
        return self.value_of(raw)

    def raw_of(self, value: int) -> int:
        """The bits for `value`. Raises ValueError if it is no integer that they can hold."""
        value = as_integer(value)
        if not self.least <= value <= self.greatest:
            raise ValueError(f"{value} is not in {self.least}..{self.greatest}")
        return value & ((1 << self.bits) - 1)

    def value_of(self, raw: int) -> int:
        """The value that has these bits."""
        return raw - (1 << self.bits) if self.signed and raw >> (self.bits - 1) else raw


class BitsNumber(Number):
    """An integer of `bits` bits, from `low` on, of an integer of `size` bytes.

    Its bytes have nothing but its own bits; in bytes that are read, the others may be anything.
    """

    __slots__ = ("low",)

    low: int

    def __init__(
        self, bits: int, low: int, size: int, order: ByteOrder = "little", seven_bit: bool = False
    ) -> None:
        fields = {"bits": bits, "signed": False, "order": order, "seven_bit": seven_bit}
        for name, value in {**fields, "size": size, "low": low}.items():
            object.__setattr__(self, name, value)

    def encode(self, value: int) -> bytes:
        """The bytes with the bits of `value`. Raises ValueError if they can't hold it."""
        return _bytes_of(self.raw_of(value) << self.low, self.size, self.order, self.seven_bit)

    def decode(self, data: bytes) -> int:
        """The value of the bits in `size` bytes."""
        raw = _integer_of(data, self.order, self.seven_bit)
        return raw >> self.low & self.greatest


class Characters(Number):
    """An integer of which each byte is a character, the first one the highest.

    To people it is a text of up to `size` characters, which zeros fill up. With `between`, each of
    exactly so many is from the first to the second of these two.
    """

    __slots__ = ("between",)

    between: bytes

    def __init__(self, size: int, seven_bit: bool = False, between: bytes = b"") -> None:
        bits = size * (7 if seven_bit else 8)
        fields = {"bits": bits, "signed": False, "order": "big", "seven_bit": seven_bit}
        for name, value in {**fields, "size": size, "between": between}.items():
            object.__setattr__(self, name, value)

    @property
    def allowed(self) -> str:
        """The characters that may be, in words."""
        return f"{self.size} characters from {' to '.join(map(_shown, self.between))}"

    def holds(self, number: int) -> bool:
        """True if all characters of a number are between those that may be."""
        if not self.between:
            return True
        first, last = self.between
        return all(first <= character <= last for character in self.encode(number))

    def text(self, number: int) -> str:
        """The characters of a number."""
        return self.encode(number).decode("latin-1").rstrip("\0")

    def number(self, text: object) -> int:
        """The number of some characters. Raises EncodeError where there are too many."""
        if not isinstance(text, str):
            raise EncodeError("", f"must be a text of {self.size} characters, not {text!r}")
        greatest = "\x7f" if self.seven_bit else "\xff"
        if any(character > greatest for character in text):
            raise EncodeError("", f"{text!r} has a character that is not one byte")
        if len(text) > self.size:
            raise EncodeError("", f"{text!r} has {len(text)} characters, and {self.size} fit")
        return self.decode(text.encode("latin-1").ljust(self.size, b"\0"))


def _shown(code: int) -> str:
    """A character of ASCII as such if it can be seen, else its number."""
    seen = chr(code)
    return seen if seen.isprintable() and seen not in ' "\\' else f"0x{code:02X}"


def given_number(number: object, value: object) -> int:
    """The number that a caller gives, which may be a text. Raises EncodeError."""
    return number.number(value) if isinstance(number, Characters) else as_integer(value)


def as_integer(value: object) -> int:
    """The integer that a value is to Python: an int, a bool, an enum's member, one of NumPy's.

    Raises EncodeError for anything else, floats and texts of numbers among them.
    """
    try:
        return operator.index(value)  # type: ignore[arg-type]
    except TypeError:
        raise EncodeError("", f"must be an integer, not {value!r}") from None


def _bytes_of(raw: int, size: int, order: ByteOrder, seven_bit: bool) -> bytes:
    """The bytes of an unsigned integer that fits them."""
    if not seven_bit:
        return raw.to_bytes(size, order)
    groups = bytes((raw >> shift) & 0x7F for shift in range(0, 7 * size, 7))
    return groups if order == "little" else groups[::-1]


def _integer_of(data: bytes, order: ByteOrder, seven_bit: bool) -> int:
    """The unsigned integer of some bytes. Raises ByteError where 7-bit bytes have an eighth bit."""
    if seven_bit:
        return _join_groups(data if order == "big" else reversed(data))
    return int.from_bytes(data, order)


def _join_groups(groups: Iterable[int]) -> int:
    """The integer of 7-bit groups, most significant first."""
    raw = 0
    for group in groups:
        if group > 0x7F:
            raise ByteError("encoding", f"{group:02X} has its most significant bit set")
        raw = raw << 7 | group
    return raw
