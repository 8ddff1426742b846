"""Where a schema refers to the parts of a frame.

A schema has one frame for all senders or one per sender, and the same holds for the transparency.
What serves several senders follows a rename only when no other sender has the old name any more.
"""

from __future__ import annotations

from functools import partial

from protogen.schema.edit import (
    ANY,
    Names,
    Path,
    edit_at,
    items_of,
    keys_of,
    rename_keys,
    rename_run,
)
from protogen.schema.nodes import Node, ScalarNode, SequenceNode


def is_by_sender(root: Node, key: str) -> bool:
    """Return whether what stands under ``key`` is keyed by endpoint."""
    senders = keys_of(root.child(key))
    return bool(senders) and senders <= keys_of(root.child("endpoints"))


def follow_parts(root: Node, sender: str | None, names: Names) -> Node:
    """Return ``root`` with references to parts renamed, in frames of one sender or of all."""
    frame: Path = ("frame",) if sender is None else ("frame", sender)
    for key in ("covers", "counts", "when"):
        root = _runs(root, (*frame, ANY, key), names)
    root = _follow_transparency(root, sender, names)
    root = _runs(root, ("content_covers",), _free(root, sender, None, names))
    root = edit_at(root, ("messages", ANY), partial(_follow_message, root, sender, names))
    reserved = ("reserved", "identities", ANY)
    return edit_at(root, reserved, partial(_follow_identity, root, sender, names))


def _runs(root: Node, path: Path, names: Names) -> Node:
    return edit_at(root, path, lambda node: rename_run(node, names))


def _follow_transparency(root: Node, sender: str | None, names: Names) -> Node:
    region: Path = ("transparency",)
    if is_by_sender(root, "transparency"):
        region = ("transparency", ANY if sender is None else sender)
    else:
        names = _free(root, sender, None, names)
    for key in ("covers", "when"):
        root = _runs(root, (*region, key), names)
    return root


def _follow_message(root: Node, sender: str | None, names: Names, message: Node) -> Node:
    message = _follow_identity(root, sender, names, message)
    names = _free(root, sender, message, names)
    message = edit_at(message, ("examples", ANY, "parts"), lambda parts: rename_keys(parts, names))
    return _runs(message, ("examples", ANY, "covers"), names)


def _follow_identity(root: Node, sender: str | None, names: Names, owner: Node) -> Node:
    names = _free(root, sender, owner, names)
    return edit_at(owner, ("id",), lambda identity: rename_keys(identity, names))


def _free(root: Node, sender: str | None, owner: Node | None, names: Names) -> Names:
    """Return the names that ``owner`` may drop: those that none of its other senders still has.

    Without an owner, all senders count.
    """
    if sender is None:
        return names
    senders = _senders(root, owner)
    if sender not in senders:
        return {}
    others = (other for other in senders if other != sender)
    kept = {part for other in others for part in keys_of(root.at(("frame", other)))}
    return {old: new for old, new in names.items() if old not in kept}


def _senders(root: Node, owner: Node | None) -> list[str]:
    written = None if owner is None else owner.child("from")
    if isinstance(written, ScalarNode):
        return [written.text]
    if isinstance(written, SequenceNode):
        return [item.text for item in written.items if isinstance(item, ScalarNode)]
    return [key.text for key, _ in items_of(root.child("frame"))]
