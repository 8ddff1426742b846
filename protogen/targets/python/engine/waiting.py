"""Functions that tell plain beginnings of frames, whose other bytes have yet to arrive.

They save the reference from taking what is there byte by byte. So they may only say yes where its
`Candidate` would take all bytes without a verdict; no is always safe.
"""

from __future__ import annotations

from protogen.model.frame import LengthPart, LiteralPart, NumberPart, Part
from protogen.model.framing import AfterEnd, StartLiteral, StartSet
from protogen.targets.python import frames as tables
from protogen.targets.python.engine.frames import FastFrame
from protogen.targets.python.engine.lines import Constants, Lines
from protogen.targets.python.engine.numbers import FrameFunction
from protogen.targets.python.literals import octets_in_class as literal
from protogen.targets.python.literals import tuple_of


def waiter(frame: FastFrame, constants: Constants) -> tuple[str, ...]:
    """The body of `_waits_SENDER(data, at)`.

    It tells whether what stands from `at` on is the beginning of a frame on which there can be no
    verdict before more bytes arrive. That it stands behind an end has been seen.
    """
    return _Waiting(frame, Lines(constants)).body()


class _Waiting(FrameFunction):
    """Writes the body of one function.

    The function holds the content so far against what its first bytes announce. As long as it is no
    longer than that, the reference still waits: for content, or for the end behind it.
    """

    def body(self) -> tuple[str, ...]:
        self.lines.add("size = len(data) - at")
        self._no_if(f"size >= {self.frame.framing.greatest}")
        self._no_other_start()
        if not self._delimiters_show:
            self._no_delimiters()
        with self.lines.block("try:"):
            self._content()
            for part in self.frame.head:
                self._check(part)
            self._compare()
        with self.lines.block("except _fast.ANYTHING:  # The reference says what is wrong."):
            self.lines.add("return False")
        return self.lines.text

    def _no_if(self, condition: str) -> None:
        self.lines.add(f"if {condition}:")
        self.lines.add("    return False")

    def _no_other_start(self) -> None:
        start = self.frame.start
        if isinstance(start, StartLiteral):
            self._no_if(f"not data.startswith({literal(start.bytes)}, at)")
        elif isinstance(start, StartSet):
            least, greatest = start.least, start.greatest
            self._no_if(f"not size or not 0x{least:02X} <= data[at] <= 0x{greatest:02X}")

    # --- what ends a candidate wherever it stands -------------------------------------------------

    def _no_delimiters(self) -> None:
        frame, start, end = self.frame, self.frame.start, self.frame.framing.end
        if isinstance(start, AfterEnd) and (end is None or not end.protected):
            self._no_if(f"data.startswith({literal(frame.end)}, at)")
        elif isinstance(start, StartLiteral) and start.protected:
            self._no_if(f"data.find({literal(start.bytes)}, at + 1) > 0")
        elif isinstance(start, StartSet) and start.protected and not self.is_seen_by_bits:
            self._no_if(f"{self.starts()}(data, at + 1)")
        if end is not None and end.protected:
            behind = f"at + {len(frame.start_bytes)}" if frame.start_bytes else "at"
            self._no_if(f"data.find({literal(end.bytes)}, {behind}) >= 0")

    # --- the content so far -----------------------------------------------------------------------

    def _content(self) -> None:
        """Set `content` to all parts so far, but literals in front."""
        frame = self.frame
        begin = f"at + {frame.before}" if frame.before else "at"
        if self._delimiters_show:
            self.lines.add(f"content = data[{begin}:]")
            self._delimited()
            return
        if self._holds_end:
            # What begins an end is held back, because it may be content as well.
            first = f"at + {len(frame.start_bytes)}" if frame.start_bytes else "at"
            self.lines.add(f"held = data.endswith({literal(frame.end[:1])}, {first})")
            self.lines.add(f"content = data[{begin} : len(data) - held]")
            if not frame.stuffed:
                self.lines.add("size -= held")
        else:
            self.lines.add(f"content = data[{begin}:]")
        if frame.stuffed:
            if frame.replacements is None:
                self._digits()
            else:
                self._replaced()
            if frame.before and not frame.skipped:
                self.lines.add(f"content = data[at : {begin}] + content")

    @property
    def _delimiters_show(self) -> bool:
        """Whether a delimiter that has begun shows by a byte of the content, which is all stuffed.

        Then most beginnings of frames need neither be searched nor unstuffed.
        """
        frame, start, end = self.frame, self.frame.start, self.frame.framing.end
        literal_start = isinstance(start, StartLiteral) and start.protected
        is_all = literal_start and frame.before == frame.skipped == len(frame.start_bytes)
        overlaps = frame.start_bytes[:1] in frame.start_bytes[1:]
        known = frame.replacements is not None and frame.specials(sending=False) is not None
        ends = end is None or end.protected
        return bool(frame.stuffed and is_all and not overlaps and known and ends)

    def _delimited(self) -> None:
        """Look closer where a byte of the content may belong to a delimiter, or to a code."""
        frame, specials = self.frame, self.frame.specials(sending=False)
        assert specials is not None
        firsts = {literal_[0] for literal_ in (frame.start_bytes, frame.end) if literal_}
        found = sorted({*specials, *firsts})
        self.lines.add("part = False")
        with self.lines.block(f"if {' or '.join(f'0x{byte:02X} in content' for byte in found)}:"):
            self._no_delimiters()
            if self._holds_end:
                # What begins an end is held back, because it may be content as well.
                with self.lines.block(f"if content.endswith({literal(frame.end[:1])}):"):
                    self.lines.add("content = content[:-1]")
            self._unreplace()

    @property
    def _holds_end(self) -> bool:
        """Whether the last byte may be the first of an end that is looked for everywhere."""
        end = self.frame.framing.end
        return end is not None and end.protected and len(end.bytes) == 2

    @property
    def _there(self) -> str:
        """How many bytes of the content are there."""
        return "len(content)" if self.frame.stuffed else "size"

    @property
    def _size(self) -> str:
        """The same, where a byte whose stuffing or digits are there in part counts as one."""
        return "len(content) + part" if self.frame.stuffed else self._there

    def _digits(self) -> None:
        """Take the digits off. The upper half of a byte may be there alone."""
        transparency = self.frame.sender.frame.transparency
        assert transparency is not None
        strict = tables.encoding(transparency.encoding)
        decode = f"{self.lines.constants.named('STUFFING', strict)}.decode"
        self.lines.add("part = len(content) % 2")
        self.lines.add(f'content = {decode}(content + b"0" * part)')
        with self.lines.block("if part:"):
            self.lines.add("content = content[:-1]")

    def _replaced(self) -> None:
        """Take the stuffing off, but for the first byte of a code at the end.

        What an encoder makes of the outcome has to be what stood there.
        """
        self.lines.add("part = False")
        specials = self.frame.specials(sending=False)
        if specials is None:
            self._unreplace()
            return
        found = " or ".join(f"0x{byte:02X} in content" for byte in specials)
        with self.lines.block(f"if {found}:"):
            self._unreplace()

    def _unreplace(self) -> None:
        assert self.frame.replacements is not None
        firsts = sorted({code[:1] for _, code in self.frame.replacements if len(code) > 1})
        if firsts:
            begin = tuple_of(map(literal, firsts)) if len(firsts) > 1 else literal(firsts[0])
            self.lines.add(f"part = content.endswith({begin})")
            with self.lines.block("if part:"):
                self.lines.add("content = content[:-1]")
        self.lines.add("stuffed = content")
        for byte, code in reversed(self.frame.replacements):
            self.lines.add(f"content = content.replace({literal(code)}, {literal(byte)})")
        source = "content"
        for byte, code in self.frame.replacements:
            self.lines.add(f"again = {source}.replace({literal(byte)}, {literal(code)})")
            source = "again"
        self._no_if("again != stuffed")

    # --- the head, as far as it is there ----------------------------------------------------------

    def _check(self, part: Part) -> None:
        if isinstance(part, LiteralPart) and not self.is_start(part):
            first = self.frame.offset(part)
            if first < 0:
                low = f"at + {first + self.frame.skipped}"
                piece = f"data[{low} : at + {first + self.frame.skipped + len(part.bytes)}]"
            else:
                piece = f"content[{first}:{first + len(part.bytes)}]"
            self._no_if(f"not {literal(part.bytes)}.startswith({piece})")
        elif isinstance(part, NumberPart) and self.has_padding(part.type):
            with self.lines.block(f"if {self._there} >= {self._behind(part)}:"):
                self.lines.add(self.number("content", part))

    def _behind(self, part: NumberPart) -> int:
        return self.frame.offset(part) + part.type.size

    # --- how much is announced --------------------------------------------------------------------

    def _compare(self) -> None:
        """Compare the size of the content with that which the length or the identity announces."""
        tellers = self.frame.identity if self.frame.length is None else (self.frame.length,)
        if tellers:
            with self.lines.block(f"if {self._there} < {max(map(self._behind, tellers))}:"):
                self.lines.add("return True")
        if self.frame.length is not None:
            self._of_length(self.frame.length)
        else:
            self._of_kind()

    def _of_length(self, length: LengthPart) -> None:
        counted = self.counted(length)
        # Where the payload is empty and a checksum therefore absent, the reference counts.
        least = max(length.least - counted, 1 if self.frame.optional else 0)
        greatest = min(length.greatest - counted, self.frame.framing.payload.greatest)
        less = f" - {counted}" if counted else ""
        self.lines.add(f"payload_size = {self.number('content', length)}{less}")
        if least > -counted or greatest < length.type.greatest - counted:
            self._no_if(f"not {least} <= payload_size <= {greatest}")
        self._within("payload_size", self._around)

    def _of_kind(self) -> None:
        frame = self.frame
        size = "frame_size" if frame.lists_frame_sizes else "payload_size"
        self.lines.add(f"{size}: int = _{self.name.upper()}_KINDS[{self.identity('content')}][0]")
        if frame.lists_frame_sizes:
            self._within("frame_size", -len(frame.end))
            return
        if frame.has_open_groups:
            with self.lines.block("if payload_size < 0:"):
                self._open()
        if frame.optional:
            self._no_if("not payload_size")
        self._within("payload_size", self._around)

    def _open(self) -> None:
        """Await the end of a payload that varies in size; its message says how long it may be."""
        frame = self.frame
        if not frame.end or frame.behind:
            self.lines.add("return False")
            return
        assert frame.framing.end is not None
        if not frame.framing.end.protected:
            self._no_if(f"data.find({literal(frame.end)}, at + {frame.head_size}) >= 0")
        if frame.framing.seven_bit and not frame.tail:
            self._no_if(f"not {self._payload()}.isascii()")
        self.lines.add(f"return {self._size} <= {_sum('~payload_size', self._around)}")

    def _within(self, announced: str, around: int) -> None:
        """Await what is announced: so many bytes more than that number."""
        frame = self.frame
        if frame.framing.seven_bit:
            shift = around + frame.behind - frame.tail_size
            behind = _sum(announced, shift) if frame.tail else ""
            self._no_if(f"not {self._payload(behind)}.isascii()")
        # Without an end, or with parts behind the stuffing, the last byte decides.
        compare = "<=" if frame.end and not frame.behind else "<"
        self.lines.add(f"return {self._size} {compare} {_sum(announced, around)}")

    @property
    def _around(self) -> int:
        """The bytes of the content that are not payload, as far as they are waited for."""
        frame = self.frame
        return frame.head_size - frame.skipped + frame.tail_size - frame.behind

    def _payload(self, behind: str = "") -> str:
        first = self.frame.head_size - self.frame.skipped
        if not first and not behind:
            return "content"
        return f"content[{first or ''}{' : ' if ' ' in behind else ':'}{behind}]"


def _sum(variable: str, number: int) -> str:
    """A variable and a number, added."""
    if not number:
        return variable
    return f"{variable} + {number}" if number > 0 else f"{variable} - {-number}"
