"""Functions that read payloads: the steps of a payload plan, one after another."""

from __future__ import annotations

from collections.abc import Sequence

from protogen.model.expressions import plain_name
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
from protogen.model.payload_walks import PackedNumber, packed_numbers
from protogen.model.types import Float, Integer, Octets, Switch, Tail, Text
from protogen.targets.typescript.choosing import choose
from protogen.targets.typescript.formulas import condition, number
from protogen.targets.typescript.literals import (
    boolean,
    call,
    characters,
    integer,
    key,
    listed,
    mapping,
    octets,
    real,
    text,
)
from protogen.targets.typescript.numbers import closed, is_bigint, read_number, values_of
from protogen.targets.typescript.scope import Scope


class ReadFunction:
    """The body of a function that reads a record, and gives it."""

    def __init__(self, scope: Scope) -> None:
        self._scope = scope

    def body(
        self, steps: Sequence[AnyStep], record: str, first: Sequence[tuple[str, str]] = ()
    ) -> list[str]:
        """The lines; what is given has the members `first`, and then those of the steps."""
        found = self._fields(steps, record, 0)
        self._scope.line(f"return {_object([*first, *found])};")
        return self._scope.lines

    def _fields(self, steps: Sequence[AnyStep], record: str, level: int) -> list[tuple[str, str]]:
        names = self._scope.names.records[record].fields
        found = []
        for step in steps:
            name = self._assigned(step, text(names[step.name]), step.name, level)
            found.append((names[step.name], name))
            self._scope.know(level, step.name, name)
            if isinstance(step, RecordStep):
                self._scope.inner(level, step.name)
        return found

    def _assigned(self, step: AnyStep, at: str, word: str, level: int) -> str:
        """A variable with the value of a step."""
        scope = self._scope
        if isinstance(step, OptionalStep | ChooseStep):
            name = scope.variable(word)
            scope.line(f"let {name};")
            self._set(step, name, at, level)
            return name
        value = self._value(step, at, level)
        if value.isidentifier():
            return value
        name = scope.variable(word)
        scope.line(f"const {name} = {value};")
        return name

    def _set(self, step: AnyStep, name: str, at: str, level: int) -> None:
        """Set a variable to the value of a step."""
        scope = self._scope
        match step:
            case OptionalStep():
                holds = "r.left > 0"
                if isinstance(step.presence, ConditionalPresence):
                    holds = condition(step.presence.holds, scope.look)
                with scope.block(f"if ({holds})", f"}} else {name} = null;"):
                    self._set(step.step, name, at, level)
            case ChooseStep():
                self._choose(step, name, at, level)
            case _:
                scope.line(f"{name} = {self._value(step, at, level)};")

    def _value(self, step: AnyStep, at: str, level: int) -> str:
        """The expression of a value, behind lines that it needs."""
        scope = self._scope
        match step:
            case IntegerStep() | FloatStep():
                return read_number(step, at, scope)
            case BytesStep():
                return self._string(step, at)
            case ConstantStep():
                value = self._value(step.value, at, level)
                return f"r.constant({value}, {constant_of(step)}, {at})"
            case RecordStep():
                return self._record(step, at, level)
            case RepeatStep():
                return self._repeat(step, at, level)
            case RegionStep():
                return self._region(step, at, level)
            case OptionalStep() | ChooseStep():
                return self._assigned(step, at, step.name, level)

    # --- records and elements -----------------------------------------------------------------

    def _record(self, step: RecordStep, at: str, level: int) -> str:
        scope = self._scope
        scope.forget(level + 1)
        scope.line(f"r.enter({at});")
        if step.packing is not None:
            value = self._packed_record(step, step.packing, level)
        else:
            fields = self._fields(step.steps, step.type.name, level + 1)
            value = _object(fields)
        name = scope.variable(step.name)
        scope.line(f"const {name} = {value};")
        scope.line("r.leave();")
        return name

    def _repeat(self, step: RepeatStep, at: str, level: int) -> str:
        scope, count = self._scope, step.count
        if isinstance(step.packing, FilledPacking):
            return self._filled_array(step, step.packing, at)
        if step.packing is not None:
            return self._packed_array(step, step.packing, at)
        name, index = scope.variable(step.name or "items"), scope.variable("i")
        bounds = f"{count.least}, {count.greatest}"
        if count.fills or count.mark is not None:
            scope.line(f"const {name} = {self._empty(step)};")
            self._until_end(step, at, level, name)
            return name
        if count.tail is not None:
            found = f"r.elements({_tail(count.tail)})"
            most = f"r.count({found}, {bounds}, {text(str(step.name))}, {at})"
        else:
            most = self._count(count, at)
        total = scope.variable("count")
        scope.line(f"const {total} = {most};")
        scope.line(f"const {name} = {self._empty(step)};")
        scope.line(f"r.enter({at});")
        with scope.block(f"for (let {index} = 0; {index} < {total}; {index}++)"):
            self._push(step, name, index, level)
        scope.line("r.leave();")
        return name

    def _empty(self, step: RepeatStep) -> str:
        """No elements; of a closed enum they have the type of its values."""
        type_ = step.element.type
        is_closed = isinstance(type_, Integer) and type_.is_closed
        return f"rt.noneOf({values_of(type_, self._scope)})" if is_closed else "[]"

    def _push(self, step: RepeatStep, name: str, index: str, level: int) -> None:
        value = self._value(step.element, index, level)
        self._scope.line(f"{name}.push({value});")

    def _until_end(self, step: RepeatStep, at: str, level: int, name: str) -> None:
        """Elements to the end, or up to the one that says that it is the last."""
        scope, count = self._scope, step.count
        size = f"{name}.length"
        more, least = f"{size} + 1, 0, {count.greatest}, {text('fill')}, {at}", count.least
        is_marked = count.mark is not None
        last = scope.variable("isLast")
        if is_marked:
            scope.line(f"let {last} = false;")
        with scope.block(f"while (!{last})" if is_marked else "while (r.left > 0)"):
            scope.line(f"r.count({more});")
            scope.line(f"r.enter({at});")
            here = scope.variable("here")
            if step.element.sizes.least == 0 and not is_marked:
                scope.line(f"const {here} = r.at;")
            self._push(step, name, size, level)
            scope.line("r.leave();")
            if step.element.sizes.least == 0 and not is_marked:
                problem = text("an element of no bytes fills nothing")
                scope.line(f'if (r.at === {here}) throw r.fault({at}, "size", {problem});')
            if count.mark is not None:
                scope.line(f"{last} = {condition(count.mark, scope.look)};")
        if least:
            scope.line(f"r.count({size}, {least}, {count.greatest}, {text('fill')}, {at});")

    def _count(self, count: Count, at: str) -> str:
        """The number of elements or bytes."""
        if count.by is None:
            return str(count.known)
        found = number(count.by, self._scope.look)
        assert count.expression is not None
        if not count.stated and plain_name(count.expression) is not None:
            return found
        label = text(count.expression.text)
        return call("r.count", found, str(count.least), str(count.greatest), label, at)

    def _region(self, step: RegionStep, at: str, level: int) -> str:
        scope = self._scope
        outer = scope.variable("outer")
        scope.line(f"const {outer} = r.open({self._count(step.region, at)}, {at});")
        value = self._assigned(step.step, at, step.name, level)
        scope.line(f"r.close({outer}, {at});")
        return value

    def _choose(self, step: ChooseStep, name: str, at: str, level: int) -> None:
        choose(self._scope, step, lambda case: self._set_case(case, name, at, level), "r", at)

    def _set_case(self, step: AnyStep | RestStep, name: str, at: str, level: int) -> None:
        if isinstance(step, RestStep):
            assert isinstance(step.type, Switch)
            given = f"0, {step.count.greatest}, {boolean(step.type.byte_bits == 7)}, {at}"
            self._scope.line(f"{name} = r.rest({given});")
        elif isinstance(step, RecordStep) and not step.steps:
            self._scope.line(f"{name} = null;")
        else:
            self._set(step, name, at, level)

    # --- bytes and texts ----------------------------------------------------------------------

    def _string(self, step: BytesStep, at: str) -> str:
        type_, count = step.type, step.count
        if isinstance(type_, Text) and type_.padded is not None:
            return call("r.text", str(count.known), form_of(type_), _seven(type_), at)
        found = self._octets(step, at)
        return f"rt.latin1({found})" if isinstance(type_, Text) else found

    def _octets(self, step: BytesStep, at: str) -> str:
        count, seven = step.count, _seven(step.type)
        bounds = (str(count.least), str(count.greatest))
        if count.between is not None:
            of = count.between
            allowed = characters(of.characters)
            given = (str(of.separator), boolean(of.leads), allowed, *bounds)
            return call("r.between", *given, at)
        if count.until is not None:
            return call("r.until", str(count.until), *bounds, seven, at)
        if count.fills:
            return call("r.rest", *bounds, seven, at)
        return call("r.octets", self._count(count, at), seven, at)

    # --- packed bits --------------------------------------------------------------------------

    def _run(self, packing: Packing, at: str) -> str:
        name = self._scope.variable("run")
        little = boolean(packing.byte_order == "little")
        self._scope.line(f"const {name} = r.run({packing.size}, {little}, {at});")
        return name

    def _end_run(self, packing: Packing, run: str, at: str) -> None:
        if packing.padding:
            last = 8 * (packing.size - 1) if packing.byte_order == "little" else 0
            mask = packing.padding << last
            self._scope.line(f"r.unused({run}, {mask}n, {at});")

    def _packed_record(self, step: RecordStep, packing: Packing, level: int) -> str:
        scope, names = self._scope, self._scope.names.records[step.type.name].fields
        run = self._run(packing, '""')
        found: dict[str, list[str]] = {}
        for item in packed_numbers(step.steps):
            name = scope.variable(item.name)
            scope.line(f"const {name} = {self._bits(item, run, packing, names)};")
            found.setdefault(item.name, []).append(name)
        self._end_run(packing, run, '""')
        fields = []
        for inner in step.steps:
            is_array = isinstance(inner.type, Integer) is False
            value = listed(found[inner.name]) if is_array else found[inner.name][0]
            fields.append((names[inner.name], value))
            scope.know(level + 1, inner.name, value)
        return _object(fields)

    def _packed_array(self, step: RepeatStep, packing: Packing, at: str) -> str:
        scope = self._scope
        scope.line(f"r.enter({at});")
        run = self._run(packing, '""')
        items = packed_numbers([step])
        name = scope.variable(step.name or "items")
        found = (self._bits(item, run, packing, {}) for item in items)
        scope.line(f"const {name} = {listed(found)};")
        self._end_run(packing, run, '""')
        scope.line("r.leave();")
        return name

    def _filled_array(self, step: RepeatStep, packing: FilledPacking, at: str) -> str:
        """Numbers whose bytes tell how many there are."""
        scope, type_ = self._scope, step.element.type
        assert isinstance(type_, Integer)
        name = scope.variable(step.name or "items")
        little = boolean(packing.byte_order == "little")
        bounds = f"{step.count.least}, {step.count.greatest}"
        found = f"BigInt.as{'Int' if type_.signed else 'Uint'}N({type_.bits}, bits)"
        found = found if is_bigint(type_) else f"Number({found})"
        found = closed("r", type_, found, "index", scope)
        runs = f"rt.readRun(r, {packing.width}, {little}, {bounds}, {at})"
        scope.line(f"r.enter({at});")
        scope.line(f"const {name} = {runs}.map((bits, index) => {found});")
        scope.line("r.leave();")
        return name

    def _bits(self, item: PackedNumber, run: str, packing: Packing, names: dict[str, str]) -> str:
        type_ = item.step.type
        shift = packing.shift(item.first, type_.bits)
        signed = "Int" if type_.signed else "Uint"
        found = f"BigInt.as{signed}N({type_.bits}, {run} >> {shift}n)"
        if type_.role == "bool":
            found = f"{found} !== 0n"
        elif not is_bigint(type_):
            found = f"Number({found})"
        at = text(names[item.name]) if item.index is None else str(item.index)
        found = closed("r", type_, found, at, self._scope)
        if item.constant is None:
            return found
        due = _number(item.step, item.constant)
        return f"r.constant({found}, {due}, {at})"


