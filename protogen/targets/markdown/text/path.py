"""Path of a field inside its message."""

from __future__ import annotations

import msgspec


class Path(msgspec.Struct, frozen=True):
    """The names that lead to a field, as people write them and as an anchor."""

    shown: str = ""
    anchor: str = ""
    """Unlike `shown` it tells the cases of a switch apart, which may have fields of one name."""

    def field(self, name: str) -> Path:
        """Return the path of a field."""
        return Path(f"{self.shown}.{name}" if self.shown else name, f"{self.anchor}-{name}")

    def element(self) -> Path:
        """Return the path of an element of an array."""
        return Path(f"{self.shown}[i]", self.anchor)

    def case(self, name: str) -> Path:
        """Return the path of one case of a switch."""
        return Path(self.shown, f"{self.anchor}-{name}")


ROOT = Path()
"""The path of the message itself."""
