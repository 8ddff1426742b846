"""What a generated file is for: events that a handler takes, or rows of tables."""

from __future__ import annotations

from collections.abc import Mapping

import msgspec


class Fill(msgspec.Struct, frozen=True):
    """The functions that take what a decoder finds, and what frames are made of."""

    deliver: str
    """The function that takes any event, called with the decoder's `user` and the event."""
    messages: Mapping[str, str] | None = None
    """Functions that write the row of a message, called with the decoder and an event without a
    kind, by the message's name; None where all events go to `deliver`."""
    storage: str = "static"
    """Words in front of the function that takes whole frames."""
    strict: bool = True
    """False if frames are made again of what came in, whatever an encoder would refuse of it."""


EVENTS = Fill("decoder->handler")
