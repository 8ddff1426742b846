"""A dialect that states a frame per sender, over a base that has one for all.

The base's frame then stands for each endpoint, so that the dialect states only what differs.
"""

from __future__ import annotations

from functools import partial

from protogen.schema.dialects.directives import read_directives
from protogen.schema.syntax.protocol import is_by_sender
from protogen.schema.text.nodes import MappingNode, Node, edit_at, items_of, keys_of, to_data
from protogen.schema.text.scalars import Scalar

_SHARED = ("frame", "transparency")


def spread_shared(base: Node, dialect: Node) -> Node:
    """Return the base, saying for each sender what it says for all, where the dialect does so."""
    endpoints = base.child("endpoints")
    known = keys_of(endpoints) | _renamed(dialect.child("endpoints"))
    for key in _SHARED:
        if _keyed_by_endpoint(dialect.child(key), known) and not is_by_sender(to_data(base), key):
            base = edit_at(base, key, partial(_for_each, endpoints))
    return base


def _keyed_by_endpoint(stated: Node | None, known: set[Scalar]) -> bool:
    return bool(keys_of(stated)) and keys_of(stated) <= known


def _renamed(endpoints: Node | None) -> set[Scalar]:
    """The new names that a dialect has for endpoints of the base."""
    if not isinstance(endpoints, MappingNode):
        return set()
    return {new.value for _, new in read_directives(endpoints).renames}


def _for_each(endpoints: Node | None, shared: Node) -> Node:
    return MappingNode(tuple((name, shared) for name, _ in items_of(endpoints)), shared.span)