def _object(members: Sequence[tuple[str, str]]) -> str:
    found = mapping(dict(members))
    if len(found) < 80:
        return found
    inside = (name if name == value else f"{key(name)}: {value}" for name, value in members)
    return "{\n" + "".join(f"    {item},\n" for item in inside) + "  }"


def _seven(type_: Text | Octets) -> str:
    return boolean(type_.byte_bits == 7)


def form_of(type_: Text) -> str:
    """The form of a text of a fixed size."""
    form = type_.form
    if form.is_plain:
        return "rt.PLAIN_TEXT"
    given = {"padding": form.padding, "bits": form.bits, "shift": form.shift, "add": form.add}
    return mapping({name: str(value) for name, value in given.items()})


def _tail(tail: Tail) -> str:
    given = {"element": str(tail.element), "least": str(tail.least)}
    separator = None if tail.separator is None else str(tail.separator)
    return mapping({**given, "separator": separator})


def constant_of(step: ConstantStep) -> str:
    """The value of a constant."""
    value = step.field.const
    match value:
        case tuple():
            assert isinstance(step.value, RepeatStep)
            return listed(_number(step.value.element, item) for item in value)
        case str():
            return text(value)
        case bytes():
            return octets(value)
    assert value is not None
    return _number(step.value, value)


def default_of(step: AnyStep) -> str:
    """The value of a field where none is given."""
    value = step.field.default
    match value:
        case tuple():
            assert isinstance(step, RepeatStep)
            return listed(_number(step.element, item) for item in value)
        case str():
            return text(value)
        case bytes():
            return octets(value)
    assert value is not None
    return _number(step, value)


def _number(step: AnyStep, value: float) -> str:
    if isinstance(step.type, Float):
        return real(float(value))
    assert isinstance(step.type, Integer)
    if step.type.role == "bool":
        return boolean(bool(value))
    return integer(int(value), big=is_bigint(step.type))
