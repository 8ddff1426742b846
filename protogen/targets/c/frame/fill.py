"""Output of a decoder: events that it hands to its handler, or rows of tables."""

from __future__ import annotations

from collections.abc import Mapping

import msgspec


class Fill(msgspec.Struct, frozen=True):
    """The functions that take what a decoder finds."""

    deliver: str
    """The function that takes any event, called with the decoder's `user` and the event."""
    messages: Mapping[str, str] | None = None
    """Functions that write the row of a message, called with the decoder and an event without a
    kind, by the message's name; None where all events go to `deliver`."""
    storage: str = "static"
    """Words in front of the function that takes whole frames."""


EVENTS = Fill("decoder->handler")
