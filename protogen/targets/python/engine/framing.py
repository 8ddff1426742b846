"""Functions that make frames: a payload and the frame's numbers become bytes on the wire."""

from __future__ import annotations

from collections.abc import Sequence

from protogen.model.messages import Message
from protogen.model.parts import (
    BitsPart,
    ChecksumPart,
    ChoicePart,
    CounterPart,
    IdentityPart,
    LiteralPart,
    MirrorBits,
    NumberPart,
    Part,
    PartType,
    PayloadPart,
    ValuePart,
    VirtualPart,
    place_of,
)
from protogen.targets.python import frames as tables
from protogen.targets.python.engine.checksums import (
    FOLDED,
    checksum,
    folded,
    is_plain_xor,
    virtual_bytes,
)
from protogen.targets.python.engine.frames import EngineFrame
from protogen.targets.python.engine.layout import UNSIGNED, byte_order
from protogen.targets.python.engine.lines import Constants, Lines
from protogen.targets.python.engine.numbers import FrameFunction
from protogen.targets.python.engine.struct_calls import Packed, Packer
from protogen.targets.python.engine.writing import content_writer, is_of_one_size, payload_writer
from protogen.targets.python.literals import bracketed, text, tuple_of
from protogen.targets.python.literals import octets_in_class as literal


def framer(frame: EngineFrame, of_caller: tuple[str, ...], constants: Constants) -> tuple[str, ...]:
    """The body of `_frame_SENDER(payload, IDENTITY..., VALUES...)`."""
    return _Framer(frame, of_caller, Lines(constants)).body()


def arguments(frame: EngineFrame, of_caller: tuple[str, ...]) -> list[str]:
    """The numbers that the function takes: identity parts, then what callers of `encode` give."""
    identity = [f"{part.name}_" for part in frame.plan.identity]
    return [*identity, *_of_caller(frame, of_caller)]


def _of_caller(frame: EngineFrame, names: tuple[str, ...]) -> list[str]:
    """Names of arguments: a part of other senders only may be called like an identity of this."""
    own = {part.name for part in frame.plan.frame.caller_parts}
    return [f"{name}_" if name in own else f"other{index}" for index, name in enumerate(names)]


def encoder(
    message: Message,
    frames: Sequence[EngineFrame],
    of_caller: tuple[str, ...],
    constants: Constants,
) -> tuple[str, ...]:
    """The body of `_encode_NAME(item, module, sender, VALUES...)`, for the frames of its senders.

    `module` is the module's own table: other modules' messages have a method of the same name.
    """
    lines = Lines(constants)
    if len(frames) == 1:
        name = text(frames[0].sender.endpoint)
        is_other = f"(sender is not None and sender != {name})"
        lines.refuse_if(f"module is not _ENCODERS or {is_other}")
        if is_of_one_size(message) and _goes_together(frames[0]):
            return _Framer(frames[0], of_caller, lines, message).whole(message)
    if len(frames) > 1:
        lines.refuse_if("module is not _ENCODERS")
    payload_writer(message, lines)
    if len(frames) == 1:
        if _is_trimmed(frames[0], message):
            lines.add(f"payload = {_trimmed(frames[0])}")
        return _Framer(frames[0], of_caller, lines, message).body()
    endpoints = dict.fromkeys(frame.sender.endpoint for frame in frames)
    for endpoint in endpoints:
        own = [frame for frame in frames if frame.sender.endpoint == endpoint]
        is_meant = f"sender == {text(endpoint)}"
        if len(endpoints) == 1:
            is_meant = f"sender is None or {is_meant}"
        with lines.block(f"if {is_meant}:"):
            _first_that_fits(message, own, of_caller, lines)
    lines.add("raise _fast.NeedsReference")
    return lines.text


def _first_that_fits(
    message: Message, frames: Sequence[EngineFrame], of_caller: Sequence[str], lines: Lines
) -> None:
    """Return the frame of the first form whose length can say the payload's size."""
    for frame in frames:
        chosen = _chosen_names(message, frame)
        others = ("None" if name in chosen else f"{name}_" for name in of_caller)
        values = [*_identity_of(message, frame, lines), *others]
        stated, sizes = frame.plan.payload, frame.plan.frame.payload.sent(message.sizes)
        payload = "payload"
        if _is_trimmed(frame, message):
            payload = "trimmed"
            lines.add(f"{payload} = {_trimmed(frame)}")
        made = f"return _frame_{frame.sender.name}({', '.join([payload, *values])})"
        if frame is frames[-1] or frame.plan.length is None or stated.holds(sizes):
            lines.add(made)
            return
        if stated.meets(sizes):
            with lines.block(f"if {stated.least} <= len({payload}) <= {stated.greatest}:"):
                lines.add(made)


