"""Problems of substitutes for several bytes, and of what is counted or summed on the wire."""

from __future__ import annotations

from protogen.problems.catalogue.code import Code
from protogen.problems.catalogue.sketch import with_frame

_COUNTED = """
    start: {literal: {hex: FF FF FD 00}}
    length: {type: uint16, counts: id..payload, over: wire, range: [0, 1000]}
    id: {type: uint8, id: true}
    payload: {}
"""
_SUMMED = """
    start: {literal: {hex: FF FF FD 00}}
    length: {type: uint16, counts: id..crc, over: wire, range: [0, 1000]}
    id: {type: uint8, id: true}
    payload: {}
    crc: {type: uint8, algorithm: CRC-8/SMBUS, covers: id..payload, over: wire}
"""


def _stuffed(substitute: str, parts: str = _COUNTED, region: str = "id..payload") -> str:
    """A schema whose frame has this substitute, over these parts."""
    return with_frame(
        parts, more=f"transparency: {{covers: {region}, substitute: {{{substitute}}}}}"
    )


_KEPT_OUT = "FF FF FD: FF FF FD FD"

WIRE_COUNT_CODES: tuple[Code, ...] = (
    Code(
        "PG247",
        "substitute-for-several-bytes",
        "A substitute for several bytes that is not one byte more",
        """\
A table substitutes single bytes, as many as it lists. Or it has one sequence of two bytes or more,
and what stands for that is the sequence itself with one byte put in behind it, as in Dynamixel:
`FF FF FD: FF FF FD FD`. Then a receiver that has seen the sequence knows what comes next, whatever
was sent, and takes that byte away. It can do so only where each sequence is stuffed, so `lenient`
does not go together with it.
""",
        _stuffed("FF FF FD: FF FF FE FD"),
        _stuffed(_KEPT_OUT),
    ),
    Code(
        "PG248",
        "substitute-that-overlaps",
        "A sequence that can overlap itself",
        """\
A byte is put in behind each sequence, and then the next one is looked for. If a sequence ends as it
begins (`AA 55 AA`), documents differ in what becomes of two that share bytes. If the byte that was
put in begins the sequence again (`FF FF FD: FF FF FD FF`), a receiver may see one that nobody sent.
Choose a sequence and a byte of which no end is a beginning.
""",
        _stuffed("FF FF FD: FF FF FD FF"),
        _stuffed(_KEPT_OUT),
    ),
    Code(
        "PG249",
        "length-over-wire",
        "A length of what is sent that does not tell where the frame ends",
        """\
`over: wire` on a length counts bytes as they are sent, stuffing included. A receiver knows from it
where the stuffed parts end, before it has looked at any of them. So the length itself is in front
of them and unstuffed; it counts all of them, and the payload is one of them; they hold no checksum,
whose own size on the wire would depend on the length; no part is absent at times; and the stuffing
is a `substitute` or an `escape` that only one spelling undoes. Its `range` bounds it above alone.
""",
        _stuffed(_KEPT_OUT, _COUNTED.replace("id..payload", "payload")),
        _stuffed(_KEPT_OUT),
    ),
    Code(
        "PG250",
        "checksum-over-some-of-the-wire",
        "A checksum over some of the bytes that a sequence is looked for in",
        """\
Where a byte is put in behind a sequence, that depends on the bytes in front of it. A checksum
`over: wire` can sum up all parts that are stuffed, or none of them.
""",
        _stuffed(_KEPT_OUT, _SUMMED.replace("covers: id..payload", "covers: payload")),
        _stuffed(_KEPT_OUT, _SUMMED),
    ),
)
"""The problems of sequences and of bytes on the wire."""
