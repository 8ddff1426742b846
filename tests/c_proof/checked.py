"""Generated C in which each access to an array that is a member says its bounds.

ESBMC sees where an access leaves an object, but not where it goes from one member of a struct into
the next one. So each subscript of a member, and each copy from or to one, asserts that it stays
within. Nothing else changes.
"""

from __future__ import annotations

import re

MACROS = """#define IS_ARRAY(x) (!__builtin_types_compatible_p(__typeof__(x), __typeof__(&(x)[0])))
#define LENGTH(x) (IS_ARRAY(x) ? sizeof(x) / sizeof((x)[0]) : (size_t)-1)
#define WITHIN(x, index) within((size_t)(index), LENGTH(x))
#define FITS(x, size) (void)within(size, (IS_ARRAY(x) ? sizeof(x) : (size_t)-2) + 1U)

static inline size_t within(size_t index, size_t length) {
    __ESBMC_assert(index < length, "out of bounds of a member");
    return index;
}
"""
_PATH = re.compile(r"\b[A-Za-z_]\w*(?=(?:->|\.)[A-Za-z_])")
_MEMBER = re.compile(r"(?:->|\.)[A-Za-z_]\w*")
_COPY = """#define {name}(to, from, size) \\
    (FITS(to, size), FITS(from, size), ({name})(to, from, size))
"""


def checked(source: str, protocol: str) -> str:
    """The source of a protocol with its assertions; `MACROS` have to stand in front of it."""
    name = f"{protocol}_copy"
    text = _subscripts(source)
    copy = re.search(rf"^static void {name}\((?:.*\n)*?\}}\n", text, re.MULTILINE)
    if copy is None:
        return text
    return text[: copy.end()] + _COPY.format(name=name) + text[copy.end() :]


def _subscripts(text: str) -> str:
    """Each subscript of a member asserts its bounds, those inside of it first."""
    parts, at = [], 0
    while path := _PATH.search(text, at):
        parts.append(text[at : path.end()])
        at, start = path.end(), path.start()
        while at < len(text):
            if member := _MEMBER.match(text, at):
                parts.append(member.group())
                at = member.end()
            elif text[at] == "[":
                end = _closing(text, at)
                index = _subscripts(text[at + 1 : end])
                parts.append(f"[WITHIN({text[start:at]}, {index})]")
                at = end + 1
            else:
                break
    return "".join([*parts, text[at:]])


def _closing(text: str, opening: int) -> int:
    """The place of the bracket that closes another one."""
    depth = 0
    for at in range(opening, len(text)):
        depth += {"[": 1, "]": -1}.get(text[at], 0)
        if depth == 0:
            return at
    raise AssertionError(text[opening:])
