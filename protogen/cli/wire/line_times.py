"""Times in front of the lines of a log."""

from __future__ import annotations

import re
from datetime import date

from protogen.convert.inputs.text_logs import nanoseconds

_DAY = 24 * 3600 * 10**9

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
        if found["seconds"] is not None:
            return nanoseconds(int(found["seconds"]), found["fraction"])
        minutes = int(found["hours"]) * 60 + int(found["minutes"])
        clock = nanoseconds(minutes * 60 + int(found["of_clock"] or 0), found["fraction"])
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
