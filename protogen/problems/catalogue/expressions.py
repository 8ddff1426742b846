"""Problems of expressions over earlier fields."""

from __future__ import annotations

from protogen.problems.catalogue.code import Code
from protogen.problems.catalogue.sketch import with_fields

EXPRESSION_CODES: tuple[Code, ...] = (
    Code(
        "PG200",
        "bad-expression",
        "An expression that can't be read",
        """\
An expression is made of whole numbers (`12`, `0x1F`, `'A'`), names of earlier fields (`points`,
`header.points`, `key.size` for bits), `+ - * // %`, the comparisons `== != < <= > >=`, `in [1, 2]`,
`and`, `or`, `not`, and round brackets. Anything else would mean one thing in one language and
another in the next.
""",
        with_fields("""
            words: {type: uint8, range: [0, 16]}
            data: {type: bytes, size: words * 4 / 2}
        """),
        with_fields("""
            words: {type: uint8, range: [0, 16]}
            data: {type: bytes, size: words * 4 // 2}
        """),
    ),
    Code(
        "PG201",
        "no-operand",
        "Something that no expression can be worked out of",
        """\
An expression is worked out of integers: of fields in front, members of structs in front
(`header.count`), and bits that have a name (`key.size`, `flags.has_gps`). A float, a text, an array
or a whole struct is no integer. A name that is a field as well as a value of the other side of a
comparison could mean either.
""",
        with_fields("""
            header: {fields: {count: {type: uint8, range: [0, 16]}, spare: uint8}}
            points: {type: uint16, count: header - 2}
        """),
        with_fields("""
            header: {fields: {count: {type: uint8, range: [2, 16]}, spare: uint8}}
            points: {type: uint16, count: header.count - 2}
        """),
    ),
    Code(
        "PG202",
        "number-or-condition",
        "A condition stands where a number is due",
        """\
A comparison is true or false, and nothing can be counted or added up with that. Where a condition
is due, a number may stand: it holds unless it is 0.
""",
        with_fields("""
            mode: {type: uint8, values: {short: 0, long: 1}}
            data: {type: bytes, size: 4 * (mode == long)}
        """),
        with_fields("""
            mode: {type: uint8, values: {short: 0, long: 1}, range: [0, 1]}
            data: {type: bytes, size: 4 * mode}
        """),
    ),
    Code(
        "PG203",
        "number-out-of-bounds",
        "A number that nothing can count, or that is too great on the way",
        """\
Every number on the way to the value has at most 62 bits, so that each language can hold it. And a
number of elements or bytes that is below 0 for every value of its fields counts nothing; where it
is below 0 for some of them, those are refused when they are received.
""",
        with_fields("""
            words: {type: uint8, range: [0, 4]}
            data: {type: bytes, size: words - 8}
        """),
        with_fields("""
            words: {type: uint8, range: [8, 12]}
            data: {type: bytes, size: words - 8}
        """),
    ),
    Code(
        "PG204",
        "bad-divisor",
        "A division by something else than a number above 0",
        """\
What is divided by has to be a number, or a field with a constant: nothing could be worked out of a
frame that has a zero there. `//` rounds down, and what `%` leaves is never negative.
""",
        with_fields("""
            length: {type: uint8, range: [0, 32]}
            width: {type: uint8, range: [1, 4]}
            rows: {type: uint16, count: length // width}
        """),
        with_fields("""
            length: {type: uint8, range: [0, 32]}
            width: {type: uint8, const: 4}
            rows: {type: uint16, count: length // width}
        """),
    ),
    Code(
        "PG205",
        "settled-comparison",
        "A comparison that always or never holds",
        """\
Whatever the fields are, the comparison comes to the same, because what a field is compared with is
out of what its bits can hold. Something else was meant: another number, or another field.
""",
        with_fields("""
            kind: {type: uint8, bits: {size: 0..2, group: 3..7}}
            more: {type: uint8, when: kind.size == 8}
        """),
        with_fields("""
            kind: {type: uint8, bits: {size: 0..2, group: 3..7}}
            more: {type: uint8, when: kind.size == 7}
        """),
    ),
    Code(
        "PG206",
        "bad-when",
        "A `when` that does not fit",
        """\
A field with `when` is there in some payloads and not in others. Whoever sends it says which by
giving a value or none, so it has no `default`. Whether it is there is said where the field is, not
where a type is declared.
""",
        with_fields("""
            has_level: bool
            level: {type: uint16, when: has_level, default: 3}
        """),
        with_fields("""
            has_level: bool
            level: {type: uint16, when: has_level}
        """),
    ),
)
