"""Payloads whose zeros at the end are left out: what a receiver needs to put them there again."""

from __future__ import annotations

from protogen.model.frame import Frame
from protogen.passes.context import Context, Loc
from protogen.passes.draft import Draft
from protogen.passes.framing.capacity import stated_range
from protogen.passes.framing.fitting import check_overloads, has_length, with_payload


def trimmed(context: Context, loc: Loc, frame: Frame) -> Frame:
    """The frame with a payload that is trimmed. A byte stays, and what the length can say."""
    what = "the payload were sent"
    if not has_length(context, loc, frame, "PG235", "trailing_zeros", what):
        return frame
    stated = stated_range(frame)
    kept = max(1, stated.least if stated is not None else 0)
    return with_payload(frame, kept=kept)


def check_trimmed(context: Context, draft: Draft) -> None:
    """Check that receivers can fill up each message of frames with trimmed payloads."""
    for sender in draft.senders:
        frame = draft.frames.get(sender)
        if frame is not None and frame.payload.is_trimmed:
            _check_sizes(context, draft, sender)
            why = f"{sender} leaves out zeros at the end of payloads"
            check_overloads(context, draft, sender, "PG237", "trailing_zeros", why)


def _check_sizes(context: Context, draft: Draft, sender: str) -> None:
    """A payload is filled up to the size of its message, so that has to be one."""
    for message in draft.sent_by(sender):
        if message.sizes.fixed is None and message.name not in draft.too_large:
            text = f"`{message.name}` has {message.sizes} bytes, and {sender} leaves out zeros at"
            text = f"{text} the end: a receiver can't tell to what size to fill it up"
            hint = "give the message a fixed size, or leave out `trailing_zeros`"
            context.error_at_key("PG236", ("messages", message.name), text, hint)
