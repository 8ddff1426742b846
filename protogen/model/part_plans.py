"""Plans of the parts of a frame that others hang on: checksums, lengths, stuffing, identities."""

from __future__ import annotations

import msgspec

from protogen.model.frame_places import Place, PlacedPart, Run
from protogen.model.identities import Identities
from protogen.model.messages import Message
from protogen.model.parts import ChecksumPart, LengthPart, VirtualPart
from protogen.model.sizes import SizeSet
from protogen.model.transparency import Base16, Encoding, Escape, Insertion


class ChecksumPlan(msgspec.Struct, frozen=True, kw_only=True):
    """A checksum part, where it lies, and what it runs over."""

    part: ChecksumPart
    placed: PlacedPart
    covers: tuple[Run | bytes | VirtualPart, ...]
    """Runs of content in order, neighbours joined; bytes stand for a literal of the end."""
    is_behind: bool
    """True if the checksum stands behind all that it runs over."""

    @property
    def virtual(self) -> tuple[VirtualPart, ...]:
        """The parts that it runs over and that are not sent.

        Each has a value that follows from the identity. Where an identity gives one of them none,
        no frame of it can be verified: it is refused as one with a wrong checksum is.
        """
        return tuple(item for item in self.covers if isinstance(item, VirtualPart))

    @property
    def over_stuffing(self) -> bool:
        """True if some of what it runs over is summed as it is stuffed."""
        return any(isinstance(run, Run) and run.over_stuffing for run in self.covers)

    def skipping(self, start: int) -> ChecksumPlan:
        """The same checksum of content whose first bytes, so many, are not counted."""
        covers = (item.skipping(start) if isinstance(item, Run) else item for item in self.covers)
        return msgspec.structs.replace(
            self, placed=self.placed.skipping(start), covers=tuple(covers)
        )


class VirtualPlan(msgspec.Struct, frozen=True, kw_only=True):
    """A part that is not sent, and its value for each identity."""

    part: VirtualPart
    values: tuple[tuple[Identities, int], ...]
    """Values by the identities of messages, also of those that a small receiver does not know."""

    @property
    def count(self) -> int:
        """Number of identities."""
        return sum(identities.count for identities, _ in self.values)


class CountedLength(msgspec.Struct, frozen=True, kw_only=True):
    """A length, and its value for a payload."""

    part: LengthPart
    base: int
    """Value for an empty payload."""
    optional: int
    """Bytes that it counts besides, where the payload is not empty."""
    region_end: int | None = None
    """Where it counts bytes on the wire: how many there are up to the end of what is stuffed, in a
    frame of the value `base`."""

    @property
    def greatest(self) -> int:
        """The greatest value that a receiver takes."""
        return self.part.greatest

    @property
    def is_further(self) -> bool:
        """True if another length decides where a frame ends."""
        return self.part.agrees_with is not None

    def counted(self, payload: int) -> int:
        """Value for a payload of that size."""
        return self.base + (payload + self.optional if payload else 0)


class LengthPlan(CountedLength, frozen=True, kw_only=True):
    """The length part: its value for a payload, and the payload's size for a value."""

    most: int | None = None
    """Where it counts bytes on the wire: the greatest value that a frame has."""

    @property
    def greatest(self) -> int:
        """The greatest value that a receiver takes."""
        return self.part.greatest if self.most is None else self.most

    @property
    def over_wire(self) -> bool:
        """True if it counts stuffed bytes, so that only their end tells the payload's size."""
        return self.region_end is not None

    def payload(self, value: int) -> int | None:
        """Size of the payload for a value; None if there is none."""
        if value == self.base:
            return 0
        size = value - self.base - self.optional
        return size if size > 0 else None


class FurtherLength(CountedLength, frozen=True, kw_only=True):
    """A length behind the first one of the frame, with which it has to agree."""

    placed: PlacedPart
    first: LengthPlan

    @property
    def more(self) -> int:
        """What it is more than the first length, where the payload is not empty."""
        return self.base + self.optional - self.first.base - self.first.optional

    @property
    def more_if_empty(self) -> int:
        """What it is more than the first length, where the payload is empty."""
        return self.base - self.first.base

    def skipping(self, start: int) -> FurtherLength:
        """The same length in content whose first bytes, so many, are not counted."""
        return msgspec.structs.replace(self, placed=self.placed.skipping(start))


class StuffedRegion(msgspec.Struct, frozen=True, kw_only=True):
    """The part of the content that is stuffed on the wire."""

    encoding: Encoding
    lenient: bool
    parts: tuple[str, ...]
    """Names of its parts in wire order."""
    first: Place
    end: Place
    before: int
    """Bytes of content in front of it, where the payload is not empty and behind it."""
    behind: int
    """Bytes of content behind it, where the payload is not empty and in front of them."""
    literals_in_front: bool
    """True if nothing but literals stands in front of it."""
    covers_payload: bool
    can_be_empty: bool
    """True if it holds nothing but the payload and parts that can be absent with it."""
    reaches_end: bool
    """True if it begins in front of the tail, is never empty, and only the end follows."""
    codes: tuple[tuple[int, bytes], ...]
    """Bytes, in order, and the sequences that stand for them; empty for Base16 and COBS."""

    @property
    def longest(self) -> int:
        """Wire bytes that one byte of content takes at most; 1 where several bytes tell."""
        if isinstance(self.encoding, Base16):
            return 2
        return max((len(sequence) for _, sequence in self.codes), default=1)

    @property
    def insertion(self) -> Insertion | None:
        """What puts in a byte behind others, if that is the encoding."""
        return self.encoding if isinstance(self.encoding, Insertion) else None

    @property
    def escape(self) -> Escape | None:
        """The escape, if that is the encoding."""
        return self.encoding if isinstance(self.encoding, Escape) else None

    def skipping(self, start: int) -> StuffedRegion:
        """The same region of content whose first bytes, so many, are not counted."""
        return msgspec.structs.replace(
            self,
            first=self.first.skipping(start),
            end=self.end.skipping(start),
            before=self.before - start,
        )


class IdentityGroup(msgspec.Struct, frozen=True, kw_only=True):
    """Messages that a receiver may find behind one identity: one, or more told apart by size."""

    identity: tuple[int, ...]
    """The identity, or that of several which stands for all."""
    key: int
    """Values of the identity parts as one number, the first part in its highest bits."""
    messages: tuple[Message, ...]
    sizes: tuple[SizeSet, ...]
    """Payload sizes of each of these messages, as frames carry them."""
    identities: Identities | None = None
    """Where there are several."""

    @property
    def told_by(self) -> Identities:
        """All identities that stand for these messages."""
        return self.identities or Identities.only(self.identity)

    @property
    def fixed(self) -> int | None:
        """Size of the payload, where no message has another one."""
        sizes = {item.fixed for item in self.sizes}
        return sizes.pop() if len(sizes) == 1 else None

    @property
    def own(self) -> int | None:
        """Size that receivers know of each of these messages; None: their fields say it."""
        sizes = {message.cut_size for message in self.messages}
        return sizes.pop() if len(sizes) == 1 else None

    @property
    def greatest(self) -> int:
        """Greatest payload of these messages in bytes."""
        return max(item.greatest for item in self.sizes)
