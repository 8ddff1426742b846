"""Tables of a sender's captures: columns of raw values, and beside them what they mean.

Each message has a table. Its columns are, in this order:

* `offset` and `size` of the frame in bytes, `t_ns`: when its last byte came (null without times),
  and `@NAME` for each counter and value of the frame. Where a field has one of these names, the
  column of the frame gets a `_` in front.
* for each field its raw values under the field's name. The members of a struct are `field.member`,
  the cases of a switch `field.case` or `field.case.member`, null where they were not chosen, and
  `field.rest` for the bytes of a value without a case.
* behind the raw column of a field with a scale, its physical values, called as in Python:
  `heading_deg`; null for a special value. So it is for a single value without a scale that has a
  unit and special values. What else has a unit is physical as it is.
* behind that of a field with named values, their names: `mode_name`; null for a value without one.

`invalid_spans` and `unknown_frames` are the tables of what is no frame and of unknown identities.
"""

from __future__ import annotations

import json
from collections.abc import Iterable, Iterator, Mapping, Sequence
from fractions import Fraction
from math import lcm
from typing import Any

import msgspec

from protogen.copying import replace
from protogen.model.meanings import BitField
from protogen.model.messages import Message, given_parts
from protogen.model.names import unit_suffix
from protogen.model.protocol import Protocol, Sender
from protogen.model.types import (
    Array,
    Case,
    Field,
    Fixed,
    Float,
    Integer,
    NumberType,
    Octets,
    Struct,
    Switch,
    Text,
    Type,
)
from protogen.version import VERSION

REASONS = ("noise", "checksum", "length", "stuffing", "truncated", "size", "encoding", "value")
"""Reasons why bytes are no frame."""

Path = tuple[str, ...]
"""Way from a message to a value: field, member, ..."""

# --- what a column holds --------------------------------------------------------------------------


class Scalar(msgspec.Struct, frozen=True):
    """One value: `int8` to `uint64`, `float32`, `float64`, `bool`, `text` or `bytes`."""

    kind: str


class Names(msgspec.Struct, frozen=True):
    """One of a few texts."""

    texts: tuple[str, ...]


class Listed(msgspec.Struct, frozen=True):
    """Several values of one kind; `count` where there are always as many, and not none."""

    element: ColumnType
    count: int | None
    gaps: bool = False
    """True if some of them may be missing."""


class Record(msgspec.Struct, frozen=True):
    """Named values."""

    members: tuple[tuple[str, ColumnType], ...]
    gaps: bool = False
    """True if some of them may be missing."""


ColumnType = Scalar | Names | Listed | Record

TEXT = Scalar("text")
BYTES = Scalar("bytes")
UINT64 = Scalar("uint64")
UINT32 = Scalar("uint32")
INT64 = Scalar("int64")
FLOAT64 = Scalar("float64")


# --- what is computed from a raw value ------------------------------------------------------------


class Physical(msgspec.Struct, frozen=True):
    """The physical value of a raw one: (raw x `times` + `plus`) / `over`; None for `special`.

    The whole numbers give the exact quotient rounded once, which scale and offset as floats do not.
    """

    scale: Fraction
    offset: Fraction
    special: frozenset[int]
    is_float: bool

    @property
    def over(self) -> int:
        """The common denominator of scale and offset."""
        return lcm(self.scale.denominator, self.offset.denominator)

    @property
    def times(self) -> int:
        """The scale in parts of `over`."""
        return int(self.scale * self.over)

    @property
    def plus(self) -> int:
        """The offset in parts of `over`."""
        return int(self.offset * self.over)

    @property
    def is_plain(self) -> bool:
        """True if the physical value is the raw one."""
        return self.scale == 1 and self.offset == 0

    def of(self, raw: Any) -> Any:
        """The physical value of one raw value, or those of a list."""
        if isinstance(raw, list):
            return [self.of(item) for item in raw]
        if raw is None or raw in self.special:
            return None
        if self.is_plain:
            return raw
        return float(raw * self.scale + self.offset)


