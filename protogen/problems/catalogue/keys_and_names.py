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
        "A name is a directive of extends",
        """\
A schema that extends this one could not tell the name from the directive: `rename: {old: new}`,
`remove: [name]`, `replace: true`, `after: name` and `before: name` say what differs. Add a word
that says more. Words of C, C++ and Python are names like others: where code can't have them, it
has `class_` for `class`, and the reference says so.
""",
        with_fields("after: uint16"),
        with_fields("after_start: uint16"),
    ),
    Code(
        "PG107",
        "name-taken",
        "A name is taken twice",
        """\
Messages and declared types share one set of names, because what is written inside a field is
called after its message or type and its field: `gyro_status`. A type can't be called like a
built-in one.
Nor is a declared type one type if its uses differ: in byte order, or because a switch in it ends
the payload in one place and not in another. Rename one, or declare a type for each use. Two names
that only come to the same in some language are no problem: one of them gets `_` behind it there.
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
