"""Problems of several lengths in one frame."""

from __future__ import annotations

from protogen.problems.catalogue.code import Code
from protogen.problems.catalogue.sketch import with_frame

_NESTED = """
    outer: {type: uint8, counts: code..crc, range: [3, 254]}
    code: {type: uint8, id: true}
    inner: {type: uint8, counts: payload}
    payload: {}
    crc: {type: uint8, algorithm: CRC-8/DVB-S2, covers: code..payload}
"""
_STUFFED = """
    start: {literal: {hex: FF FF FD 00}}
    length: {type: uint16, counts: id..payload, over: wire, range: [0, 1000]}
    id: {type: uint8, id: true}
    size: {type: uint8, counts: payload}
    payload: {}
"""
_KEPT_OUT = "transparency: {covers: id..payload, substitute: {FF FF FD: FF FF FD FD}}"

LENGTH_CODES: tuple[Code, ...] = (
    Code(
        "PG285",
        "several-lengths-over-wire",
        "A length over the wire beside another length",
        """\
The first length of a frame tells where it ends, and each other has to agree with it, as soon as a
receiver has both. What a length says that counts bytes as they are sent is known only when all of
them are there. So all lengths of a frame with several count unstuffed bytes.
""",
        with_frame(_STUFFED, more=_KEPT_OUT),
        with_frame(_STUFFED.replace(", counts: payload", ""), more=_KEPT_OUT),
    ),
    Code(
        "PG286",
        "lengths-never-agree",
        "Lengths of one frame that never agree",
        """\
Several lengths of a frame are those of the same payload. Each has a range, its own or that of its
type, and counts certain parts besides; so it can state payloads from some size to another. Of these
sizes at least one has to be the same for all lengths.
""",
        with_frame(_NESTED.replace("counts: payload", "counts: payload, range: [252, 255]")),
        with_frame(_NESTED.replace("counts: payload", "counts: payload, range: [0, 251]")),
    ),
)
