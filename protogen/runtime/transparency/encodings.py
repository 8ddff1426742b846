"""Transparency by encodings of all bytes: base 16 and COBS."""

from __future__ import annotations

import binascii
from collections.abc import Iterator

from protogen.runtime.payload.number import BYTES
from protogen.runtime.transparency.regions import TransparencyError, Unstuffer, decode_by_byte
from protogen.runtime.values import Frozen

# --- base 16 ------------------------------------------------------------------------------------

_UPPER_DIGITS = b"0123456789ABCDEF"
_ALL_DIGITS = _UPPER_DIGITS + b"abcdef"


class Base16Upper(Frozen):
    """Each byte is written as two hexadecimal digits in upper case, upper half first.

    A byte that is no digit and an odd number of digits are encoding errors. Lenient: the digits
    may be in lower case, too.
    """

    __slots__ = ("lenient",)

    lenient: bool

    def __init__(self, lenient: bool = False) -> None:
        self._set(lenient)

    def encode(self, data: bytes) -> bytes:
        """Return the digits of the data."""
        return binascii.hexlify(data).upper()

    def decode(self, region: bytes) -> bytes:
        """Return what the digits stand for; else raise TransparencyError "encoding"."""
        # What is left without the digits decides, because unhexlify takes lower case always.
        if len(region) % 2 or region.translate(None, self._digits()):
            return decode_by_byte(self.decoder(), region)
        return binascii.unhexlify(region)

    def decoder(self) -> Unstuffer:
        """Return a new decoder at the start of a region."""
        return _Base16Unstuffer(self._digits())

    def _digits(self) -> bytes:
        return _ALL_DIGITS if self.lenient else _UPPER_DIGITS


class _Base16Unstuffer:
    __slots__ = ("_digits", "_upper")

    def __init__(self, digits: bytes) -> None:
        self._digits = digits
        self._upper = b""

    def push(self, byte: int) -> bytes:
        if byte not in self._digits:
            raise TransparencyError("encoding", f"{byte:02X} is no hexadecimal digit")
        if self._upper:
            decoded = binascii.unhexlify(self._upper + BYTES[byte])
            self._upper = b""
            return decoded
        self._upper = BYTES[byte]
        return b""

    def finish(self) -> bytes:
        if self._upper:
            raise TransparencyError("encoding", "the number of hexadecimal digits is odd")
        return b""


# --- COBS ---------------------------------------------------------------------------------------

_FULL_CODE = 0xFF
_FULL_GROUP = _FULL_CODE - 1
"""The bytes of the longest group; it is the only one that no zero follows."""


class Cobs(Frozen):
    """Consistent overhead byte stuffing: the region never contains a zero.

    The region is a run of groups: a code byte n, then n - 1 bytes that are not zero; a zero of the
    data follows each group except one of code FF and the last.

    A zero in the region and a group that the region's end cuts are encoding errors. Strict: so are
    an empty region, because no data is written as 01, and a last group 01 behind a group FF,
    because 254 bytes without a zero are written without it. Lenient: these two are accepted.
    """

    __slots__ = ("lenient",)

    lenient: bool

    def __init__(self, lenient: bool = False) -> None:
        self._set(lenient)

    def encode(self, data: bytes) -> bytes:
        """Return the region for the data."""
        runs = data.split(b"\0")
        groups = [group for run in runs for group in _groups(run)]
        if runs[-1] and len(runs[-1]) % _FULL_GROUP == 0:
            groups.pop()  # Behind a full group the end of the data needs no group of its own.
        return b"".join(groups)

    def decode(self, region: bytes) -> bytes:
        """Return what the groups stand for; else raise TransparencyError "encoding"."""
        data = _ungrouped(region)
        if data is None or not (self.lenient or self.encode(data) == region):
            return decode_by_byte(self.decoder(), region)
        return data

    def decoder(self) -> Unstuffer:
        """Return a new decoder at the start of a region."""
        return _CobsUnstuffer(self.lenient)


def _groups(run: bytes) -> Iterator[bytes]:
    """Return the groups for bytes without a zero: full ones, then the rest, which may be empty."""
    for start in range(0, len(run) + 1, _FULL_GROUP):
        group = run[start : start + _FULL_GROUP]
        yield BYTES[len(group) + 1] + group


def _ungrouped(region: bytes) -> bytes | None:
    """Return the data of all groups; None where a zero stands or the last group is cut."""
    if 0 in region:
        return None
    pieces = []
    start = 0
    while start < len(region):
        code = region[start]
        end = start + code
        pieces.append(region[start + 1 : end])
        if code != _FULL_CODE and end < len(region):
            pieces.append(b"\0")
        start = end
    return b"".join(pieces) if start == len(region) else None


class _CobsUnstuffer:
    __slots__ = ("_code", "_left", "_lenient", "_needless")

    def __init__(self, lenient: bool) -> None:
        self._lenient = lenient
        self._code = 0  # Of the present group; 0 before the first one.
        self._left = 0  # Bytes that are still to come in this group.
        self._needless = False  # This group is one that an encoder leaves out at the end.

    def push(self, byte: int) -> bytes:
        if byte == 0:
            raise TransparencyError("encoding", "COBS never writes a zero")
        if self._left:
            self._left -= 1
            return BYTES[byte]
        return self._open_group(byte)

    def finish(self) -> bytes:
        if self._left:
            raise TransparencyError("encoding", f"bytes missing in the last group: {self._left}")
        if self._lenient:
            return b""
        if self._code == 0:
            raise TransparencyError("encoding", "COBS writes 01 for no data, not nothing")
        if self._needless:
            raise TransparencyError("encoding", "COBS ends behind a full group without 01")
        return b""

    def _open_group(self, code: int) -> bytes:
        # Only now is it known that the group before was not the last, so that its zero is due.
        zero = b"\0" if 0 < self._code < _FULL_CODE else b""
        self._needless = code == 1 and self._code == _FULL_CODE
        self._code = code
        self._left = code - 1
        return zero
