"""Where frames begin and end, as statements of a function that cuts them."""

from __future__ import annotations

from protogen.model.frame_plan import EndRule, StartRule
from protogen.model.framing import are_run
from protogen.model.part_plans import LengthPlan
from protogen.targets.python.engine.checksums import ChecksumFunction
from protogen.targets.python.engine.place import Place
from protogen.targets.python.literals import bracketed, tuple_of
from protogen.targets.python.literals import octets_in_class as literal


class Locator(ChecksumFunction):
    """Printer of a function that finds out where a frame begins and ends."""

    def place(self, offset: int) -> str:
        """So many bytes behind the start of the frame."""
        return Place("at", offset).text

    def locate(self) -> None:
        """Set `raw`, the frame's bytes, and `end`, the place behind them."""
        match self.plan.end_rule:
            case EndRule.NEXT_START:
                self._until_start()
            case EndRule.DELIMITER:
                self._until_end()
            case EndRule.LENGTH:
                self._by_length()
            case EndRule.IDENTITY:
                self._by_kind()

    def start(self) -> None:
        """Check that a frame can begin here."""
        plan = self.plan
        if plan.start is StartRule.AFTER_END and plan.end_rule is not EndRule.DELIMITER:
            # Nothing in front of an end is no frame, even where frames begin with the same bytes.
            self.stop_if(f"data.startswith({literal(plan.end_bytes)}, at)")
        elif plan.start is StartRule.SET and not self._identity_starts:
            self.stop_if(self._is_no_start())
        elif plan.start is StartRule.LITERAL:
            begins = f"data.startswith({literal(plan.start_bytes)}, at)"
            if plan.shares_delimiter:
                # The place behind the start, which may be the end of the frame before.
                self.lines.add(f"begun = at + {len(plan.start_bytes)} * {begins}")
            elif len(plan.start_bytes) == 1:
                self.stop_if(f"data[{self.place(0)}] != 0x{plan.start_bytes[0]:02X}")
            else:
                self.stop_if(f"not {begins}")

    def _is_no_start(self) -> str:
        """The condition that no word stands here that frames start with."""
        first, starts = f"data[{self.place(0)}]", self.plan.start_set
        if not starts:
            words = tuple_of(map(literal, self.plan.start_words))
            return f"not data.startswith({words}, at)"
        if are_run(starts):
            return f"not 0x{starts[0]:02X} <= {first} <= 0x{starts[-1]:02X}"
        return f"{first} not in {literal(bytes(starts))}"

    @property
    def _identity_starts(self) -> bool:
        """True if the first byte is the identity's, which is looked up to find the end."""
        return self.plan.end_rule is EndRule.IDENTITY and self.frame.parts[0] in self.plan.identity

    def _until_start(self) -> None:
        if self.plan.start is StartRule.LITERAL:
            self.lines.add(f"end = data.find({literal(self.plan.start_bytes)}, at + 1)")
        else:
            self.lines.add(f"found = {self.starts()}(data, at + 1)")
            self.lines.add("end = -1 if found is None else found.start()")
        with self.lines.block("if end < 0:"):
            # A length tells whether the last frame is all there; else the next start has to.
            if self.plan.length is None:
                self.lines.add("return at")
            else:
                self.lines.add("end = size")
        if self.plan.start_size > 1:
            # Two starts that overlap.
            self.stop_if(f"end < at + {self.plan.start_size}")
        self._raw()

    def _until_end(self) -> None:
        begun = "begun" if self.plan.shares_delimiter else self.place(self.plan.mark_size)
        self.lines.add(f"end = data.find({literal(self.plan.end_bytes)}, {begun}{self._bound})")
        self.stop_if("end < 0")
        self.lines.add(f"end += {len(self.plan.end_bytes)}")
        self._raw()
        if not self._is_stuffed_throughout:
            self._no_start_inside()

    @property
    def _bound(self) -> str:
        """An argument that lets `find` look no further than the longest frame goes.

        Else each of many starts that have no end would be looked for one in all that has come.
        """
        return f", {self.place(self.plan.greatest)}"

    @property
    def _is_stuffed_throughout(self) -> bool:
        """True if all between start and end is stuffed, so that unstuffing it finds any start."""
        frame = self.frame
        return frame.stuffed and frame.before == len(self.plan.start_bytes) > 0 and not frame.behind

    def _raw(self) -> None:
        if self.plan.end_rule in (EndRule.LENGTH, EndRule.IDENTITY):
            self.stop_if("end > size")
        self.lines.add("raw = data[at:end]")
        if not self.length_bounds:
            self.not_too_long()

    @property
    def length_bounds(self) -> bool:
        """True if the length bounds all frames in which nothing is stuffed."""
        frame, plan = self.frame, self.plan
        bare = self.overhead + plan.payload.greatest
        is_seen = not frame.stuffed or frame.specials(sending=False) is not None
        plain = plan.length is not None and not (plan.shares_delimiter or plan.optional_size)
        return plain and is_seen and bare <= plan.greatest

    @property
    def overhead(self) -> int:
        """Bytes of a frame besides its payload, where that is not empty and nothing is stuffed."""
        return self.plan.head_size + self.plan.tail_size + len(self.plan.end_bytes)

    def not_too_long(self) -> None:
        """Check that the frame is no longer than any can be, unless its end tells so."""
        if self.plan.end_rule is EndRule.DELIMITER and not self.plan.shares_delimiter:
            return  # Its end would not have been found.
        size = "len(raw)"
        if self.plan.shares_delimiter:
            size += f" + {len(self.plan.start_bytes)}"
        varies = self.plan.end_rule is not EndRule.IDENTITY or self.plan.has_open_groups
        if varies or self.plan.is_cut_off:
            self.stop_if(f"{size} > {self.plan.greatest}")

    def _no_start_inside(self) -> None:
        """A start that can't occur inside of a frame ends it where it stands."""
        plan = self.plan
        if not plan.start_is_unique:
            return
        if plan.start is StartRule.LITERAL and not plan.shares_delimiter:
            self.stop_if(f"raw.find({literal(plan.start_bytes)}, 1) > 0")
        elif plan.start is StartRule.SET and not self.is_seen_by_bits:
            self.stop_if(f"{self.starts()}(raw, 1)")

    def _by_length(self) -> None:
        around, length = self.overhead, self.plan.length
        assert length is not None
        counted = length.base + length.optional
        less = f" - {counted}" if counted else ""
        number = self.number("data", length.part, "at")
        self.lines.add(f"count = {bracketed(number) if less else number}{less}")
        if self.plan.optional_size:
            with self.lines.block(f"if count == {-length.optional}:"):
                self.lines.add(f"end = {self.place(around - self.plan.optional_size)}")
            with self.lines.block("elif count > 0:"):
                self.lines.add(f"end = {self.place(around)} + count")
            with self.lines.block("else:"):
                self.lines.add("return at")
        else:
            least, greatest = self.payload_bounds(length)
            self.stop_if(f"not {least} <= count <= {greatest}")
            self.lines.add(f"end = {self.place(around)} + count")
        self._sized()

    def payload_bounds(self, length: LengthPlan) -> tuple[int, int]:
        """The least and the greatest payload that a length can tell, and a frame can have."""
        part, counted = length.part, length.base + length.optional
        least = max(part.least - counted, 0)
        return least, min(part.greatest - counted, self.plan.payload.greatest)

    def _by_kind(self) -> None:
        frame, around = self.frame, self.overhead
        key = self.identity("data", "at")
        varies = self.plan.has_open_groups or self.plan.optional_size
        found = "payload_size, read" if varies else "frame_size, read"
        if frame.shows_identity:
            found += ", numbers"
        self.lines.add(f"{found} = _{self.name.upper()}_KINDS[{key}]")
        open_groups = self.plan.has_open_groups
        if open_groups and self.plan.end_bytes:
            with self.lines.block("if payload_size < 0:"):
                behind = self.place(self.plan.head_size)
                self.lines.add(
                    f"end = data.find({literal(self.plan.end_bytes)}, {behind}{self._bound})"
                )
                self.stop_if("end < 0")
                self.lines.add(f"end += {len(self.plan.end_bytes)}")
            head = "elif payload_size:" if self.plan.optional_size else "else:"
            with self.lines.block(head):
                self.lines.add(f"end = {self.place(around)} + payload_size")
            if self.plan.optional_size:
                with self.lines.block("else:"):
                    self.lines.add(f"end = {self.place(around - self.plan.optional_size)}")
        else:
            if open_groups:
                self.stop_if("payload_size < 0")
            less = (
                f" - {self.plan.optional_size} * (not payload_size)"
                if self.plan.optional_size
                else ""
            )
            if less or open_groups:
                self.lines.add(f"end = {self.place(around)} + payload_size{less}")
            else:
                self.lines.add("end = at + frame_size")
        self._sized()

    def _sized(self) -> None:
        """Take a frame of a known size."""
        self._raw()
        if self.plan.end_bytes:
            self.stop_if(f"not raw.endswith({literal(self.plan.end_bytes)})")
        self._no_start_inside()
