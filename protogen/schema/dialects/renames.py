"""Gives items of a base the names that a dialect has for them, wherever the base refers to them."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Mapping

from protogen.copying import replace
from protogen.problems import Problems
from protogen.schema.dialects.directives import Rename, read_directives
from protogen.schema.dialects.merge import report_unknown
from protogen.schema.references import Spot, references
from protogen.schema.scopes import Place
from protogen.schema.text.nodes import (
    Item,
    MappingNode,
    Node,
    ScalarNode,
    SequenceNode,
    to_data,
)
from protogen.schema.text.scalars import Scalar

_Names = dict[Scalar, ScalarNode]
"""Old names and what they become."""
_Edits = Mapping[Spot, Mapping[int, tuple[str, ScalarNode]]]
"""For each scalar, the old names in its text by their offset, with what they become."""


def apply_renames(base: Node, dialect: Node, problems: Problems) -> Node:
    """Return ``base`` with every `rename` in ``dialect`` carried out.

    Outer mappings come first: inside of a renamed item, the dialect uses the new name.
    """
    return _apply(base, (), dialect, problems)


def _apply(root: Node, path: Place, dialect: Node, problems: Problems) -> Node:
    if not isinstance(dialect, MappingNode):
        return root
    base = root.at(path)
    directives = read_directives(dialect)
    if not isinstance(base, MappingNode) or directives.replace is not None:
        _report_pointless(dialect, problems)
        return root
    if names := _usable(base, directives.renames, problems):
        root = _edited(root, (), _edits(root, path, names))
    for key, value in sorted(directives.items, key=_is_late):
        root = _apply(root, (*path, key.value), value, problems)
    return root


def _edits(root: Node, path: Place, names: _Names) -> _Edits:
    """Edits that rename items of the mapping at ``path``, with the references to them."""
    edits: dict[Spot, dict[int, tuple[str, ScalarNode]]] = defaultdict(dict)
    for old, new in names.items():
        edits[Spot((*path, old), at_key=True)][0] = (str(old), new)
    data = to_data(root)
    for found in references(data):
        # What serves several senders keeps a name until none of them has it any more.
        if found.name in names and found.declarations(data) == [(*path, found.name)]:
            edits[found.spot][found.start] = (str(found.name), names[found.name])
    return edits


def _edited(node: Node, place: Place, edits: _Edits) -> Node:
    if isinstance(node, ScalarNode):
        edit = edits.get(Spot(place))
        return node if edit is None else replace(_renamed(node, edit), span=node.span)
    if isinstance(node, SequenceNode):
        inner = (_edited(item, (*place, index), edits) for index, item in enumerate(node.items))
        return SequenceNode(tuple(inner), node.span)
    items = [
        (_edited_key(key, at, edits), _edited(value, at, edits))
        for key, value in node.items
        for at in [(*place, key.value)]
    ]
    return MappingNode(tuple(items), node.span)


def _edited_key(key: ScalarNode, at: Place, edits: _Edits) -> ScalarNode:
    edit = edits.get(Spot(at, at_key=True))
    return key if edit is None else _renamed(key, edit)


def _renamed(node: ScalarNode, edit: Mapping[int, tuple[str, ScalarNode]]) -> ScalarNode:
    """A scalar with the names in its text changed; it has the place of the last new name."""
    text = node.text
    for start, (old, new) in sorted(edit.items(), reverse=True):
        if len(old) == len(node.text):
            return new
        text = text[:start] + new.text + text[start + len(old) :]
    return ScalarNode(text, text, node.plain, next(iter(edit.values()))[1].span)


def _is_late(item: Item) -> bool:
    """Endpoints come first: frames are keyed by them, in the dialect by their new names."""
    return item[0].value != "endpoints"


def _report_pointless(dialect: Node, problems: Problems) -> None:
    """Report every rename in a mapping that has no counterpart in the base."""
    if not isinstance(dialect, MappingNode):
        return
    directives = read_directives(dialect)
    for old, _ in directives.renames:
        report_unknown("PG023", old, "to rename here", (), problems)
    for _, value in directives.items:
        _report_pointless(value, problems)


def _usable(base: MappingNode, renames: tuple[Rename, ...], problems: Problems) -> _Names:
    """Return the renames that make sense, and report the others."""
    names: _Names = {}
    for old, new in renames:
        if base.child(old.value) is None:
            report_unknown("PG023", old, "to rename here", (key for key, _ in base.items), problems)
        else:
            names[old.value] = new
    taken = {key.value for key, _ in base.items} - names.keys()
    for name, new in list(names.items()):
        if new.value in taken:
            problems.add("PG025", new.span, f"there is a `{new.text}` already")
            del names[name]
        taken.add(new.value)
    return names
