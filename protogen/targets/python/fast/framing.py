"""Functions that make frames: a payload and the frame's numbers become bytes on the wire."""

from __future__ import annotations

from protogen.model.frame import (
    ChecksumPart,
    CounterPart,
    IdentityPart,
    LengthPart,
    LiteralPart,
    NumberPart,
    Part,
    PayloadPart,
    ValuePart,
)
from protogen.model.types import Integer
from protogen.model.wire import fixed_size
from protogen.targets.python import frames as tables
from protogen.targets.python.fast.cutting import checksum
from protogen.targets.python.fast.frames import FastFrame
from protogen.targets.python.fast.lines import Constants, Lines
from protogen.targets.python.literals import octets_in_class as literal

_CODES = {1: "B", 2: "H", 4: "I", 8: "Q"}


def framer(frame: FastFrame, of_caller: tuple[str, ...], constants: Constants) -> tuple[str, ...]:
    """The body of `_frame_SENDER(payload, IDENTITY..., VALUES...)`."""
    return _Framer(frame, of_caller, Lines(constants)).body()


def arguments(frame: FastFrame, of_caller: tuple[str, ...]) -> list[str]:
    """The numbers that the function takes: identity parts, then what callers of `encode` give."""
    identity = [f"{part.name}_" for part in frame.identity]
    return [*identity, *_of_caller(frame, of_caller)]


def _of_caller(frame: FastFrame, names: tuple[str, ...]) -> list[str]:
    """Names of arguments: a part of other senders only may be called like an identity of this."""
    own = {part.name for part in frame.sender.frame.caller_parts}
    return [f"{name}_" if name in own else f"other{index}" for index, name in enumerate(names)]


