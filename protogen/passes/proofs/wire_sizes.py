"""Sizes of frames on the wire, stuffing included.

Stuffed byte by byte, a frame takes what each of its bytes takes at best or at worst. The greatest
size is never too small and the least never too great, as a decoder relies on both. They are exact,
but where several stuffed checksums, or one wider than a byte, depend on many bytes, where one is
bits of a part, and where a byte is put in behind several others.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from functools import partial

from protogen.model.frame import Frame
from protogen.model.messages import Message
from protogen.model.parts import (
    ChecksumPart,
    LengthPart,
    Part,
    checksums_of,
    members_of,
    mirrors_of,
)
from protogen.model.sizes import SizeSet
from protogen.model.transparency import Base16, Cobs, Escape, Insertion
from protogen.model.types import Field
from protogen.passes.proofs.contents import Contents, Stretch, contents_of, payload_of
from protogen.passes.proofs.together import Together
from protogen.passes.proofs.wire_code import EVERY_BYTE, ByteSet, code_of

_COBS_BLOCK = 254


class WireSizes:
    """Sizes of one sender's frames; `payload` is what any byte of a payload can be."""

    def __init__(self, frame: Frame, payload: ByteSet) -> None:
        self._frame = frame
        self._payload = payload
        self._covered = frame.stuffed
        self._encoding = frame.encoding
        self._lenient = frame.transparency is not None and frame.transparency.lenient
        self._by_byte = None if self._adds else code_of(self._encoding)
        """The codeword of each byte; None where bytes are added to all of a region."""
        self._payload_name = frame.payload.name
        self._checksums = {sign: Together(frame, partial(self._price, sign)) for sign in (1, -1)}
        self._known: dict[tuple[ByteSet, int], int] = {}

    @property
    def _adds(self) -> bool:
        return isinstance(self._encoding, Cobs | Insertion)

    @property
    def overhead(self) -> SizeSet:
        """Bytes that are not payload, before stuffing."""
        fixed = sum(part.size for part in self._frame.parts)
        optional = sum(part.size for part in self._frame.checksums if part.when_payload)
        return SizeSet.between(fixed - optional, fixed, optional)

    def frame(self, payload: SizeSet) -> SizeSet:
        """Wire bytes of any frame with such a payload."""
        return self._sizes(payload, {}, ())

    def message(self, message: Message, payload: SizeSet) -> SizeSet:
        """Wire bytes of the frames of one message, whose identity is known."""
        identity = {
            part.name: message.identity[index]
            for index, part in enumerate(self._frame.identity)
            if not message.chooses(index)
        }
        return self._sizes(payload, identity, message.fields)

    def _sizes(
        self, payload: SizeSet, identity: Mapping[str, int], fields: tuple[Field, ...]
    ) -> SizeSet:
        optional = any(part.when_payload for part in self._frame.checksums)
        if self._encoding is None:
            least, greatest = map(self._plain, (payload.least, payload.greatest))
            return SizeSet.between(least, greatest, 1 if optional else payload.step)
        least = -self._most(payload, identity, fields, sign=-1)
        greatest = self._most(payload, identity, fields, sign=1)
        doubled = isinstance(self._encoding, Base16) and self._payload_name in self._covered
        step = payload.step * (1 + doubled) if isinstance(self._encoding, Base16) else 1
        return SizeSet.between(least, greatest, 1 if optional else step)

    def _plain(self, payload: int) -> int:
        """Bytes of a frame in which nothing is stuffed."""
        overhead = self.overhead
        return payload + (overhead.greatest if payload else overhead.least)

    # -- over all sizes of the payload ----------------------------------------------------------

    def _most(
        self,
        payload: SizeSet,
        identity: Mapping[str, int],
        fields: tuple[Field, ...],
        *,
        sign: int,
    ) -> int:
        """The greatest size, or with a sign of -1 the least one, less than nothing.

        It is nearly always that of the greatest or least payload. But what a length part states of
        it may be short where another size is long, so sizes near to it are asked for too.
        """
        sizes = payload.members(payload.least, payload.greatest)
        sizes = sizes[::-1] if sign > 0 else sizes
        first = self._contents(sizes[0], identity, fields)
        best = self._worth(first, sign)
        if self._by_byte is None:
            return best  # More data never take less.
        ceiling = self._ceiling(first, sign)
        for size in sizes[1:]:
            # Each byte that is farther off is worth as much less as a byte of the payload is.
            away = abs(size - sizes[0]) * abs(self._byte(self._payload_name, self._payload, sign))
            if best >= ceiling - away:
                break
            contents = self._contents(size, identity, fields)
            if best < self._apart(contents, sign):
                best = max(best, self._worth(contents, sign))
        return best

    def _ceiling(self, contents: Contents, sign: int) -> int:
        """Bound on the worth of a frame, whatever length and checksums it has."""
        free = [part.name for part in self._frame.parts if _follows(part)]
        most = sum(
            self._frame.part(name).size * self._byte(name, EVERY_BYTE, sign) for name in free
        )
        others = (item for item in contents.items() if item[0] not in free)
        return most + sum(self._part(name, stretches, sign) for name, stretches in others)

    def _contents(
        self, size: int, identity: Mapping[str, int], fields: tuple[Field, ...]
    ) -> Contents:
        payload = payload_of(fields, size, self._payload)
        return contents_of(self._frame, payload, identity)

    # -- of one size ----------------------------------------------------------------------------

    def _worth(self, contents: Contents, sign: int) -> int:
        depending = [part for part in self._frame.checksums if self._depends(part, contents)]
        if len(depending) == 1:
            return self._together(depending[0], contents, sign)
        return self._apart(contents, sign)

    def _apart(self, contents: Contents, sign: int) -> int:
        """Worth of the frame, if a checksum can be anything whatever it covers."""
        if self._by_byte is None:
            return sign * self._with_added(contents, worst=sign > 0)
        return sum(self._part(name, stretches, sign) for name, stretches in contents.items())

    def _part(self, name: str, stretches: Iterable[Stretch], sign: int) -> int:
        return sum(stretch.count * self._byte(name, stretch.values, sign) for stretch in stretches)

    def _byte(self, part: str, values: ByteSet, sign: int) -> int:
        """Greatest worth of a byte of a part, if it has one of these values."""
        if part not in self._covered:
            return sign
        key = values, sign
        if key not in self._known:
            self._known[key] = max(self._value(value, sign) for value in values)
        return self._known[key]

    def _value(self, value: int, sign: int) -> int:
        """Worth of a stuffed byte: a lenient decoder also takes needless escapes."""
        assert self._by_byte is not None
        needless = self._lenient and isinstance(self._encoding, Escape) and sign > 0
        return 2 if needless else sign * len(self._by_byte[value])

    # -- checksums ------------------------------------------------------------------------------

    def _depends(self, part: ChecksumPart, contents: Contents) -> bool:
        """True if the size of a checksum varies with what it covers."""
        if part.name not in self._covered or self._by_byte is None:
            return False
        return any(
            self._byte(part.name, stretch.values, 1) != -self._byte(part.name, stretch.values, -1)
            for stretch in contents.get(part.name, ())
        )

    def _together(self, part: ChecksumPart, contents: Contents, sign: int) -> int:
        """Worth of the frame, where the checksum is that of the bytes."""
        found = self._checksums[sign].most(part, contents)
        parts = {part.name, *part.covers} if found is not None else set()
        others = (item for item in contents.items() if item[0] not in parts)
        return (found or 0) + sum(self._part(name, each, sign) for name, each in others)

    def _price(self, sign: int, part: str, value: int) -> int:
        return self._value(value, sign) if part in self._covered else sign

    # -- bytes that are added ---------------------------------------------------------------------

    def _with_added(self, contents: Contents, *, worst: bool) -> int:
        sizes = {name: sum(s.count for s in stretches) for name, stretches in contents.items()}
        covered = self._covered & sizes.keys()
        inside = sum(sizes[name] for name in covered)
        if isinstance(self._encoding, Insertion):
            return sum(sizes.values()) + worst * (inside // len(self._encoding.sequence))
        return sum(sizes.values()) + (self._codes(inside, worst=worst) if covered else 0)

    def _codes(self, inside: int, *, worst: bool) -> int:
        """Code bytes. Where no data are, a lenient decoder takes none; and one that is needless."""
        if not worst:
            return 0 if self._lenient and not inside else 1
        return 1 + inside // _COBS_BLOCK if self._lenient else max(1, -(-inside // _COBS_BLOCK))


def _follows(part: Part) -> bool:
    """True if a part, or some bits of it, follow from the payload and its size."""
    of = (mirror.of for mirror in mirrors_of(part))
    numbers = (part, *members_of(part), *of)
    return bool(checksums_of(part)) or any(isinstance(item, LengthPart) for item in numbers)
