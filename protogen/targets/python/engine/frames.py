"""A sender's frame as the fast engine sees it: where its parts lie, and what finds its end."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

from protogen.model.frame import (
    Base16,
    ChecksumPart,
    Cobs,
    CounterPart,
    Escape,
    IdentityPart,
    LengthPart,
    LiteralPart,
    Part,
    PayloadPart,
    Substitution,
    ValuePart,
)
from protogen.model.framing import AfterEnd, Anywhere, StartLiteral, StartSet
from protogen.model.messages import Message
from protogen.model.protocol import Sender
from protogen.model.wire import fixed_size
from protogen.runtime.bulk_cut import MIN_DATA
from protogen.runtime.transparency import replacing_order
from protogen.targets.python.literals import octets_in_class

EndedBy = Literal["end", "start", "length", "kind"]
"""What tells where a frame ends: an end that is looked for, the next start, a length, or the
identity."""

_MOST_SPECIALS = 4


@dataclass(frozen=True, slots=True)
class Kin:
    """The messages that a receiver may find behind one identity."""

    identity: tuple[int, ...]
    messages: tuple[Message, ...]

    @property
    def fixed(self) -> int | None:
        """The payload's size, where no message has another one."""
        sizes = {message.sizes.fixed for message in self.messages}
        return sizes.pop() if len(sizes) == 1 else None

    @property
    def greatest(self) -> int:
        """The greatest payload of these messages."""
        return max(message.sizes.greatest for message in self.messages)


