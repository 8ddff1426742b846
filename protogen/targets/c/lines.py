"""Statements of C, one below the other, as clang-format lays them out."""

from __future__ import annotations

import re
from collections.abc import Iterator
from contextlib import contextmanager
from functools import lru_cache

from protogen.targets.braces import BracedLines

WIDTH = 100
INDENT = 4

_PLACE = re.compile(
    r" +(?:const )?(?:uint8_t \*|size_t )(?P<declared>at\w*) = |    (?P<moved>at) \+= "
    r"| +const (?:bool|u?int\d+_t) (?P<remembered>\w+) = "
)
"""A line that says where the next value lies, or remembers one; one that moves is in no loop."""
_DECLARATION = re.compile(r"const |size_t |bool |uint8_t \*")


class Lines(BracedLines):
    """Statements of C."""

    def __init__(self, depth: int = 1) -> None:
        super().__init__(INDENT, depth)

    def add(self, *lines: str) -> None:
        """Add lines at the current depth; those of the preprocessor have no indent."""
        margin = self.margin
        self._lines += [line if line.startswith("#") else margin + line for line in lines]

    def put_first(self, *lines: str) -> None:
        """Put lines in front of all others."""
        self.put_at(0, *lines)

    def put_at(self, place: int, *lines: str) -> None:
        """Put lines of the current depth in front of those from a place on."""
        margin = self.margin
        self._lines[place:place] = [
            line if line.startswith("#") else margin + line for line in lines
        ]

    @contextmanager
    def switch(self, selector: str) -> Iterator[None]:
        """A switch, whose labels stand below its own start."""
        self.add(f"switch ({selector}) {{")
        yield
        self.add("}")

    @contextmanager
    def case(self, label: str) -> Iterator[None]:
        """A case, with the break that ends it."""
        start = len(self._lines)
        self._depth += 1
        yield
        if not self._lines[start:] or not self._lines[-1].lstrip().startswith("return "):
            self.add("break;")
        self._depth -= 1
        body, self._lines = self._lines[start:], self._lines[:start]
        indent = " " * (INDENT * (self._depth + 1))
        nothing = [f"{indent}break;"]
        if body == nothing and self._lines[-1:] == nothing and self._lines[-2].endswith(":"):
            self._lines.pop()
        declares = any(_DECLARATION.match(line.removeprefix(indent)) for line in body)
        self.add(f"{label}: {{" if declares else f"{label}:")
        self._lines += body
        if declares:
            self.add("}")

    def drop_unused_places(self) -> None:
        """Take out what says where something without bytes lies, or remembers what nobody asks."""
        kept: list[str] = []
        for line in reversed(self._lines):
            place = _PLACE.match(line)
            name = place and (place["declared"] or place["moved"] or place["remembered"])
            if not name or any(re.search(rf"\b{name}\b", other) for other in kept):
                kept.append(line)
        self._lines = kept[::-1]

    def __len__(self) -> int:
        return len(self._lines)

    def __bool__(self) -> bool:
        return bool(self._lines)


def mentions(text: str, name: str) -> bool:
    """True if a text of C uses a variable."""
    return _use_of(name).search(text) is not None


@lru_cache(maxsize=256)
def _use_of(name: str) -> re.Pattern[str]:
    # The name comes first: so texts without it are gone through fast.
    return re.compile(rf"{name}\b(?<![\w.>]{name})")


def assertion(name: str, condition: str) -> str:
    """A declaration that does not compile where a condition does not hold, in any C or C++."""
    return f"typedef char {name}[{condition} ? 1 : -1];"


def function(head: str, arguments: tuple[str, ...], body: Lines) -> str:
    """A function's definition."""
    return "\n".join([prototype(head, arguments, " {"), *body.lines, "}"])


def prototype(head: str, arguments: tuple[str, ...], end: str = ";") -> str:
    """A function's head; where it is too long, its arguments go on below each other."""
    whole = f"{head}({', '.join(arguments) or 'void'}){end}"
    if len(whole) <= WIDTH:
        return whole
    items = [f"{argument}," for argument in arguments[:-1]]
    items.append(f"{arguments[-1] if arguments else 'void'}){end}")
    margin = len(head) + 1
    is_long = margin + max(map(len, items)) > WIDTH
    lines = [f"{head}("] if is_long else [f"{head}({items.pop(0)}"]
    margin = INDENT if is_long else margin
    for item in items:
        if len(lines) > is_long and len(lines[-1]) + 1 + len(item) <= WIDTH:
            lines[-1] += f" {item}"
        else:
            lines.append(" " * margin + item)
    return "\n".join(lines)
