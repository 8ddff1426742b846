"""Functions that cut frames: bytes on the wire become events, as long as they are in order."""

from __future__ import annotations

from protogen.model.frame import LengthPart, LiteralPart
from protogen.model.frame_plan import EndRule
from protogen.model.framing import AfterEnd, StartLiteral, StartSet
from protogen.runtime.bulk_cut import MIN_DATA
from protogen.targets.python import frames as tables
from protogen.targets.python.engine.checksums import ChecksumFunction
from protogen.targets.python.engine.frames import EngineFrame
from protogen.targets.python.engine.lines import Constants, Lines
from protogen.targets.python.engine.place import Place
from protogen.targets.python.literals import octets_in_class as literal
from protogen.targets.python.literals import tuple_of

_MANY, _FIRST, _TOGETHER = 1024, 4, 64
"""Bytes from which on exclusive ors are compared together; those of how many frames at first, and
at most.

They are checked after events were made, which are dropped from the first wrong one on. So what is
done in vain is in proportion to what was not, and bounded.
"""


def cutter(frame: EngineFrame, constants: Constants) -> tuple[str, ...]:
    """The body of `_cut_SENDER(data, at, base, events)`.

    It takes whole frames from `at` on, appends their events, and gives the place of the first byte
    that it did not take. `base` is the offset of the data in the input.
    """
    return _Cutter(frame, Lines(constants)).body()


