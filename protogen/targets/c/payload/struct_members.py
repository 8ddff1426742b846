"""The members of C structs and their types, for what prints them and what adds up their sizes.

Constants need no room: an encoder writes them, and a decoder takes nothing else. What fills the
payload has a second member, which says how much it is. C has no empty structs, so what holds
nothing has no member at all.
"""

from __future__ import annotations

from collections.abc import Sequence

import msgspec

from protogen.model.payload_plan import (
    AnyStep,
    BytesStep,
    ChooseStep,
    ConstantStep,
    Count,
    FloatStep,
    IntegerStep,
    RecordStep,
    RepeatStep,
    RestStep,
)
from protogen.model.types import Float, Text
from protogen.targets.c.spelling import counting_type, integer_type


class Member(msgspec.Struct, frozen=True):
    """A member of a struct or a union."""

    name: str
    type: str | Float | RecordStep | Union | tuple[Member, ...]
    """An integer or character as C spells it, a struct of the schema, or one without a name."""
    counts: tuple[int, ...] = ()
    """Elements of an array, and of the arrays in it."""


class Union(msgspec.Struct, frozen=True):
    """The cases of a choice that hold anything, and what holds the bytes of other values."""

    selector: str
    cases: tuple[Member, ...]
    rest: Member | None


UNUSED = Member("unused", "uint8_t")
"""The member of a struct that holds nothing: C has no empty structs."""


def members_of(steps: Sequence[AnyStep]) -> tuple[Member, ...]:
    """All members of a struct for the values of these steps."""
    found = (member for step in steps for member in (counter_of(step), value_of(step)))
    return tuple(member for member in found if member is not None) or (UNUSED,)


def counter_of(step: AnyStep) -> Member | None:
    """The member for the number of elements or bytes, where they fill the payload."""
    if not isinstance(step, BytesStep | RepeatStep) or not step.fills:
        return None
    return Member(step.count.member, counting_type(step.count.greatest))


def value_of(step: AnyStep) -> Member | None:
    """The member that holds the value."""
    return _member(step, step.name) if step.holds_values else None


def _member(step: AnyStep, name: str, counts: tuple[int, ...] = ()) -> Member:
    match step:
        case IntegerStep():
            return Member(name, integer_type(step.type), counts)
        case FloatStep():
            return Member(name, step.type, counts)
        case RecordStep():
            return Member(name, step, counts)
        case BytesStep():
            character = "char" if isinstance(step.type, Text) else "uint8_t"
            return Member(name, character, (*counts, _places(step.count)))
        case RepeatStep():
            return _member(step.element, name, (*counts, _places(step.count)))
        case ChooseStep():
            return Member(name, _union(step), counts)
        case ConstantStep():
            raise AssertionError("constants have no member")


def _places(count: Count) -> int:
    """C has no empty arrays."""
    return max(1, count.greatest)


def _union(step: ChooseStep) -> Union:
    held = (case.step for case in step.cases if case.step.holds_values)
    cases = tuple(_member(item, item.name) for item in held)
    return Union(step.selector_name, cases, None if step.rest is None else _rest(step.rest))


def _rest(step: RestStep) -> Member:
    size = Member("size", counting_type(step.count.greatest))
    return Member(step.name, (size, Member("bytes", "uint8_t", (_places(step.count),))))
