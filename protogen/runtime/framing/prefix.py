"""Beginnings of frames whose other bytes have yet to arrive.

A `Prefix` spares the reference from taking such a beginning byte by byte. It says how many bytes
may come before it has to be looked at again. Where it is not sure, a `Candidate` takes over.
"""

from __future__ import annotations

from binascii import unhexlify
from itertools import accumulate
from typing import Any

from protogen.runtime.framing.content import Content, Rejected
from protogen.runtime.framing.frame import (
    AfterEnd,
    Anywhere,
    ChecksumPart,
    LiteralPart,
    NumberPart,
    Part,
    StartLiteral,
    StartSet,
)
from protogen.runtime.framing.layout import is_optional
from protogen.runtime.framing.sender import SenderSpec
from protogen.runtime.framing.starts import starts_of
from protogen.runtime.payload.number import BYTES
from protogen.runtime.transparency import Base16Upper, Cobs, TransparencyError
from protogen.runtime.values import Frozen, replace

_KEPT = 32
"""Heads that are remembered: what a wire gives must not fill the memory."""

_DIGITS = b"0123456789ABCDEF"


def prefix_of(sender: SenderSpec[Any, Any]) -> Prefix | None:
    """The beginnings of a sender's frames; None where only the reference can judge them."""
    if sender.prefix is None and sender.cut is not None:
        frame, layout = sender.frame, sender.layout
        unclear = isinstance(frame.start, Anywhere) or isinstance(frame.transparency, Cobs)
        if not unclear and not layout.shares_delimiter:
            sender.prefix = Prefix(sender)
    prefix: Prefix | None = sender.prefix
    return prefix


class Prefix:
    """Judge of the beginnings of one sender's frames."""

    def __init__(self, sender: SenderSpec[Any, Any]) -> None:
        self._frame, self._layout = sender.frame, sender.layout
        self._start, self._end = self._layout.start, self._layout.end
        start = self._frame.start
        self._starts = starts_of(self._frame)
        self._keeps_start_out = isinstance(start, StartLiteral | StartSet) and start.protected
        self._keeps_end_out = self._frame.end is not None and self._frame.end.protected
        self._region = _Region(sender)
        self._heads = _Heads(sender, self._region)
        self._start_size = self._region.wire_size(self._heads.size)
        self._skip = 0 if isinstance(start, AfterEnd) else len(self._start) or 1
        self.plain = bytes(byte for byte in range(256) if self._is_plain(byte))
        """Bytes that a frame goes on with, wherever they stand before it is due to end."""

    def _is_plain(self, byte: int) -> bool:
        start, own = self._frame.start, BYTES[byte]
        if isinstance(start, StartSet):
            begins = start.least <= byte <= start.greatest
        else:
            begins = self._start.startswith(own)
        return not (
            (begins and self._keeps_start_out)
            or self._end.startswith(own)
            or (self._frame.seven_bit and byte > 0x7F)
            or byte not in self._region.plain
        )

    def wanted(self, data: bytes, at: int) -> int:
        """Bytes, all plain but for the last, that may follow the data without a verdict.

        A verdict on what stands from `at` on, that is; 0 if there may be one as yet. That it stands
        behind an end has been seen.
        """
        wire = data[at:]
        if wire[self._skip :].translate(None, self.plain):
            return self._wanted_closely(wire)
        content = wire
        if self._region.least > 1:
            content = self._region.undigit(wire[: self._start_size])
        head = self._heads.of(content)
        if head is None:
            return 0
        if len(wire) < self._start_size:
            return 1
        return head.due - len(wire) if head.due > len(wire) else 0

    def _wanted_closely(self, wire: bytes) -> int:
        """The same where bytes may belong to delimiters and codes, or be refused."""
        room = self._frame.greatest - len(wire)
        if room <= 0 or self._is_cut_off(wire):
            return 0
        held = self._held(wire)
        found = self._region.decode(wire[: len(wire) - held])
        if found is None:
            return 0
        content, is_in_code = found
        head = self._heads.of(content)
        if head is None or self._is_refused(head, content, wire):
            return 0
        missing = head.limit - len(content)
        if len(content) < self._heads.size:
            return 1
        if missing <= 0:
            return int(not is_in_code and self._awaits_end(content[head.limit :]))
        if held or is_in_code or wire.endswith(self._start[:1], 1):
            return 1
        return min(missing * self._region.least + self._region.ends, room)

    def _is_refused(self, head: _Head, content: bytes, wire: bytes) -> bool:
        """True if there is a byte in the payload that ends the frame or is none of its bytes."""
        payload = content[self._layout.head_size : head.payload_to]
        is_open = head.is_open and not self._keeps_end_out
        is_ended = is_open and self._end in wire[self._layout.head_size :]
        return is_ended or (head.is_ascii and not payload.isascii())

    def _awaits_end(self, begun: bytes) -> bool:
        """True if bytes behind the content begin an end, and do no more."""
        if not begun:
            return self._region.ends
        is_known = self._keeps_end_out or self._layout.stuffed
        return not is_known and self._end.startswith(begun) and begun != self._end

    def _is_cut_off(self, wire: bytes) -> bool:
        """True if a delimiter stands where it ends a candidate, or no start in front."""
        if isinstance(self._frame.start, AfterEnd):
            if wire.startswith(self._end):
                return True
        elif self._starts.find(wire, 0, 1) != 0:
            return True
        if self._keeps_start_out and self._starts.find(wire, 1, len(wire)) > 0:
            return True
        return self._keeps_end_out and wire.find(self._end, len(self._start)) >= 0

    def _held(self, wire: bytes) -> int:
        """Number of bytes that may begin an end that is looked for everywhere."""
        sizes = range(len(self._end) - 1, 0, -1) if self._keeps_end_out else ()
        own = wire[len(self._start) :]
        return next((size for size in sizes if own.endswith(self._end[:size])), 0)


