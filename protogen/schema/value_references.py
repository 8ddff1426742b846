"""Where a schema refers to the names of a field's values, flags and bits.

An enum's names choose the cases of a switch, are constants and defaults, and stand in examples;
the names of flags and bits stand in examples.
"""

from __future__ import annotations

from functools import partial

from protogen.schema.edit import ANY, Names, edit_at, keys_of, rename_keys, rename_scalar
from protogen.schema.nodes import Node, ScalarNode, SequenceNode
from protogen.schema.scalars import Scalar
from protogen.schema.uses import Place, example_steps, places_of

NAMING = ("values", "flags", "bits")
"""Keys under which a field names its values or bits."""


def follow_values(root: Node, path: Place, names: Names) -> Node:
    """Return ``root`` with references to the names in the mapping at ``path`` renamed."""
    *field, kind = path
    inside: Place = ()
    if kind == "values" and len(path) > 4 and path[-3] == "bits" and len(path) % 2 == 1:
        # The values of a run of bits, which stand one step further inside.
        field, inside = list(path[:-3]), (path[-2],)
    place = tuple(field)
    if len(place) % 2:
        return root  # A field, or a message, of that name.
    if not inside and kind == "values":
        for used in places_of(root, place):
            root = _follow_enum(root, used, names)
    for message, steps in example_steps(root, place):
        root = _rename_in_examples(root, message, (*steps, *inside), names)
    return root


def _follow_enum(root: Node, place: Place, names: Names) -> Node:
    for key in ("const", "default"):
        root = edit_at(root, (*place, key), lambda node: _rename_written(node, names))
    if len(place) < 4 or place[-2] != "fields":
        return root
    return edit_at(root, place[:-1], partial(_rename_cases, place[-1], names))


def _rename_cases(switch: Scalar, names: Names, fields: Node) -> Node:
    """Rename the cases of switches by the field `switch`, in fields beside it and inside them."""
    return edit_at(fields, (ANY,), partial(_rename_cases_of, switch, names))


def _rename_cases_of(switch: Scalar, names: Names, field: Node) -> Node:
    chosen = field.child("switch")
    if isinstance(chosen, ScalarNode) and chosen.value == switch:
        field = edit_at(field, ("cases",), lambda cases: rename_keys(cases, names))
    field = edit_at(field, ("cases", ANY), partial(_rename_cases_of, switch, names))
    if switch in keys_of(field.child("fields")):
        return field  # It has a field of its own by that name.
    return edit_at(field, ("fields",), partial(_rename_cases, switch, names))


def _rename_in_examples(root: Node, message: Scalar, steps: Place, names: Names) -> Node:
    for values in (("values",), ("contradicts", "reads")):
        path = ("messages", message, "examples", ANY, *values)
        root = edit_at(root, path, partial(_rename_at, steps, names))
    return root


def _rename_at(steps: Place, names: Names, node: Node) -> Node:
    """Rename what stands behind the steps, in each element of an array."""
    if isinstance(node, SequenceNode):
        return edit_at(node, (ANY,), partial(_rename_at, steps, names))
    if not steps:
        return _rename_written(node, names)
    return edit_at(node, steps[:1], partial(_rename_at, steps[1:], names))


def _rename_written(node: Node, names: Names) -> Node:
    """Rename a value, each of a list of values, or the keys of a mapping of flags."""
    if isinstance(node, SequenceNode):
        return edit_at(node, (ANY,), lambda item: _rename_written(item, names))
    return rename_keys(rename_scalar(node, names), names)
