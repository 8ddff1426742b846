"""Functions that make the frames of a message."""

from __future__ import annotations

import msgspec

from protogen.model.messages import Message
from protogen.model.protocol import Sender
from protogen.targets.c.decoders.decoder import DecoderView
from protogen.targets.c.frame.frames import FrameView
from protogen.targets.c.payload.messages import MessageView
from protogen.targets.c.spelling import hexadecimal


class MessageFrame(msgspec.Struct, frozen=True):
    """The functions for one message, from senders of one frame."""

    message: Message
    view: MessageView
    frame: FrameView
    decoder: DecoderView
    """That of a sender of the message."""
    suffix: str
    """Suffix that tells these functions from those for other senders."""
    greatest_frame: int
    greatest_payload: int
    """The greatest payload that a frame can carry."""
    least_payload: int

    # --- names ------------------------------------------------------------------------------------

    @property
    def function(self) -> str:
        """The function that fills a buffer."""
        return f"{self.view.prefix}_frame{self.suffix}"

    @property
    def send(self) -> str:
        """The function that hands over byte after byte."""
        return f"{self.view.prefix}_send{self.suffix}"

    @property
    def upper(self) -> str:
        """Prefix of its macros."""
        return f"{self.view.upper}{self.suffix.upper()}"

    # --- the payload ------------------------------------------------------------------------------

    @property
    def validate(self) -> str:
        """The function that refuses values; empty where none is out of range."""
        return self.view.validate if self.view.validates else ""

    @property
    def no_frame_has(self) -> str:
        """The condition of a payload that no frame can carry; empty if there is none."""
        found = [f"payload < {self.least_payload}U"] if self.least_payload else []
        if self.message.sizes.greatest > self.greatest_payload:
            found.append(f"payload > {self.greatest_payload}U")
        return " || ".join(found)

    # --- the frame --------------------------------------------------------------------------------

    @property
    def room(self) -> int:
        """Bytes of the buffer that suffice for every frame of the message."""
        return self.decoder.plan.room(min(self.message.sizes.greatest, self.greatest_payload))

    @property
    def identity(self) -> tuple[str, ...]:
        """The values of the identity parts."""
        return tuple(
            hexadecimal(value, 2 * -(-part.type.bits // 8))
            for part, value in zip(self.decoder.plan.identity, self.message.identity, strict=True)
        )

    @property
    def passed(self) -> str:
        """The identity and the caller's parts, as arguments behind others."""
        names = (*self.identity, *(item.name for item in self.frame.arguments))
        return "".join(f", {name}" for name in names)

    @property
    def needs_cut_check(self) -> bool:
        """True if a decoder may end a frame where an end stands in the data."""
        plan = self.decoder.plan
        group = next((g for g in plan.groups if self.message in g.messages), None)
        is_fixed = group is not None and group.fixed is not None
        is_known = is_fixed and plan.size_known_at is not None
        return plan.cut_ambiguous and plan.length is None and not is_known

    @property
    def needs_idle_check(self) -> bool:
        """True if its first bytes may be an end, which a decoder would take for an idle line."""
        plan = self.decoder.plan
        return plan.cut_ambiguous and plan.may_look_idle(self.message)

    @property
    def refusals(self) -> str:
        """The condition that a decoder would cut the frame elsewhere; empty if it never does."""
        prefix = self.frame.decoder.prefix
        found = [f"{prefix}_ends_early(frame, wire)"] if self.needs_cut_check else []
        found += [f"{prefix}_looks_idle(frame, wire)"] if self.needs_idle_check else []
        return " || ".join(found)

    @property
    def sends(self) -> bool:
        """True if the frame can be handed over byte by byte."""
        return self.frame.plan.streams and not self.refusals

    # --- parameters -------------------------------------------------------------------------------

    @property
    def frame_arguments(self) -> tuple[str, ...]:
        """Parameters of the function that fills a buffer."""
        return (*self._given(), "uint8_t *frame", "size_t capacity", "size_t *size")

    def send_arguments(self, put: str) -> tuple[str, ...]:
        """Parameters of the function that sends."""
        return (*self._given(), f"{put} put", "void *user")

    def _given(self) -> tuple[str, ...]:
        parts = (f"{item.type} {item.name}" for item in self.frame.arguments)
        return (f"const {self.view.struct} *message", *parts)


def message_frame(
    frame: FrameView,
    decoder: DecoderView,
    sender: Sender,
    message: Message,
    view: MessageView,
    suffix: str,
) -> MessageFrame:
    """The frame functions of a message; `decoder` is that of a sender of the message."""
    plan = sender.plan
    has_length = plan.length is not None
    sizes = sender.framing.messages
    return MessageFrame(
        message=message,
        view=view,
        frame=frame,
        decoder=decoder,
        suffix=suffix,
        greatest_frame=next(item.greatest for item in sizes if item.message == message.name),
        greatest_payload=plan.payload.greatest if has_length else message.sizes.greatest,
        least_payload=plan.payload.least if has_length else 0,
    )
