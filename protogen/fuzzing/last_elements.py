"""Elements of which the last says that it is the last."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import msgspec

from protogen.model.expressions import Operand
from protogen.model.payload_plan import AnyStep, Count, IntegerStep, RecordStep
from protogen.model.payload_walks import held_step, without_constant


class Mark(msgspec.Struct, frozen=True):
    """What an element says of being the last."""

    operand: Operand
    is_last: bool

    @staticmethod
    def of(count: Count, *, is_last: bool) -> Mark | None:
        """The mark of an element, where the last one has one."""
        if count.mark is None:
            return None
        assert isinstance(count.mark.expression, Operand)
        return Mark(count.mark.expression, is_last)

    def set_in(self, values: dict[str, Any], steps: Sequence[AnyStep]) -> None:
        """Have the values of an element say what is so."""
        *outer, name = self.operand.path
        for member in outer:
            record = _step_of(steps, member)
            assert isinstance(record, RecordStep)
            values, steps = values[member], record.steps
        step = _step_of(steps, name)
        assert isinstance(step, IntegerStep)
        values[name] = self._marked(values[name], step)

    def _marked(self, value: int, step: IntegerStep) -> int:
        if self.operand.run is not None:
            low, high = self.operand.run
            cleared = value & ~((1 << (high + 1)) - (1 << low))
            return cleared | (self.operand.of(value) or 1) << low if self.is_last else cleared
        if step.type.role == "bool":
            return self.is_last
        return (value or _other_than_zero(step)) if self.is_last else 0


def _step_of(steps: Sequence[AnyStep], name: str) -> AnyStep:
    return without_constant(held_step(next(step for step in steps if step.name == name)))


def _other_than_zero(step: IntegerStep) -> int:
    """A value that is not 0 and allowed."""
    enum = step.type.enum
    if enum is not None and enum.closed:
        return next(item.value for item in enum.values if item.value)
    least, greatest = step.bounds
    return max(1, least) if greatest else next(it.value for it in step.field.special if it.value)
