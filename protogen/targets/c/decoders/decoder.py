"""A sender's decoder: its frames, and the style in which it is printed."""

from __future__ import annotations

from collections.abc import Mapping
from functools import cached_property

from msgspec.structs import astuple, replace

from protogen.model.behind_start import behind_start
from protogen.model.protocol import Sender
from protogen.targets.c.decoders.delimited import DelimitedDecoder
from protogen.targets.c.decoders.flat import FlatDecoder
from protogen.targets.c.decoders.groups import groups_of
from protogen.targets.c.decoders.kept import KeptDecoder
from protogen.targets.c.decoders.push import PushDecoder
from protogen.targets.c.decoders.received import ReceivedFrame
from protogen.targets.c.decoders.style import DecoderStyle, decoder_style
from protogen.targets.c.decoders.whole import WholeFrames, whole_frames
from protogen.targets.c.frame.checksums import ChecksumView
from protogen.targets.c.frame.part_numbers import PartNumbers
from protogen.targets.c.options import Events
from protogen.targets.c.payload.messages import MessageView
from protogen.targets.c.spelling import Names


class DecoderView(ReceivedFrame, frozen=True, dict=True):
    """Everything that the templates print of a decoder."""

    @cached_property
    def flat(self) -> FlatDecoder | None:
        """View of a flat decoder, if this is one."""
        is_flat = decoder_style(self) is DecoderStyle.FLAT
        return FlatDecoder(*astuple(self)) if is_flat else None

    @cached_property
    def delimited(self) -> DelimitedDecoder | None:
        """View of a decoder that judges frames at their end, if this is one."""
        is_delimited = decoder_style(self) is DecoderStyle.DELIMITED
        return DelimitedDecoder(*astuple(self)) if is_delimited else None

    @cached_property
    def kept(self) -> KeptDecoder | None:
        """View of a decoder that looks through what it keeps, if this is one."""
        is_kept = decoder_style(self) is DecoderStyle.KEPT
        return KeptDecoder(*astuple(self)) if is_kept else None

    @property
    def without_start(self) -> DecoderView:
        """The same of a decoder that keeps no start, where nothing reads that again."""
        lean = self.flat or self.delimited
        if lean is None or lean.keeps_start:
            return self
        return replace(self, plan=behind_start(self.plan))

    @property
    def polled(self) -> FlatDecoder | DelimitedDecoder | KeptDecoder | PushDecoder | None:
        """View of a decoder whose `push` returns which message is complete, if this is one."""
        return (self.lean or self.push) if self.is_polled else None

    @property
    def compared(self) -> tuple[ChecksumView, ...]:
        """The checksums that frames can have."""
        return self.checksums if self.kept is None else self.kept.checksums

    @property
    def lean(self) -> FlatDecoder | DelimitedDecoder | KeptDecoder | None:
        """View of a decoder without states, if this is one."""
        return self.flat or self.delimited or self.kept

    @property
    def fills_in_place(self) -> bool:
        """True if nothing that is needed stands where a payload is filled up."""
        return self.flat is not None or self.delimited is not None

    @property
    def gives_more(self) -> bool:
        """True if messages may be left when `push` has returned one."""
        if self.kept is not None:
            return self.kept.gives_more
        return self.polled is self.push and self.push.gives_more

    @property
    def size_type(self) -> str:
        """The type of what counts bytes of a frame that is received."""
        lean = self.delimited or self.kept
        return self.counter if lean is None else lean.counter

    @property
    def room(self) -> int:
        """Bytes of the buffer."""
        return (self.lean or self).buffer_size

    @property
    def other_payload(self) -> str:
        """The condition that no message has a payload of that size; empty where any may fit."""
        if self.only_size is not None:
            return f"payload != {self.only_size}U"
        delimited = self.delimited
        if delimited is None or delimited.greatest_payload >= self.plan.payload.greatest:
            return ""
        return f"payload > {delimited.greatest_payload}U"

    @cached_property
    def push(self) -> PushDecoder:
        """View of a decoder with states."""
        return PushDecoder(*astuple(self))

    @cached_property
    def whole(self) -> WholeFrames | None:
        """View of how `feed` takes a frame at once, if it can."""
        return None if self.kept else whole_frames(self)

    @property
    def takes_whole(self) -> bool:
        """True if `feed` takes frames that stand in the input as a whole."""
        return self.whole is not None or self.kept is not None

    @property
    def takes_content(self) -> bool:
        """True if a frame may be delivered from where it stands in the input."""
        return self.whole is not None and self.stuffing is None

    @property
    def is_idle(self) -> str:
        """The condition that nothing of a frame is there."""
        lean = self.flat or self.delimited
        if lean is not None:
            found = [lean.is_idle]
            found += ["decoder->node == 0U"] if lean.has_node else []
        else:
            found = [f"decoder->state == {self.protocol_upper}_SEEKING"]
            found += ["decoder->match == 0U"] if self.push.keeps_match else []
            found += ["decoder->count == 0U"] if self.keeps_wire else []
        return " && ".join(found)

    @property
    def only_size(self) -> int | None:
        """Size of the payload, where a polled decoder knows messages of one fixed size alone."""
        return None if self.polled is None else self.polled.only_size


def decoder_view(
    names: Names,
    sender: Sender,
    views: Mapping[str, MessageView],
    events: Events,
    numbers: PartNumbers,
) -> DecoderView:
    """The view of a sender's decoder; `views` has the messages that were chosen."""
    groups = groups_of(sender.plan, views)
    return DecoderView(names, sender.name, sender.plan, groups, events, numbers)
