"""Codes of Python's `struct` for values of a fixed size."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from functools import lru_cache

from protogen.model.packing import Packing
from protogen.model.payload_plan import (
    AnyStep,
    BytesStep,
    CaseStep,
    ChooseStep,
    Count,
    FloatStep,
    IntegerStep,
    NumberStep,
    RecordStep,
    RepeatStep,
)
from protogen.model.payload_walks import without_constant
from protogen.model.sizes import SizeSet
from protogen.model.types import Float, NumberType, Struct, is_text

UNSIGNED = {1: "B", 2: "H", 4: "I", 8: "Q"}


def code_of(step: AnyStep) -> str | None:
    """The code of a value that one item of `struct` holds; None where it takes more.

    A number that `struct` does not know is so many bytes, to be converted.
    """
    value = without_constant(step)
    if isinstance(value, NumberStep):
        is_free = isinstance(value, IntegerStep) and value.type.is_free
        return None if is_free else _number_code(value.type)
    if isinstance(value, BytesStep) and value.count.is_fixed:
        return f"{value.count.known}s"
    if isinstance(value, RecordStep | RepeatStep) and isinstance(value.packing, Packing):
        return f"{value.packing.size}s"
    return None


@lru_cache(maxsize=1024)
def _number_code(type_: NumberType) -> str:
    """The code of a number, worked out once for all fields of a type."""
    if is_text(type_):
        return f"{type_.size}s"
    if isinstance(type_, Float):
        known: str | None = "f" if type_.bits == 32 else "d"
        is_known = type_.byte_bits == 8
    else:
        known = UNSIGNED.get(type_.size)
        is_known = type_.byte_bits == 8 or type_.size <= 2
    if known is None or not is_known:
        return f"{type_.size}s"
    return known.lower() if type_.signed and _is_native(type_) else known


def is_native(step: IntegerStep) -> bool:
    """True if `struct` itself reads and writes the value."""
    return _is_native(step.type)


def _is_native(type_: NumberType) -> bool:
    is_whole = type_.byte_bits == 8 and type_.bits in (8, 16, 32, 64)
    return is_whole and type_.role != "bool" and not is_text(type_)


def order_of(step: AnyStep) -> str:
    """`<` or `>`; empty where the order of bytes does not matter to `struct`."""
    value = without_constant(step)
    if not isinstance(value, NumberStep) or _number_code(value.type).endswith("s"):
        return ""
    return byte_order(value.type)


def byte_order(type_: NumberType) -> str:
    """`<` or `>` for the order of a number's bytes; empty where there is only one."""
    if type_.size == 1:
        return ""
    return "<" if type_.byte_order == "little" else ">"


def common_order(steps: Sequence[AnyStep]) -> str | None:
    """The order of bytes that one `struct` has for all steps; None where it can't read them."""
    if not steps or any(code_of(step) is None for step in steps):
        return None
    orders = {order_of(step) for step in steps} - {""}
    if len(orders) > 1:
        return None
    return orders.pop() if orders else ""


def array_code(step: RepeatStep) -> str | None:
    """The code of one element, where `struct` reads all of them as they are."""
    element = step.element
    if isinstance(element, IntegerStep):
        plain = is_native(element) and not element.type.is_named
        return code_of(element) if plain else None
    is_known = isinstance(element, FloatStep) and element.type.byte_bits == 8
    return code_of(element) if is_known else None


def is_pair(step: IntegerStep) -> bool:
    """True if the value is one of 8 to 14 bits in two bytes of 7 bits."""
    return step.type.byte_bits == 7 and step.type.size == 2


def outside(sizes: SizeSet, data: str) -> str:
    """The condition that bytes are more or fewer than they can be."""
    if sizes.fixed is not None:
        return f"len({data}) != {sizes.fixed}"
    bounds = f"not {sizes.least} <= len({data}) <= {sizes.greatest}"
    return f"{bounds} or (len({data}) - {sizes.least}) % {sizes.step}" if sizes.step > 1 else bounds


def outside_of(count: Count, number: str) -> str:
    """The condition that there are more or fewer than fill a payload."""
    if count.least:
        return f"not {count.least} <= {number} <= {count.greatest}"
    return f"{number} > {count.greatest}"


def holds_records(steps: Sequence[AnyStep], sizes: SizeSet) -> bool:
    """True if these are the sizes of steps, the last of which are as many records as there are.

    Then nothing can be wrong with a size but the number of records.
    """
    if not steps or not isinstance(last := without_constant(steps[-1]), RepeatStep):
        return False
    others = [step.sizes.fixed for step in steps[:-1]]
    if not last.fills or None in others:
        return False
    size, first = last.element.sizes.fixed, sum(filter(None, others))
    return bool(size) and sizes == SizeSet(
        first, first + (size or 0) * last.count.greatest, size or 1
    )


def outer_names(struct: Struct) -> tuple[str, ...]:
    """The fields of outer records that count or select something in the struct."""
    return tuple(sorted(struct.needs))


def outer_parameters(struct: Struct) -> dict[str, str]:
    """The parameters that stand for them."""
    return {name: f"{name.replace('.', '__')}_" for name in outer_names(struct)}


def patterns(step: ChooseStep) -> Iterator[tuple[str, CaseStep | None]]:
    """Yield what the cases of a choice match, with each case; None for those without bytes."""
    empty = [str(case.value) for case in step.cases if case.is_empty and case.value is not None]
    if empty:
        yield " | ".join(empty), None
    for case in step.cases:
        if case.value is None:
            yield "_", None if case.is_empty else case
        elif not case.is_empty:
            yield str(case.value), case