class Naming(msgspec.Struct, frozen=True):
    """The name of a raw value; None for one without."""

    names: Mapping[int, str]

    def of(self, raw: Any) -> str | None:
        """The name of one raw value."""
        return None if raw is None else self.names.get(raw)


Derived = Physical | Naming

# --- columns and tables ---------------------------------------------------------------------------


class Column(msgspec.Struct, frozen=True):
    """A column of a table. `derived` says how its values follow from the raw ones at `path`."""

    name: str
    type: ColumnType
    path: Path
    derived: Derived | None = None
    nullable: bool = False
    facts: Mapping[str, str] = msgspec.field(default_factory=dict)
    """Facts for readers, in the metadata of formats that have such."""


class Table(msgspec.Struct, frozen=True):
    """A table: the rows of one message, or of what is none."""

    name: str
    frame_columns: tuple[Column, ...]
    """Columns `offset`, `size`, `t_ns`, then the parts."""
    columns: tuple[Column, ...]
    facts: Mapping[str, str]
    message: Message | None = None

    @property
    def all_columns(self) -> tuple[Column, ...]:
        """Every column, in order."""
        return self.frame_columns + self.columns


class Tables(msgspec.Struct, frozen=True):
    """The tables of one sender's captures."""

    protocol: Protocol
    sender: Sender
    messages: Mapping[str, Table]
    unknown: Table
    invalid: Table

    @property
    def all_tables(self) -> tuple[Table, ...]:
        """Every table, those of messages first."""
        return (*self.messages.values(), self.unknown, self.invalid)

    @property
    def channels(self) -> Mapping[str, int]:
        """The number of each table's channel in MCAP, by the table's name, in their order."""
        return {table.name: number for number, table in enumerate(self.all_tables, start=1)}

    @property
    def byte_time(self) -> Fraction:
        """Nanoseconds that a byte takes on the line; a microsecond where the rate is not known."""
        seconds = self.protocol.link.byte_time
        return Fraction(1000) if seconds is None else seconds * 10**9


def tables_of(protocol: Protocol, sender: Sender) -> Tables:
    """The tables of what a sender sends."""
    facts = {
        "protogen.version": VERSION,
        "protogen.protocol": protocol.name,
        "protogen.sender": sender.name,
        "protogen.spec_hash": protocol.spec_hash,
    }
    messages = {item.name: _message_table(item, sender, facts) for item in sender.messages}
    unknown = _free("unknown_frames", messages)
    invalid = _free("invalid_spans", messages)
    return Tables(
        protocol, sender, messages, _unknown(unknown, sender, facts), _invalid(invalid, facts)
    )


def _free(name: str, taken: Iterable[str]) -> str:
    names = set(taken)
    while name in names:
        name = f"_{name}"
    return name


def _frame_columns(parts: Iterable[tuple[str, Integer]], taken: Iterable[str]) -> Iterator[Column]:
    names = set(taken)
    yield Column(_free("offset", names), UINT64, ("offset",), facts={"unit": "B"})
    yield Column(_free("size", names), UINT32, ("size",), facts={"unit": "B"})
    facts = {"unit": "ns", "doc": "When the last byte came, since 1970-01-01 UTC."}
    yield Column(_free("t_ns", names), INT64, ("t_ns",), nullable=True, facts=facts)
    for name, type in parts:
        shown = TEXT if type.is_text else _scalar(type)
        yield Column(f"@{name}", shown, ("@", name), facts={"part": name})


def _message_table(message: Message, sender: Sender, facts: Mapping[str, str]) -> Table:
    columns = tuple(_message_columns(message.fields))
    parts = [(part.name, part.type) for part in given_parts(sender.frame, message)]
    identity = {
        part.name: part.shown(value)
        for part, value in zip(sender.frame.identity, message.identity, strict=True)
    }
    about = {
        "protogen.message": message.name,
        "protogen.message_spec_hash": message.spec_hash,
        "protogen.identity": json.dumps(identity),
        "protogen.doc": message.summary or message.title,
    }
    frame_columns = tuple(_frame_columns(parts, (column.name for column in columns)))
    return Table(message.name, frame_columns, columns, {**facts, **about}, message)


