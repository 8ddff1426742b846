"""Where a dialect puts a mapping over a short form of the base: what the short form stands for.

`speed: uint8` says `speed: {type: uint8}`, so a dialect may add a unit to it.
"""

from __future__ import annotations

from collections.abc import Sequence

from protogen.schema.edit import edit_at, items_of
from protogen.schema.nodes import MappingNode, Node, ScalarNode
from protogen.schema.scalars import Scalar

_ENTRIES = {"values": "value", "special": "value", "flags": "bit", "bits": "bits"}
"""Keys of a field whose entries have a short form, and the key that it stands for."""
_OTHER_KINDS = ("fields", "switch")
"""Keys of a field that make it something else, so that the base's type is not meant."""


def expand_short_forms(base: Node, dialect: Node) -> Node:
    """Return the base with a mapping for each short form that a mapping of the dialect meets."""
    return _expand(base, (), dialect)


def _expand(root: Node, path: tuple[Scalar, ...], stated: Node) -> Node:
    if not isinstance(stated, MappingNode):
        return root
    key = _short_key(path)
    here = root.at(path)
    if isinstance(here, ScalarNode):
        is_meant = key is not None and not (key == "type" and _is_other(stated))
        return edit_at(root, path, lambda node: _long(key or "", node)) if is_meant else root
    for name, value in items_of(stated):
        root = _expand(root, (*path, name.value), value)
    return root


def _is_other(stated: MappingNode) -> bool:
    return any(stated.child(key) is not None for key in _OTHER_KINDS)


def _long(key: str, short: Node) -> Node:
    return MappingNode(((ScalarNode(key, key, True, short.span), short),), short.span)


def _short_key(path: Sequence[Scalar]) -> str | None:
    """The key that a bare value at this place stands for."""
    match tuple(path):
        case ("endpoints", _):
            return "title"
        case ("transparency",) | ("transparency", _):
            return "preset"
        case ("types", _, *inside) | ("messages", _, "fields", _, *inside):
            return _key_in_field(inside)
    return "lines" if len(path) > 1 and path[-1] == "source" else None


def _key_in_field(inside: Sequence[Scalar]) -> str | None:
    """The same, seen from a field or declared type."""
    while len(inside) > 1 and inside[0] in ("fields", "cases"):
        inside = inside[2:]
    match tuple(inside):
        case ():
            return "type"
        case (str(key), _) if key in _ENTRIES:
            return _ENTRIES[key]
        case ("bits", _, "values", _):
            return "value"
        case (*_, "source"):
            return "lines"
    return None
