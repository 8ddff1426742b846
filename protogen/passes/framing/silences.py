"""Ends of frames that are a silence of the line."""

from __future__ import annotations

from fractions import Fraction

from protogen.model.frame import Frame, Silence
from protogen.model.protocol import Link
from protogen.passes.context import Context, about
from protogen.passes.framing.capacity import tail_literals
from protogen.passes.framing.written_frames import WrittenFrame
from protogen.schema.syntax.base import silence_seconds
from protogen.schema.syntax.parts import Part

_KEYS = frozenset({"idle", "doc", "source"})


def silence_of(context: Context, written: WrittenFrame) -> Silence | None:
    """The silence that ends a frame, if one does."""
    found = None
    for name, item in written.silences.items():
        found = _silence(context, written, name, item)
    return found


def _silence(context: Context, written: WrittenFrame, name: str, item: Part) -> Silence | None:
    loc = (*written.loc, name)
    others = item.model_fields_set - _KEYS
    for key in sorted(others):
        if getattr(item, key) is not None:
            text = f"`{key}` does not go together with `idle`"
            context.error_at_key("PG131", (*loc, key), text)
    if name != written.names[-1]:
        text = f"`{name}` is a silence, and the frame goes on behind it"
        context.error_at_key("PG254", loc, text, "make it the last part")
    seconds = silence_seconds(item.idle or "", character_time(context))
    if seconds is None:
        text = "nothing says how long a character is"
        context.error("PG253", (*loc, "idle"), text, "give the `link` its `baud`, or write a time")
        return None
    return Silence(
        name=name, seconds=seconds, about=about(item.doc, item.source, context.find_key(loc))
    )


def character_time(context: Context) -> Fraction | None:
    """Seconds that a character takes on the line; None where its rate is not known."""
    link = context.syntax.link
    return Link(
        baud=link.baud, data_bits=link.data_bits, parity=link.parity, stop_bits=link.stop_bits
    ).byte_time


def check_silence(context: Context, written: WrittenFrame, frame: Frame) -> None:
    """Check what stands in a frame that a silence ends, and that it has a bound."""
    if frame.silence is None:
        return
    loc = (*written.loc, frame.silence.name)
    literals = tail_literals(frame)
    if literals:
        text = f"the frame ends twice: with `{literals[-1].name}` and with a silence"
        context.error_at_key("PG254", loc, text, "keep the one that receivers look for")
    if frame.transparency is not None:
        text = "a silence ends the frame, and there is no delimiter to keep out of it"
        context.error_at_key(
            "PG254", written.transparency_loc, text, "remove the transparency, or the silence"
        )
    if frame.limit is None:
        text = f"nothing bounds a frame of {written.endpoint} but the silence behind it"
        context.error_at_key("PG255", loc, text, "bound all frames: `max_frame: 256`")
