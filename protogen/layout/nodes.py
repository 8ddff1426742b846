"""Nodes for the formatter: how each was written, and the comments beside it."""

from __future__ import annotations

from collections.abc import Iterator

import msgspec


class Scalar(msgspec.Struct):
    """A single value."""

    value: str
    """The text that it stands for, line breaks folded and escapes read."""
    source: str
    """Style in which it was written."""
    style: str
    """`'`, `"`, `|` or `>`; empty for a plain one."""
    start: int
    end: int
    anchor: str | None = None

    @property
    def is_block(self) -> bool:
        """True if it is a block of lines below its key."""
        return self.style in ("|", ">")


class Alias(msgspec.Struct):
    """Stands for what an anchor names."""

    name: str
    start: int
    end: int
    anchor: str | None = None


class Comment(msgspec.Struct):
    """A comment behind something on the same line."""

    text: str
    column: int
    """Column where it begins if it is lined up with others; else 0."""


class Item(msgspec.Struct):
    """A key with its value, or an element of a list, which has no key."""

    key: Node | None
    value: Node
    start: int
    """Index of the key or of the dash."""
    column: int
    value_column: int | None
    """Column where the value begins if that is on the line of the key."""
    leading: list[str] = msgspec.field(default_factory=list)
    """Comments on lines of their own in front of it; an empty text is a blank line."""
    beside: list[Comment] = msgspec.field(default_factory=list)


class Collection(msgspec.Struct):
    """A mapping or a list."""

    is_mapping: bool
    is_flow: bool
    items: list[Item]
    start: int
    end: int
    anchor: str | None = None
    foot: list[str] = msgspec.field(default_factory=list)
    """Comments behind the last item."""

    @property
    def column(self) -> int:
        """The column where its items begin."""
        return self.items[0].column if self.items else 0


Node = Scalar | Alias | Collection


class Text(msgspec.Struct):
    """A whole file."""

    head: list[str]
    """Head of the text: directives and the first comments."""
    root: Collection


def has_comments(node: Node) -> bool:
    """Tell whether a comment stands inside of the node."""
    if not isinstance(node, Collection):
        return False
    return bool(node.foot) or any(
        item.beside or any(item.leading) or has_comments(item.value) for item in node.items
    )


def walk(node: Node | None) -> Iterator[Node]:
    """Yield the node and all nodes inside of it, in the order of the text."""
    if node is None:
        return
    yield node
    if isinstance(node, Collection):
        for item in node.items:
            yield from walk(item.key)
            yield from walk(item.value)
