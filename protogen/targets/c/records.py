"""Structs of C: one for each struct and message."""

from __future__ import annotations

from collections.abc import Sequence

from protogen.model.fields import Field
from protogen.model.types import (
    Array,
    Float,
    Integer,
    Octets,
    Struct,
    Switch,
    Text,
    Type,
)
from protogen.targets.c import comments
from protogen.targets.c.helpers import Helpers
from protogen.targets.c.lines import INDENT, Lines
from protogen.targets.c.spelling import counting_type, integer_type
from protogen.targets.c.storage import (
    count_member,
    extent_of,
    fills,
    holds_values,
    is_stored,
    rest_member,
    room,
)


class Records:
    """Writes structs; `tags` are the names of those for structs of the schema."""

    def __init__(self, tags: dict[str, str], helpers: Helpers) -> None:
        self._tags = tags
        self._helpers = helpers

    def definition(self, tag: str, doc: list[str], fields: Sequence[Field]) -> str:
        """The definition of a struct with these fields."""
        lines = Lines(0)
        lines.add(*comments.comment(doc))
        lines.add(f"struct {tag} {{")
        members = Lines(1)
        for field in fields:
            self._member(members, fields, field)
        if not members:
            members.add(
                "/** There are no fields, and C has no empty structs. */", "uint8_t unused;"
            )
        return "\n".join([*lines.lines, *members.lines, "};"])

    def _member(self, lines: Lines, fields: Sequence[Field], field: Field) -> None:
        if fills(field):
            extent = extent_of(field.type)
            assert extent is not None
            what = "elements" if isinstance(field.type, Array) else "bytes"
            lines.add(*comments.comment([f"Number of {what} of {field.name}."], INDENT))
            lines.add(f"{counting_type(room(extent))} {count_member(fields, field)};")
        if is_stored(field):
            lines.add(*comments.comment(comments.of_field(field), INDENT))
            self._declare(lines, field.type, field.name)

    def _declare(self, lines: Lines, type_: Type, name: str) -> None:
        match type_:
            case Integer():
                lines.add(f"{integer_type(type_)} {name};")
            case Float():
                lines.add(f"{self._helpers.float_type(type_)} {name};")
            case Text(extent=extent):
                lines.add(f"char {name}[{max(1, room(extent))}];")
            case Octets(extent=extent):
                lines.add(f"uint8_t {name}[{max(1, room(extent))}];")
            case Struct():
                lines.add(f"struct {self._tags[type_.name]} {name};")
            case Array(element=element, extent=extent):
                self._declare(lines, element, f"{name}[{max(1, room(extent))}]")
            case Switch():
                self._union(lines, type_, name)

    def _union(self, lines: Lines, type_: Switch, name: str) -> None:
        lines.add("union {")
        with lines.indented():
            for case in type_.cases:
                if holds_values(case.type):
                    self._declare(lines, case.type, case.name)
            if type_.rest is not None:
                self._rest(lines, type_, type_.rest)
        lines.add(f"}} {name};")

    def _rest(self, lines: Lines, type_: Switch, greatest: int) -> None:
        lines.add(*comments.comment([f"The bytes where {type_.selector} has another value."], 8))
        lines.add("struct {")
        with lines.indented():
            lines.add(f"{counting_type(greatest)} size;")
            lines.add(f"uint8_t bytes[{max(1, greatest)}];")
        lines.add(f"}} {rest_member(type_)};")
