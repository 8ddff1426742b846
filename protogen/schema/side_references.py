"""Where a schema refers to endpoints, to decisions and to a message's examples."""

from __future__ import annotations

from functools import partial

from protogen.schema.edit import ANY, Names, Path, edit_at, keys_of, rename_keys, rename_scalar
from protogen.schema.nodes import Node, ScalarNode
from protogen.schema.scalars import Scalar

BY_SENDER = ("frame", "transparency", "byte_order")
"""Keys of the root under which endpoints may stand as keys."""

_SENDERS: tuple[Path, ...] = (
    ("messages", ANY, "from"),
    ("messages", ANY, "from", ANY),
    ("messages", ANY, "examples", ANY, "sender"),
    ("reserved", "identities", ANY, "from"),
)
_DECISIONS: tuple[Path, ...] = (
    ("frame", ANY, "unprotected"),
    ("frame", ANY, ANY, "unprotected"),
    ("overloads", ANY, "decision"),
)


def follow_endpoints(root: Node, names: Names) -> Node:
    """Return ``root``, whose endpoints are renamed already, with the references to them renamed."""
    new = {name.value for name in names.values()}
    before = (keys_of(root.child("endpoints")) - new) | names.keys()
    for key in BY_SENDER:
        if keys_of(root.child(key)) <= before:
            root = edit_at(root, (key,), lambda node: rename_keys(node, names))
    return _rename_at(root, _SENDERS, names)


def follow_decisions(root: Node, names: Names) -> Node:
    """Return ``root`` with the references to decisions renamed."""
    return _rename_at(root, _DECISIONS, names)


def follow_examples(root: Node, message: Scalar, names: Names) -> Node:
    """Return ``root`` with the examples of a message renamed in exchanges."""
    steps = ("exchanges", ANY, "steps", ANY)
    return edit_at(root, steps, partial(_rename_example, message, names))


def _rename_example(message: Scalar, names: Names, step: Node) -> Node:
    sent = step.child("message")
    if not isinstance(sent, ScalarNode) or sent.value != message:
        return step
    return edit_at(step, ("example",), lambda node: rename_scalar(node, names))


def _rename_at(root: Node, paths: tuple[Path, ...], names: Names) -> Node:
    for path in paths:
        root = edit_at(root, path, lambda node: rename_scalar(node, names))
    return root
