"""Problems of texts in a code, or with another padding than NUL."""

from __future__ import annotations

from protogen.problems.catalogue.code import Code
from protogen.problems.catalogue.sketch import with_fields

TEXT_FORM_CODES: tuple[Code, ...] = (
    Code(
        "PG294",
        "no-form-of-a-text",
        "A padding or a code of what has none",
        """\
`padding` is the character that fills up an `ascii` field of a fixed size, and `code` says what the
byte of each of its characters is. A text whose size something in the payload says has no padding,
and its bytes are the text. Where payload bytes have 7 bits, a character is its byte, too. `shift`
is for texts: an integer in characters of a `code` has its bits from the lowest one on.
""",
        with_fields('count: uint8\nname: {type: ascii, size: count, padding: " "}'),
        with_fields('name: {type: ascii, size: 6, padding: " "}'),
    ),
    Code(
        "PG295",
        "unfit-form-of-a-text",
        "A code that no byte can hold, or a padding that is no character",
        """\
A character of `ascii` has 7 bits. Shifted left by `shift` bits and with `add` added it has to be a
byte: with `shift: 1`, `add` is 0 or 1, and without a shift at most 0x80. The padding is such a
character, as it is before that.
""",
        with_fields("name: {type: ascii, size: 6, code: {bits: 7, shift: 2}}"),
        with_fields("name: {type: ascii, size: 6, code: {bits: 7, shift: 1}}"),
    ),
)
