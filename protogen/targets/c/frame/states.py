"""States of a decoder that takes byte after byte: which of them its frames need."""

from __future__ import annotations

import msgspec

from protogen.model.frame_plan import StartRule
from protogen.targets.c.frame.follow import Followed, followed
from protogen.targets.c.frame.received import ReceivedFrame


class PushStates(msgspec.Struct, frozen=True, dict=True):
    """Members of a decoder with states."""

    decoder: ReceivedFrame

    @property
    def searches(self) -> bool:
        """True if a delimiter is looked for inside candidates, from the start or later."""
        d = self.decoder
        return d.end_protected or (d.can_open and d.start is not StartRule.ANYWHERE)

    @property
    def delimiter(self) -> bytes:
        """The literal that is looked for."""
        return self.decoder.end or self.decoder.literal

    @property
    def holds_delimiter(self) -> bool:
        """True if the first bytes of a delimiter are held back until the others came."""
        return len(self.delimiter) > 1

    @property
    def matches(self) -> bytes:
        """The literal that is tracked byte by byte to find starts."""
        d = self.decoder
        return d.end if d.start is StartRule.AFTER_END else d.literal

    @property
    def literals(self) -> tuple[Followed, ...]:
        """The literals of several bytes that are tracked."""
        is_end = self.decoder.start is StartRule.AFTER_END
        tracked = {"end" if is_end else "start": self.matches}
        if self.searches:
            tracked["end" if self.decoder.end else "start"] = self.delimiter
        return tuple(followed(name, item) for name, item in tracked.items() if len(item) > 1)

    @property
    def has_flags(self) -> bool:
        """True if a candidate has more states than its counters say."""
        stuffing = self.decoder.stuffing
        return not self.decoder.simple or (stuffing is not None and stuffing.is_cobs)

    @property
    def counts_wire(self) -> bool:
        """True if it matters how many bytes a candidate has on the wire."""
        d = self.decoder
        if d.all_events or d.keeps_wire or not d.simple or d.shares:
            return True
        return d.start not in (StartRule.LITERAL, StartRule.SET)

    @property
    def keeps_behind(self) -> bool:
        """True if it matters that a candidate's last bytes are not its own."""
        d = self.decoder
        return d.all_events or d.keeps_wire or d.ends_at_start or d.start is StartRule.SET

    @property
    def keeps_match(self) -> bool:
        """True if a start or an end takes several bytes, or was seen before it matters."""
        return len(self.matches) > 1 or self.decoder.start is StartRule.AFTER_END

    @property
    def decides_later(self) -> bool:
        """True if the bytes behind a failed candidate may tell that its last ones are a start."""
        d = self.decoder
        return d.all_events and not d.keeps_wire and d.start_size > 1

    @property
    def awaits_end(self) -> bool:
        """True if the end is due in one place, and not looked for."""
        return bool(self.decoder.end) and not self.decoder.end_protected

    @property
    def start_decides(self) -> bool:
        """True if a candidate may be over with its start."""
        d = self.decoder
        return d.start is StartRule.SET or d.plan.least <= d.start_size

    @property
    def wire_ends(self) -> bool:
        """True if a checksum covers stuffed bytes, so that their places are kept."""
        over_wire = [item for item in self.decoder.plan.checksums if item.part.over_wire]
        covers = [cover for item in over_wire for cover in item.covers]
        return self.decoder.keeps_both and any(not isinstance(cover, bytes) for cover in covers)

    @property
    def sees_content(self) -> bool:
        """True if something is done with a byte of content besides counting it."""
        d = self.decoder
        return bool(not d.wire_is_content or d.head_size or d.seven_bit or d.checks_tail)
