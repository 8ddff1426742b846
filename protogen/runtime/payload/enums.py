"""Enums and flags that keep what the schema has no name for."""

from __future__ import annotations

from enum import KEEP, IntEnum, IntFlag
from typing import Any, Self

KEPT = 4096
"""Members without a name that are kept; what comes off a wire must not fill the memory."""


class OpenEnum(IntEnum):
    """Names of raw values; a value without a name is kept as a member called `UNKNOWN_value`.

    >>> class Mode(OpenEnum):
    ...     IDLE = 0
    >>> Mode(7)
    <Mode.UNKNOWN_7: 7>
    >>> Mode(7) == 7, Mode(7).is_known, Mode.IDLE.is_known
    (True, False, True)
    """

    @classmethod
    def _missing_(cls, value: object) -> Self | None:
        if not isinstance(value, int):
            return None
        # Such members are not remembered, as those of flags are until there are many.
        member = int.__new__(cls, value)
        member._name_ = f"UNKNOWN_{value}"
        member._value_ = int(value)
        return member

    def __reduce_ex__(self, protocol: object) -> tuple[type[Self], tuple[int]]:
        return type(self), (int(self),)

    @property
    def is_known(self) -> bool:
        """True if the schema names this value."""
        return self._name_ in type(self).__members__


class Flags(IntFlag, boundary=KEEP):
    """Names of single bits; bits without a name are kept."""

    @classmethod
    def _missing_(cls, value: object) -> Any:
        remembered = cls._value2member_map_
        before = len(remembered)
        member = super()._missing_(value)
        while len(remembered) > max(before, KEPT):
            remembered.popitem()  # What came last.
        return member

    @property
    def unknown(self) -> int:
        """The bits that the schema has no name for."""
        known = 0
        for member in type(self):
            known |= int(member)
        return int(self) & ~known
