"""States of a decoder that takes byte after byte: which of them its frames need."""

from __future__ import annotations

from protogen.model.frame_places import Run
from protogen.model.frame_plan import StartRule
from protogen.targets.c.decoders.received import ReceivedFrame
from protogen.targets.c.frame.expressions import byte, byte_at


def _beginnings(words: tuple[bytes, ...]) -> list[bytes]:
    """Beginnings of some words of one size, the shorter ones first: the states of a search."""
    found = {word[:size] for word in words for size in range(len(word) + 1)}
    return sorted(found, key=lambda item: (len(item), item))


def _followed(words: tuple[bytes, ...]) -> list[dict[str, int]]:
    """States of words that are tracked byte by byte.

    For each beginning that was seen: the bytes that go on with some word, and the number of the
    longest beginning that the input ends with then. Of one word that is its size.
    """
    beginnings = _beginnings(words)
    numbers = {item: number for number, item in enumerate(beginnings)}
    states: list[dict[str, int]] = []
    for begun in beginnings:
        states.append({})
        for value in dict.fromkeys(b"".join(words)):
            seen = begun + bytes((value,))
            endings = (seen[place:] for place in range(len(seen)))
            longest = next((item for item in endings if item in numbers), b"")
            if longest:
                states[-1][byte(value)] = numbers[longest]
    return states


class PushStates(ReceivedFrame, frozen=True, dict=True):
    """Members of a decoder with states."""

    @property
    def searches(self) -> bool:
        """True if a delimiter is looked for inside candidates, from the start or later."""
        if self.plan.ends_idle:
            return False
        return self.plan.end_is_unique or (
            self.seeks_end and self.plan.start is not StartRule.ANYWHERE
        )

    @property
    def closes(self) -> bool:
        """True if some frame is ended by what follows its last byte, or by a silence."""
        return self.searches or self.plan.ends_idle

    @property
    def marks(self) -> tuple[bytes, ...]:
        """The start literal, or several; empty where a byte of a set marks the start."""
        return self.plan.start_words if self.plan.mark_size else ()

    @property
    def delimiter(self) -> bytes:
        """The literal that is looked for, or one of several."""
        return self.plan.end_bytes or (self.marks[0] if self.marks else b"")

    @property
    def holds_delimiter(self) -> bool:
        """True if the first bytes of a delimiter are held back until the others came."""
        return len(self.delimiter) > 1

    @property
    def begins_anywhere(self) -> bool:
        """True if the first byte of an input may begin a frame, whatever it is."""
        return self.plan.start in (StartRule.ANYWHERE, StartRule.AFTER_END)

    @property
    def matches(self) -> tuple[bytes, ...]:
        """The literals that are tracked byte by byte to find starts."""
        return (self.plan.end_bytes,) if self.plan.start is StartRule.AFTER_END else self.marks

    @property
    def literals(self) -> dict[str, list[dict[str, int]]]:
        """States of the literals of several bytes that are tracked, by their names."""
        is_end = self.plan.start is StartRule.AFTER_END
        tracked = {"end" if is_end else "start": self.matches}
        if self.searches:
            own = (self.plan.end_bytes,) if self.plan.end_bytes else self.marks
            tracked["end" if self.plan.end_bytes else "start"] = own
        return {
            name: _followed(words) for name, words in tracked.items() if words and len(words[0]) > 1
        }

    # --- several start literals -------------------------------------------------------------------

    @property
    def beginnings(self) -> list[bytes]:
        """What the numbers of a search for several start literals stand for; empty for one."""
        return _beginnings(self.marks) if len(self.marks) > 1 else []

    @property
    def counts_beginnings(self) -> bool:
        """True if it matters how many bytes of one of several starts the input ends with."""
        return bool(self.beginnings)

    @property
    def begun_from(self) -> list[tuple[int, int]]:
        """The first number of those that stand for so many bytes, the longest first."""
        sizes = [len(item) for item in self.beginnings]
        return [(sizes.index(size), size) for size in range(self.start_size, 0, -1)]

    @property
    def reads_beginnings(self) -> bool:
        """True if bytes are taken again of which only the number of the search is known."""
        again = not self.keeps_wire or (self.searches and not self.plan.end_bytes)
        return len(self.marks) > 1 and again

    def begun(self, state: str) -> str:
        """Bytes of a start literal that the input ends with, where it is tracked."""
        return f"{self.prefix}_begun({state})" if len(self.marks) > 1 else state

    def held_size(self, state: str) -> str:
        """Bytes of a delimiter that are held back."""
        return state if self.plan.end_bytes else self.begun(state)

    def is_whole(self, state: str) -> str:
        """The condition that the input ends with a start literal."""
        if len(self.marks) > 1:
            return f"{state} >= {self.begun_from[0][0]}U"
        return f"{state} == {self.start_size}U"

    def start_byte(self, state: str, index: str) -> str:
        """A byte of a start literal, which the state of the search stands for."""
        if len(self.marks) > 1:
            return f"{self.prefix}_begun_byte({state}, {index})"
        return byte_at(self.plan.start_bytes, index)

    def held_byte(self, state: str, index: str) -> str:
        """A byte of a delimiter that is held back."""
        if self.plan.end_bytes:
            return byte_at(self.plan.end_bytes, index)
        return self.start_byte(state, index)

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
        if self.plan.is_cut_off or self.told_length is not None:
            return True
        return self.plan.start not in (StartRule.LITERAL, StartRule.SET)

    @property
    def keeps_behind(self) -> bool:
        """True if it matters that a candidate's last bytes are not its own."""
        return self.all_events or self.keeps_wire or self.ends_at_start or bool(self.plan.start_set)

    @property
    def keeps_match(self) -> bool:
        """True if a start or an end takes several bytes, or was seen before it matters."""
        is_long = any(len(item) > 1 for item in self.matches)
        return is_long or self.plan.start is StartRule.AFTER_END

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
    def counts_passed(self) -> bool:
        """True if it matters how many bytes on the wire are part of a candidate's content."""
        return self.wire_ends or self.length_over_wire

    @property
    def wire_ends(self) -> bool:
        """True if a checksum covers stuffed bytes, so that their places are kept."""
        over_wire = [item for item in self.plan.checksums if item.part.over_wire]
        covers = [cover for item in over_wire for cover in item.covers]
        return self.keeps_both and any(isinstance(cover, Run) for cover in covers)
