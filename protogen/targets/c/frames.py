"""Whole frames: what is put around a payload, and how the region under transparency is stuffed.

A frame is built in the caller's buffer. The content stands right-aligned in the room that the
frame can need at most; stuffing then writes it from the left and never overtakes itself, so that no
second buffer is needed.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

from protogen.model.frame import (
    ChecksumPart,
    Cobs,
    CounterPart,
    IdentityPart,
    LengthPart,
    LiteralPart,
    NumberPart,
    PayloadPart,
    ValuePart,
)
from protogen.model.messages import Message
from protogen.model.protocol import Sender
from protogen.targets.c.decoder import ChecksumView, DecoderView
from protogen.targets.c.expressions import wire_bytes
from protogen.targets.c.geometry import Geometry, Placed
from protogen.targets.c.payload.messages import MessageView
from protogen.targets.c.spelling import unsigned_type

_STUFFED = 128


@dataclass(frozen=True, slots=True)
class Argument:
    """A part of the frame that the caller gives."""

    name: str
    part: str
    """What the schema calls it."""
    type: str
    doc: str
    refused: str
    """The condition of a value out of range; empty where all of the type's are in it."""


@dataclass(frozen=True, slots=True)
class ByteStore:
    """One byte of a part, at an offset from the head's or tail's first byte."""

    index: str
    value: str


@dataclass(frozen=True, slots=True)
class Step:
    """What fills one part of the content."""

    name: str
    in_head: bool
    optional: bool
    stores: tuple[ByteStore, ...]
    checksum: ChecksumView | None = None
    flags: int | None = None
    """What a writer does with its bytes, where that is not what it did with those before."""


@dataclass(frozen=True, slots=True)
class FrameView:
    """A sender's frame, as it is built."""

    decoder: DecoderView
    function: str
    """The name of the function that puts a frame around a payload."""
    identity: tuple[Argument, ...]
    arguments: tuple[Argument, ...]
    steps: tuple[Step, ...]
    length: str
    """The length part's value for `payload`; empty where there is none."""
    length_type: str
    region_begin: str
    region_end: str
    worst: int
    """Bytes on the wire for one stuffed byte, at most."""
    is_cobs: bool
    sums_stuffed: bool
    """Whether a checksum covers stuffed bytes as they are on the wire."""
    checks_cut: bool
    """Whether a decoder might end a frame of some message too early."""
    streams: bool
    """Whether a frame can be written byte by byte, without a look at what follows."""
    stream: tuple[Step, ...]
    """The parts in wire order, as they are written byte by byte."""
    payload_flags: int | None

    @property
    def geometry(self) -> Geometry:
        """Where the parts lie."""
        return self.decoder.geometry

    @property
    def sends_tail(self) -> bool:
        """Whether something is sent behind the payload."""
        return bool(self.geometry.end) or any(not step.in_head for step in self.stream)

    @property
    def begins_at(self) -> int | None:
        """Bytes in front of the stuffed region, where these are few and always as many."""
        text = self.region_begin.removesuffix("U")
        return int(text) if text.isdigit() and int(text) <= 4 else None

    @property
    def summed(self) -> ChecksumView | None:
        """The checksum that is worked out while the bytes that it covers are stuffed.

        It covers all that is stuffed, and nothing but its own bytes stands behind that.
        """
        stuffing = self.decoder.stuffing
        if stuffing is None or stuffing.kind == "cobs" or len(self.decoder.checksums) != 1:
            return None
        checksum = self.decoder.checksums[0]
        tail = [step for step in self.steps if not step.in_head]
        covers = [(cover.first, cover.last, cover.literal) for cover in checksum.covers]
        payload_end = f"{self.decoder.head_size}U + decoder->payload"
        covers_all = covers == [(f"{self.begins_at}U", payload_end, "")]
        is_alone = len(tail) == 1 and tail[0].checksum is checksum and not checksum.optional
        fits = covers_all and is_alone and self.decoder.region_to_end and not checksum.over_wire
        return checksum if fits else None

    @property
    def summed_bytes(self) -> tuple[str, ...]:
        """What the checksum that is worked out with the stuffing puts behind the payload."""
        return tuple(store.value for step in self.steps[-1:] for store in step.stores)


@dataclass(frozen=True, slots=True)
class MessageFrame:
    """The function that makes the frame of one message."""

    name: str
    function: str
    send: str
    sends: bool
    struct: str
    upper: str
    validate: str
    measure: str
    store: str
    put: str
    put_function: str
    frame: FrameView
    fixed: int | None
    greatest: int
    identity: tuple[str, ...]
    least_payload: int
    greatest_payload: int
    needs_cut_check: bool
    needs_idle_check: bool
    """Whether its first bytes may be an end, which a decoder would take for an idle line."""
    greatest_frame: int
    room: int
    """Bytes of the buffer that suffice for every frame of the message."""

    @property
    def frame_arguments(self) -> tuple[str, ...]:
        """What the function that fills a buffer takes."""
        return (*self._given(), "uint8_t *frame", "size_t capacity", "size_t *size")

    def send_arguments(self, put: str) -> tuple[str, ...]:
        """What the function that sends takes."""
        return (*self._given(), f"{put} put", "void *user")

    def _given(self) -> tuple[str, ...]:
        parts = (f"{item.type} {item.name}" for item in self.frame.arguments)
        return (f"const {self.struct} *message", *parts)


