"""Payloads longer than their message, of which receivers take the bytes that they know."""

from __future__ import annotations

from protogen.copying import replace
from protogen.model.frame import Frame
from protogen.passes.context import Context, Loc
from protogen.passes.draft import Draft
from protogen.passes.framing.capacity import payload_range


def cut(context: Context, loc: Loc, frame: Frame) -> Frame:
    """The frame with a payload that is cut. The longest is what the length and the frame allow."""
    payload = frame.payload
    if frame.length is None:
        text = "nothing tells a receiver how many bytes of payload a newer sender has"
        hint = "give the frame a length part that counts the payload"
        context.error_at_key("PG280", (*loc, payload.name, "longer"), text, hint)
        return frame
    carried = payload_range(frame)
    if carried is None:
        return frame  # The length states no payload at all, which is reported.
    parts = (replace(it, longest=carried.greatest) if it == payload else it for it in frame.parts)
    return replace(frame, parts=tuple(parts))


def check_cut(context: Context, draft: Draft) -> None:
    """Check that something can be cut in frames that say so, and that sizes tell nothing else."""
    sharing: dict[Loc, list[str]] = {}
    for sender in draft.senders:
        frame = draft.frames.get(sender)
        if frame is not None and frame.payload.is_cut:
            sharing.setdefault(context.frames[sender].loc, []).append(sender)
            _check_overloads(context, draft, sender)
    for loc, senders in sharing.items():
        _check_sizes(context, draft, loc, senders)


def _check_sizes(context: Context, draft: Draft, frame: Loc, senders: list[str]) -> None:
    """A message that always has the same size, and room behind it, is what can be cut."""
    longest = draft.frames[senders[0]].payload.longest or 0
    messages = [message for sender in senders for message in draft.sent_by(sender)]
    loc, sender = (*frame, "payload", "longer"), " or ".join(senders)
    fixed = [message for message in messages if message.sizes.fixed is not None]
    if messages and not fixed:
        text = f"no message of {sender} always has the same size, so none has bytes behind it"
        hint = "leave out `longer`, or give a message a fixed size"
        context.error_at_key("PG281", loc, text, hint)
    elif fixed and all(message.sizes.greatest >= longest for message in fixed):
        text = f"no frame of {sender} has room for more than a message has: {longest} bytes"
        hint = "widen the range of the length part, raise `max_frame`, or leave out `longer`"
        context.error_at_key("PG281", loc, text, hint)


def _check_overloads(context: Context, draft: Draft, sender: str) -> None:
    """A size that a newer sender may exceed tells no messages apart."""
    for overload in draft.overloads.get(sender, ()):
        if overload.yields is None:
            text = f"payloads of {sender} may be longer than known, so their size does not tell"
            text = f"{text} messages apart"
            hint = "give each message an identity of its own, or leave out `longer`"
            context.error("PG282", ("overloads", overload.name, "by"), text, hint)
