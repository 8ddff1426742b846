"""Parts of frames: what each item of a frame is, and the bits that it is made of."""

from __future__ import annotations

from collections.abc import Iterable

import msgspec

from protogen.model.checksums import ChecksumSpec
from protogen.model.origin import NOTHING, About
from protogen.model.sizes import SizeSet
from protogen.model.types import Integer, characters, codec

PartType = Integer
"""Type of a part that is a number: an integer of whole bytes, in wire order."""


class Part(msgspec.Struct, frozen=True, kw_only=True, cache_hash=True):
    """One item of a frame."""

    name: str
    about: About = NOTHING
    unprotected: str | None = None
    """The decision that accepts that these bytes can also occur inside the frame, or, of a first
    part that is no literal, that nothing marks the start."""

    @property
    def size(self) -> int:
        """Bytes before stuffing; 0 for the payload, whose size varies."""
        return 0

    @property
    def is_optional(self) -> bool:
        """True if the part is absent where the payload is empty."""
        return False


class LiteralPart(Part, frozen=True, kw_only=True):
    """Fixed bytes."""

    bytes: bytes

    @property
    def size(self) -> int:
        """Bytes before stuffing."""
        return len(self.bytes)


class TypedPart(Part, frozen=True, kw_only=True):
    """A part that is one integer."""

    type: PartType

    @property
    def size(self) -> int:
        """Bytes before stuffing."""
        return self.type.size

    def encode(self, value: int) -> bytes:
        """Bytes of a value, before stuffing; raises ValueError if the part can't hold it."""
        return codec(self.type).encode(value)

    def shown(self, value: int) -> int | str:
        """A value as people see it: characters where the part is a text."""
        return characters(self.type).text(value) if self.type.is_text else value

    def raw(self, value: int | str) -> int:
        """The number of a value as people see it; raises EncodeError if there is none."""
        return characters(self.type).number(value) if self.type.is_text else int(value)


class NumberPart(TypedPart, frozen=True, kw_only=True):
    """A number that is not worked out of other bytes."""

    least: int
    greatest: int
    """Bounds of the raw value, both included; of a text, those of each character, repeated."""

    @property
    def between(self) -> tuple[int, int] | None:
        """The least and the greatest character of a text; None where it may have any."""
        if not self.type.is_text or not self.is_bounded:
            return None
        mask = (1 << self.type.byte_bits) - 1
        return self.least & mask, self.greatest & mask

    @property
    def allowed(self) -> str:
        """The bounds in words."""
        if self.between is None:
            return f"{self.least} to {self.greatest}"
        return characters(self.type, self.between).allowed

    def holds(self, value: int) -> bool:
        """True if a value is in bounds: a text, if each of its characters is."""
        if self.between is None:
            return self.least <= value <= self.greatest
        return characters(self.type, self.between).holds(value)

    @property
    def is_bounded(self) -> bool:
        """True if the type has values that are out of bounds."""
        return (self.least, self.greatest) != (self.type.least, self.type.greatest)


class IdentityPart(NumberPart, frozen=True, kw_only=True):
    """Tells, alone or with others, which message the frame carries."""


class Teller(msgspec.Struct, frozen=True):
    """A number of frames that tells what frames behind them are."""

    message: str
    """The message that has it as a field; empty where it is a part of frames."""
    name: str

    @property
    def text(self) -> str:
        """The number as a schema names it."""
        return f"{self.message}.{self.name}" if self.message else self.name


class Telling(msgspec.Struct, frozen=True, kw_only=True):
    """How a receiver learns a number that is not sent: from its program, or from other frames."""

    place: int
    """Parts that stand in front of it."""
    default: int = 0
    """Value before a receiver is told one."""
    once: bool = False
    """True if what was told is that of one frame, and then the default is again."""
    set_by: tuple[Teller, ...] = ()
    """What tells it in frames that a receiver takes."""


class ToldIdentity(IdentityPart, frozen=True, kw_only=True):
    """An identity that is not sent: a receiver is told it."""

    telling: Telling

    @property
    def size(self) -> int:
        """Bytes before stuffing: none."""
        return 0


