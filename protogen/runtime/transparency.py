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

from __future__ import annotations

import binascii
import re
from collections.abc import Iterable, Iterator, Mapping
from functools import cache
from typing import Literal, Protocol

from protogen.runtime.values import Frozen

TransparencyReason = Literal["stuffing", "encoding"]
"""What is wrong: bytes that are no escape sequence, or that break an encoding of the region."""

EscapeTransform = Literal["invert", "none"] | int
"""What an escape does to the byte behind it: invert its bits, nothing, exclusive or with this."""


class TransparencyError(ValueError):
    """A region on the wire is not what its transparency would have made."""

    def __init__(self, reason: TransparencyReason, message: str) -> None:
        super().__init__(message)
        self.reason: TransparencyReason = reason


class Unstuffer(Protocol):
    """Decodes one region, byte by byte. Of no use after an error or `finish`."""

    def push(self, byte: int) -> bytes:
        """Take the next byte of the region and return the decoded bytes that it releases.

        Raises TransparencyError at the first byte that no region could have here.
        """

    def finish(self) -> bytes:
        """Take the end of the region and return the decoded bytes that were held back.

        Raises TransparencyError when the region can't end here.
        """


class Transparency(Protocol):
    """One kind of transparency with its parameters."""

    @property
    def lenient(self) -> bool:
        """True if the decoder accepts more than the encoder makes."""

    def encode(self, data: bytes) -> bytes:
        """Return the region on the wire that stands for `data`."""

    def decode(self, region: bytes) -> bytes:
        """Return what a whole region stands for; raise TransparencyError as the decoder does."""

    def decoder(self) -> Unstuffer:
        """Return a new decoder at the start of a region."""


_ONE_BYTE = tuple(bytes((byte,)) for byte in range(256))


def _decode_by_byte(unstuffer: Unstuffer, region: bytes) -> bytes:
    released = [unstuffer.push(byte) for byte in region]
    released.append(unstuffer.finish())
    return b"".join(released)


def _hex(data: bytes) -> str:
    return data.hex(" ").upper()


def _cut_sequence(held: bytes) -> TransparencyError:
    return TransparencyError("stuffing", f"the region ends inside a sequence, behind {_hex(held)}")


# --- substitution -------------------------------------------------------------------------------


class Substitution(Frozen):
    """Each byte listed in `table` is replaced by a sequence; the other bytes stand for themselves.

    The table must make a prefix-free code together with the bytes that stand for themselves, as
    the compiler proves for a schema.

    Strict: where a listed byte stands, one of the sequences must stand; the first byte that fits
    none is a stuffing error. Lenient: where a sequence stands it is replaced, and where none does,
    one byte passes as it is and reading goes on at the byte behind it.
    """

    __slots__ = ("_book", "lenient", "table")

    table: Mapping[int, bytes]
    lenient: bool
    _book: _CodeBook

    def __init__(self, table: Mapping[int, bytes], lenient: bool = False) -> None:
        self._set(table, lenient)
        object.__setattr__(self, "_book", _CodeBook(table))

    def __hash__(self) -> int:
        return hash(self.lenient)

    def encode(self, data: bytes) -> bytes:
        """Return the data with every listed byte replaced by its sequence."""
        return self._book.encode(data)

    def decode(self, region: bytes) -> bytes:
        """Return what the region stands for; else raise TransparencyError "stuffing"."""
        if self.lenient:
            return self._book.restore(region)
        data = self._book.restore_strictly(region)
        return _decode_by_byte(self.decoder(), region) if data is None else data

    def decoder(self) -> Unstuffer:
        """Return a new decoder at the start of a region."""
        if self.lenient:
            return _LenientSubstitutionUnstuffer(self._book)
        return _SubstitutionUnstuffer(self._book)


