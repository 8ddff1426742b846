"""Problems of messages: identities, overloads, examples and exchanges."""

from __future__ import annotations

from protogen.problems.catalogue.code import Code
from protogen.problems.catalogue.sketch import (
    with_framed,
    with_keys,
    with_message,
    with_messages,
)

MESSAGE_CODES: tuple[Code, ...] = (
    Code(
        "PG150",
        "duplicate-identity",
        "Two messages have the same identity",
        """\
A receiver tells the messages of one sender apart by their identity. Messages of different senders
may share one, because a receiver knows whom it listens to. If the document really uses one identity
for two messages, say under `overloads` how they are told apart, or that they can't be.
""",
        with_messages("""
            stop: {id: 1, from: host}
            start: {id: 1, from: host}
        """),
        with_messages("""
            stop: {id: 1, from: host}
            start: {id: 2, from: host}
        """),
    ),
    Code(
        "PG151",
        "incomplete-identity",
        "An identity does not name the frame's identity parts",
        """\
A message has a value for each identity part of its frame, and for no other part; so has an identity
that is `reserved`. With one identity part a number or character is enough: `id: 7`. With several it
is a mapping: `id: {class_id: 2, subclass: 7}`. Where the frame has no identity part, `id` is left
out. If several endpoints send a message, their frames have the same identity parts in the same
order.
""",
        with_framed(
            """
                class_id: {type: uint8, id: true}
                subclass: {type: uint8, id: true}
                payload: {}
                end: {literal: 0xC0}
            """,
            "stop: {id: {class_id: 2}, from: host}",
            more="transparency: slip",
        ),
        with_framed(
            """
                class_id: {type: uint8, id: true}
                subclass: {type: uint8, id: true}
                payload: {}
                end: {literal: 0xC0}
            """,
            "stop: {id: {class_id: 2, subclass: 7}, from: host}",
            more="transparency: slip",
        ),
    ),
    Code(
        "PG152",
        "bad-identity",
        "An identity that its part can't hold",
        """\
The value is out of the type or the `range` of the identity part, so no frame could carry it.
Correct the value, or the part.
""",
        with_messages("stop: {id: 0x100, from: host}"),
        with_messages("stop: {id: 0x10, from: host}"),
    ),
    Code(
        "PG153",
        "same-sizes",
        "Sizes do not tell the messages apart",
        """\
The overload says that a receiver tells the messages apart `by: size`, but they can have the same
size. Bound their sizes, or state what is true: `by: undecidable`, and which of them a decoder
`yields`.
""",
        with_messages(
            """
                left: {id: 1, from: robot, fields: {range: uint16}}
                right: {id: 1, from: robot, fields: {range: uint16}}
            """,
            more="""
                overloads:
                  sonar: {messages: [left, right], by: size}
            """,
        ),
        with_messages(
            """
                left: {id: 1, from: robot, fields: {range: uint16}}
                right: {id: 1, from: robot, fields: {range: uint16}}
            """,
            more="""
                overloads:
                  sonar: {messages: [left, right], by: undecidable, yields: left}
            """,
        ),
    ),
    Code(
        "PG154",
        "unclear-overload",
        "An overload that is not clear",
        """\
An overload lists messages that share an identity, and says how a receiver tells them apart. Here it
names a message that does not exist, or messages that share no identity, or it is `undecidable` and
does not say which of its messages a decoder `yields`.
""",
        with_messages(
            """
                left: {id: 1, from: robot, fields: {range: uint16}}
                right: {id: 1, from: robot, fields: {range: uint16}}
            """,
            more="""
                overloads:
                  sonar: {messages: [left, right], by: undecidable}
            """,
        ),
        with_messages(
            """
                left: {id: 1, from: robot, fields: {range: uint16}}
                right: {id: 1, from: robot, fields: {range: uint16}}
            """,
            more="""
                overloads:
                  sonar: {messages: [left, right], by: undecidable, yields: left}
            """,
        ),
    ),
    Code(
        "PG155",
        "unbounded-payload",
        "An unspecified payload without bounds",
        """\
The payload of a message with `fields: unspecified` is raw bytes. A receiver must know how many
there can be: give `max_size`, unless the frame's length part bounds it. `min_size` and `max_size`
are for such messages only; other sizes follow from the fields.
""",
        with_message("fields: unspecified"),
        with_message("""
            fields: unspecified
            max_size: 32
        """),
    ),
    Code(
        "PG156",
        "reserved-again",
        "Something reserved came back",
        """\
Under `reserved` stands what was once in use: identities, field names, enum values. Devices in the
field may still send or expect it with its old meaning. Use another one.
""",
        with_messages(
            """
                stop: {id: 1, from: host}
                turn: {id: 2, from: host}
            """,
            more="""
                reserved:
                  identities: [{from: host, id: 2, doc: Was the self-test.}]
            """,
        ),
        with_messages(
            """
                stop: {id: 1, from: host}
                turn: {id: 3, from: host}
            """,
            more="""
                reserved:
                  identities: [{from: host, id: 2, doc: Was the self-test.}]
            """,
        ),
    ),
    Code(
        "PG157",
        "nothing-to-send",
        "No messages, or no frame to send them in",
        """\
A protocol has at least one message, and every endpoint that sends one has a frame. `frame` is
either one frame for everybody or one for each sender.
""",
        """\
protocol: demo
endpoints: {host: Host computer, robot: Robot}
frame:
  robot: {id: {type: uint8, id: true}, payload: {}, end: {literal: 0xC0}}
transparency: slip
messages:
  stop: {id: 1, from: host}
""",
        """\
protocol: demo
endpoints: {host: Host computer, robot: Robot}
frame: {id: {type: uint8, id: true}, payload: {}, end: {literal: 0xC0}}
transparency: slip
messages:
  stop: {id: 1, from: host}
""",
    ),
    Code(
        "PG160",
        "example-decodes-otherwise",
        "An example does not decode to its values",
        """\
The bytes of an example are decoded by the Python that is generated, and give other values, another
message, or no message at all. Either the schema is wrong, or the example was copied with a mistake.
If the document contradicts itself, say so: `contradicts: {fails: ..., why: ...}`.
""",
        with_message("""
            fields: {angle: uint16}
            examples:
              quarter: {frame: {hex: 01 5A 00 C0}, values: {angle: 91}}
        """),
        with_message("""
            fields: {angle: uint16}
            examples:
              quarter: {frame: {hex: 01 5A 00 C0}, values: {angle: 90}}
        """),
    ),
    Code(
        "PG161",
        "example-encodes-otherwise",
        "An example does not encode to its bytes",
        """\
The bytes decode to the values, but the values encode to other bytes. A decoder can accept more than
an encoder makes: with a `lenient` transparency it takes lower case hex digits, or escapes that are
not needed. If the device really sends these bytes, describe it so; if not, correct the example. A
frame that is `longer: cut` may have bytes behind the fields, which the encoder leaves out.
""",
        with_framed(
            """
                begin: {literal: {text: b}}
                id: {type: uint8, id: true}
                payload: {}
                end: {literal: {text: e}}
            """,
            """
                gyro:
                  id: 1
                  from: robot
                  fields: {angle: uint16}
                  examples:
                    quarter: {frame: {text: b015a00e}, values: {angle: 90}}
            """,
            more="transparency: {encoding: base16-upper, lenient: true}",
        ),
        with_framed(
            """
                begin: {literal: {text: b}}
                id: {type: uint8, id: true}
                payload: {}
                end: {literal: {text: e}}
            """,
            """
                gyro:
                  id: 1
                  from: robot
                  fields: {angle: uint16}
                  examples:
                    quarter: {frame: {text: b015A00e}, values: {angle: 90}}
            """,
            more="transparency: {encoding: base16-upper, lenient: true}",
        ),
    ),
    Code(
        "PG162",
        "incomplete-example",
        "An example that does not say enough",
        """\
An example has its bytes as `frame` (all bytes on the wire) or as `content` (what the document
prints, with `covers`: the parts that it holds). Where a message has several senders, it says which
one sends. `parts` are those whose value the sender chooses.
""",
        with_message("""
            fields: {angle: uint16}
            examples:
              quarter: {content: {hex: 5A 00}, values: {angle: 90}}
        """),
        with_message("""
            fields: {angle: uint16}
            examples:
              quarter: {content: {hex: 5A 00}, covers: payload, values: {angle: 90}}
        """),
    ),
    Code(
        "PG163",
        "no-contradiction",
        "An example does not contradict the schema as it says",
        """\
An example with `contradicts` differs from the schema, in the way that `fails` names: the decoder's
reason, `values`, or `unknown`. This one holds, or fails in another way. So the note about it is not
true any more: remove it, or correct `fails`.
""",
        with_message("""
            fields: {angle: uint16}
            examples:
              quarter:
                frame: {hex: 01 5A 00 C0}
                values: {angle: 90}
                contradicts: {fails: size, why: The document prints one byte too many.}
        """),
        with_message("""
            fields: {angle: uint16}
            examples:
              quarter:
                frame: {hex: 01 5A 00 00 C0}
                values: {angle: 90}
                contradicts: {fails: size, why: The document prints one byte too many.}
        """),
    ),
    Code(
        "PG164",
        "unknown-step",
        "An exchange names nothing",
        """\
The steps of an exchange are messages of the schema, each with one of its examples if it is to be
shown with bytes; requests, replies and refusals are messages, too. This one names a message or an
example that does not exist.
""",
        with_keys("""
            exchanges:
              startup: {steps: [gyor]}
        """),
        with_keys("""
            exchanges:
              startup: {steps: [gyro]}
        """),
    ),
)
