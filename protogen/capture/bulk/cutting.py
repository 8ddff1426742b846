"""Where frames stand in bytes, if all is in order: what `fast/cutting.py` prints, for all at once.

A place that is none costs nothing but time, and so does one that is missing.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING

from protogen.capture.arrays import numpy
from protogen.capture.bulk.numbers import integers
from protogen.capture.bulk.places import (
    literal_places,
    next_from,
    overlaps_itself,
    set_places,
    stands,
    windows,
)
from protogen.model.framing import AfterEnd, StartLiteral, StartSet
from protogen.targets.python.fast.frames import FastFrame

if TYPE_CHECKING:
    from protogen.capture.tables import Rows
    from protogen.model.frame import NumberPart


@dataclass(frozen=True, slots=True)
class Span:
    """Frames in ascending order: their first bytes, and the places behind them."""

    at: Rows
    end: Rows

    def only(self, mask: Rows) -> Span:
        """Those that the mask tells."""
        return self if mask.all() else Span(self.at[mask], self.end[mask])


class Identities:
    """What identities are looked up in: a number for each kin of a sender."""

    def __init__(self, frame: FastFrame) -> None:
        self._parts = frame.identity
        keys = [self._key(kin.identity) for kin in frame.kins]
        order = sorted(range(len(keys)), key=keys.__getitem__)
        self._order = numpy().array(order, "i8")
        self._keys = numpy().array([keys[index] for index in order], "u8")

    @staticmethod
    def are_few(frame: FastFrame) -> bool:
        """Whether a number of 64 bits tells all identities apart."""
        return sum(part.type.bits for part in frame.identity) <= 63

    def _key(self, identity: tuple[int, ...]) -> int:
        key = 0
        for part, value in zip(self._parts, identity, strict=True):
            key = key << part.type.bits | value & ((1 << part.type.bits) - 1)
        return key

    def look_up(self, numbers: tuple[Rows, ...], count: int) -> Rows:
        """The kin of each of so many frames, by the values of the parts; -1: unknown."""
        keys = numpy().zeros(count, "u8")
        for part, values in zip(self._parts, numbers, strict=True):
            bits = values.astype("i8").view("u8") & numpy().uint64((1 << part.type.bits) - 1)
            keys = keys << numpy().uint64(part.type.bits) | bits
        if not len(self._keys):
            return numpy().full(count, -1)  # type: ignore[no-any-return]
        index = numpy().searchsorted(self._keys, keys).clip(max=len(self._keys) - 1)
        found: Rows = numpy().where(self._keys[index] == keys, self._order[index], -1)
        return found


class Cutting:
    """Finds the frames of one sender."""

    def __init__(self, frame: FastFrame) -> None:
        self.frame = frame
        self.identities = Identities(frame)
        self._kin_sizes = numpy().array(
            [*(-1 if kin.fixed is None else kin.fixed for kin in frame.kins), -1], "i8"
        )
        """The payload's size by the number of a kin; -1 where it varies, and at the end."""

    @staticmethod
    def can_cut(frame: FastFrame) -> bool:
        """Whether frames can be found so."""
        literals = [frame.end, frame.start_bytes]
        return (
            frame.can_cut
            and Identities.are_few(frame)
            and not any(overlaps_itself(literal) for literal in literals if literal)
        )

    def frames(self, octets: Rows, first: int) -> Span:
        """The frames from the byte `first` on."""
        return _Search(self, octets, first).frames()

    def payload_sizes(self, kins: Rows) -> Rows:
        """The payload's size of each kin; -1 where it varies or is not known."""
        found: Rows = self._kin_sizes[kins]
        return found


