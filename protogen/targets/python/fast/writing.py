"""Functions that write records: a message becomes the bytes of its payload."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field

from protogen.model.messages import Message
from protogen.model.types import (
    Array,
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
    total,
)
from protogen.targets.python.fast.layout import (
    array_code,
    code_of,
    holds_records,
    is_named,
    is_native,
    is_pair,
    order_of,
    outer_names,
    outside,
)
from protogen.targets.python.fast.lines import Constants, Lines
from protogen.targets.python.formats import constant, is_empty
from protogen.targets.python.literals import number, tuple_of
from protogen.targets.python.spelling import class_name

_GREATEST_FLOAT32 = "3.4028234663852886e38"


def payload_writer(message: Message, lines: Lines) -> None:
    """Check a message `item` and set `payload`.

    What an integer may be, and how great, is left to `struct` wherever it writes the value itself.
    """
    lines.add(f"payload = {_Writer(lines).record('item', message.fields)}")
    if not is_of_one_size(message) and not holds_records(message.fields, message.sizes):
        lines.refuse_if(outside(message.sizes, "payload"))


def is_of_one_size(message: Message) -> bool:
    """Whether its fields can't take more bytes or fewer than a payload may have."""
    return total(message.fields).fixed is not None


def content_writer(
    message: Message, head: Sequence[Packed], integers: Sequence[str], lines: Lines
) -> str:
    """The same for numbers in front of a payload of a fixed size, and the payload.

    `integers` are variables that have to be integers as well.
    """
    writer = _Writer(lines)
    writer.begin(head, integers)
    return writer.record("item", message.fields)


_CODES = "BYTE_CODES"


@dataclass(frozen=True, slots=True)
class Packed:
    """A value for `struct`: the order of its bytes, its code, and an expression."""

    order: str
    code: str
    value: str


def struct_writer(struct: Struct, constants: Constants) -> tuple[str, ...]:
    """The body of `_write_NAME(item, OUTER...)`; OUTER are raw values of fields in front."""
    writer = _Writer(Lines(constants))
    writer.raw = {name: f"{name}_" for name in outer_names(struct)}
    writer.lines.refuse_if(f"type(item) is not {class_name(struct.name)}")
    writer.lines.add(f"return {writer.record('item', struct.fields)}")
    return writer.lines.text


def _are_plain(fields: tuple[Field, ...]) -> bool:
    """Whether all fields are integers that `struct` writes as they are."""
    orders = {order_of(item.type) for item in fields} - {""}
    return bool(fields) and len(orders) < 2 and all(map(_is_plain, fields))


def _is_plain(item: Field) -> bool:
    type_ = item.type
    if not isinstance(type_, Integer) or not is_native(type_):
        return False
    is_closed = type_.enum is not None and type_.enum.closed
    return not item.ranged and item.const is None and not is_closed


def _is_narrow(type_: Integer) -> bool:
    """Whether `struct` writes the value, but as one that may be greater."""
    return type_.size == 1 and not type_.signed and not is_native(type_) and type_.role != "bool"


def _is_looked_up(type_: Integer) -> bool:
    """Whether a list has the bytes of each value."""
    is_byte = type_.size == 1 and not is_native(type_) and not _is_narrow(type_)
    return type_.role != "bool" and (is_pair(type_) or is_byte)


def _is_bounded(item: Field) -> bool:
    """Whether being in the declared range is being in the type's."""
    return item.ranged and None not in (item.least, item.greatest) and not item.special


_SEVEN = 7
_TYPES_IN_LINE = 6


def batched(names: list[str]) -> list[list[str]]:
    """As many names as a line has room for."""
    return [names[i : i + _TYPES_IN_LINE] for i in range(0, len(names), _TYPES_IN_LINE)]


@dataclass(slots=True)
class _Bytes:
    """Bytes that are being put together: what stands, and values that one `struct` is to write."""

    pieces: list[str] = field(default_factory=list)
    order: str = ""
    codes: str = ""
    values: list[str] = field(default_factory=list)
    integers: list[str] = field(default_factory=list)
    """Variables that have to be integers, and that `struct` does not get to see."""


