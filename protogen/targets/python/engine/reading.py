"""Functions that read records: the bytes of a payload become a message."""

from __future__ import annotations

from collections.abc import Sequence
from functools import partial

import msgspec

from protogen.model.expressions import plain_name
from protogen.model.messages import Message
from protogen.model.payload_builder import plan_of
from protogen.model.payload_plan import (
    AnyStep,
    BytesStep,
    ChooseStep,
    ConstantStep,
    Count,
    FloatStep,
    Formula,
    IntegerStep,
    OptionalStep,
    RecordStep,
    RegionStep,
    RepeatStep,
    RestStep,
)
from protogen.model.payload_walks import without_constant
from protogen.model.sizes import SizeSet
from protogen.model.types import Octets, Struct
from protogen.runtime.attributes import attribute
from protogen.targets.python.engine.converting import Converter
from protogen.targets.python.engine.layout import (
    array_code,
    code_of,
    common_order,
    is_native,
    is_pair,
    order_of,
    outer_names,
    outer_parameters,
    outside,
    outside_of,
    patterns,
)
from protogen.targets.python.engine.lines import Constants, Lines
from protogen.targets.python.engine.packing import Record, unpack_record
from protogen.targets.python.engine.place import Place
from protogen.targets.python.engine.raw import Raw, member_of
from protogen.targets.python.formats import constant
from protogen.targets.python.formulas import in_python
from protogen.targets.python.literals import octets_in_class, tuple_of


def message_reader(
    message: Message, constants: Constants, around: tuple[int, int], *, is_ascii: bool
) -> tuple[str, ...]:
    """The body of `_read_NAME(data)`, which gives the message.

    The data are its payload, with so many bytes `around` it: in front, and behind. `is_ascii`:
    whoever calls it has seen that no byte has its most significant bit set.
    """
    reader = _Reader(Lines(constants), Place(), sizes=message.sizes, is_ascii=is_ascii)
    steps = message.plan.steps
    if message.sizes.fixed is not None and common_order(steps) is not None:
        reader.whole = around
    elif not steps:
        reader.lines.refuse_if(f"len(data) != {sum(around)}")
    else:
        front, behind = around
        if front or behind:
            reader.lines.add(f"data = data[{front or ''}:{-behind or ''}]")
        reader.lines.refuse_if(outside(message.sizes, "data"))
    reader.record("item", message.name, steps)
    if message.sizes.fixed is None and not reader.is_at_end:
        reader.lines.refuse_if(f"{reader.place.text} != len(data)")
    reader.lines.add("return item")
    return reader.lines.text


def struct_reader(struct: Struct, constants: Constants) -> tuple[str, ...]:
    """The body of `_read_NAME(data, at, OUTER...)`.

    It gives the struct, and where the size varies also the place behind it. OUTER are raw values of
    fields in front.
    """
    reader = _Reader(Lines(constants), Place("at"))
    reader.raw = outer_parameters(struct)
    if struct.packed is None:
        reader.record("item", struct.name, plan_of(struct.fields).steps)
    else:
        size = struct.sizes.greatest
        reader.lines.add(f"data = data[at : at + {size}]")
        reader.lines.refuse_if(f"len(data) != {size}")
        unpack_record(reader.lines, "data", "item", Record.of_struct(struct), reader.named)
    behind = "" if struct.sizes.fixed is not None else f", {reader.place.text}"
    reader.lines.add(f"return item{behind}")
    return reader.lines.text


def _padding(count: int) -> str:
    """Bytes that `struct` skips."""
    return f"{count}x" if count > 1 else "x" * count


class _Run(msgspec.Struct):
    """Values that one `struct` reads together."""

    order: str = ""
    codes: str = ""
    size: int = 0
    variables: list[str] = msgspec.field(default_factory=list)
    after: list[tuple[str, str, AnyStep]] = msgspec.field(default_factory=list)
    """Target, variable and step of each value that is to be converted."""


