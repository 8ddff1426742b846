"""Messages whose struct lies in memory as the payload does on the wire, byte for byte."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from itertools import accumulate

from protogen.model.payload_plan import (
    AnyStep,
    BytesStep,
    FloatStep,
    IntegerStep,
    PayloadPlan,
    RepeatStep,
)
from protogen.model.types import Float, NumberType
from protogen.targets.c.payload.number_bytes import is_plain, is_whole
from protogen.targets.c.payload.texts import PaddedText

_FEW = 4
"""So many bytes are better taken one by one."""


def is_image(plan: PayloadPlan) -> bool:
    """True if a little-endian machine can copy a message's members all at once.

    Its members are numbers in the order of their bytes in memory, each at a multiple of its size,
    so that there is nothing between them on any machine.
    """
    sizes = list(_sizes(plan.steps)) if plan.packing is None else [0]
    if 0 in sizes or sum(sizes) <= _FEW:
        return False
    places = accumulate(sizes, initial=0)
    return all(place % size == 0 for place, size in zip(places, sizes, strict=False))


def last_place(plan: PayloadPlan) -> tuple[str, int]:
    """The last member of such a message, and where it has to lie: then all others lie right."""
    last = plan.steps[-1]
    return last.name, sum(step.sizes.greatest for step in plan.steps) - last.sizes.greatest


def _sizes(steps: Iterable[AnyStep]) -> Iterator[int]:
    """Yield the bytes of each number; 0 for what lies in memory in another way."""
    for step in steps:
        match step:
            case IntegerStep() | FloatStep():
                yield step.type.size if _lies_alike(step.type) else 0
            case RepeatStep() if step.packing is None and step.count.is_fixed:
                yield from list(_sizes([step.element])) * step.count.greatest
            case BytesStep() if step.count.is_fixed and PaddedText.of(step.type) is None:
                yield from [1] * step.count.greatest
            case _:
                yield 0


def _lies_alike(type_: NumberType) -> bool:
    """True if a number has the bytes that it has in a little-endian memory."""
    if isinstance(type_, Float):
        return type_.bits == 32 and type_.size == 4 and type_.byte_order == "little"
    if type_.role == "bool" or type_.text is not None:
        return False
    if type_.size == 1:
        return is_plain(type_)
    return type_.bits == 8 * type_.size and is_whole(type_) and type_.byte_order == "little"


def copied(prefix: str, to: str, source: str, size: int) -> tuple[str, ...]:
    """Statements that copy so many bytes between a struct and a payload."""
    if to == "message":
        return (
            "uint8_t *const to = (uint8_t *)message;",
            f"{prefix}_copy_whole(to, {source}, {size}U);",
        )
    return (
        "const uint8_t *const from = (const uint8_t *)message;",
        f"{prefix}_copy_whole({to}, from, {size}U);",
    )
