"""Comments and the items that they belong to.

A comment on a line of its own belongs to what follows it; where nothing follows in the same
mapping or list, it stands at the foot of the one whose indentation it has. A comment behind
something belongs to the innermost item in front of it.
"""

from __future__ import annotations

import re
from collections.abc import Iterator

from protogen.layout.nodes import Collection, Comment, Item, Scalar, walk

_COMMENT = re.compile(r"(?<!\S)#[^\n]*")


def place_comments(text: str, root: Collection) -> None:
    """Put every comment, and the blank lines in front of items, to the items of `root`."""
    for match in _comments(text, root):
        start, comment = match.start(), match[0].rstrip()
        line_start = text.rfind("\n", 0, start) + 1
        before = text[line_start:start]
        if before.strip():
            # More than the usual two spaces line it up with others.
            column = len(before) if before.endswith("   ") else 0
            _place_beside(Comment(comment, column), start, root)
        else:
            lines = [""] * _below_blank(text, line_start) + [comment]
            _place_alone(lines, start, len(before), root)
    _place_blanks(text, root)


def _comments(text: str, root: Collection) -> Iterator[re.Match[str]]:
    position = 0
    spans = [_content(text, node) for node in walk(root) if isinstance(node, Scalar)]
    for start, end in [*spans, (len(text), len(text))]:
        yield from _COMMENT.finditer(text, position, max(start, position))
        position = max(position, end)


def _content(text: str, scalar: Scalar) -> tuple[int, int]:
    """Return where no comment can be: all of a scalar but the first line of a block."""
    if not scalar.is_block:
        return scalar.start, scalar.end
    line_end = text.find("\n", scalar.start)
    start = len(text) if line_end < 0 else line_end
    return start, max(start, scalar.end)


def _below_blank(text: str, line_start: int) -> bool:
    above = text[text.rfind("\n", 0, max(line_start - 1, 0)) + 1 : line_start]
    return line_start > 0 and not above.strip()


def _place_alone(lines: list[str], start: int, column: int, within: Collection) -> None:
    before = _last_before(within, start)
    following = _first_behind(within, start)
    if before is not None and _is_inside(start, column, before, within):
        assert isinstance(before.value, Collection)
        _place_alone(lines, start, column, before.value)
    elif before is not None and start < before.value.start:
        before.leading += lines
    elif following is not None:
        following.leading += lines
    else:
        within.foot += lines


def _is_inside(start: int, column: int, item: Item, within: Collection) -> bool:
    inner = item.value
    if not isinstance(inner, Collection) or not inner.items:
        return False
    if inner.is_flow:
        return inner.start < start < inner.end
    return column > within.column or _first_behind(inner, start) is not None


def _place_beside(comment: Comment, start: int, within: Collection) -> None:
    item = _last_before(within, start)
    while item is not None:
        inner = item.value
        if not isinstance(inner, Collection) or (inner.is_flow and start >= inner.end):
            break
        deeper = _last_before(inner, start)
        if deeper is None:
            break
        item = deeper
    if item is None:
        within.items[0].leading.append(comment.text)
    else:
        item.beside.append(comment)


def _last_before(collection: Collection, position: int) -> Item | None:
    found = None
    for item in collection.items:
        if item.start > position:
            break
        found = item
    return found


def _first_behind(collection: Collection, position: int) -> Item | None:
    return next((item for item in collection.items if item.start > position), None)


def _place_blanks(text: str, collection: Collection) -> None:
    for item in collection.items:
        line_start = text.rfind("\n", 0, item.start) + 1
        begins_line = not text[line_start : item.start].strip()
        if begins_line and _below_blank(text, line_start):
            item.leading.append("")
        if isinstance(item.value, Collection):
            _place_blanks(text, item.value)
