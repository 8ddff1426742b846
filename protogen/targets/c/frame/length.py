"""The length part, as a receiver reads it."""

from __future__ import annotations

import msgspec

from protogen.model.frame_plan import FramePlan
from protogen.targets.c.spelling import unsigned_type


class LengthView(msgspec.Struct, frozen=True):
    """The length part."""

    least: int
    greatest: int
    bits: int
    base: int
    """The value for a payload of no bytes."""
    optional: int
    """Bytes that it counts only where there is a payload."""
    payload: int
    """The greatest payload."""

    @property
    def type(self) -> str:
        """The type of the value."""
        return unsigned_type(max(self.bits, 16))

    @property
    def wrapping(self) -> str:
        """The type in which the size of a payload that is too short turns out too great."""
        is_narrow = self.bits <= 8 and self.base + self.payload < 256
        return "uint8_t" if is_narrow else self.type

    def size_of(self, length: str) -> str:
        """The payload's size, in the wrapping type."""
        return f"({self.wrapping})({length} - {self.base}U)" if self.base else length

    def tests(self, size: str) -> str:
        """The condition that `length`, or the payload's size after it, is none that a frame has."""
        most = (1 << (8 if self.wrapping == "uint8_t" else self.bits)) - 1
        found = []
        if self.least > self.base:
            found.append(f"length < {self.least}U")
        if self.greatest < min(self.base + self.payload, (1 << self.bits) - 1):
            found.append(f"length > {self.greatest}U")
        if self.payload < most or self.base:
            found.append(f"{size} > {self.payload}U")
        return " || ".join(found)

    @property
    def impossible(self) -> str:
        """The condition of the same where nothing wraps: `size` still counts the other parts."""
        found = []
        if self.least > 0:
            found.append(f"length < {self.least}U")
        if self.greatest < (1 << self.bits) - 1:
            found.append(f"length > {self.greatest}U")
        if self.base:
            found.append(f"size < {self.base}U")
        return " || ".join([*found, f"size - {self.base}U > {self.payload}U"])


def length_of(plan: FramePlan) -> LengthView | None:
    """The view of a frame's length part."""
    if plan.length is None:
        return None
    part = plan.length.part
    held = part.type.byte_bits * part.type.size
    return LengthView(
        least=part.least,
        greatest=min(part.greatest, (1 << held) - 1),
        bits=held,
        base=plan.length.base,
        optional=plan.length.optional,
        payload=plan.payload.greatest,
    )
