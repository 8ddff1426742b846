"""The fields of a payload, found in its bytes one after another."""

from __future__ import annotations

import struct
from collections import ChainMap
from collections.abc import Mapping, Sequence
from typing import Any, Literal

import msgspec

from protogen.copying import replace
from protogen.model.expressions import Expression, reached, value_of
from protogen.model.numbers import FreeNumeral
from protogen.model.packing import FilledPacking
from protogen.model.parts import Part
from protogen.model.payload_plan import (
    AnyStep,
    BytesStep,
    Check,
    ChooseStep,
    ConditionalPresence,
    ConstantStep,
    Count,
    FloatStep,
    Formula,
    IntegerStep,
    OptionalStep,
    PartStep,
    PayloadPlan,
    RecordStep,
    RegionStep,
    RepeatStep,
    RestStep,
    TrailingPresence,
)
from protogen.model.payload_walks import PackedNumber, packed_numbers
from protogen.model.reading.readings import integer_reading, physical, quoted, value_name
from protogen.model.reading.wire import Unit
from protogen.model.types import (
    Between,
    Field,
    Float,
    NumberType,
    Scalar,
    Tail,
    Text,
    codec,
)
from protogen.runtime.errors import ByteError
from protogen.runtime.payload.bits import BitReader
from protogen.runtime.payload.number import Number

Scope = ChainMap[str, Any]
"""The integers read so far, which count and select what follows; of a struct a mapping of them."""

ScalarStep = IntegerStep | FloatStep | BytesStep


class Row(msgspec.Struct, frozen=True, kw_only=True):
    """Some bytes of a frame and what they stand for."""

    offset: int
    """Of the first byte on the wire, counted from the start of the frame."""
    wire: bytes
    """As on the wire."""
    bytes: bytes = b""
    """Without transparency."""
    bits: str = ""
    """The bits of a packed number, most significant first. It has no bytes of its own: they are
    those of a row in front, the `run`."""
    run: Literal["", "list", "record"] = ""
    """What the rows behind are that have their bits in these bytes."""
    path: str = ""
    """The part's name, or the field's with what leads to it, such as `points[2].x`."""
    type: str = ""
    """In the words of the schema language; `literal` for a literal."""
    value: int | float | str | None = None
    """The raw value of a number or a text."""
    meaning: str = ""
    """A name of the value, its physical value, or what the part is good for."""
    fault: str = ""
    """Reason that these bytes can't stand here; empty where they can."""
    cut: bool = False
    """True if more bytes belong here, but the frame has no more."""
    subject: Part | Field | None = None
    """The part or the field that the bytes belong to; None where they belong to none."""
    value_type: Scalar | None = None
    """The type of a part's or a field's value; None for a literal, or bytes that none fits."""

    def reads(self, value: int | float | str, meaning: str, fault: str = "") -> Row:
        """The row with what its bytes turned out to be."""
        return replace(self, value=value, meaning=meaning, fault=self.fault or fault)


class Cursor:
    """Takes units one after another. `offset` is the place of the first one in the frame."""

    def __init__(self, units: Sequence[Unit], offset: int) -> None:
        self._units = units
        self.offset = offset
        self._position = 0

    @property
    def left(self) -> int:
        """Number of units that are left."""
        return len(self._units) - self._position

    def take(
        self,
        count: int,
        path: str,
        type: str,
        *,
        fault: str = "",
        subject: Part | Field | None = None,
        value_type: Scalar | None = None,
    ) -> Row:
        """A row without a value of the next `count` units, or of as many as there are."""
        offset = self.offset
        taken = self._next(count)
        missing = count - len(taken)
        return Row(
            offset=offset,
            wire=b"".join(unit.wire for unit in taken),
            bytes=bytes(unit.byte for unit in taken),
            path=path,
            type=type,
            fault=f"missing bytes: {missing}" if missing else fault,
            cut=bool(missing),
            subject=subject,
            value_type=value_type,
        )

    def _next(self, count: int) -> Sequence[Unit]:
        taken = self._units[self._position : self._position + count]
        self._position += len(taken)
        self.offset += sum(len(unit.wire) for unit in taken)
        return taken

    def size_to(self, byte: int, behind: int) -> int:
        """Number of units in front of a byte that is `behind` so many of them, or of all."""
        units = self._units[self._position + behind :]
        return behind + next((i for i, it in enumerate(units) if it.byte == byte), len(units))

    def elements(self, tail: Tail) -> int:
        """Number of elements that are left in front of a tail."""
        units = self._units[self._position :]
        if tail.separator is not None:
            units = [unit for unit in units if unit.byte == tail.separator]
        return max(0, len(units) - tail.least) // tail.element

    def ends_with(self, data: bytes) -> bool:
        """True if the units that are left end with these bytes."""
        left = self._units[self._position :]
        return bytes(unit.byte for unit in left[-len(data) :]) == data

    def skip(self, size: int) -> None:
        """Pass bytes on the wire that belong to no unit."""
        self.offset += size

    def rest(self) -> Sequence[Unit]:
        """The units that are left, which this one passes."""
        return self._next(self.left)

    def part(self, count: int) -> Cursor:
        """A cursor over the next `count` units, which this one passes."""
        offset = self.offset
        return Cursor(self._next(count), offset)