class LengthPart(NumberPart, frozen=True, kw_only=True):
    """The number of unstuffed bytes of some parts; it may count itself.

    Of several in one frame, each is bounded by what all of them allow.
    """

    counts: tuple[str, ...]
    over_wire: bool = False
    """True if it counts them as they are on the wire, stuffing included."""
    agrees_with: str | None = None
    """The first length of the frame, which decides where it ends, if this is another one."""


class ToldLength(LengthPart, frozen=True, kw_only=True):
    """A length that is not sent: a receiver is told it. It is the only one of its frame."""

    telling: Telling

    @property
    def size(self) -> int:
        """Bytes before stuffing: none."""
        return 0


ToldPart = ToldIdentity | ToldLength
"""A number that is not sent, and that a receiver is told."""


class CounterPart(NumberPart, frozen=True, kw_only=True):
    """Counts frames and wraps."""

    default: int | None = None


class ValuePart(NumberPart, frozen=True, kw_only=True):
    """A number that the caller gives and the receiver hands on."""

    default: int | None = None


class ChoicePart(ValuePart, frozen=True, kw_only=True):
    """One of several literals of one size: the caller chooses, and the receiver hands it on."""

    words: tuple[bytes, ...]
    """The literals, in the order of the schema."""

    @property
    def values(self) -> tuple[int, ...]:
        """The literals as numbers, in the same order."""
        return tuple(map(codec(self.type).decode, self.words))

    @property
    def between(self) -> None:
        """None: literals may have any characters."""

    @property
    def is_bounded(self) -> bool:
        """True, as receivers refuse whatever is none of the literals."""
        return True


BitsMember = IdentityPart | LengthPart | CounterPart | ValuePart
"""A part that is bits of another one."""


class FixedBits(msgspec.Struct, frozen=True, kw_only=True):
    """Bits of a part that have a name and are the same in each frame."""

    name: str
    about: About
    type: Integer
    value: int


class MirrorBits(TypedPart, frozen=True, kw_only=True):
    """Bits of a part that follow from a number in front of them, or in the same part."""

    of: NumberPart
    """That number, which has as many bits."""
    inverted: bool
    """True if each of them is the other one."""

    @property
    def flips(self) -> int:
        """What the number is XORed with."""
        return self.type.greatest if self.inverted else 0

    @property
    def meaning(self) -> str:
        """What the bits are, in words."""
        return f"{self.of.name} {'with all bits inverted' if self.inverted else 'again'}"

    def follows(self, number: int) -> int:
        """The bits that follow from a number."""
        return number ^ self.flips


class ChecksumPart(TypedPart, frozen=True, kw_only=True):
    """A checksum over other parts."""

    algorithm: ChecksumSpec
    covers: tuple[str, ...]
    over_wire: bool = False
    when_payload: bool = False
    """True if the part is absent where the payload is empty."""
    lowest: int = 0
    """The lowest bit of the result that it has, where it is some bits of a part."""

    @property
    def takes_all(self) -> bool:
        """True if it has all bits of the result."""
        return self.algorithm.width <= self.type.bits

    @property
    def taken(self) -> str:
        """The bits of the result that it has, in words; empty where it has all."""
        if self.takes_all:
            return ""
        highest = self.lowest + self.type.bits - 1
        return f"bit {highest}" if self.type.bits == 1 else f"bits {self.lowest}..{highest}"

    def due(self, result: int) -> int:
        """Its value, where the algorithm has this result."""
        return result if self.type.within is None else result >> self.lowest & self.type.greatest

    @property
    def is_optional(self) -> bool:
        """True if the part is absent where the payload is empty."""
        return self.when_payload


