"""Nodes -> text in the canonical layout.

Indentation is by two spaces. What was written between brackets stays so where it fits its line and
holds no comment; otherwise it becomes a block. Columns that an author has lined up stay columns.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from itertools import groupby

from protogen.copying import replace
from protogen.layout.nodes import Alias, Collection, Item, Node, Scalar, Text, has_comments
from protogen.layout.scalars import (
    FOLDED,
    block_lines,
    can_be_folded,
    filled,
    folded,
    on_one_line,
    quoted,
)

WIDTH = 100
"""The greatest length of a line, as far as words and comments allow it."""
STEP = 2


def print_text(text: Text) -> str:
    """Return the text in the canonical layout."""
    # A key that came first by its order alone brings comments that are not the file's.
    between = [""] if any(text.root.items[0].leading) else []
    lines = [*text.head, *between, *_block(text.root, 0)]
    return "\n".join(_single_blanks(lines)) + "\n"


def _single_blanks(lines: Sequence[str]) -> Iterator[str]:
    """Yield the lines without blank ones at the start, and without two of them in a row."""
    before = ""
    for line in lines:
        if line or before:
            yield line
        before = line


# --- blocks ---------------------------------------------------------------------------------------


def _block(collection: Collection, indent: int) -> list[str]:
    """Return the lines of a mapping or list that is not empty."""
    lines: list[str] = []
    runs = groupby(_with_run_numbers(collection, indent), key=lambda pair: pair[0])
    for _, run in runs:
        items = [item for _, item in run]
        column = _common_column(items, indent)
        for item in items:
            lines += _leading(item, indent, is_first=item is collection.items[0])
            lines += _item(item, indent, column)
    return lines + _indented(collection.foot, indent)


def _with_run_numbers(collection: Collection, indent: int) -> Iterator[tuple[int, Item]]:
    """Yield the items with the number of the run of neighbours that may share columns."""
    number = 0
    was_short = False
    for item in collection.items:
        is_short = item.key is not None and _fits(item, indent, 1)
        if not (is_short and was_short) or item.leading:
            number += 1
        was_short = is_short
        yield number, item


def _common_column(items: Sequence[Item], indent: int) -> int:
    """Return how long the heads of a run have to be; 0 where their values are not lined up."""
    if len(items) == 1:
        return 0
    columns = {item.value_column for item in items}
    gaps = [_gap(item) for item in items]
    if len(columns) > 1 or None in columns or max(gaps) < 2:
        return 0
    longest = max(len(_head(item)) for item in items)
    fit = all(_fits(item, indent, longest + 1 - len(_head(item))) for item in items)
    return longest if fit else 0


def _gap(item: Item) -> int:
    """Return how many spaces stand between a key and its value."""
    if item.value_column is None:
        return 0
    return item.value_column - item.column - len(_written_key(item)) - 1


def _written_key(item: Item) -> str:
    key = item.key
    return key.source if isinstance(key, Scalar) else _head(item)[:-1]


def _leading(item: Item, indent: int, *, is_first: bool) -> list[str]:
    lines = [*item.leading, *_hoisted(item, indent)]
    while is_first and lines and not lines[0]:
        lines = lines[1:]
    return _indented(lines, indent)


def _hoisted(item: Item, indent: int) -> list[str]:
    """Return the comments that stand between the dash of an element and its first key."""
    if not _is_compact(item, indent):
        return []
    assert isinstance(item.value, Collection)
    first = item.value.items[0]
    own = [comment.text for comment in (*item.beside, *first.beside[:-1])]
    return [*own, *filter(None, first.leading), *_hoisted(first, indent + STEP)]


def _is_compact(item: Item, indent: int) -> bool:
    """Tell whether the value is a block that begins on the line of the dash."""
    value = item.value
    return (
        item.key is None
        and isinstance(value, Collection)
        and bool(value.items)
        and value.anchor is None
        and not _fits(item, indent, 1)
        and not _is_list_of_words(value)
    )


def _indented(lines: Sequence[str], indent: int) -> list[str]:
    return [" " * indent + line if line else "" for line in lines]


# --- items ----------------------------------------------------------------------------------------


def _item(item: Item, indent: int, column: int) -> list[str]:
    head = _head(item)
    gap = max(column - len(head), 0) + 1
    if _is_inline(item.value) and (_fits(item, indent, gap) or not _can_be_broken(item.value)):
        written = _inline(item.value, in_flow=False)
        line = f"{' ' * indent}{head}{' ' * gap if written else ''}{written}"
        return _with_comments(line, item, indent)
    return _broken(item, indent)


def _head(item: Item) -> str:
    if item.key is None:
        return "-"
    key = _inline(item.key, in_flow=False)
    return f"{key} :" if isinstance(item.key, Alias) else f"{key}:"


def _fits(item: Item, indent: int, gap: int) -> bool:
    if not _is_inline(item.value):
        return False
    written = _inline(item.value, in_flow=False)
    return indent + len(_head(item)) + gap + len(written) <= WIDTH


def _with_comments(line: str, item: Item, indent: int) -> list[str]:
    """Return a line with the comment beside it; more of them go in front."""
    if not item.beside:
        return [line]
    *others, last = item.beside
    width = max(len(line) + 2, last.column)
    return [*_indented([comment.text for comment in others], indent), line.ljust(width) + last.text]


def _broken(item: Item, indent: int) -> list[str]:
    """Return an item whose value does not stand on the line of its key."""
    value = item.value
    if isinstance(value, Scalar):
        return _broken_scalar(value, item, indent)
    assert isinstance(value, Collection)
    if _is_list_of_words(value):
        return _filled_list(value, item, indent)
    head = " " * indent + _joined(_head(item), _properties(value))
    if _is_compact(item, indent):
        inner = _block(_without_first_leading(value), indent + STEP)
        return [head + inner[0][indent + 1 :], *inner[1:]]
    return [*_with_comments(head, item, indent), *_block(value, indent + STEP)]


def _without_first_leading(collection: Collection) -> Collection:
    """Return the collection without the comments that were hoisted out of it."""
    first, *others = collection.items
    bare = replace(first, leading=[], beside=first.beside[-1:])
    return replace(collection, items=[bare, *others])


def _broken_scalar(scalar: Scalar, item: Item, indent: int) -> list[str]:
    width = WIDTH - indent - STEP
    block = block_lines(scalar, width) if scalar.is_block else None
    if block is None and (scalar.is_block or not can_be_folded(scalar)):
        line = " " * indent + _joined(_head(item), _properties(scalar), quoted(scalar.value))
        return _with_comments(line, item, indent)
    header, lines = block or (FOLDED, folded(scalar.value, width))
    head = " " * indent + _joined(_head(item), _properties(scalar), header)
    return [*_with_comments(head, item, indent), *_indented(lines, indent + STEP)]


def _filled_list(collection: Collection, item: Item, indent: int) -> list[str]:
    """Return a list of numbers or words over several lines."""
    head = " " * indent + _joined(_head(item), _properties(collection))
    words = [_inline(element.value, in_flow=True) + "," for element in collection.items]
    words[0] = "[" + words[0]
    words[-1] = words[-1][:-1] + "]"
    first, *others = filled(words, WIDTH - indent - STEP - 1)
    lines = [first, *(" " + line for line in others)]
    return [*_with_comments(head, item, indent), *_indented(lines, indent + STEP)]


# --- on one line ----------------------------------------------------------------------------------


def _is_inline(node: Node) -> bool:
    """Tell whether the node may stand on one line, however long that is."""
    if isinstance(node, Scalar):
        return not node.is_block
    if isinstance(node, Alias):
        return True
    return not node.items or (node.is_flow and not has_comments(node))


def _can_be_broken(node: Node) -> bool:
    if isinstance(node, Scalar):
        return can_be_folded(node)
    return isinstance(node, Collection) and bool(node.items)


def _is_list_of_words(collection: Collection) -> bool:
    return (
        collection.is_flow
        and not collection.is_mapping
        and not has_comments(collection)
        and not any(isinstance(item.value, Collection) for item in collection.items)
    )


def _inline(node: Node, *, in_flow: bool) -> str:
    match node:
        case Alias(name=name):
            return f"*{name}"
        case Scalar():
            return _joined(_properties(node), on_one_line(node, in_flow=in_flow))
        case Collection(items=items, is_mapping=is_mapping):
            inner = ", ".join(map(_inline_item, items))
            return _joined(_properties(node), f"{{{inner}}}" if is_mapping else f"[{inner}]")


def _inline_item(item: Item) -> str:
    value = _inline(item.value, in_flow=True)
    return value if item.key is None else f"{_head(item)} {value}"


def _properties(node: Node) -> str:
    return f"&{node.anchor}" if node.anchor is not None else ""


def _joined(*words: str) -> str:
    return " ".join(word for word in words if word)
