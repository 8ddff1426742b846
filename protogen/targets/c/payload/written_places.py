"""Places of a message's fields while it is written in its frame, field by field.

There are two ways. Where numbers of elements are fields of the message, and a frame has room for
the most of all arrays, numbers are given when the frame is ended; then what stands behind an array
moves up to it. Where numbers are worked out or stand in a struct, or the most of all arrays is too
much for a frame, numbers are given first, when the frame is begun, and nothing moves.
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
    Reference,
    RepeatStep,
)
from protogen.targets.c.payload.accessors import has_fixed_elements, is_readable
from protogen.targets.c.payload.texts import PaddedText
from protogen.targets.kept import Kept

_LARGE = 32
"""Bytes of a payload from which on they are there; a struct of fewer takes little."""


class Amount(msgspec.Struct, frozen=True):
    """Number that says how many elements or bytes there are, as a caller gives it."""

    name: str
    """The field that says it (of a member of a struct, `head.count`), or the member of a record for
    it where an array fills the payload."""
    step: IntegerStep | None
    """The field."""
    at: int
    """Where that stands in the place that has it."""
    least: int
    greatest: int
    place: str = ""
    """The step that has it, of a number that is given first; empty of those given at the end."""


class Place(msgspec.Struct, frozen=True):
    """A step, and where it stands."""

    step: AnyStep
    at: int
    most: int
    """Elements of an array, or bytes, that there is room for."""
    amount: str
    """The name of the number that says how many there are, of one that is given at the end."""
    width: int
    """Bytes of an element."""
    size: int
    """Bytes of the room."""
    moves: bool
    """True if it stands elsewhere in a payload of fewer elements."""
    varies: bool = False
    """True if the number of elements or bytes does."""
    ahead: tuple[Place, ...] = ()
    """Places of other numbers of elements in front of it, of which `at` has no bytes."""

    @property
    def least(self) -> int:
        """The fewest elements of an array, or bytes."""
        return self.step.count.least if self.step.count else 1


class Places(msgspec.Struct, frozen=True):
    """The places of a message."""

    places: tuple[Place, ...]
    amounts: tuple[Amount, ...]
    size: int
    """Bytes of the room for all of them."""
    fixed: int = 0
    """Bytes of what does not vary, where numbers are given first."""

    @property
    def first(self) -> tuple[Amount, ...]:
        """The numbers that are given when a frame is begun."""
        return tuple(it for it in self.amounts if it.place)

    @property
    def last(self) -> tuple[Amount, ...]:
        """The numbers that are given when it is ended."""
        return tuple(it for it in self.amounts if not it.place)


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
    """True if fields of the message say the number, or what is left of the payload does."""
    if count.known is not None or count.until is not None or count.mark is not None:
        return False
    if count.tail is not None or count.between is not None:
        return False
    return count.fills or (count.by is not None and all(it.level == 0 for it in _said_by(count)))


def _said_by(count: Count | None) -> Iterable[Reference]:
    """The fields that say a number."""
    return () if count is None or count.by is None else count.by.references.values()


def _is_plain(step: AnyStep) -> bool:
    """True if one field of the message is the number, or what is left of the payload says it."""
    assert step.count is not None
    by = None if step.count.by is None else step.count.by.plain
    return step.fills or (by is not None and "." not in by.name)


def _amount_of(step: AnyStep) -> str:
    """The name of the number of elements or bytes of what varies, where one field is it."""
    count = step.count
    assert count is not None
    by = None if count.by is None else count.by.plain
    return count.member if by is None else by.name


def _width(step: AnyStep) -> int:
    """Bytes of an element."""
    return step.element.sizes.greatest if isinstance(step, RepeatStep) else 1


# --- numbers that are given at the end ------------------------------------------------------------


def _given_at_the_end(item: Message, varied: Sequence[AnyStep]) -> Places | None:
    """The places, where all arrays have room for the most elements."""
    steps, limit = item.plan.steps, item.sizes.greatest
    names = list(dict.fromkeys(map(_amount_of, varied)))
    fixed = _fixed(item, varied)
    room = (limit - fixed) // max(1, sum(map(_width, varied)))
    bounds = {name: _bounds(name, varied, steps) for name in names}
    if len(names) == 1:  # With one number, it is known how many of them a frame has room for.
        [(name, (least, greatest))] = bounds.items()
        bounds[name] = (least, min(greatest, room))
    places: list[Place] = []
    at, moves = 0, False
    for step in steps:
        amount = _amount_of(step) if step in varied else ""
        most = bounds[amount][1] if amount else _most(step)
        size = most * _width(step) if amount else step.sizes.greatest
        places.append(Place(step, at, most, amount, _width(step), size, moves, bool(amount)))
        at, moves = at + size, moves or bool(amount)
    if at > limit or any(least > most or most < 1 for least, most in bounds.values()):
        return None
    found = {place.step.name: place for place in places}
    amounts = tuple(
        Amount(name, _counting(found, name), found[name].at if name in found else 0, *bounds[name])
        for name in names
    )
    return Places(tuple(places), amounts, at)


def _fixed(item: Message, varied: Sequence[AnyStep]) -> int:
    return sum(step.sizes.greatest for step in item.plan.steps if step not in varied)


def _most(step: AnyStep) -> int:
    return step.count.greatest if step.count else 1


def _bounds(name: str, varied: Iterable[AnyStep], steps: Iterable[AnyStep]) -> tuple[int, int]:
    """The least and the greatest number that all arrays, and the field that says it, can have."""
    counts = [step.count for step in varied if step.count and _amount_of(step) == name]
    bounds = [(count.least, count.greatest) for count in counts]
    bounds += [it.bounds for it in steps if isinstance(it, IntegerStep) and it.name == name]
    return max(least for least, _ in bounds), min(greatest for _, greatest in bounds)


def _counting(places: dict[str, Place], name: str) -> IntegerStep | None:
    step = places[name].step if name in places else None
    return step if isinstance(step, IntegerStep) else None


# --- numbers that are given first -----------------------------------------------------------------


def _given_first(item: Message, varied: Sequence[AnyStep]) -> Places | None:
    """The places, where numbers of elements are in the payload before anything else is."""
    steps, fixed = item.plan.steps, _fixed(item, varied)
    names = dict.fromkeys(it.name for step in varied for it in _said_by(step.count))
    amounts = [_number(steps, name) for name in names]
    places: list[Place] = []
    ahead: tuple[Place, ...] = ()
    at = 0
    for step in steps:
        varies, most = step in varied, _most(step)
        size = most * _width(step) if varies else step.sizes.greatest
        amount = _amount_of(step) if step.fills else ""
        place = Place(step, at, most, amount, _width(step), size, False, varies, ahead)
        if step.fills and step.count is not None:
            amounts.append(Amount(amount, None, 0, step.count.least, most))
        if any(it.step.fills for it in ahead) or (varies and (most < 1 or _has_default(step))):
            return None
        ahead, at = (*ahead, place) if varies else ahead, at if varies else at + size
        places.append(place)
    known = [it for it in amounts if it is not None]
    if len(known) < len(amounts):
        return None
    order = [step.name for step in steps]
    known.sort(key=lambda it: (order.index(it.place) if it.place else len(order), it.at))
    return Places(
        tuple(places), tuple(known), min(item.sizes.greatest, sum(it.size for it in places)), fixed
    )


def _has_default(step: AnyStep) -> bool:
    return step.field.default is not None


def _number(steps: Sequence[AnyStep], name: str) -> Amount | None:
    """A number that is a field of the message, or a member of a struct in it."""
    place, *members = name.split(".")
    step, at = next((it for it in steps if it.name == place), None), 0
    for member in members:
        if not isinstance(step, RecordStep) or step.packing is not None:
            return None
        names = [it.name for it in step.steps]
        index = names.index(member)
        at += sum(it.sizes.greatest for it in step.steps[:index])
        step = step.steps[index]
    if not isinstance(step, IntegerStep):
        return None
    return Amount(name, step, at, *step.bounds, place)


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
    found = _given_at_the_end(item, varied) if all(map(_is_plain, varied)) else None
    if found is None:
        found = _given_first(item, varied)
    if found is None or any(it.step and not _can_be_given(it.step) for it in found.amounts):
        return None
    return found


written_places = Kept(_places_of, most=1024)
"""The places of a message that can be written in its frame; None of others."""
