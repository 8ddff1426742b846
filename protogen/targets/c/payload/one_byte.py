"""Messages that are one byte: too few for functions that are called."""

from __future__ import annotations

from protogen.c_language.numbers import integer_type
from protogen.model.payload_plan import IntegerStep, PartStep, PayloadPlan
from protogen.targets.c.payload.number_bytes import is_plain


def only_byte(plan: PayloadPlan) -> str:
    """The member that is all of a payload, a byte as it is; empty if it is anything else."""
    if len(plan.steps) != 1 or plan.packing is not None:
        return ""
    step = plan.steps[0]
    if not isinstance(step, IntegerStep) or isinstance(step, PartStep):
        return ""
    is_number = step.type.role != "bool" and integer_type(step.type) == "uint8_t"
    return step.name if is_number and is_plain(step.type) else ""
