"""Problems of what stands behind an array that fills, and of texts between separators."""

from __future__ import annotations

from protogen.problems.catalogue.code import Code
from protogen.problems.catalogue.sketch import with_fields, with_message

TAIL_CODES: tuple[Code, ...] = (
    Code(
        "PG297",
        "unclear-tail",
        "Fields behind an array that fills, which nothing tells from its elements",
        """\
An array with `count: fill` may have fields behind it: it ends where what is left is too little for
one more element and these fields. So its elements, and each field behind it, have a fixed number of
bytes, or of fields between separators; and optional ones among them together have less than an
element, else nothing would tell one from the other.
""",
        with_fields("""
            levels: {type: uint16, count: {fill: true, max: 8}}
            current: {type: uint8, optional: true}
            speed: {type: uint8, optional: true}
        """),
        with_fields("""
            levels: {type: uint16, count: {fill: true, max: 8}}
            current: {type: uint8, optional: true}
        """),
    ),
    Code(
        "PG298",
        "text-without-end",
        "A text whose end is not told, or told twice",
        """\
A text between separators ends in front of the next one, or where the payload does, so it has
neither a number of characters nor a terminator: its `size` says how many it can have, such as
`{max: 20}`. With `fill` it takes all that is left, separators included. Nowhere else does a `size`
or `count` without `fill` say where something ends, and only such a text is `without` some
characters.
""",
        with_message('separator: ","\nfields: {mode: {type: ascii, size: 8}, angle: decimal}'),
        with_message(
            'separator: ","\nfields: {mode: {type: ascii, size: {max: 8}}, angle: decimal}'
        ),
    ),
)
