"""Whole frames that stand in the input of `feed`, taken without a candidate."""

from __future__ import annotations

import msgspec

from protogen.model.frame_plan import StartRule
from protogen.targets.c.frame import style
from protogen.targets.c.frame.expressions import equals
from protogen.targets.c.frame.groups import GroupView
from protogen.targets.c.frame.numbers import NumberView
from protogen.targets.c.frame.received import ReceivedFrame
from protogen.targets.c.frame.stuffing import Code, StuffingKind

_MOST_SPECIALS = 5
"""More special bytes take longer to look for than they save."""


class WholeFrames(msgspec.Struct, frozen=True, dict=True):
    """View of a decoder that takes a frame at once."""

    decoder: ReceivedFrame

    @property
    def specials(self) -> tuple[int, ...]:
        """Bytes of a stuffed region that do not stand for themselves, or begin a delimiter."""
        d = self.decoder
        assert d.stuffing is not None
        root = d.stuffing.nodes[0]
        starts = set(d.literal[:1] or d.never_passed)
        taken = {branch.byte for branch in root.branches} | set(root.refused)
        return tuple(sorted(taken | starts | set(d.end[:1])))

    @property
    def by_identity(self) -> bool:
        """True if one byte tells all of a frame but its payload, whose bytes carry seven bits."""
        d = self.decoder
        is_bare = (d.head_size, d.tail_size, d.end_size) == (1, 0, 0) and d.stuffing is None
        spare = any(item.seven_bit or item.padding for item in d.head_numbers)
        return d.all_events and is_bare and d.seven_bit and d.known_by_identity and not spare

    def is_alone(self, group: GroupView) -> bool:
        """True if an identity is that of one message with a payload of one size."""
        return bool(group.fixed) and len(group.messages) == 1

    @property
    def sizing(self) -> NumberView:
        """The number that tells the size of the payload, itself or as an identity."""
        return next(n for n in self.decoder.head_numbers if n.is_length or n.identifies)

    def stands(self, code: Code) -> str:
        """The condition that the rest of a sequence stands at `from`."""
        rest = code.sequence[1:]
        return f"size - from >= {len(rest)}U && {equals(rest, 'data', 'from')}"

    def codes_from(self, byte: int) -> tuple[Code, ...]:
        """The sequences of the stuffing that begin with a byte, the longest first."""
        codes = () if self.decoder.stuffing is None else self.decoder.stuffing.codes
        found = [code for code in codes if code.sequence[0] == byte]
        return tuple(sorted(found, key=lambda code: -len(code.sequence)))


def whole_frames(decoder: ReceivedFrame) -> WholeFrames | None:
    """The view for a decoder whose `feed` can take a frame at once; None where it can't."""
    d = decoder
    starts_show = d.gives_up_high_bytes and d.head_size == 1 and not d.tail_size
    sizes_are_known = d.length is not None or any(g.fixed is not None for g in d.groups)
    fits = (
        _unstuffs(d)
        and not d.keeps_both
        and d.start in (StartRule.LITERAL, StartRule.SET)
        and d.known_from > 0
        and sizes_are_known
        and not d.shares
        and not d.optional_size
        and not d.checks_tail
        # A frame with a start inside is none: without stuffing, each byte would have to be seen.
        and not (d.start_protected and d.stuffing is None and not starts_show)
    )
    return WholeFrames(d) if fits else None


def _unstuffs(decoder: ReceivedFrame) -> bool:
    """True if nothing is stuffed, or sequences stand for few bytes of all behind the start."""
    stuffing = decoder.stuffing
    if stuffing is None:
        return True
    return (
        stuffing.kind is StuffingKind.CODES
        and style.is_stuffed_behind_start(decoder.plan)
        and len(WholeFrames(decoder).specials) <= _MOST_SPECIALS
        and all(len(code.sequence) > 1 for code in stuffing.codes)
    )
