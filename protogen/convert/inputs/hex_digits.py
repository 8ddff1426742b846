r"""Bytes as people write and log them: `1B 02`, `1b02`, `0x1B,0x02`, `\x1b\x02`, `1B:02`.

Separators are white space, commas, colons and semicolons; `#` begins a comment that runs to the
end of the line. Digits without a separator are bytes of two digits each; behind `0x` a single
digit is a byte, too.
"""

from __future__ import annotations

import re
from string import hexdigits

from protogen.errors import UserError

_TOKEN = re.compile(
    r"(?P<pairs>(?:[0-9A-Fa-f]{2}[ \t\r\n]+)+)"  # what most files hold, read in one go
    r"|(?P<space>[\s,;:]+)"
    r"|(?P<comment>\#)"
    r"|(?P<prefix>0[xX]|\\[xX]|)(?P<digits>[0-9A-Fa-f]+)(?![xX])"
)
_UNFINISHED = re.compile(r"\\[xX]?|0[xX]")
_LONG = 1 << 16
"""A run of digits that is longer is read before its end is seen."""


class HexError(UserError, ValueError):
    """Text that stands for no bytes, and where. `line` and `column` count from 1."""

    def __init__(self, line: int, column: int, problem: str) -> None:
        super().__init__(f"line {line}, column {column}: {problem}")
        self.line = line
        self.column = column
        self.problem = problem


def parse_hex(text: str) -> bytes:
    """Return the bytes that ``text`` stands for. Raises HexError."""
    reader = HexReader()
    return reader.feed(text) + reader.finish()


class HexReader:
    """Reads text in pieces that may be cut anywhere, and holds no more than one long token."""

    def __init__(self) -> None:
        self._text = ""
        self._position = 0
        self._line = 1
        self._column = 1
        self._in_comment = False

    def feed(self, text: str) -> bytes:
        """Return the bytes that are complete with ``text``. Raises HexError."""
        self._text += text
        return self._read(final=False)

    def finish(self) -> bytes:
        """Return the bytes of what was held back; the text ends here. Raises HexError."""
        return self._read(final=True)

    def _read(self, *, final: bool) -> bytes:
        read = bytearray()
        while self._position < len(self._text):
            taken = self._comment() if self._in_comment else self._token(read, final=final)
            if not taken:
                break
            self._position += taken
        self._forget()
        return bytes(read)

    def _comment(self) -> int:
        """Return how many characters are comment."""
        end = self._text.find("\n", self._position)
        self._in_comment = end < 0
        return (len(self._text) if end < 0 else end) - self._position

    def _token(self, read: bytearray, *, final: bool) -> int:
        """Put the bytes of the next token into ``read`` and return its length; 0: wait for more."""
        found = _TOKEN.match(self._text, self._position)
        rest = self._text[self._position : self._position + 3]
        if found is None:
            if final or not _UNFINISHED.fullmatch(rest):
                raise self._stranger_error()
            return 0
        self._in_comment = found["comment"] is not None
        if found["digits"]:
            return self._digits(found, read, final=final)
        read += bytes.fromhex(found["pairs"] or "")
        return len(found[0])

    def _digits(self, found: re.Match[str], read: bytearray, *, final: bool) -> int:
        prefix, digits = found["prefix"], found["digits"]
        if found.end() == len(self._text) and not final:
            if len(digits) < _LONG:
                return 0
            digits = digits[: len(digits) // 2 * 2]
        if prefix in ("0x", "0X") and len(digits) == 1:
            digits = f"0{digits}"
        elif len(digits) % 2:
            raise self._odd_error(found)
        read += bytes.fromhex(digits)
        return len(prefix) + len(found["digits"][: len(digits)])

    def _odd_error(self, found: re.Match[str]) -> HexError:
        stranger = self._text[found.end() : found.end() + 1]
        if stranger and not _TOKEN.match(stranger) and not _UNFINISHED.match(stranger):
            self._position = found.end()
            return self._stranger_error()
        return self._error(f"`{found[0][-20:]}` has an odd number of hex digits")

    def _stranger_error(self) -> HexError:
        # A digit that fits nothing has an `x` behind it.
        self._position += self._text[self._position] in hexdigits
        stranger = self._text[self._position : self._position + 1]
        return self._error(f"`{stranger}` is no hex digit and no separator")

    def _forget(self) -> None:
        """Drop the text that was read, and keep count of lines and columns."""
        done, self._text = self._text[: self._position], self._text[self._position :]
        self._position = 0
        self._line, self._column = self._place(done)

    def _place(self, done: str) -> tuple[int, int]:
        breaks = done.count("\n")
        if not breaks:
            return self._line, self._column + len(done)
        return self._line + breaks, len(done) - done.rfind("\n")

    def _error(self, message: str) -> HexError:
        line, column = self._place(self._text[: self._position])
        return HexError(line, column, message)
