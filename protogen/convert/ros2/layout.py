"""Layout of the ROS 2 messages that rows of tables become.

A message has a member for each column of its table: numbers as they are, text as `string`, bytes as
`uint8[]`, lists as `T[]` (`T[N]` where there are always as many) and what lists hold of records as
messages of their own. ROS knows no lists of lists, so that each of the inner ones is a message with
the one member `values`. It knows no missing values, either:

* a physical value that is a float is NaN where there is none; its raw value stands beside it;
* in front of anything else that may be missing stands a bool, `has_NAME`. Without a value, numbers
  are 0, texts and lists empty.

Instead of the names of values there are constants: `uint8 MODE_IDLE=0`.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence

import msgspec

from protogen.convert.columns import tables as shown
from protogen.convert.columns.tables import (
    Column,
    ColumnType,
    Listed,
    Naming,
    Physical,
    Scalar,
    Table,
    Tables,
    field_at,
    of_any_count,
    rest_name,
)
from protogen.convert.ros2.names import (
    constant_name,
    field_names,
    message_name,
    package_name,
)
from protogen.model.names import free_name
from protogen.model.types import Array, Field, NumberType, Struct, Switch, Type

# --- types of ROS ---------------------------------------------------------------------------------


class Number(msgspec.Struct, frozen=True):
    """A number or a bool."""

    word: str

    @property
    def size(self) -> int:
        """Bytes, and what its place is a multiple of."""
        return _SIZES[self.word]

    @property
    def is_float(self) -> bool:
        """True if it has a value that says that there is none."""
        return self.word.startswith("float")


_SIZES = {"bool": 1, "float32": 4, "float64": 8}
_SIZES |= {f"{sign}int{8 * size}": size for sign in ("", "u") for size in (1, 2, 4, 8)}


class String(msgspec.Struct, frozen=True):
    """Text in UTF-8."""


class ListOf(msgspec.Struct, frozen=True):
    """Several values, with their number in front unless there are always `count`."""

    element: RosType
    count: int | None = None


class Constant(msgspec.Struct, frozen=True):
    """A name of a number."""

    name: str
    value: int


class Member(msgspec.Struct, frozen=True):
    """A member of a message."""

    name: str
    type: RosType
    source: str
    """Name of the column, or of the member of a record; empty for bytes that no case stands for."""
    flag: str | None = None
    """Name of the bool in front that says whether there is a value; None: there always is one."""
    column: Column | None = None
    constants: tuple[Constant, ...] = ()
    comment: str = ""


class Message(msgspec.Struct, frozen=True):
    """A message, or one inside of another."""

    name: str
    members: tuple[Member, ...]
    comment: str = ""
    is_list: bool = False
    """True if it stands for its only member, a list in a list."""

    @property
    def inner(self) -> Iterator[Message]:
        """The messages inside of it, each once and behind those that it is inside of."""
        for member in self.members:
            type = member.type
            while isinstance(type, ListOf):
                type = type.element
            if isinstance(type, Message):
                yield type
                yield from type.inner


RosType = Number | String | ListOf | Message

BOOL = Number("bool")
BYTE = Number("uint8")
BYTES = ListOf(BYTE)
NOTHING = "structure_needs_at_least_one_member"
"""The member, a `uint8`, that ROS gives messages without any."""

# --- the messages of tables -----------------------------------------------------------------------


class Layout:
    """The messages of a sender's tables."""

    def __init__(self, tables: Tables) -> None:
        self.package = package_name(tables.protocol.name)
        self._names: set[str] = set()
        names = {table.name: self._free(table.name) for table in tables.all_tables}
        self.messages: Mapping[str, Message] = {
            table.name: self._message(table, names[table.name]) for table in tables.all_tables
        }
        """By the table's name."""

    def _free(self, *names: str) -> str:
        found = free_name(message_name(*names), self._names, between="")
        self._names.add(found)
        return found

    def _message(self, table: Table, name: str) -> Message:
        columns = [it for it in table.all_columns if not isinstance(it.derived, Naming)]
        members = [_of_column(self, table, column) for column in columns]
        return _named(name, members, table.facts.get("protogen.doc", ""))

    def type_of(self, type: ColumnType, of: Type | None, way: str) -> RosType:
        """The type of what a column holds, or of what is inside of it."""
        match type:
            case Scalar(kind="text") | shown.Names():
                return String()
            case Scalar(kind="bytes"):
                return BYTES
            case Scalar(kind=word):
                return Number(word)
            case Listed(element=element, count=count):
                inner = of.element if isinstance(of, Array) else None
                found = self.type_of(element, inner, way)
                if isinstance(found, ListOf):
                    found = self._list(found, way)
                return ListOf(found, count)
        members = list(_record_members(self, type, of, way))
        return _named(self._free(way), members or [_Draft(NOTHING, BYTE, "")], "")

    def _list(self, type: ListOf, way: str) -> Message:
        """The message that a list in a list is."""
        name = self._free(way, "list")
        return Message(name, (Member("values", type, ""),), is_list=True)


