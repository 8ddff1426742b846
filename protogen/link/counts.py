"""What a link has seen and sent."""

from __future__ import annotations

from collections import Counter
from typing import Any

import msgspec

from protogen.runtime.events import Event, MessageEvent


def name_of(event: Event[Any, Any]) -> str:
    """What an event counts as: the message, `unknown`, or `invalid` with its reason."""
    if isinstance(event, MessageEvent):
        name: str = event.message.NAME
        return name
    return event.kind if event.kind == "unknown" else f"invalid: {event.reason}"


class LinkCounts(msgspec.Struct):
    """Counts since a link was opened."""

    received: Counter[str] = msgspec.field(default_factory=Counter)
    """Events: messages by name, `unknown`, and `invalid: REASON`."""
    sent: Counter[str] = msgspec.field(default_factory=Counter)
    """Frames by message, each repetition among them."""
    bytes_received: int = 0
    replies: int = 0
    """Requests that were answered."""
    refusals: int = 0
    """Requests that were refused."""
    unanswered: int = 0
    """Requests that nothing answered."""
    retries: int = 0
    """Repetitions of requests."""
    late: int = 0
    """Answers to what was settled or given up before."""
    losses: int = 0
    """How often the port was lost."""