def _unknown(name: str, sender: Sender, facts: Mapping[str, str]) -> Table:
    parts = [
        (part.name, part.type) for part in (*sender.frame.identity, *sender.frame.caller_parts)
    ]
    payload = Column("payload", BYTES, ("payload",))
    return Table(name, tuple(_frame_columns(parts, ())), (payload,), facts)


def _invalid(name: str, facts: Mapping[str, str]) -> Table:
    columns = (
        Column("reason", Names(REASONS), ("reason",)),
        Column("raw", BYTES, ("raw",), facts={"doc": "The bytes on the wire."}),
    )
    return Table(name, tuple(_frame_columns((), ())), columns, facts)


# --- the columns of fields ------------------------------------------------------------------------


def _message_columns(fields: Sequence[Field]) -> Iterator[Column]:
    raw = list(_columns(fields, (), nullable=False))
    taken = {column.name for column in raw}
    known = {column.path: item for column, item in _with_fields(raw, fields)}
    for column in raw:
        yield column
        for meaning in _meanings(column, known[column.path]):
            name = meaning.name
            while name in taken:
                name += "_value"
            taken.add(name)
            yield replace(meaning, name=name)


def _with_fields(
    raw: Iterable[Column], fields: Sequence[Field]
) -> Iterator[tuple[Column, Field | None]]:
    for column in raw:
        yield column, field_at(fields, column.path)


def field_at(fields: Sequence[Field], path: Path) -> Field | None:
    """The field whose values a column holds; of a switch, which has none of its own, None."""
    found = next(item for item in fields if item.name == path[0])
    type, steps = found.type, path[1:]
    while steps:
        if isinstance(type, Switch):
            case = next((item for item in type.cases if item.name == steps[0]), None)
            if case is None:
                return None
            type, steps = case.type, steps[1:]
            continue
        assert isinstance(type, Struct)
        return field_at(type.fields, steps)
    return replace(found, type=type)


def _columns(fields: Sequence[Field], prefix: Path, *, nullable: bool) -> Iterator[Column]:
    for item in fields:
        may_be_absent = nullable or item.may_be_absent
        yield from _value_columns(item, item.type, (*prefix, item.name), nullable=may_be_absent)


def _value_columns(item: Field, type: Type, path: Path, *, nullable: bool) -> Iterator[Column]:
    match type:
        case Struct(fields=fields):
            yield from _columns(fields, path, nullable=nullable)
        case Switch(cases=cases, rest=rest):
            for case in cases:
                if not _is_empty(case):
                    yield from _value_columns(item, case.type, (*path, case.name), nullable=True)
            if rest is not None:
                yield Column(".".join((*path, rest_name(type))), BYTES, (*path, ""), nullable=True)
        case _:
            facts = facts_of(item, type)
            yield Column(".".join(path), column_type(type), path, nullable=nullable, facts=facts)


def rest_name(type: Switch) -> str:
    """Name of the bytes of a value without a case."""
    return _free("rest", (case.name for case in type.cases))


def _is_empty(case: Case) -> bool:
    return isinstance(case.type, Struct) and not case.type.fields


def column_type(type: Type) -> ColumnType:
    """Type of a column of such values."""
    match type:
        case Integer():
            return _scalar(type)
        case Float(bits=bits):
            return Scalar(f"float{bits}")
        case Text():
            return TEXT
        case Octets():
            return BYTES
        case Array(element=element, extent=extent):
            # Arrow knows lists that are always empty only if their type does not say so.
            count = (extent.count or None) if isinstance(extent, Fixed) else None
            return Listed(column_type(element), count)
        case Struct(fields=fields):
            gaps = any(item.may_be_absent for item in fields)
            return Record(tuple((item.name, _member_type(item)) for item in fields), gaps)
        case Switch(cases=cases, rest=rest):
            members = [
                (case.name, of_any_count(column_type(case.type)))
                for case in cases
                if not _is_empty(case)
            ]
            tail = [] if rest is None else [(rest_name(type), BYTES)]
            return Record((*members, *tail), gaps=True)


