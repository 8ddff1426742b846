"""The immutable tree of a document: scalars, mappings and sequences with their spans."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from typing import Any

import msgspec

from protogen.problems.span import Span
from protogen.schema.text.scalars import Scalar, SourceFloat, SourceInt

Loc = Sequence[Scalar]
"""A location: the keys and indices that lead from a node to one inside of it."""


class _Inside:
    """Access to the nodes inside of a node."""

    __slots__ = ()

    def child(self, step: Scalar) -> Node | None:
        """Return the node under a key or an index, or None if there is none."""
        return None

    def at(self, path: Loc) -> Node | None:
        """Return the node that ``path`` leads to, or None if there is none."""
        node: Any = self
        for step in path:
            node = None if node is None else node.child(step)
        found: Node | None = node
        return found


class ScalarNode(_Inside, msgspec.Struct, frozen=True, gc=False):
    """A single value; ``text`` is what was written, ``plain`` whether without quotes."""

    value: Scalar
    text: str
    plain: bool
    span: Span


Item = tuple[ScalarNode, "Node"]
"""A key of a mapping and its value."""


@dataclass(frozen=True, slots=True)
class MappingNode(_Inside):
    """Keys with values, in written order. Keys are texts, integers or booleans, each there once."""

    items: tuple[Item, ...]
    span: Span
    _index: dict[Scalar, Item] = field(init=False, repr=False, compare=False)

    def __post_init__(self) -> None:
        object.__setattr__(self, "_index", {item[0].value: item for item in self.items})

    def item(self, key: Scalar) -> Item | None:
        """Return the key node and the value node of ``key``, or None if there is no such key."""
        return self._index.get(key)

    def child(self, step: Scalar) -> Node | None:
        """Return the value of the key ``step``, or None if there is no such key."""
        item = self._index.get(step)
        return None if item is None else item[1]


@dataclass(frozen=True, slots=True)
class SequenceNode(_Inside):
    """Values in written order."""

    items: tuple[Node, ...]
    span: Span

    def child(self, step: Scalar) -> Node | None:
        """Return the value at the index ``step``, or None if there is none."""
        if isinstance(step, int) and 0 <= step < len(self.items):
            return self.items[step]
        return None


Node = ScalarNode | MappingNode | SequenceNode


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


def to_data(node: Node) -> Any:
    """Return the tree as dictionaries, lists and scalars.

    Numbers are `SourceInt` and `SourceFloat`, which know how they were written; keys are plain.
    """
    if isinstance(node, MappingNode):
        return {key.value: to_data(value) for key, value in node.items}
    if isinstance(node, SequenceNode):
        return [to_data(item) for item in node.items]
    value = node.value
    if isinstance(value, str | bool):
        return value
    if isinstance(value, int):
        return SourceInt.of(value, node.text)
    return SourceFloat.of(value, node.text) if isinstance(value, float) else value


def find(root: Node, loc: Loc, *, key: bool = False) -> Span:
    """Return the place that an error location of pydantic means, as far as the tree has it.

    Components that name nothing in the tree, such as the label of a tagged union, are skipped.
    Where one names something only by chance, the reading that explains more of the location wins.
    With ``key``, or if the location ends in ``[key]``, the place is that of the last key instead
    of its value.
    """
    if loc and loc[-1] == "[key]":
        return find(root, loc[:-1], key=True)
    item, node = _straight(root, loc) or _Places(loc).follow(root, 0)[1:]
    return item[0].span if key and item is not None else node.span


def _straight(node: Node, loc: Loc) -> tuple[Item | None, Node] | None:
    """Return the last key and its value where every component is a key of the one before."""
    item: Item | None = None
    for step in loc:
        if isinstance(node, MappingNode):
            item = node.item(step)
            child = None if item is None else item[1]
        else:
            item, child = None, node.child(step)
        if child is None:
            return None
        node = child
    return item, node


_Found = tuple[int, Item | None, Node]
"""Number of components that led somewhere, the item that the last one led to, and its node."""


class _Places:
    """Nodes that a location leads to; each is looked up once, as locations may repeat names."""

    def __init__(self, loc: Loc) -> None:
        self._loc = loc
        self._found: dict[tuple[int, int], _Found] = {}

    def follow(self, node: Node, start: int) -> _Found:
        """Follow the components from `start` on, as many of them as lead somewhere."""
        key = (id(node), start)
        if key not in self._found:
            self._found[key] = self._follow(node, start)
        return self._found[key]

    def _follow(self, node: Node, start: int) -> _Found:
        best: _Found = (0, None, node)
        for position in range(start, len(self._loc)):
            if best[0] >= len(self._loc) - position:
                break
            step = self._loc[position]
            child = node.child(step)
            if child is None:
                continue
            found = self.follow(child, position + 1)
            if found[0] + 1 > best[0]:
                own = node.item(step) if isinstance(node, MappingNode) else None
                best = (found[0] + 1, found[1] if found[0] else own, found[2])
        return best
