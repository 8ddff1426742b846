"""Integers written as text: digits, as many each time."""

from __future__ import annotations

from protogen.runtime.errors import ByteError
from protogen.runtime.payload.number import Number
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