class _Search:
    """Looks for frames in some bytes."""

    def __init__(self, cutting: Cutting, octets: Rows, first: int) -> None:
        self._cutting = cutting
        self._frame = cutting.frame
        self._octets = octets
        self._first = first

    def frames(self) -> Span:
        found = self._placed()
        size = found.end - found.at + (len(self._frame.start_bytes) if self._frame.shares else 0)
        fits = (found.end > found.at) & (found.end <= len(self._octets))
        return found.only(fits & (size <= self._frame.framing.greatest))

    def _placed(self) -> Span:
        frame = self._frame
        if frame.shares:
            return self._between_shared()
        if frame.ended_by == "end":
            return self._without_start_inside(self._until_ends())
        if frame.ended_by == "start":
            return Span(self._starts[:-1], self._starts[1:])
        return self._without_start_inside(self._sized())

    @cached_property
    def _starts(self) -> Rows:
        """Where frames may start."""
        start = self._frame.start
        if isinstance(start, StartLiteral):
            found = literal_places(self._octets, start.bytes)
        elif isinstance(start, StartSet):
            found = set_places(self._octets, start.least, start.greatest)
        else:
            behind = self._ends[self._ends > self._first]
            return numpy().concatenate(([self._first], behind))  # type: ignore[no-any-return]
        return found[numpy().searchsorted(found, self._first) :]

    @cached_property
    def _ends(self) -> Rows:
        """The places behind ends."""
        found = literal_places(self._octets, self._frame.end) + len(self._frame.end)
        return found[numpy().searchsorted(found, self._first) :]

    # --- between delimiters -----------------------------------------------------------------------

    def _until_ends(self) -> Span:
        """From the first start behind an end up to the next end."""
        ends, size = self._ends, len(self._octets)
        before = numpy().concatenate(([self._first], ends))[: len(ends)]
        starts = before if isinstance(self._frame.start, AfterEnd) else self._from_start(before)
        room = len(self._frame.start_bytes) + len(self._frame.end)
        return Span(starts, ends).only((starts < size) & (ends - starts >= room))

    def _from_start(self, before: Rows) -> Rows:
        return next_from(self._starts, before, len(self._octets))

    def _between_shared(self) -> Span:
        """Between two delimiters; that in front belongs to the frame before, if there is one."""
        size = len(self._frame.end)
        ends = self._ends
        if len(ends) < 2:
            return Span(ends[:0], ends[:0])
        holds = numpy().diff(ends) > size
        taken = numpy().concatenate(([False], holds[:-1]))
        starts = numpy().where(taken, ends[:-1], ends[:-1] - size)
        return Span(starts, ends[1:]).only(holds)

    def _without_start_inside(self, found: Span) -> Span:
        """A start that can't occur inside of a frame ends it where it stands."""
        start = self._frame.start
        if not isinstance(start, StartLiteral | StartSet) or not start.protected:
            return found
        behind = next_from(self._starts, found.at + 1, len(self._octets))
        return found.only(behind >= found.end)

    # --- sizes ------------------------------------------------------------------------------------

    def _sized(self) -> Span:
        """Where the head says how large a frame is."""
        frame, octets = self._frame, self._octets
        starts = self._starts[self._starts <= len(octets) - max(1, frame.head_size)]
        sized = self._by_length(starts) if frame.length is not None else self._by_kind(starts)
        found = sized.only((sized.end > sized.at) & (sized.end <= len(octets)))
        if frame.end:
            found = found.only(stands(octets, found.end - len(frame.end), frame.end))
        if isinstance(frame.start, AfterEnd):
            found = found.only(~stands(octets, found.at, frame.end))
        elif frame.start.protected:  # type: ignore[union-attr]
            return found
        return _chained(found)

    def _number(self, part: NumberPart, starts: Rows) -> Rows:
        """A part of the head, whatever its padding is."""
        first = starts + self._frame.offset(part) + self._frame.skipped
        return integers(windows(self._octets, first, part.type.size), part.type)[0]

    def _by_length(self, starts: Rows) -> Span:
        frame, length = self._frame, self._frame.length
        assert length is not None
        # A length of 64 bits that is too great becomes negative, or ends far behind the data.
        number = self._number(length, starts).astype("i8").clip(-1, len(self._octets))
        count = number - frame.counted(length)
        around = frame.head_size + frame.tail_size + len(frame.end)
        end = starts + count + around
        if frame.optional:
            is_empty = count == -frame.counted_optional(length)
            end = numpy().where(is_empty, starts + around - frame.optional_size, end)
            return Span(starts, end).only(is_empty | (count > 0))
        return Span(starts, end).only(count >= 0)

    def _by_kind(self, starts: Rows) -> Span:
        frame = self._frame
        numbers = tuple(self._number(part, starts) for part in frame.identity)
        kins = self._cutting.identities.look_up(numbers, len(starts))
        starts, kins = starts[kins >= 0], kins[kins >= 0]
        sizes = self._cutting.payload_sizes(kins)
        around = frame.head_size + frame.tail_size + len(frame.end)
        end = starts + sizes + around
        if frame.optional:
            end -= frame.optional_size * (sizes == 0)
        if frame.has_open_kinds:
            behind = numpy().zeros_like(end)
            if frame.end:
                bounds = starts + frame.head_size + len(frame.end)
                behind = next_from(self._ends, bounds, 0)
            end = numpy().where(sizes < 0, behind, end)
        return Span(starts, end)


def _chained(found: Span) -> Span:
    """Frames behind one another: from each on, the next is that which starts where it ends.

    Where none does, the chain goes on with the next that there is.
    """
    if (found.end[:-1] <= found.at[1:]).all():
        return found
    following = numpy().searchsorted(found.at, found.end).tolist()
    places, place = [], 0
    while place < len(following):
        places.append(place)
        place = following[place]
    return Span(found.at[places], found.end[places])
