"""Transparency: what keeps delimiters out of a region of a frame, and takes it off again.

Each kind is an immutable value. `encode` and `decode` work on a whole region; `decoder` gives a
machine that takes the region byte by byte, as a stream decoder needs it. Both decode alike: the
same bytes, or the same error.

    >>> slip = Substitution({0xC0: bytes((0xDB, 0xDC)), 0xDB: bytes((0xDB, 0xDD))})
    >>> slip.encode(bytes.fromhex("01 C0 02")).hex(" ")
    '01 db dc 02'
    >>> slip.decode(bytes.fromhex("01 DB DC 02")).hex(" ")
    '01 c0 02'

A strict decoder accepts exactly what the encoder makes: a region decodes only if encoding the
result gives the region back. What a `lenient` one accepts beyond that is said with each kind.
"""

from protogen.runtime.transparency.encodings import Base16Upper, Cobs
from protogen.runtime.transparency.insertion import Insertion
from protogen.runtime.transparency.regions import Transparency, TransparencyError, Unstuffer
from protogen.runtime.transparency.substitution import Escape, Substitution, replacing_order

__all__ = [
    "Base16Upper",
    "Cobs",
    "Escape",
    "Insertion",
    "Substitution",
    "Transparency",
    "TransparencyError",
    "Unstuffer",
    "replacing_order",
]
