"""Problems of fields that are parts of the frame."""

from __future__ import annotations

from protogen.problems.catalogue.code import Code
from protogen.problems.catalogue.sketch import with_framed

_PARTS = """
    id: {type: uint8, id: true}
    flags: {type: uint8}
    payload: {}
    end: {literal: 0xC0}
"""


def _framed(fields: str, parts: str = _PARTS, more: str = "transparency: slip") -> str:
    """A schema of one message with these fields."""
    return with_framed(parts, f"status: {{id: 1, from: robot, fields: {{{fields}}}}}", more=more)


_BEHIND = """
    sync: {literal: 0xA5}
    id: {type: uint8, id: true}
    payload: {}
    flags: {type: uint8}
    sum: {type: uint8, algorithm: sum-8, covers: id..flags}
"""
_IN_FRONT = """
    sync: {literal: 0xA5}
    id: {type: uint8, id: true}
    flags: {type: uint8}
    payload: {}
    sum: {type: uint8, algorithm: sum-8, covers: id..payload}
"""
_FLAGS = "flags: {part: flags, type: uint8, flags: {hot: 0}}, heat: {type: uint16, when: flags.hot}"
_ACCEPTED = """
decisions:
  starts: {question: Starts inside?, document: Nothing., choice: Accept., because: Sums tell.}
"""

PART_FIELD_CODES: tuple[Code, ...] = (
    Code(
        "PG290",
        "no-part-of-the-frame",
        "A field that is no part of the frame",
        """\
With `part`, a field is the number of a part of the frame. In each frame that carries the message
that is a part whose number the sender chooses: one with a type and no other key, one of several
literals, bits of these, or an identity of which the message has several. The field has as many bits
as the part, and no sign.
""",
        _framed("flags: {part: flag, type: uint8}, speed: uint16"),
        _framed("flags: {part: flags, type: uint8}, speed: uint16"),
    ),
    Code(
        "PG291",
        "misplaced-part",
        "A `part` where none can be",
        """\
The payload has no bytes of a field that is a part of the frame. So such fields come in front of all
others, belong to the message itself and not to something inside of it, are each another part, and
have no key about bytes, nor one about presence. They have a type, and names of values or bits, a
range, a scale and a unit, as other integers do.
""",
        _framed("speed: uint16, flags: {part: flags, type: uint8}"),
        _framed("flags: {part: flags, type: uint8}, speed: uint16"),
    ),
    Code(
        "PG292",
        "part-too-late",
        "A part that comes behind the fields that it says something of",
        """\
Where neither a length nor an end tells how long a payload is, its fields do. A receiver has to know
the parts of the frame among them by then, so these stand in front of the payload.
""",
        _framed(_FLAGS, _BEHIND.replace("0xA5", "0xA5, unprotected: starts"), _ACCEPTED),
        _framed(_FLAGS, _IN_FRONT.replace("0xA5", "0xA5, unprotected: starts"), _ACCEPTED),
    ),
)
"""Problems of fields that are parts of the frame."""
