"""Functions that read records: the bytes of a payload become a message."""

from __future__ import annotations

from collections.abc import Sequence

from protogen.model.expressions import plain_name
from protogen.model.messages import Message
from protogen.model.packing import Packing
from protogen.model.payload_builder import plan_of
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
    TrailingPresence,
)
from protogen.model.payload_walks import without_constant
from protogen.model.types import Between, Octets, Struct
from protogen.runtime.attributes import attribute
from protogen.targets.python.engine.array_reading import ArrayReader, Run
from protogen.targets.python.engine.layout import (
    code_of,
    common_order,
    is_native,
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
from protogen.targets.python.formats import constant
from protogen.targets.python.formulas import in_python
from protogen.targets.python.literals import octets_in_class


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


class _Reader(ArrayReader):
    """Writes the body of one function."""

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
        run, self._run = self._run, Run()
        if not run.codes:
            return
        if self.whole is None and run.codes == "B":
            self.lines.add(f"{run.variables[0]} = data[{self.place.text}]")
        else:
            self._unpack(run)
        self.place.offset += run.size
        self._convert(run)

    def _convert(self, run: Run) -> None:
        for target, variable, step in run.after:
            self.lines.add(f"{target} = {self.converted(variable, step)}")
            self._constant(target, step)

    def _unpack(self, run: Run) -> None:
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
            case RecordStep() | RepeatStep() if isinstance(step.packing, Packing):
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
        elif step.count.between is not None:
            self._between(value, step.count, step.count.between)
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

    def _between(self, value: str, count: Count, between: Between) -> None:
        """Take the characters in front of the next separator, or of the end."""
        start = self.place.text
        separator = octets_in_class(bytes((between.separator,)))
        if between.leads:
            first = Place(self.place.variable, self.place.offset + 1).text
            self.lines.refuse_if(f"data[{start}:{first}] != {separator}")
            self.place.offset += 1
            start = first
        if between.takes_rest:
            self.lines.add(f"{value} = data[{start}:]")
        else:
            end = self.lines.local("end")
            self.lines.add(f"{end} = data.find({separator}, {start})")
            self.lines.add(f"{value} = data[{start}:] if {end} < 0 else data[{start}:{end}]")
        self.lines.refuse_if(outside_of(count, f"len({value})"))
        characters = self.lines.constants.named("CHARACTERS", octets_in_class(between.characters))
        self.lines.refuse_if(f"{value}.translate(None, {characters})")
        if between.takes_rest:
            self._move_to_end("len(data)")
        else:
            self._move_to(f"{start} + len({value})")

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
        with self.lines.block(f"if {self._is_there(step)}:"):
            found = self._value(step.step)
            self._constant(found, step.step)
            self.lines.add(f"{value} = {found}")
            self._move_to(self.place.text)
        return value

    def _is_there(self, step: OptionalStep) -> str:
        match step.presence:
            case ConditionalPresence(expression=condition):
                return in_python(condition, self.raw_of)
            case TrailingPresence():
                return f"{self.place.text} < len(data)"

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
