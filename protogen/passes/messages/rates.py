"""How often messages are sent by themselves, and whether the line has room for them."""

from __future__ import annotations

from fractions import Fraction

from protogen.model.load import Load, RatedFrame, load_of
from protogen.passes.context import Context, Loc
from protogen.passes.draft import Draft
from protogen.passes.framing.silences import character_time
from protogen.problems import hint_for
from protogen.schema.syntax.base import RATE_UNITS, rate_hertz, rate_number


def rate_of(context: Context, message: Loc, written: str | None) -> Fraction | None:
    """The rate of a message in Hz; None where it has none, or one that can't be."""
    if written is None:
        return None
    number, unit = rate_number(written)
    loc = (*message, "rate")
    if unit not in RATE_UNITS:
        hint = hint_for(unit, [name for name in RATE_UNITS if name])
        text = f"`{unit}` is no unit of how often, nor of a time"
        context.error("PG331", loc, text, hint or "write 50 Hz, or the time between, such as 20 ms")
    elif number <= 0:
        text = f"`{written}` says that it is never sent"
        context.error("PG330", loc, text, "leave `rate` out where nothing is sent by itself")
    return rate_hertz(written)


def check_load(context: Context, draft: Draft) -> None:
    """Check that the line has room for all that an endpoint sends by itself."""
    character = character_time(context)
    endpoints = dict.fromkeys(context.frames[sender].endpoint for sender in draft.framings)
    for endpoint in endpoints:
        found = _load(context, draft, endpoint, character)
        if found is not None and found.least > 1:
            rated = [item for item in draft.messages.values() if item.rate is not None]
            last = next(item for item in reversed(rated) if endpoint in item.senders)
            text = f"with this, what {endpoint} sends by itself takes {found.shown} of the line"
            hint = "send it less often, or give the `link` a higher `baud`"
            context.warning("PG332", ("messages", last.name, "rate"), text, hint)


def _load(context: Context, draft: Draft, endpoint: str, character: Fraction | None) -> Load | None:
    frames = [
        RatedFrame.of(draft.messages[item.message], item, draft.frames[sender])
        for sender, framing in draft.framings.items()
        if context.frames[sender].endpoint == endpoint
        for item in framing.messages
    ]
    return load_of(frames, character)
