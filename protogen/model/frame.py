"""Frames: parts in wire order, one of which is the payload."""

from __future__ import annotations

from fractions import Fraction
from functools import cached_property
from math import ceil, floor, log10

import msgspec

from protogen.model.origin import NOTHING, About
from protogen.model.parts import (
    ChecksumPart,
    CounterPart,
    IdentityPart,
    LengthPart,
    MirrorBits,
    Part,
    PayloadPart,
    ToldIdentity,
    ToldLength,
    ToldPart,
    UnsentPart,
    ValuePart,
    VirtualPart,
    checksums_of,
    mirrors_of,
    varying_bits,
    written_apart,
)
from protogen.model.transparency import Cobs, Encoding, Transparency


class Silence(msgspec.Struct, frozen=True, kw_only=True):
    """Silence of the line behind the last byte of a frame, which alone ends it."""

    name: str
    seconds: Fraction
    about: About = NOTHING

    @property
    def microseconds(self) -> int:
        """Whole microseconds that are no less."""
        return ceil(self.seconds * 1_000_000)

    @property
    def text(self) -> str:
        """The time for people, to three digits: `3.65 ms`."""
        milliseconds = self.seconds * 1000
        digits = max(0, 2 - floor(log10(milliseconds)))
        shown = f"{float(milliseconds):.{digits}f}"
        return f"{shown.rstrip('0').rstrip('.') if '.' in shown else shown} ms"


class Frame(msgspec.Struct, frozen=True, kw_only=True, dict=True, cache_hash=True):
    """Parts in wire order, exactly one of which is the payload."""

    parts: tuple[Part, ...]
    virtual: tuple[VirtualPart, ...] = ()
    """The parts that go into checksums and are not sent."""
    told: tuple[ToldPart, ...] = ()
    """The parts that receivers are told, and that are not sent."""
    transparency: Transparency | None = None
    limit: int | None = None
    """Wire bytes that no frame exceeds, where the schema bounds them."""
    silence: Silence | None = None
    """The silence that ends a frame, where nothing else does."""

    @cached_property
    def declared(self) -> tuple[Part, ...]:
        """All parts in the order of the schema, those that are not sent among them."""
        places: list[tuple[int, UnsentPart]] = [
            *((part.place, part) for part in self.virtual),
            *((part.telling.place, part) for part in self.told),
        ]
        found: list[Part] = []
        for index, part in enumerate(self.parts):
            found += [item for place, item in places if place == index]
            found.append(part)
        return (*found, *(item for place, item in places if place >= len(self.parts)))

    def virtual_part(self, name: str) -> VirtualPart | None:
        """The part of that name that is not sent; None if there is none."""
        return next((part for part in self.virtual if part.name == name), None)

    def part(self, name: str) -> Part:
        """The part called `name`, of those that are sent; raises KeyError."""
        for part in self.parts:
            if part.name == name:
                return part
        raise KeyError(name)

    @cached_property
    def payload(self) -> PayloadPart:
        """The payload."""
        return next(part for part in self.parts if isinstance(part, PayloadPart))

    @cached_property
    def head(self) -> tuple[Part, ...]:
        """The parts in front of the payload."""
        return self.parts[: self.parts.index(self.payload)]

    @cached_property
    def tail(self) -> tuple[Part, ...]:
        """The parts behind the payload, the end literal included."""
        return self.parts[self.parts.index(self.payload) + 1 :]

    @property
    def encoding(self) -> Encoding | None:
        """Encoding of the stuffed parts; None where nothing is stuffed."""
        return None if self.transparency is None else self.transparency.encoding

    @cached_property
    def stuffed(self) -> frozenset[str]:
        """Names of the parts under transparency."""
        if self.transparency is None:
            return frozenset()
        names = [part.name for part in self.parts]
        first, last = map(names.index, (self.transparency.first, self.transparency.last))
        return frozenset(names[first : last + 1])

    @property
    def code_size(self) -> int:
        """Bytes that the encoding puts in front of its region, whatever that holds.

        COBS puts its first code byte there. The others stand in the places of zeros, except that a
        further one stands behind each `FULL_GROUP` bytes without a zero.
        """
        return int(isinstance(self.encoding, Cobs))

    @cached_property
    def identity(self) -> tuple[IdentityPart, ...]:
        """The identity parts: those that receivers are told, and the others in wire order."""
        return (*self.told_identity, *self.sent_identity)

    @cached_property
    def told_identity(self) -> tuple[ToldIdentity, ...]:
        """The identity parts that receivers are told."""
        return tuple(part for part in self.told if isinstance(part, ToldIdentity))

    @cached_property
    def sent_identity(self) -> tuple[IdentityPart, ...]:
        """The identity parts that are sent, in wire order."""
        return tuple(part for part in self.numbers if isinstance(part, IdentityPart))

    @cached_property
    def numbers(self) -> tuple[Part, ...]:
        """All parts in wire order, in place of those whose bits are parts these."""
        return written_apart(self.parts)

    @cached_property
    def identity_is_early(self) -> bool:
        """True if nothing of the identity stands behind the payload."""
        return set(self.sent_identity) <= set(written_apart(self.head))

    def is_known_early(self, name: str) -> bool:
        """True if the number of that name is known when the payload begins."""
        return any(part.name == name for part in (*self.told, *written_apart(self.head)))

    def holder(self, name: str) -> Part:
        """The part of that name, or the one that has it among its bits; raises KeyError."""
        for part in self.parts:
            if part.name == name or any(item.name == name for item in varying_bits(part)):
                return part
        raise KeyError(name)

    @cached_property
    def mirrors(self) -> tuple[MirrorBits, ...]:
        """The bits that follow from others, in wire order of the parts that have them."""
        return tuple(item for part in self.parts for item in mirrors_of(part))

    def key(self, identity: tuple[int, ...]) -> int:
        """Values of the identity parts as one number, the first part in its highest bits."""
        key = 0
        for part, value in zip(self.identity, identity, strict=True):
            key = key << part.type.bits | value
        return key

    @property
    def length_over_wire(self) -> bool:
        """True if a length counts bytes as they are on the wire."""
        return self.length is not None and self.length.over_wire

    @cached_property
    def lengths(self) -> tuple[LengthPart, ...]:
        """The length that receivers are told, or those that are sent, in wire order."""
        numbers = (*self.told, *self.numbers)
        return tuple(part for part in numbers if isinstance(part, LengthPart))

    @property
    def length(self) -> LengthPart | None:
        """The length that decides where the frame ends, if there is one: the first."""
        return self.lengths[0] if self.lengths else None

    @property
    def told_length(self) -> ToldLength | None:
        """The length that receivers are told, if there is one."""
        return next((part for part in self.told if isinstance(part, ToldLength)), None)

    @cached_property
    def checksums(self) -> tuple[ChecksumPart, ...]:
        """The checksum parts in wire order."""
        return tuple(item for part in self.parts for item in checksums_of(part))

    @property
    def shown_parts(self) -> tuple[IdentityPart | CounterPart | ValuePart, ...]:
        """The parts that events show."""
        kinds = IdentityPart | CounterPart | ValuePart
        return (*self.told_identity, *(part for part in self.numbers if isinstance(part, kinds)))

    @cached_property
    def caller_parts(self) -> tuple[CounterPart | ValuePart, ...]:
        """The parts whose values come from the caller."""
        return tuple(part for part in self.numbers if isinstance(part, CounterPart | ValuePart))