def dissect(plan: PayloadPlan, cursor: Cursor, parts: Mapping[str, int]) -> list[Row]:
    """Return a row for each field, member and element, up to the first that has no bytes.

    `parts` has the numbers of the frame, which some fields are.
    """
    reader = _Reader(cursor, parts)
    reader.record(plan.steps, "", ChainMap())
    return reader.rows


class _Reader:
    def __init__(self, cursor: Cursor, parts: Mapping[str, int]) -> None:
        self._parts = parts
        self._cursor = cursor
        self._short = False
        self.rows: list[Row] = []

    def record(self, steps: Sequence[AnyStep], prefix: str, scope: Scope) -> None:
        for step in steps:
            self._step(step, prefix + step.name, scope)

    def _step(self, step: AnyStep, path: str, scope: Scope) -> None:
        if self._short:
            return
        match step:
            case RecordStep() | RepeatStep() if step.packing is not None:
                self._packed(step, path, scope)
            case RecordStep():
                inner = scope.new_child()
                scope[step.name] = inner.maps[0]
                self.record(step.steps, f"{path}.", inner)
            case RepeatStep():
                self._elements(step, path, scope)
            case ChooseStep():
                self._case(step, path, scope)
            case OptionalStep():
                if self._is_there(step, scope):
                    self._step(step.step, path, scope)
            case RegionStep():
                self._region(step, path, scope)
            case ConstantStep():
                self._step(step.value, path, scope)
            case _:
                self._single(step, path, scope)

    def _single(self, step: ScalarStep, path: str, scope: Scope) -> None:
        if isinstance(step, PartStep):
            self._part(step, path, scope)
        else:
            self._scalar(step, path, scope)

    def _part(self, step: PartStep, path: str, scope: Scope) -> None:
        """A number of the frame, of which the payload has no bytes; unknown ones are 0."""
        value = scope[step.name] = self._parts.get(step.part, 0)
        label = f"part {step.part}"
        row = self._cursor.take(0, path, label, subject=step.field, value_type=step.type)
        self.rows.append(row.reads(value, _meaning(step, value), _fault(step, value)))

    def _is_there(self, step: OptionalStep, scope: Scope) -> bool:
        match step.presence:
            case ConditionalPresence(expression=condition):
                return bool(_said(condition, scope))
            case TrailingPresence():
                return bool(self._cursor.left)

    def _region(self, step: RegionStep, path: str, scope: Scope) -> None:
        size = _count(step.region, scope) or 0
        outside, there = self._cursor, min(size, self._cursor.left)
        self._cursor = outside.part(size)
        self._step(step.step, path, scope)
        left = size - there + self._cursor.left
        if left and not self._short:
            fault = f"{left} of the {size} bytes are left over"
            row = self._cursor.take(left, path, "bytes", fault=fault, subject=step.field)
            self._short = row.cut
            self.rows.append(row)
        self._cursor = outside

    def _elements(self, step: RepeatStep, path: str, scope: Scope) -> None:
        if step.count.mark is not None:
            self._up_to_last(step, path, scope, step.count.mark)
            return
        count = _count(step.count, scope)
        if step.count.tail is not None:
            count = self._cursor.elements(step.count.tail)
        index = 0
        while not self._short and (self._cursor.left if count is None else index < count):
            element = replace(step.element, field=_element(step.field, index))
            self._step(element, f"{path}[{index}]", scope)
            index += 1

    def _up_to_last(self, step: RepeatStep, path: str, scope: Scope, mark: Formula) -> None:
        """Elements up to the one that says that it is the last; one at least."""
        for index in range(step.count.greatest):
            self._step(step.element, f"{path}[{index}]", scope)
            # An element has no name, under which its members are found behind it.
            if self._short or _said(mark.expression, scope.new_child(scope[step.element.name])):
                return
        fault = f"none of {step.count.greatest} elements says that it is the last"
        self.rows.append(self._cursor.take(0, path, step.type.label, fault=fault))

    def _case(self, step: ChooseStep, path: str, scope: Scope) -> None:
        chosen = _said(step.expression, scope)
        found = step.rest if chosen is None else step.case(chosen)
        if found is not None and not isinstance(found, RestStep):
            self._step(found, path, scope)
            return
        fault = f"`{step.expression.text}` has no case {chosen}" if found is None else ""
        if self._cursor.left:
            left = self._cursor.left
            row = self._cursor.take(left, path, "bytes", fault=fault, subject=step.field)
            self.rows.append(row)

    def _packed(self, step: RecordStep | RepeatStep, path: str, scope: Scope) -> None:
        """A row for the bytes of packed numbers, and one for each of the numbers."""
        is_record, packing, filled = isinstance(step, RecordStep), step.packing, 0
        if isinstance(packing, FilledPacking):
            filled = 8 * self._cursor.left // packing.width
            packing = packing.run_of(filled)
        assert packing is not None
        row = self._cursor.take(packing.size, path, f"packed {packing.order}", subject=step.field)
        row = replace(row, meaning=f"{packing.bits} bits", run="record" if is_record else "list")
        if not row.cut and row.bytes and row.bytes[-1] & packing.padding:
            row = replace(row, fault="the bits behind the last number have to be zero")
        self._short = row.cut
        self.rows.append(row)
        if row.cut:
            return
        run = BitReader(row.bytes, packing.order)
        steps = step.steps if isinstance(step, RecordStep) else (replace(step, name=""),)
        base = f"{path}." if is_record else path
        members = scope[step.name] = {}
        for item in packed_numbers(steps, filled):
            found = _bits(item, run, base, row.offset)
            self.rows.append(found)
            members[item.name] = found.value

    def _scalar(self, step: ScalarStep, path: str, scope: Scope) -> None:
        size = self._size_of(step, scope)
        size = self._cursor.left if size is None else size
        label = step.type.label
        row = self._cursor.take(size, path, label, subject=step.field, value_type=step.type)
        self._short = row.cut
        if not row.cut:
            row = _read(step, row)
        if isinstance(row.value, int):
            scope[step.field.name] = row.value
        self.rows.append(row)

    def _size_of(self, step: ScalarStep, scope: Scope) -> int | None:
        """Bytes of a value, with a terminator; None: as many as there are."""
        if not isinstance(step, BytesStep):
            return self._size(step.type)
        if step.count.until is not None:
            return self._cursor.size_to(step.count.until, 0) + 1
        if step.count.between is not None:
            between = step.count.between
            if between.takes_rest:
                return None
            return self._cursor.size_to(between.separator, between.leads)
        return _count(step.count, scope)

    def _size(self, type_: NumberType) -> int | None:
        """Bytes of a number; None: as many as there are."""
        form = type_.text
        if not isinstance(form, FreeNumeral):
            return type_.size
        return None if form.separator is None else self._cursor.size_to(form.separator, form.leads)


