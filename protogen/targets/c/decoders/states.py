"""States of a decoder that takes byte after byte: which of them its frames need."""

from __future__ import annotations

from protogen.model.frame_plan import StartRule
from protogen.targets.c.decoders.received import ReceivedFrame
from protogen.targets.c.frame.expressions import byte


def _followed(literal: bytes) -> list[dict[str, int]]:
    """States of a literal that is tracked byte by byte.

    For each size that was seen before: the bytes that go on with some of the literal, and how much
    of it the input ends with then.
    """
    states: list[dict[str, int]] = []
    for matched in range(len(literal) + 1):
        states.append({})
        for value in dict.fromkeys(literal):
            seen = literal[:matched] + bytes((value,))
            sizes = range(min(len(seen), len(literal)), 0, -1)
            longest = next((size for size in sizes if seen.endswith(literal[:size])), 0)
            if longest:
                states[-1][byte(value)] = longest
    return states


class PushStates(ReceivedFrame, frozen=True, dict=True):
    """Members of a decoder with states."""

    @property
    def searches(self) -> bool:
        """True if a delimiter is looked for inside candidates, from the start or later."""
        return self.plan.end_is_unique or (
            self.can_open and self.plan.start is not StartRule.ANYWHERE
        )

    @property
    def delimiter(self) -> bytes:
        """The literal that is looked for."""
        return self.plan.end_bytes or self.plan.start_bytes

    @property
    def holds_delimiter(self) -> bool:
        """True if the first bytes of a delimiter are held back until the others came."""
        return len(self.delimiter) > 1

    @property
    def begins_anywhere(self) -> bool:
        """True if the first byte of an input may begin a frame, whatever it is."""
        return self.plan.start in (StartRule.ANYWHERE, StartRule.AFTER_END)

    @property
    def matches(self) -> bytes:
        """The literal that is tracked byte by byte to find starts."""
        return (
            self.plan.end_bytes if self.plan.start is StartRule.AFTER_END else self.plan.start_bytes
        )

    @property
    def literals(self) -> dict[str, list[dict[str, int]]]:
        """States of the literals of several bytes that are tracked, by their names."""
        is_end = self.plan.start is StartRule.AFTER_END
        tracked = {"end" if is_end else "start": self.matches}
        if self.searches:
            tracked["end" if self.plan.end_bytes else "start"] = self.delimiter
        return {name: _followed(item) for name, item in tracked.items() if len(item) > 1}

    @property
    def has_flags(self) -> bool:
        """True if a candidate has more states than its counters say."""
        stuffing = self.stuffing
        return not self.simple or (stuffing is not None and stuffing.is_cobs)

    @property
    def counts_wire(self) -> bool:
        """True if it matters how many bytes a candidate has on the wire."""
        if self.all_events or self.keeps_wire or not self.simple or self.plan.shares_delimiter:
            return True
        if self.plan.is_cut_off:
            return True
        return self.plan.start not in (StartRule.LITERAL, StartRule.SET)

    @property
    def keeps_behind(self) -> bool:
        """True if it matters that a candidate's last bytes are not its own."""
        return (
            self.all_events
            or self.keeps_wire
            or self.ends_at_start
            or self.plan.start is StartRule.SET
        )

    @property
    def keeps_match(self) -> bool:
        """True if a start or an end takes several bytes, or was seen before it matters."""
        return len(self.matches) > 1 or self.plan.start is StartRule.AFTER_END

    @property
    def decides_later(self) -> bool:
        """True if the bytes behind a failed candidate may tell that its last ones are a start."""
        return self.all_events and not self.keeps_wire and self.start_size > 1

    @property
    def awaits_end(self) -> bool:
        """True if the end is due in one place, and not looked for."""
        return bool(self.plan.end_bytes) and not self.plan.end_is_unique

    @property
    def start_decides(self) -> bool:
        """True if a candidate may be over with its start."""
        return self.plan.start is StartRule.SET or self.plan.least <= self.start_size

    @property
    def wire_ends(self) -> bool:
        """True if a checksum covers stuffed bytes, so that their places are kept."""
        over_wire = [item for item in self.plan.checksums if item.part.over_wire]
        covers = [cover for item in over_wire for cover in item.covers]
        return self.keeps_both and any(not isinstance(cover, bytes) for cover in covers)
