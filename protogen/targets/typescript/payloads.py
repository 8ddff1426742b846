"""Functions that read and write payloads: the steps of a plan, one after another.

Both go the same way through the steps, with the same paths and blocks; what one reads and the other
writes at a place stands side by side.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence

from protogen.model.computed import counting
from protogen.model.expressions import plain_name
from protogen.model.messages import Message
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
from protogen.model.types import Integer, Struct, Text
from protogen.targets.typescript.formulas import condition, number
from protogen.targets.typescript.literals import (
    Code,
    Data,
    call,
    characters,
    given,
    integer,
    lines,
    literal,
    member,
    told,
)
from protogen.targets.typescript.numbers import (
    check_number,
    closed,
    is_bigint,
    is_checked,
    is_seven,
    read_number,
    spelled,
    values_of,
    write_number,
)
from protogen.targets.typescript.scope import Scope

_NOTHING = Code("")
"""The value that is written where one is read, and the one that is read where one is written."""
_WIDTH = 80
"""An object of more characters has a line for each of its members."""


class PayloadFunction:
    """The body of a function, which calls a reader `r`, or a writer `w` of a message `m`."""

    def __init__(self, scope: Scope, *, reads: bool) -> None:
        self._scope = scope
        self._reads = reads
        self._by = "r" if reads else "w"

    def body(self, message: Message) -> tuple[str, ...]:
        """The lines."""
        found = self._fields(message.plan.steps, message, "m", 0)
        if self._reads:
            self._scope.add(f"return {_object({'message': message.name, **found})};")
        return self._scope.lines

    def _call(self, name: str, *arguments: Data) -> Code:
        return call(f"{self._by}.{name}", *arguments)

    def _do(self, name: str, *arguments: Data) -> None:
        self._scope.add(f"{self._call(name, *arguments)};")

    def _transfer(self, name: str, value: Code, *arguments: Data) -> Code:
        """The expression that reads; or print what writes the value."""
        if self._reads:
            return self._call(name, *arguments)
        self._do(name, value, *arguments)
        return _NOTHING

    def _let(self, word: str, value: str) -> Code:
        name = self._scope.variable(word)
        self._scope.add(f"const {name} = {value};")
        return name

    # --- fields -----------------------------------------------------------------------------------

    def _fields(
        self, steps: Sequence[AnyStep], record: Struct | Message, holder: str, level: int
    ) -> dict[str, Code]:
        """The fields of a record, by their names there."""
        names = self._scope.names.records[record.name].fields
        found = {}
        for step in steps:
            own = names[step.name]
            value = self._given(step, record, holder)
            found[own] = self._field(step, value, literal(own), level)
            if isinstance(step, RecordStep):
                self._scope.inner(level, step.name)
        return found

    def _given(self, step: AnyStep, record: Struct | Message, holder: str) -> Code:
        """The value of a field: what is given, or what stands for it where nothing is."""
        if self._reads:
            return _NOTHING
        names, counts = self._scope.names.records[record.name].fields, counting(record.fields)
        found = member(holder, names[step.name])
        if step.name in counts:
            item = counts[step.name]
            counted = call("rt.counted", member(holder, names[item.field]), *item.line[1:])
            return Code(f"{found} ?? {counted}")
        if step.field.default is not None:
            return Code(f"{found} ?? {literal(spelled(step.type, step.field.default))}")
        return found

    def _field(self, step: AnyStep, value: Code, at: Code, level: int) -> Code:
        """Read or write a field; what counts or selects is kept."""
        scope, held = self._scope, held_step(step)
        if self._reads:
            value = self._value(step, value, at, level)
            name = value if value.isidentifier() else self._let(step.name, value)
            scope.know(level, step.name, name)
            return name
        if isinstance(held, IntegerStep) and held.is_needed:
            if step is held:
                value = check_number(held, value, at, scope)
            value = self._let(step.name, value)
            scope.know(level, step.name, value)
            if step is held:
                scope.add(f"{write_number(held, value, at, scope)};")
                return _NOTHING
        return self._value(step, value, at, level)

    def _value(self, step: AnyStep, value: Code, at: Code, level: int) -> Code:
        """The expression of what is read, behind lines that it needs; or print what writes it."""
        match step:
            case IntegerStep() | FloatStep():
                return self._number(step, value, at)
            case BytesStep():
                return self._string(step, value, at)
            case ConstantStep():
                return self._constant(step, value, at, level)
            case RecordStep():
                return self._record(step, value, at, level)
            case RepeatStep():
                return self._repeat(step, value, at, level)
            case RegionStep():
                return self._region(step, value, at, level)
            case OptionalStep() | ChooseStep():
                return self._one_of(step, value, at, level)

    def _constant(self, step: ConstantStep, value: Code, at: Code, level: int) -> Code:
        if self._reads:
            return self._due(step, self._value(step.value, value, at, level), at)
        return self._value(step.value, self._due(step, value, at), at, level)

    def _due(self, step: ConstantStep, value: Code, at: Code) -> Code:
        """The constant, which a value has to be."""
        return self._call("constant", value, spelled(step.type, step.field.const), at)

    def _region(self, step: RegionStep, value: Code, at: Code, level: int) -> Code:
        region = self._let("region", self._call("open", self._size(step.region, at), at))
        found = self._field(step.step, value, at, level)
        self._do("close", region, at)
        return found

    # --- numbers, bytes and texts -----------------------------------------------------------------

    def _number(self, step: IntegerStep | FloatStep, value: Code, at: Code) -> Code:
        scope = self._scope
        if self._reads:
            return read_number(step, at, scope)
        if not is_checked(step):
            value = check_number(step, value, at, scope)
        scope.add(f"{write_number(step, value, at, scope)};")
        return _NOTHING

    def _string(self, step: BytesStep, value: Code, at: Code) -> Code:
        type_, count, seven = step.type, step.count, is_seven(step.type)
        if isinstance(type_, Text) and type_.padded is not None:
            return self._transfer("text", value, count.known, _form_of(type_), seven, at)
        least, greatest = self._bounds(count)
        if of := count.between:
            around = of.separator, of.leads, characters(of.characters)
            return self._transfer("between", value, *around, least, greatest, at)
        if not self._reads:
            name = "latin1" if isinstance(type_, Text) else "octets"
            return self._transfer(name, value, least, greatest, seven, at, count.until)
        is_text = isinstance(type_, Text)
        if count.until is not None:
            found = self._call("until", count.until, least, greatest, seven, at)
            return call("rt.latin1", found) if is_text else found
        size = self._call("rest", least, greatest, at) if count.fills else self._size(count, at)
        return self._call("latin1" if is_text else "octets", size, seven, at)

    def _size(self, count: Count, at: Code) -> Code:
        """A number of elements or bytes; a reader holds it to its bounds."""
        if count.by is None:
            return literal(count.known)
        found = Code(number(count.by, self._scope.look))
        assert count.expression is not None
        is_sure = not count.stated and plain_name(count.expression) is not None
        if not self._reads or is_sure:
            return found
        return self._call("count", found, count.least, count.greatest, count.expression.text, at)

    def _bounds(self, count: Count) -> tuple[Data, Data]:
        """The least and the greatest number that a writer takes."""
        if self._reads or (count.by is None and count.known is None):
            return count.least, count.greatest
        found = self._size(count, _NOTHING)
        found = found if count.by is None else self._let("count", found)
        return found, found

    # --- records and elements ---------------------------------------------------------------------

    def _record(self, step: RecordStep, value: Code, at: Code, level: int) -> Code:
        scope = self._scope
        scope.forget(level + 1)
        if not self._reads:
            value = self._let(step.name or "item", self._call("record", value, at))
        self._do("enter", at)
        if step.packing is None:
            found = self._fields(step.steps, step.type, value, level + 1)
        else:
            found = self._packed_fields(step, step.packing, value, level + 1)
        made = self._let(step.name, _object(found)) if self._reads else _NOTHING
        self._do("leave")
        return made

    def _repeat(self, step: RepeatStep, value: Code, at: Code, level: int) -> Code:
        packing = step.packing
        if not self._reads:
            value = self._let("items", self._call("list", value, *self._bounds(step.count), at))
        if packing is None:
            return self._elements(step, value, at, level)
        self._do("enter", at)
        if isinstance(packing, FilledPacking):
            value = self._filled(step, packing, value)
        else:
            found = self._packed([step], packing, {step.name: value}, {}, level)
            value = found[step.name]
        self._do("leave")
        return value

    def _elements(self, step: RepeatStep, items: Code, at: Code, level: int) -> Code:
        scope, mark = self._scope, step.count.mark
        index = scope.variable("i")
        more = f"; {index} < {items}.length"
        if self._reads:
            more = self._more(step, index, at)
            items = self._let(step.name or "items", self._none_of(step))
        self._do("enter", at)
        with scope.block(f"for (let {index} = 0{more}; {index}++)"):
            value = self._value(step.element, Code(f"{items}[{index}]"), index, level)
            if self._reads:
                is_known = step.count.known is not None
                put = f"{items}[{index}] = {value};" if is_known else f"{items}.push({value});"
                scope.add(put)
            if mark is not None and self._reads:
                scope.add(f"isLast = {condition(mark, scope.look)};")
            elif mark is not None:
                self._do("last", Code(condition(mark, scope.look)), items, index, mark.label)
        self._do("leave")
        return items

    def _more(self, step: RepeatStep, index: Code, at: Code) -> str:
        """More variables of a loop that reads elements, and the condition for another one."""
        count, bounds = step.count, (step.count.least, step.count.greatest)
        if count.mark is not None:
            return f", isLast = false; {self._call('goesOn', Code('isLast'), index, *bounds)}"
        if count.fills:
            found = self._call("next", Code("lastAt"), index, *bounds)
            return f", lastAt = -1; (lastAt = {found}) >= 0"
        if count.tail is not None:
            around = given(separator=count.tail.separator)
            found = self._call("elements", told(count.tail, "element least") | around)
            size = self._call("count", found, *bounds, step.name, at)
        else:
            size = self._size(count, at)
        return f"; {index} < {size if count.known is not None else self._let('count', size)}"

    def _none_of(self, step: RepeatStep) -> Code:
        """No elements, with room for as many as are known; of a closed enum with its type."""
        type_ = step.element.type
        if isinstance(type_, Integer) and type_.is_closed:
            return call("rt.noneOf", values_of(type_, self._scope))
        return Code("[]") if step.count.known is None else call("new Array", step.count.known)

    # --- what is there or not, or one of several --------------------------------------------------

    def _one_of(self, step: OptionalStep | ChooseStep, value: Code, at: Code, level: int) -> Code:
        """A value that is one thing or another."""
        if self._reads:
            held = self._scope.variable(step.name)
            self._scope.add(f"let {held};")
        else:
            held = self._let(step.name, value)
        if isinstance(step, OptionalStep):
            self._optional(step, held, at, level)
        else:
            self._choose(step, held, at, level)
        return held

    def _optional(self, step: OptionalStep, held: Code, at: Code, level: int) -> None:
        scope, presence = self._scope, step.presence
        if isinstance(presence, ConditionalPresence):
            holds = condition(presence.holds, scope.look)
        elif self._reads:
            holds = "r.left > 0"
        else:
            holds = f"{held} !== null && {held} !== undefined"
            scope.know(level, f"?{step.name}", held)
        with scope.block(f"if ({holds})"):
            if step.field.behind and not self._reads:
                front = Code(scope.known(level, f"?{step.field.behind}"))
                self._do("behind", front, step.field.behind, at)
            self._put(step.step, held, at, level)
        with scope.block("else"):
            self._put(None, held, at, level)

    def _choose(self, step: ChooseStep, held: Code, at: Code, level: int) -> None:
        scope = self._scope
        if isinstance(step.selector, int) and (chosen := step.case(step.selector)) is not None:
            self._case(chosen, held, at, level)
            return
        selector = self._let("selector", number(step.selector, scope.look))
        head = "if"
        for case in step.cases:
            if case.value is not None:
                with scope.block(f"{head} ({selector} === {case.value})"):
                    self._case(case.step, held, at, level)
                head = "else if"
        rest = step.rest if step.otherwise is None else step.otherwise.step
        with scope.block("else" if head != "if" else "if (true)"):
            if rest is not None:
                self._case(rest, held, at, level)
            else:
                problem = self._call("noCase", selector, step.expression.text, at)
                scope.add(f"throw {problem};")

    def _case(self, step: AnyStep | RestStep, held: Code, at: Code, level: int) -> None:
        """Read or write one of several; of a struct without fields there is no value."""
        is_empty = isinstance(step, RecordStep) and not step.steps
        self._put(None if is_empty else step, held, at, level)

    def _put(self, step: AnyStep | RestStep | None, held: Code, at: Code, level: int) -> None:
        """Read into a variable, or write its value; without a step there is none."""
        if step is None:
            found = Code("null")
            if not self._reads:
                self._do("nothing", held, at)
        elif isinstance(step, RestStep):
            ends = (0, step.count.greatest)
            sizes = (self._call("rest", *ends, at),) if self._reads else ends
            found = self._transfer("octets", held, *sizes, is_seven(step.type), at)
        else:
            found = self._value(step, held, at, level)
        if self._reads:
            self._scope.add(f"{held} = {found};")

    # --- packed bits ------------------------------------------------------------------------------

    def _packed_fields(
        self, step: RecordStep, packing: Packing, holder: str, level: int
    ) -> dict[str, Code]:
        names = self._scope.names.records[step.type.name].fields
        values = {it.name: self._packed_given(it, step.type, holder) for it in step.steps}
        found = self._packed(step.steps, packing, values, names, level)
        return {names[name]: value for name, value in found.items()}

    def _packed_given(self, step: AnyStep, record: Struct, holder: str) -> Code:
        value, inner = self._given(step, record, holder), without_constant(step)
        if self._reads or not isinstance(inner, RepeatStep):
            return value
        at = literal(self._scope.names.records[record.name].fields[step.name])
        if isinstance(step, ConstantStep):
            value = self._due(step, value, at)
        return self._let("items", self._call("list", value, *self._bounds(inner.count), at))

    def _packed(
        self,
        steps: Iterable[AnyStep],
        packing: Packing,
        values: Mapping[str, Code],
        names: Mapping[str, str],
        level: int,
    ) -> dict[str, Code]:
        """The numbers of a run of bits, by their fields."""
        found: dict[str, Data] = {}
        scope, size, little = self._scope, packing.size, packing.byte_order == "little"
        run = scope.variable("run")
        start = self._call("run", size, little, "") if self._reads else "0n"
        scope.add(f"{'const' if self._reads else 'let'} {run} = {start};")
        for item in packed_numbers(steps):
            is_alone, value = item.index is None, values[item.name]
            at = literal(names[item.name] if is_alone else item.index)
            shift = packing.shift(item.first, item.step.type.bits)
            if self._reads:
                value = _taken(item.step.type, f"{run} >> {shift}n")
            elif not is_alone:
                value = Code(f"{value}[{item.index}]")
            name = self._let(item.name or "bits", self._checked(item, value, at))
            if not self._reads:
                scope.add(
                    f"{run} |= BigInt.asUintN({item.step.type.bits}, BigInt({name})) << {shift}n;"
                )
            if is_alone:
                scope.know(level, item.name, name)
            found[item.name] = name if is_alone else [*found.get(item.name, ()), name]
        if not self._reads:
            self._do("ubig", run, size, 8 * size, little, 256)
        elif packing.padding:
            mask = packing.padding << (8 * (size - 1) if little else 0)
            self._do("unused", run, integer(mask), "")
        return {name: literal(value) for name, value in found.items()}

    def _checked(self, item: PackedNumber, value: Code, at: Code) -> Code:
        """The number of a run, which may be a constant or of a closed enum."""
        step, scope = item.step, self._scope
        due = None if item.constant is None else literal(spelled(step.type, item.constant))
        if self._reads:
            value = closed("r", step.type, value, at, scope)
        value = value if due is None else self._call("constant", value, due, at)
        return value if self._reads else check_number(step, value, at, scope)

    def _filled(self, step: RepeatStep, packing: FilledPacking, items: Code) -> Code:
        """Numbers whose bytes tell how many there are."""
        scope, inner, little = self._scope, step.element, packing.byte_order == "little"
        assert isinstance(inner, IntegerStep)
        index = Code("index")
        if self._reads:
            bounds = step.count.least, step.count.greatest
            runs = call("rt.readRun", Code("r"), packing.width, little, *bounds, "")
            found = closed("r", inner.type, _taken(inner.type, "bits"), index, scope)
            return self._let(step.name or "items", f"{runs}.map((bits, index) => {found})")
        value = check_number(inner, Code("item"), index, scope)
        made = Code(f"{items}.map((item, index) => BigInt({value}))")
        scope.add(f"{call('rt.writeRun', Code('w'), made, packing.width, little)};")
        return _NOTHING


def _taken(type_: Integer, run: str) -> Code:
    """The number in the lowest bits of a run."""
    found = f"BigInt.as{'Int' if type_.signed else 'Uint'}N({type_.bits}, {run})"
    if type_.role == "bool":
        return Code(f"{found} !== 0n")
    return Code(found if is_bigint(type_) else f"Number({found})")


def _object(members: Mapping[str, Data]) -> Code:
    found = literal(members)
    return found if len(found) < _WIDTH else lines(members, "  ")


def _form_of(type_: Text) -> Code:
    """The form of a text of a fixed size."""
    is_plain = type_.form.is_plain
    return (
        Code("rt.PLAIN_TEXT") if is_plain else literal(told(type_.form, "padding bits shift add"))
    )
