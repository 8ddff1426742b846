"""Values of fields that are parts of the frame: what they may be, and the part of each frame."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from math import lcm
from typing import Any

from hypothesis import assume
from hypothesis import strategies as st

from protogen.model.frame import Frame
from protogen.model.messages import Message
from protogen.model.parts import ChoicePart
from protogen.model.types import Field, Integer

Runs = Sequence[tuple[int, int]]
"""The first and the last of numbers that follow each other."""


def held_parts(message: Message, values: Mapping[str, Any]) -> dict[str, int | str]:
    """The parts of a frame that the message has as fields."""
    return {field.part: int(values[field.name]) for field in message.held}


def held_of(message: Message, values: Mapping[str, Any]) -> dict[str, int]:
    """The fields that are parts of a frame."""
    return {field.name: int(values[field.name]) for field in message.held}


def held_runs(message: Message, frames: Sequence[Frame]) -> dict[str, list[Runs]]:
    """What each part that is a field may be in each of these frames."""
    return {
        field.part: [_runs_of(frame, message, field.part) for frame in frames]
        for field in message.held
    }


def _runs_of(frame: Frame, message: Message, name: str) -> Runs:
    for index, identity in enumerate(frame.identity):
        if identity.name == name:
            return message.told_by.runs[index]
    part = next(part for part in frame.caller_parts if part.name == name)
    if isinstance(part, ChoicePart):
        return [(value, value) for value in part.values]
    return [(part.least, part.greatest)]


@st.composite
def held_value(
    draw: st.DrawFn,
    field: Field,
    known: Sequence[int] | None,
    multiples: Sequence[int],
    bounds: tuple[int, int],
    frames: Sequence[Runs],
) -> int | bool:
    """A number that the field may be, and the part in each of the frames.

    `known` are all that it may be, where not all within the bounds are known.
    """
    type_ = field.type
    assert isinstance(type_, Integer)
    runs = frames[0]
    for other in (*frames[1:], [bounds]):
        runs = [
            (max(first, low), min(last, high))
            for first, last in runs
            for low, high in other
            if max(first, low) <= min(last, high)
        ]
    ends = [end for run in runs for end in run]
    named = [] if type_.enum is None else [entry.value for entry in type_.enum.values]
    likely = [value for value in (*ends, *named, *(known or ())) if _is_in(value, runs)]
    special = [entry.value for entry in field.special if known is None]
    likely += [value for value in special if all(_is_in(value, run) for run in frames)]
    if known is not None:
        likely = [value for value in likely if value in known]
    assert likely, f"nothing can be {field.name}"
    usual = st.sampled_from(likely)
    if known is None:
        usual = usual | st.sampled_from(list(runs)).flatmap(lambda run: st.integers(*run))
    value = draw(usual)
    value -= value % lcm(*multiples)
    assume(all(_is_in(value, run) for run in frames))
    return bool(value) if type_.role == "bool" else value


def _is_in(value: int, runs: Runs) -> bool:
    return any(first <= value <= last for first, last in runs)
