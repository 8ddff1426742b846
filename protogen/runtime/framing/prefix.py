"""Beginnings of frames whose other bytes have yet to arrive.

A `Prefix` spares the reference from taking such a beginning byte by byte. It asks a `Candidate`
once for each head, and says how many bytes may come before there can be a verdict. What more than
its head, its size and its stuffing may decide is left to a `Candidate` of its own.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Sequence
from operator import and_
from typing import Any

from protogen.runtime.framing.frame import (
    Anywhere,
    BitsPart,
    LiteralPart,
    NumberPart,
    Part,
    StartMark,
    members_of,
)
from protogen.runtime.framing.layout import Layout
from protogen.runtime.framing.machine import Candidate
from protogen.runtime.framing.sender import SenderSpec
from protogen.runtime.framing.starts import starts_of
from protogen.runtime.payload.number import BYTES
from protogen.runtime.transparency import Base16Upper, Cobs

_KEPT = 32
"""Heads that are remembered: what a wire gives must not fill the memory."""

_DIGITS = b"0123456789ABCDEF"


def prefix_of(sender: SenderSpec[Any, Any]) -> Prefix | None:
    """The beginnings of a sender's frames; None where only the reference can judge them."""
    if sender.prefix is None and sender.cut is not None and not _is_unclear(sender):
        sender.prefix = Prefix(sender)
    prefix: Prefix | None = sender.prefix
    return prefix


def prefix_of_any(senders: Sequence[SenderSpec[Any, Any]]) -> Prefix | FormsPrefix | None:
    """The same of several senders, or forms of frames, of which one begins there."""
    return prefix_of(senders[0]) if len(senders) == 1 else FormsPrefix(senders)


def _is_unclear(sender: SenderSpec[Any, Any]) -> bool:
    """True if bytes of a beginning do not tell how many bytes of content they are."""
    frame, layout = sender.frame, sender.layout
    if isinstance(frame.start, Anywhere) or layout.shares_delimiter:
        return True
    has_digits = isinstance(frame.transparency, Base16Upper)
    return isinstance(frame.transparency, Cobs) or (has_digits and not _ends_stuffed(sender))


def _ends_stuffed(sender: SenderSpec[Any, Any]) -> bool:
    """True if the stuffed region goes up to the end."""
    layout = sender.layout
    return bool(layout.stuffed) and layout.stuffed[-1] == len(layout.parts) - 1


def _tells(part: Part, told: tuple[Part, ...]) -> bool:
    """True if a part, or one that is bits of it, is one of those that tell something."""
    return any(item in told for item in (part, *members_of(part)))


def _is_checked(part: Part, layout: Layout) -> bool:
    """True if some bytes are no value of the part, or of one that is bits of it."""
    if any(item.name in layout.mirrored for item in (part, *members_of(part))):
        return True
    bounded = [item for item in layout.bounded if not item.holds_all]
    if isinstance(part, BitsPart):
        is_bounded = any(item in bounded for item in part.members)
        return bool(part.mask or part.mirrors) or is_bounded
    if part in bounded:
        return True
    if isinstance(part, NumberPart):
        return part.number.bits < 8 * part.size
    return isinstance(part, LiteralPart)