class _Region:
    """The stuffed region of a frame; without one, every byte stands for itself."""

    def __init__(self, sender: SenderSpec[Any, Any]) -> None:
        parts, stuffed = sender.layout.parts, sender.layout.stuffed
        transparency = sender.frame.transparency if stuffed else None
        strict: Any = transparency  # All classes of them have this attribute.
        self._strict = None if strict is None else replace(strict, lenient=False)
        self._has_digits = isinstance(transparency, Base16Upper)
        self._before = sum(part.size for part in parts[: stuffed[0]]) if stuffed else 0
        self.behind = sum(part.size for part in parts[stuffed[-1] + 1 :]) if stuffed else 0
        """Bytes of content behind the region."""
        self.ends = sender.frame.end is not None and not self.behind
        """True if an end stands behind the bytes that are awaited."""
        self.least = 2 if self._has_digits else 1
        """Bytes on the wire that a byte of content takes at least."""
        codes = [] if self._strict is None else list(map(self._strict.encode, BYTES))
        codes = [code for byte, code in zip(BYTES, codes, strict=False) if code != byte]
        firsts = {code[:1] for code in codes}
        self._beginnings = sorted({c[:size] for c in codes for size in range(1, len(c))}, key=len)
        if self._has_digits:
            self.plain = _DIGITS
        else:
            self.plain = bytes(byte for byte in range(256) if self._stands_for_itself(byte, firsts))
        """Bytes that stand for themselves, or digits."""

    def _stands_for_itself(self, byte: int, firsts: set[bytes]) -> bool:
        own = BYTES[byte]
        return own not in firsts and (self._strict is None or self._strict.encode(own) == own)

    def wire_size(self, content: int) -> int:
        """The least bytes on the wire that so many bytes of content take."""
        return content + max(content - self._before, 0) * (self.least - 1)

    def undigit(self, wire: bytes) -> bytes:
        """Content of bytes whose region is plain digits, as far as these come in pairs."""
        odd = max(len(wire) - self._before, 0) % 2
        return wire[: self._before] + unhexlify(wire[self._before : len(wire) - odd])

    def decode(self, wire: bytes) -> tuple[bytes, bool] | None:
        """Content of a frame's beginning, and whether it ends inside of a code.

        None where some bytes are not what an encoder would make.
        """
        if self._strict is None:
            return wire, False
        front, region = wire[: self._before], wire[self._before :]
        if self._has_digits:
            if region.translate(None, _DIGITS):
                return None
            cut = [len(region) % 2]
        else:
            cut = [0, *(len(item) for item in self._beginnings if region.endswith(item))]
        for size in reversed(cut):
            try:
                content = self._strict.decode(region[: len(region) - size])
            except TransparencyError:
                continue
            return front + content, size > 0
        return None


