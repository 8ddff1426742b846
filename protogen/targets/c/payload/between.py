"""What C asks of texts between separators, and of elements in front of a tail."""

from __future__ import annotations

from protogen.c_language.numbers import hexadecimal, unsigned
from protogen.model.types import Between, Tail
from protogen.targets.c.lines import Lines
from protogen.targets.c.payload.helpers import Helpers

_BYTE_COUNT = """\
const uint8_t *bytes = (const uint8_t *)at;
size_t count = 0U;
for (size_t i = 0; i < size; i++) {
    if (bytes[i] == byte) {
        count++;
    }
}
return count;
"""
_IS_PRINTABLE = """\
const uint8_t *bytes = (const uint8_t *)at;
for (size_t i = 0; i < size; i++) {
    if (bytes[i] < 0x20U || bytes[i] > 0x7EU) {
        return false;
    }
    for (size_t j = 0; j < count; j++) {
        if (bytes[i] == (uint8_t)without[j]) {
            return false;
        }
    }
}
return true;
"""


def separator_of(between: Between) -> str:
    """The separator as a number."""
    return hexadecimal(between.separator)


def text_size(helpers: Helpers, between: Between, address: str, left: str) -> str:
    """The bytes in front of the next separator, of so many that are left."""
    if between.takes_rest:
        return left
    return f"{helpers.text_size()}({address}, {left}, {separator_of(between)})"


def is_text(helpers: Helpers, between: Between, address: str, size: str) -> str:
    """The condition that a text has none but its characters."""
    without = [item for item in range(0x20, 0x7F) if item not in between.characters]
    arguments = ("const void *at", "size_t size", "const char *without", "size_t count")
    function = helpers.helper("is_printable", "bool", arguments, _IS_PRINTABLE)
    # A text in C may not end a comment or begin a trigraph; numbers do neither.
    written = "".join(f"\\{item:03o}" for item in without)
    return f'{function}({address}, {size}, "{written}", {unsigned(len(without))})'


def count_elements(
    helpers: Helpers, lines: Lines, tail: Tail, count: str, place: tuple[str, str, str]
) -> None:
    """Print how many elements stand in front of a tail.

    `place` is the address, the bytes that are left there, and a name for what is left of these.
    Small controllers do not divide.
    """
    address, left, name = place
    if tail.separator is not None:
        function = helpers.helper(
            "byte_count", "size_t", ("const void *at", "size_t size", "uint8_t byte"), _BYTE_COUNT
        )
        left = f"{function}({address}, {left}, {hexadecimal(tail.separator)})"
    least, step = unsigned(tail.element + tail.least), unsigned(tail.element)
    with lines.block(f"for (size_t {name} = {left}; {name} >= {least}; {name} -= {step})"):
        lines.add(f"{count}++;")
