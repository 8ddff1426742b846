"""Problems of finding frames in a stream: starts, ends and delimiters."""

from __future__ import annotations

from protogen.problems.catalogue.code import Code
from protogen.problems.catalogue.sketch import with_frame, with_framed

_DECISION = """\
decisions:
  end_in_data:
    question: What if the data holds the end byte?
    document: It does not say.
    choice: A receiver takes it for the end.
    because: The document gives no other end.
"""

FRAMING_CODES: tuple[Code, ...] = (
    Code(
        "PG142",
        "unprotected-literal",
        "A delimiter that can occur inside a frame",
        """\
The bytes that open or close the frame can also occur inside of it, so a receiver can cut a frame in
the wrong place. The message shows such a frame. A payload's bytes are known where fields are text
or have a `code`, and with `byte_bits: 7`; of other numbers, whatever their `range`, and of messages
that are not known, they may be any. Add the transparency that the document describes. If it has
none, that is how the protocol is: write a decision that says so, and name it with `unprotected`.
The reference then shows what it costs.
""",
        with_frame(
            """
                id: {type: uint8, id: true}
                payload: {}
                end: {literal: {text: "\\n"}}
            """,
        ),
        with_frame(
            """
                id: {type: uint8, id: true}
                payload: {}
                end: {literal: {text: "\\n"}, unprotected: end_in_data}
            """,
            more=_DECISION,
        ),
    ),
    Code(
        "PG143",
        "undecided-unprotected",
        "`unprotected` names no decision",
        """\
`unprotected` accepts a weakness of the protocol, and a reader must be able to look up why. The name
is not under `decisions`. Correct the spelling, or write the decision.
""",
        with_frame(
            """
                id: {type: uint8, id: true}
                payload: {}
                end: {literal: {text: "\\n"}, unprotected: end_in_dta}
            """,
            more=_DECISION,
        ),
        with_frame(
            """
                id: {type: uint8, id: true}
                payload: {}
                end: {literal: {text: "\\n"}, unprotected: end_in_data}
            """,
            more=_DECISION,
        ),
    ),
    Code(
        "PG144",
        "needless-unprotected",
        "`unprotected` where nothing can go wrong",
        """\
The literal can't occur inside a frame, so there is nothing to accept. Left there, the key would
hide it if a later change made the literal unsafe. Remove it.
""",
        with_frame(
            """
                id: {type: uint8, id: true}
                payload: {}
                end: {literal: 0xC0, unprotected: end_in_data}
            """,
            more="transparency: slip\n" + _DECISION,
        ),
        with_frame(
            """
                id: {type: uint8, id: true}
                payload: {}
                end: {literal: 0xC0}
            """,
            more="transparency: slip",
        ),
    ),
    Code(
        "PG145",
        "no-end",
        "A receiver can't tell where a frame ends",
        """\
The end of a frame is told by a length part, by an end literal, or by the identity, if that says
which message it is and the message has one size or counts itself what follows. Here nothing does.
Give the frame a length or an end, or the message a size.
""",
        with_framed(
            """
                start: {type: byte, id: true, range: [0x80, 0xFE]}
                payload: {}
            """,
            "text: {id: 0x80, from: robot, fields: unspecified, max_size: 32}",
            more="byte_bits: 7",
        ),
        with_framed(
            """
                start: {type: byte, id: true, range: [0x80, 0xFE]}
                payload: {}
                stop: {literal: 0xFF}
            """,
            "text: {id: 0x80, from: robot, fields: unspecified, max_size: 32}",
            more="byte_bits: 7",
        ),
    ),
    Code(
        "PG146",
        "no-start",
        "A receiver can't tell where a frame starts",
        """\
A receiver may be switched on in the middle of a frame, and bytes get lost. It needs something to
find the next frame by: a literal in front or behind, an identity in front with a `range` of its
own, or at least a checksum that tells a frame from other bytes. Where the document has none of
these, `unprotected:` on the first part names a decision that accepts position alone.
""",
        with_frame("""
            id: {type: uint8, id: true}
            length: {type: uint8, counts: payload}
            payload: {}
        """),
        with_frame("""
            id: {type: uint8, id: true}
            length: {type: uint8, counts: payload}
            payload: {}
            check: {type: uint16, algorithm: CRC-16/XMODEM, covers: id..payload}
        """),
    ),
    Code(
        "PG148",
        "payload-too-small",
        "A payload smaller than the length part allows",
        """\
The length part has a least value, and a message is shorter than that. It could not be sent, and a
receiver would refuse it. Correct the `range` of the length part (it counts all parts under
`counts`, not only the payload), or the message.
""",
        with_framed(
            """
                id: {type: uint8, id: true}
                length: {type: uint8, counts: payload, range: [2, 64]}
                payload: {}
                check: {type: uint8, algorithm: sum-8, covers: id..payload}
            """,
            "stop: {id: 1, from: host}",
        ),
        with_framed(
            """
                id: {type: uint8, id: true}
                length: {type: uint8, counts: payload, range: [0, 64]}
                payload: {}
                check: {type: uint8, algorithm: sum-8, covers: id..payload}
            """,
            "stop: {id: 1, from: host}",
        ),
    ),
    Code(
        "PG149",
        "no-end-of-stuffing",
        "A receiver can't tell where the stuffed parts end",
        """\
Parts that are not stuffed follow on the stuffed ones, and no length tells where the change is.
Bytes behind it would be unstuffed by mistake, or the other way round. Stuff these parts as well, or
give the frame a length. The same holds for stuffed parts behind a payload of no fixed size.
""",
        with_frame(
            """
                id: {type: uint8, id: true}
                payload: {}
                version: {type: uint8, range: [1, 9]}
                end: {literal: 0xC0}
            """,
            more="transparency: {preset: slip, covers: id..payload}",
        ),
        with_frame(
            """
                id: {type: uint8, id: true}
                payload: {}
                version: {type: uint8, range: [1, 9]}
                end: {literal: 0xC0}
            """,
            more="transparency: {preset: slip, covers: id..version}",
        ),
    ),
)
