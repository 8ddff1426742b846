"""Problems of keys, values and names: what can be written where."""

from __future__ import annotations

from protogen.problems.catalogue.code import Code
from protogen.problems.catalogue.sketch import with_fields, with_messages

_TWO_STOPS = """\
halt: {id: 1, from: host}
pause: {id: 1, from: host}
"""

_DECISION = """\
decisions:
  one_stop:
    question: How are halt and pause told apart?
    document: Both are sent with the identity 1.
    choice: A receiver takes either for halt.
    because: To stop is the safe reading.
"""

_OVERLOADS = """\
overloads:
  stop: {messages: [halt, pause], by: undecidable, yields: halt, decision: DECISION}
"""

KEY_AND_NAME_CODES: tuple[Code, ...] = (
    Code(
        "PG100",
        "unknown-key",
        "A key that has no meaning here",
        """\
protogen knows all keys that may stand in a place, and this is none of them. It is not skipped:
a key that is spelled wrong would otherwise silently change what is on the wire. Correct the
spelling, or move the key to where it belongs.
""",
        with_fields("angle: {type: sint16, scael: 1/16, unit: deg}"),
        with_fields("angle: {type: sint16, scale: 1/16, unit: deg}"),
    ),
    Code(
        "PG101",
        "missing-key",
        "A key is missing",
        """\
Some keys have to be there: a schema has a `protocol`, `endpoints`, a `frame` and `messages`, a
message says who sends it (`from`), a decision says why. Add the key.
""",
        with_messages("gyro: {id: 1, fields: {angle: uint16}}"),
        with_messages("gyro: {id: 1, from: robot, fields: {angle: uint16}}"),
    ),
    Code(
        "PG102",
        "wrong-kind",
        "A value of the wrong kind",
        """\
The key exists, but it takes another kind of value: a number where a text stands, a mapping where
a list stands, one word out of a few. The message says what is expected. Often it is a matter of
quotes: `"0x10"` is a text, `0x10` is a number.
""",
        with_fields("""
            angle: uint16
            status: {type: uint8, values: {ready: "0x10"}}
        """),
        with_fields("""
            angle: uint16
            status: {type: uint8, values: {ready: 0x10}}
        """),
    ),
    Code(
        "PG103",
        "bad-name",
        "A name is not in lower snake case",
        """\
Names are lower case letters and digits, with single underscores between words, and start with a
letter: `left_motor`. Each target makes its own spelling from that (`LeftMotor`, `LEFT_MOTOR`), so
there must be one form to start from. The name in the document can stand under `title`.
""",
        with_messages("GyroData: {id: 1, from: robot, fields: {angle: uint16}}"),
        with_messages("gyro_data: {id: 1, from: robot, title: GyroData, fields: {angle: uint16}}"),
    ),
    Code(
        "PG106",
        "reserved-word",
        "A name is a reserved word",
        """\
The name is taken in C, C++, Python or JavaScript, or by the code that protogen generates (a message
`result` of `rn1` would be the struct `rn1_result`, beside the enum of that name), or it is a
directive of `extends`. No target changes a name, so that a field has one name in every language and
in the document. Add a word that says more: `class` becomes `class_id`. Names of an enum's values
stand behind that of their enum, so that they may be words of a language, unless a case of a union
is called after them. Files have the protocol's name: its `string.h` would hide that of C.
""",
        with_fields("default: uint16"),
        with_fields("default_speed: uint16"),
    ),
    Code(
        "PG107",
        "name-taken",
        "A name is taken twice",
        """\
Messages and types share one set of names, because generated code has one class for each of them:
`gyro_1` and `gyro1` would both be `Gyro1`. What is written inside a field is called after its
message and field: `gyro_status`. A type can't be called like a built-in one. Nor is a declared type
one type if its uses differ: in byte order, or because a switch in it ends the payload in one place
and not in another. In C, joined names can come to the same: a message `board` and an endpoint
`board` both have `RN1_BOARD_FRAME_MAX`. Rename one, or declare a type for each use.
""",
        with_messages(
            "gyro: {id: 1, from: robot, fields: {state: {type: gyro}}}",
            more="""
                types:
                  gyro: {type: uint8, values: {starting: 0, ready: 1}}
            """,
        ),
        with_messages(
            "gyro: {id: 1, from: robot, fields: {state: {type: gyro_state}}}",
            more="""
                types:
                  gyro_state: {type: uint8, values: {starting: 0, ready: 1}}
            """,
        ),
    ),
    Code(
        "PG108",
        "unknown-endpoint",
        "There is no such endpoint",
        """\
A message comes from an endpoint, one of the sides of the link that are listed under `endpoints`.
Without a known sender, nobody can say which frame the message travels in. Correct the spelling, or
add the endpoint.
""",
        with_messages("gyro: {id: 1, from: robto, fields: {angle: uint16}}"),
        with_messages("gyro: {id: 1, from: robot, fields: {angle: uint16}}"),
    ),
    Code(
        "PG165",
        "unknown-decision",
        "There is no such decision",
        """\
An overload can name the decision that accepts it. That name is not under `decisions`, so a reader
would look for the reason in vain. Correct the spelling, or write the decision.
""",
        with_messages(_TWO_STOPS, more=_OVERLOADS.replace("DECISION", "one_stp") + _DECISION),
        with_messages(_TWO_STOPS, more=_OVERLOADS.replace("DECISION", "one_stop") + _DECISION),
    ),
)
