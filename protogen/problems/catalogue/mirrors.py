"""Problems of parts, and bits of parts, that follow from a number of the frame."""

from __future__ import annotations

from protogen.problems.catalogue.code import Code
from protogen.problems.catalogue.sketch import with_framed


def _framed(*parts: str) -> str:
    """A schema whose frames have these parts behind their identity."""
    lines = "\n        ".join(parts)
    frame = f"""
        kind: {{type: uint8, id: true}}
        {lines}
        payload: {{}}
        crc: {{type: uint8, algorithm: CRC-8/SMBUS, covers: kind..payload}}
        end: {{literal: 0xC0}}
    """
    return with_framed(frame, "beat: {id: 1, from: robot}", more="transparency: slip")


def _headed(mirror: str, version: str = "{bits: 0..2, const: 1}") -> str:
    """A schema with a number in some bits of a part, and other bits that follow from it."""
    bits = f"version: {version}, flow: 3..4, flow_not: {mirror}"
    return _framed(f"head: {{type: uint8, bits: {{{bits}}}}}")


_FINE = _headed("{bits: 5..6, complements: flow}")

MIRROR_CODES: tuple[Code, ...] = (
    Code(
        "PG273",
        "no-number-to-follow",
        "A part that repeats what is no number of the frame",
        """\
A part, or some bits of one, can follow from an identity, a length, a counter or a value: from a
part that is one, or from bits that are. Literals and constant bits are written once more as they
are. A checksum is worked out when all else is known, texts and digits have no bits, and what
follows from a number itself is named by that.
""",
        _headed("{bits: 5..7, complements: version}"),
        _headed("{bits: 5..7, const: 6}"),
    ),
    Code(
        "PG274",
        "follows-in-other-width",
        "A part that repeats a number of another width",
        """\
What repeats or complements a number has as many bits as it has.
""",
        _headed("{bits: 5..7, complements: flow}"),
        _FINE,
    ),
    Code(
        "PG275",
        "follows-from-behind",
        "A part that repeats a number behind it, or across the payload",
        """\
A receiver compares both as soon as it has them, so that a wrong start is given up early. So the
number itself stands in front, or in the same part, and no payload lies between the two. Of two
parts with one value, the first is the number, and the second repeats it.
""",
        _framed("size_again: {type: uint8, repeats: size}", "size: {type: uint8, counts: payload}"),
        _framed("size: {type: uint8, counts: payload}", "size_again: {type: uint8, repeats: size}"),
    ),
    Code(
        "PG276",
        "bits-that-follow",
        "Bits that follow from a number, and more",
        """\
Bits that repeat or complement a number are worked out by senders and checked by receivers. They
tell no message and count nothing, have no `range` or `default`, and follow from one number.
""",
        _headed("{bits: 5..6, complements: flow, default: 1}"),
        _FINE,
    ),
)
