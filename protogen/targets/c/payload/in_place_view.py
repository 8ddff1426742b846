"""What is printed for messages that are written where they stand in their frames."""

from __future__ import annotations

import msgspec

from protogen.c_language.numbers import unsigned
from protogen.model.payload_plan import AnyStep
from protogen.targets.c.lines import Lines
from protogen.targets.c.payload.given_amounts import GivenAmount


class Segment(msgspec.Struct, frozen=True):
    """Bytes of the payload that stand behind each other however many elements there are."""

    at: int
    """Where they stand while it is written."""
    size: str


class Setter(msgspec.Struct, frozen=True):
    """An inline function that writes a field, an element of one, or a piece of its bytes."""

    field: str
    name: str
    indexed: bool
    """True if it takes the index of an element, or of the first of several bytes."""
    value: AnyStep
    """What its value is."""
    type: str
    """The type of that, or of the pointer to it."""
    pieces: bool
    """True if it takes the number of bytes, too."""
    text: str


class Getter(msgspec.Struct, frozen=True):
    """An inline function that reads what was written: a number, a struct, or an element."""

    field: str
    name: str
    value: AnyStep
    most: str
    """How many elements there are or can be; empty if there is no index."""


class InPlace(msgspec.Struct, frozen=True):
    """What is printed for a message that can be written in its place."""

    reading: tuple[str, ...]
    """Inline functions that read what no other function of the message does."""
    getters: tuple[Getter, ...]
    """Those that read what does not move when the frame is ended, and has no worked out number."""
    setters: tuple[Setter, ...]
    begins: tuple[str, ...]
    """Statements that store the defaults at `at`, where all is 0."""
    unset: str
    """The name of the function that says whether a field still has to be set; empty: none has."""
    unset_function: str
    written: tuple[str, ...]
    """Functions for it that read what stands elsewhere in a frame that was ended."""
    room: int
    """Bytes of the payload, with the most elements that it can have."""
    amounts: tuple[GivenAmount, ...]
    """The numbers that are given when the frame is ended."""
    size: str
    """The bytes of the payload, worked out of them."""
    stores: tuple[str, ...]
    """Statements that put them into the payload at `written`."""
    segments: tuple[Segment, ...]
    first: tuple[GivenAmount, ...] = ()
    """The numbers that are given when it is begun."""
    sizing: tuple[str, ...] = ()
    """Statements that refuse these, and declare how many bytes `payload` then has room for."""
    measuring: tuple[str, ...] = ()
    """Statements that work out the bytes of the payload out of these, as they stand there."""

    @property
    def varies(self) -> bool:
        """True if not all payloads have as many elements."""
        return bool(self.amounts or self.first)

    @property
    def given(self) -> str:
        """The numbers as arguments behind others."""
        return "".join(f", {item.name}" for item in self.amounts)

    def closes_up(self, *, is_moved: bool) -> bool:
        """True if bytes have to move when the frame is ended."""
        return self.varies and (is_moved or len(self.segments) > 1)

    def closing(self, place: str, *, is_moved: bool) -> tuple[str, ...]:
        """Statements that move the bytes to where the frame has them.

        `place` is the payload's, where all of it moves. Where numbers were given first, the bytes
        stand at the start of the buffer, and move towards its end; else none does.
        """
        if not self.closes_up(is_moved=is_moved):
            return ()
        lines, segments = Lines(), self.segments
        if self.first:
            lines.add(f"to = {place};")
            with lines.block("for (size_t i = payload; i > 0U; i--)"):
                lines.add("to[i - 1U] = written[i - 1U];")
            return lines.lines
        if is_moved:
            lines.add(f"to = {place};")
        else:
            lines.add(f"to = &written[{segments[0].size}];")
            segments = segments[1:]
        for segment in segments:
            with lines.block(f"for (size_t i = 0; i < {segment.size}; i++)"):
                lines.add(f"to[i] = written[{_index(segment.at, 'i')}];")
            if segment is not segments[-1]:
                lines.add(f"to += {segment.size};")
        return lines.lines


def _index(offset: int, index: str) -> str:
    return f"{unsigned(offset)} + {index}" if offset else index
