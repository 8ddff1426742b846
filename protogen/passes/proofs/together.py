"""Joint size of a stuffed checksum and the parts that it covers."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from functools import partial

from protogen.model.checksums import checksum_of
from protogen.model.frame import Frame
from protogen.model.parts import ChecksumPart, checksums_of
from protogen.passes.proofs.contents import Contents, checksum_bytes, has_virtual, number_bytes
from protogen.passes.proofs.correlation import (
    Place,
    added,
    exclusive_or,
    most_summed,
    most_tried,
)
from protogen.passes.proofs.wire_code import ByteSet

Price = Callable[[str, int], int]
"""Worth of a byte of a part."""

_MOST_PLACES = 2048
"""Bytes up to which it is followed which sums they can have."""
_MOST_TRIED = 256
"""Bytes up to which frames are tried."""
_TRIED_BYTES = 1 << 12
"""Bytes of frames that are tried, at most."""


class Together:
    """Asks it of the frames of one sender, at what `price` their bytes are."""

    def __init__(self, frame: Frame, price: Price) -> None:
        self._frame = frame
        self._price = price
        self._places: dict[tuple[str, ByteSet], Place] = {}
        self._worths: dict[str, list[int]] = {}

    def most(self, part: ChecksumPart, contents: Contents) -> int | None:
        """The most that a checksum and what it covers are worth; None where that takes too long.

        It is exact for sums and exclusive ors of bytes, and else where trying leads to it soon.
        What is covered and not sent lets a checksum be anything, for one message or another.
        """
        if has_virtual(self._frame, part):
            return None
        covered = [name for name in part.covers if name in contents]
        if any(self._is_open(name, contents) for name in covered):
            return None
        size = sum(stretch.count for name in covered for stretch in contents[name])
        summed = part.algorithm.is_folded_byte and not part.over_wire
        if size > (_MOST_PLACES if summed else _MOST_TRIED):
            return None
        if summed:
            return self._summed(part, self._all_places(covered, contents))
        return self._tried(part, covered, contents, _TRIED_BYTES // max(size, 1))

    def _is_open(self, name: str, contents: Contents) -> bool:
        """True if a covered part is a checksum that follows from yet other bytes."""
        known = all(stretch.known for stretch in contents[name])
        return bool(checksums_of(self._frame.part(name))) and not known

    def _all_places(self, covered: Sequence[str], contents: Contents) -> list[Place]:
        found: list[Place] = []
        for name in covered:
            for stretch in contents[name]:
                found.extend([self._place(name, stretch.values)] * stretch.count)
        return found

    def _place(self, name: str, values: ByteSet) -> Place:
        if (name, values) not in self._places:
            self._places[name, values] = Place.of(values, partial(self._price, name))
        return self._places[name, values]

    def _worth(self, part: ChecksumPart, data: bytes) -> int:
        return sum(self._price(part.name, byte) for byte in data)

    # -- sums -----------------------------------------------------------------------------------

    def _summed(self, part: ChecksumPart, places: list[Place]) -> int | None:
        if part.name not in self._worths:
            numbers = map(part.algorithm.result, range(256))
            self._worths[part.name] = [
                self._worth(part, number_bytes(part, number)) for number in numbers
            ]
        step = exclusive_or if part.algorithm.kind == "xor" else added
        return most_summed(places, step, self._worths[part.name], part.algorithm.init)

    # -- other checksums ------------------------------------------------------------------------

    def _tried(
        self, part: ChecksumPart, covered: Sequence[str], contents: Contents, tries: int
    ) -> int:
        bound = sum(self._place(part.name, item.values).top for item in contents[part.name])

        compute = checksum_of(part.algorithm).compute

        def checksum(data: bytes) -> int:
            if not part.over_wire:
                return self._worth(part, number_bytes(part, compute(data)))
            plain = dict(_split(covered, contents, data))
            return self._worth(part, checksum_bytes(self._frame, part, plain))

        return most_tried(self._all_places(covered, contents), checksum, bound, tries)


def _split(covered: Sequence[str], contents: Contents, data: bytes) -> Iterator[tuple[str, bytes]]:
    """The bytes of each covered part."""
    begin = 0
    for name in covered:
        end = begin + sum(stretch.count for stretch in contents[name])
        yield name, data[begin:end]
        begin = end
