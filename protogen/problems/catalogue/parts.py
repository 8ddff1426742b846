"""Problems of parts of a frame that hold one of several things, or several at once."""

from __future__ import annotations

from protogen.problems.catalogue.code import Code
from protogen.problems.catalogue.sketch import with_frame, with_framed, with_messages

PART_CODES: tuple[Code, ...] = (
    Code(
        "PG190",
        "literal-choice",
        "Literals that nobody can choose from",
        """\
`literal: {any_of: [...]}` lists the literals of which a frame has one. A receiver tells them apart,
and reads what stands behind them, because there are two or more, they differ, and all have the same
number of bytes. The `default`, which encoders write, is one of them.
""",
        with_frame(
            """
                start: {literal: {any_of: [0xC0, 0xC1], default: 0xC2}}
                id: {type: uint8, id: true}
                payload: {}
            """,
            more="transparency: {escape: {byte: 0xDB, of: [0xC0, 0xC1, 0xDB], transform: invert}}",
        ),
        with_frame(
            """
                start: {literal: {any_of: [0xC0, 0xC1], default: 0xC1}}
                id: {type: uint8, id: true}
                payload: {}
            """,
            more="transparency: {escape: {byte: 0xDB, of: [0xC0, 0xC1, 0xDB], transform: invert}}",
        ),
    ),
    Code(
        "PG191",
        "identity-overlap",
        "An identity that two messages have, or one message twice",
        """\
A message may have several identities: `id: [4, 5]`, `id: {range: [0x81, 0xFF]}`, or both in a list.
A receiver tells messages apart by them, so none of them belongs to two messages of one sender;
which of two ranges is the smaller one does not matter. Leave it out of one of them: a range can be
written as two. Messages that share all of their identities may be told apart by size, under
`overloads`.
""",
        with_messages("""
            answer: {id: {range: [0, 0x7F]}, from: robot}
            alarm: {id: 0x10, from: robot}
        """),
        with_messages("""
            answer: {id: [{range: [0, 0x0F]}, {range: [0x11, 0x7F]}], from: robot}
            alarm: {id: 0x10, from: robot}
        """),
    ),
    Code(
        "PG192",
        "text-part",
        "A text in the frame that has no such characters",
        """\
`type: ascii` makes a part of the frame a text of `size` characters, 1 to 8, such as a talker and a
sentence. Each is one byte, in the order in which they are written. A value of such a part, as `id`
and `default` give it, has exactly that many characters: blanks and other fillers are part of it.
People see it as text; a text has no `byte_order` and does not count, and its `range` is that of
each character.
""",
        with_framed(
            """
                name: {type: ascii, size: 3, id: true}
                payload: {}
                end: {literal: 0xC0}
            """,
            "status: {id: ST, from: robot}",
            more="transparency: slip",
        ),
        with_framed(
            """
                name: {type: ascii, size: 3, id: true}
                payload: {}
                end: {literal: 0xC0}
            """,
            'status: {id: "ST ", from: robot}',
            more="transparency: slip",
        ),
    ),
    Code(
        "PG193",
        "wide-identity",
        "An identity that is too wide",
        """\
The parts with `id` tell messages apart. Decoders compare them as one number, which has at most 64
bits. Let those parts be the identity that are needed to tell messages apart; the others are values,
which events show and callers give.
""",
        with_framed(
            """
                name: {type: ascii, size: 8, id: true}
                kind: {type: uint8, id: true}
                payload: {}
                end: {literal: 0xC0}
            """,
            "status: {id: {name: THRUSTER, kind: 1}, from: robot}",
            more="transparency: slip",
        ),
        with_framed(
            """
                name: {type: ascii, size: 8, id: true}
                kind: {type: uint8}
                payload: {}
                end: {literal: 0xC0}
            """,
            "status: {id: THRUSTER, from: robot}",
            more="transparency: slip",
        ),
    ),
)
