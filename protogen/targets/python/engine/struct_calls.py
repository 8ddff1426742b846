"""Calls of struct that pack several numbers together."""

from __future__ import annotations

import msgspec

from protogen.targets.python.engine.lines import Lines


class Packed(msgspec.Struct, frozen=True):
    """A value for `struct`: the order of its bytes, its code, and an expression."""

    order: str
    code: str
    value: str


_TYPES_IN_LINE = 6


def batched(names: list[str]) -> list[list[str]]:
    """As many names as a line has room for."""
    return [names[i : i + _TYPES_IN_LINE] for i in range(0, len(names), _TYPES_IN_LINE)]


class Packer(msgspec.Struct):
    """Bytes that are being put together: what stands, and values that one `struct` is to write."""

    lines: Lines
    order: str = ""
    codes: str = ""
    values: list[str] = msgspec.field(default_factory=list)
    integers: list[str] = msgspec.field(default_factory=list)
    """Variables that have to be integers, and that `struct` does not get to see."""
    _pieces: list[str] = msgspec.field(default_factory=list)

    def pack(self, item: Packed) -> None:
        """Let `struct` write a value together with its neighbours."""
        if item.order and self.order and item.order != self.order:
            self.flush()
        self.order = self.order or item.order
        self.codes += item.code
        self.values.append(item.value)

    def piece(self, expression: str) -> None:
        """Put the bytes of an expression behind all others."""
        self.flush()
        self._pieces.append(expression)

    def flush(self) -> None:
        """Write the values that are due."""
        for some in batched(self.integers):
            types = " is ".join(f"type({name})" for name in some)
            several = len(some) > 1
            self.lines.refuse_if(f"not ({types} is int)" if several else f"{types} is not int")
        if self.codes:
            layout = f'"{self.order or "<"}{self.codes}"'
            pack = self.lines.constants.named("PACK", f"_struct.Struct({layout}).pack")
            self._pieces.append(f"{pack}({', '.join(self.values)})")
        self.order = self.codes = ""
        self.values, self.integers = [], []

    def all_pieces(self) -> list[str]:
        """Expressions of all bytes, in order."""
        self.flush()
        return self._pieces
