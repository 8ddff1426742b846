"""Problems of integers that are written as text."""

from __future__ import annotations

from protogen.problems.catalogue.code import Code
from protogen.problems.catalogue.sketch import with_fields

TEXT_NUMBER_CODES: tuple[Code, ...] = (
    Code(
        "PG224",
        "no-digits-here",
        "Digits of what has none",
        """\
`digits` (base10, base16-upper, base16-lower) and `code` (some bits in each character) say how an
integer such as `uint16` is written as text; `chars` says in how many characters. An integer has
one of `digits` and `code`. Characters, booleans, floats and texts have no digits, and neither have
packed integers and bytes of 7 bits. The types `decimal` and `hexadecimal` are written in as many
digits as the number needs: their `digits` are a number, only a decimal has a `fraction`, only a
hexadecimal one a `case`, and neither a `const`.
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
point among them; a `hexadecimal` has 16 at most.
""",
        with_fields("level: {type: sint8, digits: base10, chars: 3}"),
        with_fields("level: {type: sint8, digits: base16-upper}"),
    ),
)
