"""Mappings and lists that are being read, whose end was not seen yet."""

from __future__ import annotations

from typing import Any

from protogen.problems import Span
from protogen.problems.sources import Position
from protogen.schema.text.keys import Keys
from protogen.schema.text.nodes import Item, MappingNode, Node, ScalarNode, SequenceNode


class OpenNode:
    """A mapping, if it has keys, or a list. Keys that can't be used are left out."""

    def __init__(self, event: Any, begin: Position, counted: int, keys: Keys | None) -> None:
        self.event = event
        self.begin = begin
        self.counted = counted
        """Number of nodes counted before it."""
        self.end = begin
        """End of the last thing inside."""
        self.height = 1
        self.keys = keys
        self._key: ScalarNode | None = None
        self._at_key = True
        self._items: list[Item] = []
        self._elements: list[Node] = []

    def put(self, node: Node, height: int, end: Position) -> None:
        """Add a node that is complete, ``height`` collections high, and ends at ``end``."""
        self.end = end
        self.height = max(self.height, height + 1)
        if self.keys is None:
            self._elements.append(node)
            return
        if self._at_key:
            self._key = self.keys.accept(node)
        elif self._key is not None:
            self._items.append((self._key, node))
        self._at_key = not self._at_key

    def close(self, span: Span) -> Node:
        """Return the complete node."""
        if self.keys is None:
            return SequenceNode(tuple(self._elements), span)
        return MappingNode(tuple(self._items), span)
