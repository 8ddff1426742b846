"""Problems of frames that a silence of the line ends."""

from __future__ import annotations

from protogen.problems.catalogue.code import Code
from protogen.problems.catalogue.sketch import with_frame

_FRAME = """
    id: {type: uint8, id: true}
    payload: {}
    crc: {type: uint16, algorithm: CRC-16/MODBUS, covers: id..payload}
"""

SILENCE_CODES: tuple[Code, ...] = (
    Code(
        "PG253",
        "silence-of-unknown-characters",
        "A silence in characters on a line of unknown speed",
        """\
How long a character takes follows from the `baud` of the `link`, and from its data bits, parity and
stop bits: at 9600 baud and ten bits 3.5 characters are 3.65 ms. Without a `baud` nobody can tell.
State it, or write a time: `idle: 4 ms`.
""",
        with_frame(_FRAME + "    end: {idle: 3.5 characters}", more="max_frame: 64"),
        with_frame(
            _FRAME + "    end: {idle: 3.5 characters}",
            more="max_frame: 64\nlink: {baud: 9600}",
        ),
    ),
    Code(
        "PG254",
        "silence-among-bytes",
        "A silence that does not end its frame",
        """\
A part with `idle` is the silence behind the last byte of a frame. It is the last part, it is the
only end, so that no literal stands in front of it, and no transparency has to keep a delimiter out
of the frame.
""",
        with_frame(
            """
                id: {type: uint8, id: true}
                payload: {}
                end: {idle: 4 ms}
                crc: {type: uint16, algorithm: CRC-16/MODBUS, covers: id..payload}
            """,
            more="max_frame: 64",
        ),
        with_frame(_FRAME + "    end: {idle: 4 ms}", more="max_frame: 64"),
    ),
    Code(
        "PG255",
        "silence-without-bound",
        "A frame that only a silence ends, without a bound",
        """\
A receiver has to hold a frame until its end, and nothing in a frame that only a silence ends tells
how long it can be: a frame whose identity is unknown, or a line that is never silent. `max_frame`
is the number of bytes that no frame exceeds.
""",
        with_frame(_FRAME + "    end: {idle: 4 ms}"),
        with_frame(_FRAME + "    end: {idle: 4 ms}", more="max_frame: 64"),
    ),
)
