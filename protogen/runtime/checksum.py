"""Checksums of generated codecs: exclusive or, sum, Fletcher and every CRC of 1 to 64 bits.

Each is an immutable value with one method, `compute`, from the covered bytes to an integer:

    >>> hex(Crc(16, poly=0x1021, refin=True, refout=True).compute(b"123456789"))
    '0x2189'
"""

import binascii
import zlib
from collections.abc import Callable, Iterable
from functools import cache, reduce
from itertools import accumulate
from operator import xor
from typing import Protocol
from zlib import adler32

from protogen.runtime.payload.number import ByteOrder
from protogen.runtime.values import Frozen

GREATEST_WIDTH = 64


class Checksum(Protocol):
    """A checksum algorithm."""

    def compute(self, data: bytes) -> int:
        """Return the checksum of `data`, an integer of as many bits as the algorithm has."""


_LONG = 256
"""So many bytes have a sum of more than 16 bits, or nearly."""


_SHORT, _HALVED = 32, 64
"""So many bytes are halved five or six times, without asking how many there are."""

_from_bytes = int.from_bytes


def xor_of(data: bytes) -> int:
    """Return the exclusive or of all bytes."""
    # Halves of one great integer are laid over each other, until they are one byte.
    great = _from_bytes(data, "little")
    size = len(data)
    if size > _SHORT:
        while size > _HALVED:
            half = size + 1 >> 1
            great ^= great >> 8 * half
            great &= (1 << 8 * half) - 1
            size = half
        great ^= great >> 256
    great ^= great >> 128
    great ^= great >> 64
    great ^= great >> 32
    great ^= great >> 16
    return (great ^ great >> 8) & 0xFF


def are_sound(contents: list[bytes], first: int) -> bool:
    """True if the bytes from `first` on have the exclusive or 0 in each of these of one size."""
    # One great integer of each place has a byte of each content.
    joined, size, great = b"".join(contents), len(contents[0]), 0
    for place in range(first, size):
        great ^= _from_bytes(joined[place::size], "little")
    return great == 0


class _Folded(Frozen):
    """Base of sums and exclusive ors of `width` bits, which begin with `init`.

    Of `words`, each has `width` bits in this order, and the last is filled with zeros; else bytes
    are taken. What comes of them is changed by `xorout`, `mask` and `add`, in this order.
    """

    __slots__ = ("add", "init", "mask", "width", "words", "xorout")

    width: int
    init: int
    xorout: int
    mask: int | None
    add: int
    words: ByteOrder | None

    def _units(self, data: bytes) -> Iterable[int]:
        """The numbers that are taken."""
        if self.words is None:
            return data
        size = self.width // 8
        places = range(0, len(data), size)
        filled = data + bytes(-len(data) % size)
        return (_from_bytes(filled[place : place + size], self.words) for place in places)

    def _result(self, register: int) -> int:
        result = register ^ self.xorout
        return ((result if self.mask is None else result & self.mask) + self.add) & (
            (1 << self.width) - 1
        )


class Xor(_Folded):
    """The exclusive or of all bytes or words, and `init`."""

    __slots__ = ()

    def __init__(
        self,
        width: int = 8,
        init: int = 0,
        xorout: int = 0,
        mask: int | None = None,
        add: int = 0,
        words: ByteOrder | None = None,
    ) -> None:
        self._set(width, init, xorout, mask, add, words)

    def compute(self, data: bytes) -> int:
        """Return the checksum of `data`, 0 .. 2**width - 1."""
        if self.words is None:
            return self._result(xor_of(data) ^ self.init)
        return self._result(reduce(xor, self._units(data), self.init))


class Sum(_Folded):
    """The sum of all bytes or words, and `init`; `negated`: what brings that sum to 0."""

    __slots__ = ("negated",)

    negated: bool

    def __init__(
        self,
        width: int = 8,
        init: int = 0,
        xorout: int = 0,
        mask: int | None = None,
        add: int = 0,
        words: ByteOrder | None = None,
        negated: bool = False,
    ) -> None:
        self._set(width, init, xorout, mask, add, words, negated)

    def compute(self, data: bytes) -> int:
        """Return the checksum of `data`, 0 .. 2**width - 1."""
        # Adler-32 without its first 1 is a sum modulo 65521, and faster.
        is_short = self.words is None and len(data) < _LONG
        total = adler32(data, 0) & 0xFFFF if is_short else sum(self._units(data))
        total += self.init
        return self._result(-total if self.negated else total)


class Fletcher16(Frozen):
    """Fletcher's checksum of bytes modulo 255, or 256 as UBX has it.

    The sum of the bytes is the low byte, the sum of those running sums the high byte.
    """

    __slots__ = ("modulus",)

    modulus: int

    def __init__(self, modulus: int = 255) -> None:
        self._set(modulus)

    def compute(self, data: bytes) -> int:
        """Return the checksum of `data`; both of its bytes are below `modulus`."""
        return ((sum(accumulate(data)) % self.modulus) << 8) | (sum(data) % self.modulus)