class _Draft(msgspec.Struct, frozen=True):
    """A member before it has a name that no other has."""

    name: str
    type: RosType
    source: str
    may_be_missing: bool = False
    column: Column | None = None
    values: tuple[tuple[str, int], ...] = ()
    comment: str = ""


def _of_column(layout: Layout, table: Table, column: Column) -> _Draft:
    item = None
    if table.message is not None and column in table.columns:
        item = field_at(table.message.fields, column.path)
    may_be_missing = _may_be_missing(table, column)
    kind = of_any_count(column.type) if may_be_missing else column.type
    way = f"{table.name}.{column.name}"
    type = layout.type_of(kind, None if item is None else item.type, way)
    # A NaN says that a physical value is missing.
    is_flagged = may_be_missing and not (
        isinstance(column.derived, Physical) and isinstance(type, Number) and type.is_float
    )
    role, *rest = column.path
    name = f"frame_{rest[0]}" if role == "@" else column.name
    values = _values(item) if column.derived is None else ()
    return _Draft(name, type, column.name, is_flagged, column, values, _comment(column.facts))


def _may_be_missing(table: Table, column: Column) -> bool:
    """True if a row may have no value for a column."""
    if isinstance(column.type, Listed) and column.derived is not None:
        # Elements may have no physical value, but the list is there where the raw one is.
        raw = next(it for it in table.columns if it.path == column.path and it.derived is None)
        return raw.nullable
    return column.nullable


def _record_members(
    layout: Layout, type: shown.Record, of: Type | None, way: str
) -> Iterator[_Draft]:
    """The members of a record: of a struct its fields, of a switch its cases."""
    kinds = dict(type.members)
    if isinstance(of, Switch):
        for case in of.cases:
            if case.name in kinds:
                inner = layout.type_of(kinds[case.name], case.type, f"{way}.{case.name}")
                yield _Draft(case.name, inner, case.name, may_be_missing=True)
        if of.rest is not None:
            yield _Draft(rest_name(of), BYTES, "", may_be_missing=True)
        return
    assert isinstance(of, Struct)
    for item in of.fields:
        inner = layout.type_of(kinds[item.name], item.type, f"{way}.{item.name}")
        facts = shown.facts_of(item, item.type)
        is_flagged = item.may_be_absent
        values, comment = _values(item), _comment(facts)
        yield _Draft(item.name, inner, item.name, is_flagged, None, values, comment)


def _named(name: str, drafts: Sequence[_Draft], comment: str) -> Message:
    """A message of members that have names, no two of them alike."""
    names = field_names([draft.name for draft in drafts])
    taken = set(names.values())
    constants: set[str] = set()
    members = []
    for draft in drafts:
        own = names[draft.name]
        flag = None
        if draft.may_be_missing:
            flag = free_name(f"has_{own}", taken)
            taken.add(flag)
        named = tuple(_constants(own, draft.values, constants))
        members.append(
            Member(own, draft.type, draft.source, flag, draft.column, named, draft.comment)
        )
    return Message(name, tuple(members), comment)


def _constants(
    field: str, values: Iterable[tuple[str, int]], taken: set[str]
) -> Iterator[Constant]:
    for name, value in values:
        found = free_name(constant_name(field, name), taken)
        taken.add(found)
        yield Constant(found, value)


def _values(item: Field | None) -> tuple[tuple[str, int], ...]:
    """The names of a field's raw values, and of its bits."""
    leaf = None if item is None else item.integer
    if item is None or leaf is None or leaf.role == "bool":
        return ()
    named = [(it.name, it.value) for it in leaf.enum.values] if leaf.enum else []
    named += [(it.name, it.value) for it in item.special]
    return (*named, *_masks(leaf))


def _masks(type: NumberType) -> Iterator[tuple[str, int]]:
    if type.flags is None:
        return
    size = next(bits for bits in (8, 16, 32, 64) if type.bits <= bits)
    for flag in type.flags.bits:
        mask = 1 << flag.bit
        yield flag.name, mask - (1 << size) if type.signed and flag.bit == size - 1 else mask


_SAID = ("values", "special", "flags", "part")
"""Facts that constants and the name of the member tell."""


def _comment(facts: Mapping[str, str]) -> str:
    """What else is known of a member, in a line."""
    known = dict(facts)
    text, unit = known.pop("doc", ""), known.pop("unit", "")
    known = {name: it for name, it in known.items() if name not in _SAID}
    more = ", ".join(f"{name} {value}" for name, value in known.items())
    words = (text, f"[{unit}]" if unit else "", f"({more})" if more else "")
    return " ".join(" ".join(filter(None, words)).split())
