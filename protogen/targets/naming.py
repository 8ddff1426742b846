"""Names that a target emits: what each stands for, and which of them would stand for two things."""

from __future__ import annotations

from collections.abc import Mapping

import msgspec

Place = tuple[str | int, ...]
"""Keys of the schema, from the root; `records` stands for messages and for named types."""


class Thing(msgspec.Struct, frozen=True):
    """What a name stands for."""

    kind: str
    """Kind of thing, such as `field`; for a name that is not of the schema, what it is."""
    place: Place = ()
    """Place in the schema, if the name is of it."""

    @property
    def what(self) -> str:
        """Kind and name, such as "field `gyro.int_x`". Made only where a problem is reported."""
        if len(self.place) < len(("kind", "name")):
            return self.kind
        names = self.place[-1:] if self.place[0] == "frame" else self.place[1::2]
        return f"{self.kind} `{'.'.join(map(str, names))}`"


OWN = Thing("generated code uses itself")
PROTOCOL = Thing("protocol", ("protocol",))


class Clash(msgspec.Struct, frozen=True):
    """A name that would stand for two things."""

    name: str
    first: Thing
    second: Thing


class NameTable:
    """Names of one scope. The same thing may be named again."""

    def __init__(self) -> None:
        self.things: dict[str, Thing] = {}
        """The first thing of each name."""
        self.clashes: list[Clash] = []

    def copy(self) -> NameTable:
        """A table that names can be added to without a change of this one."""
        table = NameTable()
        table.things, table.clashes = self.things.copy(), self.clashes.copy()
        return table

    def add(self, name: str, thing: Thing = OWN) -> str:
        """The name, which stands for this."""
        first = self.things.setdefault(name, thing)
        if first is not thing and first != thing:
            self.clashes.append(Clash(name, first, thing))
        return name

    def enter(self, name: str, thing: Thing, hidden: Mapping[str, Thing]) -> None:
        """The name of something in a scope inside of this, which may hide none of these."""
        self.things.setdefault(name, thing)
        if name in hidden:
            self.clashes.append(Clash(name, hidden[name], thing))


def message(name: str) -> Thing:
    """A message."""
    return Thing("message", ("records", name))


def named_type(name: str) -> Thing:
    """An enum, flags or a struct, declared or written in a field."""
    return Thing("type", ("records", name))


def endpoint(name: str) -> Thing:
    """A side of the link."""
    return Thing("endpoint", ("endpoints", name))


def part(sender: str, name: str) -> Thing:
    """A part of a frame."""
    return Thing("part", ("frame", sender, name))


def value(type_: str, name: str) -> Thing:
    """A value of an enum."""
    return Thing("value", ("records", type_, "values", name))


def flag(type_: str, name: str) -> Thing:
    """A flag of a set."""
    return Thing("flag", ("records", type_, "flags", name))


def inside(record: str, kind: str, field: str, *rest: str) -> Thing:
    """A field of a record, or something of it: `special value`, `state`, `special`, `none`."""
    return Thing(kind, ("records", record, "fields", field, *rest))
