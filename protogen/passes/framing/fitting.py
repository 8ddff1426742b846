"""What payloads need that receivers fill up, or cut, to the size of their message."""

from __future__ import annotations

from typing import Any

from protogen.copying import replace
from protogen.model.frame import Frame
from protogen.passes.context import Context, Loc
from protogen.passes.draft import Draft


def has_length(context: Context, loc: Loc, frame: Frame, code: str, key: str, what: str) -> bool:
    """True if a length counts the payload; else nothing tells a receiver `what` there is."""
    if frame.length is not None:
        return True
    text = f"nothing tells a receiver how many bytes of {what}"
    hint = "give the frame a length part that counts the payload"
    context.error_at_key(code, (*loc, frame.payload.name, key), text, hint)
    return False


def with_payload(frame: Frame, **changes: Any) -> Frame:
    """The frame with changes of its payload."""
    payload = replace(frame.payload, **changes)
    parts = (payload if part == frame.payload else part for part in frame.parts)
    return replace(frame, parts=tuple(parts))


def check_overloads(
    context: Context, draft: Draft, sender: str, code: str, key: str, why: str
) -> None:
    """Report overloads that a size alone tells apart, which it can't where payloads are fitted."""
    for overload in draft.overloads.get(sender, ()):
        if overload.yields is None:
            text = f"{why}, so their size does not tell messages apart"
            hint = f"give each message an identity of its own, or leave out `{key}`"
            context.error(code, ("overloads", overload.name, "by"), text, hint)
