"""Makes payload plans of fields."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence

from protogen.copying import replace
from protogen.model.constants import allowed
from protogen.model.expressions import Expression, Number, Operand, folded, names_in
from protogen.model.field_names import count_name, presence_name
from protogen.model.payload_plan import (
    AnyStep,
    BytesStep,
    CaseStep,
    Check,
    ChooseStep,
    ConditionalPresence,
    ConstantStep,
    Count,
    FloatStep,
    Formula,
    IntegerStep,
    NumberStep,
    OptionalStep,
    PartStep,
    PayloadPlan,
    RecordStep,
    Reference,
    RegionStep,
    RepeatStep,
    RestStep,
    Step,
    TrailingPresence,
    has_member,
    packing_checks,
)
from protogen.model.presence import Conditional, Trailing
from protogen.model.sizes import SizeSet
from protogen.model.types import (
    Array,
    Between,
    Case,
    Counted,
    Delimited,
    Extent,
    Field,
    Fill,
    Fixed,
    Float,
    Integer,
    Marked,
    Octets,
    Struct,
    Switch,
    Text,
    Type,
    Until,
    beyond,
    is_text,
    packing_of,
    run_of,
    total,
)


def plan_of(fields: Sequence[Field]) -> PayloadPlan:
    """The plan of a message's or struct's fields."""
    steps = _Builder(0, {}, {}).record(fields, is_last=True)
    return PayloadPlan(steps=steps, sizes=total(tuple(fields)))


def plan_of_struct(struct: Struct) -> PayloadPlan:
    """The plan of a struct by itself."""
    return replace(plan_of(struct.fields), sizes=struct.sizes, packing=run_of(struct))


_NOTHING: frozenset[Check] = frozenset()
_NO_NAMES: frozenset[str] = frozenset()
_PRESENCE = Integer(bits=1, role="bool")
"""The type of what says in a record whether something is there."""
_Scope = Mapping[str, "int | Reference"]
"""The numbers in front, some of which are constants; of a member of a struct, `header.count`."""
_Key = tuple[str, int, bool, frozenset[str], "tuple[tuple[str, int | Reference], ...]"]


class _Builder:
    """Makes the steps of what lies at one depth of records, behind some numbers."""

    def __init__(self, level: int, scope: _Scope, made: dict[_Key, tuple[AnyStep, ...]]) -> None:
        self._level = level
        self._scope = dict(scope)
        self._made = made
        self._needed = _NO_NAMES
        """Names of the fields up to the present one that are needed behind it."""

    def record(
        self, fields: Sequence[Field], *, is_last: bool, needed_behind: frozenset[str] = _NO_NAMES
    ) -> tuple[AnyStep, ...]:
        """The steps of the fields of a record at this depth; what follows it needs some of them."""
        steps: list[AnyStep] = []
        needed = _needed_behind(fields, needed_behind)
        for index, field in enumerate(fields):
            member = count_name(fields, field) if field.has_count else ""
            at_end = is_last and index == len(fields) - 1
            self._needed = needed[index]
            inside = at_end or field.region is not None
            step = self._step(field, field.type, field.name, inside, member)
            step = step if field.region is None else self._region(field, field.region, step, at_end)
            if isinstance(step, IntegerStep) and field.name in needed[index]:
                step = replace(step, is_needed=True)
            step = _constant(field, step) if field.const is not None else step
            steps.append(self._present(fields, field, step))
            for rest in _inside(needed[index], field.name) | {""}:
                self._remember(_member(field, rest), f"{field.name}.{rest}" if rest else field.name)
        return tuple(steps)

    def _remember(self, field: Field, name: str) -> None:
        """Keep the number of a field, or of a member inside of one."""
        number = field.constant_number
        if number is not None:
            self._scope[name] = number
        elif isinstance(field.type, Integer):
            self._scope[name] = Reference(name, self._level, field.type)

    def _find(self, name: str) -> int | Reference:
        return self._scope.get(name, Reference(name, -1, None))

    def _formula(self, expression: Expression) -> int | Formula:
        """The formula of an expression, or the number that it always is."""
        found = folded(expression, self._known)
        if isinstance(found, Number):
            return found.value
        numbers = {name: self._find(name) for name in sorted(names_in(found))}
        references = {name: it for name, it in numbers.items() if isinstance(it, Reference)}
        return Formula(found, references)

    def _known(self, operand: Operand) -> int | None:
        number = self._find(operand.name)
        return number if isinstance(number, int) else None

    def _step(
        self, field: Field, type_: Type, name: str, is_last: bool, member: str = ""
    ) -> AnyStep:
        match type_:
            case Integer():
                kind = PartStep if field.part else IntegerStep
                return kind(
                    name=name,
                    field=field,
                    sizes=type_.sizes,
                    checks=_number_checks(type_),
                    is_refusable=_is_number_refusable(field, type_),
                    is_last=is_last,
                    type=type_,
                )
            case Float():
                return FloatStep(
                    name=name,
                    field=field,
                    sizes=type_.sizes,
                    checks=_number_checks(type_),
                    is_refusable=field.ranged,
                    is_last=is_last,
                    type=type_,
                )
            case Text() | Octets():
                count = self._count(type_.extent, member)
                return BytesStep(
                    name=name,
                    field=field,
                    sizes=type_.sizes,
                    checks=_string_checks(type_),
                    is_refusable=isinstance(type_, Text)
                    or type_.byte_bits == 7
                    or not isinstance(type_.extent, Fixed),
                    is_last=is_last,
                    type=type_,
                    count=count,
                )
            case Struct():
                steps, packing = self._inner(type_, name, is_last), run_of(type_)
                return RecordStep(
                    name=name,
                    field=field,
                    sizes=type_.sizes,
                    checks=_checks(steps) | packing_checks(packing),
                    is_refusable=any(step.is_refusable for step in steps),
                    holds_values=any(map(has_member, steps)),
                    is_last=is_last,
                    type=type_,
                    steps=steps,
                    packing=packing,
                )
            case Array():
                return self._repeat(field, type_, name, is_last, member)
            case Switch():
                return self._choose(field, type_, name, is_last)

    def _region(
        self, field: Field, region: Fixed | Counted, step: AnyStep, is_last: bool
    ) -> RegionStep:
        return RegionStep(
            name=field.name,
            field=field,
            sizes=field.sizes_there,
            checks=step.checks | {Check.COUNT},
            is_refusable=True,
            holds_values=step.holds_values or step.fills,
            is_last=is_last,
            type=field.type,
            step=step,
            region=self._count(region, ""),
        )

    def _present(self, fields: Sequence[Field], field: Field, step: AnyStep) -> AnyStep:
        """The step of a field, whether that is always there or not."""
        is_refusable = step.is_refusable
        presence: ConditionalPresence | TrailingPresence
        match field.presence:
            case None:
                return step
            case Conditional(condition=condition):
                presence = ConditionalPresence(expression=condition, holds=self._formula(condition))
            case Trailing(behind=behind):
                presence = self._trailing(fields, field)
                is_refusable = is_refusable or bool(behind)
        return OptionalStep(
            name=field.name,
            field=field,
            sizes=field.sizes,
            checks=step.checks,
            is_refusable=is_refusable,
            holds_values=step.holds_values,
            is_last=step.is_last,
            type=field.type,
            presence=presence,
            step=step,
        )

    def _trailing(self, fields: Sequence[Field], field: Field) -> TrailingPresence:
        member = presence_name(fields, field)
        number = Reference(member, self._level, _PRESENCE)
        front = [presence_name(fields, item) for item in fields if item.name == field.behind]
        return TrailingPresence(
            member=member,
            holds=Formula(Operand((member,)), {member: number}),
            behind=front[0] if front else "",
        )

    def _inner(self, type_: Struct, name: str, is_last: bool) -> tuple[AnyStep, ...]:
        """The steps of a struct, made once for all places where they are the same."""
        outer = tuple((name, self._find(name)) for name in sorted(type_.needs))
        needed = _inside(self._needed, name)
        key = type_.name, self._level, is_last, needed, outer
        if key not in self._made:
            inner = _Builder(self._level + 1, self._scope, self._made)
            self._made[key] = inner.record(type_.fields, is_last=is_last, needed_behind=needed)
        return self._made[key]

    def _repeat(
        self, field: Field, type_: Array, name: str, is_last: bool, member: str
    ) -> RepeatStep:
        element = self._element(field, type_)
        packing = packing_of(type_)
        checks = element.checks | _extent_checks(type_.extent) | packing_checks(packing)
        return RepeatStep(
            name=name,
            field=field,
            sizes=type_.sizes,
            checks=checks,
            is_refusable=element.is_refusable or not isinstance(type_.extent, Fixed),
            holds_values=element.holds_values,
            is_last=is_last,
            type=type_,
            element=element,
            count=self._count(type_.extent, member, type_.element),
            packing=packing,
        )

    def _element(self, field: Field, type_: Array) -> AnyStep:
        """The step of an element, of which a member may say that it is the last."""
        needed = self._needed
        if isinstance(type_.extent, Marked):
            self._needed = frozenset({f".{type_.extent.mark.name}"})
        step = self._step(field, type_.element, "", is_last=False)
        self._needed = needed
        return step

    def _choose(self, field: Field, type_: Switch, name: str, is_last: bool) -> ChooseStep:
        cases = tuple(self._case(field, case, is_last) for case in type_.cases)
        inside = _checks(case.step for case in cases)
        return ChooseStep(
            name=name,
            field=field,
            sizes=type_.sizes,
            checks=inside | (_NOTHING if type_.takes_all else {Check.CASE}),
            is_refusable=True,
            holds_values=type_.holds_values,
            is_last=is_last,
            type=type_,
            expression=type_.selector,
            selector=self._formula(type_.selector),
            cases=cases,
            rest=None if type_.rest is None else _rest(field, type_, type_.rest, is_last),
        )

    def _case(self, field: Field, case: Case, is_last: bool) -> CaseStep:
        step = self._step(field, case.type, case.name, is_last)
        return CaseStep(value=case.value, name=case.name, step=step)

    def _mark(self, extent: Extent, element: Type | None) -> Formula | None:
        """The formula of what says that an element is the last."""
        if not isinstance(extent, Marked):
            return None
        type_ = element
        for name in extent.mark.path:
            assert isinstance(type_, Struct)
            type_ = next(item.type for item in type_.fields if item.name == name)
        assert isinstance(type_, Integer)
        name = extent.mark.name
        return Formula(extent.mark, {name: Reference(name, self._level + 1, type_)})

    def _count(self, extent: Extent, member: str, element: Type | None = None) -> Count:
        counts, number = extent.counts, None
        if isinstance(extent, Counted):
            number = self._formula(extent.by)
        known = None if isinstance(extent, Delimited) else counts.fixed
        if known is None and isinstance(number, int):
            known = number
        return Count(
            expression=extent.by if isinstance(extent, Counted) else None,
            known=known,
            by=number if isinstance(number, Formula) else None,
            member=member,
            fills=isinstance(extent, Fill) and extent.tail is None,
            tail=extent.tail if isinstance(extent, Fill) else None,
            between=extent if isinstance(extent, Between) else None,
            until=extent.byte if isinstance(extent, Until) else None,
            mark=self._mark(extent, element),
            least=counts.least,
            greatest=counts.greatest,
            stated=extent.stated,
        )


def _needed_behind(fields: Sequence[Field], needed: frozenset[str]) -> list[frozenset[str]]:
    """For each field the names that count or select in those behind it."""
    found: list[frozenset[str]] = []
    for field in reversed(fields):
        found.append(needed)
        needed = beyond(needed, field.name) | field.needs
    return found[::-1]


def _member(field: Field, path: str) -> Field:
    """The field that a path leads to inside of one; without a path, that one."""
    while path:
        assert isinstance(field.type, Struct)
        name, _, path = path.partition(".")
        field = next(item for item in field.type.fields if item.name == name)
    return field


def _inside(needed: frozenset[str], name: str) -> frozenset[str]:
    """The names of members that are needed of a field."""
    paths = (path.partition(".") for path in needed)
    return frozenset(rest for first, _, rest in paths if rest and first == name)


def _constant(field: Field, step: AnyStep) -> ConstantStep:
    assert isinstance(step, NumberStep | BytesStep | RepeatStep)
    return ConstantStep(
        name=field.name,
        field=field,
        sizes=step.sizes,
        checks=step.checks | {Check.CONSTANT},
        is_refusable=isinstance(field.type.extent, Counted),
        holds_values=False,
        is_last=step.is_last,
        type=field.type,
        value=step,
    )


def _rest(field: Field, type_: Switch, greatest: int, is_last: bool) -> RestStep:
    return RestStep(
        name=type_.rest_name,
        field=field,
        sizes=SizeSet.between(0, greatest),
        checks=_seven_bit(type_),
        is_refusable=True,
        is_last=is_last,
        type=type_,
        count=Count(member="size", fills=True, least=0, greatest=greatest, stated=False),
    )


# --- facts of numbers -----------------------------------------------------------------------------


def _checks(steps: Iterable[Step]) -> frozenset[Check]:
    return _NOTHING.union(*(step.checks for step in steps))


def _number_checks(type_: Integer | Float) -> frozenset[Check]:
    found = [Check.SEVEN_BIT] if type_.byte_bits == 7 else []
    if is_text(type_):
        found.append(Check.DIGITS)
    elif type_.bits < type_.byte_bits * type_.size:
        found.append(Check.PADDING)
    if type_.role == "bool" and type_.size:
        found.append(Check.BOOLEAN)
    if type_.is_closed:
        found.append(Check.CLOSED)
    return frozenset(found)


def _seven_bit(type_: Integer | Float | Text | Octets | Switch) -> frozenset[Check]:
    return frozenset({Check.SEVEN_BIT}) if type_.byte_bits == 7 else _NOTHING


def _string_checks(type_: Text | Octets) -> frozenset[Check]:
    is_coded = isinstance(type_, Text) and not type_.form.is_plain
    of_characters = frozenset({Check.CHARACTERS}) if is_coded else _NOTHING
    return _seven_bit(type_) | _extent_checks(type_.extent) | of_characters


def _extent_checks(extent: Extent) -> frozenset[Check]:
    if isinstance(extent, Between):
        return frozenset({Check.CHARACTERS})
    return frozenset({Check.COUNT}) if isinstance(extent, Counted) else _NOTHING


def _is_number_refusable(field: Field, type_: Integer) -> bool:
    """True if the machine number that holds the value can have one that is not allowed."""
    if type_.is_closed:
        return True
    if type_.role == "bool" and not field.ranged:
        return False
    least, greatest = allowed(field, type_)
    machine_least, machine_greatest = type_.machine_bounds
    return least > machine_least or greatest < machine_greatest