class _Framer:
    """Writes the body of one function."""

    def __init__(self, frame: FastFrame, of_caller: tuple[str, ...], lines: Lines) -> None:
        self.frame = frame
        self.of_caller = of_caller
        self.lines = lines

    def body(self) -> tuple[str, ...]:
        self._values()
        self._payload()
        if self.frame.framing.cut_ambiguous:
            self.lines.add("events: list[_typing.Any] = []")
        if self.frame.optional:
            with self.lines.block("if payload:"):
                self._make(bare=False)
            self._make(bare=True)
        else:
            self._make(bare=False)
        return self.lines.text

    def _values(self) -> None:
        for name in _of_caller(self.frame, self.of_caller):
            if not name.endswith("_"):
                self.lines.refuse_if(f"{name} is not None")
        for part in self.frame.sender.frame.caller_parts:
            assert isinstance(part, CounterPart | ValuePart)
            if part.default is not None:
                self.lines.add(f"if {part.name}_ is None:")
                self.lines.add(f"    {part.name}_ = {part.default}")
            allowed = f"{part.least} <= {part.name}_ <= {part.greatest}"
            self.lines.refuse_if(f"type({part.name}_) is not int or not {allowed}")

    def _payload(self) -> None:
        frame = self.frame
        least, greatest = 0, frame.framing.payload.greatest
        if frame.length is not None:
            counted = self._counted(frame.length, bare=False)
            least = max(0, frame.length.least - counted)
            greatest = min(greatest, frame.length.greatest - counted)
            if least or not self._always_fits(greatest):
                self.lines.refuse_if(f"not {least} <= len(payload) <= {greatest}")
        if frame.framing.seven_bit:
            self.lines.refuse_if("not payload.isascii()")

    def _always_fits(self, greatest: int) -> bool:
        """Whether the sizes of all messages are in bounds."""
        return all(message.sizes.greatest <= greatest for message in self.frame.sender.messages)

    def _counted(self, part: LengthPart, bare: bool) -> int:
        return sum(
            fixed_size(other)
            for other in self.frame.sender.frame.parts
            if other.name in part.counts
            and not (bare and isinstance(other, ChecksumPart) and other.when_payload)
        )

    # --- parts in wire order ----------------------------------------------------------------------

    def _make(self, bare: bool) -> None:
        """Return the wire bytes; `bare`: of a frame without a payload and its checksums."""
        frame = self.frame
        parts = [part for part in frame.parts if not (bare and _is_optional(part))]
        checked = [part for part in parts if isinstance(part, ChecksumPart)]
        self.lines.add(f"content = {self._joined([p for p in parts if p not in checked], bare)}")
        for part in checked:
            self._insert(part, parts)
        self._return()

    def _joined(self, parts: list[Part], bare: bool) -> str:
        """These parts one after another, numbers packed together."""
        pieces: list[str] = []
        run: list[tuple[str, str, str]] = []

        def flush() -> None:
            if run:
                order = next((order for order, _, _ in run if order), "<")
                layout = f'"{order}{"".join(code for _, code, _ in run)}"'
                pack = self.lines.constants.named("PACK", f"_struct.Struct({layout}).pack")
                pieces.append(f"{pack}({', '.join(value for _, _, value in run)})")
                run.clear()

        for part in parts:
            if isinstance(part, NumberPart) and _is_plain(part.type):
                order = _order(part.type)
                if order and any(other and other != order for other, _, _ in run):
                    flush()
                run.append((order, _CODES[part.type.size], self._value(part, bare)))
            elif isinstance(part, LiteralPart) and len(part.bytes) == 1:
                run.append(("", "B", f"0x{part.bytes[0]:02X}"))
            else:
                flush()
                pieces.append(self._piece(part, bare))
        flush()
        return " + ".join(pieces) or 'b""'

    def _piece(self, part: Part, bare: bool) -> str:
        match part:
            case LiteralPart():
                return literal(part.bytes)
            case PayloadPart():
                return "payload"
            case NumberPart():
                return f"{self._codec(part.type)}.encode({self._value(part, bare)})"
        raise TypeError(f"{type(part).__name__} is no part that has bytes here")

    def _value(self, part: NumberPart, bare: bool) -> str:
        if isinstance(part, LengthPart):
            counted = self._counted(part, bare)
            return f"len(payload) + {counted}" if counted else "len(payload)"
        assert isinstance(part, IdentityPart | CounterPart | ValuePart)
        return f"{part.name}_"

    def _codec(self, type_: Integer) -> str:
        seven = type_.byte_bits == 7
        listed = f'{type_.bits}, {type_.signed}, "{type_.byte_order}", {seven}'
        return self.lines.constants.named("NUMBER", f"_rt.Number({listed})")

    def _insert(self, part: ChecksumPart, parts: list[Part]) -> None:
        """Put a checksum behind all that the content has; only the last parts are checksums."""
        due = checksum(part, self._covered(part), self.frame, self.lines.constants)
        if _is_plain(part.type) and part.type.size == 1:
            self.lines.add(f"content += _BYTES[{due}]")
        else:
            self.lines.add(f"content += {self._codec(part.type)}.encode({due})")

    def _covered(self, part: ChecksumPart) -> str:
        """What a checksum covers, while the content ends where the part begins."""
        frame = self.frame
        missing = -frame.offset(part)
        return frame.covered(part, "content", missing)

    def _return(self) -> None:
        frame = self.frame
        wire = "content"
        if frame.stuffed:
            before = f"content[:{frame.before}] + " if frame.before else ""
            behind = f" + content[{-frame.behind}:]" if frame.behind else ""
            inner = frame.slice_of("content", frame.before, -frame.behind)
            assert frame.sender.frame.transparency is not None
            stuffing = tables.encoding(frame.sender.frame.transparency.encoding)
            encode = f"{self.lines.constants.named('STUFFING', stuffing)}.encode"
            wire = f"{before}{encode}({inner}){behind}"
        if frame.end:
            wire += f" + {literal(frame.end)}"
        if not frame.framing.cut_ambiguous:
            self.lines.add(f"return {wire}")
            return
        # A decoder might end the frame elsewhere.
        self.lines.add(f"wire = {wire}")
        self.lines.add(f"end = _cut_{frame.sender.name}(wire, 0, 0, events)")
        self.lines.refuse_if("end != len(wire) or [event.payload for event in events] != [payload]")
        self.lines.add("return wire")


def _is_optional(part: Part) -> bool:
    return isinstance(part, ChecksumPart) and part.when_payload


def _is_plain(type_: Integer) -> bool:
    return type_.byte_bits == 8 and type_.bits in (8, 16, 32, 64)


def _order(type_: Integer) -> str:
    if type_.size == 1:
        return ""
    return "<" if type_.byte_order == "little" else ">"
