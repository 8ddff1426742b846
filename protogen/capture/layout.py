"""Lays out rows as a C compiler lays out structs: each member at the next multiple of its size."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence

from protogen.capture.schema import (
    CaptureSchema,
    Choice,
    Column,
    Dimension,
    Number,
    Record,
    Shape,
    TableSchema,
    Text,
)
from protogen.copying import replace
from protogen.model.frame import CounterPart, IdentityPart, NumberPart, ValuePart
from protogen.model.messages import Message
from protogen.model.protocol import Protocol, Sender
from protogen.model.types import (
    Array,
    Counted,
    Extent,
    Field,
    Fill,
    Float,
    Integer,
    Octets,
    Struct,
    Switch,
    Type,
    count_name,
    counting_bits,
)
from protogen.model.types import Text as TextType

_BYTE = Number("u1", 1)
_WORD = Number("u4", 4)
_LONG = Number("u8", 8)


def capture_schema(protocol: Protocol, sender: Sender) -> CaptureSchema:
    """The tables of what `sender` sends."""
    parts = shown_parts(sender)
    head = [
        Column(name="offset", role="offset", source="offset", shape=_LONG),
        Column(name="sequence", role="sequence", source="sequence", shape=_LONG),
        Column(name="size", role="size", source="size", shape=_WORD),
    ]
    framed = [*head, *_parts(parts, [item.name for item in head])]
    payload = [
        _place("payload_offset", _LONG, framed),
        _place("payload_size", _WORD, framed),
    ]
    reason = Column(name="reason", role="reason", source="reason", shape=_BYTE)
    return CaptureSchema(
        protocol=protocol.name,
        sender=sender.name,
        spec_hash=protocol.spec_hash,
        messages={item.name: _table(framed, item) for item in sender.received},
        invalid=TableSchema(row=record([*head, reason])),
        unknown=TableSchema(row=record([*framed, *payload])),
    )


def shown_parts(sender: Sender) -> tuple[NumberPart, ...]:
    """The parts of a frame that events show."""
    kinds = IdentityPart | CounterPart | ValuePart
    return tuple(part for part in sender.frame.parts if isinstance(part, kinds))


def _parts(parts: Iterable[NumberPart], taken: Sequence[str]) -> Iterator[Column]:
    for part in parts:
        name = _free(part.name, taken)
        yield Column(name=name, role="part", source=part.name, shape=_number(part.type), part=part)


def _place(name: str, shape: Number, others: Iterable[Column]) -> Column:
    found = _free(name, [item.name for item in others])
    return Column(name=found, role="payload", source=name, shape=shape)


def _table(framed: Sequence[Column], message: Message) -> TableSchema:
    inner = message_record(message)
    base = record(framed)
    start = _aligned(_end(base.columns), inner.alignment)
    taken = [item.name for item in framed]
    renamed = {item.name: _free(item.name, taken) for item in inner.columns}
    fields = [
        replace(
            _counted_anew(item, renamed), name=renamed[item.name], position=start + item.position
        )
        for item in inner.columns
    ]
    alignment = max(base.alignment, inner.alignment)
    size = _aligned(start + inner.size, alignment)
    return TableSchema(row=Record((*base.columns, *fields), size, alignment), message=message)


def message_record(message: Message) -> Record:
    """The message's own columns, under the names that the schema and C give them."""
    return record(_columns(message.fields, {}))


def _counted_anew(column: Column, renamed: dict[str, str]) -> Column:
    """The column, where what counts or selects in it has got another name.

    Only the message's own columns get other names; what lies deeper finds them by these.
    """
    if all(old == new for old, new in renamed.items()):
        return column
    dimensions = tuple(
        replace(item, counted_by=renamed.get(item.counted_by or "", item.counted_by))
        for item in column.dimensions
    )
    return replace(column, dimensions=dimensions, shape=_chosen_anew(column.shape, renamed))


def _chosen_anew(shape: Shape, renamed: dict[str, str]) -> Shape:
    match shape:
        case Record(columns=columns):
            inside, found = dict(renamed), []
            for item in columns:
                found.append(_counted_anew(item, inside))
                inside.pop(item.name, None)  # What is behind it finds this one.
            return replace(shape, columns=tuple(found))
        case Choice(selector=str(selector)):
            cases = tuple((value, _counted_anew(case, renamed)) for value, case in shape.cases)
            return replace(shape, selector=renamed.get(selector, selector), cases=cases)
        case _:
            return shape


