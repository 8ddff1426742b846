"""A frame's content, read as the frame's parts while it comes in.

The *content* is the bytes of all parts before any stuffing, without the end literal.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

from protogen.runtime.errors import ByteError, PayloadFault, Reason
from protogen.runtime.framing.frame import (
    BitsPart,
    ChecksumPart,
    LengthPart,
    LiteralPart,
    NumberPart,
    Part,
    PayloadPart,
    ValuePart,
    members_of,
)
from protogen.runtime.framing.layout import Slice, is_optional
from protogen.runtime.framing.sender import IdentityGroup, SenderSpec

if TYPE_CHECKING:
    from protogen.runtime.constructs import Measurer


class Rejected(Exception):  # noqa: N818 - it is a verdict, not an error of the program
    """Bytes are no frame."""

    def __init__(self, reason: Reason, problem: str) -> None:
        super().__init__(reason, problem)
        self.reason: Reason = reason
        self.problem = problem


class Content:
    """Takes content byte by byte and says what is known of the frame."""

    def __init__(self, sender: SenderSpec[Any, Any], told: Mapping[str, int]) -> None:
        """`told` has the values of parts that are not sent."""
        self._sender = sender
        self._layout = sender.layout
        self.bytes = bytearray()
        self.numbers: dict[str, int] = {
            part.name: told.get(part.name, part.default) for part in sender.frame.told
        }
        """The values of the parts that are known: told, or read."""
        self.index = 0
        """The part that is due."""
        self.payload_size: int | None = None
        """The payload's size, as soon as it is known."""
        self.is_open = False
        """True if the payload has begun, and only what follows will tell its size."""
        self.is_full = False
        """True if all parts are there."""
        self._group: IdentityGroup[Any] | None = None
        self._measurer: Measurer | None = None  # Of a payload that nothing delimits but itself.
        self.limit: int | None = None
        """Bytes that the content has at most, as soon as that is known."""
        self.region_end: int | None = None
        """Wire bytes up to the end of what is stuffed, where the length says that."""
        self._next = -1  # Where the part that is due ends.
        self._literal = b""  # What its bytes have to be.
        self._clear_bits = False  # Whether their most significant bit has to be clear.

    def begin(self) -> None:
        """Take what was told, before the first byte. Raises Rejected where no frame has it."""
        told = self._layout.told_length
        if told is not None:
            self._read_length(told)
        if not self._layout.sent_identity:
            self._identify()
        self._enter()

    def accept(self, byte: int) -> bool:
        """Take the next byte. True: a part was completed, and more may be known."""
        index = len(self.bytes)
        if self.limit is not None and index >= self.limit:
            raise self.surplus()
        self.bytes.append(byte)
        if self._literal and byte != self._literal[index - self._next]:
            raise Rejected("value", f"{byte:02X} is not {self._part.name}")
        if byte > 0x7F and self._clear_bits:
            raise Rejected("encoding", f"{byte:02X} has its most significant bit set")
        if index + 1 != self._next:
            return False
        self._leave()
        return True

    def surplus(self) -> Rejected:
        """Verdict on a byte behind the content's last one."""
        if self.payload_size is None:
            return Rejected("size", "no message of this identity has so many bytes")
        return Rejected(self._announced, f"there are more than {self.limit} bytes, or no end")

    def close(self) -> None:
        """Take the end of the content. Raises Rejected where the frame can't end here."""
        if self.payload_size is None and self._layout.counts_wire:
            raise Rejected("length", "the frame ends before its length says")
        if self.payload_size is None:
            self._close_open()
        elif not self.is_full:
            problem = f"the frame ends behind {len(self.bytes)} of {self.limit} bytes"
            raise Rejected(self._announced, problem)

    # --- part by part -------------------------------------------------------------------------

    @property
    def _part(self) -> Part:
        return self._layout.parts[self.index]

    @property
    def _announced(self) -> Reason:
        """The reason where there are more or fewer bytes than announced."""
        return "size" if self._layout.length is None else "length"

    def _enter(self) -> None:
        """Begin the next part that has bytes."""
        parts = self._layout.parts
        while self.index < len(parts) and self._is_absent(parts[self.index]):
            self.index += 1
        self._literal = b""
        self._clear_bits = False
        self._next = -1
        if self.index == len(parts):
            self.is_full = True
        elif isinstance(self._part, PayloadPart):
            self._enter_payload()
        else:
            self._next = len(self.bytes) + self._part.size
            self._literal = self._part.value if isinstance(self._part, LiteralPart) else b""

    def _is_absent(self, part: Part) -> bool:
        return self.payload_size == 0 and (isinstance(part, PayloadPart) or is_optional(part))

    def _leave(self) -> None:
        """End the part that is due."""
        if self._measurer is not None:
            self._measure(self._measurer)
            return
        part = self._part
        self._read_part(part, bytes(self.bytes[-part.size :]))
        self.index += 1
        self._enter()

    def _read_part(self, part: Part, data: bytes) -> None:
        """Take the numbers of a part, and then what they tell."""
        if isinstance(part, BitsPart):
            self._read_bits(part, data)
        elif isinstance(part, NumberPart) and not isinstance(part, ChecksumPart):
            self._read(part, data)
        numbers = (part, *members_of(part))
        if self._layout.length in numbers and self._layout.length is not self._layout.told_length:
            self._read_length(self._layout.length)
        if self._layout.early_identity and self._completes_identity(numbers):
            self._identify()
        for length in self._layout.lengths[1:]:
            if length in numbers:
                self._agree(length)

    def _completes_identity(self, numbers: Sequence[Part]) -> bool:
        """True if the last identity part that is sent is among these."""
        sent = self._layout.sent_identity
        return bool(sent) and sent[-1] in numbers

    def _read_bits(self, part: BitsPart, data: bytes) -> None:
        try:
            part.check(data)
        except ByteError as error:
            raise Rejected(error.reason, f"{part.name}: {error}") from None
        for member in part.members:
            self._read(member, data)
        for mirror in part.mirrors:
            try:
                mirror.check(data, self.numbers[mirror.of])
            except ByteError as error:
                raise Rejected(error.reason, str(error)) from None

    def _read(self, part: NumberPart, data: bytes) -> None:
        try:
            self.numbers[part.name] = number = part.number.decode(data)
        except ByteError as error:
            raise Rejected(error.reason, f"{part.name}: {error}") from None
        if isinstance(part, ValuePart) and part in self._layout.bounded:
            self._check_bounds(part, number)

    def _check_bounds(self, part: ValuePart, number: int) -> None:
        if not part.holds(number):
            raise Rejected("value", f"{part.name} is {number}, which is not {part.allowed}")

    # --- how large the payload is ---------------------------------------------------------------

    def _read_length(self, part: LengthPart) -> None:
        value = self.numbers[part.name]
        if part.over_wire:
            self.region_end = self._layout.region_end(part, value)
            if self.region_end is None:
                raise Rejected("length", f"{part.name} is {value}")
            return
        size = self._layout.counted_payload(part, value)
        if size is None:
            raise Rejected("length", f"{part.name} is {value}")
        self._set_payload(size)
        self._compare()

    def _agree(self, part: LengthPart) -> None:
        """Hold another length against the size that the first one told."""
        assert self.payload_size is not None
        value, due = self.numbers[part.name], self._layout.counted(part, self.payload_size)
        if value != due:
            raise Rejected("length", f"{part.name} is {value}, and has to be {due}")

    def _identify(self) -> None:
        """Find the messages of the identity, and what they say about the size."""
        self._group = self._sender.group(self._sender.identity(self.numbers))
        if (
            self._group is not None
            and self._layout.length is None
            and self._group.fixed is not None
        ):
            self._set_payload(self._group.fixed)
        self._compare()

    def _compare(self) -> None:
        """Hold the size that the length tells against those of the identity's messages."""
        group, size = self._group, self.payload_size
        if group is None or size is None or not self._sender.frame.rescans:
            return
        if self._layout.length is not None and not group.holds(size):
            raise Rejected("size", f"no message of this identity has {size} bytes of payload")

    def _set_payload(self, size: int) -> None:
        self.payload_size = size
        self.limit = self._layout.head_size + size + self._layout.tail_size(size)

    def _enter_payload(self) -> None:
        if self.payload_size is not None:
            self._next = len(self.bytes) + self.payload_size
            self._clear_bits = self._sender.frame.seven_bit
        elif self._ends_elsewhere or self._group is None:
            self._open_payload()
        else:
            self._measurer = self._group.measurer(self.numbers)
            self._clear_bits = self._sender.frame.seven_bit
            self._measure(self._measurer)

    @property
    def _ends_elsewhere(self) -> bool:
        """True if something else than the message tells where its payload ends."""
        layout = self._layout
        return bool(layout.end) or layout.ends_idle or layout.counts_wire

    def _open_payload(self) -> None:
        self.is_open = True
        # With parts behind the payload, its last bytes can't be told from theirs yet.
        self._clear_bits = self._sender.frame.seven_bit and not self._layout.tail
        if self._group is not None and not self._layout.counts_wire:
            tail = self._layout.tail_size(self._group.greatest)
            self.limit = self._layout.head_size + self._group.greatest + tail

    @property
    def _room(self) -> int:
        """Bytes that a payload has at most in a frame that a decoder takes."""
        around = self._layout.head_size + self._layout.tail_size(1)
        return self._sender.frame.greatest - around

    def _measure(self, measurer: Measurer) -> None:
        """Try to read a message that nothing delimits but itself."""
        try:
            new = bytes(self.bytes[self._layout.head_size + measurer.taken :])
            self._set_payload(measurer.take(new))
        except PayloadFault as error:
            # How far ahead a reader looks is its own matter; that the room is full is not.
            left = self._room - measurer.taken
            if not error.missing or left <= 0:
                raise Rejected(error.reason, error.problem) from None
            self._next = len(self.bytes) + min(error.missing, left)
            return
        self._measurer = None
        self.index += 1
        self._enter()

    # --- the end of an open payload -------------------------------------------------------------

    def close_counted(self) -> None:
        """Take the end of all content, where the length says that it is."""
        self._close_open("length", "the length leaves no room for all parts")
        self.limit = len(self.bytes)
        self.is_full = True

    def _close_open(
        self,
        reason: Reason = "truncated",
        problem: str = "the frame ends before all of its parts are there",
    ) -> None:
        size = self._layout.payload_size(len(self.bytes)) if self.is_open else None
        if size is None:
            raise Rejected(reason, problem)
        self.payload_size = size
        payload, *tail = list(self._layout.slices(size))[self._layout.payload_index :]
        if self._sender.frame.seven_bit and not self._slice(payload).isascii():
            raise Rejected("encoding", "a byte of the payload has its most significant bit set")
        for item in tail:
            self._read_closed(item)

    def _read_closed(self, item: Slice) -> None:
        data = self._slice(item)
        if isinstance(item.part, LiteralPart) and data != item.part.value:
            raise Rejected("value", f"{data.hex(' ')} is not {item.part.name}")
        self._read_part(item.part, data)

    def _slice(self, item: Slice) -> bytes:
        return bytes(self.bytes[item.start : item.end])
