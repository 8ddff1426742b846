"""Lines of text out of pieces of bytes: UTF-8, or UTF-16 where a mark in front says so.

Windows PowerShell writes UTF-16 into a file that the output of a command is sent to.
"""

from __future__ import annotations

import codecs
from collections.abc import Iterable, Iterator

from protogen.convert.errors import ConvertError

_LONGEST_LINE = 1 << 24
_MARKS = (codecs.BOM_UTF16_LE, codecs.BOM_UTF16_BE)


def encoding_of(head: bytes) -> str:
    """Encoding of text that begins with these bytes, at least two of them."""
    return "utf-16" if head.startswith(_MARKS) else "utf-8-sig"


def decoded(pieces: Iterable[bytes]) -> Iterator[str]:
    """The text that the bytes are. What is none becomes U+FFFD."""
    decoder: codecs.IncrementalDecoder | None = None
    waiting = b""
    for piece in pieces:
        waiting += piece
        if decoder is None:
            if len(waiting) < len(codecs.BOM_UTF16):
                continue
            decoder = codecs.getincrementaldecoder(encoding_of(waiting))("replace")
        yield decoder.decode(waiting)
        waiting = b""
    yield waiting.decode("utf-8", "replace") if decoder is None else decoder.decode(b"", True)


def lines_of(pieces: Iterable[bytes], place: str | None = None) -> Iterator[str]:
    """The lines, without what ends them. Raises ConvertError where one does not end."""
    rest = ""
    for text in decoded(pieces):
        *whole, rest = (rest + text).split("\n")
        yield from whole
        if len(rest) > _LONGEST_LINE:
            where = "" if place is None else f"{place}: "
            problem = f"a line has over {_LONGEST_LINE} characters: this is no text"
            raise ConvertError(f"{where}{problem}")
    if rest:
        yield rest
