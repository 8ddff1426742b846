"""Functions that write payloads: the steps of a payload plan, one after another."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence

from protogen.model.computed import Computed, computed
from protogen.model.packing import FilledPacking, Packing
from protogen.model.payload_plan import (
    AnyStep,
    BytesStep,
    ChooseStep,
    ConditionalPresence,
    ConstantStep,
    Count,
    FloatStep,
    IntegerStep,
    OptionalStep,
    RecordStep,
    RegionStep,
    RepeatStep,
    RestStep,
)
from protogen.model.payload_walks import PackedNumber, held_step, packed_numbers, without_constant
from protogen.model.types import Field, Integer, Switch, Text
from protogen.targets.typescript.choosing import choose
from protogen.targets.typescript.formulas import condition, number
from protogen.targets.typescript.literals import boolean, call, characters, key, text
from protogen.targets.typescript.numbers import check_number, is_bigint, write_number
from protogen.targets.typescript.reading import constant_of, default_of, form_of
from protogen.targets.typescript.scope import Scope


class WriteFunction:
    """The body of a function that writes the members of a record, which is called `m`."""

    def __init__(self, scope: Scope) -> None:
        self._scope = scope

    def body(self, steps: Sequence[AnyStep], record: str, fields: Sequence[Field]) -> list[str]:
        """The lines."""
        self._fields(steps, record, fields, "m", 0)
        return self._scope.lines

    def _fields(
        self,
        steps: Sequence[AnyStep],
        record: str,
        fields: Sequence[Field],
        holder: str,
        level: int,
    ) -> None:
        names, counts = self._scope.names.records[record].fields, computed(fields)
        for step in steps:
            given = self._given(step, names, counts, holder)
            self._field(step, given, text(names[step.name]), level)
            if isinstance(step, RecordStep):
                self._scope.inner(level, step.name)

    def _given(
        self,
        step: AnyStep,
        names: Mapping[str, str],
        counts: Mapping[str, Computed],
        holder: str,
    ) -> str:
        """The value of a field: what is given, or what stands for it where nothing is."""
        given = _member(holder, names[step.name])
        if step.name in counts:
            item = counts[step.name]
            return f"{given} ?? {_counted(item, _member(holder, names[item.field]))}"
        if step.field.default is not None:
            return f"{given} ?? {default_of(step)}"
        return given

    def _field(self, step: AnyStep, given: str, at: str, level: int) -> None:
        """Write a field; what counts or selects is kept."""
        scope, held = self._scope, held_step(step)
        if isinstance(step, IntegerStep) and step.is_needed:
            name = scope.variable(step.name)
            scope.line(f"const {name} = {self._checked(step, given, at)};")
            scope.line(write_number(step, name, at, scope))
            scope.know(level, step.name, name)
            return
        if isinstance(held, IntegerStep) and held.is_needed:
            name = scope.variable(step.name)
            scope.line(f"const {name} = {given};")
            scope.know(level, step.name, name)
            given = name
        self._write(step, given, at, level)

    def _checked(self, step: IntegerStep | FloatStep, given: str, at: str) -> str:
        return check_number(step, given, at, self._scope)

    def _write(self, step: AnyStep, given: str, at: str, level: int) -> None:
        scope = self._scope
        match step:
            case IntegerStep() | FloatStep():
                scope.line(write_number(step, self._checked(step, given, at), at, scope))
            case BytesStep():
                self._string(step, given, at)
            case ConstantStep():
                due = f"w.constant({given}, {constant_of(step)}, {at})"
                self._write(step.value, due, at, level)
            case RecordStep():
                self._record(step, given, at, level)
            case RepeatStep():
                self._repeat(step, given, at, level)
            case ChooseStep():
                self._choose(step, given, at, level)
            case OptionalStep():
                self._optional(step, given, at, level)
            case RegionStep():
                start = scope.variable("start")
                scope.line(f"const {start} = w.size;")
                self._write(step.step, given, at, level)
                size, _ = self._bounds(step.region)
                scope.line(f"w.region({start}, {size}, {at});")

    # --- records and elements -----------------------------------------------------------------

    def _record(self, step: RecordStep, given: str, at: str, level: int) -> None:
        scope, holder = self._scope, self._scope.variable(step.name or "item")
        scope.forget(level + 1)
        scope.line(f"const {holder} = w.record({given}, {at});")
        scope.line(f"w.enter({at});")
        if step.packing is not None:
            values = self._packed_values(step, holder)
            self._packed(packed_numbers(step.steps), step.packing, values, level + 1)
        else:
            self._fields(step.steps, step.type.name, step.type.fields, holder, level + 1)
        scope.line("w.leave();")

    def _repeat(self, step: RepeatStep, given: str, at: str, level: int) -> None:
        scope, count = self._scope, step.count
        items, index = scope.variable("items"), scope.variable("i")
        least, greatest = self._bounds(count)
        scope.line(f"const {items} = w.list({given}, {least}, {greatest}, {at});")
        scope.line(f"w.enter({at});")
        if isinstance(step.packing, FilledPacking):
            assert isinstance(step.element, IntegerStep)
            little = boolean(step.packing.byte_order == "little")
            value = self._checked(step.element, "item", "index")
            made = f"{items}.map((item, index) => BigInt({value}))"
            scope.line(f"rt.writeRun(w, {made}, {step.packing.width}, {little});")
        elif step.packing is not None:
            self._packed(packed_numbers([step]), step.packing, {step.name: items}, level)
        else:
            with scope.block(f"for (let {index} = 0; {index} < {items}.length; {index}++)"):
                self._write(step.element, f"{items}[{index}]", index, level)
                if count.mark is not None:
                    is_last = f"({condition(count.mark, scope.look)})"
                    due = f"{index} === {items}.length - 1"
                    problem = text(f"the last element, and no other, is the last by {count.mark}")
                    scope.line(f"if ({is_last} !== ({due})) throw w.error({index}, {problem});")
        scope.line("w.leave();")

    def _bounds(self, count: Count) -> tuple[str, str]:
        """The least and the greatest number of elements or bytes."""
        if count.by is None:
            known = count.known
            return (str(count.least), str(count.greatest)) if known is None else (str(known),) * 2
        found = self._scope.variable("count")
        self._scope.line(f"const {found} = {number(count.by, self._scope.look)};")
        return found, found

    def _choose(self, step: ChooseStep, given: str, at: str, level: int) -> None:
        scope = self._scope
        value = scope.variable("value")
        scope.line(f"const {value} = {given};")
        choose(scope, step, lambda case: self._case(case, value, at, level), "w", at)

    def _case(self, step: AnyStep | RestStep, value: str, at: str, level: int) -> None:
        if isinstance(step, RestStep):
            assert isinstance(step.type, Switch)
            given = f"0, {step.count.greatest}, {boolean(step.type.byte_bits == 7)}, {at}"
            self._scope.line(f"w.octets({value}, {given});")
        elif isinstance(step, RecordStep) and not step.steps:
            self._scope.line(f"w.nothing({value}, {at});")
        else:
            self._write(step, value, at, level)

    def _optional(self, step: OptionalStep, given: str, at: str, level: int) -> None:
        scope = self._scope
        value = scope.variable(step.name)
        scope.line(f"const {value} = {given};")
        if isinstance(step.presence, ConditionalPresence):
            with scope.block(f"if ({condition(step.presence.holds, scope.look)})"):
                self._write(step.step, value, at, level)
            with scope.block("else"):
                scope.line(f"w.nothing({value}, {at});")
            return
        scope.know(level, f"?{step.name}", value)
        with scope.block(f"if ({value} !== null && {value} !== undefined)"):
            if step.field.behind:
                front = scope.known(level, f"?{step.field.behind}")
                problem = f"must be null, as {step.field.behind} in front of it is left out"
                scope.line(f"if (({front} ?? null) === null) throw w.error({at}, {text(problem)});")
            self._write(step.step, value, at, level)

    # --- bytes and texts ----------------------------------------------------------------------

    def _string(self, step: BytesStep, given: str, at: str) -> None:
        scope, type_, count = self._scope, step.type, step.count
        seven = boolean(type_.byte_bits == 7)
        if isinstance(type_, Text) and type_.padded is not None:
            form = form_of(type_)
            scope.line(f"{call('w.text', given, str(count.known), form, seven, at)};")
            return
        bounds = self._bounds(count)
        if count.between is not None:
            of = count.between
            around = (str(of.separator), boolean(of.leads), characters(of.characters))
            scope.line(f"{call('w.between', given, *around, *bounds, at)};")
            return
        name = "w.latin1" if isinstance(type_, Text) else "w.octets"
        until = None if count.until is None else str(count.until)
        scope.line(f"{call(name, given, *bounds, seven, at, until)};")

    # --- packed bits --------------------------------------------------------------------------

    def _packed_values(self, step: RecordStep, holder: str) -> Mapping[str, str]:
        """The expressions of the fields of a packed struct."""
        scope = self._scope
        names, counts = scope.names.records[step.type.name].fields, computed(step.type.fields)
        values = {}
        for inner in step.steps:
            given, value = self._given(inner, names, counts, holder), without_constant(inner)
            if isinstance(value, RepeatStep):
                at = text(names[inner.name])
                if isinstance(inner, ConstantStep):
                    given = f"w.constant({given}, {constant_of(inner)}, {at})"
                bounds = ", ".join(self._bounds(value.count))
                items = scope.variable("items")
                scope.line(f"const {items} = w.list({given}, {bounds}, {at});")
                given = items
            values[inner.name] = given
        return values

    def _packed(
        self,
        numbers: Iterable[PackedNumber],
        packing: Packing,
        values: Mapping[str, str],
        level: int,
    ) -> None:
        """Write a run of bits; `values` has the expression of each field."""
        scope = self._scope
        run = scope.variable("run")
        scope.line(f"let {run} = 0n;")
        for item in numbers:
            self._put(item, run, packing, values[item.name], level)
        size, little = packing.size, boolean(packing.byte_order == "little")
        scope.line(f"w.ubig({run}, {size}, {8 * size}, {little}, 256);")

    def _put(self, item: PackedNumber, run: str, packing: Packing, given: str, level: int) -> None:
        scope, step = self._scope, item.step
        assert isinstance(step.type, Integer)
        at = text(item.name) if item.index is None else str(item.index)
        value = given if item.index is None else f"{given}[{item.index}]"
        if item.constant is not None:
            big = is_bigint(step.type)
            due = boolean(bool(item.constant)) if step.type.role == "bool" else item.constant
            value = f"w.constant({value}, {due}{'n' if big else ''}, {at})"
        name = scope.variable(item.name or "bits")
        scope.line(f"const {name} = {self._checked(step, value, at)};")
        if item.index is None:
            scope.know(level, item.name, name)
        shift = packing.shift(item.first, step.type.bits)
        scope.line(f"{run} |= BigInt.asUintN({step.type.bits}, BigInt({name})) << {shift}n;")


def _member(holder: str, name: str) -> str:
    own = key(name)
    return f"{holder}{own}" if own.startswith("[") else f"{holder}.{own}"


def _counted(item: Computed, value: str) -> str:
    """The number that tells how many elements or bytes a field has."""
    count, (_, factor, offset, size) = f"rt.sizeOf({value})", item.line
    count = f"{count} * {size}" if size > 1 else count
    if factor < 0:
        count = f"{offset} - {count}"
    elif offset:
        count = f"{count} - {offset}" if offset > 0 else f"{count} + {-offset}"
    return f"({count})" if abs(factor) == 1 else f"rt.floor({count}, {abs(factor)})"
