"""Functions that make the frames of a message."""

from __future__ import annotations

from collections.abc import Iterator
from fractions import Fraction
from functools import cached_property

import msgspec

from protogen.c_language.numbers import hexadecimal
from protogen.copying import replace
from protogen.model.frame_room import room
from protogen.model.identities import Runs
from protogen.model.messages import Message, given_parts
from protogen.model.parts import ChoicePart, IdentityPart, NumberPart
from protogen.model.protocol import Sender
from protogen.model.transparency import FULL_GROUP
from protogen.model.types import Field
from protogen.targets.c.decoders.decoder import DecoderView
from protogen.targets.c.frame.arguments import Argument, argument_of, one_of
from protogen.targets.c.frame.frames import FrameView
from protogen.targets.c.frame.virtual import value_of
from protogen.targets.c.payload.in_place_view import InPlace
from protogen.targets.c.payload.message_names import FrameNames
from protogen.targets.c.payload.messages import MessageView
from protogen.targets.c.payload.one_byte import only_byte

_GREATEST_COPY = 256
"""Bytes of a frame that may be put on the stack before it is sent."""


class MessageFrame(msgspec.Struct, frozen=True, dict=True):
    """The functions for one message, from senders of one frame."""

    message: Message
    view: MessageView
    frame: FrameView
    decoder: DecoderView
    """That of a sender of the message."""
    called: FrameNames
    greatest_frame: int
    greatest_payload: int
    """The greatest payload that a frame can carry."""
    least_payload: int
    is_sized: bool
    """True if its identity stands for payloads of one size."""
    is_cut_off: bool
    """True if a decoder counts the bytes of its frames, as some can be too long."""
    beside: int = 0
    """What frames of these senders need beside the most for each byte of content."""

    # --- the payload ------------------------------------------------------------------------------

    @cached_property
    def validate(self) -> str:
        """The function that refuses values; empty where none is out of range."""
        return self.view.validate if self.view.validates else ""

    @cached_property
    def no_frame_has(self) -> str:
        """The condition of a payload that no frame can carry; empty if there is none."""
        found = [f"payload < {self.least_payload}U"] if self.least_payload else []
        if self.message.sizes.greatest > self.greatest_payload:
            found.append(f"payload > {self.greatest_payload}U")
        return " || ".join(found)

    @property
    def is_trimmed(self) -> bool:
        """True if zeros at the end of its payload may be left out."""
        return self.frame.plan.frame.payload.sent(self.message.sizes) != self.message.sizes

    @cached_property
    def byte(self) -> str:
        """The member that is all of the payload, and one byte as it is; empty if there is none."""
        if self.validate or self.values or self.is_trimmed or self.is_refused:
            return ""
        return only_byte(self.message.plan)

    # --- the frame --------------------------------------------------------------------------------

    @property
    def room(self) -> int:
        """Bytes of the buffer that suffice for every frame of the message."""
        payload = min(self.message.sizes.greatest, self.greatest_payload)
        return room(self.decoder.plan, payload, self.beside)

    @property
    def may_fill_group(self) -> bool:
        """True if its content may have as many bytes as a group of COBS has at most."""
        greatest = min(self.message.sizes.greatest, self.greatest_payload)
        return self.decoder.around + greatest >= FULL_GROUP

    @property
    def identity(self) -> tuple[str, ...]:
        """The values of the identity parts."""
        return tuple(
            argument.name
            if self.message.chooses(index)
            else hexadecimal(self.message.identity[index], 2 * -(-part.type.bits // 8))
            for index, part, argument in self._sent_identity
        )

    @property
    def _sent_identity(self) -> Iterator[tuple[int, IdentityPart, Argument]]:
        """The identity parts that are sent, with their places among all and their arguments."""
        plan = self.decoder.plan
        for part, argument in zip(plan.sent_identity, self.frame.identity, strict=True):
            yield plan.identity.index(part), part, self._own(argument)

    @cached_property
    def _members(self) -> dict[str, str]:
        """The parts of the frame that are members of the message."""
        return {number.part: f"message->{number.member}" for number in self.view.held}

    def _own(self, argument: Argument) -> Argument:
        """A part of the frame, out of the message where that has it."""
        member = self._members.get(argument.part)
        if member is None:
            return argument
        part = self._part(argument.part)
        own = argument_of(part, member)
        if self._field(argument.part).is_bool:
            return replace(own, refused=_refused_bit(part, member))
        return replace(own, refused="") if self._is_validated(argument.part) else own

    def _part(self, name: str) -> NumberPart:
        """A part of the frame that the message has as a field."""
        parts = given_parts(self.frame.plan.frame, self.message)
        return next(part for part in parts if part.name == name)

    def _field(self, name: str) -> Field:
        """The field that is a part of the frame."""
        return next(field for field in self.message.held if field.part == name)

    def _is_validated(self, name: str) -> bool:
        """True if the message's own bounds of a part of the frame leave nothing to refuse."""
        part, field = self._part(name), self._field(name)
        if isinstance(part, ChoicePart) or field.least is None or field.greatest is None:
            return False
        ends = [field.least, field.greatest, *(Fraction(entry.value) for entry in field.special)]
        return part.least <= min(ends) and max(ends) <= part.greatest

    @cached_property
    def values(self) -> tuple[Argument, ...]:
        """The parts that vary: those of several identities first."""
        chosen = (
            self._one_of(argument, part, self.message.told_by.runs[index])
            for index, part, argument in self._sent_identity
            if self.message.chooses(index)
        )
        return (*chosen, *map(self._own, self.frame.arguments))

    def _one_of(self, argument: Argument, part: IdentityPart, runs: Runs) -> Argument:
        """An identity that is one of several; those of a single bit are all that there are."""
        if part.name in self._members and self._field(part.name).is_bool:
            return replace(argument, refused="")
        return one_of(argument, part, runs)

    @property
    def arguments(self) -> tuple[Argument, ...]:
        """Those of them that the caller gives, as the message has no member for them."""
        return tuple(item for item in self.values if item.part not in self._members)

    @cached_property
    def passed(self) -> str:
        """Identity, parts that are not sent and those of the caller, as arguments behind others."""
        given = (
            value_of(part, self.message.virtual_value(part) or 0)
            for part in self.decoder.plan.frame.virtual
        )
        others = (self._own(item).name for item in self.frame.arguments)
        names = (*self.identity, *given, *others)
        return "".join(f", {name}" for name in names)

    @property
    def needs_cut_check(self) -> bool:
        """True if a decoder may end a frame where an end stands in the data."""
        plan = self.decoder.plan
        is_known = self.is_sized and plan.size_known_at is not None
        return plan.cut_ambiguous and plan.length is None and not is_known

    @property
    def needs_idle_check(self) -> bool:
        """True if its first bytes may be an end, which a decoder would take for an idle line."""
        plan = self.decoder.plan
        return plan.cut_ambiguous and plan.may_look_idle(self.message)

    @property
    def _cut_elsewhere(self) -> list[str]:
        """Conditions that a decoder would cut the frame elsewhere."""
        prefix = self.frame.decoder.prefix
        found = [f"{prefix}_ends_early(frame, size)"] if self.needs_cut_check else []
        found += [f"{prefix}_looks_idle(frame, size)"] if self.needs_idle_check else []
        return found

    @cached_property
    def is_refused(self) -> str:
        """The condition that no decoder would take the frame; empty if one always does."""
        too_long = [f"size > {self.decoder.plan.greatest}U"] if self.is_cut_off else []
        return " || ".join(too_long + self._cut_elsewhere)

    @cached_property
    def streams(self) -> bool:
        """True if each byte of the frame can go before those behind it are known."""
        return self.frame.plan.streams and not self.is_refused

    @property
    def sends(self) -> bool:
        """True if the frame can be handed over byte by byte, at least from a copy on the stack."""
        return self.streams or self.room <= _GREATEST_COPY

    # --- written in place -------------------------------------------------------------------------

    @cached_property
    def in_place(self) -> InPlace | None:
        """What writes the message in its frame; None where that is no way, or has no room."""
        place = self.view.in_place
        return place if place is not None and place.room <= self.greatest_payload else None

    @property
    def refused_in_place(self) -> tuple[str, ...]:
        """The conditions of arguments that are refused when such a frame is ended."""
        amounts = self.in_place.amounts if self.in_place else ()
        refused = [*(item.refused for item in amounts), *(item.refused for item in self.values)]
        return tuple(filter(None, refused))

    @property
    def too_short_in_place(self) -> str:
        """The condition of too short a payload there; empty if there is none."""
        least = max(self.least_payload, self.message.sizes.least)
        is_short = self.message.plan.sizes.least < least
        return f"payload < {least}U" if is_short else ""

    # --- parameters -------------------------------------------------------------------------------

    @property
    def frame_arguments(self) -> tuple[str, ...]:
        """Parameters of the function that fills a buffer."""
        return (*self._given(), "uint8_t *frame", "size_t capacity")

    def send_arguments(self, put: str) -> tuple[str, ...]:
        """Parameters of the function that sends."""
        return (*self._given(), f"{put} put", "void *user")

    @property
    def copied(self) -> str:
        """What fills a buffer with the frame that a function which sends was called for."""
        given = ("message",) if self.view.parameter else ()
        names = (*given, *(item.name for item in self.arguments), "frame", "sizeof frame")
        return f"{self.called.function}({', '.join(names)})"

    @property
    def begin_arguments(self) -> tuple[str, ...]:
        """Parameters of the function that begins a frame in its buffer."""
        return (*self.begin_given, "uint8_t *frame", "size_t capacity")

    @property
    def begin_given(self) -> tuple[str, ...]:
        """Those for numbers of elements that are given first."""
        first = self.in_place.first if self.in_place else ()
        return tuple(f"{item.type} {item.name}" for item in first)

    @property
    def end_arguments(self) -> tuple[str, ...]:
        """Parameters of the function that ends a frame that was begun in its buffer."""
        return (*self.end_given, "uint8_t *frame")

    @property
    def end_given(self) -> tuple[str, ...]:
        """Those for what the caller gives: numbers of elements, and parts of the frame."""
        amounts = self.in_place.amounts if self.in_place else ()
        return (*(f"{item.type} {item.name}" for item in amounts), *self._parts())

    def _given(self) -> tuple[str, ...]:
        return (*self.view.parameter, *self._parts())

    def _parts(self) -> tuple[str, ...]:
        return tuple(f"{item.type} {item.name}" for item in self.arguments)


class SenderFrames:
    """Frame functions of a sender's messages; what they look up is worked out once for all."""

    def __init__(self, frame: FrameView, decoder: DecoderView, sender: Sender) -> None:
        self._frame = frame
        self._decoder = decoder
        self._plan = sender.plan
        self._framings = {item.message: item for item in sender.framing.messages}
        groups = [group for group in decoder.plan.groups if group.fixed is not None]
        self._sized = {item.name for group in groups for item in group.messages}

    def view(self, message: Message, view: MessageView, called: FrameNames) -> MessageFrame:
        """The frame functions of a message."""
        plan = self._plan
        framing = self._framings[message.name]
        is_bounded = plan.bounds_payload
        return MessageFrame(
            message=message,
            view=view,
            frame=self._frame,
            decoder=self._decoder,
            called=called,
            greatest_frame=framing.greatest,
            greatest_payload=plan.payload.greatest if is_bounded else message.sizes.greatest,
            least_payload=plan.payload.least if plan.length is not None else 0,
            is_cut_off=framing.is_cut_off,
            is_sized=message.name in self._sized,
        )


def _refused_bit(part: NumberPart, name: str) -> str:
    """The condition of a bit that a part of the frame can't be: compilers warn of comparisons."""
    if part.least > 0:
        return f"!{name}"
    return name if part.greatest < 1 else ""
