"""One difference between two versions of a protocol."""

from __future__ import annotations

import msgspec


class Mark(msgspec.Struct, frozen=True):
    """Some bits of a field's raw value, as a frame has to have them to show a change."""

    mask: int
    bits: int

    def on(self, raw: int) -> bool:
        """True if the raw value has these bits."""
        return raw & self.mask == self.bits

    def put(self, raw: int) -> int:
        """The raw value with these bits."""
        return raw & ~self.mask | self.bits


class Change(msgspec.Struct, frozen=True, kw_only=True):
    """A difference that has one rule."""

    rule: str
    """The name in `protogen.evolution.rules`."""
    place: str
    """Place of the change: `gyro.int_x`, `frame.checksum`, `enum axis`."""
    text: str
    """The change in words: `from uint16 little to uint16 big`."""
    message: str | None = None
    """The message, by its name in OLD where it has one; None for what concerns all."""
    sender: str | None = None
    """The sender, by its name in OLD; None for every one that has the message."""
    path: str | None = None
    """The field in the message: `encoders` or `limits.upper`."""
    now: str | None = None
    """The path in NEW of a field that has another name there."""
    run: str | None = None
    """The run of bits in the field."""
    names: tuple[str | None, str | None] = (None, None)
    """A value or a flag by its names in OLD and NEW; None where it has none."""
    marks: tuple[Mark | None, Mark | None] = (None, None)
    """Content of the field in frames of OLD and of NEW that show the change; None for anything."""
    selector: str | None = None
    """The field, beside or around this one, that holds what the marks are of."""
    is_lost: bool = False
    """True if the thing with the marks is only not known by its name any more."""
    part: str | None = None
    """The part of the frame, by its name in OLD where it has one."""
    old_part: str | None = None
    new_part: str | None = None
    """The names of a frame's part that has another one now."""
    taken_by: tuple[str, ...] = ()
    """Messages of NEW that have this one's identity."""
    places: tuple[str, ...] = msgspec.field(default=())
    """Other places with the same change, as an enum has that several fields use."""


def named(old: str, new: str) -> str:
    """The words for a value that changed."""
    return f"from {old} to {new}"
