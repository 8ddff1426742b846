"""A frame taken apart, byte by byte: what `explain` and the reference show.

This reads bytes to show them; it decides nothing. Whether they are a frame, and why not, is what a
decoder says.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence

import msgspec

from protogen.copying import replace
from protogen.model.checksums import checksum_of
from protogen.model.identities import Identity
from protogen.model.messages import Message
from protogen.model.parts import (
    BitsPart,
    ChecksumPart,
    ChoicePart,
    IdentityPart,
    LengthPart,
    LiteralPart,
    MirrorBits,
    NumberPart,
    Part,
    PayloadPart,
    ToldIdentity,
    ToldLength,
    ToldPart,
    TypedPart,
    VirtualPart,
)
from protogen.model.protocol import Protocol, Sender
from protogen.model.reading.dissect import Cursor, Row, dissect
from protogen.model.reading.readings import character, quoted
from protogen.model.reading.wire import Unit, Wire, plain, unstuff
from protogen.model.transparency import FULL_GROUP
from protogen.model.types import characters, codec
from protogen.runtime.errors import ByteError

__all__ = ["Row", "annotate"]

_SURPLUS = "nothing is due here"
_NOT_KNOWN = "left, as what is behind the known fields is"
_LEFT_OUT = "left out, as zeros at the end are"


def annotate(
    protocol: Protocol,
    sender: str,
    data: bytes,
    *,
    covers: Sequence[str] | None = None,
    message: Message | None = None,
    told: Mapping[str, int] | None = None,
) -> tuple[Row, ...]:
    """Return what each byte of `data`, which `sender` is said to have sent, stands for.

    The `wire` of all rows, joined, is `data`. Bytes that are no frame are taken apart as far as
    they look like one. With `covers`, `data` holds only those parts, without transparency, as a
    document prints them. The payload is that of `message`, if given, whatever the identity says.
    `told` has the values of parts that are not sent; other identities have their defaults, and the
    length is that of `data`.
    Raises KeyError if there is no such sender.
    """
    known = protocol.sender(sender)
    if covers is None:
        parts, wire = known.frame.declared, unstuff(known.plan, data)
        first = _Frame(known, parts, wire, message, told=told)
        rows = first.rows()
        if not known.looks_ahead:
            return rows
        return _Frame(known, parts, wire, message, first.identity, told, first.numbers).rows()
    held = [part for part in known.frame.parts if part.name in covers]
    return _Frame(known, held, Wire(plain(data)), message, numbers=told).rows()


class _Found(msgspec.Struct, frozen=True):
    """A part that was read, for the checksums that cover it."""

    content: bytes
    wire: bytes


class _Frame:
    """Reads the parts of one frame."""

    def __init__(
        self,
        sender: Sender,
        parts: Sequence[Part],
        wire: Wire,
        message: Message | None,
        identity: Identity | None = None,
        told: Mapping[str, int] | None = None,
        numbers: Mapping[str, int] | None = None,
    ) -> None:
        """With the identity and numbers, where some other reading has found them."""
        self._told_values = told or {}
        self._identity = identity
        self._sender = sender
        self._parts = parts
        self._wire = wire
        self._given = message
        self._cursor = Cursor(wire.units, 0)
        self._size = self._cursor.left
        transparency = sender.frame.transparency
        self._coded = "" if transparency is None else transparency.first
        self._rows: list[Row] = []
        self._found: dict[str, _Found] = {}
        self._numbers = dict(numbers or {})

    @property
    def numbers(self) -> Mapping[str, int]:
        """The numbers that were read, by the names of their parts."""
        return self._numbers

    def rows(self) -> tuple[Row, ...]:
        """Read all parts."""
        for part in self._parts:
            if part.name == self._coded:
                self._code(self._wire.code)
            if not self._ended:
                self._part(part)
        self._leftovers()
        return tuple(self._rows)

    def _code(self, code: bytes) -> None:
        """The code byte of COBS, which is in front of all that it is about."""
        if not code:
            return
        meaning = f"COBS: the next zero or the end is {code[0]} bytes on"
        if code[0] > FULL_GROUP:
            meaning = f"COBS: {FULL_GROUP} bytes without a zero"
        self._cursor.skip(len(code))
        self._rows.append(self._bare(code, meaning))

    def _part(self, part: Part) -> None:
        start = len(self._rows)
        if isinstance(part, PayloadPart):
            self._rows += self._payload(part)
        elif isinstance(part, VirtualPart):
            self._virtual(part)
            return
        elif isinstance(part, ToldPart):
            self._told(part)
            return
        elif self._is_absent(part):
            self._found[part.name] = _Found(b"", b"")
            return
        else:
            row = self._fixed(part)
            self._rows.append(row)
            if isinstance(part, BitsPart):
                self._rows += self._bits(part, row)
        rows = self._rows[start:]
        content = b"".join(row.bytes for row in rows)
        self._found[part.name] = _Found(content, b"".join(row.wire for row in rows))

    def _is_absent(self, part: Part) -> bool:
        payload = self._found.get(self._sender.frame.payload.name)
        return part.is_optional and (payload is None or not payload.content)

    def _told(self, part: ToldPart) -> None:
        """A part that is not sent: as told, or as the given message or its frame has it."""
        value = self._told_values.get(part.name, self._assumed(part))
        row = self._cursor.take(0, part.name, part.type.label, subject=part, value_type=part.type)
        if isinstance(part, ToldIdentity):
            self._numbers[part.name] = value
            self._rows.append(row.reads(value, "told, not sent"))
            return
        row = self._number(part, value, row)
        self._rows.append(replace(row, meaning=f"{row.meaning}; told, not sent"))

    def _assumed(self, part: ToldPart) -> int:
        """What a part is where nothing was told."""
        if isinstance(part, ToldLength):
            return self._sender.plan.told_size(self._size)[part.name]
        if self._given is None:
            return part.telling.default
        return self._given.identity[self._sender.frame.identity.index(part)]

    def _virtual(self, part: VirtualPart) -> None:
        """A part without bytes, which the checksums that cover it may need."""
        message = self._given or next(iter(self._candidates()), None)
        value = part.default if message is None else message.virtual_value(part)
        row = self._cursor.take(0, part.name, part.type.label, subject=part, value_type=part.type)
        if value is None:
            self._rows.append(replace(row, meaning="not sent, and unknown"))
            return
        encoded = part.encode(value)
        self._found[part.name] = _Found(encoded, encoded)
        shown = quoted(str(characters(part.type).text(value))) if part.type.is_text else ""
        self._rows.append(row.reads(value, " ".join(filter(None, (shown, "not sent")))))

    @property
    def _ended(self) -> bool:
        """True if the bytes ended inside of a part, so that there is nothing for those behind."""
        if self._cursor.left:
            return False
        return bool(self._wire.rest) or any(row.cut for row in self._rows[-1:])

    # --- parts of a fixed size --------------------------------------------------------------

    def _fixed(self, part: Part) -> Row:
        if isinstance(part, LiteralPart):
            row = self._cursor.take(part.size, part.name, "literal", subject=part)
            if part.bytes.startswith(row.bytes):
                return row
            return replace(row, fault=f"must be {part.bytes.hex(' ').upper()}")
        assert isinstance(part, TypedPart)
        label = part.type.label
        row = self._cursor.take(part.size, part.name, label, subject=part, value_type=part.type)
        if row.cut:
            return row
        try:
            value = codec(part.type).decode(row.bytes)
        except ByteError as error:
            return replace(row, fault=str(error))
        if isinstance(part, ChecksumPart):
            return self._checksum(part, row.reads(value, ""))
        if isinstance(part, BitsPart):
            other = value & part.mask != part.fixed
            fault = f"bits {part.mask:X} must be {part.fixed:X}" if other else ""
            if part.whole is not None and not fault:
                return self._mirror(part.whole, value, row)
            return row.reads(value, "bits that are parts", fault)
        assert isinstance(part, NumberPart)
        return self._number(part, value, row)

    def _bits(self, part: BitsPart, row: Row) -> Iterator[Row]:
        """The parts that are bits of one that was read, which have no bytes of their own.

        Behind them are the bits that follow from others, and those that are checksums.
        """
        mirrors = (item for item in part.mirrors if item != part.whole)
        bits = (*part.members, *mirrors, *part.sums)
        for member in bits if isinstance(row.value, int) else ():
            own = replace(
                self._cursor.take(0, member.name, member.type.name, subject=member),
                value_type=member.type,
            )
            value = codec(member.type).decode(row.bytes)
            own = replace(own, offset=row.offset, bits=f"{value:0{member.type.bits}b}")
            if isinstance(member, MirrorBits):
                yield self._mirror(member, value, own)
            elif isinstance(member, ChecksumPart):
                yield self._checksum(member, own.reads(value, ""))
            else:
                yield self._number(member, value, own)

    def _mirror(self, part: MirrorBits, value: int, row: Row) -> Row:
        """Bits that follow from a number that was read, if there was one."""
        number = self._numbers.get(part.of.name)
        due = None if number is None else part.follows(number)
        fault = f"must be {due}, as {part.of.name} is {number}" if value != due else ""
        return row.reads(value, part.meaning, "" if due is None else fault)

    def _number(self, part: NumberPart, value: int, row: Row) -> Row:
        self._numbers[part.name] = value
        fits = part.holds(value)
        fault = "" if fits else f"must be {'' if part.between else 'from '}{part.allowed}"
        if isinstance(part, ChoicePart):
            words = " or ".join(word.hex(" ").upper() for word in part.words)
            fault = "" if value in part.values else f"must be {words}"
        meaning = character(value) if part.type.role == "char" else ""
        if part.type.is_text:
            meaning = quoted(str(part.shown(value)))
        if isinstance(part, LengthPart):
            fault = self._disagrees(part, value) or fault
            where = " on the wire" if part.over_wire else ""
            meaning = f"bytes of {', '.join(part.counts)}{where}"
        elif isinstance(part, IdentityPart):
            meaning = " ".join(filter(None, (meaning, self._names_of(part))))
        return row.reads(value, meaning, fault)

    def _disagrees(self, part: LengthPart, value: int) -> str:
        """What is wrong with a length behind the first one, if there was that and it is another."""
        for other in self._sender.plan.further_lengths:
            first = self._numbers.get(other.first.part.name)
            payload = None if first is None else other.first.payload(first)
            if other.part.name == part.name and payload is not None:
                due = other.counted(payload)
                return "" if value == due else f"must be {due}, as {part.agrees_with} is {first}"
        return ""

    def _names_of(self, part: IdentityPart) -> str:
        """The messages of the identity, beside its last part."""
        if part.name != self._sender.frame.identity[-1].name:
            return ""
        names = [message.name for message in self._candidates()]
        return " or ".join(names) or "no message has this identity"

    def _checksum(self, part: ChecksumPart, row: Row) -> Row:
        taken = f"{part.taken} of " if part.taken else ""
        meaning = f"{taken}{part.algorithm.name} of {', '.join(part.covers)}"
        row = replace(row, meaning=meaning)
        unknown = [item.name for item in self._sender.frame.virtual if item.name in part.covers]
        unknown = [name for name in unknown if name not in self._found]
        if unknown and self.identity is not None:
            text = f"the identity is unknown, and so is {unknown[0]}, which {part.name} covers"
            return replace(row, fault=text)
        if any(name not in self._found for name in part.covers):
            return row
        pieces = [self._found[name] for name in part.covers]
        covered = b"".join(piece.wire if part.over_wire else piece.content for piece in pieces)
        number = part.due(checksum_of(part.algorithm).compute(covered))
        if part.type.within is not None:
            fault = f"{part.name} is {row.value}, not {number}"
            return row if row.value == number else replace(row, fault=fault)
        due = part.encode(number)
        if row.bytes == due:
            return row
        # In the words of a decoder: bytes in wire order, which are not always the number's digits.
        return replace(row, fault=f"{part.name} is {row.bytes.hex(' ')}, not {due.hex(' ')}")

    # --- the payload ------------------------------------------------------------------------

    def _payload(self, part: PayloadPart) -> list[Row]:
        size = self._payload_size(part)
        inside = self._cursor.part(size)
        message = self._message(size)
        if message is None:
            rows = [inside.take(size, part.name, "bytes", subject=part)] if size else []
        else:
            rows = self._dissected(message, inside)
        if inside.left:
            left, fault = inside.left, "" if self._is_cut(message) else _SURPLUS
            rest = inside.take(left, part.name, "bytes", fault=fault, subject=part)
            rows.append(rest if fault else replace(rest, meaning=_NOT_KNOWN))
        return rows or [replace(inside.take(0, part.name, "", subject=part), meaning="empty")]

    def _dissected(self, message: Message, inside: Cursor) -> list[Row]:
        """The rows of a payload; zeros that the frame leaves out have values and no bytes."""
        offset, size = inside.offset, inside.left
        own = message.sizes.greatest
        if self._is_cut(message) and message.cut_size is not None and size > own:
            return dissect(message.plan, inside.part(own), self._numbers)
        missing = own - size
        if missing <= 0 or not self._sender.plan.is_trimmed:
            return dissect(message.plan, inside, self._numbers)
        zeros = Cursor([*inside.rest(), *[Unit(0, b"")] * missing], offset)
        return list(_as_sent(dissect(message.plan, zeros, self._numbers), size))

    def _is_cut(self, message: Message | None) -> bool:
        """True if receivers leave what is behind the fields of a message."""
        is_known = message is not None and message.can_be_cut
        return is_known and self._sender.plan.is_cut

    def _payload_size(self, part: PayloadPart) -> int:
        """As the length part says, else what the parts behind it leave."""
        behind = self._parts[self._parts.index(part) + 1 :]
        length = self._sender.plan.length
        if length is None or length.over_wire or length.part.name not in self._numbers:
            return self._size_without_length(behind)
        stated = length.payload(self._numbers[length.part.name]) or 0
        return min(stated, self._cursor.left)

    def _size_without_length(self, behind: Sequence[Part]) -> int:
        """Bytes that the parts behind leave; the message's size if the frame is not whole."""
        message = self._given or next(iter(self._candidates()), None)
        last = behind[-1] if behind else None
        is_cut = isinstance(last, LiteralPart) and not self._cursor.ends_with(last.bytes)
        if message is not None and message.sizes.fixed is not None and is_cut:
            return min(message.sizes.fixed, self._cursor.left)
        return max(0, self._cursor.left - sum(part.size for part in behind))

    def _message(self, size: int) -> Message | None:
        """The given message, else that of this identity and size, else the one that is closest."""
        if self._given is not None:
            return self._given
        candidates = self._candidates()
        fitting = [message for message in candidates if size in message.sizes]
        yielded = [item for item in fitting if self._sender.received_as(item.name) == item.name]
        return next(iter((*yielded, *fitting, *candidates)), None)

    def _candidates(self) -> list[Message]:
        identity = self._identity or tuple(
            self._numbers.get(part.name, -1) for part in self._sender.frame.identity
        )
        return [message for message in self._sender.messages if message.is_told_by(identity)]

    @property
    def identity(self) -> Identity | None:
        """The identity that was read, or found before; None where a part of it is missing."""
        names = [part.name for part in self._sender.frame.identity]
        if self._identity is not None or any(name not in self._numbers for name in names):
            return self._identity
        return tuple(self._numbers[name] for name in names)

    # --- what is left -----------------------------------------------------------------------

    def _leftovers(self) -> None:
        if self._cursor.left:
            self._rows.append(self._cursor.take(self._cursor.left, "", "", fault=_SURPLUS))
        if self._wire.rest or self._wire.fault:
            fault = self._wire.fault
            meaning = "" if fault else "stands for no byte"
            self._rows.append(self._bare(self._wire.rest, meaning, fault))
        if self._wire.behind:
            self._rows.append(self._bare(b"".join(unit.wire for unit in self._wire.behind)))

    def _bare(self, wire: bytes, meaning: str = "", fault: str = "") -> Row:
        offset = sum(len(row.wire) for row in self._rows)
        return Row(offset=offset, wire=wire, meaning=meaning, fault=fault)


def _as_sent(rows: Sequence[Row], size: int) -> Iterator[Row]:
    """The rows of a payload that was filled up, without the bytes behind the first `size`."""
    for row in rows:
        sent, size = row.bytes[:size], max(0, size - len(row.bytes))
        if len(sent) == len(row.bytes):
            yield row
        else:
            meaning = "; ".join(filter(None, (row.meaning, _LEFT_OUT if not sent else "")))
            yield replace(row, bytes=sent, meaning=meaning)