def _is_trimmed(frame: EngineFrame, message: Message) -> bool:
    """True if zeros at the end of a message's payload may be left out."""
    return frame.plan.frame.payload.sent(message.sizes) != message.sizes


def _trimmed(frame: EngineFrame) -> str:
    """The payload without zeros at its end, but for the bytes that stay, as an expression."""
    kept, bare = frame.plan.frame.payload.kept, 'payload.rstrip(b"\\0")'
    if kept == 1:
        return f"{bare} or payload[:1]"
    return f"payload[: max(len({bare}), {kept})]"


def _chosen_names(message: Message, frame: EngineFrame) -> list[str]:
    """Identity parts whose values the caller of an encoder may choose."""
    parts = enumerate(frame.plan.identity)
    return [part.name for index, part in parts if message.chooses(index)]


def _identity_of(message: Message, frame: EngineFrame, lines: Lines) -> list[str]:
    """Expressions for the values of identity parts; those of a caller are checked."""
    found = []
    for index, part in enumerate(frame.plan.identity):
        value = str(message.identity[index])
        if message.chooses(index):
            given, default, value = f"{part.name}_", value, f"identity{index}"
            if part.type.is_text:
                number = f"{text_reader(part, lines)}({given})"
                lines.add(f"{value} = {default} if {given} is None else {number}")
            else:
                lines.add(f"{value} = {default} if {given} is None else {given}")
                lines.refuse_if(f"type({value}) is not int")
            bounds = [_in_run(value, *run) for run in message.told_by.runs[index]]
            lines.refuse_if(f"not ({' or '.join(bounds)})")
        found.append(value)
    return found


def _in_run(value: str, first: int, last: int) -> str:
    return f"{value} == {first}" if first == last else f"{first} <= {value} <= {last}"


def text_reader(part: NumberPart, lines: Lines) -> str:
    """The name of what reads the number of a text that a caller gives."""
    return lines.constants.named("TEXT", f"_fast.text({tables.number(part)})")


def _variable(part: CounterPart | ValuePart) -> str:
    """The variable that holds a part's number."""
    return f"{part.name}_number" if part.type.is_text else f"{part.name}_"


def encoder_arguments(of_caller: tuple[str, ...]) -> list[str]:
    """Arguments for what callers of `encode` give."""
    return [f"{name}_" for name in of_caller]


def _goes_together(frame: EngineFrame) -> bool:
    """True if all parts in front of the payload are numbers for `struct`, and none is optional."""
    plain = all(frame.is_skipped(part) or _is_packed(part) for part in frame.head)
    return plain and not (frame.plan.optional_size or frame.plan.is_trimmed)


