"""Frames of one message, one behind another, taken all at once.

The first of them is cut as any other; the rest has to be like it in all but its payload and a
counter of one byte. What is not plainly so is left to the cutter, which takes it frame by frame.
"""

from __future__ import annotations

from collections.abc import Sequence
from itertools import accumulate, pairwise
from typing import Any
from zlib import adler32

from protogen.runtime.checksum import are_sound
from protogen.runtime.errors import ANYTHING, Unclear
from protogen.runtime.events import MessageEvent
from protogen.runtime.number import BYTES
from protogen.runtime.sender import Cutter

LONG = 2048
"""In so many bytes it is worth looking for runs."""

_FIRST, _WINDOW = 1024, 8192
"""So many bytes are looked at together at first, and at most: twice as many after each run.

So what is done in vain, where they are no run, is in proportion to what was not, and bounded.
"""

_KEPT = 32
"""So many heads are remembered; what comes off a wire must not fill the memory."""

_LEAST = 8
"""Fewer frames are left to the cutter."""


class StuffedRuns:
    """Runs of frames in which all that is between start and end is stuffed."""

    start: bytes
    end: bytes
    """Empty where the next start ends a frame."""
    codes: tuple[tuple[bytes, bytes], ...]
    """Bytes and what stands for them, in an order in which an encoder can replace them."""
    greatest: int
    """Bytes of the longest frame."""
    specials: bytes
    """Without these bytes, a content stands for itself."""
    head: slice
    """The bytes of a content that tell the numbers of its event."""
    alike: tuple[int, ...]
    """The places of the bytes in front of the payload that are the same all through a run."""
    counter: int | None
    """The place of the byte among them that is not."""
    xor_from: int | None
    """Where the bytes begin whose exclusive or is 0. None: the sum of all bytes is 0."""
    numbers: dict[bytes, list[tuple[int, ...]]]
    """The numbers of events by the value of the counter, for each head but for that."""

    def __init__(  # noqa: PLR0913 - an argument for each field
        self,
        start: bytes,
        end: bytes,
        codes: tuple[tuple[bytes, bytes], ...],
        greatest: int,
        specials: bytes,
        head: slice,
        alike: tuple[int, ...],
        counter: int | None,
        xor_from: int | None,
    ) -> None:
        self.start = start
        self.end = end
        self.codes = codes
        self.greatest = greatest
        self.specials = specials
        self.head = head
        self.alike = alike
        self.counter = counter
        self.xor_from = xor_from
        self.numbers = {}

    def take(
        self, data: bytes, at: int, base: int, events: list[Any], cut: Cutter, heads: Any
    ) -> int:
        """Add the events of runs from `at` on; the place of the first byte that is in none.

        `cut` takes frames one by one; `heads` has the numbers and the reader for a content's head.
        """
        window = _FIRST
        try:
            while len(data) - at > LONG:
                found, end = self._run(data[at : at + window], base + at, cut, heads)
                events += found
                at += end
                window = min(2 * window, _WINDOW)
        except ANYTHING:  # The cutter comes to what is not in order.
            return at
        return at

    def _run(self, data: bytes, base: int, cut: Cutter, heads: Any) -> tuple[list[Any], int]:
        """The events of one run, and the place behind it. Raises Unclear, or anything."""
        begun = len(self.start)
        parts = data[begun:].split(self.end + self.start)
        parts.pop()  # It may go on.
        if len(parts) < _LEAST or not data.startswith(self.start):
            raise Unclear
        codec = self._codec(data[: begun + len(parts[0]) + len(self.end)], cut)
        contents = self._contents(parts)
        first = contents[0]
        self._check(first, contents)
        numbers, read = heads[first[self.head]]
        around = len(self.start) + len(self.end)
        places = list(accumulate([len(part) + around for part in parts], initial=0))
        raws = [data[low:high] for low, high in pairwise(places)]
        shown = self._shown(first, contents, heads) or [numbers] * len(contents)
        found = []
        frames = zip(places[:-1], raws, shown, map(read, contents), strict=True)
        for offset, raw, number, message in frames:
            event: Any = MessageEvent()
            event.offset = base + offset
            event.raw = raw
            event.numbers = number
            event.message = message
            event.codec = codec
            found.append(event)
        return found, places[-1]

    @staticmethod
    def _codec(frame: bytes, cut: Cutter) -> Any:
        """What the cutter says of the first frame, which has to be in order."""
        events: list[Any] = []
        if cut(frame, 0, 0, events) != len(frame) or events[0].kind != "message":
            raise Unclear
        return events[0].codec

    def _contents(self, parts: Sequence[bytes]) -> list[bytes]:
        """All contents, of one size, without stuffing. Raises Unclear."""
        size = len(self._unstuffed(parts[0]))
        plain = [part for part in parts if len(part) == size]
        joined = b"".join(plain)
        if any(special in joined for special in self.specials):
            raise Unclear
        if len(plain) == len(parts):
            return plain
        contents = [part if len(part) == size else self._unstuffed(part) for part in parts]
        if set(map(len, contents)) != {size}:
            raise Unclear
        return contents

    def _unstuffed(self, part: bytes) -> bytes:
        """A content. Raises Unclear unless an encoder would stuff it so."""
        if len(self.start) + len(part) + len(self.end) > self.greatest:
            raise Unclear
        content = part
        for byte, code in reversed(self.codes):
            content = content.replace(code, byte)
        again = content
        for byte, code in self.codes:
            again = again.replace(byte, code)
        if again != part:
            raise Unclear
        return content

    def _check(self, first: bytes, contents: list[bytes]) -> None:
        """Raise Unclear unless all heads are alike and all checksums right."""
        size, count = len(first), len(contents)
        joined = b"".join(contents)
        for place in self.alike:
            if joined[place::size] != first[place : place + 1] * count:
                raise Unclear
        if self.xor_from is not None:
            if not are_sound(contents, self.xor_from):
                raise Unclear
            return
        sums = [adler32(content, 0) & 0xFF for content in contents]
        if any(sums):
            raise Unclear

    def _shown(self, first: bytes, contents: list[bytes], heads: Any) -> list[Any]:
        """The numbers of all events, where they have a counter."""
        place = self.counter
        if place is None:
            return []
        head, index = first[self.head], place - self.head.start
        front, behind = head[:index], head[index + 1 :]
        key = front + b"\0" + behind
        known = self.numbers.get(key)
        if known is None:
            if len(self.numbers) >= _KEPT:
                self.numbers.clear()
            # There when it is whole: others may look for it at the same time.
            known = [heads[front + BYTES[value] + behind][0] for value in range(256)]
            self.numbers[key] = known
        return [known[content[place]] for content in contents]