class Prefix:
    """Judge of the beginnings of one sender's frames, of those that have a cutter."""

    def __init__(self, sender: SenderSpec[Any, Any]) -> None:
        self._sender = sender
        frame, layout = sender.frame, sender.layout
        self._has_end, self._greatest = bool(layout.end), frame.greatest
        self._starts = starts_of(frame)
        self._start_size = layout.start_size
        self._mask = self._telling_bits()
        self._head_size = len(self._mask)
        is_sought = frame.end is not None and frame.end.protected
        # An end that the data can hold is looked for only where no length tells its place.
        self._sought = layout.end if is_sought or layout.length is None else b""
        sizes = range(len(layout.end) - 1, 0, -1) if is_sought else ()
        self._begun_ends = [layout.end[:size] for size in sizes]
        self._limits: dict[bytes, int] = {}
        self._stuffing = frame.transparency if layout.stuffed else None
        self._has_digits = isinstance(self._stuffing, Base16Upper)
        self._before = self._start_size
        codes: dict[bytes, bytes] = {}
        if self._stuffing is not None:
            self._before = sum(part.size for part in layout.parts[: layout.stuffed[0]])
            codes = {byte: self._stuffing.encode(byte) for byte in BYTES}
            codes = {byte: code for byte, code in codes.items() if code != byte}
        self.plain = _DIGITS if self._has_digits else self._plain(codes)
        """Bytes that stand for themselves and belong to no delimiter, or digits."""
        known = set(codes.values()) if _ends_stuffed(sender) else set()
        self._begun_codes = {code[:size] for code in known for size in range(1, len(code))}
        self._clean = _any_number_of(self.plain, known, in_pairs=self._has_digits)

    def _telling_bits(self) -> bytes:
        """Bits of a head that tell the payload's size, or may show that it is none."""
        layout = self._sender.layout
        told: tuple[Part, ...] = layout.sent_identity
        if layout.length is not None:
            told = (*layout.lengths, *(told if layout.spec.rescans else ()))
        parts = (
            part.size * BYTES[255 * (_tells(part, told) or _is_checked(part, layout))]
            for part in layout.head
        )
        mask = BYTES[255] * self._start_size + b"".join(parts)[self._start_size :]
        return mask if layout.length is None else mask.rstrip(b"\0")

    def _plain(self, codes: dict[bytes, bytes]) -> bytes:
        frame, layout = self._sender.frame, self._sender.layout
        special = {*self._sought[:1], *b"".join(codes), *(code[0] for code in codes.values())}
        if isinstance(frame.start, StartMark) and frame.start.protected:
            special |= {word[0] for word in layout.start_words}
        return bytes({*range(0x80 if frame.seven_bit else 0x100)} - special)

    def wanted(self, data: bytes, at: int) -> int:
        """Bytes, all plain but for the last, that may follow the data without a verdict.

        A verdict on what stands from `at` on, that is; 0 if there may be one as yet. That it stands
        behind an end has been seen.
        """
        if len(data) - at >= self._greatest:
            return 0  # Else each damaged frame would be given all that came behind it.
        wire = content = data[at:]
        is_begun = is_in_code = False
        if wire[self._start_size :].translate(None, self.plain):
            found = self._content(wire)
            if found is None:
                return 0
            content, is_begun, is_in_code = found
        elif self._has_digits:
            is_begun = is_in_code = max(0, len(wire) - self._before) % 2 == 1
            content = self._unstuffed(wire[:-1] if is_begun else wire)
            if self._has_high_bits(content):
                return 0
        head_size = self._head_size
        head = bytes(map(and_, content, self._mask))
        known = self._limits.get(head)
        limit = self._limit(head) if known is None else known
        if not limit:
            return 0
        left = limit - len(content)
        room = self._greatest - len(wire)
        if is_begun:
            return int(left >= is_in_code and room > 0)
        if len(head) < head_size:
            return int(left > 0 and room > 0)
        if self._has_digits:
            # Any two digits may be a byte that seven bits do not make.
            left = min(left, 1) if self._sender.frame.seven_bit else 2 * left
        return max(0, min(left + self._has_end, room))

    def _content(self, wire: bytes) -> tuple[bytes, bool, bool] | None:
        """Content of a beginning, and whether an end or a code is begun behind it, and a code.

        None where there is a delimiter, or what an encoder would not make.
        """
        layout = self._sender.layout
        first = layout.mark_size
        if self._starts.find(wire, 1, len(wire)) > 0:
            return None
        if self._sought and self._sought in wire[first:]:
            return None
        held = next((len(end) for end in self._begun_ends if wire.endswith(end, first)), 0)
        own = wire[: len(wire) - held]
        clean = self._clean.match(own, self._before)
        assert clean is not None
        begun = own[clean.end() :]
        if begun and begun not in self._begun_codes:
            return None
        content = self._unstuffed(own[: clean.end()])
        if self._has_high_bits(content):
            return None
        return content, bool(held or begun), bool(begun)

    def _has_high_bits(self, content: bytes) -> bool:
        """True if a byte that carries seven bits has its most significant one set."""
        return self._sender.frame.seven_bit and not content[self._start_size :].isascii()

    def _unstuffed(self, wire: bytes) -> bytes:
        region = wire[self._before :]
        return wire[: self._before] + (self._stuffing.decode(region) if self._stuffing else region)

    def _limit(self, head: bytes) -> int:
        """Content with which there may be a verdict on what begins so; 0: it may be there."""
        if len(self._limits) >= _KEPT:
            self._limits.clear()
        self._limits[head] = limit = self._judge(head)
        return limit

    def _judge(self, head: bytes) -> int:
        region = head[self._before :]
        wire = head[: self._before] + (self._stuffing.encode(region) if self._stuffing else region)
        if self._start_size and self._starts.find(wire, 0, 1) != 0:
            return 0
        candidate = Candidate(self._sender)
        if any(candidate.push(byte) is not None for byte in wire):
            return 0
        if len(head) < self._head_size:
            return self._head_size
        # What may yet turn out to be an end has told nothing.
        is_told = candidate.content_size == self._head_size
        return candidate.content_limit or 0 if is_told else 0


class FormsPrefix:
    """Judge of the beginnings of several forms at once.

    There is no verdict on them before there is one on the first form that may begin there.
    """

    def __init__(self, senders: Sequence[SenderSpec[Any, Any]]) -> None:
        self._each = [(starts_of(sender.frame), prefix_of(sender)) for sender in senders]
        plain = [prefix.plain for _, prefix in self._each if prefix is not None]
        self.plain = bytes(byte for byte in range(256) if all(byte in item for item in plain))
        """Bytes that are plain in all of them."""

    def wanted(self, data: bytes, at: int) -> int:
        """Bytes that may follow the data without a verdict, as one form's prefix says it."""
        for starts, prefix in self._each:
            if starts.find(data, at, at + 1) == at:
                return 0 if prefix is None else prefix.wanted(data, at)
            if starts.undecided(data, at) == at:
                return 0
        return 0


def _any_number_of(plain: bytes, codes: Iterable[bytes], *, in_pairs: bool) -> re.Pattern[bytes]:
    """Pattern for plain bytes and codes, or pairs of plain bytes, as many as there are."""
    one = b"[" + re.escape(plain) + b"]" if plain else b"(?!)"
    pieces = [one + one] if in_pairs else [one + b"+", *map(re.escape, codes)]
    return re.compile(b"(?:" + b"|".join(pieces) + b")*")
