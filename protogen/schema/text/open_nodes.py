"""Lists and mappings that are being read, whose end was not seen yet."""

from __future__ import annotations

from typing import Any

from protogen.problems import Problems, Span
from protogen.problems.sources import Position
from protogen.schema.text.nodes import Item, MappingNode, Node, ScalarNode, SequenceNode
from protogen.schema.text.scalars import Scalar


class OpenCollection:
    """A list or a mapping."""

    __slots__ = ("_last", "begin", "counted", "event", "height")

    def __init__(self, event: Any, begin: Position, counted: int) -> None:
        self.event = event
        self.begin = begin
        self.counted = counted
        """Number of nodes counted before it."""
        self._last: Span | None = None
        """Span of the last thing inside."""
        self.height = 1

    @property
    def end(self) -> Position:
        """End of the last thing inside."""
        last = self._last
        return self.begin if last is None else Position(last.end_line, last.end_column)

    def put(self, node: Node, height: int, span: Span) -> None:
        """Add a node that is complete, ``height`` collections high, which stands at ``span``."""
        raise NotImplementedError

    def close(self, span: Span) -> Node:
        """Return the complete node."""
        raise NotImplementedError


class OpenList(OpenCollection):
    """A list."""

    __slots__ = ("_elements",)

    def __init__(self, event: Any, begin: Position, counted: int) -> None:
        super().__init__(event, begin, counted)
        self._elements: list[Node] = []

    def put(self, node: Node, height: int, span: Span) -> None:
        """Add an element."""
        self._last = span
        if height >= self.height:
            self.height = height + 1
        self._elements.append(node)

    def close(self, span: Span) -> Node:
        """Return the complete node."""
        return SequenceNode(tuple(self._elements), span)


class OpenMapping(OpenCollection):
    """A mapping. Its keys are names and integers, each once; others are left out."""

    __slots__ = ("_items", "_key", "_keys", "_problems", "_wants_value")

    def __init__(self, event: Any, begin: Position, counted: int, problems: Problems) -> None:
        super().__init__(event, begin, counted)
        self._problems = problems
        self._keys: dict[Scalar, ScalarNode] = {}
        self._items: list[Item] = []
        self._key: ScalarNode | None = None
        self._wants_value = False

    def put(self, node: Node, height: int, span: Span) -> None:
        """Add a key or its value, which come by turns."""
        self._last = span
        if height >= self.height:
            self.height = height + 1
        if not self._wants_value:
            self._key = self._accepted(node)
        elif self._key is not None:
            self._items.append((self._key, node))
        self._wants_value = not self._wants_value

    def close(self, span: Span) -> Node:
        """Return the complete node."""
        return MappingNode(tuple(self._items), span)

    def _accepted(self, key: Node) -> ScalarNode | None:
        """Return the key if it can be used; otherwise report why not."""
        if not isinstance(key, ScalarNode):
            kind = "list" if isinstance(key, SequenceNode) else "mapping"
            self._problems.add("PG009", key.span, f"a {kind} can't be a key")
        elif key.plain and key.text == "<<":
            message = "the merge key `<<` is no part of YAML 1.2"
            hint = "repeat the keys; an alias such as `*name` stands for a whole value"
            self._problems.add("PG012", key.span, message, hint)
        elif not isinstance(key.value, str | int):
            self._report_scalar(key)
        elif key.value in self._keys:
            self._report_duplicate(key, self._keys[key.value])
        else:
            self._keys[key.value] = key
            return key
        return None

    def _report_scalar(self, key: ScalarNode) -> None:
        if not key.text:
            self._problems.add("PG009", key.span, "a key is missing")
            return
        kind = "nothing" if key.value is None else "a fraction"
        message = f"`{key.text}` means {kind}, so it can't be a key"
        self._problems.add("PG009", key.span, message, f'write `"{key.text}"` if it is a name')

    def _report_duplicate(self, key: ScalarNode, first: ScalarNode) -> None:
        same = "" if key.text == first.text else f", which is the same as `{first.text}`"
        message = f"the key `{key.text}` stands twice{same}"
        self._problems.add("PG006", key.span, message, notes=[(first.span, "it stands here first")])
