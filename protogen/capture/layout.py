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
from protogen.model.payload_plan import (
    AnyStep,
    BytesStep,
    ChooseStep,
    Count,
    FloatStep,
    IntegerStep,
    RecordStep,
    RepeatStep,
    RestStep,
)
from protogen.model.protocol import Protocol, Sender
from protogen.model.types import Float, Integer, counting_bits
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
    return record(_columns(message.plan.steps))


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


def _columns(steps: Sequence[AnyStep]) -> Iterator[Column]:
    for step in steps:
        if isinstance(step, BytesStep | RepeatStep) and step.fills:
            yield Column(
                name=step.count.member,
                role="count",
                source=step.name,
                shape=_counting(step.count.greatest),
                field=step.field,
            )
        if step.holds_values:
            yield _column(step)


def _column(step: AnyStep) -> Column:
    dimensions: list[Dimension] = []
    name, element = step.name, step
    while isinstance(element, RepeatStep):
        dimensions.append(_dimension(element.count))
        element = element.element
    if isinstance(element, BytesStep):
        dimensions.append(_dimension(element.count))
    return Column(
        name=name,
        role="field",
        source=name,
        shape=_shape(element),
        dimensions=tuple(dimensions),
        field=step.field,
    )


def _dimension(count: Count) -> Dimension:
    """C has no empty arrays, so there is room for one element at least."""
    capacity = max(1, count.greatest)
    if count.fills:
        return Dimension(capacity, count.member)
    return Dimension(capacity, None if count.by is None else count.by.name)


def _shape(step: AnyStep) -> Shape:
    match step:
        case IntegerStep():
            return _number(step.type)
        case FloatStep(type=Float(bits=bits)):
            return Number(f"f{bits // 8}", bits // 8)
        case BytesStep():
            is_text = isinstance(step.type, TextType)
            return Text(max(1, step.count.greatest)) if is_text else _BYTE
        case RecordStep():
            return record(_columns(step.steps))
        case ChooseStep():
            return _choice(step)
        case _:
            raise AssertionError("an array is a dimension, and a constant has no column")


def _number(type_: Integer) -> Number:
    if type_.role == "bool":
        return Number("?", 1)
    size = type_.width // 8
    return Number(f"{'i' if type_.signed else 'u'}{size}", size)


def _counting(greatest: int) -> Number:
    size = counting_bits(greatest) // 8
    return Number(f"u{size}", size)


def _choice(step: ChooseStep) -> Choice:
    held = [case for case in step.cases if case.step.holds_values]
    cases = tuple((case.value, _column(case.step)) for case in held)
    empty = tuple(case.value for case in step.cases if not case.step.holds_values)
    rest = None if step.rest is None else _rest(step.rest)
    every = [column for _, column in cases] + ([] if rest is None else [rest])
    alignment = max(item.shape.alignment for item in every)
    size = _aligned(max(item.size for item in every), alignment)
    selector = step.selector if isinstance(step.selector, int) else step.selector_name
    return Choice(selector, cases, empty, rest, size, alignment)


def _rest(step: RestStep) -> Column:
    size = Column(name="size", role="count", source="bytes", shape=_counting(step.count.greatest))
    held = Column(
        name="bytes",
        role="field",
        source="bytes",
        shape=_BYTE,
        dimensions=(Dimension(max(1, step.count.greatest), "size"),),
    )
    return Column(
        name=step.name,
        role="field",
        source=step.field.name,
        shape=record([size, held]),
        field=step.field,
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
