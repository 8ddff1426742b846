"""Problems of parts that receivers are told, and that are not sent."""

from __future__ import annotations

from protogen.problems.catalogue.code import Code
from protogen.problems.catalogue.sketch import with_framed

_MESSAGES = """
    speed: {id: {asked: 1, ok: 1}, from: robot, fields: {speed: uint16}}
    name: {id: {asked: 2, ok: 1}, from: robot, fields: {name: {type: ascii, size: 4}}}
"""
_SLIP = "transparency: slip"


def _framed(told: str, more: str = "") -> str:
    """A schema with a told part, and further parts behind it."""
    frame = f"""
        asked: {{type: uint8, told: true{told}}}
        ok: {{type: uint8, id: true}}
        {more}
        payload: {{}}
        sum: {{type: uint8, algorithm: sum-8, covers: ok..payload}}
        end: {{literal: 0xC0}}
    """
    return with_framed(frame, _MESSAGES, more=_SLIP)


_DATA = "data: {from: robot, fields: {data: {type: bytes, size: {fill: true, min: 1}}}}"
_ANNOUNCED = "announced: {type: uint8, told: true, counts: payload, range: [1, 64]}"
_BARE = """
decisions:
  bare: {question: Where do data begin?, document: -, choice: At once., because: Nothing else can.}
"""


def _sized(parts: str) -> str:
    """A schema with these parts in front of bare data."""
    return with_framed(f"{parts}\npayload: {{unprotected: bare}}", _DATA, more=_BARE)


TOLD_PART_CODES: tuple[Code, ...] = (
    Code(
        "PG305",
        "not-telling",
        "A number that can't tell what frames are",
        """\
What a part with `told: true` is, a receiver learns from its program, or from frames that it
takes. `set_by` names a part of frames that receivers hand on (an identity, a counter or a value),
or MESSAGE.FIELD, a field that is an unsigned integer or an array of such. The part has to have room
for all of its values.
""",
        _framed(", set_by: name.name"),
        _framed(", set_by: speed.speed").replace("type: uint8, told", "type: uint16, told"),
    ),
    Code(
        "PG306",
        "told-too-late",
        "What frames are can't be told in time, or not for a checksum",
        """\
A receiver has to be told in front of a frame which one it is. Where the end of a frame is the start
of the next one as well, it has begun with that one already. And the values of virtual parts follow
from the identity that is sent: a frame has virtual parts, or identities that are told. Forms of one
endpoint's frames that have a told part of one name have one value of it, and say the same about it.
""",
        _framed("", "extra: {type: uint8, virtual: true, default: 0}").replace(
            "covers: ok", "covers: extra"
        ),
        _framed("", "extra: {type: uint8, default: 0}"),
    ),
    Code(
        "PG307",
        "told-no-bytes",
        "A frame may have no bytes, as a receiver is told",
        """\
A length with `told: true` says how many bytes a frame has. Where nothing but the payload is sent, a
frame without bytes would be one at any place, so that a receiver would find them without end. The
`range` of the length begins with 1 there.
""",
        _sized("announced: {type: uint16, told: true, counts: payload}"),
        _sized("announced: {type: uint16, told: true, counts: payload, range: [1, 512]}"),
    ),
    Code(
        "PG308",
        "told-twice",
        "The size of a frame is told, and something else gives it as well",
        """\
A length with `told: true` stands for what frames do not say. Where they have a length that is sent,
a silence behind them, or stuffed bytes up to a delimiter, a receiver finds the end without it.
""",
        _sized(f"{_ANNOUNCED}\nlength: {{type: uint8, counts: payload}}"),
        _sized(_ANNOUNCED),
    ),
)
