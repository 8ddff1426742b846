"""Problems of arrays whose number of bytes is told."""

from __future__ import annotations

from protogen.problems.catalogue.code import Code
from protogen.problems.catalogue.sketch import with_fields

SIZED_ARRAY_CODES: tuple[Code, ...] = (
    Code(
        "PG239",
        "no-whole-elements",
        "A size in bytes that is no whole number of elements",
        """\
`size` on an array is its number of bytes. All elements have the same number of bytes, so the size
is a multiple of that, and so are its bounds. Where an earlier field says it, a receiver takes only
multiples; but one that can never be a multiple makes every message invalid.
""",
        with_fields("words: {type: uint16, size: 5}"),
        with_fields("words: {type: uint16, size: 6}"),
    ),
    Code(
        "PG240",
        "misplaced-size",
        "A size in bytes where it tells nothing",
        """\
`size` is the number of bytes of an `ascii` or `bytes` field, or of an array of elements that all
have the same size. A single struct or switch has the size of its fields; an array of structs says
`count: fill` beside the size. Beside a size there is no other count, as the size tells it.
""",
        with_fields("words: {type: uint16, count: 3, size: 6}"),
        with_fields("words: {type: uint16, size: 6}"),
    ),
)
