"""A sender's frame as the fast engine sees it: where its parts lie, and what finds its end."""

from __future__ import annotations

from collections.abc import Callable
from functools import cached_property

from protogen.model.frame_places import Place, Run, Side
from protogen.model.frame_plan import EndRule
from protogen.model.parts import (
    BitsPart,
    ChecksumPart,
    LiteralPart,
    NumberPart,
    Part,
    VirtualPart,
    checksums_of,
)
from protogen.model.protocol import Sender
from protogen.runtime.bulk_cut import MIN_DATA
from protogen.runtime.transparency import replacing_order
from protogen.targets.python.literals import octets_in_class

_MOST_SPECIALS = 4
_MOST_IDENTITIES = 4096


class EngineFrame:
    """Everything about a sender's frames that the functions of the fast engine are printed from."""

    def __init__(self, sender: Sender) -> None:
        plan = sender.plan
        region = plan.region
        self.sender = sender
        self.plan = plan
        self.head = tuple(item.part for item in plan.head)
        self.tail = tuple(item.part for item in plan.tail)
        self.parts = (*self.head, plan.frame.payload, *self.tail)
        self.checksums = sender.frame.checksums
        self.shown = tuple(i.part for i in plan.shown if isinstance(i.part, NumberPart))
        self.stuffed = region is not None
        self.before = 0 if region is None else region.before
        self.behind = 0 if region is None else region.behind
        self.greatest_payload = max((item.sizes.greatest for item in sender.messages), default=0)
        """Bytes of the largest payload that a message has, whatever frames allow."""
        self.gives_content = False
        """True if readers are given the whole content of a frame, and not its payload alone."""
        self._covered: dict[tuple[str, str, int], list[str | VirtualPart]] = {}
        """Expressions of what checksums cover: those of all messages are the same."""

    @cached_property
    def skipped(self) -> int:
        """Bytes at the start of a frame that are not in the content.

        These are all in front of the stuffed region, if they are literals.
        """
        region = self.plan.region
        if region is None:
            return len(self.plan.start_bytes) if self.plan.shares_delimiter else 0
        return region.before if region.literals_in_front else 0

    # --- what can be cut --------------------------------------------------------------------------

    @cached_property
    def can_frame(self) -> bool:
        """True if there is a function that makes frames; else the reference does it alone."""
        return (
            (self.takes_whole or not self.plan.cut_ambiguous)
            and not any(part.over_wire for part in self.checksums)
            and self.tail == self.checksums
            and self.plan.is_regular
            and self._has_few_identities
            and not self.plan.frame.length_over_wire
            and not self._holds_parts
        )

    @property
    def _holds_parts(self) -> bool:
        """True if some message has numbers of the frame as fields, which readers do not take."""
        return any(message.held for message in self.sender.messages)

    @property
    def takes_whole(self) -> bool:
        """True if there is a function that takes frames; it looks their identities up in a table.

        A range of very many identities is left to the reference.
        """
        several = filter(None, (group.identities for group in self.plan.groups))
        are_few = sum(item.count for item in several) <= _MOST_IDENTITIES
        is_plain = self.plan.takes_whole and not self._holds_parts
        return is_plain and are_few and self._has_few_identities

    @property
    def _has_few_identities(self) -> bool:
        """True if tables have room for what each identity puts into checksums."""
        return all(item.count <= _MOST_IDENTITIES for item in self.plan.virtual)

    @property
    def lists_frame_sizes(self) -> bool:
        """True if the table of identities has sizes of whole frames, and not of payloads."""
        plan = self.plan
        varies = plan.has_open_groups or plan.optional_size
        return plan.end_rule is EndRule.IDENTITY and not varies

    @property
    def remembered(self) -> tuple[int, int] | None:
        """Begin and end in the content of all numbers that events show.

        None where a stream repeats these bytes too seldom for remembering what they mean.
        """
        others = [part for part in self.shown if part not in self.plan.identity]
        places = {self.offset(part): part.size for part in others}  # Bits of one share theirs.
        if not self.shown or sum(places.values()) > 1:
            return None
        first = min(map(self.offset, self.shown))
        last = max(self.offset(part) + part.size for part in self.shown)
        between = [part for part in self.head if first <= self.offset(part) < last]
        plain = not any(map(checksums_of, between))
        return (first, last) if plain else None

    @property
    def can_cut_in_bulk(self) -> bool:
        """True if runs of frames of one message can be taken at once, but for their checksum.

        Delimiters show by special bytes, all of a frame that is not a delimiter is stuffed, and
        frames of one message that are equally long have all parts in the same places.
        """
        specials = self.specials(sending=False)
        if not self.takes_whole or self.replacements is None or specials is None:
            return False
        start, end = self.plan.start_bytes, self.plan.end_bytes
        if self.plan.end_rule is EndRule.NEXT_START:
            shows = len(start) == 1
        else:
            shows = (
                self.plan.end_rule is EndRule.DELIMITER
                and start[:1] != b""
                and {start[0], end[0]} <= {*specials}
            )
        return (
            shows
            and self.before == self.skipped == len(start)
            and not (self.behind or self.plan.shares_delimiter)
            and all(len(code) > 1 for _, code in self.replacements)
            and self.plan.length is not None
            and self.gives_content
            and self.remembered is not None
            and len(self.checksums) == 1
            and self.tail == self.checksums
            and self.plan.greatest < MIN_DATA
            and not any(isinstance(part, BitsPart) for part in self.head)
        )

    @property
    def around(self) -> tuple[int, int] | None:
        """Bytes of the content in front of the payload and behind it.

        None where that varies, and where the payload is wanted by itself.
        """
        if self.plan.optional_size or self.plan.seven_bit or self.plan.is_fitted:
            return None
        if self.plan.length is None and self.plan.end_rule is not EndRule.IDENTITY:
            return None
        return self.plan.head_size - self.skipped, self.plan.tail_size

    @property
    def shows_identity(self) -> bool:
        """True if events show the identity and no other part."""
        return self.shown == self.plan.identity

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
        codes = () if self.plan.region is None else self.plan.region.codes
        if not codes:
            return None
        found = {byte for byte, _ in codes} | {code[0] for _, code in codes}
        if (
            not sending
            and self.plan.end_rule is EndRule.NEXT_START
            and len(self.plan.start_bytes) == 1
        ):
            found -= set(self.plan.start_bytes)
        return tuple(sorted(found)) if len(found) <= _MOST_SPECIALS else None

    # --- where parts lie --------------------------------------------------------------------------

    def offset(self, part: Part) -> int:
        """Place of a part of the head in the content; of one of the tail, from its end."""
        placed = self.plan.part(part.name)
        return placed.offset - (self.skipped if placed.in_head else self.plan.tail_size)

    def slice_of(self, content: str, first: int, last: int) -> str:
        """Bytes of the content; a `last` of 0 is its end, negative numbers count from there."""
        if first == 0 and last == 0:
            return content
        return f"{content}[{first or ''}:{last or ''}]"

    def covered(
        self,
        part: ChecksumPart,
        content: str,
        missing: int = 0,
        *,
        virtual: Callable[[VirtualPart], str],
    ) -> str:
        """Bytes that a checksum covers, as an expression.

        The content's last `missing` bytes are not there yet. `virtual` gives the bytes of a part
        that is not sent.
        """
        key = part.name, content, missing
        if key not in self._covered:
            self._covered[key] = [
                run
                if isinstance(run, VirtualPart)
                else octets_in_class(run)
                if isinstance(run, bytes)
                else self.slice_of(content, *(_moved(bound, missing) for bound in run))
                for run in self.covered_runs(part)
            ]
        pieces = (it if isinstance(it, str) else virtual(it) for it in self._covered[key])
        return " + ".join(pieces) or 'b""'

    def covered_runs(self, part: ChecksumPart) -> tuple[tuple[int, int] | bytes | VirtualPart, ...]:
        """Bytes that a checksum covers, or where they begin and end in the content.

        A place below 0 is counted from the content's end, as is an end of 0.
        """
        plan = next(item for item in self.plan.checksums if item.part == part)
        runs: list[tuple[int, int] | bytes | VirtualPart] = []
        for run in plan.covers:
            if not isinstance(run, Run):
                runs.append(run)
                continue
            first, end = self._place(run.first), self._place(run.end)
            if run.first.side is Side.HEAD and first < 0:
                runs.append(self.front[run.first.offset : self._front_end(run.end)])
                first = 0
            if run.end.side is Side.TAIL or end > 0:
                runs.append((first, end))
        return tuple(runs)

    @cached_property
    def front(self) -> bytes:
        """Literals in front of the content."""
        literals = [part.bytes for part in self.head if isinstance(part, LiteralPart)]
        return b"".join(literals)[: self.skipped]

    def _front_end(self, place: Place) -> int:
        return place.offset if place.side is Side.HEAD else self.skipped

    def _place(self, place: Place) -> int:
        """Place in the content; those of the tail are counted from its end."""
        return place.offset - (self.skipped if place.side is Side.HEAD else self.plan.tail_size)

    def is_start(self, part: LiteralPart) -> bool:
        """True if finding the start has checked the literal."""
        behind = self.offset(part) + self.skipped + len(part.bytes)
        return behind <= len(self.plan.start_bytes)

    def is_skipped(self, part: Part) -> bool:
        """True if a part is a literal in front of the content."""
        return part in self.head and self.offset(part) < 0


def _moved(bound: int, missing: int) -> int:
    """A place counted from the content's end, where the last `missing` bytes are not there."""
    return bound + missing if bound < 0 else bound
