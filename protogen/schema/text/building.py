"""Mappings and lists that are being read: what is known of them before their end is seen."""

from __future__ import annotations

from abc import ABC, abstractmethod
from typing import Any

from protogen.problems import Problems, Span
from protogen.problems.sources import Position
from protogen.schema.text.keys import Keys
from protogen.schema.text.nodes import Item, MappingNode, Node, ScalarNode, SequenceNode


class OpenNode(ABC):
    """A mapping or list whose end was not seen yet."""

    def __init__(self, event: Any, begin: Position, counted: int) -> None:
        self.event = event
        self.begin = begin
        self.counted = counted
        """Number of nodes counted before it."""
        self.end = begin
        """End of the last thing inside."""
        self.height = 1

    def put(self, node: Node, height: int, end: Position) -> None:
        """Add a node that is complete, ``height`` collections high, and ends at ``end``."""
        self.end = end
        self.height = max(self.height, height + 1)
        self._take(node)

    @abstractmethod
    def _take(self, node: Node) -> None: ...

    @abstractmethod
    def close(self, span: Span) -> Node:
        """Return the complete node."""


class OpenSequence(OpenNode):
    """A list whose end was not seen yet."""

    def __init__(self, event: Any, begin: Position, counted: int) -> None:
        super().__init__(event, begin, counted)
        self._items: list[Node] = []

    def _take(self, node: Node) -> None:
        self._items.append(node)

    def close(self, span: Span) -> Node:
        """Return the list."""
        return SequenceNode(tuple(self._items), span)


class OpenMapping(OpenNode):
    """A mapping whose end was not seen yet; keys that can't be used are left out."""

    def __init__(self, event: Any, begin: Position, counted: int, problems: Problems) -> None:
        super().__init__(event, begin, counted)
        self._keys = Keys(problems)
        self._key: ScalarNode | None = None
        self._at_key = True
        self._items: list[Item] = []

    def _take(self, node: Node) -> None:
        if self._at_key:
            self._key = self._keys.accept(node)
        elif self._key is not None:
            self._items.append((self._key, node))
        self._at_key = not self._at_key

    def close(self, span: Span) -> Node:
        """Return the mapping."""
        return MappingNode(tuple(self._items), span)
