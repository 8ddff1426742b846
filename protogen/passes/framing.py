"""How does a receiver find where a frame starts and ends?

Decides, for each sender, what marks the start and the end, whether those marks are protected, and
how large a frame can be. A schema whose receiver could not tell is a problem here.
"""

from __future__ import annotations

from fractions import Fraction

from protogen.model.frame import Frame, LiteralPart, PayloadPart
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
from protogen.model.protocol import Link
from protogen.model.sizes import SizeSet
from protogen.model.types import Array, Integer, Struct, Switch, Type
from protogen.passes import framing_words, wire_sizes
from protogen.passes.capacity import (
    GREATEST_FRAME,
    head_literals,
    part_size,
    payload_range,
    tail_literals,
)
from protogen.passes.codewords import occurs
from protogen.passes.context import Context, Loc
from protogen.passes.draft import Draft
from protogen.passes.fields import fills
from protogen.passes.undetected import undetected_errors
from protogen.passes.wire_code import (
    EVERY_BYTE,
    SEVEN_BITS,
    ByteSet,
    covered_parts,
    part_bytes,
    segments,
    wire_bytes,
)


def analyse_framing(context: Context, draft: Draft) -> None:
    """The framing of each sender."""
    accepted: set[tuple[str, str]] = set()
    for sender, frame in draft.frames.items():
        analysis = _Analysis(context, sender, frame, draft.sent_by(sender), accepted)
        framing = analysis.framing()
        if framing is not None:
            draft.framings[sender] = framing


