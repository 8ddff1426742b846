"""Where a field, or a declared type, is used: what a rename inside of it has to follow."""

from __future__ import annotations

from collections.abc import Iterator

from protogen.schema.edit import items_of
from protogen.schema.nodes import Node, ScalarNode
from protogen.schema.scalars import Scalar

Place = tuple[Scalar, ...]
"""Keys that lead from the root to a field or a declared type."""


def places_of(root: Node, place: Place, seen: frozenset[Scalar] = frozenset()) -> Iterator[Place]:
    """Yield a field's own place and, for a declared type, that of each field that comes to it."""
    yield place
    if len(place) == 2 and place[0] == "types" and place[1] not in seen:
        seen |= {place[1]}
        for used in _of_type(root, place[1]):
            yield from places_of(root, used, seen)


def example_steps(
    root: Node, place: Place, seen: frozenset[Scalar] = frozenset()
) -> Iterator[tuple[Scalar, Place]]:
    """Yield where the values of a field stand: messages, and the steps in an example's `values`.

    The place of a message is that of all its values. Values do not say which case of a switch they
    belong to, so those of fields inside of a case are not found.
    """
    kind, owner, *inside = place
    if any(step != "fields" for step in inside[::2]):
        return
    steps = tuple(inside[1::2])
    if kind == "messages":
        yield owner, steps
    elif owner not in seen:
        for used in _of_type(root, owner):
            for message, outer in example_steps(root, used, seen | {owner}):
                yield message, (*outer, *steps)


def _of_type(root: Node, name: Scalar) -> Iterator[Place]:
    """Yield each field and declared type whose `type` has this name."""
    for place, written in _everything(root):
        named = written if isinstance(written, ScalarNode) else written.child("type")
        if isinstance(named, ScalarNode) and named.value == name:
            yield place


def _everything(root: Node) -> Iterator[tuple[Place, Node]]:
    """Yield each field and declared type, those inside of others included."""
    for key, declared in items_of(root.child("types")):
        yield from _field(("types", key.value), declared)
    for key, message in items_of(root.child("messages")):
        for name, item in items_of(message.child("fields")):
            yield from _field(("messages", key.value, "fields", name.value), item)


def _field(place: Place, item: Node) -> Iterator[tuple[Place, Node]]:
    yield place, item
    for key in ("fields", "cases"):
        for name, inner in items_of(item.child(key)):
            yield from _field((*place, key, name.value), inner)
