"""Base of the functions that look at frames: numbers of the head, starts, sizes."""

from __future__ import annotations

from protogen.model.framing import are_run
from protogen.model.parts import BitsPart, PartType, TypedPart
from protogen.targets.python import frames as tables
from protogen.targets.python.engine.frames import EngineFrame
from protogen.targets.python.engine.layout import UNSIGNED, byte_order
from protogen.targets.python.engine.lines import Lines
from protogen.targets.python.engine.place import Place


class FrameFunction:
    """Writes the body of one function."""

    def __init__(self, frame: EngineFrame, lines: Lines) -> None:
        self.frame = frame
        self.plan = frame.plan
        self.lines = lines
        self.name = frame.sender.name

    def starts(self) -> str:
        """The search for one of the words that frames start with."""
        return self.lines.constants.named("STARTS", f"_re.compile({self._pattern()}).search")

    def _pattern(self) -> str:
        words = ["".join(f"\\x{byte:02x}" for byte in word) for word in self.plan.start_words]
        if self.plan.start_size > 1:
            return f'rb"{"|".join(words)}"'
        is_run = are_run(self.plan.start_set)
        return f'rb"[{words[0]}-{words[-1]}]"' if is_run else f'rb"[{"".join(words)}]"'

    @property
    def is_seen_by_bits(self) -> bool:
        """True if the check for 7-bit bytes finds any start inside of a frame."""
        plan = self.plan
        alone = plan.head_size == 1 and not plan.tail and plan.region is None
        outside = not any(byte in plan.start_set for byte in plan.end_bytes)
        high = bool(plan.start_set) and plan.start_set[0] >= 0x80
        return plan.seven_bit and high and alone and outside

    def number(self, source: str, part: TypedPart, base: str | None = None) -> str:
        """The value of a part of the head, in the content or, with a base, in the data.

        The base is where the frame starts in them: a variable, or empty where it is at 0.
        """
        # In the data, counted from the frame's start, nothing is skipped.
        skipped = 0 if base is None else self.frame.skipped
        return self.number_at(source, part, Place(base or "", self.frame.offset(part) + skipped))

    def number_at(self, source: str, part: TypedPart, first: Place) -> str:
        """The value of a part whose bytes begin at that place."""
        within = part.type.within
        if within is not None:
            holder = self.plan.frame.holder(part.name)
            assert isinstance(holder, BitsPart)
            every = 8 * within.size if holder.type.byte_bits == 8 else holder.type.bits
            moved = f" >> {within.low}" if within.low else ""
            is_top = within.low + part.type.bits == every
            mask = "" if is_top else f" & 0x{part.type.greatest:02X}"
            return f"{self.number_at(source, holder, first)}{moved}{mask}"
        if part.type.size == 1 and not self.has_padding(part.type):
            return f"{source}[{first.text}]"
        code = UNSIGNED.get(part.type.size)
        if code is not None and not self.has_padding(part.type):
            layout = byte_order(part.type) + code
            unpack = self.lines.constants.named("UNPACK", f'_struct.Struct("{layout}").unpack_from')
            return f"{unpack}({source}, {first.text})[0]"
        behind = Place(first.variable, first.offset + part.type.size)
        piece = f"{source}[{first.text} : {behind.text}]"
        if self.has_padding(part.type):
            return f"{self.lines.constants.number(part.type)}.decode({piece})"
        return f'int.from_bytes({piece}, "{part.type.byte_order}")'

    def stuffing(self) -> str:
        """The encoding of the stuffed region, as an encoder applies it."""
        assert self.plan.region is not None
        return self.lines.constants.named("STUFFING", tables.encoding(self.plan.region.encoding))

    def identity(self, source: str, base: str | None = None) -> str:
        """The values of all identity parts, between commas."""
        return ", ".join(self.number(source, part, base) for part in self.plan.identity) or "()"

    @staticmethod
    def has_padding(type_: PartType) -> bool:
        """True if some bits of the bytes have to be clear, or the bytes be digits."""
        return type_.bits % 8 != 0 or type_.byte_bits == 7 or type_.text is not None
