"""Numbers of the frame that are fields of a message, as arguments of its payload's functions."""

from __future__ import annotations

from collections.abc import Iterable

import msgspec

from protogen.c_language.numbers import integer_type
from protogen.model.messages import Message
from protogen.model.payload_plan import PartStep
from protogen.targets.c.payload.walk import parameter_for
from protogen.targets.c.spelling import Names


class HeldNumber(msgspec.Struct, frozen=True):
    """A number of the frame, as a parameter."""

    field: str
    """Name of the field in the schema."""
    part: str
    """Name of the part in the schema."""
    shown: str
    """The member for the part among an event's parts."""
    member: str
    """The message's member for it."""
    name: str
    """The parameter."""
    type: str


def held_numbers(message: Message, names: Names) -> tuple[HeldNumber, ...]:
    """The numbers of the frame that a message has."""
    return tuple(
        HeldNumber(
            field=step.name,
            part=step.part,
            shown=names.member(step.part),
            member=names.member(step.name),
            name=parameter_for(names.member(step.name)),
            type=integer_type(step.type),
        )
        for step in message.plan.steps
        if isinstance(step, PartStep)
    )


def from_parts(held: Iterable[HeldNumber], parts: str) -> str:
    """The numbers as arguments behind others; `parts` leads to the members of an event's parts."""
    return "".join(f", {parts}{number.shown}" for number in held)
