"""Functions that cut frames: bytes on the wire become events, as long as they are in order."""

from __future__ import annotations

from protogen.model.frame_plan import EndRule
from protogen.model.part_plans import LengthPlan
from protogen.model.parts import BitsPart, ChoicePart, LiteralPart, NumberPart
from protogen.runtime.bulk_cut import MIN_DATA
from protogen.targets.python import frames as tables
from protogen.targets.python.engine import identities
from protogen.targets.python.engine.frames import EngineFrame
from protogen.targets.python.engine.lines import Constants, Lines
from protogen.targets.python.engine.locating import Locator
from protogen.targets.python.engine.place import Place
from protogen.targets.python.literals import bracketed, tuple_of
from protogen.targets.python.literals import octets_in_class as literal


def cutter(frame: EngineFrame, constants: Constants) -> tuple[str, ...]:
    """The body of `_cut_SENDER(data, at, base, events)`.

    It takes whole frames from `at` on, appends their events, and gives the place of the first byte
    that it did not take. `base` is the offset of the data in the input.
    """
    return _Cutter(frame, Lines(constants)).body()


class _Cutter(Locator):
    """Writes the body of one function."""

    def body(self) -> tuple[str, ...]:
        self.lines.add("size = len(data)")
        if self.lines.constants.use("_TABLES."):
            self.lines.add("if not _TABLES.are_filled:")
            self.lines.add("    _TABLES.fill()")
        if self.frame.can_cut_in_bulk:
            self._runs()
        self.lines.add("add = events.append")
        if self.plan.end_rule is EndRule.NEXT_START:
            # Behind a frame that ends where the next start is, that needs not be checked again.
            with self.lines.block("try:"):
                self.start()
            with self.lines.block("except _fast.ANYTHING:  # There is nothing."):
                self.lines.add("return at")
        with self.lines.block("try:"), self.lines.block("while at < size:"):
            if self.plan.end_rule is not EndRule.NEXT_START:
                self.start()
            self._frame()
            self._event()
        with self.lines.block("except _fast.ANYTHING:  # The reference looks at what is here."):
            self.lines.add("pass")
        self.lines.add("return at")
        return self.lines.text

    def _runs(self) -> None:
        """Take runs of frames of one message at once, if their checksum is one that allows it."""
        frame = self.frame
        (part,) = frame.checksums
        covered = self.covered(part)
        first = self.xors_to_nothing(part, covered)
        if first is None and not self.sums_to_nothing(part, covered):
            return
        assert frame.remembered is not None
        counting = [item for item in frame.shown if item not in self.plan.identity]
        counter = frame.offset(counting[0]) if counting else None
        places = range(self.plan.head_size - frame.skipped)
        specials = frame.specials(sending=False)
        assert specials is not None
        codes = (
            tuple_of((literal(byte), literal(code))) for byte, code in frame.replacements or ()
        )
        given = {
            "start": literal(self.plan.start_bytes),
            "end": literal(self.plan.end_bytes),
            "greatest": self.plan.greatest,
            "codes": tuple_of(codes),
            "specials": literal(bytes(specials)),
            "head": "slice({}, {})".format(*frame.remembered),
            "alike": tuple_of(str(place) for place in places if place != counter),
            "counter": counter,
            "xor_from": first,
        }
        arguments = ", ".join(f"{name}={value}" for name, value in given.items())
        runs = self.lines.constants.named("BULK", f"_fast.BulkCutter({arguments})")
        with self.lines.block(f"if size - at > {MIN_DATA}:"):
            of_sender = f"_cut_{self.name}, _{self.name.upper()}_HEADS"
            self.lines.add(f"at = {runs}.take(data, at, base, events, {of_sender})")

    def _frame(self) -> None:
        """Set `payload`, and what else of the frame is wanted."""
        self.locate()
        self._content()
        self._payload()
        self._head()
        self.compare_checksums()

    # --- what is in it ----------------------------------------------------------------------------

    def _content(self) -> None:
        """Set `content`, where the frame's bytes are not the content themselves."""
        frame = self.frame
        if self.content == "raw":
            return
        first = "begun - at" if self.plan.shares_delimiter else str(frame.before or "")
        last = str(-(len(self.plan.end_bytes) + frame.behind) or "")
        if frame.stuffed and (frame.before > len(self.plan.start_bytes) or frame.behind):
            # Else what is in front of the stuffed bytes and what is behind them would overlap.
            around = len(self.plan.end_bytes) + frame.behind
            least = (
                f"{first} + {around}" if self.plan.shares_delimiter else f"{frame.before + around}"
            )
            self.stop_if(f"len(raw) < {least}")
        self.lines.add(f"content = raw[{first}:{last}]")
        if not frame.stuffed:
            return
        self._unstuffed()
        pieces = ["content"]
        if frame.before and not frame.skipped:
            pieces.insert(0, f"raw[:{frame.before}]")
        if frame.behind:
            pieces.append(f"raw[{last}:{-len(self.plan.end_bytes) or ''}]")
        if len(pieces) > 1:
            self.lines.add(f"content = {' + '.join(pieces)}")

    def _unstuffed(self) -> None:
        """Take the stuffing off, as an encoder would have put it on.

        What only a lenient receiver takes is left to the reference.
        """
        decode = f"{self.stuffing()}.decode"
        specials = self.frame.specials(sending=False)
        if specials is None:
            self.lines.add(f"content = {decode}(content)")
            return
        found = " or ".join(f"0x{byte:02X} in content" for byte in specials)
        with self.lines.block(f"if {found}:"):
            if self.length_bounds:
                self.not_too_long()
            if self.frame.replacements is None:
                self.lines.add(f"content = {decode}(content)")
            else:
                self._replaced()

    def _replaced(self) -> None:
        """Take codes off; encoding the outcome again must reproduce the input."""
        assert self.frame.replacements is not None
        self.lines.add("stuffed = content")
        for byte, code in reversed(self.frame.replacements):
            self.lines.add(f"content = content.replace({literal(code)}, {literal(byte)})")
        source = "content"
        for byte, code in self.frame.replacements:
            self.lines.add(f"again = {source}.replace({literal(byte)}, {literal(code)})")
            source = "again"
        self.stop_if("again != stuffed")

    def _payload(self) -> None:
        """Set `payload`, and check that there is room for it."""
        frame, length = self.frame, self.plan.length
        around = self.plan.head_size - frame.skipped + self.plan.tail_size
        sliced = f"payload = {self.payload_slice}"
        if length is not None and not self.plan.optional_size:
            if self.plan.end_rule is not EndRule.LENGTH or frame.stuffed:
                self._length(length, around)
            if not frame.gives_content:
                self.lines.add(sliced)
        elif self.plan.optional_size:
            with self.lines.block(f"if len({self.content}) <= {around}:"):
                self.stop_if(f"len({self.content}) != {around - self.plan.optional_size}")
                self.lines.add('payload = b""')
            with self.lines.block("else:"):
                self.lines.add(sliced)
            if length is not None:
                self.stop_if(f"len(payload) > {self.plan.payload.greatest}")
                self._optional_length(length)
        else:
            if self.plan.end_rule in (EndRule.DELIMITER, EndRule.NEXT_START):
                self.stop_if(f"len({self.content}) < {max(around, 1)}")
            if not frame.gives_content:
                self.lines.add(sliced)
        if self.plan.seven_bit:
            self.stop_if("not payload.isascii()")

    def _length(self, length: LengthPlan, around: int) -> None:
        """A length in bounds that is right tells that all other parts are there."""
        part, counted = length.part, length.base + length.optional
        behind = self.frame.offset(part) + part.type.size
        if part.type.size > 1 and (
            around < behind or self.plan.end_rule in (EndRule.DELIMITER, EndRule.NEXT_START)
        ):
            self.stop_if(f"len({self.content}) < {behind}")
        self.lines.add(f"length = {self.number(self.content, part)}")
        rest = around - counted
        due = f"length + {rest}" if rest > 0 else f"length - {-rest}" if rest else "length"
        size = f"len({self.content})"
        least, greatest = self.payload_bounds(length)
        if least + counted > 0 or greatest + counted < part.type.greatest:
            self.stop_if(f"not {least + around} <= {size} == {due} <= {greatest + around}")
        else:
            self.stop_if(f"{size} != {due}")

    def _optional_length(self, length: LengthPlan) -> None:
        part, number = length.part, self.number(self.content, length.part)
        absent = f"{length.optional} * (not payload)"
        self.stop_if(f"{number} != len(payload) + {length.base + length.optional} - {absent}")
        self.stop_if(f"not {part.least} <= {number} <= {part.greatest}")

    def _head(self) -> None:
        for part in self.frame.head:
            if isinstance(part, LiteralPart) and not self.frame.is_start(part):
                first, source = self.frame.offset(part), self.content
                if first < 0:
                    first, source = first + self.frame.skipped, "raw"
                self.stop_if(f"not {source}.startswith({literal(part.bytes)}, {first})")
            elif isinstance(part, BitsPart) and part.mask:
                place = Place("", self.frame.offset(part))
                number = self.number_at(self.content, part, place)
                self.stop_if(f"{number} & 0x{part.mask:02X} != 0x{part.fixed:02X}")
        self._mirrors()
        self._further_lengths()
        for item in self.plan.bounded:
            part = item.part
            assert isinstance(part, NumberPart)
            number = self.number(self.content, part)
            if part.between is not None:
                characters = self.lines.constants.named("NUMBER", tables.number(part))
                self.stop_if(f"not {characters}.holds({number})")
            elif not isinstance(part, ChoicePart):
                self.stop_if(f"not {part.least} <= {number} <= {part.greatest}")
            elif item.end > self.plan.start_size:
                self.stop_if(f"{number} not in {tuple_of(map(str, part.values))}")

    def _mirrors(self) -> None:
        """Check bits that follow from other numbers."""
        for mirror in self.plan.frame.mirrors:
            bits = self.number(self.content, mirror)
            of = self.number(self.content, mirror.of)
            differs = f"{bracketed(bits)} ^ {bracketed(of)} != 0x{mirror.flips:02X}"
            self.stop_if(differs if mirror.inverted else f"{bits} != {of}")

    def _further_lengths(self) -> None:
        """Hold other lengths against the first, which the size of the payload agrees with."""
        for length in self.plan.further_lengths:
            first = bracketed(self.number(self.content, length.first.part))
            sign = "+" if length.more > 0 else "-"
            due = f"{first} {sign} {abs(length.more)}" if length.more else first
            absent = length.more - length.more_if_empty
            if absent:
                due += f" - {absent} * ({first} == {length.first.base})"
            self.stop_if(f"{bracketed(self.number(self.content, length.part))} != {due}")

    # --- the event --------------------------------------------------------------------------------

    def _event(self) -> None:
        self._numbers()
        self.lines.add("event: _typing.Any = _MessageEvent()")
        self.lines.add(f"event.message = read({self._read_from})")
        self.lines.add("event.offset = base + at")
        for name in ("raw", "numbers"):
            self.lines.add(f"event.{name} = {name}")
        self.lines.add(f"event.codec = {self.name.upper()}_SENDER")
        self.lines.add("event.kept_parts = None")
        self.lines.add("add(event)")
        self.lines.add("at = end")

    @property
    def _read_from(self) -> str:
        """Argument of readers."""
        if self.plan.is_fitted:
            known = "payload[:full]" if self.plan.is_cut else "payload"
            return f'{known}.ljust(full, b"\\0")' if self.plan.is_trimmed else known
        return self.content if self.frame.gives_content else "payload"

    def _numbers(self) -> None:
        """Set `numbers`, and `read` unless the place of the end has told it."""
        frame = self.frame
        if self.plan.end_rule is EndRule.IDENTITY:
            if not frame.shows_identity:
                numbers = (self.number(self.content, part) for part in frame.shown)
                self.lines.add(f"numbers = {tuple_of(numbers)}")
        elif frame.remembered is not None:
            first, last = frame.remembered
            head = f"{self.content}[{first}:{last}]"  # A stream repeats it over and over.
            self._look_up("numbers, ", f"_{self.name.upper()}_HEADS[{head}]")
        else:
            names = [f"n{index}" for index, _ in enumerate(frame.shown)]
            for name, part in zip(names, frame.shown, strict=True):
                self.lines.add(f"{name} = {self.number(self.content, part)}")
            self.lines.add(f"numbers = {tuple_of(names)}")
            identity = [names[frame.shown.index(part)] for part in self.plan.identity]
            self._look_up("", identities.entry(frame, identity))

    def _look_up(self, numbers: str, entry: str) -> None:
        """Set `read`, and what stands in front of it, from the entry of a table."""
        if self.plan.length is None:
            self.lines.add(f"{numbers}payload_size, read = {entry}")
            self.stop_if("0 <= payload_size != len(payload)")
            return
        full = "full, " if self.plan.is_fitted else ""
        self.lines.add(f"{numbers}{full}read = {entry}")
        with self.lines.block("if read is None:"):
            self._unknown()

    def _unknown(self) -> None:
        spec = f"{self.name.upper()}_SENDER"
        payload = self.payload_slice if self.frame.gives_content else "payload"
        self.lines.add(f"add(_fast.unknown({spec}, base + at, raw, numbers, {payload}))")
        self.lines.add("at = end")
        self.lines.add("continue")