class _Analysis:
    """One sender's frames."""

    def __init__(
        self,
        context: Context,
        sender: str,
        frame: Frame,
        messages: list[Message],
        reported: set[tuple[str, str]],
    ) -> None:
        self._context = context
        self._sender = sender
        self._key = sender if sender in context.syntax.frame else ""
        self._frame = frame
        self._messages = messages
        self._reported = reported
        self._payload = payload_alphabet(context.syntax.byte_bits, messages)
        self._head = head_literals(frame)
        self._tail = tail_literals(frame)

    def framing(self) -> Framing | None:
        """The framing, or None where a receiver could not tell."""
        end = self._end()
        start = self._start(end)
        if start is None or not self._ends_known(end):
            return None
        if self._region_unclear():
            return None
        return self._describe(start, end)

    # -- start and end ------------------------------------------------------------------------

    def _end(self) -> End | None:
        if not self._tail:
            return None
        literal = b"".join(part.bytes for part in self._tail)
        return End(bytes=literal, protected=self._protected(literal, self._tail))

    def _start(self, end: End | None) -> Start | None:
        if self._head:
            literal = b"".join(part.bytes for part in self._head)
            return StartLiteral(bytes=literal, protected=self._protected(literal, self._head))
        marked = self._start_set()
        if marked is not None:
            return marked
        if end is not None:
            return AfterEnd()
        if self._frame.checksums:
            return Anywhere()
        self._context.error_at_key(
            "PG146",
            ("frame", self._key),
            f"nothing tells a receiver where a frame of {self._sender} starts",
            "a frame needs a literal, an identity with a `range`, or at least a checksum",
        )
        return None

    def _start_set(self) -> StartSet | None:
        """The first part, where a range sets its byte apart."""
        first = self._frame.parts[0]
        item = self._context.syntax.frame[self._key][first.name]
        if item.range is None or first.name in covered_parts(self._frame):
            return None
        values = part_bytes(first, self._payload)[0]
        others = (used for part, used in wire_bytes(self._frame, self._payload) if part != first)
        protected = not any(values & used for used in others) and part_size(first) == 1
        return StartSet(least=min(values), greatest=max(values), protected=protected)

    def _protected(self, literal: bytes, parts: tuple[LiteralPart, ...]) -> bool:
        """Whether the literal occurs only in its place; if not, a decision has to accept it."""
        delimiters = [part.name for part in (*self._head, *self._tail)]
        witness = occurs(literal, b"", segments(self._frame, self._payload, delimiters), b"")
        decision = next((part.unprotected for part in parts if part.unprotected), None)
        name = parts[0].name
        if (self._key, name) not in self._reported:
            self._reported.add((self._key, name))
            self._judge(name, witness, decision)
        return witness is None

    def _judge(self, name: str, witness: tuple[bytes, int] | None, decision: str | None) -> None:
        loc: Loc = ("frame", self._key, name)
        if witness is not None and decision is None:
            data, offset = witness
            self._context.error_at_key(
                "PG142",
                loc,
                f"`{name}` can also occur inside a frame, and nothing protects it: "
                f"{_hex(data)} has it at byte {offset}",
                "add a transparency, or accept it: `unprotected:` and a decision's name",
            )
        if witness is None and decision is not None:
            text = f"`{name}` can't occur inside a frame, so nothing needs to be accepted"
            self._context.error("PG144", (*loc, "unprotected"), text, "remove `unprotected`")
        if decision is not None and decision not in self._context.syntax.decisions:
            text = f"there is no decision `{decision}`"
            self._context.error("PG143", (*loc, "unprotected"), text)

    # -- what a receiver can tell -------------------------------------------------------------

    def _ends_known(self, end: End | None) -> bool:
        """Whether the frame, or each message, says where it ends."""
        if self._frame.length is not None or end is not None:
            return True
        if not self._identity_first():
            text = "the identity comes behind the payload, and nothing else tells where it ends"
            self._context.error_at_key("PG145", ("frame", self._key), text)
            return False
        endless = [message for message in self._messages if _has_filler(message)]
        for message in endless:
            self._context.error_at_key(
                "PG145",
                ("messages", message.name),
                f"a receiver can't tell where `{message.name}` ends",
                "give the frame a length or an end literal, or the message a fixed size",
            )
        return not endless

    def _identity_first(self) -> bool:
        names = [part.name for part in self._frame.parts]
        payload = next(p.name for p in self._frame.parts if isinstance(p, PayloadPart))
        return all(names.index(p.name) < names.index(payload) for p in self._frame.identity)

    def _region_unclear(self) -> bool:
        """Raw parts between a stuffed region and the end need a length to be found."""
        transparency = self._frame.transparency
        if transparency is None or self._frame.length is not None:
            return False
        names = [part.name for part in self._frame.parts]
        rest = names[names.index(transparency.last) + 1 :]
        unclear = [name for name in rest if name not in {part.name for part in self._tail}]
        if unclear:
            text = f"nothing tells where the stuffed parts end and `{unclear[0]}` begins"
            self._context.error_at_key("PG149", ("frame", self._key, unclear[0]), text)
        return bool(unclear)

    # -- results ------------------------------------------------------------------------------

    def _describe(self, start: Start, end: End | None) -> Framing | None:
        frame = self._frame
        payload = self._payload_sizes()
        wire = wire_sizes.WireSizes(frame, self._payload)
        greatest = wire.frame(payload).greatest
        if greatest > GREATEST_FRAME:
            text = f"a frame of {self._sender} can have {greatest} bytes; at most 1 MiB is allowed"
            self._context.error_at_key("PG122", ("frame", self._key), text)
            return None
        per_message = tuple(self._message(wire, message) for message in self._messages)
        synchronising, why = framing_words.synchronisation(frame, start, end)
        return Framing(
            start=start,
            end=end,
            head=wire.head,
            tail=wire.tail,
            payload=payload,
            least=min((item.least for item in per_message), default=0),
            greatest=greatest,
            overhead=wire.overhead,
            seven_bit=self._payload == SEVEN_BITS,
            cut_ambiguous=end is not None and not end.protected,
            self_synchronising=synchronising,
            why_synchronising=why,
            finds_start=framing_words.finds_start(start),
            finds_end=framing_words.finds_end(frame, end, self._messages),
            undetected=undetected_errors(frame, start, end, self._messages),
            messages=per_message,
        )

    def _payload_sizes(self) -> SizeSet:
        sizes = payload_range(self._frame)
        if sizes is not None:
            return sizes
        least = min((message.sizes.least for message in self._messages), default=0)
        greatest = max((message.sizes.greatest for message in self._messages), default=0)
        return SizeSet.between(least, greatest)

    def _message(self, wire: wire_sizes.WireSizes, message: Message) -> MessageFraming:
        sizes = wire.message(message)
        return MessageFraming(
            message=message.name,
            least=sizes.least,
            greatest=sizes.greatest,
            per_second=_rate(self._context, sizes.greatest),
        )


def _rate(context: Context, size: int) -> Fraction | None:
    link = context.syntax.link
    bits = Link(data_bits=link.data_bits, parity=link.parity, stop_bits=link.stop_bits)
    return Fraction(link.baud, bits.bits_per_byte * size) if link.baud else None


def _has_filler(message: Message) -> bool:
    return any(fills(field.type) for field in message.fields)


def payload_alphabet(byte_bits: int, messages: list[Message]) -> ByteSet:
    """The bytes that a payload can hold."""
    if byte_bits == 8:
        return EVERY_BYTE
    whole = any(_holds_whole_bytes(field.type) for m in messages for field in m.fields)
    return EVERY_BYTE if whole else SEVEN_BITS


def _holds_whole_bytes(type_: Type) -> bool:
    match type_:
        case Integer():
            return type_.role == "byte"
        case Struct():
            return any(_holds_whole_bytes(field.type) for field in type_.fields)
        case Array():
            return _holds_whole_bytes(type_.element)
        case Switch():
            return any(_holds_whole_bytes(case.type) for case in type_.cases)
    return False


def _hex(data: bytes) -> str:
    return data.hex(" ").upper()


__all__ = ["analyse_framing", "payload_alphabet"]
