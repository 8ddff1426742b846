"""Structs of C: one for each struct and message."""

from __future__ import annotations

from collections.abc import Iterable, Sequence

import msgspec

from protogen.c_language.numbers import counting_type, integer_type
from protogen.model.payload_plan import (
    AnyStep,
    BytesStep,
    ChooseStep,
    ConstantStep,
    Count,
    FloatStep,
    IntegerStep,
    OptionalStep,
    RecordStep,
    RegionStep,
    RepeatStep,
)
from protogen.model.payload_walks import held_step
from protogen.model.types import Field, Struct, Text
from protogen.targets.c import comments
from protogen.targets.c.lines import INDENT, Lines
from protogen.targets.c.named import BitsView, Macro, bits_views, meaning
from protogen.targets.c.payload.helpers import Helpers
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
        """The definition of a struct for the values of these steps; its comment if there are none.

        Constants need no room: an encoder writes them, and a decoder takes nothing else. What
        fills the payload has a second member, which says how much it is.
        """
        lines, members = Lines(0), Lines()
        for step in steps:
            self._field(members, step)
        if not members:  # C has no empty structs.
            return "\n".join(comments.comment(doc))
        lines.add(*comments.comment(doc), f"struct {tag} {{")
        return "\n".join([*lines.lines, *members.lines, "};"])

    def _field(self, lines: Lines, step: AnyStep) -> None:
        held = held_step(step)
        if isinstance(step, OptionalStep) and step.presence.member:
            text = f"True if {step.name} is there: it may be left out, with all behind it."
            lines.add(*comments.comment([text], INDENT), f"bool {step.presence.member};")
        if isinstance(held, BytesStep | RepeatStep) and held.count.member:
            what = "elements" if isinstance(held, RepeatStep) else "bytes"
            lines.add(*comments.comment([f"Number of {what} of {step.name}."], INDENT))
            lines.add(f"{counting_type(held.count.greatest)} {held.count.member};")
        if step.holds_values:
            doc = comments.of_field(step.field, self._values_of(step.field))
            lines.add(*comments.comment(doc, INDENT))
            self._member(lines, step, self._names.member(step.name))

    def _values_of(self, item: Field) -> str:
        """What the names of its values, or of its flags, begin with; empty if they have none."""
        integer = item.integer
        named = integer and (integer.enum or integer.flags)
        return self._names.values_of(named.name) if named else ""

    def _member(self, lines: Lines, step: AnyStep, name: str) -> None:
        """The member of that name, which has the sizes of the arrays around it behind it."""
        match step:
            case IntegerStep():
                lines.add(f"{integer_type(step.type)} {name};")
            case FloatStep():
                lines.add(f"{self._helpers.float_type(step.type)} {name};")
            case RecordStep():
                lines.add(f"{self.spelled(step.type)} {name};")
            case BytesStep():
                character = "char" if isinstance(step.type, Text) else "uint8_t"
                lines.add(f"{character} {name}{_places(step.count)};")
            case RepeatStep():
                self._member(lines, step.element, name + _places(step.count))
            case ChooseStep():
                self._union(lines, step, name)
            case OptionalStep() | RegionStep():
                self._member(lines, step.step, name)
            case ConstantStep():
                raise AssertionError("constants have no member")

    def _union(self, lines: Lines, step: ChooseStep, name: str) -> None:
        with lines.block("union", f"}} {name};"):
            for case in step.cases:
                if case.step.holds_values:
                    self._member(lines, case.step, self._names.member(case.step.name))
            if step.rest is not None:
                text = f"The bytes where {step.expression.text} has another value."
                lines.add(*comments.comment([text], 2 * INDENT))
                count = step.rest.count
                with lines.block("struct", f"}} {step.rest.name};"):
                    lines.add(f"{counting_type(count.greatest)} size;")
                    lines.add(f"uint8_t bytes{_places(count)};")


def _places(count: Count) -> str:
    """The size of an array; C has no empty ones."""
    return f"[{max(1, count.greatest)}]"
