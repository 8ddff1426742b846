"""The framing properties, in words for people."""

from __future__ import annotations

from protogen.model.frame import Frame
from protogen.model.framing import AfterEnd, Anywhere, End, Start, StartLiteral, StartSet
from protogen.model.messages import Message


def finds_start(start: Start, *, is_idle: bool = False) -> str:
    """Sentence on how a receiver finds where a frame starts; `is_idle`: a silence ends frames."""
    match start:
        case StartLiteral(protected=True):
            return f"at {_hex(start.bytes)}, which occurs nowhere else in a frame"
        case StartLiteral():
            return (
                f"at {_hex(start.bytes)}, which can also occur inside a frame: a false start is "
                "given up when the frame does not check, and its bytes are read again"
            )
        case StartSet(protected=True):
            return f"at {_any(start)}, which occurs nowhere else in a frame"
        case StartSet():
            return f"at {_any(start)}, which can also occur inside a frame"
        case AfterEnd():
            return "behind the end of the frame before, or at the start of the stream"
        case Anywhere(checked=True):
            where = " up to the silence" if is_idle else ""
            return f"at any byte from which sizes and checksum are right{where}"
        case Anywhere() if is_idle:
            return "behind a silence; what can be no frame is passed over byte by byte"
        case Anywhere():
            return (
                "where the frame before ends, or at the start of the stream; what can be no frame "
                "is passed over byte by byte"
            )


_MANY_WORDS = 16
"""So many words are listed."""


def finds_end(frame: Frame, start: Start, end: End | None, messages: list[Message]) -> str:
    """Sentence on how a receiver finds where a frame ends."""
    if frame.silence is not None:
        told = f"; `{frame.length.name}` must give its size" if frame.length else ""
        told = f"{told}{_agreeing(frame)}"
        return f"after {frame.silence.text} of silence, and nowhere else{told}"
    if frame.length is not None:
        told = ", which a receiver is told," if frame.told_length else ""
        where = f"`{frame.length.name}`{told} gives the size{_agreeing(frame)}"
        return where if end is None else f"{where}; {_hex(end.bytes)} must follow"
    if end is None:
        is_fixed = all(message.sizes.fixed is not None for message in messages)
        what = "the identity gives" if is_fixed else "identity and fields give"
        if isinstance(start, Anywhere):
            if not frame.identity:
                return "the message gives the size"
            return f"{what} the size; no frame has an unknown identity"
        return f"{what} the size; an unknown message ends at the next start"
    if end.protected:
        return f"at {_hex(end.bytes)}, which occurs nowhere else in a frame"
    return (
        f"the identity gives the size of messages of one size, and {_hex(end.bytes)} must follow; "
        f"other messages end at the first {_hex(end.bytes)}, also if it was meant as data"
    )


def _agreeing(frame: Frame) -> str:
    """What is said of lengths behind the one that tells where a frame ends."""
    names = [f"`{part.name}`" for part in frame.lengths[1:]]
    return f", and {' and '.join(names)} must agree with it" if names else ""


def synchronisation(frame: Frame, start: Start, end: End | None) -> tuple[bool, str]:
    """Sentence on whether a receiver that joins anywhere surely finds the next frame, and why."""
    if frame.silence is not None:
        return True, (
            "a silence ends whatever was in front of it, so a receiver is in step from the next "
            "silence on; of frames without a silence between them only the last can be found"
        )
    match start:
        case StartLiteral(protected=True) | StartSet(protected=True):
            return True, (
                "the start can't occur inside a frame, so a receiver is in step from the next "
                "frame on"
            )
        case AfterEnd() if end is not None and end.protected:
            return True, (
                "the end can't occur inside a frame, so a receiver is in step from the next end on"
            )
        case AfterEnd():
            return False, (
                "the end can occur in the data, so a receiver may start in the middle of a frame; "
                f"it finds its way back behind a true end{_helped(frame)}"
            )
        case Anywhere(checked=False):
            return False, (
                "nothing marks the start, so a receiver that begins elsewhere, or loses a byte, "
                "may cut frames in the wrong places from then on"
            )
    return False, f"the start can occur in the data; {_checked(frame)}"


def held_by(frame: Frame, form: str) -> str:
    """Sentence on a start that frames of another form can hold."""
    return f"the start can occur in frames of the form `{form}`; {_checked(frame)}"


def _helped(frame: Frame) -> str:
    return ", when the checksum has rejected what it read until then" if frame.checksums else ""


def _checked(frame: Frame) -> str:
    if frame.checksums:
        return "false starts are told from true ones by size and checksum"
    return "with no checksum, a false start can be taken for a frame"


def _hex(data: bytes) -> str:
    return data.hex(" ").upper()


def span(start: StartSet) -> str:
    """What a frame starts with: `80 to FE`, or `C8 or EA`."""
    *words, last = map(_hex, start.words)
    if start.is_run:
        return f"{words[0] if words else last} to {last}"
    if len(words) > _MANY_WORDS:
        words = [*words[:_MANY_WORDS], "..."]
    return f"{', '.join(words)} or {last}"


def _any(start: StartSet) -> str:
    return f"a byte {span(start)}" if start.is_run else span(start)
