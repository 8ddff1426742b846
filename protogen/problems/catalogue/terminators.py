"""Problems of texts and bytes that a terminator ends."""

from __future__ import annotations

from protogen.problems.catalogue.code import Code
from protogen.problems.catalogue.sketch import with_fields

TERMINATOR_CODES: tuple[Code, ...] = (
    Code(
        "PG229",
        "no-terminator-here",
        "A terminator of what has none",
        """\
`until` is the byte behind an `ascii` or `bytes` field that says where it ends. Numbers have the
size of their type, and arrays and structs a number of elements. What has a `size` needs no
terminator, and a constant is always the same: it has a `size`, and its last byte may be a
terminator like any other.
""",
        with_fields("name: {type: ascii, size: 16, until: 0}"),
        with_fields("name: {type: ascii, until: {byte: 0, max: 16}}"),
    ),
    Code(
        "PG230",
        "unfit-terminator",
        "A terminator that bounds nothing, or that no byte can be",
        """\
A receiver needs memory for the greatest value in front of a terminator. So the frame bounds it, by
a length part or by `max_frame`, or the field does: `until: {byte: 0, max: 64}`. Where `min` and
`max` leave only one size, the terminator says nothing: that is a field of a `size` with a constant
byte behind it. With `byte_bits: 7` no byte of a payload is greater than 0x7F.
""",
        with_fields("name: {type: ascii, until: 0}"),
        with_fields("name: {type: ascii, until: {byte: 0, max: 64}}"),
    ),
)
