"""Place of a printed function in the bytes that it reads."""

from __future__ import annotations

import msgspec


class Place(msgspec.Struct):
    """A place in `data`: a variable, where the bytes before vary in size, and a number."""

    variable: str = ""
    offset: int = 0

    @property
    def text(self) -> str:
        """The place as an expression."""
        if not self.variable:
            return str(self.offset)
        return f"{self.variable} + {self.offset}" if self.offset else self.variable

    @property
    def grouped(self) -> str:
        """The same, in brackets where it is a sum."""
        return f"({self.text})" if self.variable and self.offset else self.text