class _Framer(FrameFunction):
    """Writes the body of one function."""

    def __init__(
        self,
        frame: EngineFrame,
        of_caller: tuple[str, ...],
        lines: Lines,
        message: Message | None = None,
    ) -> None:
        """With a message, for its frames alone: what is the same in all of them is no argument."""
        super().__init__(frame, lines)
        self.message = message
        self._has_payload = False
        """True if a variable holds the payload alone."""
        names = _of_caller(frame, of_caller) if message is None else encoder_arguments(of_caller)
        chosen = () if message is None else _chosen_names(message, frame)
        given = zip(of_caller, names, strict=True)
        self.values = {name: argument for name, argument in given if name not in chosen}
        self._identity = [f"{part.name}_" for part in frame.plan.identity]

    def body(self) -> tuple[str, ...]:
        for name in self._values():
            self.lines.refuse_if(f"type({name}) is not int")
        self._payload()
        self._has_payload = True
        if self.plan.optional_size:
            with self.lines.block("if payload:"):
                self._make(bare=False)
            self._make(bare=True)
        else:
            self._make(bare=False)
        return self.lines.text

    def whole(self, message: Message) -> tuple[str, ...]:
        """The body for a message of a fixed size, packed together with what is in front of it."""
        integers = self._values()
        head = [
            self._packed(part, bare=False)
            for part in self.frame.head
            if not self.frame.is_skipped(part)
        ]
        self.lines.add(f"content = {content_writer(message, head, integers, self.lines)}")
        for part in self.frame.checksums:
            self._insert(part)
        self._return(bare=False)
        return self.lines.text

    def _covers_payload(self, part: ChecksumPart, covered: str) -> bool:
        """True if a checksum covers the payload alone, with which the content ends at the first."""
        own = self.frame.slice_of("content", self.plan.head_size - self.frame.skipped, 0)
        return covered == own and part == self.frame.checksums[0]

    def _packed(self, part: Part, bare: bool) -> Packed:
        if isinstance(part, LiteralPart):
            return Packed("", "B", f"0x{part.bytes[0]:02X}")
        assert isinstance(part, NumberPart | BitsPart)
        return Packed(byte_order(part.type), UNSIGNED[part.type.size], self._value(part, bare))

    @property
    def _fixed(self) -> int | None:
        """Bytes of the payload, where it is that of a message and always as long."""
        if self.message is None:
            return None
        return self.plan.frame.payload.sent(self.message.sizes).fixed

    def _values(self) -> list[str]:
        """Check what callers give; the variables that have yet to be seen to be integers.

        Where `struct` writes them, it sees to that.
        """
        integers = []
        if self.message is not None:
            self._identity = _identity_of(self.message, self.frame, self.lines)
        own = {part.name for part in self.plan.frame.caller_parts}
        for name, argument in self.values.items():
            if name not in own:
                self.lines.refuse_if(f"{argument} is not None")
        for part in self.plan.frame.caller_parts:
            assert isinstance(part, CounterPart | ValuePart)
            if part.type.is_text:
                self._read_text(part)
            else:
                self._read_number(part)
            if isinstance(part, ChoicePart):
                values = tuple_of(map(str, part.values))
                self.lines.refuse_if(f"{_variable(part)} not in {values}")
            if not _is_plain(part.type) and not part.type.is_text:
                integers.append(f"{part.name}_")
        return integers

    def _read_number(self, part: ValuePart | CounterPart) -> None:
        if part.default is not None:
            self.lines.add(f"if {part.name}_ is None:")
            self.lines.add(f"    {part.name}_ = {part.default}")
        least, greatest = part.least, part.greatest
        if isinstance(part, ChoicePart):
            return
        if not _is_plain(part.type) or (least, greatest) != (0, part.type.greatest):
            self.lines.refuse_if(f"not {least} <= {part.name}_ <= {greatest}")

    def _read_text(self, part: ValuePart | CounterPart) -> None:
        number = f"{text_reader(part, self.lines)}({part.name}_)"
        if part.default is not None:
            number = f"{part.default} if {part.name}_ is None else {number}"
        self.lines.add(f"{_variable(part)} = {number}")

    def _payload(self) -> None:
        length = self.plan.length
        if length is not None:
            counted = length.base + length.optional
            least = max(0, length.part.least - counted)
            greatest = min(self.plan.payload.greatest, length.part.greatest - counted)
            if least or self.frame.greatest_payload > greatest:
                self.lines.refuse_if(f"not {least} <= len(payload) <= {greatest}")

    # --- parts in wire order ----------------------------------------------------------------------

    def _make(self, bare: bool) -> None:
        """Return the wire bytes; `bare`: of a frame without a payload and its checksums."""
        present = [part for part in self.frame.parts if not (bare and part.is_optional)]
        parts = [part for part in present if not self.frame.is_skipped(part)]
        checked = [part for part in parts if isinstance(part, ChecksumPart)]
        self.lines.add(f"content = {self._joined([p for p in parts if p not in checked], bare)}")
        for part in checked:
            self._insert(part)
        self._return(bare)

    def _joined(self, parts: list[Part], bare: bool) -> str:
        """These parts one after another, numbers packed together."""
        packer = Packer(self.lines)
        for part in parts:
            if _is_packed(part):
                packer.pack(self._packed(part, bare))
            else:
                packer.piece(self._piece(part, bare))
        return " + ".join(packer.all_pieces()) or 'b""'

    def _piece(self, part: Part, bare: bool) -> str:
        match part:
            case LiteralPart():
                return literal(part.bytes)
            case PayloadPart():
                return "payload"
            case NumberPart() | BitsPart():
                return f"{self.lines.constants.number(part.type)}.encode({self._value(part, bare)})"
        raise TypeError(f"{type(part).__name__} is no part that has bytes here")

    def _value(self, part: NumberPart | BitsPart, bare: bool) -> str:
        if isinstance(part, BitsPart):
            return self._joined_bits(part, bare)
        lengths = (self.plan.length, *self.plan.further_lengths)
        length = next((item for item in lengths if item and part.name == item.part.name), None)
        if length is not None:
            counted = length.base + (0 if bare else length.optional)
            if self._fixed is not None:
                return str(self._fixed + counted)
            return f"len(payload) + {counted}" if counted else "len(payload)"
        if isinstance(part, IdentityPart):
            return self._identity[self.plan.identity.index(part)]
        assert isinstance(part, CounterPart | ValuePart)
        return _variable(part)

    def _joined_bits(self, part: BitsPart, bare: bool) -> str:
        """The number whose bits are parts."""
        terms = [f"0x{part.fixed:02X}"] if part.fixed else []
        for item in part.members:
            low = place_of(item.type)
            value = self._value(item, bare)
            terms.append(f"{value} << {low}" if low else value)
        terms += [self._mirror(item, bare) for item in part.mirrors]
        return " | ".join(terms)

    def _mirror(self, item: MirrorBits, bare: bool) -> str:
        """The bits that follow from another number, where they stand."""
        value, low = self._value(item.of, bare), place_of(item.type)
        if value.isdigit():
            return str(item.follows(int(value)) << low)
        if item.inverted:
            value = f"{bracketed(value)} ^ 0x{item.flips:02X}"
        return f"{bracketed(value)} << {low}" if low else value

    def _insert(self, part: ChecksumPart) -> None:
        """Put a checksum behind all that the content has; only the last parts are checksums."""
        due = self._folded(part) or checksum(
            part, self._covered(part), self.frame, self.lines.constants
        )
        if _is_plain(part.type) and part.type.size == 1:
            self.lines.add(f"content += _BYTES[{due}]")
        elif _is_plain(part.type):
            order = part.type.byte_order
            self.lines.add(f'content += ({due}).to_bytes({part.type.size}, "{order}")')
        else:
            self.lines.add(f"content += {self.lines.constants.number(part.type)}.encode({due})")

    def _folded(self, part: ChecksumPart) -> str:
        """The exclusive or of a message's payload as an expression; nothing for anything else."""
        message, covered, spec = self.message, self._covered(part), part.algorithm
        if message is None or not (covered == "payload" or self._covers_payload(part, covered)):
            return ""
        if not is_plain_xor(spec):
            return ""
        if self._fixed is not None:
            return folded(self.lines, covered, "", self._fixed)
        return folded(self.lines, covered, f"len({covered}) > {FOLDED}", message.sizes.greatest)

    def _covered(self, part: ChecksumPart) -> str:
        """Bytes that a checksum covers, while the content ends where the part begins."""
        frame = self.frame
        missing = -frame.offset(part)
        covered = frame.covered(part, "content", missing, virtual=self._virtual)
        return "payload" if self._has_payload and self._covers_payload(part, covered) else covered

    def _virtual(self, part: VirtualPart) -> str:
        """Bytes of a part that is not sent."""
        value = None if self.message is None else self.message.virtual_value(part)
        if value is not None:
            return literal(part.encode(value))
        return virtual_bytes(self.frame, part, self._identity, self.lines.constants)

    @property
    def _is_cut_off(self) -> bool:
        """True if the frame may be longer than any that a decoder takes."""
        framings = self.frame.sender.framing.messages
        name = None if self.message is None else self.message.name
        return self.plan.is_cut_off and any(
            item.is_cut_off for item in framings if name in (item.message, None)
        )

    def _return(self, bare: bool) -> None:
        frame = self.frame
        wire = self._stuffed(0 if bare else frame.behind) if frame.stuffed else "content"
        if frame.front:
            wire = f"{literal(frame.front)} + {wire}"
        if self.plan.end_bytes:
            wire += f" + {literal(self.plan.end_bytes)}"
        is_cut_off = self._is_cut_off
        if not (self.plan.cut_ambiguous or is_cut_off):
            self.lines.add(f"return {wire}")
            return
        self.lines.add(f"wire = {wire}")
        if is_cut_off:
            self.lines.refuse_if(f"len(wire) > {self.plan.greatest}")
        if not self.plan.cut_ambiguous:
            self.lines.add("return wire")
            return
        # A decoder might end the frame elsewhere.
        self.lines.add(f"return _fast.checked(wire, _cut_{self.name})")

    def _stuffed(self, size_behind: int) -> str:
        """The content, stuffed but for its last bytes unless it stands for itself."""
        frame = self.frame
        front = frame.before - frame.skipped
        inner = frame.slice_of("content", front, -size_behind)
        encode = f"{self.stuffing()}.encode"
        before = f"content[:{front}] + " if front else ""
        behind = f" + content[{-size_behind}:]" if size_behind else ""
        specials = frame.specials(sending=True)
        if specials is None or before or behind:
            return f"{before}{encode}({inner}){behind}"
        found = " or ".join(f"0x{byte:02X} in content" for byte in specials)
        with self.lines.block(f"if {found}:"):
            if frame.replacements is None:
                self.lines.add(f"content = {encode}(content)")
            else:
                for byte, code in frame.replacements:
                    self.lines.add(f"content = content.replace({literal(byte)}, {literal(code)})")
        return "content"


def _is_packed(part: Part) -> bool:
    """True if `struct` writes the part together with its neighbours."""
    if isinstance(part, LiteralPart):
        return len(part.bytes) == 1
    return isinstance(part, NumberPart | BitsPart) and _is_plain(part.type)


def _is_plain(type_: PartType) -> bool:
    is_whole = type_.text is None and type_.within is None
    return type_.byte_bits == 8 and type_.bits in (8, 16, 32, 64) and is_whole
