"""The format of recordings.

A file begins with `MAGIC`. Then records follow, one for each piece that was read from the line:

    bytes   type          meaning
    0..7    int64 LE      nanoseconds since 1970-01-01 UTC
    8..11   uint32 LE     bytes behind this head
    12      uint8         kind: 0 bytes of the line, 1 the name of a source, 2 a note
    13      uint8         source: who sent the bytes, or whose name it is
    14, 15                zero
    16..                  the bytes; names and notes are UTF-8

The joined bytes of all records of a source are what it sent; nothing is assumed of where a piece
ends. A source without a name is not known. A file that ends inside a record, because the power
failed, holds the records in front of it, and the bytes that are there.

Files of format 1 have heads of 12 bytes, without kind and source.
"""

from __future__ import annotations

import struct
from enum import IntEnum

import msgspec

MAGIC = b"PGREC\x00\x02\n"
"""The first bytes of a recording: name, format 2."""
MAGIC_1 = b"PGREC\x00\x01\n"
"""The first bytes of format 1, which is read, and no longer written."""
HEAD = struct.Struct("<qIBBxx")
"""Time, size, kind and source of a record."""
HEAD_1 = struct.Struct("<qI")
"""Time and size of a record of format 1."""
GREATEST = 1 << 24
"""The most bytes of one record."""
MOST_SOURCES = 256
"""A source is a byte."""


class RecordKind(IntEnum):
    """What the bytes of a record are."""

    BYTES = 0
    NAME = 1
    NOTE = 2


class Record(msgspec.Struct, frozen=True):
    """Bytes that a source sent, or a note."""

    data: bytes
    when: int
    """Nanoseconds since 1970-01-01 UTC."""
    source: str = ""
    """Name of who sent them; empty where that is not known."""
    kind: RecordKind = RecordKind.BYTES
    """Bytes or note; names are told by `source`."""
