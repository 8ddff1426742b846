"""Text in a fixed number of bytes, with padding behind it."""

from __future__ import annotations

from functools import cache

from protogen.runtime.errors import ByteError
from protogen.runtime.values import Frozen


class PaddedText(Frozen):
    """Text of at most `size` characters, with as many of `padding` behind it as are missing.

    A character has `bits` bits (with 8 it is any byte). On the wire it is shifted left by `shift`
    bits, and `add` is added. NUL is no character of a text that has another padding.
    """

    __slots__ = ("_foreign", "_texts", "_wires", "add", "bits", "padding", "shift", "size")

    size: int
    """Bytes on the wire."""
    padding: int
    """The character, as it is before it is shifted."""
    bits: int
    shift: int
    add: int
    _texts: bytes
    """The character of each byte."""
    _wires: bytes
    """The byte of each character."""
    _foreign: bytes
    """All bytes that are no character."""

    def __init__(
        self, size: int, padding: int = 0, bits: int = 8, shift: int = 0, add: int = 0
    ) -> None:
        self._set(size, padding, bits, shift, add)
        texts, wires, foreign = _tables(padding, bits, shift, add)
        object.__setattr__(self, "_texts", texts)
        object.__setattr__(self, "_wires", wires)
        object.__setattr__(self, "_foreign", foreign)

    def encode(self, text: str) -> bytes:
        """The bytes of a text. Raises ValueError where there are none."""
        fault = self.fault_of(text)
        if fault or len(text) > self.size:
            raise ValueError(fault or f"{text!r} has more than {self.size} characters")
        characters = text.encode("latin-1").ljust(self.size, bytes((self.padding,)))
        return characters.translate(self._wires)

    def decode(self, data: bytes) -> str:
        """The text without its padding. Raises ByteError where a byte is no character."""
        if self._foreign:
            place = self.first_foreign(data)
            if place is not None:
                raise ByteError("value", f"{data[place]:02X} is no character of this text")
        characters = data.translate(self._texts).rstrip(bytes((self.padding,)))
        return characters.decode("latin-1")

    def first_foreign(self, data: bytes) -> int | None:
        """The place of the first byte that is no character; None where all are."""
        if len(data.translate(None, self._foreign)) == len(data):
            return None
        return next(index for index, byte in enumerate(data) if byte in self._foreign)

    def fault_of(self, text: str) -> str:
        """The reason that a decoder would not read a text again; empty where it would."""
        if text.endswith(chr(self.padding)):
            return f"ends with {self._padding_name}, which a receiver takes for padding"
        return self.foreign_in(text)

    def foreign_in(self, text: str) -> str:
        """The reason that a character of a text has no byte; empty where all have one."""
        for index, character in enumerate(text):
            place = f"{character!r}, character {index + 1} of {len(text)}, is none"
            if ord(character) >= 1 << self.bits:
                return f"must be characters up to U+{(1 << self.bits) - 1:04X}; {place}"
            if self.padding and character == "\0":
                return f"has NUL, which no text has whose padding is {self._padding_name}"
        return ""

    @property
    def _padding_name(self) -> str:
        return {0: "NUL", 0x20: "a blank"}.get(self.padding, repr(chr(self.padding)))


@cache
def _tables(padding: int, bits: int, shift: int, add: int) -> tuple[bytes, bytes, bytes]:
    """The character of each byte, the byte of each character, and the bytes that are none."""
    texts, wires, foreign = bytearray(256), bytearray(256), set(range(256))
    for character in range(1 << bits):
        wires[character] = byte = (character << shift) + add
        texts[byte] = character
        if character or not padding:
            foreign.discard(byte)
    return bytes(texts), bytes(wires), bytes(sorted(foreign))
