"""Reads and changes of an immutable tree that take any node."""

from __future__ import annotations

from collections.abc import Callable

from protogen.schema.text.nodes import Item, MappingNode, Node
from protogen.schema.text.scalars import Scalar


def edit_at(node: Node, key: Scalar, edit: Callable[[Node], Node]) -> Node:
    """Return the mapping with the value of ``key`` edited; anything else as it is."""
    if not isinstance(node, MappingNode) or node.item(key) is None:
        return node
    items = ((name, edit(value) if name.value == key else value) for name, value in node.items)
    return MappingNode(tuple(items), node.span)


def items_of(node: Node | None) -> tuple[Item, ...]:
    """Return the items of a mapping; anything else has none."""
    return node.items if isinstance(node, MappingNode) else ()


def keys_of(node: Node | None) -> set[Scalar]:
    """Return the keys of a mapping; anything else has none."""
    return {key.value for key, _ in items_of(node)}
