"""Problems of integers that are written as text."""

from __future__ import annotations

from protogen.problems.catalogue.code import Code
from protogen.problems.catalogue.sketch import with_fields, with_message

TEXT_NUMBER_CODES: tuple[Code, ...] = (
    Code(
        "PG224",
        "no-digits-here",
        "Digits of what has none",
        """\
`digits` (base10, base16-upper, base16-lower) and `code` (some bits in each character) say how an
integer such as `uint16`, a field or a part of a frame, is written as text; `chars` says in how many
characters. An integer has one of `digits` and `code`. Characters, booleans, floats and texts have
no digits, and neither have packed integers and bytes of 7 bits. The types `decimal` and
`hexadecimal` are written in as many digits as the number needs: their `digits` are a number, only a
decimal has a `fraction`, only a hexadecimal one a `case`, and neither a `const`.
""",
        with_fields("level: {type: uint8, chars: 3}"),
        with_fields("level: {type: uint8, digits: base10, chars: 3}"),
    ),
    Code(
        "PG225",
        "digits-do-not-fit",
        "Digits that can't stand for a number",
        """\
Digits stand for numbers of 64 bits at most, the characters of a `code` are bytes, and there is no
place for a minus: a signed integer is written in two's complement, as many hexadecimal digits as
its bits need at least. A signed decimal number is `decimal`, of 18 digits at most, those behind the
point among them; a `hexadecimal` has 16 at most. A checksum has so many digits that they can stand
for each of its values.
""",
        with_fields("level: {type: sint8, digits: base10, chars: 3}"),
        with_fields("level: {type: sint8, digits: base16-upper}"),
    ),
    Code(
        "PG226",
        "not-separable",
        "A field that no separator can stand beside",
        """\
Fields with a `separator` are text that ends where the next separator begins. So each is a number
that is written as text (`decimal`, `hexadecimal`) or a character whose values are known (`char`
with `values` and `closed: true`), a text (`ascii`), or a struct or an array of these. Where no
separator stands in front of the first field, that is a single number, character or text: else its
type would be another there than elsewhere. `separator: {byte: ",", in_front: true}` puts one there
too.
""",
        with_message('separator: ","\nfields: {count: decimal, angle: uint16}'),
        with_message(
            'separator: ","\nfields: {count: {type: decimal, range: [0, 9]}, angle: decimal}'
        ),
    ),
    Code(
        "PG227",
        "separator-inside",
        "A separator that a field can hold",
        """\
The byte that stands between fields ends each of them, so it can be no part of one: neither a digit,
sign or point of a number, nor a value of a character.
""",
        with_message('separator: "-"\nfields: {count: decimal, angle: decimal}'),
        with_message('separator: ";"\nfields: {count: decimal, angle: decimal}'),
    ),
    Code(
        "PG228",
        "nothing-to-leave-out",
        "A field that can't be empty",
        """\
`empty` names the value of a number or character that stands between separators where its text is
left out. That value is none that digits can have, so it has neither bits nor another name, and no
`closed` list of numbers holds it; of a character it is 0.
""",
        with_fields("count: {type: decimal, empty: absent}"),
        with_message('separator: ","\nfields: {count: {type: decimal, empty: absent}}'),
    ),
)
