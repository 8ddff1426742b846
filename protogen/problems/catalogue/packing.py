"""Problems of packed integers, whose bits follow each other without byte boundaries."""

from __future__ import annotations

from protogen.problems.catalogue.code import Code
from protogen.problems.catalogue.sketch import with_fields

PACKING_CODES: tuple[Code, ...] = (
    Code(
        "PG220",
        "nothing-to-pack",
        "`packed` where there is nothing to pack",
        """\
`packed` stands on an array of integers, or on a struct of them: their bits follow each other
without byte boundaries. A single number has nothing to follow, and in a packed struct everything
is packed already. Two neighbours that share bytes are a packed struct of two fields.
""",
        with_fields("""
            mode: {type: uint3, packed: lsb_first}
            level: {type: uint5, packed: lsb_first}
        """),
        with_fields("""
            state: {packed: lsb_first, fields: {mode: uint3, level: uint5}}
        """),
    ),
    Code(
        "PG221",
        "not-packable",
        "Something that can't be packed",
        """\
Only integers are packed (with names of values, flags, ranges and scales as elsewhere), and arrays
of them: of a fixed number, or outside of packed structs as many as fill what is left. Where a
number begins has to be the same in every message, so that `when` has no place among them, and
floats, texts, structs and cases begin at a byte. End the packed struct in front of them.
""",
        with_fields("""
            state: {packed: lsb_first, fields: {mode: uint4, angle: uint12, speed: float32}}
        """),
        with_fields("""
            state: {packed: lsb_first, fields: {mode: uint4, angle: uint12}}
            speed: float32
        """),
    ),
    Code(
        "PG222",
        "packed-byte-order",
        "A byte order of bits that are packed",
        """\
`packed` says all about the order: with `lsb_first` a number begins with its least significant bit,
with `msb_first` with its most significant one. Its bits need not begin or end at a byte, so there
are no bytes of it to put in order.
""",
        with_fields("channels: {type: uint11, count: 16, packed: lsb_first, byte_order: big}"),
        with_fields("channels: {type: uint11, count: 16, packed: lsb_first}"),
    ),
    Code(
        "PG223",
        "packed-seven-bits",
        "Packed bits in bytes of 7 bits",
        """\
With `byte_bits: 7` each byte carries 7 bits, and its most significant bit is zero. Packed integers
take all 8 bits of a byte. Declare each number by itself: one of 8 to 14 bits takes two bytes.
""",
        with_fields("channels: {type: uint11, count: 2, packed: lsb_first}", more="byte_bits: 7"),
        with_fields("channels: {type: uint11, count: 2}", more="byte_bits: 7"),
    ),
    Code(
        "PG302",
        "unclear-packed-count",
        "Packed integers to the end, whose number their bytes do not tell",
        """\
With `count: fill`, packed integers take all bytes that are left, and these tell how many there are:
fewer than 8 bits are left in the last byte. If an integer has fewer than 8 bits itself, one more
may take no byte more, and nothing tells whether it is there. Write how many there are; if there may
be several numbers of them, a switch has a case for each.
""",
        with_fields("""
            switches: {type: uint4, packed: lsb_first, count: {fill: true, max: 4}}
        """),
        with_fields("""
            more: bool
            switches:
              switch: more
              cases:
                0: {type: uint4, packed: lsb_first, count: 2}
                1: {type: uint4, packed: lsb_first, count: 4}
        """),
    ),
)