def _element(field: Field, index: int) -> Field:
    """The field as it is for one element; only a constant has a value for each."""
    if not isinstance(field.const, tuple):
        return field
    return replace(field, const=field.const[index] if index < len(field.const) else None)


def _bits(item: PackedNumber, run: BitReader, base: str, offset: int) -> Row:
    """The row of a packed number, whose bits are taken out of the run."""
    type_, end = item.step.type, item.first + item.step.type.bits - 1
    place = f"bit {end}" if end == item.first else f"bits {item.first}..{end}"
    index = "" if item.index is None else f"[{item.index}]"
    raw = run.take(type_.bits)
    step = replace(item.step, field=_element(item.step.field, item.index or 0))
    value = Number(type_.bits, type_.signed).value_of(raw)
    row = Row(
        offset=offset + item.first // 8,
        wire=b"",
        bits=f"{raw:0{type_.bits}b}",
        path=f"{base}{item.name}{index}",
        type=f"{type_.label}, {place}",
        subject=step.field,
        value_type=type_,
    )
    return row.reads(value, _meaning(step, value), _fault(step, value))


def _count(count: Count, scope: Scope) -> int | None:
    """The number that the bytes in front say; None: as many as there are."""
    if count.expression is None:
        return count.known
    return max(0, _said(count.expression, scope) or 0)


