"""Problems of a frame's parts, its length, checksum and transparency."""

from __future__ import annotations

from protogen.problems.catalogue.code import Code
from protogen.problems.catalogue.sketch import with_frame, with_framed
from protogen.problems.severity import Severity

FRAME_CODES: tuple[Code, ...] = (
    Code(
        "PG130",
        "no-payload",
        "A frame without a payload",
        """\
Every frame has one part called `payload`: the place of the message's fields, written `payload: {}`.
It stands there also where most messages have no fields, because its place is part of the wire
format.
""",
        with_frame(
            """
                id: {type: uint8, id: true}
                data: {type: uint16}
                end: {literal: 0xC0}
            """,
            more="transparency: slip",
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
        "PG131",
        "part-without-role",
        "A part without a clear role",
        """\
The keys of a part say what it does: `literal` (fixed bytes), `id: true` (identity), `counts`
(length), `counter: true`, `algorithm` with `covers` (checksum), or a `type` alone (a number that
the caller gives). This part has none of them, or a key that does not go together with its role, or
it lacks one: each part but literals and the payload needs a `type`, a checksum `covers`. Only a
checksum behind the payload can be there `when: payload`, and only one of bytes that COBS did not
make is `over: wire`.
""",
        with_frame(
            """
                id: {type: uint8, id: true}
                payload: {}
                check: {type: uint8, algorithm: sum-8}
                end: {literal: 0xC0}
            """,
            more="transparency: slip",
        ),
        with_frame(
            """
                id: {type: uint8, id: true}
                payload: {}
                check: {type: uint8, algorithm: sum-8, covers: id..payload}
                end: {literal: 0xC0}
            """,
            more="transparency: slip",
        ),
    ),
    Code(
        "PG132",
        "unknown-part",
        "The frame has no such part",
        """\
`counts` and `covers` name parts of the same frame: one, a list, or a run `first..last` in wire
order. A length or checksum over other parts than the device uses fails on every frame.
""",
        with_frame(
            """
                id: {type: uint8, id: true}
                payload: {}
                check: {type: uint8, algorithm: sum-8, covers: identity..payload}
                end: {literal: 0xC0}
            """,
            more="transparency: slip",
        ),
        with_frame(
            """
                id: {type: uint8, id: true}
                payload: {}
                check: {type: uint8, algorithm: sum-8, covers: id..payload}
                end: {literal: 0xC0}
            """,
            more="transparency: slip",
        ),
    ),
    Code(
        "PG133",
        "useless-length",
        "A length that a receiver can't use",
        """\
A length tells a receiver how many bytes to wait for. So it counts the payload; it may count other
parts as well, itself included. The first of a frame stands in front of the payload. A number that
has another purpose is a part with a `type` alone.
""",
        with_frame("""
            id: {type: uint8, id: true}
            length: {type: uint8, counts: id}
            payload: {}
            check: {type: uint8, algorithm: sum-8, covers: id..payload}
        """),
        with_frame("""
            id: {type: uint8, id: true}
            length: {type: uint8, counts: [id, payload]}
            payload: {}
            check: {type: uint8, algorithm: sum-8, covers: id..payload}
        """),
    ),
    Code(
        "PG134",
        "unknown-algorithm",
        "There is no such checksum algorithm",
        """\
Algorithms are `xor-8`, `sum-8`, `sum-8/negated`, `fletcher-16` (modulo 255),
`fletcher-16/256` and the CRCs of the CRC RevEng catalogue by name, such as `CRC-16/MODBUS`.
"CRC-16" alone says too little: some thirty algorithms are called so. One that is not in the
catalogue is given by its parameters:
`{width: 16, poly: 0x1021, init: 0xFFFF, refin: false, refout: false, xorout: 0}`.
""",
        with_frame(
            """
                id: {type: uint8, id: true}
                payload: {}
                check: {type: uint16, algorithm: CRC-16/MODBSU, covers: id..payload}
                end: {literal: 0xC0}
            """,
            more="transparency: slip",
        ),
        with_frame(
            """
                id: {type: uint8, id: true}
                payload: {}
                check: {type: uint16, algorithm: CRC-16/MODBUS, covers: id..payload}
                end: {literal: 0xC0}
            """,
            more="transparency: slip",
        ),
    ),
    Code(
        "PG126",
        "checksum-of-many",
        "A checksum's name that several have",
        """\
The catalogue of CRCs lists many of each width, and short names such as `CRC-16` are used for more
than one of them. The short name is taken for the one that the catalogue gives it to, which may not
be the device's. Write the whole name.
""",
        with_frame(
            """
                id: {type: uint8, id: true}
                payload: {}
                crc: {type: uint16, algorithm: CRC-16, covers: id..payload}
                end: {literal: 0xC0}
            """,
            more="transparency: slip",
        ),
        with_frame(
            """
                id: {type: uint8, id: true}
                payload: {}
                crc: {type: uint16, algorithm: CRC-16/ARC, covers: id..payload}
                end: {literal: 0xC0}
            """,
            more="transparency: slip",
        ),
        severity=Severity.WARNING,
    ),
    Code(
        "PG135",
        "checksum-width",
        "A checksum and its part differ in width",
        """\
The part has more or fewer bits than the algorithm yields, or a parameter has more bits than the
register. Which bits would be sent is not clear. Give the part the type of the checksum's width.
Bits of a part that are only some bits of a checksum say which, with `takes: 0..3`.
""",
        with_frame(
            """
                id: {type: uint8, id: true}
                payload: {}
                check: {type: uint8, algorithm: CRC-16/KERMIT, covers: id..payload}
                end: {literal: 0xC0}
            """,
            more="transparency: slip",
        ),
        with_frame(
            """
                id: {type: uint8, id: true}
                payload: {}
                check: {type: uint16, algorithm: CRC-16/KERMIT, covers: id..payload}
                end: {literal: 0xC0}
            """,
            more="transparency: slip",
        ),
    ),
    Code(
        "PG136",
        "checksum-covers-itself",
        "A checksum covers itself",
        """\
The checksum would have to be known before it can be computed. End the run in front of it. If the
document says that the sum over *all* bytes is zero, the checksum is a negated one
(`sum-8/negated`) over the others.
""",
        with_frame(
            """
                id: {type: uint8, id: true}
                payload: {}
                check: {type: uint8, algorithm: sum-8, covers: id..check}
                end: {literal: 0xC0}
            """,
            more="transparency: slip",
        ),
        with_frame(
            """
                id: {type: uint8, id: true}
                payload: {}
                check: {type: uint8, algorithm: sum-8/negated, covers: id..payload}
                end: {literal: 0xC0}
            """,
            more="transparency: slip",
        ),
    ),
    Code(
        "PG137",
        "length-too-narrow",
        "The length part is too narrow",
        """\
A size that the schema states is greater than the length part can say, so such a message could not
be sent: a fixed size, a counting field with a `range`, a `max`. (What no `range` or `max` bounds is
bounded by the length part.) Or the length part can't even say how many bytes it counts besides the
payload. Make the length part wider, or its `range`, or bound the message to what it can say.
""",
        with_framed(
            """
                id: {type: uint8, id: true}
                length: {type: uint8, counts: payload}
                payload: {}
                check: {type: uint8, algorithm: sum-8, covers: id..payload}
            """,
            "lidar: {id: 1, from: robot, fields: {distances: {type: uint16, count: 360}}}",
        ),
        with_framed(
            """
                id: {type: uint8, id: true}
                length: {type: uint16, counts: payload}
                payload: {}
                check: {type: uint8, algorithm: sum-8, covers: id..payload}
            """,
            "lidar: {id: 1, from: robot, fields: {distances: {type: uint16, count: 360}}}",
        ),
    ),
    Code(
        "PG138",
        "unclear-transparency",
        "A transparency that is not clear",
        """\
A transparency is exactly one of `substitute` (a table), `escape`, `encoding` or `preset`, and
covers one unbroken run of parts. Without `covers` these are all parts between the literals that
open and close the frame. A table says once what becomes of a byte: `b` and `0x62` are the same.
""",
        with_frame(
            """
                id: {type: uint8, id: true}
                number: {type: uint8}
                payload: {}
                end: {literal: 0xC0}
            """,
            more="transparency: {preset: slip, covers: [id, payload]}",
        ),
        with_frame(
            """
                id: {type: uint8, id: true}
                number: {type: uint8}
                payload: {}
                end: {literal: 0xC0}
            """,
            more="transparency: {preset: slip, covers: id..payload}",
        ),
    ),
    Code(
        "PG139",
        "unescaped-escape",
        "The escape byte is not escaped",
        """\
Where the escape byte occurs in the data and is sent as it is, a receiver takes it for an escape and
changes the byte behind it. So the escape byte is one of the bytes that are escaped: add it to `of`.
""",
        with_frame(
            """
                sync: {literal: 0x55}
                id: {type: uint8, id: true}
                length: {type: uint8, counts: payload}
                payload: {}
            """,
            more="transparency: {escape: {byte: 0x56, of: [0x55], transform: invert}}",
        ),
        with_frame(
            """
                sync: {literal: 0x55}
                id: {type: uint8, id: true}
                length: {type: uint8, counts: payload}
                payload: {}
            """,
            more="transparency: {escape: {byte: 0x56, of: [0x55, 0x56], transform: invert}}",
        ),
    ),
    Code(
        "PG140",
        "ambiguous-stuffing",
        "Stuffing that can't be undone",
        """\
Two different inputs give the same bytes on the wire, so no receiver can know which one was meant.
The message shows two such inputs. Most often the byte that begins a sequence has no entry of its
own: it must be replaced as well wherever it occurs in the data.
""",
        with_frame(
            """
                id: {type: uint8, id: true}
                payload: {}
                end: {literal: 0x7E}
            """,
            more="transparency: {substitute: {0x7E: [0x7D, 0x01]}}",
        ),
        with_frame(
            """
                id: {type: uint8, id: true}
                payload: {}
                end: {literal: 0x7E}
            """,
            more="transparency: {substitute: {0x7E: [0x7D, 0x01], 0x7D: [0x7D, 0x02]}}",
        ),
    ),
    Code(
        "PG141",
        "late-stuffing",
        "Stuffing that can't be decoded at once",
        """\
Each output belongs to one input only, but a receiver must read on to know which. At the last byte
of a frame there is nothing to read on to. Choose sequences of which none begins another one.
""",
        with_frame(
            """
                id: {type: uint8, id: true}
                payload: {}
                end: {literal: 0x7E}
            """,
            more="""
                transparency:
                  substitute: {0x7E: [0x7D, 0x00], 0x00: [0x7C, 0x00], 0x7C: [0x7C, 0x7C]}
            """,
        ),
        with_frame(
            """
                id: {type: uint8, id: true}
                payload: {}
                end: {literal: 0x7E}
            """,
            more="""
                transparency:
                  substitute: {0x7E: [0x7D, 0x00], 0x7D: [0x7D, 0x7D]}
            """,
        ),
    ),
    Code(
        "PG147",
        "empty-literal",
        "A literal without bytes",
        """\
A literal is bytes that stand in every frame. One of no bytes marks nothing and would be found
everywhere. Write the bytes, or leave the part out.
""",
        with_frame(
            """
                start: {literal: {hex: ""}}
                id: {type: uint8, id: true}
                payload: {}
                end: {literal: 0xC0}
            """,
            more="transparency: slip",
        ),
        with_frame(
            """
                start: {literal: {hex: C0}}
                id: {type: uint8, id: true}
                payload: {}
                end: {literal: 0xC0}
            """,
            more="transparency: slip",
        ),
    ),
)
