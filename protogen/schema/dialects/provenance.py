"""Names of documents for the sources of a schema, so that they survive a merge.

`source: 61-65` means lines of the document that the same file names at its root. A dialect names
another document there, so before schemas are merged each source is given its document's name.
"""

from __future__ import annotations

import msgspec

from protogen.copying import replace
from protogen.schema.syntax.protocol import keyed_by_names
from protogen.schema.text.nodes import Item, MappingNode, Node, ScalarNode, SequenceNode, items_of


class _Origin(msgspec.Struct, frozen=True):
    """The document that a file is about, and whether the file is laid over another one."""

    document: ScalarNode
    over_base: bool


def name_documents(root: Node, *, over_base: bool) -> Node:
    """Give every source below the root the name of the root's document, where it has none.

    With ``over_base``, each source also replaces that of the base as a whole: half of each would
    be false.
    """
    source = root.child("source")
    document = None if source is None else source.child("document")
    if not isinstance(document, ScalarNode):
        return root
    origin = _Origin(document, over_base)
    items = tuple(
        (key, value if key.value == "source" else _below(key, value, origin))
        for key, value in items_of(root)
    )
    return MappingNode(items, root.span)


def _below(key: ScalarNode, value: Node, origin: _Origin) -> Node:
    return _walk(value, origin, _levels_of_names(key, value))


def _levels_of_names(key: ScalarNode, value: Node) -> int:
    """Number of levels of mappings under a key whose keys are names; a frame per sender has two."""
    if key.value not in keyed_by_names():
        return 0
    inner = [item for _, item in items_of(value)]
    nested = key.value == "frame" and all(_holds_mappings(item) for item in inner)
    return 2 if nested else 1


def _holds_mappings(node: Node) -> bool:
    items = items_of(node)
    return bool(items) and all(isinstance(value, MappingNode) for _, value in items)


def _walk(node: Node, origin: _Origin, levels: int) -> Node:
    """Name the documents in one node whose keys are names for so many levels."""
    if isinstance(node, ScalarNode):
        return node
    if isinstance(node, SequenceNode):
        # Sequences are not merged, so nothing in them lies over something else.
        inside = replace(origin, over_base=False)
        return SequenceNode(tuple(_walk(item, inside, 0) for item in node.items), node.span)
    return MappingNode(tuple(_item(item, origin, levels) for item in node.items), node.span)


def _item(item: Item, origin: _Origin, levels: int) -> Item:
    key, value = item
    if levels:
        return key, _walk(value, origin, levels - 1)
    if key.value == "source":
        return key, _named(key, value, origin)
    return key, _below(key, value, origin)


def _named(key: ScalarNode, value: Node, origin: _Origin) -> Node:
    items: tuple[Item, ...] = items_of(value)
    if isinstance(value, ScalarNode):
        items = ((ScalarNode("lines", "lines", True, key.span), value),)
    if not {"document", "url"} & {name.value for name, _ in items}:
        items = ((ScalarNode("document", "document", True, key.span), origin.document), *items)
    if origin.over_base:
        whole = ScalarNode("replace", "replace", True, key.span)
        items = ((whole, ScalarNode(True, "true", True, key.span)), *items)
    return MappingNode(items, value.span)
