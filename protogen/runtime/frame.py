"""What a generated module says about a frame: its parts in wire order, and how it is found.

Whatever needs analysis (what is protected, how large a frame can be) is worked out by the compiler
and only stated here.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from protogen.runtime.dataclass import dataclass
from protogen.runtime.number import Number

if TYPE_CHECKING:
    from protogen.runtime.checksum import Checksum
    from protogen.runtime.transparency import Transparency

# --- parts ------------------------------------------------------------------------------------


@dataclass(frozen=True, slots=True)
class LiteralPart:
    """Fixed bytes."""

    name: str
    value: bytes

    @property
    def size(self) -> int:
        """Bytes before any stuffing."""
        return len(self.value)


@dataclass(frozen=True, slots=True)
class NumberPart:
    """A part that is one integer."""

    name: str
    number: Number

    @property
    def size(self) -> int:
        """Bytes before any stuffing."""
        return self.number.size


@dataclass(frozen=True, slots=True)
class IdentityPart(NumberPart):
    """Tells, alone or with others, which message the frame carries."""


@dataclass(frozen=True, slots=True)
class LengthPart(NumberPart):
    """The number of bytes of the parts that it `counts`, before any stuffing.

    The payload is one of them; the length itself may be. `least` and `greatest` bound its value.
    """

    counts: tuple[str, ...]
    least: int
    greatest: int


@dataclass(frozen=True, slots=True)
class ValuePart(NumberPart):
    """A number that the caller gives, from `least` to `greatest`, and that a receiver hands on."""

    least: int
    greatest: int
    default: int | None = None


@dataclass(frozen=True, slots=True)
class CounterPart(ValuePart):
    """Counts frames from `default` or `least` on; behind `greatest` comes `least`."""


@dataclass(frozen=True, slots=True)
class PayloadPart:
    """The message's fields."""

    name: str = "payload"
    size: int = 0
    """The payload's bytes are not counted among those of the parts."""


@dataclass(frozen=True, slots=True)
class ChecksumPart(NumberPart):
    """A checksum of other parts: of their bytes before any stuffing, or as they are on the wire."""

    algorithm: Checksum
    covers: tuple[str, ...]
    over_wire: bool = False
    when_payload: bool = False
    """Absent where the payload is empty."""


Part = LiteralPart | IdentityPart | LengthPart | ValuePart | PayloadPart | ChecksumPart


# --- start and end ----------------------------------------------------------------------------


@dataclass(frozen=True, slots=True)
class StartLiteral:
    """A frame starts with these bytes. Protected: they occur nowhere else in a valid frame."""

    value: bytes
    protected: bool


@dataclass(frozen=True, slots=True)
class StartSet:
    """A frame starts with a byte from `least` to `greatest`.

    Protected: no other byte of a valid frame is one of them.
    """

    least: int
    greatest: int
    protected: bool


@dataclass(frozen=True, slots=True)
class AfterEnd:
    """A frame starts behind an end, or where the stream starts."""


@dataclass(frozen=True, slots=True)
class Anywhere:
    """Nothing marks the start: sizes and the checksum tell whether a frame starts at a byte."""


Start = StartLiteral | StartSet | AfterEnd | Anywhere


@dataclass(frozen=True, slots=True)
class End:
    """A frame ends with these bytes. Protected: they occur nowhere else in a valid frame."""

    value: bytes
    protected: bool


# --- the frame ----------------------------------------------------------------------------------


@dataclass(frozen=True, slots=True)
class FrameSpec:
    """The frame of one sender.

    `parts` are in wire order, one of them the payload. `stuffed` are those under `transparency`,
    which follow each other. `greatest` is the size on the wire, in bytes, that no frame exceeds;
    `least` that of the smallest. `greatest_payload` is the most that the payload can have.
    """

    parts: tuple[Part, ...]
    start: Start
    end: End | None
    least: int
    greatest: int
    greatest_payload: int
    transparency: Transparency | None = None
    stuffed: tuple[str, ...] = ()
    seven_bit: bool = False
    """Whether every payload byte has its most significant bit clear."""
    ambiguous_cut: bool = False
    """Whether an encoder has to check that a decoder ends the frame where it ends."""
