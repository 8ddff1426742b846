"""Generated C as WP can read it."""

from __future__ import annotations

import re

_TO_WORD = re.compile(r"\(void\)memcpy\(&(\w+), ([^;]*), ([48])\);")
_FROM_WORD = re.compile(r"\(void\)memcpy\(([^;]*), &(\w+), ([48])\);")
WORDS = """
/*@ requires \\valid_read(at + (0 .. {last})); assigns \\nothing; */
static uint64_t read_{size}(const uint8_t *at);

/*@ requires \\valid(at + (0 .. {last})); assigns at[0 .. {last}]; */
static void write_{size}(uint8_t *at, uint64_t word);
"""


def portable(source: str) -> str:
    """Generated C without SSE2, in which copies of 8 and of 4 bytes are functions.

    These have the contract of `memcpy`, whose casts from one type of number to another are too much
    for WP's memory. Bits that are masked become a quotient, with which Z3 can reckon.
    """
    lines: list[str] = []
    depth, left_out = 0, False
    for line in source.splitlines(keepends=True):
        directive = line.split()[0] if line.startswith("#") else ""
        begins = directive.startswith("#if") and (depth > 0 or line.endswith("_SSE2\n"))
        depth += begins
        left_out = (left_out or begins) and not (depth == 1 and directive == "#else")
        if not left_out and not (depth == 1 and directive in ("#else", "#endif")):
            lines.append(line)
        if depth and directive == "#endif":
            depth -= 1
            left_out = left_out and depth > 0
    source = "".join(lines).replace(" & ~(size_t)7U);", " / 8U * 8U);")
    source = _TO_WORD.sub(r"\1 = read_\3(\2);", source)
    return _FROM_WORD.sub(r"write_\3(\1, \2);", source)
