"""Payloads longer than their message, of which receivers take the bytes that they know."""

from __future__ import annotations

from protogen.model.frame import Frame
from protogen.passes.context import Context, Loc
from protogen.passes.draft import Draft
from protogen.passes.framing.capacity import payload_range
from protogen.passes.framing.fitting import check_overloads, has_length, with_payload


def cut(context: Context, loc: Loc, frame: Frame) -> Frame:
    """The frame with a payload that is cut. The longest is what the length and the frame allow."""
    what = "payload a newer sender has"
    if not has_length(context, loc, frame, "PG280", "longer", what):
        return frame
    carried = payload_range(frame)
    if carried is None:
        return frame  # The length states no payload at all, which is reported.
    return with_payload(frame, longest=carried.greatest)


def check_cut(context: Context, draft: Draft) -> None:
    """Check that something can be cut in frames that say so, and that sizes tell nothing else."""
    sharing: dict[Loc, list[str]] = {}
    for sender in draft.senders:
        frame = draft.frames.get(sender)
        if frame is not None and frame.payload.is_cut:
            sharing.setdefault(context.frames[sender].loc, []).append(sender)
            why = f"payloads of {sender} may be longer than known"
            check_overloads(context, draft, sender, "PG282", "longer", why)
    for loc, senders in sharing.items():
        _check_sizes(context, draft, loc, senders)


def _check_sizes(context: Context, draft: Draft, frame: Loc, senders: list[str]) -> None:
    """A message that no field fills to its end, and room behind it, is what can be cut."""
    longest = draft.frames[senders[0]].payload.longest or 0
    messages = [message for sender in senders for message in draft.sent_by(sender)]
    loc, sender = (*frame, "payload", "longer"), " or ".join(senders)
    known = [message for message in messages if message.can_be_cut]
    if messages and not known:
        text = f"every message of {sender} takes all of its payload, so none has bytes behind it"
        hint = "leave out `longer`, or say where the fields of a message end"
        context.error_at_key("PG281", loc, text, hint)
    elif known and all(message.sizes.greatest >= longest for message in known):
        text = f"no frame of {sender} has room for more than a message has: {longest} bytes"
        hint = "widen the range of the length part, raise `max_frame`, or leave out `longer`"
        context.error_at_key("PG281", loc, text, hint)
