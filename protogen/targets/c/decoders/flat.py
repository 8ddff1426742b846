"""A flat decoder in C: its counters, and the conditions that are made of them."""

from __future__ import annotations

from collections.abc import Iterator
from functools import cached_property

from protogen.targets.c.decoders.groups import GroupView
from protogen.targets.c.decoders.received import ReceivedFrame
from protogen.targets.c.frame.checksums import ChecksumView, CoveredRun
from protogen.targets.c.frame.expressions import byte
from protogen.targets.c.frame.numbers import LiteralView, NumberView
from protogen.targets.c.frame.part_numbers import fills_bytes
from protogen.targets.c.frame.stuffing import Branch, Node, StuffingKind

_TOP_BITS = {f"uint{bits}_t": 1 << (bits - 1) for bits in (8, 16, 32)}
"""The highest bits of what counts bytes."""


class FlatDecoder(ReceivedFrame, frozen=True, dict=True):
    """Counters and conditions of a flat decoder."""

    # --- counters ---------------------------------------------------------------------------------

    @cached_property
    def only_size(self) -> int | None:
        """The payload's size where all messages have the same, and each identity one message.

        Frames of other sizes are given up where they tell their size: nobody asks for them, and no
        frame can start inside of them.
        """
        groups = self.groups
        sizes = {group.fixed if len(group.messages) == 1 else None for group in groups}
        return sizes.pop() if len(sizes) == 1 else None

    @property
    def lead(self) -> int:
        """What the counter of content counts in front of the buffer.

        A start that is not kept is one, so that nought says that no candidate is open.
        """
        return 1 if self.plan.skipped else 0

    @property
    def place(self) -> str:
        """The place in the buffer of the byte that is taken."""
        return "at - 1U" if self.lead else "at"

    @property
    def place_behind(self) -> str:
        """The same where that counter has counted it."""
        return f"at - {self.lead + 1}U"

    @property
    def payload(self) -> str:
        """The payload's size in C."""
        return "payload" if self.only_size is None else f"{self.only_size}U"

    @property
    def limit(self) -> str:
        """Value of the counter when all content is there, as far as is known."""
        if self.only_size is None:
            return "limit" if self.takes_start_alike else "decoder->limit"
        return f"{self.counts_around + self.only_size}U"

    @property
    def counts_around(self) -> int:
        """What that counter has more than the payload's size then."""
        return self.around + self.lead

    @property
    def counts_digits(self) -> bool:
        """True if bytes of content come as two digits each, which are counted."""
        return self.stuffing is not None and self.stuffing.kind is StuffingKind.BASE16

    def counted(self, size: int) -> int:
        """Value of the counter of content behind so many bytes of it."""
        return (self.lead + size) * (2 if self.counts_digits else 1)

    @property
    def counted_limit(self) -> str:
        """Value of that counter when all content is there, as far as is known."""
        if self.only_size is None:
            return f"2U * {self.limit}" if self.counts_digits else self.limit
        return f"{self.counted(self.around + self.only_size)}U"

    @property
    def content_counter(self) -> str:
        """The variable for it while a byte is taken."""
        return "digits" if self.counts_digits else "at"

    @property
    def has_node(self) -> bool:
        """True if something else than that counter tells the place inside of a stuffed byte."""
        return self.stuffing is not None and not self.counts_digits and self.escape_flag is None

    @cached_property
    def escape_flag(self) -> int | None:
        """The bit of that counter that says that an escape came; None where `node` says it.

        Then one comparison finds all that is rare: no candidate, an escape, and the last byte.
        """
        if self.handed is None or self.only_size is None or self.checks_head:
            return None
        if self.stuffing is None or self.stuffing.kind is not StuffingKind.CODES:
            return None
        begins = [b.node is not None for b in self.branches(self.stuffing.nodes[0])]
        if begins != [True] or self.escape_xor is None or self.refused:
            return None
        flag = _TOP_BITS[self.counter]
        return flag if self.last_due < flag else None

    @property
    def last_due(self) -> int:
        """Value of that counter where the last byte of content is due, in frames of one size."""
        assert self.only_size is not None
        return self.counted(self.around + self.only_size) - 1

    @property
    def escape(self) -> str:
        """The byte of the escape, where there is one."""
        assert self.stuffing is not None
        return byte(self.branches(self.stuffing.nodes[0])[0].byte)

    @property
    def idle_member(self) -> str:
        """The counter that says that no candidate is open.

        No byte gets into a candidate whose limit is nought, which is the shortest test; but only
        where a limit is all that is in front of it can that not be mistaken for a payload's size.
        """
        is_size = self.around > self.first_head or self.counts_digits
        return "content" if is_size or self.only_size is not None else "limit"

    @property
    def idle_value(self) -> int:
        """Value of that counter then: nothing, or more than there is room for.

        A frame that is complete but for its end has no room either, which is the same test.
        """
        is_nothing = self.only_size is not None or self.idle_member == "limit"
        return 0 if is_nothing else self.counted(self.buffer_size + 1)

    @property
    def is_idle(self) -> str:
        """The condition that no candidate is open."""
        if self.is_over_when_full:
            return "decoder->content >= decoder->limit"
        return f"decoder->{self.idle_member} == {self.idle_value}U"

    @property
    def is_over_when_full(self) -> bool:
        """True if no byte is due behind the last one of content, so that nothing is given up."""
        return self.idle_member == "limit" and not self.plan.end_bytes

    @property
    def gives_up_first(self) -> bool:
        """True if `push` gives up before it looks at a byte, and takes that back for a digit."""
        return False

    @property
    def skip_start(self) -> str:
        """What passes by a start that nobody asked for; empty where that is giving it up."""
        sets_limit = self.idle_member == "limit" and self.only_size is None
        return "limit = 0U;\n    break;" if sets_limit else ""

    @property
    def size_member(self) -> str:
        """The counter that still has the size of content when a frame is complete."""
        return "content" if self.idle_member == "limit" else "limit"

    def size_kept(self, payload: str) -> str:
        """The size of a payload as that counter holds it."""
        return f"({self.counter})({payload} + {self.counts_around}U)"

    @property
    def shown_size(self) -> str:
        """The payload's size of a complete frame, as an argument in front of others."""
        if self.only_size is not None:
            return ""
        return f"({self.counter})(decoder->{self.size_member} - {self.counts_around}U), "

    @cached_property
    def handed(self) -> ChecksumView | None:
        """The checksum that is the last byte of a frame: it is compared as it comes, and not kept.

        The zeros of a payload that is filled up need its room.
        """
        if self.end_size or self.counts_digits or self.filled_size:
            return None
        last = self.around - 1
        for c in self.checksums:
            is_byte = c.size == 1 and fills_bytes(c.part) and not c.optional
            if is_byte and c.at.at(0) == last and self._covers_up_to(last):
                return c
        return None

    def _covers_up_to(self, last: int) -> bool:
        """True if no checksum covers the last byte."""
        runs = [item for c in self.checksums for item in c.covers if isinstance(item, CoveredRun)]
        return all(run.last.at(0) <= last for run in runs)

    @property
    def buffer_size(self) -> int:
        """Bytes of the buffer."""
        return super().buffer_size - (1 if self.handed else 0)

    @property
    def kept_content(self) -> str:
        """Where the content begins in the buffer."""
        return "decoder->buffer"

    @property
    def has_no_room(self) -> str:
        """The condition that no byte of content is due."""
        if self.only_size is None:
            return f"at >= {self.limit}"
        last = self.counts_around + self.only_size - 1
        return f"({self.counter})(at - 1U) >= {last}U" if self.plan.end_bytes else "at == 0U"

    # --- start and end ----------------------------------------------------------------------------

    @property
    def sees_start(self) -> str:
        """The condition that a byte is a start."""
        return "byte > 0x7FU" if self.gives_up_high_bytes else self.is_start("byte")

    @property
    def keeps_start(self) -> bool:
        """True if something reads the start's bytes again."""
        return not self.plan.start_bytes or self.plan.covers_start

    @property
    def takes_start_alike(self) -> bool:
        """True if a start is kept by the statements that keep the bytes behind it.

        Its identity tells the limit; one that nobody asked for has no room, so that it passes by.
        """
        is_plain = self.stuffing is None and not self.checks_head and self.handed is None
        is_byte = self.identity_is_start and not self.plan.start_bytes and not self.plan.end_bytes
        return is_plain and is_byte and bool(self.skip_start)

    @property
    def completes_with_start(self) -> bool:
        """True if some frame is a start and nothing else."""
        fits = self.around == self.first_head and not self.plan.end_bytes
        return fits and any(group.fixed == 0 for group in self.groups)

    @property
    def is_complete(self) -> str:
        """The condition that all content is there where an end comes.

        A decoder that was never initialised, in memory of zeros, has a limit of nought, too.
        """
        is_begun = " && at != 0U" if self.only_size is None else ""
        return f"{self.content_counter} == {self.counted_limit}{is_begun}"

    # --- parts ------------------------------------------------------------------------------------

    @property
    def checks_head(self) -> bool:
        """True if something behind the start, in front of the payload, is looked at as it comes."""
        if self.judges_last:
            return False
        indices = [item.index for item in self.head_literals] + [n.last for n in self.head_numbers]
        return any(index >= self.first_head for index in indices)

    @property
    def judges_last(self) -> bool:
        """True if the head is looked at when all of a frame is there, and not as it comes.

        Where all frames have one size nothing else of the head is needed before, and no byte costs
        a look at which one it is. A start that shows ends what is none of them.
        """
        return self.only_size is not None and not self.identity_is_start

    def is_other_length(self, length: str) -> str:
        """The condition that the payload has another size than the length says."""
        assert self.length is not None and self.only_size is not None
        return f"{length} != {self.length.base + self.only_size}U"

    @property
    def compares_size(self) -> bool:
        """True if a length in the head has to say how large the payload turned out to be."""
        return self.only_size is None and any(number.is_length for number in self.head_numbers)

    @property
    def checks_parts(self) -> bool:
        """True if something of the head is looked at behind the start, besides the identity."""
        numbers = (
            n.seven_bit or n.fault or n.bounds or n.contradicts or n.is_length
            for n in self.head_numbers
        )
        return bool(self.literals_behind_start) or any(numbers)

    @property
    def literals_behind_start(self) -> tuple[LiteralView, ...]:
        """Fixed bytes in front of the payload that are not the start's."""
        first = self.plan.start_size - self.plan.skipped
        return tuple(literal for literal in self.head_literals if literal.index >= first)

    def declares(self, number: NumberView) -> bool:
        """True if the case of a number has variables."""
        return number.is_length or (number.identifies and self.only_size is None)

    # --- messages ---------------------------------------------------------------------------------

    @property
    def always_known(self) -> bool:
        """True if every frame that gets to its end is a message."""
        messages = [message for group in self.groups for message in group.messages]
        is_known = self.known_by_identity and not self.judges_last
        return is_known and not any(message.checks for message in messages)

    @property
    def tells_by_key(self) -> bool:
        """True if the identity has to be looked at again."""
        is_known = self.known_by_identity and not self.judges_last
        return self.identified and not (is_known and len(self.groups) == 1)

    @property
    def is_told_at_once(self) -> bool:
        """True if a frame that is complete needs no more than a look at its identity.

        What needs more stands apart: inside of `push` its registers would be saved at each byte.
        """
        messages = [message for group in self.groups for message in group.messages]
        looks = self.checksums or self.fits_payloads or any(message.checks for message in messages)
        return not looks

    def size_is_certain(self, group: GroupView) -> bool:
        """True if a payload of that identity has a size that its message can have."""
        if self.only_size is not None:
            return True
        if self.known_by_identity and group.fixed is not None:
            return True
        message = group.messages[0]
        if len(group.messages) == 1 and message.takes_any_size:
            return True
        if self.fits_payloads and message.fixed:
            return message.takes_any_size
        return len(group.messages) == 1 and message.check_sees_size

    # --- stuffing ---------------------------------------------------------------------------------

    def branches(self, node: Node) -> tuple[Branch, ...]:
        """The branches of a node that a byte can get to."""
        return tuple(
            b for b in node.branches if self.escape_starts or b.byte not in self.never_passed
        )

    @property
    def refused(self) -> tuple[int, ...]:
        """Bytes that never stand for themselves, and are no delimiters."""
        assert self.stuffing is not None
        refused = self.stuffing.nodes[0].refused
        return tuple(b for b in refused if self.escape_starts or b not in self.never_passed)

    @property
    def escape_xor(self) -> int | None:
        """What is changed of each escaped byte, where there is one escape and that is the same."""
        assert self.stuffing is not None
        if self.escape_starts or len(self.stuffing.nodes) != 2:
            return None
        branches = self.branches(self.stuffing.nodes[1])
        changes = {None if b.value is None else b.value ^ b.byte for b in branches}
        return changes.pop() if len(changes) == 1 else None

    @property
    def escaped(self) -> tuple[int, ...]:
        """The bytes that stand behind the escape, changed back."""
        assert self.stuffing is not None
        return tuple(b.value for b in self.branches(self.stuffing.nodes[1]) if b.value is not None)

    @property
    def further_branches(self) -> Iterator[tuple[str, Branch]]:
        """The conditions of the branches behind the first byte of a sequence."""
        assert self.stuffing is not None
        for node in self.stuffing.nodes[1:]:
            for branch in self.branches(node):
                yield f"byte == {byte(branch.byte)}{self._and_at(node)}", branch

    def _and_at(self, node: Node) -> str:
        assert self.stuffing is not None
        is_only = len(self.stuffing.nodes) <= 2
        return "" if is_only else f" && decoder->node == {node.number}U"

    @property
    def is_second_of_start(self) -> str:
        """The condition that a byte behind a delimiter's first is the start's second."""
        assert self.stuffing is not None
        condition = f"byte == {byte(self.plan.start_bytes[1])}"
        if len(self.escape_nodes) == len(self.stuffing.nodes) - 1:
            return condition
        places = " || ".join(f"decoder->node == {node.number}U" for node in self.escape_nodes)
        return f"{condition} && ({places})"

    @property
    def is_second_of_end(self) -> str:
        """The same of the end."""
        return f"byte == {byte(self.plan.end_bytes[1])}{self._and_at(self.escape_nodes[0])}"
