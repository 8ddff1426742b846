"""Changes inside of an immutable tree; what no change concerns stays the same object."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from enum import Enum

from protogen.schema.nodes import Item, MappingNode, Node, ScalarNode, SequenceNode
from protogen.schema.scalars import Scalar


class AnyItem(Enum):
    """A step of a path that stands for every item."""

    ITEM = "*"


ANY = AnyItem.ITEM

Step = Scalar | AnyItem
Path = tuple[Step, ...]
Edit = Callable[[Node], Node]
Names = Mapping[Scalar, ScalarNode]
"""Old names and what they become."""


def edit_at(node: Node, path: Sequence[Step], edit: Edit) -> Node:
    """Return the tree with ``edit`` applied wherever ``path`` leads to; it may lead nowhere."""
    if not path:
        return edit(node)
    step, rest = path[0], path[1:]
    if step is not ANY:
        return _edit_one(node, step, rest, edit)
    if isinstance(node, MappingNode):
        return _with_items(node, [(key, edit_at(value, rest, edit)) for key, value in node.items])
    if isinstance(node, SequenceNode):
        return _with_nodes(node, [edit_at(item, rest, edit) for item in node.items])
    return node


def items_of(node: Node | None) -> tuple[Item, ...]:
    """Return the items of a mapping; anything else has none."""
    return node.items if isinstance(node, MappingNode) else ()


def keys_of(node: Node | None) -> set[Scalar]:
    """Return the keys of a mapping; anything else has none."""
    return {key.value for key, _ in items_of(node)}


def rename_keys(node: Node, names: Names) -> Node:
    """Return a mapping with its keys renamed; they keep their positions."""
    if not isinstance(node, MappingNode):
        return node
    items = [(names.get(key.value, key), value) for key, value in node.items]
    return _with_items(node, items)


def rename_scalar(node: Node, names: Names) -> Node:
    """Return the new name if ``node`` is an old one."""
    new = names.get(node.value) if isinstance(node, ScalarNode) else None
    return node if new is None else ScalarNode(new.value, new.text, new.plain, node.span)


def rename_run(node: Node, names: Names) -> Node:
    """Return a run of parts renamed: a name, ``first..last``, or a list of such."""
    if isinstance(node, SequenceNode):
        return _with_nodes(node, [rename_run(item, names) for item in node.items])
    if not isinstance(node, ScalarNode) or not isinstance(node.value, str):
        return node
    ends = [names[name].text if name in names else name for name in node.text.split("..")]
    run = "..".join(ends)
    return node if run == node.text else ScalarNode(run, run, node.plain, node.span)


def _edit_one(node: Node, key: Scalar, rest: Sequence[Step], edit: Edit) -> Node:
    if not isinstance(node, MappingNode) or (item := node.item(key)) is None:
        return node
    edited = item[0], edit_at(item[1], rest, edit)
    if edited[1] is item[1]:
        return node
    return MappingNode(tuple(edited if old is item else old for old in node.items), node.span)


def _with_items(node: MappingNode, items: Sequence[Item]) -> MappingNode:
    unchanged = all(
        new_key is key and new_value is value
        for (new_key, new_value), (key, value) in zip(items, node.items, strict=True)
    )
    return node if unchanged else MappingNode(tuple(items), node.span)


def _with_nodes(node: SequenceNode, nodes: Sequence[Node]) -> SequenceNode:
    unchanged = all(new is old for new, old in zip(nodes, node.items, strict=True))
    return node if unchanged else SequenceNode(tuple(nodes), node.span)
