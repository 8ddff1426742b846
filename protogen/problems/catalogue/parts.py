"""Problems of parts of a frame that hold one of several things, or several at once."""

from __future__ import annotations

from protogen.problems.catalogue.code import Code
from protogen.problems.catalogue.sketch import with_frame

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
)