class Crc(Frozen):
    """A cyclic redundancy check by its Rocksoft parameters, as the CRC RevEng catalogue gives them.

    `width` is 1..64 bits. `poly` is the polynomial without its top bit, `init` the register before
    the first byte; both are written most significant bit first, also where `refin` is set.
    `refin`: bytes enter least significant bit first. `refout`: the register leaves with its bits
    in reverse order. `xorout` is applied last.

    Raises ValueError when the width is out of range or a parameter has more bits than the width.
    """

    __slots__ = ("init", "poly", "refin", "refout", "width", "xorout")

    width: int
    poly: int
    init: int
    refin: bool
    refout: bool
    xorout: int

    def __init__(
        self,
        width: int,
        poly: int,
        init: int = 0,
        refin: bool = False,
        refout: bool = False,
        xorout: int = 0,
    ) -> None:
        if not 1 <= width <= GREATEST_WIDTH:
            raise ValueError(f"a CRC has 1..{GREATEST_WIDTH} bits, not {width}")
        for name, value in (("poly", poly), ("init", init), ("xorout", xorout)):
            if not 0 <= value < 1 << width:
                raise ValueError(f"{name} does not fit {width} bits")
        self._set(width, poly, init, refin, refout, xorout)

    def compute(self, data: bytes) -> int:
        """Return the checksum of `data`, 0 .. 2**width - 1."""
        register = reversed_bits(self.init, self.width) if self.refin else self.init
        register = _engine(self.width, self.poly, self.refin)(data, register)
        if self.refin != self.refout:
            register = reversed_bits(register, self.width)
        return register ^ self.xorout

    def function(self) -> Callable[[bytes], int]:
        """Return the fastest function that computes it."""
        given = self.width, self.poly, self.refin, self.refout
        init, xorout = self.init, self.xorout
        if given == (16, 0x1021, False, False):
            return lambda data: binascii.crc_hqx(data, init) ^ xorout
        if given == (32, 0x04C11DB7, True, True) and init == xorout == 0xFFFFFFFF:
            return zlib.crc32
        return self.compute


# An engine takes data and the register before it, and gives the register behind it. The register
# of a reflected engine (`refin`) is in reverse bit order throughout.
_Engine = Callable[[bytes, int], int]


@cache
def _engine(width: int, poly: int, refin: bool) -> _Engine:
    """Return the fastest engine there is for these parameters."""
    if (width, poly) == (16, 0x1021):
        return _mirrored(binascii.crc_hqx, width) if refin else binascii.crc_hqx
    if (width, poly) == (32, 0x04C11DB7):
        return _zlib_engine if refin else _mirrored(_zlib_engine, width)
    return _reflected_engine(width, poly) if refin else _plain_engine(width, poly)


def _plain_engine(width: int, poly: int) -> _Engine:
    """Return a table engine for bytes that enter most significant bit first."""
    # A register of less than 8 bits is kept in the upper bits of one byte, so that the table
    # is entered in the same way for every width.
    padding = max(0, 8 - width)
    top = width + padding - 8
    mask = (1 << (width + padding)) - 1
    table = _plain_table(poly << padding, width + padding)

    def advance(data: bytes, register: int) -> int:
        register <<= padding
        for byte in data:
            register = table[(register >> top) ^ byte] ^ ((register << 8) & mask)
        return register >> padding

    return advance


def _plain_table(poly: int, width: int) -> tuple[int, ...]:
    """Return what each value of the register's top byte adds to it when it is shifted out."""
    mask = (1 << width) - 1

    def entry(byte: int) -> int:
        register = byte << (width - 8)
        for _ in range(8):
            carry = register >> (width - 1)
            register = ((register << 1) & mask) ^ (carry * poly)
        return register

    return tuple(map(entry, range(256)))


def _reflected_engine(width: int, poly: int) -> _Engine:
    """Return a table engine for bytes that enter least significant bit first."""
    table = _reflected_table(reversed_bits(poly, width))

    def advance(data: bytes, register: int) -> int:
        for byte in data:
            register = table[(register ^ byte) & 0xFF] ^ (register >> 8)
        return register

    return advance


def _reflected_table(reversed_poly: int) -> tuple[int, ...]:
    """Return what each value of the register's lowest byte adds to it when it is shifted out."""

    def entry(register: int) -> int:
        for _ in range(8):
            register = (register >> 1) ^ ((register & 1) * reversed_poly)
        return register

    return tuple(map(entry, range(256)))


def _zlib_engine(data: bytes, register: int) -> int:
    # zlib inverts the register on its way in and out.
    return zlib.crc32(data, register ^ 0xFFFFFFFF) ^ 0xFFFFFFFF


def _mirrored(engine: _Engine, width: int) -> _Engine:
    """Return the same polynomial with bytes entering in the other bit order."""

    def advance(data: bytes, register: int) -> int:
        mirrored = engine(data.translate(_REVERSED_BYTES), reversed_bits(register, width))
        return reversed_bits(mirrored, width)

    return advance


def reversed_bits(value: int, width: int) -> int:
    """The number with its bits in the other order."""
    size = width + 7 >> 3
    reversed_bytes = value.to_bytes(size, "little").translate(_REVERSED_BYTES)
    return _from_bytes(reversed_bytes, "big") >> 8 * size - width


_REVERSED_BYTES = bytes(int(f"{byte:08b}"[::-1], 2) for byte in range(256))
