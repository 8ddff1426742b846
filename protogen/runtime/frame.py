"""What a generated module says about a frame: its parts in wire order, and how it is found.

Whatever needs analysis (what is protected, how large a frame can be) is worked out by the compiler
and only stated here.
"""

from __future__ import annotations

from protogen.runtime.checksum import Checksum
from protogen.runtime.number import Number
from protogen.runtime.transparency import Transparency
from protogen.runtime.values import Frozen

# --- parts ------------------------------------------------------------------------------------


class LiteralPart(Frozen):
    """Fixed bytes."""

    __slots__ = ("name", "value")

    name: str
    value: bytes

    def __init__(self, name: str, value: bytes) -> None:
        self._set(name, value)

    @property
    def size(self) -> int:
        """Bytes before any stuffing."""
        return len(self.value)


class NumberPart(Frozen):
    """A part that is one integer."""

    __slots__ = ("name", "number")

    name: str
    number: Number

    def __init__(self, name: str, number: Number) -> None:
        self._set(name, number)

    @property
    def size(self) -> int:
        """Bytes before any stuffing."""
        return self.number.size


class IdentityPart(NumberPart):
    """Tells, alone or with others, which message the frame carries."""

    __slots__ = ()


class LengthPart(NumberPart):
    """The number of bytes of the parts that it `counts`, before any stuffing.

    The payload is one of them; the length itself may be. `least` and `greatest` bound its value.
    """

    __slots__ = ("counts", "greatest", "least")

    counts: tuple[str, ...]
    least: int
    greatest: int

    def __init__(
        self, name: str, number: Number, counts: tuple[str, ...], least: int, greatest: int
    ) -> None:
        self._set(name, number, counts, least, greatest)


class ValuePart(NumberPart):
    """A number that the caller gives, from `least` to `greatest`, and that a receiver hands on."""

    __slots__ = ("default", "greatest", "least")

    least: int
    greatest: int
    default: int | None

    def __init__(
        self, name: str, number: Number, least: int, greatest: int, default: int | None = None
    ) -> None:
        self._set(name, number, least, greatest, default)


class CounterPart(ValuePart):
    """Counts frames from `default` or `least` on; behind `greatest` comes `least`."""

    __slots__ = ()

    def __init__(
        self, name: str, number: Number, least: int, greatest: int, default: int | None = None
    ) -> None:
        self._set(name, number, least, greatest, default)


class PayloadPart(Frozen):
    """The message's fields."""

    __slots__ = ("name", "size")

    name: str
    size: int
    """The payload's bytes are not counted among those of the parts."""

    def __init__(self, name: str = "payload", size: int = 0) -> None:
        self._set(name, size)


class ChecksumPart(NumberPart):
    """A checksum of other parts: of their bytes before any stuffing, or as they are on the wire."""

    __slots__ = ("algorithm", "covers", "over_wire", "when_payload")

    algorithm: Checksum
    covers: tuple[str, ...]
    over_wire: bool
    when_payload: bool
    """Absent where the payload is empty."""

    def __init__(
        self,
        name: str,
        number: Number,
        algorithm: Checksum,
        covers: tuple[str, ...],
        over_wire: bool = False,
        when_payload: bool = False,
    ) -> None:
        self._set(name, number, algorithm, covers, over_wire, when_payload)


Part = LiteralPart | IdentityPart | LengthPart | ValuePart | PayloadPart | ChecksumPart


# --- start and end ----------------------------------------------------------------------------


class StartLiteral(Frozen):
    """A frame starts with these bytes. Protected: they occur nowhere else in a valid frame."""

    __slots__ = ("protected", "value")

    value: bytes
    protected: bool

    def __init__(self, value: bytes, protected: bool) -> None:
        self._set(value, protected)


class StartSet(Frozen):
    """A frame starts with a byte from `least` to `greatest`.

    Protected: no other byte of a valid frame is one of them.
    """

    __slots__ = ("greatest", "least", "protected")

    least: int
    greatest: int
    protected: bool

    def __init__(self, least: int, greatest: int, protected: bool) -> None:
        self._set(least, greatest, protected)


class AfterEnd(Frozen):
    """A frame starts behind an end, or where the stream starts."""

    __slots__ = ()


class Anywhere(Frozen):
    """Nothing marks the start: sizes and the checksum tell whether a frame starts at a byte."""

    __slots__ = ()


Start = StartLiteral | StartSet | AfterEnd | Anywhere


class End(Frozen):
    """A frame ends with these bytes. Protected: they occur nowhere else in a valid frame."""

    __slots__ = ("protected", "value")

    value: bytes
    protected: bool

    def __init__(self, value: bytes, protected: bool) -> None:
        self._set(value, protected)


# --- the frame ----------------------------------------------------------------------------------


class FrameSpec(Frozen):
    """The frame of one sender.

    `parts` are in wire order, one of them the payload. `stuffed` are those under `transparency`,
    which follow each other. `greatest` is the size on the wire, in bytes, that no frame exceeds;
    `least` that of the smallest. `greatest_payload` is the most that the payload can have.
    """

    __slots__ = (
        "ambiguous_cut",
        "end",
        "greatest",
        "greatest_payload",
        "least",
        "parts",
        "seven_bit",
        "start",
        "stuffed",
        "transparency",
    )

    parts: tuple[Part, ...]
    start: Start
    end: End | None
    least: int
    greatest: int
    greatest_payload: int
    transparency: Transparency | None
    stuffed: tuple[str, ...]
    seven_bit: bool
    """True if every payload byte has its most significant bit clear."""
    ambiguous_cut: bool
    """True if an encoder has to check that a decoder ends the frame where it ends."""

    def __init__(  # noqa: PLR0913 - an argument for each field
        self,
        parts: tuple[Part, ...],
        start: Start,
        end: End | None,
        least: int,
        greatest: int,
        greatest_payload: int,
        transparency: Transparency | None = None,
        stuffed: tuple[str, ...] = (),
        seven_bit: bool = False,
        ambiguous_cut: bool = False,
    ) -> None:
        self._set(
            parts,
            start,
            end,
            least,
            greatest,
            greatest_payload,
            transparency,
            stuffed,
            seven_bit,
            ambiguous_cut,
        )
