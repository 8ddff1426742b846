"""Transparency by sequences: of any bytes, or of an escape byte and the byte behind it."""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping
from functools import cache

from protogen.runtime.payload.number import BYTES
from protogen.runtime.transparency.regions import (
    EscapeTransform,
    TransparencyError,
    Unstuffer,
    cut_sequence,
    decode_by_byte,
    spelled,
)
from protogen.runtime.values import Frozen

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
        return decode_by_byte(self.decoder(), region) if data is None else data

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
        literals = {BYTES[byte]: BYTES[byte] for byte in range(256) if byte not in special}
        self._table = {BYTES[byte]: sequence for byte, sequence in table.items()}
        self._decoded = {sequence: BYTES[byte] for byte, sequence in table.items()}
        self._listed = _any_of(map(BYTES.__getitem__, table))
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
        held = self._held + BYTES[byte]
        decoded = self._codewords.get(held)
        if decoded is not None:
            self._held = b""
            return decoded
        if held not in self._prefixes:
            raise TransparencyError("stuffing", f"{spelled(held)} is no sequence and no plain byte")
        self._held = held
        return b""

    def finish(self) -> bytes:
        if self._held:
            raise cut_sequence(self._held)
        return b""


class _LenientSubstitutionUnstuffer(_SubstitutionUnstuffer):
    __slots__ = ()

    def push(self, byte: int) -> bytes:
        # What is held is shorter than the longest sequence, which bounds the work for a byte.
        self._held += BYTES[byte]
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
    return re.compile(re.escape(BYTES[byte]) + b".?", re.DOTALL)


def _unescape(sequence: bytes, mask: int) -> bytes:
    if len(sequence) == 1:
        raise cut_sequence(sequence)
    return BYTES[sequence[1] ^ mask]


class _LenientEscapeUnstuffer:
    __slots__ = ("_byte", "_escaped", "_mask")

    def __init__(self, byte: int, mask: int) -> None:
        self._byte = byte
        self._mask = mask
        self._escaped = False

    def push(self, byte: int) -> bytes:
        if self._escaped:
            self._escaped = False
            return BYTES[byte ^ self._mask]
        if byte == self._byte:
            self._escaped = True
            return b""
        return BYTES[byte]

    def finish(self) -> bytes:
        if self._escaped:
            raise cut_sequence(BYTES[self._byte])
        return b""
