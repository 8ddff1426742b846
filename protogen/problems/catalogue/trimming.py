"""Problems of payloads whose zeros at the end are left out."""

from __future__ import annotations

from protogen.problems.catalogue.code import Code
from protogen.problems.catalogue.sketch import with_payload

_TRIMMED = "trailing_zeros: trimmed"
_GYRO = "gyro: {id: 1, from: robot, fields: {angle: uint16}}\n"
_OTHER = "other: {id: 1, from: robot, fields: {angle: uint32}}\n"

TRIMMING_CODES: tuple[Code, ...] = (
    Code(
        "PG235",
        "trimmed-without-length",
        "Zeros left out, and nothing that says how many",
        """\
With `trailing_zeros: trimmed`, a payload has fewer bytes on the wire than its message. A receiver
has to know how many, and no identity tells that; an end literal alone would not tell a zero that
was left out from one that was lost. So the frame has a length part that counts the payload.
""",
        with_payload(_TRIMMED, _GYRO, length=False),
        with_payload(_TRIMMED, _GYRO),
    ),
    Code(
        "PG236",
        "trimmed-of-no-size",
        "Zeros left out of a payload whose size varies",
        """\
A receiver fills a payload up with zeros to the size of its message. Where a count, a terminator, a
condition or `fill` lets that size vary, it could not tell which one is meant. Give the message a
fixed size (fields that are seldom used cost nothing at its end, where they are zero), or a form of
frame that leaves nothing out.
""",
        with_payload(
            _TRIMMED,
            "text: {id: 1, from: robot, fields: {text: {type: ascii, size: fill}}}\n",
        ),
        with_payload(
            _TRIMMED,
            "text: {id: 1, from: robot, fields: {text: {type: ascii, size: 50}}}\n",
        ),
    ),
    Code(
        "PG237",
        "trimmed-overload",
        "Messages told apart by a size that zeros change",
        """\
An overload `by: size` tells messages of one identity apart by how long their payloads are. With
`trailing_zeros: trimmed` that depends on the values, so it tells nothing. Give each message an
identity of its own.
""",
        with_payload(
            _TRIMMED,
            _GYRO + _OTHER,
            more="overloads: {both: {messages: [gyro, other], by: size}}",
        ),
        with_payload(_TRIMMED, _GYRO + _OTHER.replace("id: 1", "id: 2")),
    ),
)
