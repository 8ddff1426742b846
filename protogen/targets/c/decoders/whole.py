"""Whole frames that stand in the input of `feed`, taken without a candidate."""

from __future__ import annotations

import msgspec

from protogen.model.frame_plan import StartRule
from protogen.targets.c.decoders.groups import GroupView
from protogen.targets.c.decoders.received import ReceivedFrame
from protogen.targets.c.decoders.style import DecoderStyle, decoder_style
from protogen.targets.c.frame.expressions import differs, equals
from protogen.targets.c.frame.numbers import NumberView
from protogen.targets.c.frame.stuffing import Code, StuffingKind

_MOST_SPECIALS = 5
"""More special bytes take longer to look for than they save."""


_WITHOUT_STATES = (DecoderStyle.FLAT, DecoderStyle.DELIMITED)


class WholeFrames(ReceivedFrame, frozen=True, dict=True):
    """View of a decoder that takes a frame at once."""

    @property
    def specials(self) -> tuple[int, ...]:
        """Bytes of a stuffed region that do not stand for themselves, or begin a delimiter."""
        assert self.stuffing is not None
        root = self.stuffing.nodes[0]
        starts = set(self.plan.start_bytes[:1] or self.never_passed)
        starts |= {word[0] for word in self.plan.start_words}
        taken = {branch.byte for branch in root.branches} | set(root.refused)
        return tuple(sorted(taken | starts | set(self.plan.end_bytes[:1])))

    @property
    def by_identity(self) -> bool:
        """True if one byte tells all of a frame but its payload, whose bytes carry seven bits."""
        plan = self.plan
        is_bare = (plan.head_size, plan.tail_size, self.end_size, plan.region) == (1, 0, 0, None)
        spare = any(item.seven_bit or item.fault for item in self.head_numbers)
        is_told = plan.seven_bit and self.known_by_identity
        return self.all_events and is_bare and is_told and not spare

    @property
    def is_no_start(self) -> str:
        """The condition that no start stands at the beginning of `data`."""
        words = self.plan.start_words
        if self.plan.start_set:
            return f"!({self.is_start('data[0]')})"
        return " && ".join(
            differs(word, "data") if len(words) == 1 else f"({differs(word, 'data')})"
            for word in words
        )

    def is_alone(self, group: GroupView) -> bool:
        """True if an identity is that of one message with a payload of one size."""
        return bool(group.fixed) and len(group.messages) == 1

    @property
    def sizing(self) -> NumberView:
        """The number that tells the size of the payload, itself or as an identity."""
        return next(n for n in self.head_numbers if n.is_length or n.identifies)

    def stands(self, code: Code) -> str:
        """The condition that the rest of a sequence stands at `from`."""
        rest = code.sequence[1:]
        return f"size - from >= {len(rest)}U && {equals(rest, 'data', 'from')}"

    def codes_from(self, byte: int) -> tuple[Code, ...]:
        """The sequences of the stuffing that begin with a byte, the longest first."""
        codes = () if self.stuffing is None else self.stuffing.codes
        found = [code for code in codes if code.sequence[0] == byte]
        return tuple(sorted(found, key=lambda code: -len(code.sequence)))


def whole_frames(decoder: ReceivedFrame) -> WholeFrames | None:
    """The view for a decoder whose `feed` can take a frame at once; None where it can't."""
    d = WholeFrames(*msgspec.structs.astuple(decoder))
    starts_show = d.gives_up_high_bytes and d.plan.head_size == 1 and not d.plan.tail_size
    sizes_are_known = d.length is not None or any(g.fixed is not None for g in d.groups)
    fits = (
        _unstuffs(d)
        and not d.keeps_both
        and d.plan.start in (StartRule.LITERAL, StartRule.SET)
        and not d.plan.ends_idle
        and d.known_from > 0
        and not d.told_parts
        and sizes_are_known
        and not d.plan.shares_delimiter
        and not d.optional_size
        and not d.checks_tail
        # Such decoders fill payloads up in their buffer.
        and not (d.filled_size and decoder_style(d) in _WITHOUT_STATES)
        # A frame with a start inside is none: without stuffing, each byte would have to be seen.
        and not (d.plan.start_is_unique and d.stuffing is None and not starts_show)
    )
    return d if fits else None


def _unstuffs(decoder: WholeFrames) -> bool:
    """True if nothing is stuffed, or sequences stand for few bytes of all behind the start."""
    stuffing = decoder.stuffing
    if stuffing is None:
        return True
    return (
        stuffing.kind is StuffingKind.CODES
        and decoder.is_stuffed_behind_start
        and len(decoder.specials) <= _MOST_SPECIALS
        and all(len(code.sequence) > 1 for code in stuffing.codes)
    )
