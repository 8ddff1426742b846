"""Cut runs of equal frames in one step. Frames that differ go to the one-by-one cutter.

Equal frames have the same content but for payload, checksum and a counter of one byte. The cutter
takes the first frame of a run; the others are compared with it.
"""

from __future__ import annotations

from collections.abc import Sequence
from itertools import accumulate, pairwise
from typing import Any
from zlib import adler32

from protogen.runtime.checksum import are_sound
from protogen.runtime.errors import ANYTHING, NeedsReference
from protogen.runtime.events import MessageEvent
from protogen.runtime.framing.sender import Cutter
from protogen.runtime.payload.number import BYTES

MIN_DATA = 2048
"""Bytes of input below which no run is looked for."""

_FIRST_WINDOW, _MAX_WINDOW = 1024, 8192
"""Bytes that are searched for a run at once.

The window doubles after each run, so wasted work stays proportional to useful work.
"""

_MAX_HEADS = 32
"""Heads whose numbers are remembered: a wire must not fill the memory."""

_MAX_MISSES = 15
"""Calls that go by where run after run is damaged: it takes as long to find that as to cut them."""

MIN_RUN = 8
"""Shorter runs are cut one frame at a time."""


class BulkCutter:
    """Cutter of runs of frames in which everything between start and end is stuffed."""

    start: bytes
    end: bytes
    """Empty where the next start ends a frame."""
    codes: tuple[tuple[bytes, bytes], ...]
    """Bytes and the codes that stand for them, in an order in which they can be replaced."""
    greatest: int
    """Bytes of the longest frame."""
    specials: bytes
    """Content without these bytes stands for itself."""
    head: slice
    """Bytes of a content that tell the numbers of its event."""
    alike: tuple[int, ...]
    """Places of the bytes in front of the payload that are the same throughout a run."""
    counter: int | None
    """Place of the counter, the one byte in front of the payload that may differ."""
    xor_from: int | None
    """Place from which the XOR of all bytes is 0. None: the sum of all bytes is 0."""
    numbers: dict[bytes, list[tuple[int, ...]]]
    """Numbers of events by the value of the counter, for each head without it."""

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
        self._misses = self._left = 0  # What was tried in vain of late, and is not tried again yet.

    def take(
        self, data: bytes, at: int, base: int, events: list[Any], cut: Cutter, heads: Any
    ) -> int:
        """Add the events of runs from `at` on; return the place of the first byte in no run.

        `cut` takes frames one by one; `heads` has the numbers and the reader for a content's head.
        """
        if self._left:
            self._left -= 1
            return at
        window, begun = _FIRST_WINDOW, at
        try:
            while len(data) - at > MIN_DATA:
                found, end = self._run(data[at : at + window], base + at, cut, heads)
                events += found
                at += end
                window = min(2 * window, _MAX_WINDOW)
        except ANYTHING:  # The cutter comes to what is not in order.
            self._misses = min(2 * self._misses + 1, _MAX_MISSES) if at == begun else 0
            self._left = self._misses
        return at

    def _run(self, data: bytes, base: int, cut: Cutter, heads: Any) -> tuple[list[Any], int]:
        """Events of one run, and the place behind it. Raises NeedsReference, or anything."""
        begun = len(self.start)
        parts = data[begun:].split(self.end + self.start)
        parts.pop()  # It may go on.
        if len(parts) < MIN_RUN or not data.startswith(self.start):
            raise NeedsReference
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
            event.kept_parts = None
            found.append(event)
        return found, places[-1]

    @staticmethod
    def _codec(frame: bytes, cut: Cutter) -> Any:
        """Sender of the first frame. Raises NeedsReference if the cutter leaves that."""
        events: list[Any] = []
        if cut(frame, 0, 0, events) != len(frame) or events[0].kind != "message":
            raise NeedsReference
        return events[0].codec

    def _contents(self, parts: Sequence[bytes]) -> list[bytes]:
        """All contents, unstuffed. Raises NeedsReference unless they have one size."""
        size = len(self._unstuffed(parts[0]))
        plain = [part for part in parts if len(part) == size]
        joined = b"".join(plain)
        if any(special in joined for special in self.specials):
            raise NeedsReference
        if len(plain) == len(parts):
            return plain
        contents = [part if len(part) == size else self._unstuffed(part) for part in parts]
        if set(map(len, contents)) != {size}:
            raise NeedsReference
        return contents

    def _unstuffed(self, part: bytes) -> bytes:
        """Content of a frame. Raises NeedsReference unless an encoder would stuff it so."""
        if len(self.start) + len(part) + len(self.end) > self.greatest:
            raise NeedsReference
        content = part
        for byte, code in reversed(self.codes):
            content = content.replace(code, byte)
        again = content
        for byte, code in self.codes:
            again = again.replace(byte, code)
        if again != part:
            raise NeedsReference
        return content

    def _check(self, first: bytes, contents: list[bytes]) -> None:
        """Raise NeedsReference unless all heads are alike and all checksums right."""
        size, count = len(first), len(contents)
        joined = b"".join(contents)
        for place in self.alike:
            if joined[place::size] != first[place : place + 1] * count:
                raise NeedsReference
        if self.xor_from is not None:
            if not are_sound(contents, self.xor_from):
                raise NeedsReference
            return
        sums = [adler32(content, 0) & 0xFF for content in contents]
        if any(sums):
            raise NeedsReference

    def _shown(self, first: bytes, contents: list[bytes], heads: Any) -> list[Any]:
        """Numbers of all events; empty if frames have no counter."""
        place = self.counter
        if place is None:
            return []
        head, index = first[self.head], place - self.head.start
        front, behind = head[:index], head[index + 1 :]
        key = front + b"\0" + behind
        known = self.numbers.get(key)
        if known is None:
            if len(self.numbers) >= _MAX_HEADS:
                self.numbers.clear()
            # There when it is whole: others may look for it at the same time.
            known = [heads[front + BYTES[value] + behind][0] for value in range(256)]
            self.numbers[key] = known
        return [known[content[place]] for content in contents]
