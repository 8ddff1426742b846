"""Problems of payloads longer than their message, which receivers cut."""

from __future__ import annotations

from protogen.problems.catalogue.code import Code
from protogen.problems.catalogue.sketch import with_payload

_CUT = "longer: cut"
_GYRO = "gyro: {id: 1, from: robot, fields: {angle: uint16}}\n"
_OTHER = "other: {id: 1, from: robot, fields: {angle: uint32}}\n"
_TEXT = "text: {id: 2, from: robot, fields: {text: {type: ascii, size: fill}}}\n"

CUTTING_CODES: tuple[Code, ...] = (
    Code(
        "PG280",
        "longer-without-length",
        "Payloads may be longer, and nothing says how long",
        """\
With `longer: cut`, a receiver takes the bytes of a payload that it knows and leaves what a newer
sender has behind them. It has to know how many there are to find the end of the frame, and no
identity tells that. So the frame has a length part that counts the payload.
""",
        with_payload(_CUT, _GYRO, length=False),
        with_payload(_CUT, _GYRO),
    ),
    Code(
        "PG281",
        "longer-than-nothing",
        "No payload that could be longer than its message",
        """\
With `longer: cut`, a payload may have more bytes than its message, where that always has the same
size, or its fields say where they end. A message with a field that fills the payload takes all of
it: there is nothing to cut. Nor is there where the length part, or `max_frame`, allows no more
bytes than the messages have.
""",
        with_payload(_CUT, _TEXT),
        with_payload(_CUT, _TEXT + _GYRO),
    ),
    Code(
        "PG282",
        "longer-overload",
        "Messages told apart by a size that newer senders exceed",
        """\
An overload `by: size` tells messages of one identity apart by how long their payloads are. With
`longer: cut` a longer one may be any of them. Give each message an identity of its own.
""",
        with_payload(
            _CUT,
            _GYRO + _OTHER,
            more="overloads: {both: {messages: [gyro, other], by: size}}",
        ),
        with_payload(_CUT, _GYRO + _OTHER.replace("id: 1", "id: 2")),
    ),
)
