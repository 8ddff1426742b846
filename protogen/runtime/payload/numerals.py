"""Integers written as text."""

from __future__ import annotations

from typing import Literal

from protogen.runtime.errors import ByteError
from protogen.runtime.payload.number import Number, as_integer
from protogen.runtime.values import Frozen


class Numeral(Frozen):
    """An integer of `bits` bits as `size` digits, the most significant one first.

    `alphabet` has the characters of the digits, in the order of their values; so it says the base.
    A signed integer is two's complement in its bits.
    """

    __slots__ = ("_number", "_values", "alphabet", "bits", "signed", "size")

    bits: int
    alphabet: bytes
    size: int
    """Bytes on the wire."""
    signed: bool
    _number: Number
    _values: dict[int, int]
    """Each digit's value."""

    def __init__(self, bits: int, alphabet: bytes, size: int, signed: bool = False) -> None:
        self._set(bits, alphabet, size, signed)
        object.__setattr__(self, "_number", Number(bits, signed))
        values = {character: value for value, character in enumerate(alphabet)}
        object.__setattr__(self, "_values", values)

    def encode(self, value: int) -> bytes:
        """The digits of `value`. Raises ValueError if it is no integer that they can hold."""
        rest, digits = self._number.raw_of(value), bytearray(self.size)
        for place in reversed(range(self.size)):
            rest, digit = divmod(rest, len(self.alphabet))
            digits[place] = self.alphabet[digit]
        if rest:
            raise ValueError(f"{value} has more than {self.size} digits")
        return bytes(digits)

    def decode(self, data: bytes) -> int:
        """The value of `size` digits. Raises ByteError where no value has them."""
        raw = 0
        for character in data:
            digit = self._values.get(character)
            if digit is None:
                raise ByteError("value", f"{character:02X} is no digit here")
            raw = raw * len(self.alphabet) + digit
        if raw >> self.bits:
            raise ByteError("value", f"{raw} does not fit {self.bits} bits")
        return self._number.value_of(raw)


class Separated(Frozen):
    """Surroundings of a text: a `separator` ends it; with `leads` one stands in front of it.

    With `empty` there may be nothing between two separators.
    """

    __slots__ = ("empty", "leads", "separator")

    separator: int
    leads: bool
    empty: bool

    def __init__(self, separator: int, leads: bool = False, empty: bool = False) -> None:
        self._set(separator, leads, empty)


class FreeNumeral(Frozen):
    """An integer as decimal or hexadecimal digits, as many as it needs, or as one character.

    `front` digits at most stand in front of the point and at least `padded`, with zeros where the
    number has fewer; with a `fraction` so many stand behind the point, and the integer is as many
    powers of ten greater than what is written. A decoder takes whatever means the same and is no
    longer than the longest number: fewer digits, other zeros, a plus, letters of the other case.
    In base 256 the only digit is a character.

    The text ends where the bytes do, or, if it is `separated`, in front of a separator. Where it
    may be empty, having no text is the integer `absent`.
    """

    __slots__ = (
        "absent", "base", "fraction", "front", "greatest", "longest", "padded", "separated",
        "signed", "upper",
    )  # fmt: skip

    base: Literal[10, 16, 256]
    front: int
    padded: int
    fraction: int
    signed: bool
    upper: bool
    """Case of hexadecimal digits."""
    separated: Separated | None
    greatest: int
    """The greatest integer that so many digits stand for."""
    longest: int
    """Bytes of the longest text."""
    absent: int
    """What no text stands for, where there may be none: no digits have this value."""

    def __init__(
        self,
        base: Literal[10, 16, 256],
        front: int = 1,
        padded: int = 1,
        fraction: int = 0,
        signed: bool = False,
        upper: bool = True,
        separated: Separated | None = None,
    ) -> None:
        self._set(base, front, padded, fraction, signed, upper, separated)
        object.__setattr__(self, "greatest", base ** (front + fraction) - 1)
        longest = signed + front + (fraction + 1 if fraction else 0)
        object.__setattr__(self, "longest", longest)
        object.__setattr__(self, "absent", 0 if base == 256 else self.greatest + 1)

    def encode(self, value: int) -> bytes:
        """The number as an encoder writes it. Raises ValueError if it has too many digits."""
        value = as_integer(value)
        between = self.separated
        front = bytes((between.separator,)) if between and between.leads else b""
        if between and between.empty and value == self.absent:
            return front
        least = -self.greatest if self.signed else 0
        if not least <= value <= self.greatest:
            raise ValueError(f"{value} is not in {least}..{self.greatest}")
        return front + self._written(value)

    def _written(self, value: int) -> bytes:
        if self.base == 256:
            return bytes((value,))
        form = "d" if self.base == 10 else "X" if self.upper else "x"
        digits = f"{abs(value):0{self.padded + self.fraction}{form}}"
        if self.fraction:
            digits = f"{digits[: -self.fraction]}.{digits[-self.fraction :]}"
        return f"{'-' if value < 0 else ''}{digits}".encode()

    def decode(self, data: bytes) -> int:
        """The integer that is written. Raises ByteError where nothing means one."""
        value, end = self.take(data)
        if end < len(data):
            raise ByteError("size", f"{data[end:]!r} is left behind the number")
        return value

    def take(self, data: bytes, at: int = 0) -> tuple[int, int]:
        """The integer that is written there, and the place behind it. Raises ByteError."""
        between = self.separated
        if between is None:
            return self._value(data[at:], may_be_empty=False), len(data)
        if between.leads:
            if at >= len(data):
                raise ByteError("size", "the separator in front is missing")
            if data[at] != between.separator:
                raise ByteError("value", f"{data[at]:02X} is not the separator")
            at += 1
        end = data.find(between.separator, at)
        end = len(data) if end < 0 else end
        return self._value(data[at:end], may_be_empty=between.empty), end

    def _value(self, text: bytes, *, may_be_empty: bool) -> int:
        if not text and may_be_empty:
            return self.absent
        if not 1 <= len(text) <= self.longest:
            needed = "1 character" if self.longest == 1 else f"1 to {self.longest} characters"
            raise ByteError("size", f"needs {needed}, not {len(text)}")
        if self.base == 256:
            if may_be_empty and text[0] == self.absent:
                raise ByteError("value", "this character stands for none")
            return text[0]
        digits = text[1:] if self.signed and text[:1] in (b"+", b"-") else text
        front, _, behind = digits.partition(b".") if self.fraction else (digits, b"", b"")
        own, zeros = behind[: self.fraction], behind[self.fraction :]
        if not self._are_digits(front + own) or zeros.strip(b"0"):
            raise ByteError("value", f"{text!r} is no number here")
        value = int((front + own.ljust(self.fraction, b"0")), self.base)
        if value > self.greatest:
            raise ByteError("value", f"{text!r} has too many digits")
        return -value if text[:1] == b"-" else value

    def _are_digits(self, text: bytes) -> bool:
        """True if there are some, and nothing else."""
        if self.base == 10:
            return text.isdigit()
        return bool(text) and not text.translate(None, b"0123456789ABCDEFabcdef")
