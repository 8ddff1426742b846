"""The words by which a dialect says how it differs from its base.

A directive is known by its key and by the shape of its value, so that an item may have the same
name: it is a mapping, or a number in a mapping of names to numbers.
"""

from __future__ import annotations

import msgspec

from protogen.problems import Problems
from protogen.schema.text.nodes import Item, MappingNode, Node, ScalarNode, SequenceNode

_FORMS = {
    "rename": "`rename` takes a mapping of old names to new ones",
    "remove": "`remove` takes a list of names",
    "replace": "`replace` takes `true`",
}
_PLACES = ("after", "before")
DIRECTIVES = frozenset({*_FORMS, *_PLACES})
"""Words that no name of a schema can be: a dialect could not tell them apart."""

Rename = tuple[ScalarNode, ScalarNode]
"""An old name and the new one."""


class Directives(msgspec.Struct, frozen=True):
    """Directives of a mapping of a dialect, about the mapping of the base that it meets."""

    renames: tuple[Rename, ...] = ()
    removed: tuple[ScalarNode, ...] = ()
    replace: ScalarNode | None = None
    """The key of ``replace: true``."""
    items: tuple[Item, ...] = ()
    """The items that are no directives."""
    misused: tuple[ScalarNode, ...] = ()
    """The keys of directives whose value has the wrong shape."""


class Placement(msgspec.Struct, frozen=True):
    """``after: name`` or ``before: name`` in the mapping of an item."""

    where: str
    neighbour: ScalarNode


def read_directives(mapping: MappingNode) -> Directives:
    """Tell the directives in ``mapping`` from its items."""
    renames: tuple[Rename, ...] = ()
    removed: tuple[ScalarNode, ...] = ()
    replace: ScalarNode | None = None
    items: list[Item] = []
    misused: list[ScalarNode] = []
    for key, value in mapping.items:
        if key.value == "rename" and isinstance(value, MappingNode) and _names_names(value):
            renames = tuple((old, new) for old, new in value.items if isinstance(new, ScalarNode))
        elif key.value == "remove" and isinstance(value, SequenceNode) and _all_names(value):
            removed = tuple(item for item in value.items if isinstance(item, ScalarNode))
        elif key.value == "replace" and isinstance(value, ScalarNode) and value.value is True:
            replace = key
        elif key.value in _FORMS and not _may_be_item(value):
            misused.append(key)
        else:
            items.append((key, value))
    return Directives(renames, removed, replace, tuple(items), tuple(misused))


def report_misuse(directives: Directives, problems: Problems) -> None:
    """Report the directives that are not written as they must be, or make no sense together."""
    for key in directives.misused:
        problems.add("PG025", key.span, _FORMS[key.text])
    named = (*(old for old, _ in directives.renames), *directives.removed)
    if directives.replace is not None and named:
        message = "with `replace: true` there is nothing left to rename or remove"
        problems.add("PG025", named[0].span, message)


def split_placement(node: Node, problems: Problems) -> tuple[Node, Placement | None]:
    """Return the item ``node`` without its `after` or `before`, and what that says."""
    if not isinstance(node, MappingNode):
        return node, None
    placements = [
        Placement(key.text, value)
        for key, value in node.items
        if key.value in _PLACES and isinstance(value, ScalarNode) and isinstance(value.value, str)
    ]
    if not placements:
        return node, None
    if len(placements) > 1:
        span = placements[1].neighbour.span
        problems.add("PG025", span, "an item has either `after` or `before`, not both")
    used = {placement.where for placement in placements}
    kept = (item for item in node.items if item[0].value not in used)
    return MappingNode(tuple(kept), node.span), placements[0]


def _is_name(node: Node) -> bool:
    return isinstance(node, ScalarNode) and isinstance(node.value, str | int)


def _names_names(mapping: MappingNode) -> bool:
    return bool(mapping.items) and all(_is_name(value) for _, value in mapping.items)


def _all_names(sequence: SequenceNode) -> bool:
    return all(_is_name(item) for item in sequence.items)


def _may_be_item(node: Node) -> bool:
    if isinstance(node, ScalarNode):
        return isinstance(node.value, int | float) and not isinstance(node.value, bool)
    return isinstance(node, MappingNode)
