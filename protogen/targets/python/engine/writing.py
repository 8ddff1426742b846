"""Functions that write records: a message becomes the bytes of its payload."""

from __future__ import annotations

from collections.abc import Sequence
from functools import partial

from protogen.model.expressions import plain_name
from protogen.model.messages import Message
from protogen.model.packing import FilledPacking, Packing
from protogen.model.payload_builder import plan_of
from protogen.model.payload_plan import (
    AnyStep,
    BytesStep,
    ChooseStep,
    ConditionalPresence,
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
    TrailingPresence,
)
from protogen.model.payload_walks import without_constant
from protogen.model.types import Between, Field, Struct, Text, is_text
from protogen.runtime.attributes import attribute
from protogen.targets.python.engine.layout import (
    array_code,
    code_of,
    common_order,
    holds_records,
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
from protogen.targets.python.engine.packing import Record, packed, packed_fill, packed_record
from protogen.targets.python.engine.raw import Raw, member_of
from protogen.targets.python.engine.struct_calls import Packed, Packer
from protogen.targets.python.formats import constant
from protogen.targets.python.formulas import in_integers
from protogen.targets.python.literals import number, octets_in_class, tuple_of

_GREATEST_FLOAT32 = "3.4028234663852886e38"


def payload_writer(message: Message, lines: Lines) -> None:
    """Check a message `item` and set `payload`.

    What an integer may be, and how great, is left to `struct` wherever it writes the value itself.
    """
    lines.add(f"payload = {_Writer(lines).record('item', message.plan.steps)}")
    if not is_of_one_size(message) and not holds_records(message.plan.steps, message.sizes):
        lines.refuse_if(outside(message.sizes, "payload"))


def is_of_one_size(message: Message) -> bool:
    """True if its fields can't take more bytes or fewer than a payload may have."""
    return message.plan.sizes.fixed is not None


def content_writer(
    message: Message, head: Sequence[Packed], integers: Sequence[str], lines: Lines
) -> str:
    """The same for numbers in front of a payload of a fixed size, and the payload.

    `integers` are variables that have to be integers as well.
    """
    writer = _Writer(lines)
    writer.begin(head, integers)
    return writer.record("item", message.plan.steps)


_SEVEN = 7
_CODES = "BYTE_CODES"


def struct_writer(struct: Struct, constants: Constants) -> tuple[str, ...]:
    """The body of `_write_NAME(item, OUTER...)`; OUTER are raw values of fields in front."""
    writer = _Writer(Lines(constants))
    writer.raw = outer_parameters(struct)
    if struct.packed is not None:
        data = packed_record(writer.lines, "item", Record.of_struct(struct))
        writer.lines.add(f"return {data}")
        return writer.lines.text
    writer.lines.refuse_if(f"type(item) is not {constants.classes[struct.name]}")
    writer.lines.add(f"return {writer.record('item', plan_of(struct.fields).steps)}")
    return writer.lines.text


def _are_plain(steps: Sequence[AnyStep]) -> bool:
    """True if all steps are integers that `struct` writes as they are."""
    return common_order(steps) is not None and all(map(_is_plain, steps))


def _is_plain(step: AnyStep) -> bool:
    if not isinstance(step, IntegerStep) or not is_native(step):
        return False
    return not step.field.ranged and not step.type.is_closed


def _is_narrow(step: IntegerStep) -> bool:
    """True if `struct` writes the value, but as one that may be greater."""
    type_ = step.type
    is_byte = type_.size == 1 and not type_.signed and not is_text(type_)
    return is_byte and not is_native(step) and type_.role != "bool"


def _is_looked_up(step: IntegerStep) -> bool:
    """True if a list has the bytes of each value."""
    is_byte = step.type.size == 1 and not is_native(step) and not _is_narrow(step)
    is_byte = is_byte and not is_text(step.type)
    return step.type.role != "bool" and (is_pair(step) or is_byte)


def _has_front(step: OptionalStep) -> bool:
    """True if the step is there only where the one in front is, too."""
    return isinstance(step.presence, TrailingPresence) and bool(step.presence.behind)


def _is_bounded(item: Field) -> bool:
    """True if being in the declared range is being in the type's."""
    return item.ranged and None not in (item.least, item.greatest) and not item.special


class _Writer(Raw):
    """Writes the body of one function."""

    def __init__(self, lines: Lines) -> None:
        super().__init__()
        self.lines = lines
        self._bytes = Packer(lines)

    def begin(self, head: Sequence[Packed], integers: Sequence[str]) -> None:
        """Numbers that stand in front, and variables that have to be integers."""
        self._bytes.integers += integers
        for item in head:
            self._bytes.pack(item)

    def record(self, source: str, steps: Sequence[AnyStep]) -> str:
        """Check the fields of `source`; the expression of their bytes."""
        self._fields(source, steps)
        return self._joined()

    def _fields(self, source: str, steps: Sequence[AnyStep]) -> None:
        outside, front = dict(self.raw), ""
        for step in steps:
            value = self.lines.local()
            self.lines.add(f"{value} = {source}.{attribute(step.name)}")
            if isinstance(step, OptionalStep) and _has_front(step):
                self.lines.refuse_if(f"{front} is None and {value} is not None")
            front = value
            bare = without_constant(step)
            inner = bare.step if isinstance(bare, RegionStep) else bare
            if isinstance(inner, IntegerStep | RecordStep):
                self.raw[step.name] = value
            self._value(value, bare, step.field)
            if isinstance(step, ConstantStep):
                self.lines.refuse_if(f"{value} != {constant(step.field)}")
        self.raw = outside

    def _joined(self) -> str:
        """All bytes as one expression."""
        pieces = self._bytes.all_pieces()
        if len(pieces) == 1:
            return pieces[0]
        return f'b"".join({tuple_of(pieces)})' if pieces else 'b""'

    def _apart(self, value: str, step: AnyStep, item: Field | None) -> str:
        """The bytes of a value that are put together by themselves."""
        outside, self._bytes = self._bytes, Packer(self.lines)
        self._value(value, step, item)
        joined = self._joined()
        self._bytes = outside
        return joined

    def _put(self, step: AnyStep, expression: str) -> None:
        """Let `struct` write a value together with its neighbours."""
        code = code_of(step)
        assert code is not None
        if isinstance(step, IntegerStep) and _is_narrow(step) and step.type.bits == _SEVEN:
            code = "b"  # Which has no number above 127.
        self._bytes.pack(Packed(order_of(step), code, expression))

    # --- values -----------------------------------------------------------------------------------

    def _value(self, value: str, step: AnyStep, item: Field | None) -> None:
        """Check a value and write it; `item` says what it may be."""
        match step:
            case IntegerStep():
                self._integer(value, step, item)
            case FloatStep():
                self._float(value, step, item)
            case BytesStep():
                if isinstance(step.type, Text):
                    self._text(value, step)
                else:
                    self._octets(value, step)
            case RecordStep() | RepeatStep() if isinstance(step.packing, Packing):
                self._put(step, packed(self.lines, value, step))
            case RecordStep():
                self.lines.refuse_if(f"type({value}) is not {self.lines.classes[step.type.name]}")
                self._fields(value, step.steps)
            case RepeatStep():
                self._array(value, step, item)
            case ChooseStep():
                self._choose(value, step)
            case OptionalStep() | RegionStep():
                self._held(value, step)

    def _integer(self, value: str, step: IntegerStep, item: Field | None) -> None:
        type_ = step.type
        if type_.role == "bool":
            self.lines.refuse_if(f"type({value}) is not bool")
        elif not is_native(step) and not _is_narrow(step) and not _is_looked_up(step):
            self._unseen(value, step)
        if type_.enum is not None and type_.is_closed:
            members = f"frozenset(map(int, {self.lines.classes[type_.enum.name]}))"
            self.lines.refuse_if(f"{value} not in {self.lines.constants.named('VALUES', members)}")
        self._in_range(value, item)
        if _is_looked_up(step) and (item is None or not _is_bounded(item)):
            # Nothing but an integer is an index of a list, but -1 is that of the last element.
            self.lines.refuse_if(f"{value} < {type_.least} or {value} > {type_.greatest}")
        if type_.is_free:
            encode = f"{self.lines.constants.number(type_)}.encode({value})"
            self._bytes.piece(encode)
        else:
            self._put(step, self._coded(value, step))

    def _unseen(self, value: str, step: IntegerStep) -> None:
        """See to it that a value is an integer where neither `struct` nor a list does."""
        type_ = step.type
        named = type_.enum or type_.flags
        if named is None:
            self._bytes.integers.append(value)
            return
        name = self.lines.classes[named.name]
        self.lines.refuse_if(f"type({value}) is not int and type({value}) is not {name}")

    def _in_range(self, value: str, item: Field | None) -> None:
        if item is None or not item.ranged or item.least is None or item.greatest is None:
            return
        allowed = f"not {number(item.least)} <= {value} <= {number(item.greatest)}"
        if item.special:
            special = tuple_of(str(named.value) for named in item.special)
            allowed += f" and {value} not in {special}"
        self.lines.refuse_if(allowed)

    def _coded(self, value: str, step: IntegerStep) -> str:
        """The value that `struct` is given for an integer."""
        type_ = step.type
        if is_native(step) or type_.role == "bool":
            return value
        if _is_looked_up(step):
            kind = "codes" if is_pair(step) else "narrow"
            codes = f"_CODES.{kind}({type_.bits})"
            return f"{self.lines.constants.named(_CODES, codes)}[{value}]"
        code = code_of(step)
        assert code is not None
        if code.endswith("s"):
            return f"{self.lines.constants.number(type_)}.encode({value})"
        if _is_narrow(step):
            self._in_narrow(value, step)
            return value
        self.lines.refuse_if(f"not {type_.least} <= {value} <= {type_.greatest}")
        return f"{value} & 0x{(1 << type_.bits) - 1:X}" if type_.signed else value

    def _in_narrow(self, value: str, step: IntegerStep) -> None:
        """Check a value that fewer than 8 bits have to hold; `struct` sees that 7 are enough."""
        if step.type.bits == _SEVEN:
            self.lines.refuse_if(f"{value} < 0")
        else:
            self.lines.refuse_if(f"not 0 <= {value} <= {step.type.greatest}")

    def _float(self, value: str, step: FloatStep, item: Field | None) -> None:
        type_ = step.type
        self.lines.refuse_if(f"type({value}) is not float")
        if type_.bits == 32:
            self.lines.refuse_if(f"not -{_GREATEST_FLOAT32} <= {value} <= {_GREATEST_FLOAT32}")
        self._in_range(value, item)
        if item is not None and item.const is not None:
            value = constant(item)  # Which equals the value, but may be the other zero.
        if type_.byte_bits == 7:
            call = f'_fast.seven_bit_float({type_.bits}, "{type_.byte_order}")'
            value = f"{self.lines.constants.named('FLOAT', call)}.encode({value})"
        self._put(step, value)

    def _text(self, value: str, step: BytesStep) -> None:
        if isinstance(step.type, Text) and not step.type.form.is_plain:
            self.lines.refuse_if(f"not {value}.isascii()")
            self._put(step, f"{self.lines.constants.padded(step.type)}.encode({value})")
            return
        data = self.lines.local()
        self.lines.add(f'{data} = {value}.encode("ascii")')
        if step.count.is_fixed:
            padded = f'len({data}) > {step.count.known} or {data}.endswith(b"\\0")'
            self.lines.refuse_if(padded)
            self._put(step, data)
        else:
            self._counted(data, step.count)
            if step.count.between is not None:
                self._between(data, step.count.between)
            self._bytes.piece(data)
            self._end(data, step.count)

    def _between(self, data: str, between: Between) -> None:
        """Refuse other characters than a text can have, and put the separator in front."""
        characters = self.lines.constants.named("CHARACTERS", octets_in_class(between.characters))
        self.lines.refuse_if(f"{data}.translate(None, {characters})")
        if between.leads:
            self._bytes.piece(octets_in_class(bytes((between.separator,))))

    def _octets(self, value: str, step: BytesStep) -> None:
        self.lines.refuse_if(f"type({value}) is not bytes")
        self._counted(value, step.count)
        if step.type.byte_bits == 7:
            self.lines.refuse_if(f"not {value}.isascii()")
        if step.count.is_fixed:
            self._put(step, value)
        else:
            self._bytes.piece(value)
            self._end(value, step.count)

    def _end(self, value: str, count: Count) -> None:
        """Put the terminator, where one ends these bytes, which none of them may be."""
        if count.until is not None:
            end = octets_in_class(bytes((count.until,)))
            self.lines.refuse_if(f"{end} in {value}")
            self._bytes.piece(end)

    def _rest(self, value: str, rest: RestStep) -> None:
        self.lines.refuse_if(f"type({value}) is not bytes")
        self.lines.refuse_if(f"len({value}) > {rest.count.greatest}")
        if rest.can_be_wrong:
            self.lines.refuse_if(f"not {value}.isascii()")

    def _counted(self, value: str, count: Count) -> None:
        """Check a number of bytes or elements."""
        if count.is_fixed:
            self.lines.refuse_if(f"len({value}) != {count.known}")
        elif count.is_delimited:
            self.lines.refuse_if(outside_of(count, f"len({value})"))
        else:
            assert count.expression is not None
            number = in_integers(count.expression, self.raw_of)
            self.lines.refuse_if(f"len({value}) != {number}")
            if count.stated or plain_name(count.expression) is None:
                self.lines.refuse_if(f"not {count.least} <= len({value}) <= {count.greatest}")

    def _choose(self, value: str, step: ChooseStep) -> None:
        self._bytes.flush()
        data = self.lines.local("case")
        selector = in_integers(step.expression, self.raw_of)
        with self.lines.block(f"match {selector}:"):
            for pattern, case in patterns(step):
                with self.lines.block(f"case {pattern}:"):
                    if case is None:
                        self.lines.refuse_if(f"{value} is not None")
                        self.lines.add(f'{data} = b""')
                    else:
                        self.lines.add(f"{data} = {self._apart(value, case.step, None)}")
            if step.rest is not None:
                with self.lines.block("case _:"):
                    self._rest(value, step.rest)
                    self.lines.add(f"{data} = {value}")
            elif step.otherwise is None:
                with self.lines.block("case _:"):
                    self.lines.add("raise _fast.NeedsReference")
        self._bytes.piece(data)

    def _optional(self, value: str, step: OptionalStep) -> None:
        self._bytes.flush()
        data = self.lines.local()
        given = f"{value} is not None"
        match step.presence:
            case ConditionalPresence(expression=expression):
                condition, refused = in_integers(expression, self.raw_of), given
            case TrailingPresence():
                condition, refused = given, ""
        with self.lines.block(f"if {condition}:"):
            bare = without_constant(step.step)
            self.lines.add(f"{data} = {self._apart(value, bare, step.field)}")
            if isinstance(step.step, ConstantStep):
                self.lines.refuse_if(f"{value} != {constant(step.field)}")
        with self.lines.block("else:"):
            if refused:
                self.lines.refuse_if(refused)
            self.lines.add(f'{data} = b""')
        self._bytes.piece(data)

    def _held(self, value: str, step: OptionalStep | RegionStep) -> None:
        if isinstance(step, OptionalStep):
            self._optional(value, step)
        else:
            self._region(value, step)

    def _region(self, value: str, step: RegionStep) -> None:
        self._bytes.flush()
        data = self.lines.local()
        self.lines.add(f"{data} = {self._apart(value, step.step, step.field)}")
        self._counted(data, step.region)
        self._bytes.piece(data)

    # --- arrays -----------------------------------------------------------------------------------

    def _array(self, value: str, step: RepeatStep, item: Field | None) -> None:
        if isinstance(step.packing, FilledPacking):
            self._bytes.piece(packed_fill(self.lines, value, step))
            return
        self.lines.refuse_if(f"type({value}) is not list")
        self._counted(value, step.count)
        element = step.element
        if isinstance(element, RecordStep) and _are_plain(element.steps):
            self._plain_records(value, element)
        elif isinstance(element, RecordStep):
            outer = "".join(f", {self.raw_at(name)}" for name in outer_names(element.type))
            self._bytes.flush()
            data = self.lines.local()
            written = f"_write_{element.type.name}(each{outer})"
            self.lines.add(f'{data} = b"".join([{written} for each in {value}])')
            self._bytes.piece(data)
        elif isinstance(element, IntegerStep) and is_pair(element) and not element.type.is_named:
            self._all_in_range(value, item)
            type_ = element.type
            arguments = f'{type_.bits}, {type_.signed}, "{type_.byte_order}"'
            encode = f"_fast.PairLists({arguments}).encode"
            self._bytes.piece(f"{self.lines.constants.named('PAIR_LIST', encode)}({value})")
        elif array_code(step) is not None and isinstance(element, IntegerStep):
            self._all_in_range(value, item)
            self._bytes.piece(self._packed(value, step))
        else:
            self._one_by_one(value, element, item)
        if step.count.mark is not None:
            self._marked(value, step.count.mark)

    def _marked(self, value: str, mark: Formula) -> None:
        """Refuse elements of which another one than the last says that it is the last."""
        last, each = (
            in_integers(mark.expression, partial(member_of, item))
            for item in (f"{value}[-1]", "each")
        )
        self.lines.refuse_if(f"not ({last}) or any({each} for each in {value}[:-1])")

    def _plain_records(self, value: str, element: RecordStep) -> None:
        """Records of integers, written together with what stands in front of them."""
        codes = "".join(str(code_of(step)) for step in element.steps)
        order = common_order(element.steps)
        if self._bytes.order and order and self._bytes.order != order:
            self._bytes.flush()
        due = self._bytes
        front = (due.order or order or "<") + due.codes
        packers = self.lines.constants.named("PACKERS", f'_fast.Packers("{front}", "{codes}")')
        values = self.lines.local("values")
        # All that `struct` is given, whatever it is: what is no integer it refuses.
        self.lines.add(f"{values}: list[_typing.Any] = [{', '.join(due.values)}]")
        with self.lines.block(f"for each in {value}:"):
            self.lines.refuse_if(f"type(each) is not {self.lines.classes[element.type.name]}")
            numbers = tuple_of(f"each.{attribute(step.name)}" for step in element.steps)
            self.lines.add(f"{values} += {numbers}")
        due.codes = ""
        self._bytes.piece(f"{packers}[len({value})](*{values})")

    def _all_in_range(self, value: str, item: Field | None) -> None:
        if item is None or not item.ranged or item.least is None or item.greatest is None:
            return
        allowed = f"{number(item.least)} <= each <= {number(item.greatest)}"
        if item.special:
            allowed += f" or each in {tuple_of(str(named.value) for named in item.special)}"
        self.lines.refuse_if(f"not all({allowed} for each in {value})")

    def _packed(self, value: str, step: RepeatStep) -> str:
        code, order = array_code(step), order_of(step.element) or "<"
        if step.count.is_fixed:
            layout = f'"{order}{step.count.known}{code}"'
            pack = self.lines.constants.named("PACK", f"_struct.Struct({layout}).pack")
            return f"{pack}(*{value})"
        return f'_struct.pack(f"{order}{{len({value})}}{code}", *{value})'

    def _one_by_one(self, value: str, element: AnyStep, item: Field | None) -> None:
        self._bytes.flush()
        data, each = self.lines.local(), self.lines.local("each")
        self.lines.add(f"{data}: list[bytes] = []")
        with self.lines.block(f"for {each} in {value}:"):
            self.lines.add(f"{data}.append({self._apart(each, element, item)})")
        self._bytes.piece(f'b"".join({data})')
