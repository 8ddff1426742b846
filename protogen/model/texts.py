"""How texts of a fixed size lie in their bytes."""

from __future__ import annotations

import json
from typing import Literal

import msgspec

from protogen.runtime.payload.texts import PaddedText


class TextForm(msgspec.Struct, frozen=True, kw_only=True):
    """How the characters of a text of a fixed size lie in its bytes, and what stands behind them.

    NUL is no character of a text with another padding, and each byte that stands for none is wrong.
    """

    padding: int = 0
    """The character that fills a shorter text up."""
    bits: Literal[7, 8] = 8
    """Bits of a character; with 8 it is any byte."""
    shift: int = 0
    """Bits by which a character is shifted left."""
    add: int = 0
    """What is added to that."""

    @property
    def label(self) -> str:
        """What it says of bytes, such as `7 bits << 1, padding " "`; empty of plain text."""
        code = f"{self.bits} bits" if self.bits < 8 else ""
        code = f"{code} << {self.shift}" if self.shift else code
        if self.add:
            code = f"({code}) + 0x{self.add:02X}" if self.shift else f"{code} + 0x{self.add:02X}"
        padding = f"padding {json.dumps(chr(self.padding))}" if self.padding else ""
        return ", ".join(filter(None, (code, padding)))

    @property
    def is_plain(self) -> bool:
        """True if each byte is a character as it is, and NUL the padding."""
        return self == PLAIN_TEXT

    @property
    def alphabet(self) -> frozenset[int]:
        """The bytes that stand for a character."""
        first = 1 if self.padding else 0
        return frozenset((item << self.shift) + self.add for item in range(first, 1 << self.bits))

    def codec(self, size: int) -> PaddedText:
        """What reads and writes such a text of so many bytes."""
        return PaddedText(size, self.padding, self.bits, self.shift, self.add)


PLAIN_TEXT = TextForm()
"""Each byte is a character as it is, and NUL the padding."""
