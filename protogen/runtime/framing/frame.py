"""Declaration of a frame in a generated module: its parts in wire order, its start and end.

Whatever needs analysis (what is protected, how large a frame can be) is worked out by the compiler
and only stated here.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import NamedTuple

from protogen.runtime.checksum import Checksum
from protogen.runtime.errors import ByteError, EncodeError
from protogen.runtime.identities import Identities, Identity
from protogen.runtime.payload.number import BitsNumber, Characters, Number
from protogen.runtime.payload.numerals import Numeral
from protogen.runtime.transparency import Transparency
from protogen.runtime.values import Frozen

# --- parts ------------------------------------------------------------------------------------


class LiteralPart(NamedTuple):
    """Fixed bytes."""

    name: str
    value: bytes

    @property
    def size(self) -> int:
        """Bytes before any stuffing."""
        return len(self.value)


class IdentityPart(NamedTuple):
    """Tells, alone or with others, which message the frame carries."""

    name: str
    number: Number | Numeral

    @property
    def size(self) -> int:
        """Bytes before any stuffing."""
        return self.number.size


class LengthPart(NamedTuple):
    """The number of bytes of the parts that it `counts`, before any stuffing or on the wire.

    The payload is one of them; the length itself may be. `least` and `greatest` bound its value.
    On the wire, it counts all parts that are stuffed, and stands in front of them. Of several in
    one frame, the first tells where it ends; the others are for the same payload.
    """

    name: str
    number: Number | Numeral
    counts: tuple[str, ...]
    least: int
    greatest: int
    over_wire: bool = False

    @property
    def size(self) -> int:
        """Bytes before any stuffing."""
        return self.number.size


class ToldPart(NamedTuple):
    """A part that is not sent: a receiver is told it. It is an identity, or a `length`.

    `default` is its value before. `once`: what was told holds for one frame. `set_by` are the
    numbers of frames that tell it: those of a part, which have no message, or of its field.
    """

    name: str
    number: Number
    default: int = 0
    once: bool = False
    set_by: tuple[tuple[str, str], ...] = ()
    """Name of a part and nothing, or of a message and a field."""
    length: LengthPart | None = None


class ValuePart(NamedTuple):
    """A number that the caller gives, from `least` to `greatest`, and that a receiver hands on.

    With `values`, it is one of these: a literal of which there are several.
    """

    name: str
    number: Number | Numeral
    least: int
    greatest: int
    default: int | None = None
    values: tuple[int, ...] = ()

    @property
    def size(self) -> int:
        """Bytes before any stuffing."""
        return self.number.size

    @property
    def holds_all(self) -> bool:
        """True if each number of its bits is one that the part can have."""
        number = self.number
        if self.values or isinstance(number, Characters) or not isinstance(number, Number):
            return False
        return self.least <= number.least and number.greatest <= self.greatest

    def holds(self, value: int) -> bool:
        """True if the value is one that the part can have."""
        if self.values:
            return value in self.values
        number = self.number
        is_text = not isinstance(number, Characters) or number.holds(value)
        return self.least <= value <= self.greatest and is_text

    @property
    def allowed(self) -> str:
        """Values that the part can have, in words."""
        if self.values:
            return f"one of {', '.join(f'0x{value:02X}' for value in self.values)}"
        number = self.number
        if isinstance(number, Characters) and number.between:
            return f"a text of {number.allowed}"
        return f"in {self.least}..{self.greatest}"


class CounterPart(ValuePart):
    """Counts frames from `default` or `least` on; behind `greatest` comes `least`."""


BitsMember = IdentityPart | LengthPart | ValuePart
"""A part that is bits of another one."""


class MirrorBits(NamedTuple):
    """Bits of a part that follow from the number of another: it, or all of its bits inverted.

    That part is called `of`. It stands in front, or is some bits of the same part.
    """

    name: str
    number: Number
    of: str
    flips: int = 0
    """What the number is XORed with."""

    def encode(self, numbers: Mapping[str, int]) -> bytes:
        """The bytes with these bits, by the values of parts."""
        return self.number.encode(numbers[self.of] ^ self.flips)

    def check(self, data: bytes, of: int) -> None:
        """Raise ByteError where the bits do not follow from the number of the other part."""
        number = self.number.decode(data)
        if number != of ^ self.flips:
            problem = f"{self.name} is {number}, and has to be {of ^ self.flips}"
            raise ByteError("value", f"{problem}, as {self.of} is {of}")


class ChecksumPart(NamedTuple):
    """A checksum of other parts: of their bytes before any stuffing, or as they are on the wire."""

    name: str
    number: Number | Numeral
    algorithm: Checksum
    covers: tuple[str, ...]
    over_wire: bool = False
    when_payload: bool = False
    """Absent where the payload is empty."""
    lowest: int = 0
    """The lowest bit of the result that it has, where it is some bits of a part."""

    def due(self, result: int) -> int:
        """Its value, where the algorithm has this result."""
        if isinstance(self.number, BitsNumber):
            return result >> self.lowest & ((1 << self.number.bits) - 1)
        return result

    def fault(self, data: bytes, result: int) -> str | None:
        """Description of bytes that are not those of this result; None if they are."""
        due = self.due(result)
        if isinstance(self.number, BitsNumber):
            number = self.number.decode(data)
            return None if number == due else f"{self.name} is {number}, not {due}"
        right = self.number.encode(due)
        return None if data == right else f"{self.name} is {data.hex(' ')}, not {right.hex(' ')}"

    @property
    def size(self) -> int:
        """Bytes before any stuffing."""
        return self.number.size


class BitsPart(NamedTuple):
    """A number whose bits are parts, `members`; each of these has the bytes of all.

    Some bits may follow from numbers in front, or from members: `mirrors`. Some may be a checksum,
    or some bits of one: `sums`. All others are those of `mask`, which are `fixed` in each frame.
    """

    name: str
    number: Number
    members: tuple[BitsMember, ...]
    mask: int
    fixed: int
    mirrors: tuple[MirrorBits, ...] = ()
    sums: tuple[ChecksumPart, ...] = ()

    @property
    def size(self) -> int:
        """Bytes before any stuffing."""
        return self.number.size

    def check(self, data: bytes) -> None:
        """Raise ByteError where bits that are the same in each frame are others."""
        number = self.number.decode(data)
        if number & self.mask != self.fixed:
            problem = f"the bits {self.mask:X} of {number:X} have to be {self.fixed:X}"
            raise ByteError("value", problem)

    def encode(self, numbers: Mapping[str, int]) -> bytes:
        """The bytes for the values of parts. Raises EncodeError where one can't be."""
        joined = self.fixed
        for part in (*self.members, *self.sums):
            try:
                data = part.number.encode(numbers[part.name])
            except ValueError as error:
                raise EncodeError(part.name, str(error)) from None
            joined |= self.number.decode(data)
        for mirror in self.mirrors:
            joined |= self.number.decode(mirror.encode(numbers))
        return self.number.encode(joined)


