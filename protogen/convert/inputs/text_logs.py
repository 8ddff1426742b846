"""Logs of text with a time in each line, as `candump -l` and `candump -ta` write them.

    (1700000000.123456) can0 123#55020141BC
    (1700000000.123456)  can0  123   [5]  55 02 01 41 BC
    (1700000000.124) ttyUSB0 55 02 01 41 BC
    (1700000000.124) esp 55 02 01 41 BC

In parentheses stand seconds since 1970-01-01, behind them, if one likes, a word that is no hex
number: an interface, or the sender, and only the wanted sender's lines count where it is one. The
identifier of a CAN frame is no part of the bytes; one that asks for data (`R`) has none. Notes
about errors, empty lines and comments behind `#` say nothing.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Collection, Iterable, Iterator
from typing import NamedTuple

Complain = Callable[[str], None]
"""Take note of a line that can't be used."""

BEGIN = re.compile(r"\s*(?:#[^\n]*\n\s*)*\(\d{1,12}(?:\.\d{1,9})?\)[ \t]+\S", re.ASCII)
"""Beginning of a file of this kind."""

_SPLIT = re.compile(
    r"\((?P<seconds>\d{1,12})(?:\.(?P<fraction>\d{1,9}))?\)"
    r"(?:\s+(?P<name>(?![0-9A-Fa-f]+(?:\s|$))[^\s#]+)(?=\s|$))?"
    r"(?:(?:\s+[RT]X\s+[-B]\s+[-E])?\s+(?P<id>[0-9A-Fa-f]+)"
    r"(?:\#(?:\#[0-9A-Fa-f]|R[0-9A-Fa-f]?)?|\s+\[\d{1,4}\](?:\s+remote request)?))?"
    # What is taken here is not given back: long lines that fit nothing are soon known.
    r"\s*+(?P<hex>(?>(?:[0-9A-Fa-f]{2}\s*+)*))(?:(?<=\s)(?:[RT]x?|ERRORFRAME))?\s*+(?:'.*')?",
    # `bytes.fromhex` takes only such digits and spaces for what they are.
    re.ASCII,
)
_ERROR = 1 << 29
"""The bit of an identifier that makes the frame a note about an error, which was on no line."""

_LATEST = (1 << 63) - 1
"""The last time that tables have a place for: nanoseconds in an `int64`."""


def nanoseconds(seconds: int, fraction: str | None) -> int:
    """Seconds, and up to nine digits behind their point, in nanoseconds."""
    return seconds * 10**9 + int((fraction or "").ljust(9, "0"))


class LogLine(NamedTuple):
    """What a line says."""

    name: str | None
    """The interface or the sender."""
    data: bytes
    when: int
    """Nanoseconds since 1970-01-01."""


def log_pieces(
    lines: Iterable[str], sender: str, senders: Collection[str], complain: Complain
) -> Iterator[tuple[bytes, int]]:
    """The bytes of each line that is not another sender's, with its time in nanoseconds.

    A line that can't be read is complained of, and its bytes are lost.
    """
    for line in log_lines(lines, complain):
        if line.name not in senders or line.name == sender:
            yield line.data, line.when


def log_lines(lines: Iterable[str], complain: Complain) -> Iterator[LogLine]:
    """What each line says. One that can't be read is complained of, and its bytes are lost."""
    for number, line in enumerate(lines, start=1):
        text = line.strip()
        if not text or text.startswith("#"):
            continue
        found = _SPLIT.fullmatch(text)
        if found is None or not (found["hex"] or found["id"]):
            complain(f"line {number}: not `(SECONDS) [NAME] HEX`: {text[:40]!r}")
        elif not (found["id"] and int(found["id"], 16) & _ERROR):
            when = nanoseconds(int(found["seconds"]), found["fraction"])
            if when > _LATEST:
                complain(f"line {number}: a time behind the year 2262: {text[:40]!r}")
            else:
                yield LogLine(found["name"], bytes.fromhex(found["hex"]), when)
