"""Problems of arrays whose number of bytes is told, and of regions of so many bytes."""

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
`size` is the number of bytes of an `ascii` or `bytes` field, of an array, or of the region that a
struct or a switch lies in. It tells how many elements there are, so there is no other count beside
it; `count: fill` stands for that. Where a field comes last it ends with the payload anyway, and
beside a separator with the next one.
""",
        with_fields("words: {type: uint16, count: 3, size: 6}"),
        with_fields("words: {type: uint16, size: 6}"),
    ),
    Code(
        "PG241",
        "region-never-filled",
        "A region that what lies in it never fills",
        """\
A struct or switch with a `size` takes just so many bytes. Here it can't: it always has more, or
fewer, so that every message would be invalid.
""",
        with_fields("place: {size: 3, fields: {x: uint16, y: uint16}}"),
        with_fields("place: {size: 4, fields: {x: uint16, y: uint16}}"),
    ),
)
