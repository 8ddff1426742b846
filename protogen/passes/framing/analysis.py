"""Framing of a sender: how a receiver finds where a frame starts and ends.

Decides, for each sender, what marks the start and the end, whether those marks are protected, and
how large a frame can be. A schema whose receiver could not tell is a problem here.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from fractions import Fraction

from protogen.copying import replace
from protogen.model.frame import Frame
from protogen.model.framing import (
    AfterEnd,
    Anywhere,
    End,
    Framing,
    MessageFraming,
    Start,
    StartLiteral,
    StartSet,
)
from protogen.model.messages import Message
from protogen.model.parts import ChoicePart, LiteralPart, Part, PayloadPart
from protogen.model.sizes import SizeSet
from protogen.model.transparency import Cobs
from protogen.passes.context import Context
from protogen.passes.draft import Draft
from protogen.passes.framing import framing_words
from protogen.passes.framing.capacity import (
    GREATEST_FRAME,
    amount,
    joined_words,
    payload_range,
    unclear_behind_stuffing,
    wire_limit,
)
from protogen.passes.framing.delimiters import Sent, delimiters_of, judge_delimiters
from protogen.passes.framing.silences import character_time
from protogen.passes.proofs import wire_sizes
from protogen.passes.proofs.alphabets import payload_alphabet
from protogen.passes.proofs.codewords import Segment, occurs
from protogen.passes.proofs.undetected import undetected_errors
from protogen.passes.proofs.wire_code import (
    SEVEN_BITS,
    part_bytes,
    segments,
    wire_bytes,
)


def analyse_framing(context: Context, draft: Draft) -> None:
    """The framing of each sender."""
    analyses = [
        _Analysis(context, draft, sender, draft.frames[sender])
        for sender in draft.senders
        if sender in draft.frames
    ]
    judge_delimiters(context, [item.sent() for item in analyses])
    for analysis in analyses:
        analysis.others = [item for item in analyses if analysis.is_beside(item)]
        framing = analysis.framing()
        if framing is not None:
            draft.framings[analysis.sender] = framing


class _Analysis:
    """One sender's frames."""

    def __init__(self, context: Context, draft: Draft, sender: str, frame: Frame) -> None:
        self._context = context
        self._written = context.frames[sender]
        self._loc = self._written.loc
        sent, uncut = list(draft.sent_by(sender)), replace(frame.payload, longest=None)
        self._messages = [
            replace(
                message,
                sizes=frame.payload.carried(message.sizes, can_be_cut=message.can_be_cut),
            )
            for message in sent
        ]
        self._own = [
            replace(message, sizes=uncut.carried(message.sizes, can_be_cut=False))
            for message in sent
        ]
        """The messages without the bytes that newer senders may have behind them."""
        self._too_large = any(message.name in draft.too_large for message in self._messages)
        self._overloads = draft.overloads[sender]
        bits, is_cut = context.syntax.byte_bits, frame.payload.is_cut
        self._payload = payload_alphabet(bits, self._messages, is_cut=is_cut)
        self.sender = sender
        self.frame = frame
        self.delimiters = delimiters_of(frame, self._payload)
        self._carried = payload_range(frame)
        self.others: Sequence[_Analysis] = ()
        """Other forms of the endpoint's frames."""

    def sent(self) -> Sent:
        """What tells whether the delimiters are protected."""
        return Sent(self.sender, self.frame, self.delimiters, self._messages, self._payload)

    def is_beside(self, other: _Analysis) -> bool:
        """True if the other is another form of the same endpoint's frames."""
        return other is not self and other._written.endpoint == self._written.endpoint

    def framing(self) -> Framing | None:
        """The framing, or None where a receiver could not tell."""
        end = self._end()
        start = self._start(end)
        if start is None or not self._ends_known(end):
            return None
        self._needless(start)
        self._told_too_late(start, end)
        self._only_end()
        if self._region_unclear():
            return None
        return self._describe(start, end)

    # -- start and end ------------------------------------------------------------------------

    def _end(self) -> End | None:
        tail = self.delimiters.tail
        return None if tail is None else End(bytes=tail.words[0], protected=tail.protected)

    def _start(self, end: End | None) -> Start | None:
        head = self.delimiters.head
        if head is not None and len(head.words) > 1:
            return StartSet(words=head.words, protected=head.protected)
        if head is not None:
            return StartLiteral(bytes=head.words[0], protected=head.protected)
        marked = self._start_set()
        if marked is not None:
            return marked
        if end is not None:
            return AfterEnd()
        if self._always_checked():
            return Anywhere()
        if self.frame.parts[0].unprotected is not None:
            return None if self._holds_nothing() else Anywhere(checked=False)
        self._context.error_at_key(
            "PG146",
            self._loc,
            f"nothing tells a receiver where a frame of {self.sender} starts",
            "a frame needs a literal, a first byte with a `range` of its own, or at least a "
            "checksum that is always there; or accept it: `unprotected:` and a decision's name on "
            "the first part",
        )
        return None

    def _holds_nothing(self) -> bool:
        """True if a frame may have no bytes at all, which would be one at any place."""
        if any(part.size and not part.is_optional for part in self.frame.parts):
            return False
        empty = [message.name for message in self._messages if message.sizes.least == 0]
        for name in empty:
            text = f"a frame of `{name}` can have no bytes at all, and nothing marks its start"
            hint = "give the frame an identity or another part, or the message a field"
            self._context.error_at_key("PG146", ("messages", name), text, hint)
        return bool(empty)

    def _told_too_late(self, start: Start, end: End | None) -> None:
        """Report told parts where the end of a frame begins the next one, before more is told."""
        if not self.frame.told or end is None or not isinstance(start, StartLiteral):
            return
        if end.protected and start.bytes == end.bytes:
            name = self.frame.told[0].name
            text = f"the end of a frame is the start of the next one, before `{name}` can be told"
            hint = "end frames with another literal, or give them a length"
            self._context.error_at_key("PG306", (*self._loc, name), text, hint)

    def _needless(self, start: Start) -> None:
        """Report parts that accept that nothing marks the start, where something does."""
        needed = self.frame.parts[0] if start == Anywhere(checked=False) else None
        for part in self.frame.parts:
            is_literal = isinstance(part, LiteralPart | ChoicePart)
            if part.unprotected is not None and part is not needed and not is_literal:
                text = f"a receiver finds frames without `{part.name}`, so nothing needs to be"
                place = (*self._loc, part.name, "unprotected")
                self._context.error("PG144", place, f"{text} accepted", "remove `unprotected`")

    def _always_checked(self) -> bool:
        return any(not part.when_payload for part in self.frame.checksums)

    def _start_set(self) -> StartSet | None:
        """The first part, where a range sets its byte apart.

        Where other bytes of a frame can be such a byte too, it takes more to tell frames: a length
        or a checksum. A set that holds all of them tells nothing.
        """
        first = self.frame.parts[0]
        item = self._written.parts[first.name]
        if first.name in self.frame.stuffed or (item.range is None and item.bits is None):
            return None
        values = part_bytes(first, self._payload)[0]
        used = (used for part, used in wire_bytes(self.frame, self._payload) if part != first)
        others = frozenset().union(*used)
        protected = values.isdisjoint(others) and first.size == 1
        told = protected or self.frame.length is not None or self._always_checked()
        if not told or others <= values:
            return None
        words = tuple(bytes((value,)) for value in sorted(values))
        return StartSet(words=words, protected=protected)

    # -- what a receiver can tell -------------------------------------------------------------

    def _ends_known(self, end: End | None) -> bool:
        """True if the frame, or each message, says where it ends."""
        if self.frame.length is not None or self.frame.silence is not None or end is not None:
            return True
        if not self.frame.identity_is_early:
            text = "the identity comes behind the payload, and nothing else tells where it ends"
            self._context.error_at_key("PG145", self._loc, text)
            return False
        before = self._context.tally.errors
        self._messages_end()
        self._overloads_end()
        return self._context.tally.errors == before

    def _messages_end(self) -> None:
        """Fields that fill the payload were refused already; an unspecified one is such a field."""
        for message in self._messages:
            if message.unspecified and message.sizes.fixed is None:
                self._context.error_at_key(
                    "PG145",
                    ("messages", message.name),
                    f"a receiver can't tell where `{message.name}` ends",
                    "give the frame a length or an end literal, or the message a fixed size",
                )

    def _overloads_end(self) -> None:
        """The size tells messages apart only if something else tells the size."""
        sizes = {message.name: message.sizes.fixed for message in self._messages}
        for overload in self._overloads:
            if len({sizes[name] for name in overload.messages} | {None}) != 2:
                text = "a receiver can't tell where these messages end: they differ in size"
                hint = "give the frame a length or an end literal"
                self._context.error_at_key("PG145", ("overloads", overload.name), text, hint)

    def _only_end(self) -> None:
        """A frame that holds nothing is no frame to a receiver, but a line that is idle."""
        head, tail = self.delimiters.head, self.delimiters.tail
        if tail is None or (head is not None and head.words != tail.words):
            return
        if isinstance(self.frame.encoding, Cobs):
            return  # It makes a byte of nothing.
        names = {part.name for part in (*(head.parts if head else ()), *tail.parts)}
        others = (part for part in self.frame.parts if part.name not in names)
        if any(part.size and not part.is_optional for part in others):
            return
        for message in self._messages:
            if message.sizes.least == 0:
                text = f"a frame of `{message.name}` can be its end alone, which says nothing"
                hint = "give the frame an identity or another part, or the message a field"
                self._context.error_at_key("PG146", ("messages", message.name), text, hint)

    def _payload_index(self) -> int:
        parts = enumerate(self.frame.parts)
        return next(index for index, part in parts if isinstance(part, PayloadPart))

    def _region_unclear(self) -> bool:
        """A length is needed to find where stuffed parts begin, or raw ones behind them."""
        transparency = self.frame.transparency
        if transparency is None or self.frame.length is not None:
            return False
        names = [part.name for part in self.frame.parts]
        behind = names.index(transparency.first) > self._payload_index()
        if behind and any(message.sizes.fixed is None for message in self._messages):
            words = f"nothing tells where the payload ends and the stuffed `{transparency.first}`"
            hint = "give the frame a length, stuff the payload, too, or send it unstuffed"
            place = (*self._loc, transparency.first)
            self._context.error_at_key("PG149", place, f"{words} begins", hint)
            return True
        unclear = unclear_behind_stuffing(self.frame)
        if unclear:
            first, last = unclear[0], unclear[-1]
            text = f"nothing tells where the stuffed parts end and `{first.name}` begins"
            hint = f"stuff all up to `{last.name}`, or give the frame a length"
            if isinstance(first, LiteralPart):
                hint = (
                    f"give the frame a length: `{first.name}` is no end, as `{last.name}` follows"
                )
            self._context.error_at_key("PG149", (*self._loc, first.name), text, hint)
        return bool(unclear)

    # -- results ------------------------------------------------------------------------------

    def _describe(self, start: Start, end: End | None) -> Framing | None:
        frame = self.frame
        payload = self._payload_sizes(start)
        wire = wire_sizes.WireSizes(frame, self._payload)
        longest = wire.frame(payload).greatest
        limit = wire_limit(frame)
        greatest = longest if limit is None else min(longest, limit)
        if greatest > GREATEST_FRAME:
            if self._too_large:
                return None  # Which was said of the message.
            text = f"a frame of {self.sender} can have {amount(greatest)} bytes; "
            text = f"{text}at most 1 MiB is allowed"
            self._context.error_at_key("PG122", self._loc, text)
            return None
        per_message = tuple(self._message(wire, message) for message in self._own)
        synchronising, why = framing_words.synchronisation(frame, start, end)
        holder = next((item for item in self.others if item.can_hold(start)), None)
        if synchronising and holder is not None:
            synchronising, why = False, framing_words.held_by(frame, holder._written.form)
        return Framing(
            start=start,
            end=end,
            payload=payload,
            least=min((item.least for item in per_message), default=0),
            greatest=greatest,
            overhead=wire.overhead,
            seven_bit=self._context.syntax.byte_bits == 7 and self._payload == SEVEN_BITS,
            cut_ambiguous=end is not None and not end.protected,
            is_cut_off=greatest < longest or any(item.is_cut_off for item in per_message),
            self_synchronising=synchronising,
            why_synchronising=why,
            finds_start=framing_words.finds_start(start, is_idle=frame.silence is not None),
            finds_end=framing_words.finds_end(frame, start, end, self._messages),
            undetected=undetected_errors(frame, start, end, self._messages, self._payload),
            messages=per_message,
        )

    def can_hold(self, start: Start) -> bool:
        """True if the start of another form's frame may stand in these, but for their beginning.

        What begins a frame of this form is no false start: a receiver takes it for either.
        """
        words = start.words if isinstance(start, StartSet) else ()
        if isinstance(start, StartLiteral):
            words = (start.bytes,)
        if all(len(word) == 1 for word in words):
            used = list(wire_bytes(self.frame, self._payload))
            return any(
                word[0] in values
                for word in words
                for part, values in used
                if part not in self._beginning(word)
            )
        return any(
            occurs(word, b"", self._stretches(self._beginning(word)), b"") is not None
            for word in words
        )

    def _beginning(self, word: bytes) -> tuple[Part, ...]:
        """The literals that are this word at the beginning of a frame; none where it can't be."""
        parts = self.delimiters.head.parts if self.delimiters.head is not None else ()
        for count in range(1, len(parts) + 1):
            words = joined_words(parts[:count])
            if word in words and all(len(other) == len(word) for other in words):
                return parts[:count]
        return ()

    def _stretches(self, own: Iterable[Part]) -> list[Segment]:
        return segments(self.frame, self._payload, [part.name for part in own])

    def _payload_sizes(self, start: Start) -> SizeSet:
        # Without a length, unknown messages alone have other sizes than those that are known.
        has_end = self.frame.silence is not None or not isinstance(start, Anywhere)
        may_be_unknown = self.frame.identity and has_end
        if self._carried is not None and (self.frame.length is not None or may_be_unknown):
            return self._carried
        least = min((message.sizes.least for message in self._messages), default=0)
        greatest = max((message.sizes.greatest for message in self._messages), default=0)
        return SizeSet.between(least, greatest)

    def _sendable(self, sizes: SizeSet) -> SizeSet:
        """Sizes of a message that this sender's frames can carry; others may send it as well."""
        if self._carried is None:
            return sizes
        return sizes.within(self._carried.least, self._carried.greatest) or sizes

    def _message(self, wire: wire_sizes.WireSizes, message: Message) -> MessageFraming:
        sizes = wire.message(message, self._sendable(message.sizes))
        limit = wire_limit(self.frame)
        if limit is None:
            return self._framing_of(message, sizes)
        fits = self._carried is not None and message.sizes.least <= self._carried.greatest
        if fits and sizes.least > limit:
            text = f"a frame of `{message.name}` has at least {sizes.least} bytes on the wire"
            text = f"{text}, and one of {self.sender} at most {limit}"
            self._context.error_at_key("PG182", ("messages", message.name), text)
        longest = wire.message(message, message.sizes).greatest
        sizes = sizes.within(0, limit) or SizeSet.exactly(limit)
        return replace(self._framing_of(message, sizes), is_cut_off=longest > limit)

    def _framing_of(self, message: Message, sizes: SizeSet) -> MessageFraming:
        return MessageFraming(
            message=message.name,
            least=sizes.least,
            greatest=sizes.greatest,
            per_second=_rate(self._context, self.frame, sizes.greatest),
        )


def _rate(context: Context, frame: Frame, size: int) -> Fraction | None:
    character = character_time(context)
    silence = Fraction(0) if frame.silence is None else frame.silence.seconds
    return 1 / (character * size + silence) if character else None
