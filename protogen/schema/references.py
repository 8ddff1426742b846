"""Where a schema refers to what it names: changes the references after a rename.

What refers to a name is known per kind of item: to a field the fields beside it and the examples,
to a part what `part_references` lists, to a message overloads and exchanges, to a type every
`type`. An item of another kind is renamed alone.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from protogen.schema.edit import (
    ANY,
    Names,
    Path,
    edit_at,
    items_of,
    keys_of,
    rename_keys,
    rename_scalar,
)
from protogen.schema.nodes import Node, ScalarNode, SequenceNode
from protogen.schema.part_references import follow_parts, is_by_sender
from protogen.schema.scalars import Scalar

_PART_TYPES: tuple[Path, ...] = (("frame", ANY, "type"), ("frame", ANY, ANY, "type"))
_FIELDS: tuple[Path, ...] = (("types",), ("messages", ANY, "fields"))
_MESSAGE_NAMES: tuple[Path, ...] = (
    ("overloads", ANY, "messages", ANY),
    ("overloads", ANY, "yields"),
    ("exchanges", ANY, "steps", ANY),
    ("exchanges", ANY, "steps", ANY, "message"),
)


def follow_renames(root: Node, path: Sequence[Scalar], names: Names) -> Node:
    """Return ``root`` with the references to items of the mapping at ``path`` renamed."""
    match tuple(path):
        case ("types",):
            return _follow_types(root, names)
        case ("messages",):
            return _follow_messages(root, names)
        case ("frame",) if not is_by_sender(root, "frame"):
            return follow_parts(root, None, names)
        case ("frame", str(sender)) if is_by_sender(root, "frame"):
            return follow_parts(root, sender, names)
        case ("messages" | "types", _, "fields", *_) if path[-1] == "fields":
            return _follow_fields(root, tuple(path), names)
        case _:
            return root


def _follow_types(root: Node, names: Names) -> Node:
    for path in _PART_TYPES:
        root = edit_at(root, path, lambda node: rename_scalar(node, names))
    for path in _FIELDS:
        root = edit_at(root, path, lambda fields: _retype(fields, names))
    return root


def _retype(fields: Node, names: Names) -> Node:
    """Rename the types of fields; a bare text in the place of a field is its type."""
    fields = edit_at(fields, (ANY,), lambda field: rename_scalar(field, names))
    fields = edit_at(fields, (ANY, "type"), lambda node: rename_scalar(node, names))
    for inside in ("fields", "cases"):
        fields = edit_at(fields, (ANY, inside), lambda inner: _retype(inner, names))
    return fields


def _follow_messages(root: Node, names: Names) -> Node:
    for path in _MESSAGE_NAMES:
        root = edit_at(root, path, lambda node: rename_scalar(node, names))
    return edit_at(root, ("reserved", "fields"), lambda node: rename_keys(node, names))


def _follow_fields(root: Node, path: tuple[Scalar, ...], names: Names) -> Node:
    root = edit_at(root, path, lambda fields: _rename_beside(fields, names))
    kind, owner, steps = path[0], path[1], path[3::2]
    if any(step != "fields" for step in path[4::2]):
        # Values do not say which case of a switch they belong to.
        return root
    if kind == "messages":
        return _rename_values(root, owner, steps, names)
    for message, field in _uses(root, owner):
        root = _rename_values(root, message, (field, *steps), names)
    return root


def _rename_beside(fields: Node, names: Names) -> Node:
    """Rename what the fields of one mapping, and those inside of them, refer to."""
    return edit_at(fields, (ANY,), lambda field: _rename_in_field(field, names))


def _rename_in_field(field: Node, names: Names) -> Node:
    for key in ("count", "size", "switch"):
        field = edit_at(field, (key,), lambda node: rename_scalar(node, names))
    field = edit_at(field, ("cases", ANY), lambda case: _rename_in_field(case, names))
    return edit_at(field, ("fields",), lambda inner: _rename_inside(inner, names))


def _rename_inside(inner: Node, names: Names) -> Node:
    """Rename in fields further inside, which hide outer fields of the same name."""
    return _rename_beside(inner, {old: names[old] for old in names.keys() - keys_of(inner)})


def _uses(root: Node, type_name: Scalar) -> Iterator[tuple[Scalar, Scalar]]:
    """Yield each message and its field that have the declared type."""
    messages = root.child("messages")
    for message, syntax in items_of(messages):
        for field, written in items_of(syntax.child("fields")):
            named = written if isinstance(written, ScalarNode) else written.child("type")
            if isinstance(named, ScalarNode) and named.value == type_name:
                yield message.value, field.value


def _rename_values(root: Node, message: Scalar, steps: Sequence[Scalar], names: Names) -> Node:
    for values in (("values",), ("contradicts", "reads")):
        path = ("messages", message, "examples", ANY, *values)
        root = edit_at(root, path, lambda node: _rename_value(node, steps, names))
    return root


def _rename_value(node: Node, steps: Sequence[Scalar], names: Names) -> Node:
    """Rename keys in a struct's values, or in those of each element of an array."""
    if isinstance(node, SequenceNode):
        return edit_at(node, (ANY,), lambda item: _rename_value(item, steps, names))
    if not steps:
        return rename_keys(node, names)
    return edit_at(node, steps[:1], lambda inner: _rename_value(inner, steps[1:], names))
