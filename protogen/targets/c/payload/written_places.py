"""Places of a message's fields while it is written in its frame, field by field.

Each array has room for the most elements that it can have. How many it has is given when the frame
is ended; then what stands behind it moves up to it.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence

import msgspec

from protogen.model.initial_payload import initial_bytes
from protogen.model.messages import Message
from protogen.model.payload_plan import (
    AnyStep,
    BytesStep,
    ConstantStep,
    Count,
    FloatStep,
    IntegerStep,
    PartStep,
    RecordStep,
    RepeatStep,
)
from protogen.targets.c.payload.accessors import has_fixed_elements, is_readable
from protogen.targets.c.payload.texts import PaddedText
from protogen.targets.kept import Kept

_LARGE = 32
"""Bytes of a payload from which on they are there; a struct of fewer takes little."""


class Amount(msgspec.Struct, frozen=True):
    """Number of elements or bytes that is given when a frame is ended."""

    name: str
    """The field that says it, or the member of a record for it where an array fills the payload."""
    step: IntegerStep | None
    """The field."""
    at: int
    """Where that stands."""
    least: int
    greatest: int


class Place(msgspec.Struct, frozen=True):
    """A step, and where it stands."""

    step: AnyStep
    at: int
    most: int
    """Elements of an array, or bytes, that there is room for."""
    amount: str
    """The name of the number that says how many there are; empty where that is always the same."""
    width: int
    """Bytes of an element."""
    size: int
    """Bytes of the room."""
    moves: bool
    """True if it stands elsewhere in a payload of fewer elements."""


class Places(msgspec.Struct, frozen=True):
    """The places of a message."""

    places: tuple[Place, ...]
    amounts: tuple[Amount, ...]
    size: int
    """Bytes of the room for all of them."""


def is_written_in_place(item: Message) -> bool:
    """True if a message can be written in its frame."""
    return written_places(item) is not None


def _is_settable(step: AnyStep) -> bool:
    """True if a step has one size, and a value of it can be stored."""
    if initial_bytes(step) is None:
        return False
    match step:
        case IntegerStep() | FloatStep():
            return not isinstance(step, PartStep)
        case RepeatStep():
            return has_fixed_elements(step) and step.holds_values
        case RecordStep():
            return step.holds_values and not step.type.needs
    return isinstance(step, ConstantStep | BytesStep)


def _varies(step: AnyStep) -> bool:
    """True for elements of one size, or bytes, whose number is given when the frame is ended."""
    if not isinstance(step, RepeatStep | BytesStep) or not _is_given(step.count):
        return False
    if isinstance(step, BytesStep):
        return PaddedText.of(step.type) is None
    is_plain = step.field.default is None and initial_bytes(step.element) is not None
    return is_plain and has_fixed_elements(step) and step.holds_values


def _is_given(count: Count) -> bool:
    """True if a field of the message is the number, or what is left of the payload says it."""
    if count.known is not None or count.until is not None or count.mark is not None:
        return False
    if count.tail is not None or count.between is not None:
        return False
    if count.fills:
        return True
    by = None if count.by is None else count.by.plain
    return by is not None and by.level == 0 and "." not in by.name


def _amount_of(step: AnyStep) -> str:
    """The name of the number of elements or bytes of what varies."""
    count = step.count
    assert count is not None
    by = None if count.by is None else count.by.plain
    return count.member if by is None else by.name


def _width(step: AnyStep) -> int:
    """Bytes of an element."""
    return step.element.sizes.greatest if isinstance(step, RepeatStep) else 1


def _laid_out(item: Message, varied: Sequence[AnyStep]) -> Places | None:
    """The places, where no frame is too short for them."""
    steps, limit = item.plan.steps, item.sizes.greatest
    names = list(dict.fromkeys(map(_amount_of, varied)))
    fixed = sum(step.sizes.greatest for step in steps if step not in varied)
    room = (limit - fixed) // max(1, sum(map(_width, varied)))
    bounds = {name: _bounds(name, varied, steps) for name in names}
    if len(names) == 1:  # With one number, it is known how many of them a frame has room for.
        [(name, (least, greatest))] = bounds.items()
        bounds[name] = (least, min(greatest, room))
    places: list[Place] = []
    at, moves = 0, False
    for step in steps:
        amount = _amount_of(step) if step in varied else ""
        most = bounds[amount][1] if amount else step.count.greatest if step.count else 1
        size = most * _width(step) if amount else step.sizes.greatest
        places.append(Place(step, at, most, amount, _width(step), size, moves))
        at, moves = at + size, moves or bool(amount)
    if at > limit or any(least > most or most < 1 for least, most in bounds.values()):
        return None
    found = {place.step.name: place for place in places}
    amounts = tuple(
        Amount(name, _counting(found, name), found[name].at if name in found else 0, *bounds[name])
        for name in names
    )
    if any(it.step is not None and not _can_be_given(it.step) for it in amounts):
        return None
    return Places(tuple(places), amounts, at)


def _bounds(name: str, varied: Iterable[AnyStep], steps: Iterable[AnyStep]) -> tuple[int, int]:
    """The least and the greatest number that all arrays, and the field that says it, can have."""
    counts = [step.count for step in varied if step.count and _amount_of(step) == name]
    bounds = [(count.least, count.greatest) for count in counts]
    bounds += [it.bounds for it in steps if isinstance(it, IntegerStep) and it.name == name]
    return max(least for least, _ in bounds), min(greatest for _, greatest in bounds)


def _counting(places: dict[str, Place], name: str) -> IntegerStep | None:
    step = places[name].step if name in places else None
    return step if isinstance(step, IntegerStep) else None


def _can_be_given(step: IntegerStep) -> bool:
    """True if the field can be any number within its bounds, and no other."""
    is_special = bool(step.field.special) or step.type.enum is not None
    return step.type.role != "bool" and not is_special


def _places_of(item: Message) -> Places | None:
    """Places, unless a message can't be written in its frame.

    One that can be is large, and has an array of elements of one size, or bytes whose number
    varies. All else has one size, and is no union, no run of bits and no part of the frame.
    """
    plan, steps = item.plan, item.plan.steps
    if item.held or plan.packing is not None or item.sizes.greatest < _LARGE:
        return None
    varied = [step for step in steps if _varies(step)]
    if varied:
        is_fit = item.sizes.fixed is None
    else:
        is_fit = plan.sizes.fixed is not None and item.sizes.fixed == plan.sizes.fixed
        is_fit = is_fit and any(map(is_readable, steps))
    if not is_fit or not all(step in varied or _is_settable(step) for step in steps):
        return None
    return _laid_out(item, varied)


written_places = Kept(_places_of, most=1024)
"""The places of a message that can be written in its frame; None of others."""
