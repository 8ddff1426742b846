"""Wire bytes that a field begins with: its default, and zero where it has none."""

from __future__ import annotations

from collections.abc import Sequence

from protogen.model.constants import raw_bytes
from protogen.model.meanings import Enum
from protogen.model.payload_plan import (
    AnyStep,
    BytesStep,
    ConstantStep,
    FloatStep,
    IntegerStep,
    NumberStep,
    PartStep,
    RecordStep,
    RepeatStep,
)
from protogen.model.types import Text


def initial_bytes(step: AnyStep) -> bytes | None:
    """The bytes of a step's default; None where its size varies, or nothing says its bytes."""
    if isinstance(step, ConstantStep):
        return step.data
    return _of_number(step) if isinstance(step, NumberStep) else _of_others(step)


def _of_number(step: NumberStep) -> bytes | None:
    if isinstance(step, FloatStep):
        return raw_bytes(step.type, _real(step))
    if isinstance(step, PartStep) or not isinstance(step, IntegerStep) or step.type.is_free:
        return None
    return raw_bytes(step.type, _whole(step))


def _of_others(step: AnyStep) -> bytes | None:
    default = step.field.default
    match step:
        case BytesStep() if step.count.is_fixed:
            plain = b"" if not isinstance(step.type, Text) else raw_bytes(step.type, "")
            given = raw_bytes(step.type, default) if isinstance(default, str | bytes) else plain
            return given.ljust(step.count.greatest, b"\0")
        case RecordStep() if step.packing is None:
            return _joined([initial_bytes(item) for item in step.steps])
        case RepeatStep() if step.packing is None and step.count.is_fixed:
            if isinstance(default, tuple):
                return b"".join(raw_bytes(step.element.type, item) for item in default)
            return _joined([initial_bytes(step.element)] * step.count.greatest)
    return None


def begins_refused(step: AnyStep, given: Sequence[IntegerStep] = ()) -> bool:
    """True if an encoder refuses what such a step begins with, numbers aside that are given."""
    if not step.is_refusable or step in given:
        return False
    match step:
        case IntegerStep():
            return not _is_allowed(step, _whole(step))
        case FloatStep():
            number, least, greatest = _real(step), step.field.least, step.field.greatest
            is_above = least is None or number >= least
            return not (is_above and (greatest is None or number <= greatest))
        case RecordStep():
            return any(begins_refused(item, given) for item in step.steps)
        case RepeatStep():
            return step.field.default is None and begins_refused(step.element)
    return False


def _joined(parts: list[bytes | None]) -> bytes | None:
    known = [part for part in parts if part is not None]
    return b"".join(known) if len(known) == len(parts) else None


def _whole(step: IntegerStep) -> int:
    default = step.field.default
    return int(default) if isinstance(default, int) else 0


def _real(step: FloatStep) -> float:
    default = step.field.default
    return float(default) if isinstance(default, int | float) else 0.0


def _is_allowed(step: IntegerStep, number: int) -> bool:
    least, greatest = step.bounds
    is_known = not step.type.is_closed or _names(step.type.enum, number)
    is_special = any(item.value == number for item in step.field.special)
    return is_known and (is_special or least <= number <= greatest)


def _names(enum: Enum | None, number: int) -> bool:
    return enum is not None and any(item.value == number for item in enum.values)
