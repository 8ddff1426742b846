"""XML of definitions -> elements with their places.

A document type can let a few bytes become gigabytes, or read other files: none is taken.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import NoReturn
from xml.parsers.expat import ExpatError, ParserCreate, errors

import msgspec

from protogen.importing.remarks import DefinitionError
from protogen.problems.span import Span

GREATEST_SIZE = 16 * 1024 * 1024
"""The most bytes that a file may have."""
GREATEST_DEPTH = 32
"""The most elements that may lie in each other."""

_CHARACTERS = (errors.XML_ERROR_INVALID_TOKEN, errors.XML_ERROR_UNDEFINED_ENTITY)


class Element(msgspec.Struct):
    """Element of a file: its name, its attributes, its text and the elements in it."""

    tag: str
    attributes: Mapping[str, str]
    span: Span
    children: list[Element]
    text: str = ""
    """Its own text, without that of the elements in it."""
    last_line: int = 0

    def all(self, tag: str) -> Iterator[Element]:
        """Yield the elements in it of a name."""
        return (child for child in self.children if child.tag == tag)

    def first(self, tag: str) -> Element | None:
        """Return the first element in it of a name."""
        return next(self.all(tag), None)

    def needed(self, attribute: str) -> str:
        """Return an attribute that has to be there. Raises DefinitionError."""
        value = self.attributes.get(attribute, "").strip()
        if not value:
            hint = f'<{self.tag} {attribute}="..."'
            raise DefinitionError(self.span, f"this `{self.tag}` has no `{attribute}`", hint)
        return value


def read_xml(path: Path) -> Element:
    """Return the root of a file. Raises DefinitionError, with the place of the mistake."""
    file = str(path)
    try:
        data = path.read_bytes()
    except OSError as error:
        reason = error.strerror or str(error)
        raise DefinitionError(Span.of_file(file), f"the file can't be read: {reason}") from None
    if len(data) > GREATEST_SIZE:
        message = f"the file has more than {GREATEST_SIZE // 1024**2} MiB"
        raise DefinitionError(Span.of_file(file), message)
    return _Reader(file).read(data)


class _Reader:
    """Takes what the parser finds."""

    def __init__(self, file: str) -> None:
        self._file = file
        self._open: list[Element] = []
        self._root: Element | None = None
        self._parser = ParserCreate()
        self._parser.buffer_text = True
        self._parser.StartElementHandler = self._start
        self._parser.EndElementHandler = self._end
        self._parser.CharacterDataHandler = self._characters
        self._parser.StartDoctypeDeclHandler = self._doctype

    def read(self, data: bytes) -> Element:
        try:
            self._parser.Parse(data, True)
        except ExpatError as error:
            raise self._mistake(error) from None
        except (LookupError, ValueError) as error:
            # The parser leaves encodings that it does not have to Python's codecs.
            raise DefinitionError(self._here(), f"this can't be read: {error}") from None
        assert self._root is not None
        return self._root

    def _here(self) -> Span:
        line, column = self._parser.CurrentLineNumber, self._parser.CurrentColumnNumber
        return Span.at(self._file, line, column + 1)

    def _mistake(self, error: ExpatError) -> DefinitionError:
        cause = errors.messages.get(error.code, str(error))
        hint = None
        if cause in _CHARACTERS:
            hint = "in a text, & is &amp; and < is &lt;; other characters are those of the encoding"
        elif self._open:
            inner = self._open[-1]
            hint = f"`{inner.tag}` of line {inner.span.line} is open here"
        elif self._root is None:
            hint = "a file of definitions is XML, and begins with <"
        span = Span.at(self._file, error.lineno, error.offset + 1)
        return DefinitionError(span, f"this is no XML: {cause}", hint)

    def _start(self, tag: str, attributes: dict[str, str]) -> None:
        if len(self._open) == GREATEST_DEPTH:
            message = f"more than {GREATEST_DEPTH} elements lie in each other here"
            raise DefinitionError(self._here(), message)
        element = Element(tag, attributes, self._here(), [])
        if self._open:
            self._open[-1].children.append(element)
        else:
            self._root = element
        self._open.append(element)

    def _end(self, _tag: str) -> None:
        self._open.pop().last_line = self._parser.CurrentLineNumber

    def _characters(self, text: str) -> None:
        self._open[-1].text += text

    def _doctype(self, *_: object) -> NoReturn:
        hint = "take out <!DOCTYPE ...>, and write what its entities stand for"
        raise DefinitionError(self._here(), "a document type is not read", hint)
