"""The pieces of construct that a generated `FORMAT` is made of, strict and lossless.

This is the only package that knows construct. Each piece here is a construct object like any other:
it parses, builds, tells its size where that is fixed, and can be embedded in a larger declaration.

    >>> point = Struct("x" / Int(16, signed=True), "y" / Int(16, signed=True))
    >>> point.build({"x": -2, "y": 3}).hex()
    'feff0300'
    >>> point.sizeof()
    4

What parses builds the same bytes again. What does not parse raises `PayloadError`, which says where
and why. construct's own pieces are wrapped where they lose bytes or say too little: they ignore
bytes behind the last field, keys that no field has, and a bad tail of a greedy range.
"""

from construct import (  # type: ignore[import-untyped,unused-ignore]
    Construct,
    Container,
    Pass,
    Renamed,
)

from protogen.runtime.constructs.bits import Bit, Bits, Packed, PackedFill
from protogen.runtime.constructs.numbers import (
    Closed,
    Digits,
    Fixed,
    Flag01,
    Float,
    Int,
    SevenBit,
    SevenBitFloat,
    Written,
)
from protogen.runtime.constructs.pieces import Count, PayloadError, Piece
from protogen.runtime.constructs.progress import Measurer
from protogen.runtime.constructs.strings import (
    Latin1,
    Latin1Fill,
    Latin1Until,
    Octets,
    OctetsFill,
    OctetsUntil,
    Padded,
    TextBetween,
)
from protogen.runtime.constructs.structs import (
    Cases,
    Counted,
    Fill,
    IfLeft,
    Part,
    Region,
    Struct,
    Tail,
    UpToLast,
    When,
    Whole,
    prefix_size,
    region_bytes,
)

__all__ = [
    "Bit",
    "Bits",
    "Cases",
    "Closed",
    "Construct",
    "Container",
    "Count",
    "Counted",
    "Digits",
    "Fill",
    "Fixed",
    "Flag01",
    "Float",
    "IfLeft",
    "Int",
    "Latin1",
    "Latin1Fill",
    "Latin1Until",
    "Measurer",
    "Octets",
    "OctetsFill",
    "OctetsUntil",
    "Packed",
    "PackedFill",
    "Padded",
    "Part",
    "Pass",
    "PayloadError",
    "Piece",
    "Region",
    "Renamed",
    "SevenBit",
    "SevenBitFloat",
    "Struct",
    "Tail",
    "TextBetween",
    "UpToLast",
    "When",
    "Whole",
    "Written",
    "prefix_size",
    "region_bytes",
]
