"""Payloads whose zeros at the end are left out: what a receiver needs to put them there again."""

from __future__ import annotations

from protogen.copying import replace
from protogen.model.frame import Frame
from protogen.passes.context import Context, Loc
from protogen.passes.draft import Draft
from protogen.passes.framing.capacity import stated_range


def trimmed(context: Context, loc: Loc, frame: Frame) -> Frame:
    """The frame with a payload that is trimmed. A byte stays, and what the length can say."""
    payload = frame.payload
    if frame.length is None:
        text = "nothing tells a receiver how many bytes of the payload were sent"
        hint = "give the frame a length part that counts the payload"
        context.error_at_key("PG235", (*loc, payload.name, "trailing_zeros"), text, hint)
        return frame
    stated = stated_range(frame)
    kept = max(1, stated.least if stated is not None else 0)
    parts = (replace(part, kept=kept) if part == payload else part for part in frame.parts)
    return replace(frame, parts=tuple(parts))


def check_trimmed(context: Context, draft: Draft) -> None:
    """Check that receivers can fill up each message of frames with trimmed payloads."""
    for sender in draft.senders:
        frame = draft.frames.get(sender)
        if frame is not None and frame.payload.is_trimmed:
            _check_sizes(context, draft, sender)
            _check_overloads(context, draft, sender)


def _check_sizes(context: Context, draft: Draft, sender: str) -> None:
    """A payload is filled up to the size of its message, so that has to be one."""
    for message in draft.sent_by(sender):
        if message.sizes.fixed is None and message.name not in draft.too_large:
            text = f"`{message.name}` has {message.sizes} bytes, and {sender} leaves out zeros at"
            text = f"{text} the end: a receiver can't tell to what size to fill it up"
            hint = "give the message a fixed size, or leave out `trailing_zeros`"
            context.error_at_key("PG236", ("messages", message.name), text, hint)


def _check_overloads(context: Context, draft: Draft, sender: str) -> None:
    """A size that varies tells no messages apart."""
    for overload in draft.overloads.get(sender, ()):
        if overload.yields is None:
            text = f"{sender} leaves out zeros at the end of payloads, so their size does not tell"
            text = f"{text} messages apart"
            hint = "give each message an identity of its own, or leave out `trailing_zeros`"
            context.error("PG237", ("overloads", overload.name, "by"), text, hint)
