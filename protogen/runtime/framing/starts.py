"""Search for places where a frame may start."""

from __future__ import annotations

import re

from protogen.runtime.framing.frame import AfterEnd, FrameSpec, StartMark, StartSet


class Starts:
    """Finds possible starts: places where a frame may begin."""

    def __init__(self, pattern: bytes, size: int = 1, *, words: tuple[bytes, ...] = ()) -> None:
        """`pattern` matches `size` bytes at a start; `words` of that size may come in pieces."""
        self._search = re.compile(pattern, re.DOTALL).search
        self._size = size
        self._words = words
        self.context = 0
        """Bytes in front of a place that tell whether it is a start."""

    def find(self, data: bytes, low: int, high: int) -> int:
        """The first start from `low` on that lies before `high`; -1 if there is none."""
        found = self._search(data, low, high - 1 + self._size) if low < high else None
        return -1 if found is None else found.start()

    def undecided(self, data: bytes, low: int) -> int:
        """The first place from `low` on that more bytes may yet make a start; else the end."""
        for place in range(max(low, len(data) - self._size + 1), len(data)):
            if any(word.startswith(data[place:]) for word in self._words):
                return place
        return len(data)


def starts_of(spec: FrameSpec) -> Starts:
    """The search for the starts of such frames."""
    start = spec.start
    if isinstance(start, StartSet):
        first, last = (re.escape(bytes((byte,))) for byte in (start.least, start.greatest))
        return Starts(b"[" + first + b"-" + last + b"]")
    if isinstance(start, StartMark):
        pattern = b"|".join(map(re.escape, start.words))
        return Starts(pattern, len(start.words[0]), words=start.words)
    if isinstance(start, AfterEnd):
        assert spec.end is not None
        behind = Starts(b"(?<=" + re.escape(spec.end.value) + b")", size=0)
        behind.context = len(spec.end.value)
        return behind
    return Starts(b"", size=0)
