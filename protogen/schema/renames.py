"""Gives items of a base the names that a dialect has for them, wherever the base refers to them."""

from __future__ import annotations

from protogen.problems import Problems
from protogen.schema.directives import Rename, read_directives
from protogen.schema.edit import Names, edit_at, rename_keys
from protogen.schema.merge import report_unknown
from protogen.schema.nodes import Item, MappingNode, Node, ScalarNode
from protogen.schema.references import follow_renames
from protogen.schema.scalars import Scalar


def apply_renames(base: Node, dialect: Node, problems: Problems) -> Node:
    """Return ``base`` with every `rename` in ``dialect`` carried out.

    Outer mappings come first: inside of a renamed item, the dialect uses the new name.
    """
    return _apply(base, (), dialect, problems)


def _apply(root: Node, path: tuple[Scalar, ...], dialect: Node, problems: Problems) -> Node:
    if not isinstance(dialect, MappingNode):
        return root
    base = root.at(path)
    directives = read_directives(dialect)
    if not isinstance(base, MappingNode) or directives.replace is not None:
        _report_pointless(dialect, problems)
        return root
    names = _usable(base, directives.renames, problems)
    if names:
        root = edit_at(root, path, lambda node: rename_keys(node, names))
        root = follow_renames(root, path, names)
    for key, value in sorted(directives.items, key=_is_late):
        root = _apply(root, (*path, key.value), value, problems)
    return root


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


def _usable(base: MappingNode, renames: tuple[Rename, ...], problems: Problems) -> Names:
    """Return the renames that make sense, and report the others."""
    names: dict[Scalar, ScalarNode] = {}
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