def _said(expression: Expression, scope: Scope) -> int | None:
    """The value of an expression; None where the bytes in front did not say it."""
    try:
        return int(value_of(expression, lambda operand: reached(scope, operand.name)))
    except KeyError:
        return None


# --- values -------------------------------------------------------------------------------------


def _read(step: ScalarStep, row: Row) -> Row:
    if Check.SEVEN_BIT in step.checks and not row.bytes.isascii():
        return replace(row, fault="has a byte of more than 7 bits")
    if isinstance(step, BytesStep):
        row = row if step.count.until is None else replace(row, fault=_bounds_fault(step, row))
        if step.count.between is not None:
            row = replace(row, fault=_between_fault(step.count, step.count.between, row.bytes))
        return _text(step, row) if isinstance(step.type, Text) else _octets(step.field, row)
    try:
        value = codec(step.type).decode(row.bytes)
    except ByteError as error:
        return replace(row, fault=str(error))
    if isinstance(step, FloatStep):
        real = _float(step.type, value)
        return row.reads(real, physical(step.field, real, gap=" "))
    return row.reads(value, _meaning(step, value), _fault(step, value))


def _float(type: Float, pattern: int) -> float:
    form = ">f" if type.bits == 32 else ">d"
    value: float = struct.unpack(form, pattern.to_bytes(type.bits // 8, "big"))[0]
    return value


def _octets(field: Field, row: Row) -> Row:
    if isinstance(field.const, bytes) and field.const != row.bytes:
        return replace(row, fault=f"must be {field.const.hex(' ').upper()}")
    return row


def _bounds_fault(step: BytesStep, row: Row) -> str:
    """The reason that there are too many bytes in front of a terminator, or too few."""
    size = len(row.bytes) - 1
    if size > step.count.greatest:
        return f"has {size} bytes in front of the terminator, at most {step.count.greatest}"
    if size < step.count.least:
        return f"has {size} bytes in front of the terminator, at least {step.count.least}"
    return ""


def _between_fault(count: Count, between: Between, data: bytes) -> str:
    """The reason that a text can't stand between separators."""
    if between.leads and data[:1] != bytes((between.separator,)):
        return "the separator in front is missing"
    text = data[between.leads :]
    if not count.least <= len(text) <= count.greatest:
        return f"has {len(text)} characters, and not {count.least} to {count.greatest}"
    wrong = text.translate(None, between.characters)
    return f"{wrong[0]:02X} is no character of it" if wrong else ""


def _text(step: BytesStep, row: Row) -> Row:
    text = row.bytes.decode("latin-1")
    if step.count.between is not None:
        text = text[step.count.between.leads :]
    if step.count.until is not None:
        text = text[:-1]
    padded = step.type.padded if isinstance(step.type, Text) else None
    if padded is not None:
        try:
            text = padded.decode(row.bytes)
        except ByteError as error:
            return replace(row, fault=str(error))
    due = step.field.const
    wrong = isinstance(due, str) and text != due
    return row.reads(text, "", f"must be {quoted(str(due))}" if wrong else "")


def _meaning(step: IntegerStep, value: int) -> str:
    text = integer_reading(step, value, gap=" ")
    if text != str(value):
        return text
    return "a value without a name" if step.type.enum is not None else ""


def _fault(step: IntegerStep, value: int) -> str:
    due = step.field.const
    if isinstance(due, int) and value != due:
        return f"must be {due}"
    if step.type.is_closed and value_name(step.field, step.type, value) is None:
        return "is none of the values that there are"
    return ""
