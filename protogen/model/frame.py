"""Frames: parts in wire order, and what keeps delimiters out of them."""

from __future__ import annotations

from dataclasses import dataclass

from protogen.model.checksums import ChecksumSpec
from protogen.model.origin import NOTHING, About
from protogen.model.types import Integer
from protogen.runtime.number import Number

PartType = Integer
"""Type of a part that is a number: an integer of whole bytes, in wire order."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Part:
    """One item of a frame."""

    name: str
    about: About = NOTHING

    @property
    def size(self) -> int:
        """Bytes before stuffing; 0 for the payload, whose size varies."""
        return 0

    @property
    def is_optional(self) -> bool:
        """True if the part is absent where the payload is empty."""
        return False


@dataclass(frozen=True, slots=True, kw_only=True)
class LiteralPart(Part):
    """Fixed bytes."""

    bytes: bytes
    unprotected: str | None = None
    """The decision that accepts that the bytes can also occur inside the frame."""

    @property
    def size(self) -> int:
        """Bytes before stuffing."""
        return len(self.bytes)


@dataclass(frozen=True, slots=True, kw_only=True)
class NumberPart(Part):
    """A part that is one integer."""

    type: PartType
    least: int
    greatest: int
    """Bounds of the raw value, both included."""

    @property
    def size(self) -> int:
        """Bytes before stuffing."""
        return self.type.size

    def encode(self, value: int) -> bytes:
        """Bytes of a value, before stuffing; raises ValueError if the part can't hold it."""
        kind = self.type
        seven_bit = kind.byte_bits == 7
        return Number(kind.bits, kind.signed, kind.byte_order, seven_bit).encode(value)


@dataclass(frozen=True, slots=True, kw_only=True)
class IdentityPart(NumberPart):
    """Tells, alone or with others, which message the frame carries."""


@dataclass(frozen=True, slots=True, kw_only=True)
class LengthPart(NumberPart):
    """The number of unstuffed bytes of some parts; it may count itself."""

    counts: tuple[str, ...]


@dataclass(frozen=True, slots=True, kw_only=True)
class CounterPart(NumberPart):
    """Counts frames and wraps."""

    default: int | None = None


@dataclass(frozen=True, slots=True, kw_only=True)
class ValuePart(NumberPart):
    """A number that the caller gives and the receiver hands on."""

    default: int | None = None


@dataclass(frozen=True, slots=True, kw_only=True)
class PayloadPart(Part):
    """The message's fields."""


@dataclass(frozen=True, slots=True, kw_only=True)
class ChecksumPart(Part):
    """A checksum over other parts."""

    type: PartType
    algorithm: ChecksumSpec
    covers: tuple[str, ...]
    over_wire: bool = False
    when_payload: bool = False
    """True if the part is absent where the payload is empty."""

    @property
    def size(self) -> int:
        """Bytes before stuffing."""
        return self.type.size

    @property
    def is_optional(self) -> bool:
        """True if the part is absent where the payload is empty."""
        return self.when_payload


@dataclass(frozen=True, slots=True, kw_only=True)
class Substitution:
    """Each listed byte is replaced by a sequence."""

    table: tuple[tuple[int, bytes], ...]


@dataclass(frozen=True, slots=True, kw_only=True)
class Escape:
    """A byte of `of` is written as the escape byte and itself XOR `xor` (0xFF inverts it)."""

    byte: int
    of: tuple[int, ...]
    xor: int


@dataclass(frozen=True, slots=True, kw_only=True)
class Base16:
    """Two upper-case hex digits a byte."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Cobs:
    """Consistent overhead byte stuffing: the region holds no zero byte."""


Encoding = Substitution | Escape | Base16 | Cobs


@dataclass(frozen=True, slots=True, kw_only=True)
class Transparency:
    """Encoding that keeps delimiters out of the parts `first` to `last`."""

    first: str
    last: str
    encoding: Encoding
    preset: str | None = None
    lenient: bool = False
    about: About = NOTHING


@dataclass(frozen=True, slots=True, kw_only=True)
class Frame:
    """Parts in wire order, exactly one of which is the payload."""

    parts: tuple[Part, ...]
    transparency: Transparency | None = None

    def part(self, name: str) -> Part:
        """The part called `name`; raises KeyError."""
        for part in self.parts:
            if part.name == name:
                return part
        raise KeyError(name)

    @property
    def identity(self) -> tuple[IdentityPart, ...]:
        """The identity parts in wire order."""
        return tuple(part for part in self.parts if isinstance(part, IdentityPart))

    @property
    def length(self) -> LengthPart | None:
        """The length part, if there is one."""
        return next((part for part in self.parts if isinstance(part, LengthPart)), None)

    @property
    def checksums(self) -> tuple[ChecksumPart, ...]:
        """The checksum parts in wire order."""
        return tuple(part for part in self.parts if isinstance(part, ChecksumPart))

    @property
    def caller_parts(self) -> tuple[CounterPart | ValuePart, ...]:
        """The parts whose values come from the caller."""
        return tuple(part for part in self.parts if isinstance(part, CounterPart | ValuePart))
