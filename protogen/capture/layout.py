"""Lays out rows as a C compiler lays out structs: each member at the next multiple of its size."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from functools import lru_cache
from math import prod

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
from protogen.model.expressions import Expression, Operand, plain_name, rebuilt
from protogen.model.messages import Message
from protogen.model.parts import NumberPart
from protogen.model.payload_plan import (
    AnyStep,
    BytesStep,
    ChooseStep,
    Count,
    FloatStep,
    Formula,
    IntegerStep,
    OptionalStep,
    RecordStep,
    RepeatStep,
    RestStep,
)
from protogen.model.payload_walks import held_step
from protogen.model.protocol import Protocol, Sender
from protogen.model.types import NumberType, counting_bits
from protogen.model.types import Text as TextType

_FLAG = Number("?", 1)
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
        sender=sender.endpoint,
        form="" if sender.is_only_form else sender.form,
        spec_hash=protocol.spec_hash,
        messages={item.name: _table(framed, item) for item in sender.received},
        invalid=TableSchema(row=record([*head, reason])),
        unknown=TableSchema(row=record([*framed, *payload])),
    )


def shown_parts(sender: Sender) -> tuple[NumberPart, ...]:
    """The parts of a frame that events show."""
    return sender.frame.shown_parts


def _parts(parts: Iterable[NumberPart], taken: Sequence[str]) -> Iterator[Column]:
    for part in parts:
        is_text = part.type.is_text
        yield Column(
            name=_free(part.name, taken),
            role="part",
            source=part.name,
            shape=Text(part.type.size) if is_text else _number(part.type),
            dimensions=(Dimension(part.type.size),) if is_text else (),
            part=part,
        )


def _place(name: str, shape: Number, others: Iterable[Column]) -> Column:
    found = _free(name, [item.name for item in others])
    return Column(name=found, role="payload", source=name, shape=shape)


def _table(framed: Sequence[Column], message: Message) -> TableSchema:
    base = record(framed)
    inner = message_record(message, [item.name for item in framed])
    start = _aligned(_end(base.columns), inner.alignment)
    fields = [item.at(start + item.position) for item in inner.columns]
    alignment = max(base.alignment, inner.alignment)
    size = _aligned(start + inner.size, alignment)
    return TableSchema(row=Record((*base.columns, *fields), size, alignment), message=message)


def message_record(message: Message, taken: Sequence[str] = ()) -> Record:
    """The message's own columns, under the names that the schema and C give them.

    Where one of the names is taken, `_` stands behind it.
    """
    return record(_columns(message.plan.steps, taken, taken))


def struct_sizes(message: Message) -> tuple[int, int] | None:
    """Bytes of a message's struct in C: on 32-bit machines, and on an AVR, which aligns nothing.

    None where no field has a value: there is no struct.
    """
    if not message.plan.holds_values:
        return None
    record = message_record(message)
    return record.size, _packed_size(record)


def _packed_size(shape: Shape) -> int:
    match shape:
        case Record():
            return max(1, sum(map(_packed, shape.columns)))
        case Choice():
            rest = () if shape.rest is None else (shape.rest,)
            return max(map(_packed, (*(case for _, case in shape.cases), *rest)))
        case _:
            return shape.size


def _packed(column: Column) -> int:
    return _packed_size(column.shape) * prod(column.counts)


def _free(name: str, taken: Sequence[str]) -> str:
    while name in taken:
        name += "_"
    return name


# --- fields ---------------------------------------------------------------------------------------
# `outer` are names that the message's own columns can't have, `taken` those of the same record.


def _columns(
    steps: Sequence[AnyStep], outer: Sequence[str], taken: Sequence[str] = ()
) -> Iterator[Column]:
    for step in steps:
        held, when = held_step(step), None
        if isinstance(step, OptionalStep):  # Outside of a region, where there are both.
            by, member = step.presence.holds, step.presence.member
            when = by if isinstance(by, int) else _referred(by, outer)
            if member:
                when = _free(member, taken)
                yield Column(
                    name=when,
                    role="presence",
                    source=step.name,
                    shape=_FLAG,
                    field=step.field,
                )
        if isinstance(held, BytesStep | RepeatStep) and held.count.member:
            yield Column(
                name=_free(held.count.member, taken),
                role="count",
                source=step.name,
                shape=_counting(held.count.greatest),
                field=step.field,
                when=when,
            )
        if step.holds_values:
            yield replace(_column(held, outer, taken), when=when)


def _column(step: AnyStep, outer: Sequence[str], taken: Sequence[str] = ()) -> Column:
    dimensions: list[Dimension] = []
    element = step
    while isinstance(element, RepeatStep):
        dimensions.append(_dimension(element.count, outer, taken))
        element = element.element
    if isinstance(element, BytesStep):
        dimensions.append(_dimension(element.count, outer, taken))
    return Column(
        name=_free(step.name, taken),
        role="field",
        source=step.name,
        shape=_shape(element, outer),
        dimensions=tuple(dimensions),
        field=step.field,
    )


def _dimension(count: Count, outer: Sequence[str], taken: Sequence[str]) -> Dimension:
    """C has no empty arrays, so there is room for one element at least."""
    capacity = max(1, count.greatest)
    if count.member:
        return Dimension(capacity, _free(count.member, taken))
    return Dimension(capacity, None if count.by is None else _referred(count.by, outer))


def _referred(formula: Formula, outer: Sequence[str]) -> str | Expression:
    """Name of the column of a number that counts or selects; an expression over columns."""

    def called(item: Expression) -> Expression:
        if not isinstance(item, Operand) or formula.references[item.name].level > 0:
            return item
        return replace(item, path=(_free(item.path[0], outer), *item.path[1:]))

    found = rebuilt(formula.expression, called)
    return plain_name(found) or found


def _shape(step: AnyStep, outer: Sequence[str]) -> Shape:
    match step:
        case IntegerStep() | FloatStep():
            return _number(step.type)
        case BytesStep():
            is_text = isinstance(step.type, TextType)
            return Text(max(1, step.count.greatest)) if is_text else _BYTE
        case RecordStep():
            return record(_columns(step.steps, outer))
        case ChooseStep():
            return _choice(step, outer)
        case _:
            raise AssertionError("an array is a dimension, and a constant has no column")


@lru_cache(maxsize=1024)
def _number(type_: NumberType) -> Number:
    if type_.kind == "bool":
        return Number("?", 1)
    size = type_.width // 8
    return Number(f"{type_.kind[0]}{size}", size)


def _counting(greatest: int) -> Number:
    size = counting_bits(greatest) // 8
    return Number(f"u{size}", size)


def _choice(step: ChooseStep, outer: Sequence[str]) -> Choice:
    held = [case for case in step.cases if case.step.holds_values]
    cases = tuple((case.value, _column(case.step, outer)) for case in held)
    empty = tuple(case.value for case in step.cases if not case.step.holds_values)
    rest = None if step.rest is None else _rest(step.rest)
    every = [column for _, column in cases] + ([] if rest is None else [rest])
    alignment = max(item.shape.alignment for item in every)
    size = _aligned(max(item.size for item in every), alignment)
    chosen_by = step.selector
    selector = chosen_by if isinstance(chosen_by, int) else _referred(chosen_by, outer)
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