class PayloadPart(NamedTuple):
    """The message's fields.

    Zeros at its end are left out on the wire where `kept` tells how many bytes stay at least. Where
    `longest` tells how many it can have, there may be more than those of its message.
    """

    name: str = "payload"
    size: int = 0
    """The payload's bytes are not counted among those of the parts."""
    kept: int | None = None
    longest: int | None = None

    @property
    def is_fitted(self) -> bool:
        """True if it may have another size than its message has."""
        return self.kept is not None or self.longest is not None

    def trimmed(self, payload: bytes) -> bytes:
        """The bytes of a message's payload that an encoder puts into a frame."""
        if self.kept is None:
            return payload
        return payload[: max(len(payload.rstrip(b"\0")), self.kept)]

    def fitted(self, payload: bytes, size: int | None) -> bytes:
        """What a frame has of a payload, cut or filled up to its size; None: that varies."""
        if size is None:
            return payload
        if self.longest is not None:
            payload = payload[:size]
        return payload if self.kept is None else payload.ljust(size, b"\0")


class VirtualPart(NamedTuple):
    """A number that goes into the checksums that cover it, and is not sent.

    `values` has its value for each identity; `default` is that of unknown ones.
    """

    name: str
    number: Number | Numeral
    values: tuple[tuple[Identity | Identities, int], ...]
    default: int | None = None