def frame_view(decoder: DecoderView) -> FrameView:
    """The view of a sender's frame."""
    return _Builder(decoder).view()


class _Builder:
    def __init__(self, decoder: DecoderView) -> None:
        self._decoder = decoder
        self._geometry = decoder.geometry
        self._sender = decoder.geometry.sender

    def view(self) -> FrameView:
        frame = self._sender.frame
        stuffing = self._decoder.stuffing
        framing = self._sender.framing
        stream, payload_flags = self._stream()
        return FrameView(
            decoder=self._decoder,
            function=f"{self._decoder.prefix}_wrap",
            identity=tuple(_argument(part) for part in frame.identity),
            arguments=tuple(_argument(part) for part in frame.caller_parts),
            steps=tuple(self._ordered()),
            length=self._length(),
            length_type="" if frame.length is None else unsigned_type(_width(frame.length)),
            region_begin=self._decoder.region_begin.replace("decoder->", ""),
            region_end=self._decoder.region_end.replace("decoder->", ""),
            worst=_worst(self._sender),
            is_cobs=stuffing is not None and stuffing.kind == "cobs",
            sums_stuffed=any(item.sums_stuffed for item in self._decoder.checksums),
            checks_cut=framing.cut_ambiguous and frame.length is None,
            streams=self._can_stream(),
            stream=stream,
            payload_flags=payload_flags,
        )

    # --- byte by byte ---------------------------------------------------------------------------

    def _can_stream(self) -> bool:
        """A checksum in front of what it covers, and the codes of COBS, tell what follows."""
        stuffing = self._decoder.stuffing
        if stuffing is not None and stuffing.kind == "cobs":
            return False
        if stuffing is not None and any(c.over_wire for c in self._sender.frame.checksums):
            return False
        names = [part.name for part in self._sender.frame.parts]
        return all(
            names.index(name) < names.index(part.name)
            for part in self._sender.frame.checksums
            for name in part.covers
        )

    def _stream(self) -> tuple[tuple[Step, ...], int | None]:
        steps: list[Step] = []
        payload_flags: int | None = None
        before = 0
        placed = {item.part.name: item for item in (*self._geometry.head, *self._geometry.tail)}
        for part in self._sender.frame.parts:
            flags = self._flags(part.name)
            change = None if flags == before else flags
            if isinstance(part, PayloadPart):
                payload_flags = change
            elif part.name in placed:
                steps.append(replace(self._step(placed[part.name]), flags=change))
            else:
                continue
            before = flags
        return tuple(steps), payload_flags

    def _flags(self, name: str) -> int:
        """Which checksums cover a part, and whether it is stuffed."""
        frame = self._sender.frame
        covering = sum(1 << i for i, part in enumerate(frame.checksums) if name in part.covers)
        return covering | (_STUFFED if name in self._geometry.stuffed else 0)

    def _length(self) -> str:
        view = self._decoder.length
        if view is None:
            return ""
        if not view.optional:
            return f"{view.base}u + payload" if view.base else "payload"
        return f"(payload == 0u ? {view.base}u : {view.base + view.optional}u + payload)"

    def _ordered(self) -> list[Step]:
        """The parts in the order in which they can be filled: checksums behind what they cover."""
        placed = [*self._geometry.head, *self._geometry.tail]
        plain = [item for item in placed if not isinstance(item.part, ChecksumPart)]
        left = [item for item in placed if isinstance(item.part, ChecksumPart)]
        done: list[Placed] = []
        while left:
            names = {item.part.name for item in left}
            ready = next(i for i in left if names.isdisjoint(_covered(i)))
            left.remove(ready)
            done.append(ready)
        return [self._step(item) for item in (*plain, *done)]

    def _step(self, item: Placed) -> Step:
        part = item.part
        in_head = self._geometry.is_head(item)
        less = self._decoder_absent(item)
        match part:
            case LiteralPart():
                values = tuple(f"0x{byte:02X}" for byte in part.bytes)
            case LengthPart():
                values = wire_bytes(part.type, "length")
            case NumberPart():
                values = wire_bytes(part.type, argument_name(part.name))
            case ChecksumPart():
                values = wire_bytes(part.type, "due")
            case _:
                values = ()
        stores = tuple(
            ByteStore(f"{item.offset + index}u{less}", value) for index, value in enumerate(values)
        )
        checksum = next((c for c in self._decoder.checksums if c.name == part.name), None)
        return Step(part.name, in_head, item.is_optional, stores, checksum)

    def _decoder_absent(self, item: Placed) -> str:
        if self._geometry.is_head(item):
            return ""
        tail = self._geometry.tail
        absent = sum(o.size for o in tail if o.is_optional and o.end <= item.offset)
        return f" - (payload == 0u ? {absent}u : 0u)" if absent else ""


