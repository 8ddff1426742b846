"""A file -> an immutable tree of nodes, each with its span."""

from __future__ import annotations

import os
import re
from collections.abc import Iterator
from pathlib import Path

import msgspec

from protogen.problems import Problem, Problems, SourceMap, Span
from protogen.problems.sources import end_of, split_lines
from protogen.schema.text.compose import FAST_LOADER, Loader, compose
from protogen.schema.text.nodes import Loc, Node, find

GREATEST_SIZE = 8 * 1024 * 1024
"""The most bytes that a file may have."""

# What YAML calls printable, without the breaks that only YAML 1.1 counts as line breaks and
# without the byte order mark, which has no business inside of a text.
_FORBIDDEN = re.compile(
    "[^\t\n\r\x20-\x7e\xa0-\u2027\u202a-\ud7ff\ue000-\ufefe\uff00-\ufffd\U00010000-\U0010ffff]"
)
_STAND_IN = "\N{REPLACEMENT CHARACTER}"
_COMMENT = re.compile(r"(?:^| )#")
_CONFLICT_MARK = "<<<<<<< "
_CONFLICT = re.compile(rf"^{_CONFLICT_MARK}.*$", re.MULTILINE)
_BYTE_ORDER_MARK = "\ufeff"
_UTF16_MARKS = (b"\xff\xfe", b"\xfe\xff")


class Document(msgspec.Struct, frozen=True):
    """The tree of one file. ``file`` is its name as in spans; the text has no byte order mark."""

    root: Node
    file: str
    source_text: str

    def find(self, loc: Loc, *, key: bool = False) -> Span:
        """Return the place that an error location means, as far as the document has it."""
        return find(self.root, loc, key=key)


def read_document(
    path: str | os.PathLike[str], problems: Problems, sources: SourceMap
) -> Document | None:
    """Read the file at ``path``; spans name it as ``path`` does.

    Whatever is wrong with it is reported. None is returned where that leaves nothing to go on
    with; otherwise the tree lacks only what can't be used, such as the second of two equal keys.
    """
    file = os.fspath(path)
    try:
        data = read_bytes(file)
    except (OSError, ValueError) as error:
        problems.add("PG001", Span.of_file(file), f"the file can't be read: {reason(error)}")
        return None
    return decode_document(data, file, problems, sources)


def read_bytes(file: str) -> bytes:
    """Return the bytes of ``file``, but no more than one above `GREATEST_SIZE`.

    Raises OSError if the file can't be read and ValueError if its name can't be one.
    """
    with Path(file).open("rb") as stream:
        return stream.read(GREATEST_SIZE + 1)


def reason(error: OSError | ValueError) -> str:
    """Return why a file could not be read, without its name."""
    return (isinstance(error, OSError) and error.strerror) or str(error)


def decode_document(
    data: bytes, file: str, problems: Problems, sources: SourceMap
) -> Document | None:
    """Return the document in the bytes of ``file``, and give its text to ``sources``."""
    if len(data) > GREATEST_SIZE:
        problems.add("PG003", Span.of_file(file), "the file is larger than 8 MiB")
        return None
    try:
        text = data.decode("utf-8")
    except UnicodeDecodeError as error:
        _report_encoding(error, file, problems, sources)
        return None
    sources.add(file, text.removeprefix(_BYTE_ORDER_MARK))
    return parse_document(text, file, problems)


def parse_document(
    text: str, file: str, problems: Problems, *, loader: Loader = FAST_LOADER
) -> Document | None:
    """Return the document in ``text``, or None where what is wrong leaves nothing to go on with.

    Never raises for any text.
    """
    text = text.removeprefix(_BYTE_ORDER_MARK)
    conflict = _CONFLICT.search(text) if _CONFLICT_MARK in text else None
    if conflict is not None:
        line = text.count("\n", 0, conflict.start()) + 1
        words = "a merge left a conflict here"
        hint = "keep what is right of both sides, and remove the lines with the marks"
        problems.add("PG004", Span.at(file, line, 1, 7), words, hint)
        return None
    spoiled = Problems(_character_problems(text, file))
    problems.extend(spoiled)
    found = Problems()
    readable = _FORBIDDEN.sub(_STAND_IN, text) if spoiled else text
    root = compose(readable.replace("\t", " "), file, found, loader=loader)
    problems.extend(found if not spoiled else _unrelated(found, spoiled))
    return None if root is None or spoiled else Document(root, file, text)


def _unrelated(found: Problems, spoiled: Problems) -> Iterator[Problem]:
    """Yield what stands before the first bad character, unless it is its consequence."""
    first = min(problem.sort_key for problem in spoiled)
    return (item for item in found if item.sort_key < first and item.code != "PG004")


def _character_problems(text: str, file: str) -> Iterator[Problem]:
    """Yield the first tab and the first forbidden character of each line."""
    if "\t" not in text and _FORBIDDEN.search(text) is None:
        return
    for number, line in enumerate(split_lines(text), start=1):
        yield from _tab_problems(line, file, number)
        if forbidden := _FORBIDDEN.search(line):
            character = f"{ord(forbidden[0]):04X}"
            yield Problem.of(
                "PG004",
                Span.at(file, number, forbidden.start() + 1),
                f"the character U+{character} is not allowed",
                "between double quotes it can be written as an escape",
            )


def _tab_problems(line: str, file: str, number: int) -> Iterator[Problem]:
    tab = line.find("\t")
    comment = _COMMENT.search(line)
    if tab < 0 or (comment is not None and comment.start() < tab):
        return
    span = Span.at(file, number, tab + 1)
    if line[:tab].strip(" "):
        hint = "use spaces, or `\\t` between double quotes"
        yield Problem.of("PG005", span, "a tab stands between other characters", hint)
    else:
        yield Problem.of("PG005", span, "a tab stands in the indentation", "indent with spaces")


def _report_encoding(
    error: UnicodeDecodeError, file: str, problems: Problems, sources: SourceMap
) -> None:
    data: bytes = error.object
    text = data.decode("utf-8", "replace").removeprefix(_BYTE_ORDER_MARK)
    sources.add(file, text)
    place = end_of(data[: error.start].decode("utf-8").removeprefix(_BYTE_ORDER_MARK))
    hint = "save the file as UTF-8"
    if data.startswith(_UTF16_MARKS):
        hint = "this looks like UTF-16; save the file as UTF-8"
    message = f"the byte 0x{data[error.start]:02X} is not UTF-8"
    problems.add("PG002", Span.at(file, place.line, place.column), message, hint)
