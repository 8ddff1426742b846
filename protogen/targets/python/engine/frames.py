"""A sender's frame as the fast engine sees it: where its parts lie, and what finds its end."""

from __future__ import annotations

from protogen.model.frame import (
    Base16,
    ChecksumPart,
    Cobs,
    Escape,
    LiteralPart,
    NumberPart,
    Part,
    PayloadPart,
    Substitution,
)
from protogen.model.frame_plan import EndRule, LengthPlan
from protogen.model.messages import Message
from protogen.model.protocol import Sender
from protogen.runtime.bulk_cut import MIN_DATA
from protogen.runtime.transparency import replacing_order
from protogen.targets.python.literals import octets_in_class

_MOST_SPECIALS = 4


class FastFrame:
    """Everything about a sender's frames that the functions of the fast engine are printed from."""

    def __init__(self, sender: Sender, *, skips_start: bool = False) -> None:
        """With `skips_start` the content begins behind literals in front of what is stuffed."""
        plan = sender.plan
        region = plan.region
        self.sender = sender
        self.plan = plan
        self.framing = sender.framing
        self.start = self.framing.start
        self.start_bytes = plan.start_bytes
        self.end = plan.end_bytes
        self.head = tuple(item.part for item in plan.head)
        self.tail = tuple(item.part for item in plan.tail)
        self.parts = (*self.head, plan.frame.payload, *self.tail)
        self.head_size = plan.head_size
        self.tail_size = plan.tail_size
        self.length = None if plan.length is None else plan.length.part
        self.checksums = sender.frame.checksums
        self.identity = plan.identity
        self.shown = tuple(i.part for i in plan.shown if isinstance(i.part, NumberPart))
        self.groups = plan.groups
        self.stuffed = region is not None
        self.before = 0 if region is None else region.before
        self.behind = 0 if region is None else region.behind
        self.skipped = self._literals_in_front if skips_start else 0
        """Bytes at the start of a frame that are not in the content."""
        self.gives_content = False
        """True if readers are given the whole content of a frame, and not its payload alone."""

    @property
    def _literals_in_front(self) -> int:
        """Bytes in front of the stuffed region, if they are all literals; else 0."""
        region = self.plan.region
        if region is None:
            return len(self.start_bytes) if self.shares else 0
        return region.before if region.literals_in_front else 0

    @property
    def length_plan(self) -> LengthPlan:
        """What the length part counts; only for frames that have one."""
        assert self.plan.length is not None
        return self.plan.length

    def sends(self, message: Message) -> bool:
        """Whether the sender sends the message."""
        return self.sender.name in message.senders

    # --- what can be cut --------------------------------------------------------------------------

    @property
    def ended_by(self) -> EndRule:
        """What tells where a frame ends."""
        return self.plan.end_rule

    @property
    def can_cut(self) -> bool:
        """True if there is a function that cuts frames; else the reference does it alone."""
        return self.plan.takes_whole

    @property
    def can_frame(self) -> bool:
        """True if there is a function that makes frames; else the reference does it alone."""
        return (
            (self.plan.takes_whole or not self.plan.cut_ambiguous)
            and not any(part.over_wire for part in self.checksums)
            and self.tail == self.checksums
            and self.plan.is_regular
        )

    @property
    def optional(self) -> bool:
        """Whether the checksums are absent where the payload is empty."""
        return any(part.when_payload for part in self.checksums)

    @property
    def optional_size(self) -> int:
        """Bytes that are absent where the payload is empty."""
        return self.plan.optional_size

    @property
    def shares(self) -> bool:
        """True if the end of a frame may be the start of the next as well."""
        return self.plan.shares_delimiter

    @property
    def has_open_groups(self) -> bool:
        """True if the payloads of some identity vary in size."""
        return self.plan.has_open_groups

    @property
    def lists_frame_sizes(self) -> bool:
        """Whether the table of identities has sizes of whole frames, and not of payloads."""
        return self.ended_by is EndRule.IDENTITY and not self.has_open_groups and not self.optional

    @property
    def remembered(self) -> tuple[int, int] | None:
        """Where the bytes of all numbers that events show begin and end in the content.

        None where a stream repeats these bytes too seldom for remembering what they mean.
        """
        others = [part for part in self.shown if part not in self.identity]
        if not self.shown or sum(part.size for part in others) > 1:
            return None
        first = min(map(self.offset, self.shown))
        last = max(self.offset(part) + part.size for part in self.shown)
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
        if self.ended_by is EndRule.NEXT_START:
            shows = len(start) == 1
        else:
            shows = (
                self.ended_by is EndRule.DELIMITER
                and start[:1] != b""
                and {start[0], end[0]} <= {*specials}
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
        if self.length is None and self.ended_by is not EndRule.IDENTITY:
            return None
        return self.head_size - self.skipped, self.tail_size

    @property
    def shows_identity(self) -> bool:
        """Whether events show the identity and no other part."""
        return self.shown == self.identity

    # --- stuffing ---------------------------------------------------------------------------------

    @property
    def replacements(self) -> tuple[tuple[bytes, bytes], ...] | None:
        """Bytes and what stands for them, in an order in which an encoder can replace them.

        None where there is none, and where a byte begins codes but has none itself.
        """
        region = self.plan.region
        if region is None or not region.codes:
            return None
        table = {bytes((byte,)): code for byte, code in region.codes}
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
        if not sending and self.ended_by is EndRule.NEXT_START and len(self.start_bytes) == 1:
            found -= set(self.start_bytes)
        return tuple(sorted(found)) if len(found) <= _MOST_SPECIALS else None

    # --- where parts lie --------------------------------------------------------------------------

    def offset(self, part: Part) -> int:
        """Where a part of the head begins in the content, and one of the tail, from its end."""
        if part in self.head:
            return self.plan.part(part.name).offset - self.skipped
        return self.plan.part(part.name).offset - self.tail_size

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
        return first, first + part.size


def _moved(bound: int, missing: int) -> int:
    """A place counted from the content's end, where the last `missing` bytes are not there."""
    return bound + missing if bound < 0 else bound
