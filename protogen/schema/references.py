"""Where a schema refers to what it names: changes the references after a rename.

What refers to a name is known per kind of item: to a field the fields beside it and the examples,
to a part what `part_references` lists, to an endpoint or a decision what `side_references` lists,
to a value or a flag what `value_references` lists, to a message overloads and exchanges, to a type
every `type`. An item of another kind is renamed alone.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

from protogen.schema.edit import (
    ANY,
    Names,
    Path,
    edit_at,
    keys_of,
    rename_keys,
    rename_scalar,
)
from protogen.schema.nodes import Node, SequenceNode
from protogen.schema.part_references import follow_parts, is_by_sender
from protogen.schema.scalars import Scalar
from protogen.schema.side_references import follow_decisions, follow_endpoints, follow_examples
from protogen.schema.uses import example_steps
from protogen.schema.value_references import NAMING, follow_values

_PART_TYPES: tuple[Path, ...] = (("frame", ANY, "type"), ("frame", ANY, ANY, "type"))
_FIELDS: tuple[Path, ...] = (("types",), ("messages", ANY, "fields"))
_RESERVED_VALUES: Path = ("reserved", "values")
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
        case ("endpoints",):
            return follow_endpoints(root, names)
        case ("decisions",):
            return follow_decisions(root, names)
        case ("messages" | "types", _, *_):
            return _follow_inside(root, tuple(path), names)
    return root


def _follow_inside(root: Node, path: tuple[Scalar, ...], names: Names) -> Node:
    """Rename what stands inside of a message or a declared type."""
    match path:
        case ("messages", message, "examples"):
            return follow_examples(root, message, names)
        case (_, _, "fields", *_) if _holds_fields(path):
            return _follow_fields(root, path, names)
        case (_, _, *_, kind) if kind in NAMING:
            return follow_values(root, path, names)
    return root


def _holds_fields(path: Sequence[Scalar]) -> bool:
    """Whether a mapping of fields is here; a field may be called `fields` as well."""
    return len(path) % 2 == 1 and path[-1] == "fields"


def _follow_types(root: Node, names: Names) -> Node:
    for path in _PART_TYPES:
        root = edit_at(root, path, lambda node: rename_scalar(node, names))
    for path in _FIELDS:
        root = edit_at(root, path, lambda fields: _retype(fields, names))
    return edit_at(root, _RESERVED_VALUES, lambda node: rename_keys(node, names))


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
    root = edit_at(root, ("reserved", "fields"), lambda node: rename_keys(node, names))
    return edit_at(root, _RESERVED_VALUES, lambda node: _rename_dotted(node, (), names))


def _rename_dotted(node: Node, owner: Sequence[Scalar], names: Names) -> Node:
    """Rename keys such as `message.field`, in what stands behind `owner`."""
    place = len(owner)
    dotted = {}
    for key in keys_of(node):
        steps = str(key).split(".")
        if len(steps) > max(place, 1) and steps[:place] == list(owner) and steps[place] in names:
            new = names[steps[place]]
            text = ".".join((*steps[:place], new.text, *steps[place + 1 :]))
            dotted[key] = replace(new, value=text, text=text)
    return rename_keys(node, dotted)


def _follow_fields(root: Node, path: tuple[Scalar, ...], names: Names) -> Node:
    root = edit_at(root, path, lambda fields: _rename_beside(fields, names))
    if path[0] == "messages" and len(path) == 3:
        owner = path[1:2]
        root = edit_at(root, _RESERVED_VALUES, lambda node: _rename_dotted(node, owner, names))
    for message, steps in example_steps(root, path[:-1]):
        root = _rename_values(root, message, steps, names)
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
