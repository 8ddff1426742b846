"""Problems of what bounds a frame and what fills its payload."""

from __future__ import annotations

from protogen.problems.catalogue.code import Code
from protogen.problems.catalogue.sketch import with_fields, with_keys

FRAME_SIZE_CODES: tuple[Code, ...] = (
    Code(
        "PG180",
        "fill-without-choice",
        "A fill that leaves no choice",
        """\
What fills a payload is as many elements as there are, from `min` to `max`. Here `min` is as great
as the greatest number, so that there are always as many, or greater, so that there can be none. The
greatest number is `max`, or else what the frame has room for. Correct the bounds, or write the
number itself: `count: 4`.
""",
        with_fields("text: {type: ascii, size: {fill: true, min: 8, max: 4}}"),
        with_fields("text: {type: ascii, size: {fill: true, min: 4, max: 8}}"),
    ),
    Code(
        "PG181",
        "no-room-for-a-frame",
        "A greatest frame without room for any",
        """\
`max_frame` is the number of bytes on the wire that no frame exceeds, delimiters and checksums
included. Here the parts around the payload alone have more, or do with the least payload that the
length part can state. Raise it to what the document says.
""",
        with_keys("max_frame: 1"),
        with_keys("max_frame: 64"),
    ),
    Code(
        "PG182",
        "message-over-max-frame",
        "A message that no frame has room for",
        """\
The message can have a payload that makes a frame longer than `max_frame`, whatever its bytes are: a
fixed size, a counting field with a `range`, a `max`. Or its constants are stuffed, and all of its
frames are longer. Raise `max_frame`, or bound the message. A message some of whose values are too
long only because of how they are stuffed is fine: an encoder refuses those values.
""",
        with_keys("max_frame: 3"),
        with_keys("max_frame: 4"),
    ),
)
