"""Problems of fields and types: widths, sizes, bits and values."""

from __future__ import annotations

from protogen.problems.catalogue.code import Code
from protogen.problems.catalogue.sketch import with_fields, with_message
from protogen.problems.severity import Severity

FIELD_CODES: tuple[Code, ...] = (
    Code(
        "PG104",
        "unknown-type",
        "There is no such type",
        """\
A type is one of the built-in ones (`uint1` to `uint64`, `sint1` to `sint64`, `byte`, `char`,
`bool`, `float32`, `float64`, `ascii`, `bytes`) or is declared under `types`. A part of a frame is
always an unsigned integer, `byte` or `char`.
""",
        with_fields("angle: int16"),
        with_fields("angle: sint16"),
    ),
    Code(
        "PG105",
        "bad-width",
        "An integer has a width that it can't have",
        """\
Integers have 1 to 64 bits, because that is what fits a number in every language. A longer run of
bytes is `bytes` with a `size`, or an array. A part of a frame takes whole bytes: two parts of four
bits would not share a byte, but take one each. Declare the byte, and say in `doc` what is in it.
""",
        with_fields("serial_number: uint96"),
        with_fields("serial_number: {type: bytes, size: 12}"),
    ),
    Code(
        "PG109",
        "no-byte-order",
        "Nothing says in which order bytes are sent",
        """\
A number of more than one byte can be sent with its least or with its most significant byte first.
The two ends have to agree, so there is no default. Set `byte_order` on the protocol, for a sender,
on a message, a field or a part.
""",
        """\
protocol: demo
endpoints: {host: Host computer, robot: Robot}
frame: {id: {type: uint8, id: true}, payload: {}, end: {literal: 0xC0}}
transparency: slip
messages:
  gyro: {id: 1, from: robot, fields: {angle: uint16}}
""",
        """\
protocol: demo
endpoints: {host: Host computer, robot: Robot}
byte_order: big
frame: {id: {type: uint8, id: true}, payload: {}, end: {literal: 0xC0}}
transparency: slip
messages:
  gyro: {id: 1, from: robot, fields: {angle: uint16}}
""",
    ),
    Code(
        "PG110",
        "conflicting-keys",
        "Keys that do not go together",
        """\
The field has keys that make no sense with each other or with its type: a `scale` on a text, `flags`
on a signed integer, a `type` beside `fields`, an `ascii` field without a `size`. What such a field
would be on the wire is anyone's guess. Keep the keys that say what you mean.
""",
        with_fields("name: {type: ascii, size: 16, scale: 2}"),
        with_fields("name: {type: ascii, size: 16}"),
    ),
    Code(
        "PG111",
        "field-after-fill",
        "A field behind one that fills the payload",
        """\
A field with `count: fill` or `size: fill` takes all that is left of the payload. For a field behind
it nothing is left, and a receiver could not find it. Move the field that fills to the end, or give
it a number or a counting field. Only an array of elements of one size may have fields behind it.
""",
        with_fields("""
            text: {type: ascii, size: {fill: true, max: 32}}
            line: uint8
        """),
        with_fields("""
            line: uint8
            text: {type: ascii, size: {fill: true, max: 32}}
        """),
    ),
    Code(
        "PG112",
        "overlapping-bits",
        "Bit ranges overlap",
        """\
Two names under `bits` claim the same bit, so a sender could be asked to make it 0 and 1 at once.
Bits count from 0, the least significant one; both ends of `LOW..HIGH` are included. Only bits in a
list, such as `bits: [5..7]`, may have other names, too: they mean something else in other frames.
""",
        with_fields("""
            command:
              type: uint8
              bits: {number: 0..5, action: 5..7}
        """),
        with_fields("""
            command:
              type: uint8
              bits: {number: 0..4, action: 5..7}
        """),
    ),
    Code(
        "PG113",
        "bits-too-high",
        "Bits that the integer does not have",
        """\
A bit or a run of bits lies beyond the integer, or its ends are in the wrong order. Bits count from
0, so the highest bit of a `uint8` is 7. Documents often count from 1: then subtract one everywhere.
""",
        with_fields("status: {type: uint8, flags: {ready: 1, moving: 2, error: 8}}"),
        with_fields("status: {type: uint8, flags: {ready: 0, moving: 1, error: 7}}"),
    ),
    Code(
        "PG296",
        "several-runs-of-bits",
        "Runs of bits that are no list, or values and expressions that they do not have",
        """\
A name may stand for several runs of bits, such as `bits: [0..3, 5..7]`: they are listed from the
lowest bit on, and other bits lie between them. In a value the runs keep their distances, counted
from the lowest bit, so a named value has none of the bits in between. Nothing can be worked out of
several runs together.
""",
        with_fields("""
            control:
              type: uint8
              bits: {kind: {bits: [5..7, 0..3]}, poll: 4}
        """),
        with_fields("""
            control:
              type: uint8
              bits: {kind: {bits: [0..3, 5..7]}, poll: 4}
        """),
    ),
    Code(
        "PG114",
        "value-does-not-fit",
        "A value does not fit",
        """\
A `range`, `const`, `default`, `special` or enum value can't be held by the field or part, or lies
out of its range. It could never be on the wire, so the width or the value is wrong. These are raw
values, before `scale` and `offset`.
""",
        with_fields("mode: {type: uint7, values: {idle: 0, moving: 1, failed: 0x80}}"),
        with_fields("mode: {type: uint8, values: {idle: 0, moving: 1, failed: 0x80}}"),
    ),
    Code(
        "PG115",
        "empty-range",
        "A range holds nothing",
        """\
The least value is greater than the greatest one, so no value would be valid. Ranges are written
`[LEAST, GREATEST]`; with negative numbers it is easy to swap them. The same holds for `min_size`
and `max_size`.
""",
        with_fields("temperature: {type: sint8, range: [40, -40]}"),
        with_fields("temperature: {type: sint8, range: [-40, 40]}"),
    ),
    Code(
        "PG116",
        "no-earlier-field",
        "There is no earlier field of that name",
        """\
`count`, `size` and `switch` name fields that a receiver has already read: those in front, in the
same struct or message or in one around it. A field behind comes too late. Correct the spelling, or
change the order if the wire has it the other way round.
""",
        with_fields("""
                ranges: {type: uint16, count: clusters}
                clusters: {type: uint8}
            """).replace("ranges: {type", "ranges: {type"),
        with_fields("""
            clusters: {type: uint8, range: [0, 16]}
            ranges: {type: uint16, count: clusters}
        """),
    ),
    Code(
        "PG117",
        "bad-count",
        "A field that can't count",
        """\
How many elements follow is told by an unsigned integer. A signed one could be negative, a float
could be a half, an array is not one number, and flags or runs of bits are several.
""",
        with_fields("""
            points: sint8
            ranges: {type: uint16, count: points}
        """),
        with_fields("""
            points: uint8
            ranges: {type: uint16, count: points}
        """),
    ),
    Code(
        "PG118",
        "unbounded-fill",
        "A field without an end",
        """\
A field that fills the payload ends where the payload ends. So the frame must tell where that is,
by a length part or by an end literal, and something must bound it, because a receiver needs memory
for the greatest frame. A length part does both; with an end literal alone give a bound:
`{fill: true, max: 64}`. An element that may be empty can't fill: nobody could count them.
""",
        with_fields("text: {type: ascii, size: fill}"),
        with_fields("text: {type: ascii, size: {fill: true, max: 64}}"),
    ),
    Code(
        "PG119",
        "circular-types",
        "Types go in a circle",
        """\
A type that contains itself, directly or by way of others, would take endlessly many bytes. On a
wire such things are built with a count: make it an array of a type that ends.
""",
        with_fields(
            "root: node",
            more="""
                types:
                  node: {fields: {value: uint8, next: node}}
            """,
        ),
        with_fields(
            """
                nodes: uint8
                root: {type: node, count: nodes}
            """,
            more="""
                types:
                  node: {fields: {value: uint8, parent: uint8}}
            """,
        ),
    ),
    Code(
        "PG120",
        "value-named-twice",
        "A value or a bit has two names",
        """\
Two names stand for one raw value or one bit. A decoder could not know which to show, and most often
one of the numbers is a slip.
""",
        with_fields("mode: {type: uint8, values: {idle: 0, moving: 1, turning: 1}}"),
        with_fields("mode: {type: uint8, values: {idle: 0, moving: 1, turning: 2}}"),
    ),
    Code(
        "PG121",
        "bad-case",
        "A case that can't be chosen",
        """\
The cases of a `switch` are values of the field that it names: numbers that this field can have, or
names of its enum. A case with any other key would never be chosen, and of two cases for one value
one would be lost.
""",
        with_fields("""
            operation: {type: uint8, values: {reset: 1, speed: 2}}
            argument:
              switch: operation
              cases: {reset: {fields: {}}, sped: uint16}
        """),
        with_fields("""
            operation: {type: uint8, values: {reset: 1, speed: 2}}
            argument:
              switch: operation
              cases: {reset: {fields: {}}, speed: uint16}
        """),
    ),
    Code(
        "PG122",
        "frame-too-large",
        "A frame can be larger than 1 MiB, or has too many fields",
        """\
A receiver has to hold the greatest frame, and a damaged length must not make it wait for millions
of bytes that never come. Bound the count with a `range` on the counting field, the length part with
a `range`, or a field that fills with `max`. Structs and declared types are nested at most 64 deep,
and declared types come to at most 50000 fields where they are used: a few lines that repeat each
other can't come to more than a program can hold.
""",
        with_fields("""
            points: uint32
            ranges: {type: uint16, count: points}
        """),
        with_fields("""
            points: {type: uint32, range: [0, 360]}
            ranges: {type: uint16, count: points}
        """),
    ),
    Code(
        "PG123",
        "zero-scale",
        "A scale of zero, or beyond floating point",
        """\
The physical value is the raw value times `scale` plus `offset`. With a scale of zero all raw values
would mean the same, and an encoder could not get back to them. Leave `scale` out where raw and
physical value are equal. Programs have physical values as 64-bit floating point, up to 1.8e308: a
`scale` or `offset` that makes greater ones, or a scale below 2.3e-308, is a mistake as well.
""",
        with_fields("angle: {type: sint16, scale: 0, unit: deg}"),
        with_fields("angle: {type: sint16, scale: 1/16, unit: deg}"),
    ),
    Code(
        "PG124",
        "leading-zero",
        "A number that begins with a zero",
        """\
`010` is ten in YAML 1.2, which protogen and most editors read, and eight in YAML 1.1 and in C. So
it is not clear what is meant. Write `10`, or `0o10` for an octal number. In a text, such as a
version, zeros stay as they are.
""",
        with_message("""
            fields: {angle: {type: uint16, default: 010}}
        """),
        with_message("""
            fields: {angle: {type: uint16, default: 10}}
        """),
        severity=Severity.WARNING,
    ),
    Code(
        "PG125",
        "unit-is-a-number",
        "A unit that is a number",
        """\
A unit is the name of what a physical value is counted in, such as `mm` or `deg/s`. What a raw value
is multiplied by is its `scale`. A quantity without a unit has none, or `unit: 1`.
""",
        with_fields("range: {type: uint16, unit: 5}"),
        with_fields("range: {type: uint16, scale: 5, unit: mm}"),
        severity=Severity.WARNING,
    ),
)