class _Writer:
    """Writes the body of one function."""

    def __init__(self, lines: Lines) -> None:
        self.lines = lines
        self.raw: dict[str, str] = {}
        """Raw values of the fields in front, by name."""
        self._bytes = _Bytes()

    def begin(self, head: Sequence[Packed], integers: Sequence[str]) -> None:
        """Numbers that stand in front, and variables that have to be integers."""
        self._bytes.integers += integers
        for item in head:
            self._pack(item)

    def record(self, source: str, fields: tuple[Field, ...]) -> str:
        """Check the fields of `source`; the expression of their bytes."""
        self._fields(source, fields)
        return self._joined()

    def _fields(self, source: str, fields: tuple[Field, ...]) -> None:
        outside = dict(self.raw)
        for item in fields:
            value = self.lines.local()
            self.lines.add(f"{value} = {source}.{item.name}")
            if isinstance(item.type, Integer):
                self.raw[item.name] = value
            self._value(value, item.type, item)
            if item.const is not None:
                self.lines.refuse_if(f"{value} != {constant(item)}")
        self.raw = outside

    def _joined(self) -> str:
        """All bytes as one expression."""
        self._flush()
        pieces = self._bytes.pieces
        if len(pieces) == 1:
            return pieces[0]
        return f'b"".join({tuple_of(pieces)})' if pieces else 'b""'

    def _apart(self, value: str, type_: Type, item: Field | None) -> str:
        """The bytes of a value that are put together by themselves."""
        outside, self._bytes = self._bytes, _Bytes()
        self._value(value, type_, item)
        joined = self._joined()
        self._bytes = outside
        return joined

    def _piece(self, expression: str) -> None:
        self._flush()
        self._bytes.pieces.append(expression)

    def _put(self, type_: Type, expression: str) -> None:
        """Let `struct` write a value together with its neighbours."""
        code = code_of(type_)
        assert code is not None
        if isinstance(type_, Integer) and _is_narrow(type_) and type_.bits == _SEVEN:
            code = "b"  # Which has no number above 127.
        self._pack(Packed(order_of(type_), code, expression))

    def _pack(self, item: Packed) -> None:
        if item.order and self._bytes.order and item.order != self._bytes.order:
            self._flush()
        self._bytes.order = self._bytes.order or item.order
        self._bytes.codes += item.code
        self._bytes.values.append(item.value)

    def _flush(self) -> None:
        """Write the values that are due."""
        due = self._bytes
        if due.integers:
            for some in batched(due.integers):
                types = " is ".join(f"type({name})" for name in some)
                several = len(some) > 1
                self.lines.refuse_if(f"not ({types} is int)" if several else f"{types} is not int")
        if due.codes:
            layout = f'"{due.order or "<"}{due.codes}"'
            pack = self.lines.constants.named("PACK", f"_struct.Struct({layout}).pack")
            due.pieces.append(f"{pack}({', '.join(due.values)})")
        self._bytes = _Bytes(due.pieces)

    # --- values -----------------------------------------------------------------------------------

    def _value(self, value: str, type_: Type, item: Field | None) -> None:
        """Check a value and write it; `item` says what it may be."""
        match type_:
            case Integer():
                self._integer(value, type_, item)
            case Float():
                self._float(value, type_, item)
            case Text():
                self._text(value, type_)
            case Octets():
                self._octets(value, type_)
            case Struct():
                self.lines.refuse_if(f"type({value}) is not {class_name(type_.name)}")
                self._fields(value, type_.fields)
            case Array():
                self._array(value, type_, item)
            case Switch():
                self._switch(value, type_)

    def _integer(self, value: str, type_: Integer, item: Field | None) -> None:
        if type_.role == "bool":
            self.lines.refuse_if(f"type({value}) is not bool")
        elif not is_native(type_) and not _is_narrow(type_) and not _is_looked_up(type_):
            self._unseen(value, type_)
        if type_.enum is not None and type_.enum.closed:
            members = f"frozenset(map(int, {class_name(type_.enum.name)}))"
            self.lines.refuse_if(f"{value} not in {self.lines.constants.named('VALUES', members)}")
        self._in_range(value, item)
        if _is_looked_up(type_) and (item is None or not _is_bounded(item)):
            # Nothing but an integer is an index of a list, but -1 is that of the last element.
            self.lines.refuse_if(f"{value} < {type_.least} or {value} > {type_.greatest}")
        self._put(type_, self._coded(value, type_))

    def _unseen(self, value: str, type_: Integer) -> None:
        """See to it that a value is an integer where neither `struct` nor a list does."""
        named = type_.enum or type_.flags
        if named is None:
            self._bytes.integers.append(value)
            return
        name = class_name(named.name)
        self.lines.refuse_if(f"type({value}) is not int and type({value}) is not {name}")

    def _in_range(self, value: str, item: Field | None) -> None:
        if item is None or not item.ranged or item.least is None or item.greatest is None:
            return
        allowed = f"not {number(item.least)} <= {value} <= {number(item.greatest)}"
        if item.special:
            special = tuple_of(str(named.value) for named in item.special)
            allowed += f" and {value} not in {special}"
        self.lines.refuse_if(allowed)

    def _coded(self, value: str, type_: Integer) -> str:
        """What `struct` is given for an integer."""
        if is_native(type_) or type_.role == "bool":
            return value
        if _is_looked_up(type_):
            kind = "codes" if is_pair(type_) else "narrow"
            codes = f"_CODES.{kind}({type_.bits})"
            return f"{self.lines.constants.named(_CODES, codes)}[{value}]"
        code = code_of(type_)
        assert code is not None
        if code.endswith("s"):
            return f"{self.lines.constants.number(type_)}.encode({value})"
        if _is_narrow(type_):
            self._in_narrow(value, type_)
            return value
        self.lines.refuse_if(f"not {type_.least} <= {value} <= {type_.greatest}")
        return f"{value} & 0x{(1 << type_.bits) - 1:X}" if type_.signed else value

    def _in_narrow(self, value: str, type_: Integer) -> None:
        """Check a value that fewer than 8 bits have to hold; `struct` sees that 7 are enough."""
        if type_.bits == _SEVEN:
            self.lines.refuse_if(f"{value} < 0")
        else:
            self.lines.refuse_if(f"not 0 <= {value} <= {type_.greatest}")

    def _float(self, value: str, type_: Float, item: Field | None) -> None:
        self.lines.refuse_if(f"type({value}) is not float")
        if type_.bits == 32:
            self.lines.refuse_if(f"not -{_GREATEST_FLOAT32} <= {value} <= {_GREATEST_FLOAT32}")
        self._in_range(value, item)
        if item is not None and item.const is not None:
            value = constant(item)  # Which equals the value, but may be the other zero.
        if type_.byte_bits == 7:
            call = f'_fast.seven_bit_float({type_.bits}, "{type_.byte_order}")'
            value = f"{self.lines.constants.named('FLOAT', call)}.encode({value})"
        self._put(type_, value)

    def _text(self, value: str, type_: Text) -> None:
        data = self.lines.local()
        self.lines.add(f'{data} = {value}.encode("ascii")')
        if isinstance(type_.extent, Fixed):
            padded = f'len({data}) > {type_.extent.count} or {data}.endswith(b"\\0")'
            self.lines.refuse_if(padded)
            self._put(type_, data)
        else:
            self._counted(data, type_.extent)
            self._piece(data)

    def _octets(self, value: str, type_: Octets) -> None:
        self.lines.refuse_if(f"type({value}) is not bytes")
        self._counted(value, type_.extent)
        if type_.byte_bits == 7:
            self.lines.refuse_if(f"not {value}.isascii()")
        if isinstance(type_.extent, Fixed):
            self._put(type_, value)
        else:
            self._piece(value)

    def _counted(self, value: str, extent: Extent) -> None:
        """Check a number of bytes or elements."""
        match extent:
            case Fixed():
                self.lines.refuse_if(f"len({value}) != {extent.count}")
            case Fill():
                self.lines.refuse_if(f"len({value}) > {extent.greatest}")
            case Counted():
                self.lines.refuse_if(f"len({value}) != {self.raw[extent.field]}")
                if extent.stated:
                    self.lines.refuse_if(f"not {extent.least} <= len({value}) <= {extent.greatest}")

    def _switch(self, value: str, switch: Switch) -> None:
        self._flush()
        data = self.lines.local("case")
        selector = self.raw[switch.selector]
        word = "if"
        empty = [str(case.value) for case in switch.cases if is_empty(case.type)]
        if empty:
            with self.lines.block(f"{word} {selector} in {tuple_of(empty)}:"):
                self.lines.refuse_if(f"{value} is not None")
                self.lines.add(f'{data} = b""')
            word = "elif"
        for case in switch.cases:
            if is_empty(case.type):
                continue
            with self.lines.block(f"{word} {selector} == {case.value}:"):
                self.lines.add(f"{data} = {self._apart(value, case.type, None)}")
            word = "elif"
        with self.lines.block("else:"):
            if switch.rest is None:
                self.lines.add("raise _fast.Unclear")
            else:
                rest = Octets(extent=Fill(greatest=switch.rest), byte_bits=switch.byte_bits)
                self.lines.add(f"{data} = {self._apart(value, rest, None)}")
        self._piece(data)

    # --- arrays -----------------------------------------------------------------------------------

    def _array(self, value: str, array: Array, item: Field | None) -> None:
        self.lines.refuse_if(f"type({value}) is not list")
        self._counted(value, array.extent)
        element = array.element
        if isinstance(element, Struct) and _are_plain(element.fields):
            self._plain_records(value, element)
        elif isinstance(element, Struct):
            outer = "".join(f", {self.raw[name]}" for name in outer_names(element))
            self._flush()
            data = self.lines.local()
            written = f"_write_{element.name}(each{outer})"
            self.lines.add(f'{data} = b"".join([{written} for each in {value}])')
            self._piece(data)
        elif is_pair(element) and isinstance(element, Integer) and not is_named(element):
            self._all_in_range(value, item)
            arguments = f'{element.bits}, {element.signed}, "{element.byte_order}"'
            encode = f"_fast.PairLists({arguments}).encode"
            self._piece(f"{self.lines.constants.named('PAIR_LIST', encode)}({value})")
        elif array_code(array) is not None and isinstance(element, Integer):
            self._all_in_range(value, item)
            self._piece(self._packed(value, array))
        else:
            self._one_by_one(value, element, item)

    def _plain_records(self, value: str, element: Struct) -> None:
        """Records of integers, written together with what stands in front of them."""
        codes = "".join(str(code_of(item.type)) for item in element.fields)
        order = next((order_of(item.type) for item in element.fields if order_of(item.type)), "")
        if self._bytes.order and order and self._bytes.order != order:
            self._flush()
        due = self._bytes
        front = (due.order or order or "<") + due.codes
        packers = self.lines.constants.named("PACKERS", f'_fast.Packers("{front}", "{codes}")')
        values = self.lines.local("values")
        # All that `struct` is given, whatever it is: what is no integer it refuses.
        self.lines.add(f"{values}: list[_typing.Any] = [{', '.join(due.values)}]")
        with self.lines.block(f"for each in {value}:"):
            self.lines.refuse_if(f"type(each) is not {class_name(element.name)}")
            numbers = tuple_of(f"each.{item.name}" for item in element.fields)
            self.lines.add(f"{values} += {numbers}")
        due.codes = ""
        self._piece(f"{packers}[len({value})](*{values})")

    def _all_in_range(self, value: str, item: Field | None) -> None:
        if item is None or not item.ranged or item.least is None or item.greatest is None:
            return
        allowed = f"{number(item.least)} <= each <= {number(item.greatest)}"
        if item.special:
            allowed += f" or each in {tuple_of(str(named.value) for named in item.special)}"
        self.lines.refuse_if(f"not all({allowed} for each in {value})")

    def _packed(self, value: str, array: Array) -> str:
        code, order = array_code(array), order_of(array.element) or "<"
        if isinstance(array.extent, Fixed):
            layout = f'"{order}{array.extent.count}{code}"'
            pack = self.lines.constants.named("PACK", f"_struct.Struct({layout}).pack")
            return f"{pack}(*{value})"
        return f'_struct.pack(f"{order}{{len({value})}}{code}", *{value})'

    def _one_by_one(self, value: str, element: Type, item: Field | None) -> None:
        self._flush()
        data, each = self.lines.local(), self.lines.local("each")
        self.lines.add(f"{data}: list[bytes] = []")
        with self.lines.block(f"for {each} in {value}:"):
            self.lines.add(f"{data}.append({self._apart(each, element, item)})")
        self._piece(f'b"".join({data})')