class _Head(Frozen):
    """Facts of a frame that the first bytes of its content tell."""

    __slots__ = ("due", "is_ascii", "is_open", "limit", "payload_to")

    limit: int
    """Bytes of content that are awaited at most."""
    due: int
    """Bytes on the wire behind which there may be a verdict where all are plain."""
    payload_to: int
    """Place where the payload ends at the latest."""
    is_ascii: bool
    """True if each byte of the payload is refused whose top bit is set."""
    is_open: bool
    """True if an end in the payload ends the frame."""

    def __init__(
        self, limit: int, due: int, payload_to: int, is_ascii: bool, is_open: bool
    ) -> None:
        self._set(limit, due, payload_to, is_ascii, is_open)


_UNKNOWN = _Head(0, 0, 0, is_ascii=False, is_open=False)
"""Head in front of the bytes that tell the payload's size."""


class _Heads:
    """Heads of frames by the first bytes of their content."""

    def __init__(self, sender: SenderSpec[Any, Any], region: _Region) -> None:
        layout = sender.layout
        self._sender = sender
        self._region = region
        self._start = layout.start
        told = layout.identity if layout.length is None else (layout.length,)
        ends = list(accumulate(part.size for part in layout.head))
        refused = [end for end, part in zip(ends, layout.head, strict=True) if _is_checked(part)]
        tellers = [end for end, part in zip(ends, layout.head, strict=True) if part in told]
        self.size = max([*refused, *tellers, isinstance(sender.frame.start, StartSet)])
        """Bytes behind which nothing more can be known."""
        is_plain = tellers and max([0, *refused]) <= len(self._start)
        self._first = tellers[0] - told[0].size if is_plain and self._start else 0
        self._known: dict[bytes, _Head | None] = {}

    def of(self, content: bytes) -> _Head | None:
        """Head that a beginning tells; None: there may be a verdict."""
        if not content.startswith(self._start):
            return None
        if self._first and len(content) < self.size:
            return _UNKNOWN
        key = content[self._first : self.size]
        if key not in self._known:
            if len(self._known) >= _KEPT:
                self._known.clear()
            self._known[key] = self._read(content[: self.size])
        return self._known[key]

    def _read(self, start: bytes) -> _Head | None:
        marked = self._sender.frame.start
        # There is no byte yet where the first one may begin an end, too.
        if isinstance(marked, StartSet) and any(
            not marked.least <= byte <= marked.greatest for byte in start[:1]
        ):
            return None
        content = Content(self._sender)
        try:
            for byte in start:
                content.accept(byte)
            return self._judge(content)
        except Rejected:
            return None

    def _judge(self, content: Content) -> _Head | None:
        layout, frame = self._sender.layout, self._sender.frame
        if len(content.bytes) < self.size:
            return _UNKNOWN
        is_open, size = content.payload_size is None, content.payload_size
        if size is None:
            group = self._sender.group(self._sender.identity(content.numbers))
            if group is None or not self._region.ends:
                return None
            size = group.greatest
        elif not size and layout.stuffed and any(map(is_optional, layout.tail)):
            return None
        limit = layout.head_size + size + layout.tail_size(size) - self._region.behind
        is_ascii = frame.seven_bit and not (is_open and layout.tail)
        due = min(self._region.wire_size(limit) + self._region.ends, frame.greatest)
        return _Head(limit, due, layout.head_size + size, is_ascii, is_open)


def _is_checked(part: Part) -> bool:
    """True if some bytes are no value of the part."""
    if isinstance(part, NumberPart):
        return part.number.bits < 8 * part.size and not isinstance(part, ChecksumPart)
    return isinstance(part, LiteralPart)