class FastFrame:
    """Everything about a sender's frames that the functions of the fast engine are printed from."""

    def __init__(self, sender: Sender, *, skips_start: bool = False) -> None:
        """With `skips_start` the content begins behind literals in front of what is stuffed."""
        self.sender = sender
        self.framing = sender.framing
        frame = sender.frame
        self.start = self.framing.start
        self.end = b"" if self.framing.end is None else self.framing.end.bytes
        self.parts = _without_end(frame.parts, len(self.end))
        index = next(i for i, part in enumerate(self.parts) if isinstance(part, PayloadPart))
        self.head, self.tail = self.parts[:index], self.parts[index + 1 :]
        self.head_size = sum(map(fixed_size, self.head))
        self.tail_size = sum(map(fixed_size, self.tail))
        self.length = frame.length
        self.checksums = frame.checksums
        self.identity = frame.identity
        self.shown = tuple(
            part for part in self.parts if isinstance(part, IdentityPart | CounterPart | ValuePart)
        )
        self.kins = _kins(sender)
        self.before, self.stuffed, self.behind = self._regions()
        self.skipped = self._literals_in_front if skips_start else 0
        """Bytes at the start of a frame that are not in the content."""
        self.gives_content = False
        """Whether readers are given the whole content of a frame, and not its payload alone."""

    @property
    def _literals_in_front(self) -> int:
        """The bytes in front of what is stuffed, if they are all literals; else 0."""
        transparency = self.sender.frame.transparency
        if transparency is None:
            return len(self.start_bytes) if self.shares else 0
        names = [part.name for part in self.parts]
        front = self.parts[: names.index(transparency.first)]
        return self.before if all(isinstance(part, LiteralPart) for part in front) else 0

    def _regions(self) -> tuple[int, bool, int]:
        """Bytes in front of what is stuffed, whether anything is, and bytes behind it."""
        covered = self._covered_by_stuffing
        if not covered:
            return 0, False, 0
        before = sum(map(fixed_size, self.parts[: covered.start]))
        return before, True, sum(map(fixed_size, self.parts[covered.stop :]))

    @property
    def _covered_by_stuffing(self) -> range:
        """The places of the parts that are stuffed; none where nothing is."""
        transparency = self.sender.frame.transparency
        if transparency is None:
            return range(0)
        names = [part.name for part in self.parts]
        first = names.index(transparency.first)
        last = names.index(transparency.last) if transparency.last in names else len(names) - 1
        return range(first, last + 1)

    def sends(self, message: Message) -> bool:
        """Whether the sender sends the message."""
        return self.sender.name in message.senders

    # --- what can be cut --------------------------------------------------------------------------

    @property
    def ended_by(self) -> EndedBy | None:
        """What tells where a frame ends; None where only the reference can."""
        protected_end = self.framing.end is not None and self.framing.end.protected
        protected_start = isinstance(self.start, StartLiteral | StartSet) and self.start.protected
        if self.stuffed:
            if protected_end:
                return "end"
            return "start" if protected_start and not self.end else None
        if protected_end:
            return "end"
        if self.length is not None:
            return "length"
        return "kind" if self.identity else None

    @property
    def can_cut(self) -> bool:
        """Whether there is a function that cuts frames; else the reference does it alone."""
        return (
            self.ended_by is not None
            and not isinstance(self.start, Anywhere)
            and all(part in self.head for part in self.identity)
            and (self.length is None or self.length in self.head)
            and all(isinstance(part, ChecksumPart) for part in self.tail)
            and not any(part.over_wire for part in self.checksums if self.stuffed)
            and self._checksums_are_alike
            and not (self.optional and any(part in self.head for part in self.checksums))
            and not (self.optional and self.behind and self.before < self.head_size)
            and self._region_is_plain
            and (not self.shares or self._shares_plainly)
        )

    @property
    def _shares_plainly(self) -> bool:
        """Whether a frame with a shared delimiter is all that is between two of them."""
        alone = self._literals_in_front == len(self.start_bytes)
        return alone and self.ended_by == "end"

    @property
    def _region_is_plain(self) -> bool:
        """Whether the payload is in what is stuffed, if anything is, and the start is not."""
        if not self.stuffed:
            return True
        starts_in_front = isinstance(self.start, AfterEnd) or self.before > 0
        return starts_in_front and len(self.head) in self._covered_by_stuffing

    @property
    def can_wait(self) -> bool:
        """Whether there is a function that tells plain beginnings of frames."""
        transparency = self.sender.frame.transparency
        encoding = None if transparency is None else transparency.encoding
        return (
            self.can_cut
            and not self.shares
            and (not self.stuffed or self.replacements is not None or isinstance(encoding, Base16))
            and (bool(self.end) or self.length is not None or not self._are_all_open)
        )

    @property
    def can_frame(self) -> bool:
        """Whether there is a function that makes frames; else the reference does it alone."""
        return (
            (self.can_cut or not self.framing.cut_ambiguous)
            and not any(part.over_wire for part in self.checksums)
            and self.tail == self.checksums
            and self._checksums_are_alike
            and self._region_is_plain
        )

    @property
    def _checksums_are_alike(self) -> bool:
        """Whether all of them are absent where the payload is empty, or none is."""
        return len({part.when_payload for part in self.checksums}) < 2

    @property
    def optional(self) -> bool:
        """Whether the checksums are absent where the payload is empty."""
        return any(part.when_payload for part in self.checksums)

    @property
    def optional_size(self) -> int:
        """Bytes that are absent where the payload is empty."""
        return sum(fixed_size(part) for part in self.checksums if part.when_payload)

    def counted(self, part: LengthPart) -> int:
        """What the length counts besides the payload."""
        return sum(
            fixed_size(other) for other in self.sender.frame.parts if other.name in part.counts
        )

    def counted_optional(self, length: LengthPart) -> int:
        """What the length counts less where the payload is empty."""
        absent = (part for part in self.checksums if part.when_payload)
        return sum(fixed_size(part) for part in absent if part.name in length.counts)

    @property
    def shares(self) -> bool:
        """Whether the end of a frame may be the start of the next as well."""
        return isinstance(self.start, StartLiteral) and self.start.bytes == self.end

    @property
    def _are_all_open(self) -> bool:
        return all(kin.fixed is None for kin in self.kins)

    @property
    def has_open_kinds(self) -> bool:
        """Whether the payloads of some identity vary in size."""
        return any(kin.fixed is None for kin in self.kins)

    @property
    def lists_frame_sizes(self) -> bool:
        """Whether the table of identities has sizes of whole frames, and not of payloads."""
        return self.ended_by == "kind" and not self.has_open_kinds and not self.optional

    @property
    def remembered(self) -> tuple[int, int] | None:
        """Where the bytes of all numbers that events show begin and end in the content.

        None where a stream repeats these bytes too seldom for remembering what they mean.
        """
        others = [part for part in self.shown if part not in self.identity]
        if not self.shown or sum(map(fixed_size, others)) > 1:
            return None
        first = min(map(self.offset, self.shown))
        last = max(self.offset(part) + fixed_size(part) for part in self.shown)
        between = [part for part in self.head if first <= self.offset(part) < last]
        plain = not any(isinstance(part, ChecksumPart) for part in between)
        return (first, last) if plain else None

    @property
    def has_runs(self) -> bool:
        """Whether runs of frames of one message can be taken at once, but for their checksum.

        Delimiters show by special bytes, all of a frame that is not a delimiter is stuffed, and
        frames of one message that are equally long have all parts in the same places.
        """
        specials = self.specials(sending=False)
        if not self.can_cut or self.replacements is None or specials is None:
            return False
        start, end = self.start_bytes, self.end
        if self.ended_by == "start":
            shows = len(start) == 1
        else:
            shows = (
                self.ended_by == "end" and start[:1] != b"" and {start[0], end[0]} <= {*specials}
            )
        return (
            shows
            and self.before == self.skipped == len(start)
            and not (self.behind or self.shares)
            and all(len(code) > 1 for _, code in self.replacements)
            and self.length is not None
            and self.gives_content
            and self.remembered is not None
            and len(self.checksums) == 1
            and self.tail == self.checksums
            and self.framing.greatest < MIN_DATA
        )

    @property
    def around(self) -> tuple[int, int] | None:
        """Bytes of the content in front of the payload and behind it.

        None where that varies, and where the payload is wanted by itself.
        """
        if self.optional or self.framing.seven_bit:
            return None
        if self.length is None and self.ended_by != "kind":
            return None
        return self.head_size - self.skipped, self.tail_size

    @property
    def can_decode(self) -> bool:
        """Whether there is a function that takes a frame by itself."""
        return self.can_cut and (self.ended_by != "start" or self.length is not None)

    @property
    def shows_identity(self) -> bool:
        """Whether events show the identity and no other part."""
        return self.shown == self.identity

    @property
    def start_bytes(self) -> bytes:
        """The start literal; empty where there is none."""
        return self.start.bytes if isinstance(self.start, StartLiteral) else b""

    # --- stuffing ---------------------------------------------------------------------------------

    @property
    def replacements(self) -> tuple[tuple[bytes, bytes], ...] | None:
        """Bytes and what stands for them, in an order in which an encoder can replace them.

        None where there is none, and where a byte begins codes but has none itself.
        """
        transparency = self.sender.frame.transparency
        match None if transparency is None else transparency.encoding:
            case Substitution(table=listed):
                table = {bytes((byte,)): code for byte, code in listed}
            case Escape(byte=byte, of=of, xor=xor):
                table = {bytes((member,)): bytes((byte, member ^ xor)) for member in of}
            case _:
                return None
        if any(code[:1] not in table for code in table.values()):
            return None
        return replacing_order(table)

    def specials(self, sending: bool) -> tuple[int, ...] | None:
        """Bytes without which a stuffed region stands for itself.

        None where there are too many, or where every region is encoded.
        """
        transparency = self.sender.frame.transparency
        match None if transparency is None else transparency.encoding:
            case Substitution(table=table):
                found = {byte for byte, _ in table} | {code[0] for _, code in table}
            case Escape(byte=byte, of=of):
                found = {byte, *of}
            case Base16() | Cobs() | None:
                return None
        if not sending and self.ended_by == "start" and len(self.start_bytes) == 1:
            found -= set(self.start_bytes)
        return tuple(sorted(found)) if len(found) <= _MOST_SPECIALS else None

    # --- where parts lie --------------------------------------------------------------------------

    def offset(self, part: Part) -> int:
        """Where a part of the head begins in the content, and one of the tail, from its end."""
        if part in self.head:
            return sum(map(fixed_size, self.head[: self.head.index(part)])) - self.skipped
        return -sum(map(fixed_size, self.tail[self.tail.index(part) :]))

    def slice_of(self, content: str, first: int, last: int) -> str:
        """Bytes of the content; a `last` of 0 is its end, negative numbers count from there."""
        if first == 0 and last == 0:
            return content
        return f"{content}[{first or ''}:{last or ''}]"

    def covered(self, part: ChecksumPart, content: str, missing: int = 0) -> str:
        """What a checksum covers, as an expression.

        The content's last `missing` bytes are not there yet.
        """
        pieces = [
            octets_in_class(run)
            if isinstance(run, bytes)
            else self.slice_of(content, *(_moved(bound, missing) for bound in run))
            for run in self.covered_runs(part)
        ]
        return " + ".join(pieces) or 'b""'

    def covered_runs(self, part: ChecksumPart) -> tuple[tuple[int, int] | bytes, ...]:
        """What a checksum covers: bytes, or where they begin and end in the content.

        A place below 0 is counted from the content's end, as is an end of 0.
        """
        runs: list[tuple[int, int] | bytes] = []
        for name in part.covers:
            run = self._run(name)
            before = runs[-1] if runs else None
            if isinstance(run, tuple) and isinstance(before, tuple) and before[1] == run[0] != 0:
                runs[-1] = (before[0], run[1])
            else:
                runs.append(run)
        return tuple(runs)

    def is_start(self, part: LiteralPart) -> bool:
        """Whether finding the start has checked the literal."""
        behind = self.offset(part) + self.skipped + len(part.bytes)
        return behind <= len(self.start_bytes)

    def is_skipped(self, part: LiteralPart) -> bool:
        """Whether a literal stands in front of the content."""
        return part in self.head and self.offset(part) < 0

    def _run(self, name: str) -> tuple[int, int] | bytes:
        """Where a part begins and ends in the content; the bytes of one that is not in it."""
        part = self.sender.frame.part(name)
        if isinstance(part, LiteralPart) and (self.is_skipped(part) or part not in self.parts):
            return part.bytes
        if isinstance(part, PayloadPart):
            return self.head_size - self.skipped, -self.tail_size
        first = self.offset(part)
        return first, first + fixed_size(part)


def _moved(bound: int, missing: int) -> int:
    """A place counted from the content's end, where the last `missing` bytes are not there."""
    return bound + missing if bound < 0 else bound


def _without_end(parts: tuple[Part, ...], left: int) -> tuple[Part, ...]:
    """The parts without the literals that make up the end."""
    count = len(parts)
    while left > 0 and isinstance(part := parts[count - 1], LiteralPart):
        left -= len(part.bytes)
        count -= 1
    return parts[:count]


def _kins(sender: Sender) -> tuple[Kin, ...]:
    hidden = {
        name
        for overload in sender.overloads
        if overload.yields is not None
        for name in overload.messages
        if name != overload.yields
    }
    found: dict[tuple[int, ...], list[Message]] = {}
    for message in sender.messages:
        if message.name not in hidden:
            found.setdefault(message.identity, []).append(message)
    return tuple(Kin(identity, tuple(messages)) for identity, messages in found.items())