class _Cutter(ChecksumFunction):
    """Writes the body of one function."""

    def body(self) -> tuple[str, ...]:
        self.lines.add("size = len(data)")
        if self.lines.constants.use("_TABLES."):
            self.lines.add("if not _TABLES.are_filled:")
            self.lines.add("    _TABLES.fill()")
        if self.frame.can_cut_in_bulk:
            self._runs()
        self.lines.add("add = events.append")
        if self.deferred is not None:
            self.lines.add("unchecked: list[bytes] = []")
            self.lines.add(f"together = {_FIRST}")
            self.lines.add(f"are_many = size - at > {_MANY}")
        if self.frame.ended_by is EndRule.NEXT_START:
            # Behind a frame that ends where the next start is, that needs not be checked again.
            with self.lines.block("try:"):
                self._start()
            with self.lines.block("except _fast.ANYTHING:  # There is nothing."):
                self.lines.add("return at")
        with self.lines.block("try:"), self.lines.block("while at < size:"):
            if self.deferred is not None:
                self.stop = "break"
            if self.frame.ended_by is not EndRule.NEXT_START:
                self._start()
            self._frame()
            self._event()
        with self.lines.block("except _fast.ANYTHING:  # The reference looks at what is here."):
            self.lines.add("pass")
        if self.deferred is not None:
            with self.lines.block("if unchecked:"):
                given = f"unchecked, {self.deferred}"
                self.lines.add(f"at = _checksum.in_order(at, base, events, {given})")
        self.lines.add("return at")
        return self.lines.text

    def _runs(self) -> None:
        """Take runs of frames of one message at once, if their checksum is one that allows it."""
        frame = self.frame
        (part,) = frame.checksums
        covered = frame.covered(part, self.content)
        first = self.xors_to_nothing(part, covered)
        if first is None and not self.sums_to_nothing(part, covered):
            return
        assert frame.remembered is not None
        counting = [item for item in frame.shown if item not in frame.identity]
        counter = frame.offset(counting[0]) if counting else None
        places = range(frame.head_size - frame.skipped)
        specials = frame.specials(sending=False)
        assert specials is not None
        codes = (
            tuple_of((literal(byte), literal(code))) for byte, code in frame.replacements or ()
        )
        given = {
            "start": literal(frame.start_bytes),
            "end": literal(frame.end),
            "greatest": frame.framing.greatest,
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
        self._locate()
        self._content()
        self._payload()
        self._head()
        self.compare_checksums()

    def _place(self, offset: int) -> str:
        """So many bytes behind the start of the frame."""
        return Place("at", offset).text

    # --- where the frame ends ---------------------------------------------------------------------

    def _locate(self) -> None:
        """Set `raw`, the frame's bytes, and `end`, the place behind them."""
        match self.frame.ended_by:
            case EndRule.NEXT_START:
                self._until_start()
            case EndRule.DELIMITER:
                self._until_end()
            case EndRule.LENGTH:
                self._by_length()
            case EndRule.IDENTITY:
                self._by_kind()

    def _start(self) -> None:
        start = self.frame.start
        if isinstance(start, AfterEnd) and self.frame.ended_by is not EndRule.DELIMITER:
            # Nothing in front of an end is no frame, even where frames begin with the same bytes.
            self.stop_if(f"data.startswith({literal(self.frame.end)}, at)")
        elif isinstance(start, StartSet) and not self._identity_starts:
            first = f"data[{self._place(0)}]"
            self.stop_if(f"not 0x{start.least:02X} <= {first} <= 0x{start.greatest:02X}")
        elif isinstance(start, StartLiteral):
            begins = f"data.startswith({literal(start.bytes)}, at)"
            if self.frame.shares:
                # The place behind the start, which may be the end of the frame before.
                self.lines.add(f"begun = at + {len(start.bytes)} * {begins}")
            elif len(start.bytes) == 1:
                self.stop_if(f"data[{self._place(0)}] != 0x{start.bytes[0]:02X}")
            else:
                self.stop_if(f"not {begins}")

    @property
    def _identity_starts(self) -> bool:
        """True if the first byte is the identity's, which is looked up to find the end."""
        return (
            self.frame.ended_by is EndRule.IDENTITY and self.frame.parts[0] in self.frame.identity
        )

    def _until_start(self) -> None:
        if isinstance(self.frame.start, StartLiteral):
            self.lines.add(f"end = data.find({literal(self.frame.start.bytes)}, at + 1)")
        else:
            self.lines.add(f"found = {self.starts()}(data, at + 1)")
            self.lines.add("end = -1 if found is None else found.start()")
        with self.lines.block("if end < 0:"):
            # A length tells whether the last frame is all there; else the next start has to.
            if self.frame.length is None:
                self.lines.add(self.stop)
            else:
                self.lines.add("end = size")
        if len(self.frame.start_bytes) > 1:
            # Two starts that overlap.
            self.stop_if(f"end < at + {len(self.frame.start_bytes)}")
        self._raw()

    def _until_end(self) -> None:
        frame = self.frame
        begun = "begun" if frame.shares else self._place(len(frame.start_bytes))
        self.lines.add(f"end = data.find({literal(frame.end)}, {begun}{self._bound})")
        self.stop_if("end < 0")
        self.lines.add(f"end += {len(frame.end)}")
        self._raw()
        if not self._is_stuffed_throughout:
            self._no_start_inside()

    @property
    def _bound(self) -> str:
        """An argument that lets `find` look no further than the longest frame goes.

        Else each of many starts that have no end would be looked for one in all that has come.
        """
        return f", {self._place(self.frame.framing.greatest)}"

    @property
    def _is_stuffed_throughout(self) -> bool:
        """True if all between start and end is stuffed, so that unstuffing it finds any start."""
        frame = self.frame
        return frame.stuffed and frame.before == len(frame.start_bytes) > 0 and not frame.behind

    def _raw(self) -> None:
        if self.frame.ended_by in (EndRule.LENGTH, EndRule.IDENTITY):
            self.stop_if("end > size")
        self.lines.add("raw = data[at:end]")
        if not self._length_bounds:
            self._not_too_long()

    @property
    def _length_bounds(self) -> bool:
        """True if the length bounds all frames in which nothing is stuffed."""
        frame = self.frame
        bare = frame.head_size + frame.framing.payload.greatest + frame.tail_size + len(frame.end)
        is_seen = not frame.stuffed or frame.specials(sending=False) is not None
        plain = frame.length is not None and not frame.shares and not frame.optional
        return plain and is_seen and bare <= frame.framing.greatest

    def _not_too_long(self) -> None:
        if self.frame.ended_by is EndRule.DELIMITER and not self.frame.shares:
            return  # Its end would not have been found.
        size = "len(raw)"
        if self.frame.shares:
            size += f" + {len(self.frame.start_bytes)}"
        open_groups = any(group.fixed is None for group in self.frame.groups)
        if self.frame.ended_by is not EndRule.IDENTITY or open_groups:
            self.stop_if(f"{size} > {self.frame.framing.greatest}")

    def _no_start_inside(self) -> None:
        """A start that can't occur inside of a frame ends it where it stands."""
        start = self.frame.start
        if isinstance(start, StartLiteral) and start.protected and not self.frame.shares:
            self.stop_if(f"raw.find({literal(start.bytes)}, 1) > 0")
        elif isinstance(start, StartSet) and start.protected and not self.is_seen_by_bits:
            self.stop_if(f"{self.starts()}(raw, 1)")

    def _by_length(self) -> None:
        frame, length = self.frame, self.frame.length
        assert length is not None
        around = frame.head_size + frame.tail_size + len(frame.end)
        self.lines.add(f"count = {self.number('data', length, 'at')} - {self.counted(length)}")
        if frame.optional:
            with self.lines.block(f"if count == {-frame.length_plan.optional}:"):
                self.lines.add(f"end = {self._place(around - self.frame.optional_size)}")
            with self.lines.block("elif count > 0:"):
                self.lines.add(f"end = {self._place(around)} + count")
            with self.lines.block("else:"):
                self.lines.add(self.stop)
        else:
            self.stop_if("count < 0")
            self.lines.add(f"end = {self._place(around)} + count")
        self._sized()

    def _by_kind(self) -> None:
        frame = self.frame
        around = frame.head_size + frame.tail_size + len(frame.end)
        key = self.identity("data", "at")
        varies = self.frame.has_open_groups or self.frame.optional
        found = "payload_size, read" if varies else "frame_size, read"
        if frame.shows_identity:
            found += ", numbers"
        self.lines.add(f"{found} = _{self.name.upper()}_KINDS[{key}]")
        open_groups = frame.has_open_groups
        if open_groups and frame.end:
            with self.lines.block("if payload_size < 0:"):
                behind = self._place(frame.head_size)
                self.lines.add(f"end = data.find({literal(frame.end)}, {behind}{self._bound})")
                self.stop_if("end < 0")
                self.lines.add(f"end += {len(frame.end)}")
            head = "elif payload_size:" if frame.optional else "else:"
            with self.lines.block(head):
                self.lines.add(f"end = {self._place(around)} + payload_size")
            if frame.optional:
                with self.lines.block("else:"):
                    self.lines.add(f"end = {self._place(around - self.frame.optional_size)}")
        else:
            if open_groups:
                self.stop_if("payload_size < 0")
            less = f" - {self.frame.optional_size} * (not payload_size)" if frame.optional else ""
            if less or open_groups:
                self.lines.add(f"end = {self._place(around)} + payload_size{less}")
            else:
                self.lines.add("end = at + frame_size")
        self._sized()

    def _sized(self) -> None:
        """Take a frame of a known size."""
        self._raw()
        if self.frame.end:
            self.stop_if(f"not raw.endswith({literal(self.frame.end)})")
        self._no_start_inside()

    # --- what is in it ----------------------------------------------------------------------------

    def _content(self) -> None:
        """Set `content`, where the frame's bytes are not the content themselves."""
        frame = self.frame
        if self.content == "raw":
            return
        first = "begun - at" if frame.shares else str(frame.before or "")
        last = str(-(len(frame.end) + frame.behind) or "")
        if frame.stuffed and (frame.before > len(frame.start_bytes) or frame.behind):
            # Else what is in front of the stuffed bytes and what is behind them would overlap.
            around = len(frame.end) + frame.behind
            least = f"{first} + {around}" if frame.shares else f"{frame.before + around}"
            self.stop_if(f"len(raw) < {least}")
        self.lines.add(f"content = raw[{first}:{last}]")
        if not frame.stuffed:
            return
        self._unstuffed()
        pieces = ["content"]
        if frame.before and not frame.skipped:
            pieces.insert(0, f"raw[:{frame.before}]")
        if frame.behind:
            pieces.append(f"raw[{last}:{-len(frame.end) or ''}]")
        if len(pieces) > 1:
            self.lines.add(f"content = {' + '.join(pieces)}")

    def _unstuffed(self) -> None:
        """Take the stuffing off, as an encoder would have put it on.

        What only a lenient receiver takes is left to the reference.
        """
        transparency = self.frame.sender.frame.transparency
        assert transparency is not None
        strict = tables.encoding(transparency.encoding)
        decode = f"{self.lines.constants.named('STUFFING', strict)}.decode"
        specials = self.frame.specials(sending=False)
        if specials is None:
            self.lines.add(f"content = {decode}(content)")
            return
        found = " or ".join(f"0x{byte:02X} in content" for byte in specials)
        with self.lines.block(f"if {found}:"):
            if self._length_bounds:
                self._not_too_long()
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
        frame = self.frame
        around = frame.head_size - frame.skipped + frame.tail_size
        sliced = f"payload = {self.payload_slice}"
        if frame.length is not None and not frame.optional:
            self._length(frame.length, around)
            if not frame.gives_content:
                self.lines.add(sliced)
        elif frame.optional:
            with self.lines.block(f"if len({self.content}) <= {around}:"):
                self.stop_if(f"len({self.content}) != {around - self.frame.optional_size}")
                self.lines.add('payload = b""')
            with self.lines.block("else:"):
                self.lines.add(sliced)
            if frame.length is not None:
                self.stop_if(f"len(payload) > {frame.framing.payload.greatest}")
                self._optional_length(frame.length)
        else:
            if frame.ended_by in (EndRule.DELIMITER, EndRule.NEXT_START):
                self.stop_if(f"len({self.content}) < {max(around, 1)}")
            if not frame.gives_content:
                self.lines.add(sliced)
        if frame.framing.seven_bit:
            self.stop_if("not payload.isascii()")

    def _length(self, part: LengthPart, around: int) -> None:
        """A length in bounds that is right tells that all other parts are there."""
        counted, number = self.counted(part), self.number(self.content, part)
        behind = self.frame.offset(part) + part.type.size
        if part.type.size > 1 and (
            around < behind or self.frame.ended_by in (EndRule.DELIMITER, EndRule.NEXT_START)
        ):
            self.stop_if(f"len({self.content}) < {behind}")
        self.lines.add(f"length = {number}")
        rest = around - counted
        due = f"length + {rest}" if rest > 0 else f"length - {-rest}" if rest else "length"
        size = f"len({self.content})"
        least = max(part.least, counted)
        greatest = min(part.greatest, counted + self.frame.framing.payload.greatest)
        if least > 0 or greatest < part.type.greatest:
            self.stop_if(f"not {least + rest} <= {size} == {due} <= {greatest + rest}")
        else:
            self.stop_if(f"{size} != {due}")

    def _optional_length(self, part: LengthPart) -> None:
        counted, number = self.counted(part), self.number(self.content, part)
        absent = f"{self.frame.length_plan.optional} * (not payload)"
        self.stop_if(f"{number} != len(payload) + {counted} - {absent}")
        self.stop_if(f"not {part.least} <= {number} <= {part.greatest}")

    def _head(self) -> None:
        for part in self.frame.head:
            if isinstance(part, LiteralPart) and not self.frame.is_start(part):
                first, source = self.frame.offset(part), self.content
                if first < 0:
                    first, source = first + self.frame.skipped, "raw"
                self.stop_if(f"not {source}.startswith({literal(part.bytes)}, {first})")

    # --- the event --------------------------------------------------------------------------------

    def _event(self) -> None:
        self._numbers()
        self.lines.add("event: _typing.Any = _MessageEvent()")
        self.lines.add(f"event.message = read({self._read_from})")
        self.lines.add("event.offset = base + at")
        for name in ("raw", "numbers"):
            self.lines.add(f"event.{name} = {name}")
        self.lines.add(f"event.codec = {self.name.upper()}_SENDER")
        self.lines.add("add(event)")
        self._taken()

    def _taken(self) -> None:
        """Go on behind a frame."""
        self.lines.add("at = end")
        if self.deferred is None:
            return
        with self.lines.block("if are_many:"):
            self.lines.add(f"unchecked.append({self.content})")
            with self.lines.block("if len(unchecked) >= together:"):
                self.stop_if(f"not _checksum.are_sound(unchecked, {self.deferred})")
                self.lines.add("unchecked.clear()")
                self.lines.add(f"together = min(2 * together, {_TOGETHER})")

    @property
    def _read_from(self) -> str:
        """Argument of readers."""
        return self.content if self.frame.gives_content else "payload"

    def _numbers(self) -> None:
        """Set `numbers`, and `read` unless the place of the end has told it."""
        frame = self.frame
        if frame.ended_by is EndRule.IDENTITY:
            if not frame.shows_identity:
                numbers = (self.number(self.content, part) for part in frame.shown)
                self.lines.add(f"numbers = {tuple_of(numbers)}")
        elif frame.remembered is not None:
            self._known_head(*frame.remembered)
        else:
            names = [f"n{index}" for index, _ in enumerate(frame.shown)]
            for name, part in zip(names, frame.shown, strict=True):
                self.lines.add(f"{name} = {self.number(self.content, part)}")
            self.lines.add(f"numbers = {tuple_of(names)}")
            self._look_up([names[frame.shown.index(part)] for part in frame.identity])

    def _known_head(self, first: int, last: int) -> None:
        """Look the bytes with all numbers up, which a stream repeats over and over."""
        head = f"_{self.name.upper()}_HEADS[{self.content}[{first}:{last}]]"
        if self.frame.length is not None:
            self.lines.add(f"numbers, read = {head}")
            with self.lines.block("if read is None:"):
                self._unknown()
        else:
            self.lines.add(f"numbers, payload_size, read = {head}")
            self.stop_if("0 <= payload_size != len(payload)")

    def _look_up(self, identity: list[str]) -> None:
        kinds = f"_{self.name.upper()}_KINDS"
        key = identity[0] if len(identity) == 1 else tuple_of(identity)
        if self.frame.length is not None:
            self.lines.add(f"read = {kinds}.get({key})")
            with self.lines.block("if read is None:"):
                self._unknown()
            return
        self.lines.add(f"payload_size, read = {kinds}[{key}]")
        self.stop_if("0 <= payload_size != len(payload)")

    def _unknown(self) -> None:
        spec = f"{self.name.upper()}_SENDER"
        payload = self.payload_slice if self.frame.gives_content else "payload"
        self.lines.add(f"add(_fast.unknown({spec}, base + at, raw, numbers, {payload}))")
        self._taken()
        self.lines.add("continue")