def _member_type(item: Field) -> ColumnType:
    """Type of a member of a record."""
    found = column_type(item.type)
    return of_any_count(found) if item.may_be_absent else found


def of_any_count(type: ColumnType) -> ColumnType:
    """Type of what may be missing: its lists have no elements then.

    Arrow does not read from Parquet what it has written there of lists of a fixed size in a struct
    that is missing.
    """
    match type:
        case Listed(element=element):
            return replace(type, element=of_any_count(element), count=None)
        case Record(members=members):
            return replace(type, members=tuple((it, of_any_count(of)) for it, of in members))
        case _:
            return type


def _scalar(type: Integer) -> Scalar:
    if type.role == "bool":
        return Scalar("bool")
    size = next(bits for bits in (8, 16, 32, 64) if type.bits <= bits)
    return Scalar(f"{'int' if type.signed else 'uint'}{size}")


# --- what values mean -----------------------------------------------------------------------------


def _meanings(raw: Column, item: Field | None) -> Iterator[Column]:
    if item is None:
        return
    leaf = item.type.element if isinstance(item.type, Array) else item.type
    if not isinstance(leaf, NumberType):
        return
    if item.scaled or (item.unit and item.special and leaf is item.type):
        yield _physical_column(raw, item, leaf)
    names = _names(item, leaf)
    if names and leaf is item.type:
        naming = Naming(names)
        texts = tuple(dict.fromkeys(names.values()))
        facts = {"of": raw.name}
        yield Column(f"{raw.name}_name", Names(texts), raw.path, naming, nullable=True, facts=facts)


def _physical_column(raw: Column, item: Field, leaf: NumberType) -> Column:
    special = frozenset(named.value for named in item.special)
    meaning = Physical(item.scale, item.offset, special, isinstance(leaf, Float))
    element = column_type(leaf) if meaning.is_plain else FLOAT64
    type: ColumnType = element
    if isinstance(raw.type, Listed):
        type = Listed(element, raw.type.count, gaps=bool(special))
    facts = {"of": raw.name, **({"unit": item.unit} if item.unit else {})}
    name = f"{raw.name}_{unit_suffix(item.unit)}"
    return Column(name, type, raw.path, meaning, raw.nullable or bool(special), facts)


def _names(item: Field, leaf: NumberType) -> dict[int, str]:
    if leaf.enum is None:
        return {}
    return {entry.value: entry.name for entry in (*leaf.enum.values, *item.special)}


def facts_of(item: Field, type: Type) -> dict[str, str]:
    """Facts for readers about a field's values, or about those of what it holds."""
    leaf = type.element if isinstance(type, Array) else type
    facts = {"unit": item.unit or "", "doc": item.about.doc}
    if item.scaled:
        facts |= {"scale": str(item.scale), "offset": str(item.offset)}
    if item.special:
        facts["special"] = json.dumps({named.name: named.value for named in item.special})
    if isinstance(leaf, NumberType):
        facts |= _names_of(leaf)
    return {key: value for key, value in facts.items() if value}


def _bits_of(run: BitField) -> list[int] | tuple[tuple[int, int], ...]:
    """The lowest and the highest bit of a run; of several a list of both."""
    return run.runs if run.gaps else [run.low, run.high]


def _names_of(type: NumberType) -> dict[str, str]:
    facts = {}
    if type.enum is not None:
        facts["values"] = json.dumps({named.name: named.value for named in type.enum.values})
    if type.flags is not None:
        facts["flags"] = json.dumps({flag.name: flag.bit for flag in type.flags.bits})
    if type.bit_fields:
        facts["bits"] = json.dumps({run.name: _bits_of(run) for run in type.bit_fields})
    return facts
