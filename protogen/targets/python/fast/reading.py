"""Functions that read records: the bytes of a payload become a message."""

from __future__ import annotations

from dataclasses import dataclass, field

from protogen.model.messages import Message
from protogen.model.sizes import SizeSet
from protogen.model.types import (
    Array,
    Case,
    Counted,
    Extent,
    Field,
    Fill,
    Fixed,
    Float,
    Integer,
    Octets,
    Struct,
    Switch,
    Text,
    Type,
)
from protogen.targets.python.fast.layout import (
    array_code,
    code_of,
    fixed_size,
    is_named,
    is_native,
    is_pair,
    order_of,
    outer_names,
    outside,
)
from protogen.targets.python.fast.lines import Constants, Lines
from protogen.targets.python.fast.place import Place
from protogen.targets.python.formats import constant, is_empty
from protogen.targets.python.literals import tuple_of
from protogen.targets.python.spelling import class_name


def message_reader(
    message: Message, constants: Constants, around: tuple[int, int], *, is_ascii: bool
) -> tuple[str, ...]:
    """The body of `_read_NAME(data)`, which gives the message.

    The data are its payload, with so many bytes `around` it: in front, and behind. `is_ascii`:
    whoever calls it has seen that no byte has its most significant bit set.
    """
    reader = _Reader(Lines(constants), Place(), sizes=message.sizes, is_ascii=is_ascii)
    if message.sizes.fixed is not None and goes_together(message.fields):
        reader.whole = around
    elif not message.fields:
        reader.lines.refuse_if(f"len(data) != {sum(around)}")
    else:
        front, behind = around
        if front or behind:
            reader.lines.add(f"data = data[{front or ''}:{-behind or ''}]")
        reader.lines.refuse_if(outside(message.sizes, "data"))
    reader.record("item", message.name, message.fields)
    if message.sizes.fixed is None and not reader.is_at_end:
        reader.lines.refuse_if(f"{reader.place.text} != len(data)")
    reader.lines.add("return item")
    return reader.lines.text


def goes_together(fields: tuple[Field, ...]) -> bool:
    """Whether one `struct` reads all fields."""
    orders = {order_of(item.type) for item in fields} - {""}
    return bool(fields) and all(code_of(f.type) is not None for f in fields) and len(orders) < 2


def struct_reader(struct: Struct, constants: Constants) -> tuple[str, ...]:
    """The body of `_read_NAME(data, at, OUTER...)`.

    It gives the struct, and where the size varies also the place behind it. OUTER are raw values of
    fields in front.
    """
    reader = _Reader(Lines(constants), Place("at"))
    reader.raw = {name: f"{name}_" for name in outer_names(struct)}
    reader.record("item", struct.name, struct.fields)
    behind = "" if fixed_size(struct) is not None else f", {reader.place.text}"
    reader.lines.add(f"return item{behind}")
    return reader.lines.text


def _padding(count: int) -> str:
    """Bytes that `struct` skips."""
    return f"{count}x" if count > 1 else "x" * count


@dataclass(slots=True)
class _Run:
    """Values that one `struct` reads together."""

    order: str = ""
    codes: str = ""
    size: int = 0
    variables: list[str] = field(default_factory=list)
    after: list[tuple[str, str, Type, Field | None]] = field(default_factory=list)
    """Target, variable, type and field of each value that is to be converted."""