class _Reader(Converter, Raw):
    """Writes the body of one function."""

    def __init__(
        self, lines: Lines, place: Place, *, sizes: SizeSet | None = None, is_ascii: bool = False
    ) -> None:
        """With the `sizes` of a message, which are checked in front, to read that."""
        Converter.__init__(self, lines, is_ascii=is_ascii)
        Raw.__init__(self)
        self.place = place
        self.sizes = sizes
        self.is_at_end = False
        """True once a field of the message itself has taken all that was left."""
        self.whole: tuple[int, int] | None = None
        """Bytes around the message, where one `struct` reads it and checks its size."""
        self._run = _Run()

    def record(self, target: str, name: str, steps: Sequence[AnyStep]) -> None:
        """Make the record `target` and read its fields."""
        self._record(target, name, steps)
        self._flush()

    def _record(self, target: str, name: str, steps: Sequence[AnyStep]) -> None:
        self.lines.add(f"{target} = _new({self.lines.classes[name]})")
        outside = dict(self.raw)
        for step in steps:
            self._field(f"{target}.{attribute(step.name)}", step)
        self.raw = outside

    def _field(self, target: str, step: AnyStep) -> None:
        if code_of(step) is not None:
            self._scalar(target, step)
        elif isinstance(step, RecordStep) and step.sizes.fixed is not None:
            inner = self.lines.local("s")
            self._record(inner, step.type.name, step.steps)
            self.lines.add(f"{target} = {inner}")
            self.raw[step.name] = inner
        else:
            self._flush()
            self.lines.add(f"{target} = {self._value(step)}")
            if isinstance(step, IntegerStep):
                self.raw[step.name] = target
            self._constant(target, step)
            self.raw[step.name] = target

    # --- runs of values of a fixed size -----------------------------------------------------------

    def _scalar(self, target: str, step: AnyStep, *, is_field: bool = True) -> None:
        code = code_of(step)
        size = step.sizes.fixed
        assert code is not None
        assert size is not None
        order = order_of(step)
        if order and self._run.order and order != self._run.order:
            self._flush()
        self._run.order = self._run.order or order
        self._run.codes += code
        self._run.size += size
        direct = is_field and self._is_direct(step)
        variable = target if direct else self.lines.local()
        self._run.variables.append(variable)
        value = without_constant(step)
        if is_field and isinstance(value, IntegerStep | RecordStep):
            is_raw = isinstance(value, IntegerStep) and is_native(value)
            self.raw[step.name] = variable if is_raw else target
        if not direct:
            self._run.after.append((target, variable, step))

    @staticmethod
    def _is_direct(step: AnyStep) -> bool:
        """True if `struct` itself gives the attribute's value."""
        if isinstance(step, IntegerStep):
            return is_native(step) and not step.type.is_named
        if isinstance(step, BytesStep) and not isinstance(step.type, Octets):
            return False
        return isinstance(step, FloatStep | BytesStep) and step.type.byte_bits == 8

    def _flush(self) -> None:
        """Read the values that are due."""
        run, self._run = self._run, _Run()
        if not run.codes:
            return
        if self.whole is None and run.codes == "B":
            self.lines.add(f"{run.variables[0]} = data[{self.place.text}]")
        else:
            self._unpack(run)
        self.place.offset += run.size
        self._convert(run)

    def _convert(self, run: _Run) -> None:
        for target, variable, step in run.after:
            self.lines.add(f"{target} = {self.converted(variable, step)}")
            self._constant(target, step)

    def _unpack(self, run: _Run) -> None:
        """Read several values; with a whole message, `struct` checks its size."""
        front, behind = map(_padding, self.whole or (0, 0))
        layout = f'"{run.order or "<"}{front}{run.codes}{behind}"'
        method, given = "unpack", "data"
        if self.whole is None:
            method, given = "unpack_from", f"data, {self.place.text}"
        unpack = self.lines.constants.named("UNPACK", f"_struct.Struct({layout}).{method}")
        names, call = ", ".join(run.variables), f"{unpack}({given})"
        if len(run.variables) == 1:
            names = f"({names},)"
        if len(names) + len(call) < 80:
            self.lines.add(f"{names} = {call}")
            return
        self.lines.add("(")
        for name in names.split(", "):
            self.lines.add(f"    {name.rstrip(',')},")
        self.lines.add(f") = {call}")

    def _constant(self, value: str, step: AnyStep) -> None:
        if isinstance(step, ConstantStep):
            self.lines.refuse_if(f"{value} != {constant(step.field)}")

    # --- values of any kind -----------------------------------------------------------------------

    def _value(self, step: AnyStep) -> str:
        """Read a value at the present place, which moves on; the expression that holds it."""
        match step:
            case ConstantStep():
                return self._value(step.value)
            case RecordStep() | RepeatStep() if step.packing is not None:
                pass
            case RecordStep():
                return self._struct(step.type)
            case RepeatStep():
                return self._array(step)
            case ChooseStep():
                return self._choose(step)
            case OptionalStep() | RegionStep():
                return self._held(step)
            case BytesStep() if not step.count.is_fixed:
                return self._variable_string(step)
            case IntegerStep() if step.type.is_free:
                return self._written(step)
        target = self.lines.local()
        self._scalar(target, step, is_field=False)
        self._flush()
        return target

    def _move_to(self, expression: str) -> None:
        """From here on places are counted from `expression`."""
        at = self.place.variable or "at"
        if expression != at:
            self.lines.add(f"{at} = {expression}")
        self.place = Place(at)

    def _move_to_end(self, expression: str) -> None:
        """The same for what takes all that is left; nothing stands behind it."""
        if self.lines.is_nested or self.sizes is None:
            self._move_to(expression)
        else:
            self.is_at_end = True

    def _struct(self, struct: Struct) -> str:
        value = self.lines.local("s")
        outer = "".join(f", {self.raw_at(name)}" for name in outer_names(struct))
        call = f"_read_{struct.name}(data, {self.place.text}{outer})"
        size = struct.sizes.fixed
        if size is not None:
            self.lines.add(f"{value} = {call}")
            self.place.offset += size
        else:
            at = self.place.variable or "at"
            self.lines.add(f"{value}, {at} = {call}")
            self.place = Place(at)
        return value

    def _variable_string(self, step: BytesStep) -> str:
        value = self.lines.local()
        start = self.place.text
        if step.fills:
            self.lines.add(f"{value} = data[{start}:]" if start != "0" else f"{value} = data")
            self.lines.refuse_if(outside_of(step.count, f"len({value})"))
            self._move_to_end("len(data)")
        elif step.count.until is not None:
            self._up_to(value, step.count, step.count.until)
        else:
            count = self._count(step.count)
            end = self.lines.local("end")
            self.lines.add(f"{end} = {start} + {count}")
            self.lines.refuse_if(f"{end} > len(data)")
            self.lines.add(f"{value} = data[{start}:{end}]")
            self._move_to(end)
        return self.string(value, step)

    def _up_to(self, value: str, count: Count, byte: int) -> None:
        """Take the bytes in front of a terminator, and go on behind it."""
        start, end = self.place.text, self.lines.local("end")
        stop = Place(self.place.variable, self.place.offset + count.greatest + 1).text
        found = f"data.find({octets_in_class(bytes((byte,)))}, {start}, {stop})"
        self.lines.add(f"{end} = {found}")
        self.lines.refuse_if(f"{end} < {f'{start} + {count.least}' if count.least else '0'}")
        self.lines.add(f"{value} = data[{start}:{end}]")
        self._move_to(f"{end} + 1")

    def _written(self, step: IntegerStep) -> str:
        """Take a number out of the characters up to the next separator, or of all."""
        value, start = self.lines.local(), self.place.text
        if not step.type.takes_rest:
            end, number = self.lines.local("end"), self.lines.constants.number(step.type)
            self.lines.add(f"{value}, {end} = {number}.take(data, {start})")
            self._move_to(end)
            return self.named(value, step)
        text = f"data[{start}:]" if start != "0" else "data"
        decode = f"{self.lines.constants.number(step.type)}.decode({text})"
        self.lines.add(f"{value} = {self.named(decode, step)}")
        self._move_to_end("len(data)")
        return value

    def _count(self, count: Count) -> str:
        """The number of bytes or elements that earlier fields give, or that never changes."""
        if count.is_fixed:
            return str(count.known)
        assert count.expression is not None
        raw, is_plain = in_python(count.expression, self.raw_of), plain_name(count.expression)
        if not is_plain:
            name = self.lines.local("n")
            self.lines.add(f"{name} = {raw}")
            raw = name
        if count.stated or not is_plain:
            self.lines.refuse_if(f"not {count.least} <= {raw} <= {count.greatest}")
        else:
            self.lines.refuse_if(f"{raw} < 0")
        return raw

    def _choose(self, step: ChooseStep) -> str:
        value = self.lines.local("case")
        selector = in_python(step.expression, self.raw_of)
        self._move_to(self.place.text)
        self.lines.add(f"{value}: _typing.Any = None")
        # Python compiles only so many levels of `elif`; a `match` of any length is one level.
        with self.lines.block(f"match {selector}:"):
            for pattern, case in patterns(step):
                with self.lines.block(f"case {pattern}:"):
                    if case is None:
                        self.lines.add("pass")
                    else:
                        self._case(value, case.step)
            if step.otherwise is None:
                with self.lines.block("case _:"):
                    self._rest(value, step.rest)
        return value

    def _optional(self, step: OptionalStep) -> str:
        value = self.lines.local()
        self._move_to(self.place.text)
        self.lines.add(f"{value}: _typing.Any = None")
        goes_on = f"{self.place.text} < len(data)"
        condition = goes_on if step.member else in_python(step.expression, self.raw_of)
        with self.lines.block(f"if {condition}:"):
            found = self._value(step.step)
            self._constant(found, step.step)
            self.lines.add(f"{value} = {found}")
            self._move_to(self.place.text)
        return value

    def _held(self, step: OptionalStep | RegionStep) -> str:
        return self._optional(step) if isinstance(step, OptionalStep) else self._region(step)

    def _region(self, step: RegionStep) -> str:
        """Read what ends where so many bytes do: there, `data` have their end."""
        value, end, whole = self.lines.local(), self.lines.local("end"), self.lines.local("whole")
        self.lines.add(f"{end} = {self.place.text} + {self._count(step.region)}")
        self.lines.refuse_if(f"{end} > len(data)")
        self.lines.add(f"{whole} = data")
        self.lines.add(f"data = data[:{end}]")
        sizes, self.sizes = self.sizes, None
        self.lines.add(f"{value} = {self._value(step.step)}")
        self.lines.refuse_if(f"{self.place.text} != {end}")
        self.sizes = sizes
        self.lines.add(f"data = {whole}")
        self._move_to(end)
        return value

    def _case(self, target: str, step: AnyStep) -> None:
        outside = self.place.variable
        value = self._value(step)
        self.lines.add(f"{target} = {value}")
        self._move_to(self.place.text)
        assert self.place.variable == outside

    def _rest(self, target: str, rest: RestStep | None) -> None:
        if rest is None:
            self.lines.add("raise _fast.NeedsReference")
            return
        self.lines.add(f"{target} = data[{self.place.text} :]")
        self.lines.refuse_if(f"len({target}) > {rest.count.greatest}")
        if rest.can_be_wrong:
            self.lines.refuse_if(f"not {target}.isascii()")
        self._move_to("len(data)")

    # --- arrays -----------------------------------------------------------------------------------

    def _array(self, step: RepeatStep) -> str:
        if step.count.mark is not None:
            return self._up_to_last(step, step.count.mark)
        element, size = step.element, step.element.sizes.fixed
        if not size:
            return self._array_of_varying(step)
        together = isinstance(element, RecordStep) and common_order(element.steps) is not None
        if together and self._fills_message(step.count, size):
            assert isinstance(element, RecordStep)
            return self._elements_together(element, f"data[{self.place.offset}:]")
        count = self._array_count(step.count, size)
        values = self._elements(step, size, count)
        if step.count.is_fixed:
            self.place.offset += size * (step.count.known or 0)
            return values
        name = self.lines.local()
        self.lines.add(f"{name} = {values}")
        end = f"{self.place.text} + {size} * {count}"
        if step.fills:
            self._move_to_end(end)
        else:
            self._move_to(end)
        return name

    def _fills_message(self, count: Count, size: int) -> bool:
        """True if records are all the rest of a message, whose size says that they are whole.

        Then nothing can be wrong with their number.
        """
        sizes, first = self.sizes, self.place.offset
        if sizes is None or self.lines.is_nested or self.place.variable:
            return False
        if not count.fills:
            return False
        self.is_at_end = sizes == SizeSet(first, first + size * count.greatest, size)
        return self.is_at_end

    def _array_count(self, number: Count, size: int) -> str:
        if not number.fills:
            return self._count(number)
        count, left = self.lines.local("n"), self.lines.local("left")
        self.lines.add(f"{count}, {left} = divmod(len(data) - {self.place.grouped}, {size})")
        self.lines.refuse_if(f"{left} or {outside_of(number, count)}")
        return count

    def _elements(self, step: RepeatStep, size: int, count: str) -> str:
        element = step.element
        if isinstance(element, IntegerStep) and is_pair(element):
            return self._pair_elements(element, count)
        code = array_code(step)
        if code is not None:
            return f"list({self._unpack_array(code, step, count)})"
        if isinstance(element, RecordStep):
            return self._struct_elements(element, size, count)
        code = code_of(element)
        if code is None:
            return self._array_of_varying(step, count)
        return self._converted_elements(code, step, count)

    def _unpack_array(self, code: str, step: RepeatStep, count: str) -> str:
        order = order_of(step.element) or "<"
        if step.count.is_fixed:
            layout = f"{order}{count}{code}"
            if code.endswith("s"):
                layout = order + code * (step.count.known or 0)
            expression = f'_struct.Struct("{layout}").unpack_from'
            unpack = self.lines.constants.named("UNPACK", expression)
            return f"{unpack}(data, {self.place.text})"
        layout = f'f"{order}{{{count}}}{code}"'
        if code.endswith("s"):
            layout = f'"{order}" + "{code}" * {count}'
        return f"_struct.unpack_from({layout}, data, {self.place.text})"

    def _pair_elements(self, element: IntegerStep, count: str) -> str:
        values = self.lines.local()
        start, type_ = self.place.text, element.type
        arguments = f'{type_.bits}, {type_.signed}, "{type_.byte_order}"'
        unpack = self.lines.constants.named("PAIR_LIST", f"_fast.PairLists({arguments}).decode")
        end = f"{start} + 2 * {count}"
        if count.isdigit() and not self.place.variable:
            end = str(self.place.offset + 2 * int(count))
        self.lines.add(f"{values} = {unpack}(data[{start} : {end}])")
        self.lines.refuse_if(f"len({values}) != {count}")
        if not type_.is_named:
            return values
        return f"[{self.named('value', element)} for value in {values}]"

    def _struct_elements(self, element: RecordStep, size: int, count: str) -> str:
        outer = "".join(f", {self.raw_at(name)}" for name in outer_names(element.type))
        start = self.place.text
        stop = f"{start} + {size} * {count}"
        if common_order(element.steps) is not None:
            data = self.lines.local("data")
            self.lines.add(f"{data} = data[{start} : {start} + {size} * {count}]")
            self.lines.refuse_if(f"len({data}) != {size} * {count}")
            return self._elements_together(element, data)
        call = f"_read_{element.type.name}(data, place{outer})"
        places = self.lines.local("places")
        self.lines.add(f"{places} = range({start}, {stop}, {size})")
        return f"[{call} for place in {places}]"

    def _elements_together(self, element: RecordStep, data: str) -> str:
        """The elements whose bytes an expression gives, each read by one `struct`."""
        values, item = self.lines.local(), self.lines.local("s")
        self.lines.add(f"{values}: list[_typing.Any] = []")
        outside, self._run, raw = self._run, _Run(), dict(self.raw)
        for step in element.steps:
            self._field(f"{item}.{attribute(step.name)}", step)
        run, self._run, self.raw = self._run, outside, raw
        layout = f'_struct.Struct("{run.order or "<"}{run.codes}").iter_unpack'
        unpack = self.lines.constants.named("ITERATE", layout)
        names = [self.lines.local() if "." in name else name for name in run.variables]
        with self.lines.block(f"for {tuple_of(names)[1:-1]} in {unpack}({data}):"):
            self.lines.add(f"{item} = _new({self.lines.classes[element.type.name]})")
            for name, variable in zip(names, run.variables, strict=True):
                if "." in variable:
                    self.lines.add(f"{variable} = {name}")
            self._convert(run)
            self.lines.add(f"{values}.append({item})")
        return values

    def _converted_elements(self, code: str, step: RepeatStep, count: str) -> str:
        values, value = self.lines.local(), self.lines.local()
        unpacked = self._unpack_array(code, step, count)
        if self.is_seen(step.element):
            return f"list({unpacked})"
        self.lines.add(f"{values}: list[_typing.Any] = []")
        with self.lines.block(f"for {value} in {unpacked}:"):
            self.lines.add(f"{values}.append({self.converted(value, step.element)})")
        return values

    def _up_to_last(self, step: RepeatStep, mark: Formula) -> str:
        """Elements one by one, up to the one that says that it is the last."""
        values, count = self.lines.local(), step.count
        self.lines.add(f"{values}: list[_typing.Any] = []")
        self._move_to(self.place.text)
        at = self.place.text
        with self.lines.block("while True:"):
            item = self._value(step.element)
            self._move_to(self.place.text)
            self.lines.add(f"{values}.append({item})")
            with self.lines.block(f"if {in_python(mark.expression, partial(member_of, item))}:"):
                self.lines.add("break")
            self.lines.refuse_if(f"len({values}) == {count.greatest}")
            assert self.place.text == at
        if count.least > 1:
            self.lines.refuse_if(f"len({values}) < {count.least}")
        return values

    def _array_of_varying(self, step: RepeatStep, count: str | None = None) -> str:
        """Elements one by one, each from where the one before ended."""
        values = self.lines.local()
        self.lines.add(f"{values}: list[_typing.Any] = []")
        outside = self.place.text
        if step.fills and count is None:
            self._move_to(outside)
            head = f"while {self.place.text} < len(data):"
        else:
            number = self._count(step.count) if count is None else count
            self._move_to(outside)
            head = f"for _ in range({number}):"
        at = self.place.text
        with self.lines.block(head):
            before = self.lines.local("before")
            if step.fills:
                self.lines.add(f"{before} = {at}")
            self.lines.add(f"{values}.append({self._value(step.element)})")
            self._move_to(self.place.text)
            if step.fills:
                self.lines.refuse_if(f"{at} == {before}")
            assert self.place.text == at
        if step.fills:
            self.lines.refuse_if(outside_of(step.count, f"len({values})"))
        return values