class _CodeBook:
    """A substitution table, prepared for both directions."""

    __slots__ = (
        "_decoded",
        "_listed",
        "_sequences",
        "_steps",
        "_table",
        "_unsent",
        "codewords",
        "prefixes",
    )

    def __init__(self, table: Mapping[int, bytes]) -> None:
        sequences = table.values()
        # A byte that only begins sequences (its data is never sent) is no literal either.
        special = sorted({*table, *(sequence[0] for sequence in sequences)})
        literals = {_ONE_BYTE[byte]: _ONE_BYTE[byte] for byte in range(256) if byte not in special}
        self._table = {_ONE_BYTE[byte]: sequence for byte, sequence in table.items()}
        self._decoded = {sequence: _ONE_BYTE[byte] for byte, sequence in table.items()}
        self._listed = _any_of(map(_ONE_BYTE.__getitem__, table))
        self._sequences = _any_of(sequences)
        self._steps = replacing_order(self._table)
        self._unsent = bytes(byte for byte in special if byte not in table)
        self.codewords = literals | self._decoded
        self.prefixes = {seq[:length] for seq in sequences for length in range(1, len(seq))}

    def encode(self, data: bytes) -> bytes:
        if self._steps is None:
            return self._listed.sub(lambda found: self._table[found[0]], data)
        for byte, sequence in self._steps:
            data = data.replace(byte, sequence)
        return data

    def restore(self, region: bytes) -> bytes:
        """Return the region with every sequence replaced by its byte, all else as it is."""
        return self._sequences.sub(lambda found: self._decoded[found[0]], region)

    def restore_strictly(self, region: bytes) -> bytes | None:
        """Return the region with every sequence replaced; None where it is not an encoder's."""
        data = region
        if self._steps is None:
            data = self.restore(region)
        else:
            for byte, sequence in reversed(self._steps):
                data = data.replace(sequence, byte)
        if self._unsent and len(data.translate(None, self._unsent)) < len(data):
            return None
        return data if self.encode(data) == region else None


def replacing_order(table: Mapping[bytes, bytes]) -> tuple[tuple[bytes, bytes], ...] | None:
    """Return the table in an order in which its bytes can be replaced one after the other.

    None where there is none: what is put in for a byte must hold no byte that comes later.
    """
    left, steps = dict(table), []
    while left:
        free = (b for b in left if not any(other != b and other in left[b] for other in left))
        byte = next(free, None)
        if byte is None:
            return None
        steps.append((byte, left.pop(byte)))
    return tuple(steps)


def _any_of(sequences: Iterable[bytes]) -> re.Pattern[bytes]:
    """Return a pattern for any of the sequences; one that never matches where there are none."""
    escaped = [re.escape(sequence) for sequence in sequences]
    return re.compile(b"|".join(escaped) or rb"(?!)")


class _SubstitutionUnstuffer:
    __slots__ = ("_codewords", "_held", "_prefixes")

    def __init__(self, book: _CodeBook) -> None:
        self._codewords = book.codewords
        self._prefixes = book.prefixes
        self._held = b""

    def push(self, byte: int) -> bytes:
        held = self._held + _ONE_BYTE[byte]
        decoded = self._codewords.get(held)
        if decoded is not None:
            self._held = b""
            return decoded
        if held not in self._prefixes:
            raise TransparencyError("stuffing", f"{_hex(held)} is no sequence and no plain byte")
        self._held = held
        return b""

    def finish(self) -> bytes:
        if self._held:
            raise _cut_sequence(self._held)
        return b""


class _LenientSubstitutionUnstuffer:
    __slots__ = ("_codewords", "_held", "_prefixes")

    def __init__(self, book: _CodeBook) -> None:
        self._codewords = book.codewords
        self._prefixes = book.prefixes
        self._held = b""

    def push(self, byte: int) -> bytes:
        # What is held is shorter than the longest sequence, which bounds the work for a byte.
        self._held += _ONE_BYTE[byte]
        released = b""
        while self._held and self._held not in self._prefixes:
            released += self._release()
        return released

    def finish(self) -> bytes:
        released = b""
        while self._held:
            released += self._release()
        return released

    def _release(self) -> bytes:
        """Decode the sequence at the start of what is held, or let its first byte pass."""
        held = self._held
        for length in range(1, len(held) + 1):
            decoded = self._codewords.get(held[:length])
            if decoded is not None:
                self._held = held[length:]
                return decoded
        self._held = held[1:]
        return held[:1]