class _Reader:
    """Writes the body of one function."""

    def __init__(
        self, lines: Lines, place: Place, *, sizes: SizeSet | None = None, is_ascii: bool = False
    ) -> None:
        """With the `sizes` of a message, which are checked in front, to read that."""
        self.lines = lines
        self.place = place
        self.is_ascii = is_ascii
        self.sizes = sizes
        self.is_at_end = False
        """Whether a field of the message itself has taken all that was left."""
        self.whole: tuple[int, int] | None = None
        """What is around the message, where one `struct` reads it and checks its size."""
        self.raw: dict[str, str] = {}
        """Raw values of the fields in front, by name."""
        self._run = _Run()

    def record(self, target: str, name: str, fields: tuple[Field, ...]) -> None:
        """Make the record `target` and read its fields."""
        self._record(target, name, fields)
        self._flush()

    def _record(self, target: str, name: str, fields: tuple[Field, ...]) -> None:
        self.lines.add(f"{target} = _new({class_name(name)})")
        outside = dict(self.raw)
        for item in fields:
            self._field(f"{target}.{item.name}", item)
        self.raw = outside

    def _field(self, target: str, item: Field) -> None:
        type_ = item.type
        if code_of(type_) is not None:
            self._scalar(target, type_, item)
        elif isinstance(type_, Struct) and fixed_size(type_) is not None:
            inner = self.lines.local("s")
            self._record(inner, type_.name, type_.fields)
            self.lines.add(f"{target} = {inner}")
        else:
            self._flush()
            self.lines.add(f"{target} = {self._value(type_)}")
            self._constant(target, item)

    # --- runs of values of a fixed size -----------------------------------------------------------

    def _scalar(self, target: str, type_: Type, item: Field | None) -> None:
        code = code_of(type_)
        size = fixed_size(type_)
        assert code is not None
        assert size is not None
        order = order_of(type_)
        if order and self._run.order and order != self._run.order:
            self._flush()
        self._run.order = self._run.order or order
        self._run.codes += code
        self._run.size += size
        direct = item is not None and item.const is None and self._is_direct(type_)
        variable = target if direct else self.lines.local()
        self._run.variables.append(variable)
        if item is not None and isinstance(type_, Integer):
            self.raw[item.name] = variable if is_native(type_) else target
        if not direct:
            self._run.after.append((target, variable, type_, item))

    @staticmethod
    def _is_direct(type_: Type) -> bool:
        """Whether `struct` itself gives the attribute's value."""
        if isinstance(type_, Integer):
            return is_native(type_) and not is_named(type_)
        return isinstance(type_, Float | Octets) and type_.byte_bits == 8

    def _flush(self) -> None:
        """Read the values that are due."""
        run, self._run = self._run, _Run()
        if not run.codes:
            return
        layout = f'"{run.order or "<"}{run.codes}"'
        if self.whole is not None:
            front, behind = map(_padding, self.whole)
            layout = f'"{run.order or "<"}{front}{run.codes}{behind}"'
            unpack = self.lines.constants.named("UNPACK", f"_struct.Struct({layout}).unpack")
            names = ", ".join(run.variables)
            self._unpack(f"({names},)" if len(run.variables) == 1 else names, f"{unpack}(data)")
        elif run.codes == "B":
            self.lines.add(f"{run.variables[0]} = data[{self.place.text}]")
        else:
            names = ", ".join(run.variables)
            if len(run.variables) == 1:
                names = f"({names},)"
            unpack = self.lines.constants.named("UNPACK", f"_struct.Struct({layout}).unpack_from")
            self._unpack(names, f"{unpack}(data, {self.place.text})")
        self.place.offset += run.size
        for target, variable, type_, item in run.after:
            self.lines.add(f"{target} = {self._converted(variable, type_)}")
            self._constant(target, item)

    def _unpack(self, names: str, call: str) -> None:
        if len(names) + len(call) < 80:
            self.lines.add(f"{names} = {call}")
            return
        self.lines.add("(")
        for name in names.split(", "):
            self.lines.add(f"    {name.rstrip(',')},")
        self.lines.add(f") = {call}")

    def _constant(self, value: str, item: Field | None) -> None:
        if item is not None and item.const is not None:
            self.lines.refuse_if(f"{value} != {constant(item)}")

    # --- what `struct` gives as attributes --------------------------------------------------------

    def _converted(self, variable: str, type_: Type) -> str:
        match type_:
            case Integer():
                return self._named(self._integer(variable, type_), type_)
            case Float(byte_bits=7):
                call = f'_fast.seven_bit_float({type_.bits}, "{type_.byte_order}").decode'
                return f"{self.lines.constants.named('FLOAT', call)}({variable})"
            case Text() | Octets():
                return self._string(variable, type_)
        return variable

    def _integer(self, variable: str, type_: Integer) -> str:
        if type_.role == "bool":
            self.lines.refuse_if(f"{variable} > 1")
            return f"{variable} == 1"
        if is_native(type_):
            return variable
        if is_pair(type_):
            if self.is_ascii and type_.bits == 14:
                table = f"_TABLES.pairs({type_.bits}, {type_.signed})"
                return f"{self.lines.constants.named('PAIRS', table)}[{variable}]"
            return f"{self._pairs(type_)}[{variable}]"
        code = code_of(type_)
        assert code is not None
        if code.endswith("s"):
            return f"{self.lines.constants.number(type_)}.decode({variable})"
        if not (self.is_ascii and type_.bits == 7):
            self.lines.refuse_if(f"{variable} >> {type_.bits}")
        if not type_.signed:
            return variable
        sign = f"0x{1 << (type_.bits - 1):X}"
        return f"({variable} ^ {sign}) - {sign}"

    def _pairs(self, type_: Integer) -> str:
        arguments = f'{type_.bits}, {type_.signed}, "{type_.byte_order}"'
        return self.lines.constants.named("PAIRS", f"_fast.Pairs({arguments})")

    def _named(self, value: str, type_: Integer) -> str:
        named = type_.enum or type_.flags
        if named is None:
            return value
        if not (type_.enum and type_.enum.closed) and not type_.signed and type_.bits <= 8:
            table = f"_TABLES.members({class_name(named.name)}, {type_.bits})"
            return f"{self.lines.constants.named('MEMBERS', table)}[{value}]"
        kind = "closed" if type_.enum is not None and type_.enum.closed else "Members"
        members = f"_fast.{kind}({class_name(named.name)})"
        return f"{self.lines.constants.named('MEMBERS', members)}[{value}]"

    def _string(self, value: str, type_: Text | Octets) -> str:
        if type_.byte_bits == 7 and not self.is_ascii:
            self.lines.refuse_if(f"not {value}.isascii()")
        if isinstance(type_, Octets):
            return value
        padding = '.rstrip(b"\\0")' if isinstance(type_.extent, Fixed) else ""
        return f'{value}{padding}.decode("latin-1")'

    # --- values of any kind -----------------------------------------------------------------------

    def _value(self, type_: Type) -> str:
        """Read a value at the present place, which moves on; the expression that holds it."""
        match type_:
            case Struct():
                return self._struct(type_)
            case Array():
                return self._array(type_)
            case Switch():
                return self._switch(type_)
            case Text() | Octets() if not isinstance(type_.extent, Fixed):
                return self._variable_string(type_)
        target = self.lines.local()
        self._scalar(target, type_, None)
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
        outer = "".join(f", {self.raw[name]}" for name in outer_names(struct))
        call = f"_read_{struct.name}(data, {self.place.text}{outer})"
        size = fixed_size(struct)
        if size is not None:
            self.lines.add(f"{value} = {call}")
            self.place.offset += size
        else:
            at = self.place.variable or "at"
            self.lines.add(f"{value}, {at} = {call}")
            self.place = Place(at)
        return value

    def _variable_string(self, type_: Text | Octets) -> str:
        value = self.lines.local()
        start = self.place.text
        if isinstance(type_.extent, Fill):
            self.lines.add(f"{value} = data[{start}:]" if start != "0" else f"{value} = data")
            self.lines.refuse_if(f"len({value}) > {type_.extent.greatest}")
            self._move_to_end("len(data)")
        else:
            count = self._count(type_.extent)
            end = self.lines.local("end")
            self.lines.add(f"{end} = {start} + {count}")
            self.lines.refuse_if(f"{end} > len(data)")
            self.lines.add(f"{value} = data[{start}:{end}]")
            self._move_to(end)
        return self._string(value, type_)

    def _count(self, extent: Extent) -> str:
        """The number of bytes or elements that an earlier field gives, or that never changes."""
        if isinstance(extent, Fixed):
            return str(extent.count)
        assert isinstance(extent, Counted)
        raw = self.raw[extent.field]
        if extent.stated:
            self.lines.refuse_if(f"not {extent.least} <= {raw} <= {extent.greatest}")
        else:
            self.lines.refuse_if(f"{raw} < 0")
        return raw

    def _switch(self, switch: Switch) -> str:
        value = self.lines.local("case")
        selector = self.raw[switch.selector]
        self._move_to(self.place.text)
        self.lines.add(f"{value}: _typing.Any = None")
        word = "if"
        empty = [str(case.value) for case in switch.cases if is_empty(case.type)]
        if empty:
            with self.lines.block(f"{word} {selector} in {tuple_of(empty)}:"):
                self.lines.add("pass")
            word = "elif"
        for case in switch.cases:
            if is_empty(case.type):
                continue
            with self.lines.block(f"{word} {selector} == {case.value}:"):
                self._case(value, case)
            word = "elif"
        with self.lines.block("else:"):
            self._rest(value, switch)
        return value

    def _case(self, target: str, case: Case) -> None:
        outside = self.place.variable
        value = self._value(case.type)
        self.lines.add(f"{target} = {value}")
        self._move_to(self.place.text)
        assert self.place.variable == outside

    def _rest(self, target: str, switch: Switch) -> None:
        if switch.rest is None:
            self.lines.add("raise _fast.Unclear")
            return
        self.lines.add(f"{target} = data[{self.place.text} :]")
        self.lines.refuse_if(f"len({target}) > {switch.rest}")
        if switch.byte_bits == 7:
            self.lines.refuse_if(f"not {target}.isascii()")
        self._move_to("len(data)")

    # --- arrays -----------------------------------------------------------------------------------

    def _array(self, array: Array) -> str:
        size = fixed_size(array.element)
        if not size:
            return self._array_of_varying(array)
        element = array.element
        together = isinstance(element, Struct) and goes_together(element.fields)
        if together and self._fills_message(array.extent, size):
            assert isinstance(element, Struct)
            return self._elements_together(element, f"data[{self.place.offset}:]")
        count = self._array_count(array.extent, size)
        values = self._elements(array, size, count)
        if isinstance(array.extent, Fixed):
            self.place.offset += size * array.extent.count
            return values
        name = self.lines.local()
        self.lines.add(f"{name} = {values}")
        end = f"{self.place.text} + {size} * {count}"
        if isinstance(array.extent, Fill):
            self._move_to_end(end)
        else:
            self._move_to(end)
        return name

    def _fills_message(self, extent: Extent, size: int) -> bool:
        """Whether records are all the rest of a message, whose size says that they are whole.

        Then nothing can be wrong with their number.
        """
        sizes, first = self.sizes, self.place.offset
        if sizes is None or self.lines.is_nested or self.place.variable:
            return False
        if not isinstance(extent, Fill):
            return False
        self.is_at_end = sizes == SizeSet(first, first + size * extent.greatest, size)
        return self.is_at_end

    def _array_count(self, extent: Extent, size: int) -> str:
        if not isinstance(extent, Fill):
            return self._count(extent)
        count, left = self.lines.local("n"), self.lines.local("left")
        self.lines.add(f"{count}, {left} = divmod(len(data) - {self.place.grouped}, {size})")
        self.lines.refuse_if(f"{left} or {count} > {extent.greatest}")
        return count

    def _elements(self, array: Array, size: int, count: str) -> str:
        element = array.element
        if is_pair(element):
            assert isinstance(element, Integer)
            return self._pair_elements(element, count)
        code = array_code(array)
        if code is not None:
            return f"list({self._unpack_array(code, array, count)})"
        if isinstance(element, Struct):
            return self._struct_elements(element, size, count)
        code = code_of(element)
        if code is None:
            return self._array_of_varying(array, count)
        return self._converted_elements(code, array, count)

    def _unpack_array(self, code: str, array: Array, count: str) -> str:
        order = order_of(array.element) or "<"
        if isinstance(array.extent, Fixed):
            layout = f"{order}{array.extent.count}{code}"
            if code.endswith("s"):
                layout = order + code * array.extent.count
            expression = f'_struct.Struct("{layout}").unpack_from'
            unpack = self.lines.constants.named("UNPACK", expression)
            return f"{unpack}(data, {self.place.text})"
        layout = f'f"{order}{{{count}}}{code}"'
        if code.endswith("s"):
            layout = f'"{order}" + "{code}" * {count}'
        return f"_struct.unpack_from({layout}, data, {self.place.text})"

    def _pair_elements(self, element: Integer, count: str) -> str:
        values = self.lines.local()
        start = self.place.text
        arguments = f'{element.bits}, {element.signed}, "{element.byte_order}"'
        unpack = self.lines.constants.named("PAIR_LIST", f"_fast.PairLists({arguments}).decode")
        end = f"{start} + 2 * {count}"
        if count.isdigit() and not self.place.variable:
            end = str(self.place.offset + 2 * int(count))
        self.lines.add(f"{values} = {unpack}(data[{start} : {end}])")
        self.lines.refuse_if(f"len({values}) != {count}")
        return self._named_elements(values, element)

    def _named_elements(self, values: str, element: Integer) -> str:
        if not is_named(element):
            return values
        return f"[{self._named('value', element)} for value in {values}]"

    def _struct_elements(self, element: Struct, size: int, count: str) -> str:
        outer = "".join(f", {self.raw[name]}" for name in outer_names(element))
        start = self.place.text
        stop = f"{start} + {size} * {count}"
        if goes_together(element.fields):
            data = self.lines.local("data")
            self.lines.add(f"{data} = data[{start} : {start} + {size} * {count}]")
            self.lines.refuse_if(f"len({data}) != {size} * {count}")
            return self._elements_together(element, data)
        call = f"_read_{element.name}(data, place{outer})"
        places = self.lines.local("places")
        self.lines.add(f"{places} = range({start}, {stop}, {size})")
        return f"[{call} for place in {places}]"

    def _elements_together(self, element: Struct, data: str) -> str:
        """The elements whose bytes an expression gives, each read by one `struct`."""
        values, item = self.lines.local(), self.lines.local("s")
        self.lines.add(f"{values}: list[_typing.Any] = []")
        outside, self._run, raw = self._run, _Run(), dict(self.raw)
        for field_ in element.fields:
            self._field(f"{item}.{field_.name}", field_)
        run, self._run, self.raw = self._run, outside, raw
        layout = f'_struct.Struct("{run.order or "<"}{run.codes}").iter_unpack'
        unpack = self.lines.constants.named("ITERATE", layout)
        names = [self.lines.local() if "." in name else name for name in run.variables]
        with self.lines.block(f"for {tuple_of(names)[1:-1]} in {unpack}({data}):"):
            self.lines.add(f"{item} = _new({class_name(element.name)})")
            for name, variable in zip(names, run.variables, strict=True):
                if "." in variable:
                    self.lines.add(f"{variable} = {name}")
            for target, variable, type_, field_or_none in run.after:
                self.lines.add(f"{target} = {self._converted(variable, type_)}")
                self._constant(target, field_or_none)
            self.lines.add(f"{values}.append({item})")
        return values

    def _converted_elements(self, code: str, array: Array, count: str) -> str:
        values, value = self.lines.local(), self.lines.local()
        unpacked = self._unpack_array(code, array, count)
        if self._is_seen(array.element):
            return f"list({unpacked})"
        self.lines.add(f"{values}: list[_typing.Any] = []")
        with self.lines.block(f"for {value} in {unpacked}:"):
            self.lines.add(f"{values}.append({self._converted(value, array.element)})")
        return values

    def _is_seen(self, type_: Type) -> bool:
        """Whether a byte is the value itself, now that its top bit was seen to be clear."""
        return (
            isinstance(type_, Integer)
            and (self.is_ascii, type_.bits, type_.size, type_.signed) == (True, 7, 1, False)
            and type_.role != "bool"
            and not is_named(type_)
        )

    def _array_of_varying(self, array: Array, count: str | None = None) -> str:
        """Elements one by one, each from where the one before ended."""
        values = self.lines.local()
        self.lines.add(f"{values}: list[_typing.Any] = []")
        outside = self.place.text
        if isinstance(array.extent, Fill) and count is None:
            self._move_to(outside)
            head = f"while {self.place.text} < len(data):"
        else:
            number = self._count(array.extent) if count is None else count
            self._move_to(outside)
            head = f"for _ in range({number}):"
        at = self.place.text
        with self.lines.block(head):
            before = self.lines.local("before")
            if isinstance(array.extent, Fill):
                self.lines.add(f"{before} = {at}")
            self.lines.add(f"{values}.append({self._value(array.element)})")
            self._move_to(self.place.text)
            if isinstance(array.extent, Fill):
                self.lines.refuse_if(f"{at} == {before}")
            assert self.place.text == at
        if isinstance(array.extent, Fill):
            self.lines.refuse_if(f"len({values}) > {array.extent.greatest}")
        return values
