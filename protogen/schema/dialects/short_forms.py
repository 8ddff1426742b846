"""Short forms of a base, written out where a dialect puts a mapping over them.

`speed: uint8` says `speed: {type: uint8}`, so a dialect may add a unit to it.
"""

from __future__ import annotations

from functools import partial
from typing import Any

from protogen.schema.references import form_under
from protogen.schema.syntax.forms import Form
from protogen.schema.syntax.protocol import SCHEMA
from protogen.schema.text.nodes import MappingNode, Node, ScalarNode, edit_at, items_of, to_data

_OTHER_KINDS = ("fields", "switch")
"""Keys of a field that make it something else, so that the base's type is not meant."""


def expand_short_forms(base: Node, dialect: Node) -> Node:
    """Return the base with a mapping for each short form that a mapping of the dialect meets."""
    return _expanded(SCHEMA, dialect, to_data(base), base)


def _expanded(form: Form, stated: Node, data: Any, node: Node) -> Node:
    if not isinstance(stated, MappingNode):
        return node
    if isinstance(node, ScalarNode):
        is_meant = form.short and not (form.short == "type" and _is_other(stated))
        return _long(form.short or "", node) if is_meant else node
    for key, value in items_of(stated):
        expand = partial(_expanded, form_under(data, form, key.value), value, data)
        node = edit_at(node, key.value, expand)
    return node


def _is_other(stated: MappingNode) -> bool:
    return any(stated.child(key) is not None for key in _OTHER_KINDS)


def _long(key: str, short: Node) -> Node:
    return MappingNode(((ScalarNode(key, key, True, short.span), short),), short.span)
