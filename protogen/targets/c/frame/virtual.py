"""Parts that go into checksums and are not sent: their values, as decoders look them up."""

from __future__ import annotations

import msgspec

from protogen.c_language.numbers import hexadecimal, unsigned_type
from protogen.model.frame_plan import FramePlan
from protogen.model.part_plans import VirtualPlan
from protogen.model.parts import VirtualPart
from protogen.targets.c.decoders.groups import is_among, key_constant
from protogen.targets.c.frame.part_numbers import PartNumbers


class VirtualCase(msgspec.Struct, frozen=True):
    """A value, and the identities that have it."""

    keys: tuple[str, ...]
    conditions: tuple[str, ...]
    """Conditions that `key` is one of several identities; empty if every one is."""
    value: str


class VirtualView(msgspec.Struct, frozen=True):
    """A part that is not sent."""

    part: VirtualPart
    function: str
    """The function that gives its value for an identity; empty where it is always the same."""
    constant: str
    """That value; empty where identities tell it."""
    cases: tuple[VirtualCase, ...]
    default: str
    """The value for unknown identities; empty where these have none."""
    numbers: PartNumbers

    @property
    def name(self) -> str:
        """Name of the part in the schema."""
        return self.part.name

    @property
    def type(self) -> str:
        """The type of its value."""
        return unsigned_type(self.part.type.bits)

    @property
    def listed(self) -> tuple[VirtualCase, ...]:
        """The cases that list their identities."""
        return tuple(item for item in self.cases if item.keys)

    @property
    def tested(self) -> tuple[tuple[str, str], ...]:
        """Conditions on the identity, and the value behind each."""
        return tuple((one, item.value) for item in self.cases for one in item.conditions if one)

    @property
    def of_all(self) -> str:
        """The value of a message that has every identity; empty if there is none."""
        return next((item.value for item in self.cases if "" in item.conditions), "")

    @property
    def may_fail(self) -> bool:
        """True if some identity has no value, with which no frame can be verified."""
        return not (self.constant or self.default or self.of_all)

    def wire_bytes(self, value: str) -> tuple[str, ...]:
        """The bytes of a value, as they are summed."""
        return self.numbers.bytes_of(self.part.type, value)


def virtual_of(plan: FramePlan, prefix: str, numbers: PartNumbers) -> tuple[VirtualView, ...]:
    """The views of a frame's parts that are not sent."""
    return tuple(_view(plan, item, prefix, numbers) for item in plan.virtual)


def value_of(part: VirtualPart, value: int) -> str:
    """A value of a part, as C."""
    return hexadecimal(value, 2 * -(-part.type.bits // 8))


def function_of(prefix: str, part: VirtualPart) -> str:
    """The name of the function that gives a part's value for an identity."""
    return f"{prefix}_{part.name}_of"


def _view(plan: FramePlan, item: VirtualPlan, prefix: str, numbers: PartNumbers) -> VirtualView:
    part, constant = item.part, ""
    if not plan.identity:
        value = item.values[0][1] if item.values else part.default or 0
        constant = value_of(part, value)
    by_value: dict[int, list[str]] = {}
    tested: dict[int, list[str]] = {}
    for identities, value in item.values:
        if value == part.default:
            continue
        if identities.count == 1:
            by_value.setdefault(value, []).append(key_constant(plan, identities.first))
        else:
            tested.setdefault(value, []).append(is_among(plan, identities))
    cases = (
        VirtualCase(
            tuple(by_value.get(value, ())), tuple(tested.get(value, ())), value_of(part, value)
        )
        for value in dict.fromkeys((*by_value, *tested))
    )
    return VirtualView(
        part=part,
        function="" if constant else function_of(prefix, part),
        constant=constant,
        cases=tuple(cases),
        default="" if part.default is None else value_of(part, part.default),
        numbers=numbers,
    )
