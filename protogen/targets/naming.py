"""Names that a target emits: what each stands for, and which it escapes.

A document's name is never refused for a language's sake. A name that the language reserves, or that
something else has, gets `_` behind it. No name of a schema ends so.
"""

from __future__ import annotations

from collections.abc import Iterable

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
        """Kind and name, such as "field `gyro.int_x`". Made only where the reference lists it."""
        if len(self.place) < len(("kind", "name")):
            return self.kind
        names = self.place[-1:] if self.place[0] == "frame" else self.place[1::2]
        return f"{self.kind} `{'.'.join(map(str, names))}`"


OWN = Thing("a word of the language, or a name that generated code uses itself")
PROTOCOL = Thing("protocol", ("protocol",))


class NameTable:
    """Names of one scope."""

    def __init__(self, reserved: Iterable[str] = ()) -> None:
        self.things: dict[str, Thing] = dict.fromkeys(reserved, OWN)
        """What each name stands for."""
        self.escaped: dict[Thing, list[str]] = {}
        """The names that have `_` behind them because another thing had them already."""

    def copy(self) -> NameTable:
        """A table that names can be added to without a change of this one."""
        table = NameTable()
        table.things = self.things.copy()
        table.escaped = {thing: names.copy() for thing, names in self.escaped.items()}
        return table

    def add(self, name: str, thing: Thing = OWN) -> str:
        """The name for this thing, which is escaped where another has it.

        The same thing may be named again, and is then called the same.
        """
        found = name
        while (holder := self.things.setdefault(found, thing)) is not thing and holder != thing:
            found += "_"
        if found != name:
            self.note(thing, found)
        return found

    def note(self, thing: Thing, name: str) -> None:
        """Keep a name that was escaped for this thing."""
        names = self.escaped.setdefault(thing, [])
        if name not in names:
            names.append(name)


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
