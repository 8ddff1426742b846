"""Times in front of the lines of a log, and the silences that they tell of."""

from __future__ import annotations

import re
from datetime import date
from fractions import Fraction
from typing import TYPE_CHECKING, NamedTuple

from protogen.cli.exits import UsageError

if TYPE_CHECKING:
    from protogen.cli.wire.tagged import Piece
    from protogen.model.protocol import Link

_SECOND = 10**9
_DAY = 24 * 3600 * _SECOND

_TIME = re.compile(
    r"\s*[(\[<]?\s*(?:"
    r"(?:(?P<date>\d{4}-\d\d-\d\d)[T ])?(?P<hours>\d\d?):(?P<minutes>\d\d)(?::(?P<of_clock>\d\d))?"
    r"|(?P<seconds>\d{1,12}))(?:[.,](?P<fraction>\d{1,9})\d*)?Z?(?=[\s)\]>]|$)",
    re.ASCII,
)


class LineTimes:
    """Times of lines: `12:00:01.5`, `2024-05-01T12:00:01`, `(1700000000.25)`, in any brackets."""

    def __init__(self) -> None:
        self._days = 0
        self._last = 0

    def of(self, line: str) -> int | None:
        """The time in front of a line in nanoseconds, from any moment on; None: there is none.

        A clock without a date goes on by a day where it goes back by more than half of one.
        """
        found = _TIME.match(line)
        if found is None:
            return None
        fraction = int((found["fraction"] or "").ljust(9, "0"))
        if found["seconds"] is not None:
            return int(found["seconds"]) * _SECOND + fraction
        minutes = int(found["hours"]) * 60 + int(found["minutes"])
        clock = (minutes * 60 + int(found["of_clock"] or 0)) * _SECOND + fraction
        if found["date"] is not None:
            day = _day(found["date"])
            return None if day is None else day * _DAY + clock
        self._days += self._last - clock > _DAY // 2
        self._last = clock
        return self._days * _DAY + clock


def _day(text: str) -> int | None:
    try:
        return date.fromisoformat(text).toordinal()
    except ValueError:
        return None


class _Sent(NamedTuple):
    """When bytes were noted down, and how long they were on the line."""

    when: int
    duration: Fraction


class Silences:
    """Which bytes come behind a silence that ends what a decoder holds."""

    def __init__(self, link: Link) -> None:
        """Of a link with an `idle_timeout`. Raises UsageError where it has none."""
        if link.idle_timeout is None:
            raise UsageError(
                "the schema does not say which silence ends a frame",
                "give it, such as `link: {idle_timeout: 20 ms}`, or leave --timed out",
            )
        self._timeout = link.idle_timeout * _SECOND
        bits = Fraction(link.bits_per_byte * _SECOND)
        self._of_byte = bits / link.baud if link.baud else Fraction(0)
        self._last: dict[str, _Sent] = {}

    def are_in_front(self, piece: Piece) -> bool:
        """True if its sender was silent for at least the timeout in front of these bytes.

        A line may be noted down when its bytes begin or when they are there, so the longer time
        that they, or those before, were on the line is no silence.
        """
        if piece.when is None:
            return False
        duration = len(piece.data) * self._of_byte
        before = self._last.get(piece.sender)
        if before is not None and before.when == piece.when:
            duration += before.duration
        self._last[piece.sender] = _Sent(piece.when, duration)
        if before is None:
            return False
        return piece.when - before.when - max(before.duration, duration) >= self._timeout
