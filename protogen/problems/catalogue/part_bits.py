"""Problems of parts that are bits of another one."""

from __future__ import annotations

from protogen.problems.catalogue.code import Code
from protogen.problems.catalogue.sketch import with_framed


def _framed(head: str, check: str = "head..payload") -> str:
    """A schema whose frames begin with a part of which the bits have names."""
    frame = f"""
        head: {head}
        payload: {{}}
        crc: {{type: uint8, algorithm: CRC-8/SMBUS, covers: {check}}}
        end: {{literal: 0xC0}}
    """
    return with_framed(frame, "beat: {id: 1, from: robot}", more="transparency: slip")


def _marked(keys: str) -> str:
    """A schema with a mark in the low bits of that part."""
    mark = f"mark: {{bits: 0..3, {keys}}}"
    return _framed(f"{{type: uint8, bits: {{kind: {{bits: 4..7, id: true}}, {mark}}}}}")


_FINE = _framed("{type: uint8, bits: {kind: {bits: 4..7, id: true}, port: 0..3}}")

PART_BITS_CODES: tuple[Code, ...] = (
    Code(
        "PG256",
        "no-bits-of-the-part",
        "Bits that the part does not have",
        """\
The bits of a part are those of its number, counted from the least significant bit 0. A text has
none, and the highest bit of a `uint8` is 7.
""",
        _framed("{type: uint8, bits: {kind: {bits: 4..8, id: true}, port: 0..3}}"),
        _FINE,
    ),
    Code(
        "PG257",
        "overlapping-bits-of-a-part",
        "Bits of a part that have two names",
        """\
Each bit of a part is that of one name at most. Those of no name are 0 in each frame.
""",
        _framed("{type: uint8, bits: {kind: {bits: 4..7, id: true}, port: 0..4}}"),
        _FINE,
    ),
    Code(
        "PG258",
        "name-of-bits-taken",
        "Bits that are called as another part of the frame",
        """\
Bits of a part are parts of the frame, too: an identity, a counter, or a value that the caller
gives. All of them have names of their own, as events show them side by side.
""",
        _framed("{type: uint8, bits: {kind: {bits: 4..7, id: true}, crc: 0..3}}"),
        _FINE,
    ),
    Code(
        "PG259",
        "bits-for-bytes",
        "Bits where whole bytes are meant",
        """\
Checksums cover bytes, lengths count them, and a transparency stuffs them. So they name the part
that has the bytes, and none of the bits that it has.
""",
        _framed("{type: uint8, bits: {kind: {bits: 4..7, id: true}, port: 0..3}}", "kind..payload"),
        _FINE,
    ),
    Code(
        "PG260",
        "constant-bits",
        "Bits that are the same in each frame, and more",
        """\
Bits with `const` are the same in each frame: receivers refuse any others, and nobody gives them. So
they tell no message, are no length and no checksum, count nothing, and have no `range` or
`default`. Where all named bits of a part are so, it is a `literal`.
""",
        _marked("const: 2, default: 2"),
        _marked("const: 2"),
    ),
    Code(
        "PG293",
        "bits-of-a-checksum",
        "Bits that a checksum does not have, or more or fewer than there is room for",
        """\
Bits of a part that are some bits of a checksum say with `takes` which of its result these are,
counted from the least significant bit 0: as many as they are themselves. The highest bit of a
CRC-8 is 7.
""",
        _marked("algorithm: CRC-8/SMBUS, covers: payload, takes: 4..8"),
        _marked("algorithm: CRC-8/SMBUS, covers: payload, takes: 4..7"),
    ),
)
