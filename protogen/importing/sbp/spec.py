"""One file of definitions -> what it defines.

A mistake in it is a DefinitionError with its place; a key that nobody knows is passed over, as it
may be one of a later version.
"""

from __future__ import annotations

import re
from collections.abc import Iterator

import msgspec

from protogen.importing.remarks import DefinitionError
from protogen.problems.span import Span
from protogen.schema.text.nodes import (
    MappingNode,
    Node,
    ScalarNode,
    SequenceNode,
    items_of,
    keys_of,
)
from protogen.schema.text.scalars import resolve

_GREATEST_BIT = 63
_RANGE = re.compile(r"\s*(\d{1,3})(?:\s*[-:]\s*(\d{1,3}))?\s*")


class Value(msgspec.Struct, frozen=True):
    """Number with a meaning."""

    number: int
    text: str
    span: Span


class BitRange(msgspec.Struct, frozen=True):
    """Bits of an integer, from `low` to `high`, both included."""

    low: int
    high: int
    desc: str
    values: tuple[Value, ...]
    span: Span


class FieldSpec(msgspec.Struct, frozen=True):
    """Field of a definition."""

    name: str
    type: str
    span: Span
    type_span: Span
    fill: str | None = None
    """Type of the elements of an array."""
    size: int | None = None
    size_fn: str | None = None
    """Field that counts the elements."""
    encoding: str | None = None
    units: str = ""
    desc: str = ""
    bits: tuple[BitRange, ...] = ()


class Definition(msgspec.Struct, frozen=True):
    """Message, if it has an id, or else a struct."""

    name: str
    id: int | None
    short_desc: str
    desc: str
    fields: tuple[FieldSpec, ...]
    replaced_by: tuple[str, ...]
    span: Span
    last_line: int
    is_basic: bool
    """True for a type that comes with the language of definitions, such as u8."""


class Include(msgspec.Struct, frozen=True):
    """File that another one includes."""

    path: str
    span: Span


class Package(msgspec.Struct, frozen=True):
    """What one file holds."""

    file: str
    name: str
    """Last word of the package: `navigation` of `swiftnav.sbp.navigation`."""
    desc: str
    includes: tuple[Include, ...]
    definitions: tuple[Definition, ...]
    is_rendered: bool
    """False for what is there for readers and no part of the protocol."""


def is_package(root: Node) -> bool:
    """True if a file holds definitions, or includes some."""
    keys = keys_of(root)
    return "package" in keys and bool({"definitions", "include"} & keys)


def read_package(root: Node, file: str) -> Package:
    """Return what a file defines. Raises DefinitionError."""
    name = _text_of(root, "package").rpartition(".")[2]
    includes = root.child("include")
    entries = _sequence(includes) if includes is not None else ()
    return Package(
        file,
        name,
        _text_of(root, "description"),
        tuple(Include(_text(item), item.span) for item in entries),
        tuple(_definitions(root)),
        _text_of(root, "render_source").lower() != "false",
    )


def _definitions(root: Node) -> Iterator[Definition]:
    seen: set[str] = set()
    for key, body in _named(root.child("definitions")):
        if key.text in seen:
            raise DefinitionError(key.span, f"there is a definition `{key.text}` already")
        seen.add(key.text)
        yield _definition(key, body)


def _definition(key: ScalarNode, body: Node) -> Definition:
    identity = body.child("id")
    kind = body.child("type")
    replaced = body.child("replaced_by")
    return Definition(
        key.text,
        None if identity is None else _integer(identity, "an id is a number such as 0x0102"),
        _text_of(body, "short_desc"),
        _text_of(body, "desc"),
        tuple(_field(name, value) for name, value in _named(body.child("fields"))),
        tuple(map(_text, _sequence(replaced))) if replaced is not None else (),
        key.span,
        max(key.span.line, body.span.end_line),
        kind is not None and _text(kind) in ("primitive", "collection"),
    )


def _field(key: ScalarNode, body: Node) -> FieldSpec:
    kind = body.child("type")
    if kind is None:
        raise DefinitionError(key.span, f"the field `{key.text}` has no type")
    size = body.child("size")
    return FieldSpec(
        key.text,
        _text(kind),
        key.span,
        kind.span,
        fill=_text_of(body, "fill") or None,
        size=None if size is None else _integer(size, "a size is a number"),
        size_fn=_text_of(body, "size_fn") or None,
        encoding=_text_of(body, "encoding") or None,
        units=_text_of(body, "units"),
        desc=_text_of(body, "desc"),
        bits=tuple(_bit_range(name, value) for name, value in _named(body.child("fields"))),
    )


def _bit_range(key: ScalarNode, body: Node) -> BitRange:
    found = _RANGE.fullmatch(key.text)
    low, high = (int(found[1]), int(found[2] or found[1])) if found else (1, 0)
    if low > high or high > _GREATEST_BIT:
        raise DefinitionError(key.span, f"`{key.text}` are no bits", "such as 3, or 0-2")
    values = tuple(_value(name, value) for name, value in _named(body.child("values")))
    return BitRange(low, high, _text_of(body, "desc"), values, key.span)


def _value(key: ScalarNode, body: Node) -> Value:
    return Value(_integer(key, "a value is a number"), _text(body), key.span)


# --- nodes --------------------------------------------------------------------------------------


def _named(node: Node | None) -> Iterator[tuple[ScalarNode, Node]]:
    """Yield the items of a list of mappings, or of one mapping."""
    if node is None or _is_empty(node):
        return
    for entry in _sequence(node) if isinstance(node, SequenceNode) else (node,):
        if not isinstance(entry, MappingNode):
            raise DefinitionError(entry.span, "here stands a name, a colon, and what it is")
        yield from items_of(entry)


def _sequence(node: Node) -> tuple[Node, ...]:
    if not isinstance(node, SequenceNode):
        raise DefinitionError(node.span, "here stands a list")
    return node.items


def _text_of(node: Node, key: str) -> str:
    child = node.child(key)
    return "" if child is None or _is_empty(child) else _text(child)


def _is_empty(node: Node) -> bool:
    return isinstance(node, ScalarNode) and node.plain and not node.text


def _text(node: Node) -> str:
    if not isinstance(node, ScalarNode):
        raise DefinitionError(node.span, "here stands a text")
    return node.text


def _integer(node: Node, hint: str) -> int:
    # Keys of JSON, which is YAML, stand between quotes.
    value = resolve(node.text) if isinstance(node, ScalarNode) else None
    if not isinstance(value, int) or isinstance(value, bool):
        raise DefinitionError(node.span, "this is no whole number", hint)
    return value
