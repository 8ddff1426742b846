"""A log of both directions: lines that name the sender of the bytes behind its name.

    pc: 55 02 01 53 AA            [pc] 55 02 01 53 AA            pc> 55 02 01 53 AA
    12:00:01.5 pc: 55 02          2024-05-01T12:00:01 [pc] 55 02

In front of the name may stand anything but a `#` and the name of another sender. A line is read in
pieces, so that a log of one endless line takes no more memory than any other.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator, Sequence
from typing import NamedTuple

from protogen.cli.wire.line_times import LineTimes
from protogen.convert.inputs.hex_digits import HexError, HexReader
from protogen.convert.inputs.text_lines import decoded

_LONG = 1 << 16
"""Characters; a longer line is read in pieces."""

Complain = Callable[[str], None]
"""Take note of a line that can't be used."""


class Piece(NamedTuple):
    """Some bytes of a capture and who sent them."""

    sender: str
    data: bytes
    when: int | None = None
    """Nanoseconds from any moment on, where a log with times says it."""


class _LinePiece(NamedTuple):
    """A line, or a run of characters of one that is long."""

    number: int
    text: str
    begins: bool
    ends: bool


def tagged_pieces(
    pieces: Iterator[bytes],
    senders: Sequence[str],
    complain: Complain,
    times: LineTimes | None = None,
) -> Iterator[Piece]:
    """Bytes of each line behind its sender; lines without a clear sender are complained of.

    Empty lines and those that begin with `#` say nothing. A sender may stand in upper case. With
    `times`, each line has to begin with one; the bytes of one that does not are read all the same.
    """
    reader = _Reader(senders, complain, times)
    for piece in _line_pieces(pieces):
        if piece.begins:
            reader.open(piece)
        else:
            reader.go_on(piece.text)
        yield from reader.read(ends=piece.ends)


def _line_pieces(pieces: Iterator[bytes]) -> Iterator[_LinePiece]:
    number, rest, begins = 1, "", True
    for decoded_piece in decoded(pieces):
        *whole, rest = (rest + decoded_piece).split("\n")
        for text in whole:
            yield _LinePiece(number, text, begins, ends=True)
            number, begins = number + 1, True
        if len(rest) > _LONG:
            yield _LinePiece(number, rest, begins, ends=False)
            rest, begins = "", False
    if rest or not begins:
        yield _LinePiece(number, rest, begins, ends=True)


class _Reader:
    """Reads one line after another."""

    def __init__(self, senders: Sequence[str], complain: Complain, times: LineTimes | None) -> None:
        self._times = times
        self._when: int | None = None
        self._senders = senders
        self._tag = _tag_pattern(senders)
        self._names = {name.casefold(): name for name in senders}
        self._complain = complain
        self._line = 0
        self._sender: str | None = None
        """Of the present line; None where nothing more can be read from it."""
        self._columns = 0
        """Characters in front of the bytes."""
        self._hex = HexReader()
        self._text = ""

    def open(self, piece: _LinePiece) -> None:
        """Begin a line."""
        self._line, self._sender, self._hex = piece.number, None, HexReader()
        if not piece.text.strip() or piece.text.lstrip().startswith("#"):
            return
        found = self._tag.match(piece.text)
        if found is None:
            self._complain(f"line {piece.number}: {self._mend()}")
            return
        self._sender = self._names[found["name"].casefold()]
        self._when = self._time(piece)
        self._columns = found.end()
        self._text = piece.text[found.end() :]

    def _time(self, piece: _LinePiece) -> int | None:
        if self._times is None:
            return None
        when = self._times.of(piece.text)
        if when is None:
            self._complain(
                f"line {piece.number}: no time in front: write `12:00:01.5 {self._sender}: 1B 02`"
            )
        return when

    def go_on(self, text: str) -> None:
        """Take more of the present line."""
        self._text = text

    def read(self, *, ends: bool) -> Iterator[Piece]:
        """The bytes of what was taken."""
        if self._sender is None:
            return
        try:
            data = self._hex.feed(self._text)
            whole = data + self._hex.finish() if ends else data
            yield Piece(self._sender, whole, self._when)
        except HexError as error:
            self._sender = None
            column = self._columns + error.column
            self._complain(f"line {self._line}, column {column}: {error.problem}")

    def _mend(self) -> str:
        first = self._senders[0]
        names = ", ".join(self._senders)
        return (
            f"no sender, or two, in front of the bytes: write `{first}: 1B 02` with one of {names}"
        )


def _tag_pattern(senders: Sequence[str]) -> re.Pattern[str]:
    """Match a line up to its bytes: what is in front, the only sender's name, and its end."""
    names = "|".join(map(re.escape, senders))
    word = rf"(?<!\w)(?:{names})(?!\w)"
    # Python before 3.11.5 matches possessive groups wrongly, but not atomic ones.
    return re.compile(
        rf"(?>(?:(?!{word})[^#])*)(?<![\w.-])(?P<name>{names})[ \t]*[\]>:]++"
        rf"(?![ \t]*{word}[ \t]*[\]>:])",
        re.IGNORECASE,
    )