def _free(name: str, taken: Sequence[str]) -> str:
    while name in taken:
        name += "_"
    return name


# --- fields ---------------------------------------------------------------------------------------


Constants = dict[str, int]
"""The fields in front that are constant integers. They may count or select, and have no column."""


def _columns(fields: Sequence[Field], around: Constants) -> Iterator[Column]:
    constants = dict(around)
    for field in fields:
        counter = _counter(fields, field)
        if counter is not None:
            yield counter
        if field.is_stored:
            by = None if counter is None else counter.name
            yield _column(field.type, field.name, field, constants, by)
        value = field.constant_number
        constants.pop(field.name, None)
        if value is not None:
            constants[field.name] = value


def _counter(fields: Sequence[Field], field: Field) -> Column | None:
    extent = field.type.extent
    if extent is None or not field.fills:
        return None
    return Column(
        name=count_name(fields, field),
        role="count",
        source=field.name,
        shape=_counting(extent.room),
        field=field,
    )


def _column(
    type_: Type, name: str, field: Field, constants: Constants, filled_by: str | None = None
) -> Column:
    dimensions: list[Dimension] = []
    while isinstance(type_, Array):
        dimensions.append(_dimension(type_.extent, constants, filled_by))
        type_, filled_by = type_.element, None
    if isinstance(type_, TextType | Octets):
        dimensions.append(_dimension(type_.extent, constants, filled_by))
    return Column(
        name=name,
        role="field",
        source=name,
        shape=_shape(type_, field, constants),
        dimensions=tuple(dimensions),
        field=field,
    )


def _dimension(extent: Extent, constants: Constants, filled_by: str | None) -> Dimension:
    """C has no empty arrays, so there is room for one element at least."""
    capacity = max(1, extent.room)
    match extent:
        case Counted(field=name) if name not in constants:
            return Dimension(capacity, name)
        case Fill():
            return Dimension(capacity, filled_by)
        case _:
            return Dimension(capacity)


def _shape(type_: Type, field: Field, constants: Constants) -> Shape:
    match type_:
        case Integer():
            return _number(type_)
        case Float(bits=bits):
            return Number(f"f{bits // 8}", bits // 8)
        case TextType(extent=extent):
            return Text(max(1, extent.room))
        case Octets():
            return _BYTE
        case Struct(fields=fields):
            return record(_columns(fields, constants))
        case Switch():
            return _choice(type_, field, constants)
        case Array():
            raise AssertionError("an array is a dimension")


def _number(type_: Integer) -> Number:
    if type_.role == "bool":
        return Number("?", 1)
    size = type_.width // 8
    return Number(f"{'i' if type_.signed else 'u'}{size}", size)


def _counting(greatest: int) -> Number:
    size = counting_bits(greatest) // 8
    return Number(f"u{size}", size)


def _choice(switch: Switch, field: Field, constants: Constants) -> Choice:
    cases = tuple(
        (case.value, _column(case.type, case.name, field, constants))
        for case in switch.cases
        if case.type.holds_values
    )
    empty = tuple(case.value for case in switch.cases if not case.type.holds_values)
    rest = None if switch.rest is None else _rest(switch, switch.rest, field)
    every = [column for _, column in cases] + ([] if rest is None else [rest])
    alignment = max(item.shape.alignment for item in every)
    size = _aligned(max(item.size for item in every), alignment)
    selector = constants.get(switch.selector, switch.selector)
    return Choice(selector, cases, empty, rest, size, alignment)


def _rest(switch: Switch, greatest: int, field: Field) -> Column:
    size = Column(name="size", role="count", source="bytes", shape=_counting(greatest))
    held = Column(
        name="bytes",
        role="field",
        source="bytes",
        shape=_BYTE,
        dimensions=(Dimension(max(1, greatest), "size"),),
    )
    return Column(
        name=switch.rest_name,
        role="field",
        source=field.name,
        shape=record([size, held]),
        field=field,
    )


def record(columns: Iterable[Column]) -> Record:
    """The struct of these columns. C has no empty structs: without columns it has one byte."""
    placed: list[Column] = []
    for item in columns:
        placed.append(item.at(_aligned(_end(placed), item.shape.alignment)))
    alignment = max((item.shape.alignment for item in placed), default=1)
    return Record(tuple(placed), _aligned(max(1, _end(placed)), alignment), alignment)


def _end(columns: Sequence[Column]) -> int:
    return columns[-1].position + columns[-1].size if columns else 0


def _aligned(size: int, alignment: int) -> int:
    return -(-size // alignment) * alignment