class BitsPart(TypedPart, frozen=True, kw_only=True):
    """A number whose bits are parts, or follow from others; all else is the same in each frame.

    A part that repeats or complements another one as a whole is one without members.
    """

    members: tuple[BitsMember, ...]
    """These parts, in the order of the schema."""
    fixed: int
    """The bits that are the same, as a number whose other bits are 0."""
    constants: tuple[FixedBits, ...] = ()
    """Those of them that have names, for readers."""
    mirrors: tuple[MirrorBits, ...] = ()
    """The bits that follow from others."""
    sums: tuple[ChecksumPart, ...] = ()
    """The bits that are a checksum, or some bits of one."""

    @property
    def mask(self) -> int:
        """The bits that are the same in each frame."""
        every = (1 << self.type.byte_bits * self.type.size) - 1
        return every & ~sum(place_mask(part.type) for part in varying_bits(self))

    @property
    def whole(self) -> MirrorBits | None:
        """What follows from a number, where the part as a whole does."""
        return next((item for item in self.mirrors if item.name == self.name), None)

    @property
    def has_identity(self) -> bool:
        """True if some of its bits tell which message the frame carries."""
        return any(isinstance(part, IdentityPart) for part in self.members)


def place_of(type_: Integer) -> int:
    """The lowest bit that an integer has in another one."""
    return 0 if type_.within is None else type_.within.low


def place_mask(type_: Integer) -> int:
    """The bits that a member of a part has among those of the part."""
    return ((1 << type_.bits) - 1) << place_of(type_)


class PayloadPart(Part, frozen=True, kw_only=True):
    """The message's fields."""

    kept: int | None = None
    """Bytes that stay, at least, where zeros at its end are left out; None where none are."""
    longest: int | None = None
    """Bytes of the longest one that a receiver cuts to those that it knows; None: it cuts none."""

    @property
    def is_trimmed(self) -> bool:
        """True if senders leave out zeros at its end, which receivers put there again."""
        return self.kept is not None

    @property
    def is_cut(self) -> bool:
        """True if receivers leave what is behind the bytes that they know."""
        return self.longest is not None

    @property
    def is_fitted(self) -> bool:
        """True if receivers fill payloads up, or cut them, to the size that the message has."""
        return self.is_trimmed or self.is_cut

    def carried(self, sizes: SizeSet, *, can_be_cut: bool) -> SizeSet:
        """The sizes in which a receiver takes the payloads of a message that has these itself.

        It leaves what is behind the fields of longer ones where these can be cut.
        """
        least = 0 if self.is_trimmed else sizes.least
        if self.longest is not None and can_be_cut:
            return SizeSet.between(least, max(self.longest, sizes.greatest))
        return SizeSet.between(0, sizes.greatest) if self.is_trimmed else sizes

    def sent(self, sizes: SizeSet) -> SizeSet:
        """The sizes in which an encoder sends them."""
        if self.kept is None:
            return sizes
        return SizeSet.between(min(self.kept, sizes.greatest), sizes.greatest)


class VirtualPart(TypedPart, frozen=True, kw_only=True):
    """A number that goes into the checksums that cover it, and is not sent."""

    place: int
    """Parts that stand in front of it."""
    default: int | None = None
    """Value in frames of messages that give none, and of unknown ones; None: those have none."""

    @property
    def size(self) -> int:
        """Bytes before stuffing: none."""
        return 0


UnsentPart = VirtualPart | ToldPart
"""A part that has no bytes on the wire."""


def members_of(part: Part) -> tuple[BitsMember, ...]:
    """The parts that are bits of this one."""
    return part.members if isinstance(part, BitsPart) else ()


def mirrors_of(part: Part) -> tuple[MirrorBits, ...]:
    """The bits of this part that follow from others."""
    return part.mirrors if isinstance(part, BitsPart) else ()


def checksums_of(part: Part) -> tuple[ChecksumPart, ...]:
    """The checksums that this part is, or that are bits of it."""
    if isinstance(part, BitsPart):
        return part.sums
    return (part,) if isinstance(part, ChecksumPart) else ()


def varying_bits(part: Part) -> tuple[TypedPart, ...]:
    """The bits of this part that vary."""
    return (*part.members, *part.mirrors, *part.sums) if isinstance(part, BitsPart) else ()


def written_apart(parts: Iterable[Part]) -> tuple[Part, ...]:
    """The parts in order, in place of those whose bits are parts these."""
    return tuple(item for part in parts for item in members_of(part) or (part,))
