"""A text -> its nodes, from the events and tokens of the YAML parser.

The text is that of a schema without problems: one document, no tags, keys that are scalars.

There are libraries that keep comments, ruamel.yaml for one. It ties a comment to what stands in
front of it, so that comments go astray when keys are put in order, loses some between brackets, and
does not know columns. So the parser that is there anyhow is asked where everything stands.
"""

from __future__ import annotations

import re
from bisect import bisect_left
from collections.abc import Iterator
from typing import Any

import yaml

from protogen.layout.comments import place_comments
from protogen.layout.nodes import Alias, Collection, Item, Node, Scalar, Text
from protogen.schema.text.compose import FAST_LOADER

_PROPERTIES = re.compile(r"(?:&[^\s,\[\]{}]+\s*(?:#.*\s*)*)+")
_VERSION = re.compile(r"%YAML[^\n]*\n")


def read(text: str) -> Text:
    """Return the nodes of `text`, which has no byte order mark and only line feeds as breaks."""
    reader = _Reader(text)
    root = reader.root()
    if not isinstance(root, Collection):
        raise TypeError("a schema is a mapping")
    place_comments(text, root)
    version = _VERSION.match(text)
    head = [version[0].rstrip(), "---"] if version else []
    if root.items:
        head += root.items[0].leading
        root.items[0].leading = []
    return Text(head, root)


def _events(text: str) -> Iterator[Any]:
    parser = FAST_LOADER(text)
    while parser.check_event():
        yield parser.get_event()


def _dashes(text: str) -> Iterator[int]:
    """Yield where the elements of lists begin that are not between brackets."""
    scanner = FAST_LOADER(text)
    while scanner.check_token():
        token: Any = scanner.get_token()
        if isinstance(token, yaml.BlockEntryToken):
            yield _start(token)


def _start(event: Any) -> int:
    start: int = event.start_mark.index
    return start


def _end(event: Any) -> int:
    end: int = event.end_mark.index
    return end


class _Reader:
    """Puts nodes together, event by event."""

    def __init__(self, text: str) -> None:
        self._text = text
        self._events = _events(text)
        self._dashes = list(_dashes(text))

    def root(self) -> Node:
        for event in self._events:
            if isinstance(event, yaml.DocumentStartEvent):
                return self._node(next(self._events))
        raise TypeError("there is no document")

    def _node(self, event: Any) -> Node:
        start, end = _start(event), _end(event)
        if isinstance(event, yaml.AliasEvent):
            return Alias(str(event.anchor), start, end)
        begin = self._behind_properties(event)
        if isinstance(event, yaml.ScalarEvent):
            source = self._text[begin:end].rstrip()
            style = event.style or ""
            return Scalar(event.value, source, style, begin, begin + len(source), event.anchor)
        return self._collection(event, begin)

    def _behind_properties(self, event: Any) -> int:
        start = _start(event)
        found = _PROPERTIES.match(self._text, start) if event.anchor is not None else None
        return start if found is None else found.end()

    def _collection(self, event: Any, begin: int) -> Collection:
        is_mapping = isinstance(event, yaml.MappingStartEvent)
        is_flow = bool(event.flow_style)
        items: list[Item] = []
        while True:
            first = next(self._events)
            if isinstance(first, yaml.CollectionEndEvent):
                end = _end(first)
                return Collection(is_mapping, is_flow, items, begin, end, event.anchor)
            items.append(self._item(first, is_mapping=is_mapping, is_flow=is_flow))

    def _item(self, first: Any, *, is_mapping: bool, is_flow: bool) -> Item:
        start = _start(first)
        if not is_mapping and not is_flow:
            start = self._dashes[bisect_left(self._dashes, start) - 1]
        node = self._node(first)
        value = self._node(next(self._events)) if is_mapping else node
        key = node if is_mapping else None
        return Item(key, value, start, self._column(start), self._value_column(start, value))

    def _column(self, index: int) -> int:
        return index - (self._text.rfind("\n", 0, index) + 1)

    def _value_column(self, start: int, value: Node) -> int | None:
        begin = value.start
        if value.anchor is not None:
            begin = self._text.rfind("&", start, value.start)
        return None if "\n" in self._text[start:begin] else self._column(begin)
