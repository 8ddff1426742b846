"""Merges the tree of a dialect over the tree of its base.

A mapping merges key by key; anything else takes the place of what the base has. Names of the base
were changed before (see `renames`): `rename` has nothing left to do here.
"""

from __future__ import annotations

from collections.abc import Iterable

from protogen.problems import Problems, hint_for
from protogen.schema.dialects.directives import (
    Placement,
    read_directives,
    report_misuse,
    split_placement,
)
from protogen.schema.text.nodes import Item, MappingNode, Node, ScalarNode
from protogen.schema.text.scalars import Scalar

_Items = dict[Scalar, Item]
_Placements = dict[Scalar, Placement]


def merge(base: Node, dialect: Node, problems: Problems) -> Node:
    """Return ``base`` with the differences that ``dialect`` states.

    A merged mapping has the span of the dialect's, since that is where it can be fixed.
    """
    if not isinstance(dialect, MappingNode):
        return dialect
    if not isinstance(base, MappingNode):
        base = MappingNode((), dialect.span)
    directives = read_directives(dialect)
    report_misuse(directives, problems)
    if directives.replace is not None:
        nothing = MappingNode((), dialect.span)
        return merge(nothing, MappingNode(directives.items, dialect.span), problems)
    items = {item[0].value: item for item in base.items}
    _remove(items, directives.removed, problems)
    placements = _add(items, directives.items, problems)
    return MappingNode(_ordered(items, placements, problems), dialect.span)


def report_unknown(
    code: str, name: ScalarNode, purpose: str, known: Iterable[ScalarNode], problems: Problems
) -> None:
    """Report that none of the ``known`` names is the ``name`` that a directive gives."""
    hint = hint_for(name.text, (key.text for key in known))
    problems.add(code, name.span, f"there is no `{name.text}` {purpose}", hint)


def _keys(items: _Items) -> list[ScalarNode]:
    return [key for key, _ in items.values()]


def _remove(items: _Items, removed: Iterable[ScalarNode], problems: Problems) -> None:
    for name in removed:
        if items.pop(name.value, None) is None:
            report_unknown("PG023", name, "to remove here", _keys(items), problems)


def _add(items: _Items, written: Iterable[Item], problems: Problems) -> _Placements:
    """Put the dialect's items into ``items`` and return which of them have a place."""
    placements: _Placements = {}
    for key, whole in written:
        value, placement = split_placement(whole, problems)
        known = items.get(key.value)
        # What is new may hold directives all the same; merging it over nothing carries them out.
        value = merge(MappingNode((), value.span) if known is None else known[1], value, problems)
        items[key.value] = (key, value)
        if placement is not None:
            placements[key.value] = placement
    return placements


def _ordered(items: _Items, placements: _Placements, problems: Problems) -> tuple[Item, ...]:
    """Return the items in order, those with a place beside their neighbour."""
    beside: dict[tuple[str, Scalar], list[Scalar]] = {}
    free = dict.fromkeys(items)
    for name, placement in placements.items():
        neighbour = placement.neighbour
        if neighbour.value not in items:
            purpose = f"to stand {placement.where}"
            report_unknown("PG024", neighbour, purpose, _keys(items), problems)
        else:
            beside.setdefault((placement.where, neighbour.value), []).append(name)
            del free[name]
    order = _spread(free, beside)
    for name in items.keys() - order.keys():
        span = placements[name].neighbour.span
        problems.add("PG025", span, f"`{items[name][0].text}` is placed beside itself")
    return tuple(items[name] for name in order)


def _spread(
    free: Iterable[Scalar], beside: dict[tuple[str, Scalar], list[Scalar]]
) -> dict[Scalar, None]:
    """Return the free names in order, each between those that are placed beside it."""
    order: dict[Scalar, None] = {}
    waiting = [(name, False) for name in free][::-1]
    while waiting:
        name, led = waiting.pop()
        if led:
            order[name] = None
            continue
        leading = [(other, False) for other in beside.get(("before", name), ())]
        following = [(other, False) for other in beside.get(("after", name), ())]
        waiting.extend([*leading, (name, True), *following][::-1])
    return order
