"""Where a frame may start in a run of bytes."""

from __future__ import annotations

import re
from typing import Protocol

from protogen.runtime.frame import AfterEnd, FrameSpec, StartLiteral, StartSet


class Starts(Protocol):
    """Finds possible starts: places where a frame may begin."""

    @property
    def context(self) -> int:
        """How many bytes in front of a place tell whether it is a start."""

    def find(self, data: bytes, low: int, high: int) -> int:
        """The first start from `low` on that lies before `high`; -1 if there is none."""

    def undecided(self, data: bytes, low: int) -> int:
        """The first place from `low` on that more bytes may yet make a start; else the end."""


class LiteralStarts:
    """A start literal."""

    context = 0

    def __init__(self, literal: bytes) -> None:
        self._literal = literal

    def find(self, data: bytes, low: int, high: int) -> int:
        """The first place before `high` where the whole literal stands."""
        return data.find(self._literal, low, high - 1 + len(self._literal))

    def undecided(self, data: bytes, low: int) -> int:
        """Where the data end with the beginning of the literal."""
        for place in range(max(low, len(data) - len(self._literal) + 1), len(data)):
            if self._literal.startswith(data[place:]):
                return place
        return len(data)


class SetStarts:
    """Any byte from `least` to `greatest`."""

    context = 0

    def __init__(self, least: int, greatest: int) -> None:
        first, last = (re.escape(bytes((byte,))) for byte in (least, greatest))
        self._pattern = re.compile(b"[" + first + b"-" + last + b"]")

    def find(self, data: bytes, low: int, high: int) -> int:
        """The first such byte."""
        found = self._pattern.search(data, low, high)
        return -1 if found is None else found.start()

    def undecided(self, data: bytes, low: int) -> int:
        """The end: each byte decides."""
        return len(data)


class EndStarts:
    """Right behind an end, which may lie in front of `low`."""

    def __init__(self, end: bytes) -> None:
        self._end = end
        self.context = len(end)

    def find(self, data: bytes, low: int, high: int) -> int:
        """The first place behind an end."""
        found = data.find(self._end, max(low - len(self._end), 0), high - 1)
        return -1 if found < 0 else found + len(self._end)

    def undecided(self, data: bytes, low: int) -> int:
        """The end: what lies in front of a place decides."""
        return len(data)


class EveryStart:
    """Every byte."""

    context = 0

    def find(self, data: bytes, low: int, high: int) -> int:
        """The place `low` itself."""
        return low if low < high else -1

    def undecided(self, data: bytes, low: int) -> int:
        """The end: every byte is a start."""
        return len(data)


def starts_of(spec: FrameSpec) -> Starts:
    """What finds the starts of such frames."""
    start = spec.start
    if isinstance(start, StartLiteral):
        return LiteralStarts(start.value)
    if isinstance(start, StartSet):
        return SetStarts(start.least, start.greatest)
    if isinstance(start, AfterEnd):
        assert spec.end is not None
        return EndStarts(spec.end.value)
    return EveryStart()