# --- escape -------------------------------------------------------------------------------------


class Escape(Frozen):
    """Each byte in `of` is replaced by the escape byte `byte` and the byte itself, transformed.

    `of` must hold the escape byte too, as the compiler checks for a schema.

    Strict: behind the escape byte stands a transformed member of `of`, and elsewhere no member of
    `of` stands; the first byte that breaks this is a stuffing error. Lenient: any byte behind the
    escape byte is transformed back, and members of `of` other than the escape byte may stand for
    themselves; only an escape byte at the end of the region is an error.
    """

    __slots__ = ("_strict", "byte", "lenient", "of", "transform")

    byte: int
    of: frozenset[int]
    transform: EscapeTransform
    lenient: bool
    _strict: Substitution

    def __init__(
        self,
        byte: int,
        of: frozenset[int],
        transform: EscapeTransform = "none",
        lenient: bool = False,
    ) -> None:
        self._set(byte, of, transform, lenient)
        table = {member: bytes((byte, member ^ self._mask())) for member in of}
        object.__setattr__(self, "_strict", Substitution(table))

    def encode(self, data: bytes) -> bytes:
        """Return the data with every member of `of` escaped, and nothing else."""
        return self._strict.encode(data)

    def decode(self, region: bytes) -> bytes:
        """Return what the region stands for; else raise TransparencyError "stuffing"."""
        if not self.lenient:
            return self._strict.decode(region)
        mask = self._mask()
        return _escaped(self.byte).sub(lambda found: _unescape(found[0], mask), region)

    def decoder(self) -> Unstuffer:
        """Return a new decoder at the start of a region."""
        if self.lenient:
            return _LenientEscapeUnstuffer(self.byte, self._mask())
        return self._strict.decoder()

    def _mask(self) -> int:
        """Return what the byte behind the escape byte is exclusive-ored with, either way."""
        if isinstance(self.transform, int):
            return self.transform
        return 0xFF if self.transform == "invert" else 0


@cache
def _escaped(byte: int) -> re.Pattern[bytes]:
    """Return a pattern for the escape byte and the byte behind it, where there is one."""
    return re.compile(re.escape(_ONE_BYTE[byte]) + b".?", re.DOTALL)


def _unescape(sequence: bytes, mask: int) -> bytes:
    if len(sequence) == 1:
        raise _cut_sequence(sequence)
    return _ONE_BYTE[sequence[1] ^ mask]


class _LenientEscapeUnstuffer:
    __slots__ = ("_byte", "_escaped", "_mask")

    def __init__(self, byte: int, mask: int) -> None:
        self._byte = byte
        self._mask = mask
        self._escaped = False

    def push(self, byte: int) -> bytes:
        if self._escaped:
            self._escaped = False
            return _ONE_BYTE[byte ^ self._mask]
        if byte == self._byte:
            self._escaped = True
            return b""
        return _ONE_BYTE[byte]

    def finish(self) -> bytes:
        if self._escaped:
            raise _cut_sequence(_ONE_BYTE[self._byte])
        return b""


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
            return _decode_by_byte(self.decoder(), region)
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
            decoded = binascii.unhexlify(self._upper + _ONE_BYTE[byte])
            self._upper = b""
            return decoded
        self._upper = _ONE_BYTE[byte]
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
            return _decode_by_byte(self.decoder(), region)
        return data

    def decoder(self) -> Unstuffer:
        """Return a new decoder at the start of a region."""
        return _CobsUnstuffer(self.lenient)


def _groups(run: bytes) -> Iterator[bytes]:
    """Return the groups for bytes without a zero: full ones, then the rest, which may be empty."""
    for start in range(0, len(run) + 1, _FULL_GROUP):
        group = run[start : start + _FULL_GROUP]
        yield _ONE_BYTE[len(group) + 1] + group


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
            return _ONE_BYTE[byte]
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
