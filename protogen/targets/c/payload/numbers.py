"""Numbers that count and select, as expressions of C."""

from __future__ import annotations

from dataclasses import dataclass

from protogen.model.types import Integer


@dataclass(frozen=True, slots=True)
class Number:
    """A number that was read, or is in a member."""

    expression: str
    type: Integer

    @property
    def count(self) -> str:
        """The number as one of elements or bytes."""
        return f"(size_t){self.expression}" if self.type.bits > 16 else self.expression

    @property
    def selector(self) -> str:
        """The number as what a switch is over."""
        return f"(uint8_t){self.expression}" if self.type.role == "bool" else self.expression


Scope = dict[str, "int | Number"]
"""The numbers in front, some of which are constants."""
