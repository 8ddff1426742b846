"""Place in a payload that is being checked, of which some bytes are known to be there."""

from __future__ import annotations

from protogen.c_language.numbers import unsigned
from protogen.targets.c.lines import Lines
from protogen.targets.c.payload.helpers import Helpers
from protogen.targets.c.payload.walk import RESERVED, Walk


class CheckedWalk(Walk):
    """A walk over `payload`, whose `size` bytes may be too few.

    With `needs`, a pointer `need` is told, unless it is NULL, how many bytes there have to be at
    least. A message of a fixed size has all of its bytes; the function's head has seen to that.
    """

    def __init__(
        self, helpers: Helpers, lines: Lines, prefix: str, *, fixed: bool, needs: bool
    ) -> None:
        super().__init__(helpers, lines)
        self._error = f"return {prefix.upper()}_ERROR_"
        self._locals = set(RESERVED)
        self._fixed = fixed
        self._needs = needs
        self._at = ""
        self._offset = 0
        self._secured = 0  # Bytes behind `at` that are known to be there.
        self._unchecked: int | None = None  # Where bytes begin whose top bits are to be checked.

    # --- positions ------------------------------------------------------------------------------

    def _sum(self, offset: int) -> str:
        if not self._at:
            return str(offset)
        return f"{self._at} + {unsigned(offset)}" if offset else self._at

    def _byte(self, index: int = 0) -> str:
        return f"payload[{self._sum(self._offset + index)}]"

    def _address(self, offset: int | None = None) -> str:
        total = self._sum(self._offset if offset is None else offset)
        return "payload" if total == "0" else f"payload + {total}"

    def _require(self, size: int, extra: str = "") -> None:
        """Go on only if so many bytes more are there."""
        due = self._offset + size
        if self._fixed or (not extra and due <= self._secured):
            return
        here = f"size - {self._at}" if self._at else "size"
        amount = " + ".join(filter(None, [unsigned(due) if due or not extra else "", extra]))
        with self.lines.block(f"if ({here} < {amount})"):
            if self._needs:
                end = f"{self._at} + {amount}" if self._at else amount
                self.lines.add(f"return {self.helpers.missing()}(need, {end});")
            else:
                self.lines.add(f"{self._error}SIZE;")
        if not extra:
            self._secured = due

    def _settle(self) -> None:
        """Have `at` stand at the place itself; all bytes in front of it are there."""
        self._flush()
        self._require(0)
        self._move(self._offset)

    def _move(self, distance: int | str) -> None:
        if not self._at:
            self.lines.add(f"size_t at = {distance};")
            self._at = "at"
        elif distance:
            amount = unsigned(distance) if isinstance(distance, int) else distance
            self.lines.add(f"at += {amount};")
        passed = distance if isinstance(distance, int) else 0
        self._secured = max(0, self._secured - passed) if isinstance(distance, int) else 0
        self._offset = 0

    # --- most significant bits ------------------------------------------------------------------

    def _seven_bit(self, size: int) -> None:
        """Have the top bits of so many bytes checked, at the latest before anything else is."""
        if self._unchecked is None:
            self._unchecked = self._offset
        if not self._fixed:
            self._flush(size)

    def _begin(self, byte_bits: int) -> None:
        """Begin a value of such bytes."""
        if byte_bits == 8:
            self._flush()

    def _flush(self, size: int = 0) -> None:
        start = self._unchecked
        self._unchecked = None
        end = self._offset + size
        if start is None or start == end:
            return
        if end - start == 1:
            self._refuse(f"payload[{self._sum(start)}] > 0x7FU", "ENCODING")
            return
        check = self.helpers.seven_bit()
        self._refuse(f"!{check}({self._address(start)}, {end - start})", "ENCODING")

    def _refuse(self, condition: str, reason: str) -> None:
        if condition:
            with self.lines.block(f"if ({condition})"):
                self.lines.add(f"{self._error}{reason};")