def message_frame(
    frame: FrameView,
    decoder: DecoderView,
    message: Message,
    view: MessageView,
    suffix: str,
) -> MessageFrame:
    """The frame functions of a message; `decoder` is that of a sender of the message."""
    framing = decoder.geometry.sender.framing
    has_length = decoder.length is not None
    group = [m for m in decoder.groups if any(item.name == message.name for item in m.messages)]
    is_fixed = bool(group) and group[0].fixed is not None
    parts = decoder.geometry.frame.identity
    greatest = message.sizes.greatest
    if has_length:
        greatest = min(greatest, framing.payload.greatest)
    needs_cut_check = framing.cut_ambiguous and not has_length and not is_fixed
    needs_idle_check = framing.cut_ambiguous and _may_look_idle(decoder, message)
    return MessageFrame(
        name=message.name,
        function=f"{view.prefix}_frame{suffix}",
        send=f"{view.prefix}_send{suffix}",
        sends=frame.streams and not needs_cut_check and not needs_idle_check,
        struct=view.struct,
        upper=f"{view.upper}{suffix.upper()}",
        validate=view.validate if view.validates else "",
        measure=view.measure,
        store=view.store,
        put=view.put,
        put_function=view.put_function,
        frame=frame,
        fixed=message.sizes.fixed,
        greatest=message.sizes.greatest,
        identity=tuple(
            f"0x{value:0{2 * -(-part.type.bits // 8)}X}"
            for part, value in zip(parts, message.identity, strict=True)
        ),
        least_payload=framing.payload.least if has_length else 0,
        greatest_payload=framing.payload.greatest if has_length else message.sizes.greatest,
        needs_cut_check=needs_cut_check,
        needs_idle_check=needs_idle_check,
        greatest_frame=next(m.greatest for m in framing.messages if m.message == message.name),
        room=room(frame, greatest),
    )


def _may_look_idle(decoder: DecoderView, message: Message) -> bool:
    """Whether an end may stand where nothing but a start is in front of it."""
    geometry = decoder.geometry
    if decoder.start != "after_end" and not geometry.shares_delimiter:
        return False
    behind_start = [item for item in geometry.head if item.offset >= len(geometry.start)]
    first = behind_start[0].part if behind_start else None
    if not isinstance(first, IdentityPart) or first.type.size < len(geometry.end):
        return True
    value = message.identity[geometry.identities().index(first)]
    shifts = range(0, first.type.byte_bits * first.type.size, first.type.byte_bits)
    octets = [(value >> shift) & ((1 << first.type.byte_bits) - 1) for shift in shifts]
    ordered = octets if first.type.byte_order == "little" else octets[::-1]
    return bytes(ordered).startswith(geometry.end)


def room(frame: FrameView, payload: int) -> int:
    """Bytes that the frame of a payload can need."""
    geometry = frame.geometry
    tail = geometry.tail_size if payload else geometry.tail_size - geometry.optional_size
    content = geometry.head_size + payload + tail
    end = len(geometry.end)
    if frame.decoder.stuffing is None:
        return content + end
    if frame.is_cobs:
        return content + end + content // 254 + 1
    return frame.worst * content + end


def _covered(item: Placed) -> set[str]:
    part = item.part
    return set(part.covers) - {part.name} if isinstance(part, ChecksumPart) else set()


_WORDS = (
    "byte capacity code content due frame from full high index length literal low message payload "
    "put result size sum tail to user wire writer"
)
_LOCAL = frozenset(_WORDS.split())
"""What the functions call their own variables."""


def argument_name(part: str) -> str:
    """What the functions call a part that the caller gives."""
    return f"{part}_part" if part in _LOCAL else part


def _argument(part: IdentityPart | CounterPart | ValuePart) -> Argument:
    bits = part.type.width
    name = argument_name(part.name)
    conditions = []
    if part.least > 0:
        conditions.append(f"{name} < {part.least}u")
    if part.greatest < (1 << bits) - 1:
        conditions.append(f"{name} > {part.greatest}u")
    type_, refused = unsigned_type(part.type.bits), " || ".join(conditions)
    return Argument(name, part.name, type_, part.about.doc, refused)


def _width(part: LengthPart) -> int:
    return max(16, part.type.bits)


def _worst(sender: Sender) -> int:
    transparency = sender.frame.transparency
    if transparency is None or isinstance(transparency.encoding, Cobs):
        return 1
    from protogen.targets.c.stuffing import stuffing_of

    stuffing = stuffing_of(transparency)
    return max(2 if stuffing.kind == "base16" else 1, stuffing.longest)