NumberPart = IdentityPart | LengthPart | ValuePart | ChecksumPart
Part = LiteralPart | PayloadPart | BitsPart | NumberPart


def members_of(part: Part) -> tuple[BitsMember, ...]:
    """The parts that are bits of this one."""
    return part.members if isinstance(part, BitsPart) else ()


def mirrors_of(part: Part) -> tuple[MirrorBits, ...]:
    """The bits of this part that follow from other numbers."""
    return part.mirrors if isinstance(part, BitsPart) else ()


def checksums_of(part: Part) -> tuple[ChecksumPart, ...]:
    """The checksums that this part is, or that are bits of it."""
    if isinstance(part, BitsPart):
        return part.sums
    return (part,) if isinstance(part, ChecksumPart) else ()


def written_apart(parts: Iterable[Part]) -> tuple[Part, ...]:
    """The parts in order, in place of those whose bits are parts these."""
    return tuple(item for part in parts for item in members_of(part) or (part,))


# --- start and end ----------------------------------------------------------------------------


class StartLiteral(NamedTuple):
    """A frame starts with these bytes. Protected: they occur nowhere else in a valid frame."""

    value: bytes
    protected: bool

    @property
    def words(self) -> tuple[bytes, ...]:
        """The byte strings that a frame starts with."""
        return (self.value,)


class StartSet(NamedTuple):
    """A frame starts with a byte from `least` to `greatest`.

    Protected: no other byte of a valid frame is one of them.
    """

    least: int
    greatest: int
    protected: bool

    @property
    def words(self) -> tuple[bytes, ...]:
        """The byte strings that a frame starts with."""
        return tuple(bytes((value,)) for value in range(self.least, self.greatest + 1))


class StartWords(NamedTuple):
    """A frame starts with one of these words, which are of one size.

    Protected: they occur nowhere else in a valid frame.
    """

    words: tuple[bytes, ...]
    protected: bool


class AfterEnd(Frozen):
    """A frame starts behind an end, or where the stream starts."""

    __slots__ = ()


class Anywhere(Frozen):
    """Nothing marks the start: sizes and the checksum tell whether a frame starts at a byte."""

    __slots__ = ()


StartMark = StartLiteral | StartSet | StartWords
Start = StartMark | AfterEnd | Anywhere


class End(NamedTuple):
    """A frame ends with these bytes. Protected: they occur nowhere else in a valid frame."""

    value: bytes
    protected: bool


# --- the frame ----------------------------------------------------------------------------------


class FrameSpec(NamedTuple):
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
    """True if every payload byte has its most significant bit clear."""
    rescans: bool = False
    """True if a frame can start inside a failed candidate.

    So a candidate fails as soon as a value in front of the payload is out of bounds, or the length
    is that of no message with the identity."""
    ambiguous_cut: bool = False
    """True if an encoder has to check that a decoder ends the frame where it ends."""
    is_bounded: bool = False
    """True if the schema says how long a frame can be, so that an encoder has to look."""
    virtual: tuple[VirtualPart, ...] = ()
    """Parts that are not sent. A frame whose identity gives one of them no value can't be verified:
    it fails as one with a wrong checksum does."""
    told: tuple[ToldPart, ...] = ()
    """Parts that receivers are told, and that are not sent."""
    silence: float | None = None
    """Seconds of silence that end a frame, where nothing else does."""

    @property
    def given_up_at(self) -> int:
        """Wire bytes of a candidate that is given up if it is no frame by then.

        A frame of the greatest size that only a silence ends is one until a byte follows.
        """
        return self.greatest + (self.silence is not None)
