"""One XML file of a dialect -> what it defines.

A mistake in it is a DefinitionError with its place; an element or an attribute that nobody knows is
passed over, as it may be one of a later version.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator

import msgspec

from protogen.importing.remarks import DefinitionError
from protogen.importing.xml_text import Element
from protogen.problems import hint_for
from protogen.problems.span import Span

SIZES = {
    "char": 1, "int8_t": 1, "uint8_t": 1, "int16_t": 2, "uint16_t": 2, "int32_t": 4,
    "uint32_t": 4, "int64_t": 8, "uint64_t": 8, "float": 4, "double": 8,
}  # fmt: skip
"""Bytes of each type."""
VERSION_TYPE = "uint8_t_mavlink_version"
LARGEST_ID = 0xFFFFFF
DEFAULT_VERSION = 2
"""What mavgen takes as the version of a file that does not say it."""

_TYPE = re.compile(r"([a-z0-9_]+)(?:\[(\d+)\])?")
_NUMBER = re.compile(r"[-+]?(?:0[xX][0-9a-fA-F]+|0[bB][01]+|\d+)")
_POWER = re.compile(r"(\d+)\s*(\*\*|<<)\s*(\d{1,2})")
_LIFE = ("deprecated", "superseded", "wip")
_GREATEST_LENGTH = 255


class Life(msgspec.Struct, frozen=True):
    """What a definition says of its future: it is out of use, or not ready yet."""

    kind: str
    since: str
    replaced_by: str
    text: str


class Param(msgspec.Struct, frozen=True):
    """One of the seven parameters of a command."""

    index: str
    text: str
    attributes: dict[str, str]


class Entry(msgspec.Struct, frozen=True):
    """Named value of an enum."""

    name: str
    value: int | None
    """None if it follows from the entries in front of it."""
    text: str
    life: Life | None
    params: tuple[Param, ...]
    has_location: bool
    span: Span


class Enum(msgspec.Struct, frozen=True):
    """Enum, or what a file adds to one."""

    name: str
    text: str
    life: Life | None
    is_bitmask: bool
    entries: tuple[Entry, ...]
    span: Span
    last_line: int


class FieldSpec(msgspec.Struct, frozen=True):
    """Field of a message, with the attributes that it has."""

    name: str
    type: str
    """Type of an element, one of `SIZES`."""
    count: int | None
    """Number of elements of an array."""
    is_version: bool
    is_extension: bool
    text: str
    attributes: dict[str, str]
    span: Span

    @property
    def size(self) -> int:
        """Bytes of an element."""
        return SIZES[self.type]

    @property
    def wire_size(self) -> int:
        """Bytes of all of it."""
        return self.size * (self.count or 1)


class Message(msgspec.Struct, frozen=True):
    """Message, with its fields in the order of the definition."""

    name: str
    id: int
    text: str
    life: Life | None
    fields: tuple[FieldSpec, ...]
    span: Span
    last_line: int


class Include(msgspec.Struct, frozen=True):
    """File that another one includes."""

    path: str
    span: Span


class Dialect(msgspec.Struct, frozen=True):
    """What one file holds."""

    file: str
    version: int
    number: str
    """Number of the dialect, or an empty text."""
    includes: tuple[Include, ...]
    enums: tuple[Enum, ...]
    messages: tuple[Message, ...]


def read_dialect(root: Element, file: str) -> Dialect:
    """Return what a file defines. Raises DefinitionError."""
    if root.tag != "mavlink":
        hint = "such a file begins with <mavlink>"
        message = f"these are no definitions of MAVLink, but `{root.tag}`"
        raise DefinitionError(root.span, message, hint)
    version, number = root.first("version"), root.first("dialect")
    messages = tuple(map(_message, _inside(root, "messages", "message")))
    _check_unique(messages, "message")
    return Dialect(
        file,
        DEFAULT_VERSION if version is None else _whole(version.text.strip(), version),
        "" if number is None else number.text.strip(),
        tuple(Include(item.text.strip(), item.span) for item in root.all("include")),
        tuple(map(_enum, _inside(root, "enums", "enum"))),
        messages,
    )


def _inside(root: Element, outer: str, inner: str) -> Iterator[Element]:
    for group in root.all(outer):
        yield from group.all(inner)


# --- enums --------------------------------------------------------------------------------------


def _enum(element: Element) -> Enum:
    entries = tuple(map(_entry, element.all("entry")))
    _check_unique(entries, "entry")
    return Enum(
        element.needed("name"),
        _description(element),
        _life(element),
        element.attributes.get("bitmask") == "true",
        entries,
        element.span,
        element.last_line,
    )


def _entry(element: Element) -> Entry:
    value = element.attributes.get("value")
    return Entry(
        element.needed("name"),
        None if value is None else _value(value.strip(), element),
        _description(element),
        _life(element),
        tuple(
            Param(item.needed("index"), item.text, dict(item.attributes))
            for item in element.all("param")
        ),
        element.attributes.get("hasLocation") == "true",
        element.span,
    )


def _value(text: str, element: Element) -> int:
    """Return a value, which may be a power: 2**9, 1<<9."""
    found = _POWER.fullmatch(text)
    if found is None:
        return _whole(text, element)
    base, exponent = int(found[1]), int(found[3])
    return base**exponent if found[2] == "**" else base << exponent


def _life(element: Element) -> Life | None:
    for child in element.children:
        if child.tag in _LIFE:
            since = child.attributes.get("since", "").strip()
            replaced = child.attributes.get("replaced_by", "").strip()
            return Life(child.tag, since, replaced, f"{child.text} {_description(child)}")
    return None


# --- messages -----------------------------------------------------------------------------------


def _message(element: Element) -> Message:
    number = _whole(element.needed("id"), element)
    if not 0 <= number <= LARGEST_ID:
        message = f"the id {number} is none: it has three bytes"
        raise DefinitionError(element.span, message, f"from 0 to {LARGEST_ID}")
    fields = tuple(_fields(element))
    _check_unique(fields, "field")
    return Message(
        element.needed("name"),
        number,
        _description(element),
        _life(element),
        fields,
        element.span,
        element.last_line,
    )


def _fields(message: Element) -> Iterator[FieldSpec]:
    is_extension = False
    for child in message.children:
        if child.tag == "extensions":
            is_extension = True
        elif child.tag == "field":
            yield _field(child, is_extension=is_extension)


def _field(element: Element, *, is_extension: bool) -> FieldSpec:
    written = element.needed("type")
    found = _TYPE.fullmatch(written)
    base = found[1] if found else written
    count = int(found[2]) if found and found[2] else None
    # As mavgen has them: another name for bytes with a sign, and numbers without `_t`.
    base = "int8_t" if base == "array" else base
    kind = next((name for name in (base, f"{base}_t") if name in SIZES), None)
    is_version = written == VERSION_TYPE
    if kind is None and not is_version:
        hint = hint_for(base, [*SIZES, VERSION_TYPE])
        raise DefinitionError(element.span, f"there is no type `{written}`", hint)
    if count is not None and not 0 < count <= _GREATEST_LENGTH:
        message = f"an array of {count} elements"
        raise DefinitionError(element.span, message, f"it has 1 to {_GREATEST_LENGTH}")
    return FieldSpec(
        element.needed("name"),
        kind or "uint8_t",
        count,
        is_version,
        is_extension,
        f"{element.text} {_description(element)}",
        dict(element.attributes),
        element.span,
    )


def _description(element: Element) -> str:
    child = element.first("description")
    return "" if child is None else child.text


def _whole(text: str, element: Element) -> int:
    if not _NUMBER.fullmatch(text):
        message = f"`{text}` of this `{element.tag}` is no whole number"
        raise DefinitionError(element.span, message, "such as 3, or 0x10")
    digits = text.lstrip("+-").lower()
    number = int(digits, {"0x": 16, "0b": 2}.get(digits[:2], 10))
    return -number if text.startswith("-") else number


def _check_unique(items: Iterable[Message | FieldSpec | Entry], what: str) -> None:
    seen: dict[str, Span] = {}
    for item in items:
        if item.name in seen:
            message = f"the {what} `{item.name}` is there already, in line {seen[item.name].line}"
            raise DefinitionError(item.span, message, "each has a name of its own")
        seen[item.name] = item.span
