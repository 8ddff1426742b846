"""Messages and the steps of their payloads."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from fractions import Fraction
from typing import Any

from protogen.model.computed import counting
from protogen.model.identities import Identities
from protogen.model.messages import Message
from protogen.model.packing import FilledPacking
from protogen.model.payload_plan import (
    AnyStep,
    BytesStep,
    Check,
    ChooseStep,
    ConditionalPresence,
    ConstantStep,
    Count,
    FloatStep,
    IntegerStep,
    OptionalStep,
    PartStep,
    RecordStep,
    RegionStep,
    RepeatStep,
    RestStep,
)
from protogen.model.payload_walks import packed_numbers
from protogen.model.sizes import SizeSet
from protogen.model.types import Constant, Field
from protogen.targets.html.plans.plain import Json, expression, fraction, lean, number
from protogen.targets.html.plans.types import TypeTable
from protogen.targets.typescript.names import Names


class MessagePlans:
    """Writes messages; `names` are those that the codec gives to fields."""

    def __init__(self, names: Names, types: TypeTable) -> None:
        self._names = names
        self._types = types

    def message(self, message: Message) -> Json:
        """A message and the steps of its payload."""
        return lean(
            {
                "sizes": _sizes(message.sizes),
                "identities": _runs(message.told_by),
                "virtual": dict(message.virtual),
                "cutSize": message.cut_size,
                "canBeCut": message.can_be_cut,
                "steps": self._steps(message.plan.steps, message.name, message.fields),
            }
        )

    def _steps(self, steps: Iterable[AnyStep], record: str, fields: Sequence[Field]) -> list[Json]:
        computes = counting(fields)
        return [
            self._step(step, record) | ({"computed": True} if step.name in computes else {})
            for step in steps
        ]

    def _step(self, step: AnyStep, record: str) -> Json:
        """A step; `record` is the struct or message whose field it is."""
        names = self._names.records.get(record)
        key = None if names is None else names.fields.get(step.name)
        common: Json = {"name": step.name, "key": None if key == step.name else key}
        match step:
            case PartStep():
                own = self._scalar(step) | {"kind": "part", "part": step.part}
            case IntegerStep() | FloatStep() | BytesStep():
                own = self._scalar(step)
            case ConstantStep():
                own = {"kind": "constant", "step": self._step(step.value, record)}
            case RecordStep():
                inside = self._steps(step.steps, step.type.name, step.type.fields)
                own = {"kind": "record", "steps": inside, **self._packing(step)}
            case RepeatStep():
                element = self._step(step.element, record)
                own = {"kind": "repeat", "element": element, "count": self._count(step.count)}
                own |= {"label": step.type.label, **self._packing(step)}
            case ChooseStep():
                own = {"kind": "choose", **self._choose(step, record)}
            case OptionalStep():
                is_said = isinstance(step.presence, ConditionalPresence)
                when = step.presence.expression if is_said else None  # type: ignore[union-attr]
                own = {"kind": "optional", "step": self._step(step.step, record)}
                own["when"] = None if when is None else expression(when)
            case RegionStep():
                own = {"kind": "region", "step": self._step(step.step, record)}
                own["region"] = self._count(step.region)
        return lean({**common, **own})

    def _choose(self, step: ChooseStep, record: str) -> Json:
        cases = [
            lean(
                {
                    "value": None if case.value is None else number(case.value),
                    "isElse": case.value is None,
                    "name": case.name,
                    "step": self._step(case.step, record),
                }
            )
            for case in step.cases
        ]
        return {
            "expression": expression(step.expression),
            "text": step.expression.text,
            "cases": cases,
            "rest": isinstance(step.rest, RestStep),
        }

    def _packing(self, step: RecordStep | RepeatStep) -> Json:
        packing = step.packing
        if packing is None:
            return {}
        steps = step.steps if isinstance(step, RecordStep) else (step,)
        is_filled = isinstance(packing, FilledPacking)
        numbers = [
            lean(
                {
                    "name": item.name if isinstance(step, RecordStep) else "",
                    "index": item.index,
                    "first": item.first,
                    "type": self._types.place(item.step.type),
                    **self._meaning(item.step.field),
                    "const": None if item.constant is None else number(item.constant),
                }
            )
            for item in packed_numbers(steps, int(is_filled))
        ]
        if isinstance(packing, FilledPacking):
            # The numbers are as many as fit, each like the first.
            return {"packing": {"order": packing.order, "width": packing.width, "numbers": numbers}}
        own: Json = {"size": packing.size, "order": packing.order, "bits": packing.bits}
        return {"packing": {**own, "padding": packing.padding, "numbers": numbers}}

    def _scalar(self, step: IntegerStep | FloatStep | BytesStep) -> Json:
        field = step.field
        own: Json = {
            "kind": "scalar",
            "type": self._types.place(step.type),
            "sevenBit": Check.SEVEN_BIT in step.checks,
            **self._meaning(field),
        }
        own["const"] = _constant(field.const)
        own["default"] = _constant(field.default)
        if isinstance(step, BytesStep):
            own["count"] = self._count(step.count)
        elif field.ranged:
            own["range"] = [_bound(field.least), _bound(field.greatest)]
        return own

    def _meaning(self, field: Field) -> Json:
        """How raw values of a field are read."""
        return {
            "unit": field.unit,
            "scale": fraction(field.scale) if field.scaled else None,
            "offset": fraction(field.offset) if field.scaled and field.offset else None,
            "special": {item.name: number(item.value) for item in field.special},
        }

    def _count(self, count: Count) -> Json:
        between = count.between
        return lean(
            {
                "known": None if count.expression is not None else count.known,
                "by": None if count.expression is None else expression(count.expression),
                "text": None if count.expression is None else count.expression.text,
                "fills": count.fills,
                "until": count.until,
                "least": count.least,
                "greatest": count.greatest,
                "tail": None
                if count.tail is None
                else {
                    "separator": count.tail.separator,
                    "element": count.tail.element,
                    "least": count.tail.least,
                },
                "mark": None if count.mark is None else expression(count.mark.expression),
                "between": None
                if between is None
                else {
                    "separator": between.separator,
                    "leads": between.leads,
                    "rest": between.takes_rest,
                    "characters": between.characters.decode("latin-1"),
                },
            }
        )


def _sizes(sizes: SizeSet) -> list[int]:
    return [sizes.least, sizes.greatest, sizes.step]


def _runs(identities: Identities) -> list[list[list[int | str]]]:
    return [[[number(one), number(other)] for one, other in runs] for runs in identities.runs]


def _bound(value: Fraction | None) -> Any:
    return None if value is None else fraction(value)


def _constant(value: Constant | None) -> Any:
    match value:
        case bytes():
            return {"hex": value.hex()}
        case tuple():
            return [number(item) for item in value]
        case bool() | str() | float() | None:
            return value
    return number(value)
