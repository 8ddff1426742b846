"""Transparency by a byte that is put in behind each sequence of some others."""

from __future__ import annotations

from protogen.runtime.payload.number import BYTES
from protogen.runtime.transparency.regions import (
    TransparencyError,
    Unstuffer,
    cut_sequence,
    decode_by_byte,
    spelled,
)
from protogen.runtime.values import Frozen


class Insertion(Frozen):
    """Behind each `sequence` of two bytes or more, `byte` is put in.

    No end of the sequence, and none of it with the byte, may be a beginning of it, as the compiler
    checks for a schema: so sequences do not overlap.

    Strict: where the sequence stands, the byte must follow; any other byte is a stuffing error.
    """

    __slots__ = ("_following", "_stuffed", "byte", "sequence")

    sequence: bytes
    byte: int
    _stuffed: bytes
    _following: tuple[dict[int, int], ...]

    def __init__(self, sequence: bytes, byte: int) -> None:
        self._set(sequence, byte)
        object.__setattr__(self, "_stuffed", sequence + BYTES[byte])
        object.__setattr__(self, "_following", followed(sequence))

    def __hash__(self) -> int:
        return hash((self.sequence, self.byte))

    @property
    def lenient(self) -> bool:
        """False: what is stuffed has one spelling."""
        return False

    def encode(self, data: bytes) -> bytes:
        """Return the data with the byte behind every sequence."""
        return data.replace(self.sequence, self._stuffed)

    def decode(self, region: bytes) -> bytes:
        """Return what the region stands for; else raise TransparencyError "stuffing"."""
        data = region.replace(self._stuffed, self.sequence)
        if data.replace(self.sequence, self._stuffed) == region:
            return data
        return decode_by_byte(self.decoder(), region)

    def decoder(self) -> Unstuffer:
        """Return a new decoder at the start of a region."""
        return _InsertionUnstuffer(self.sequence, self.byte, self._following)


def followed(sequence: bytes) -> tuple[dict[int, int], ...]:
    """How much of a sequence is seen behind so much of it and a byte; nothing for bytes left out.

    This is the automaton of Knuth, Morris and Pratt, without the state where all of it was seen.
    """
    found: list[dict[int, int]] = []
    for size in range(len(sequence)):
        found.append({})
        for byte in dict.fromkeys(sequence):
            seen = sequence[:size] + BYTES[byte]
            sizes = range(len(seen), 0, -1)
            longest = next((n for n in sizes if seen.endswith(sequence[:n])), 0)
            if longest:
                found[-1][byte] = longest
    return tuple(found)


class _InsertionUnstuffer:
    """Holds the last byte of each sequence until the byte behind it is there."""

    __slots__ = ("_byte", "_following", "_seen", "_sequence")

    def __init__(self, sequence: bytes, byte: int, following: tuple[dict[int, int], ...]) -> None:
        self._sequence = sequence
        self._byte = byte
        self._following = following
        self._seen = 0

    def push(self, byte: int) -> bytes:
        if self._seen == len(self._sequence):
            if byte != self._byte:
                held = self._sequence + BYTES[byte]
                raise TransparencyError("stuffing", f"{spelled(held)} is never sent")
            self._seen = 0
            return self._sequence[-1:]
        self._seen = self._following[self._seen].get(byte, 0)
        return b"" if self._seen == len(self._sequence) else BYTES[byte]

    def finish(self) -> bytes:
        if self._seen == len(self._sequence):
            raise cut_sequence(self._sequence)
        return b""
