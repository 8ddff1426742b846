"""Structs of C: one for each struct and message."""

from __future__ import annotations

from collections.abc import Iterable, Sequence

import msgspec

from protogen.model.payload_plan import AnyStep, RecordStep, RepeatStep
from protogen.model.types import Field, Float, Struct
from protogen.targets.c import comments
from protogen.targets.c.lines import INDENT, Lines
from protogen.targets.c.named import BitsView, Macro, bits_views, meaning
from protogen.targets.c.payload.helpers import Helpers
from protogen.targets.c.payload.struct_members import UNUSED, Member, Union, counter_of, value_of
from protogen.targets.c.spelling import Names


class StructView(msgspec.Struct, frozen=True):
    """A struct, the macros of its fields, and what reads its bits."""

    heading: str
    definition: str
    constants: tuple[Macro, ...]
    bits: tuple[BitsView, ...]


class Records:
    """Writes structs; `tags` are the names of those for structs of the schema."""

    def __init__(self, tags: dict[str, str], names: Names, helpers: Helpers) -> None:
        self._tags = tags
        self._names = names
        self._helpers = helpers

    def view(
        self,
        name: str,
        tag: str,
        doc: list[str],
        fields: Sequence[Field],
        steps: Sequence[AnyStep],
        macros: Iterable[Macro] = (),
    ) -> StructView:
        """The view of a struct or message; further macros go in front of those of its fields."""
        return StructView(
            heading=name,
            definition=self._definition(tag, doc, steps),
            constants=(*macros, *meaning(name, fields, self._names)),
            bits=tuple(bits for f in fields for bits in bits_views(name, f, self._names)),
        )

    def spelled(self, type_: Struct) -> str:
        """A struct of the schema, as `struct rn1_point`."""
        return f"struct {self._tags[type_.name]}"

    def _definition(self, tag: str, doc: list[str], steps: Sequence[AnyStep]) -> str:
        """The definition of a struct for the values of these steps."""
        lines = Lines(0)
        lines.add(*comments.comment(doc))
        lines.add(f"struct {tag} {{")
        members = Lines(1)
        for step in steps:
            self._field(members, step)
        if not members:
            members.add("/** There are no fields, and C has no empty structs. */")
            self._declare(members, UNUSED)
        return "\n".join([*lines.lines, *members.lines, "};"])

    def _field(self, lines: Lines, step: AnyStep) -> None:
        counter, value = counter_of(step), value_of(step)
        if counter is not None:
            what = "elements" if isinstance(step, RepeatStep) else "bytes"
            lines.add(*comments.comment([f"Number of {what} of {step.name}."], INDENT))
            self._declare(lines, counter)
        if value is not None:
            lines.add(*comments.comment(comments.of_field(step.field), INDENT))
            self._declare(lines, value)

    def _declare(self, lines: Lines, member: Member) -> None:
        name = "".join([member.name, *(f"[{count}]" for count in member.counts)])
        match member.type:
            case Float():
                lines.add(f"{self._helpers.float_type(member.type)} {name};")
            case RecordStep():
                lines.add(f"{self.spelled(member.type.type)} {name};")
            case Union():
                self._union(lines, member.type, name)
            case tuple():
                self._struct(lines, member.type, name)
            case spelled:
                lines.add(f"{spelled} {name};")

    def _union(self, lines: Lines, union: Union, name: str) -> None:
        lines.add("union {")
        with lines.indented():
            for case in union.cases:
                self._declare(lines, case)
            if union.rest is not None:
                text = f"The bytes where {union.selector} has another value."
                lines.add(*comments.comment([text], 8))
                self._declare(lines, union.rest)
        lines.add(f"}} {name};")

    def _struct(self, lines: Lines, members: Sequence[Member], name: str) -> None:
        lines.add("struct {")
        with lines.indented():
            for member in members:
                self._declare(lines, member)
        lines.add(f"}} {name};")
