"""Inline functions that read an element of an array straight out of a payload."""

from __future__ import annotations

from protogen.model.payload_builder import plan_of
from protogen.model.payload_plan import (
    AnyStep,
    FloatStep,
    IntegerStep,
    NumberStep,
    RecordStep,
    RepeatStep,
)
from protogen.targets.c.comments import comment
from protogen.targets.c.lines import Lines, function
from protogen.targets.c.payload.helpers import Helpers, is_plain, is_whole, joined, sign_extended
from protogen.targets.c.payload.loading import Load
from protogen.targets.c.payload.records import Records
from protogen.targets.c.spelling import Names, integer_type, unsigned_type


def is_readable(step: AnyStep) -> bool:
    """True if there is such a function: elements of one size lie at a place that is known."""
    if not isinstance(step, RepeatStep) or step.field.position is None:
        return False
    element = step.element
    if isinstance(element, RecordStep):
        # Nothing outside of it may say what is in it.
        return bool(element.sizes.fixed and element.holds_values) and not element.type.needs
    return isinstance(element, NumberStep)


class Accessors:
    """Writes these functions."""

    def __init__(self, names: Names, helpers: Helpers, records: Records) -> None:
        self._names = names
        self._helpers = helpers
        self._records = records

    def of(self, record: str, step: AnyStep) -> tuple[str, ...]:
        """The function that reads an element, where it `is_readable` and has anything to read."""
        if not isinstance(step, RepeatStep) or not is_readable(step):
            return ()
        field, element = step.field, step.element
        body = Lines()
        start = f"payload + {field.position}" if field.position else "payload"
        size = element.sizes.greatest
        distance = f"{size} * index" if size > 1 else "index"
        place = f"const uint8_t *at = {start} + {distance};"
        body.add(place)
        arguments: tuple[str, ...] = ("const uint8_t *payload", "size_t index")
        match element:
            case IntegerStep():
                type_ = integer_type(element.type)
                _read(element, body)
            case FloatStep():
                type_ = self._helpers.float_type(element.type)
                with self._helpers.public():
                    body.add(f"return {self._helpers.load(element.type)}(at);")
            case RecordStep():
                type_ = "void"
                arguments = (*arguments, f"{self._records.spelled(element.type)} *out")
                with self._helpers.public():
                    Load(self._helpers, body).pointed(plan_of(element.type.fields), "out->")
            case _:
                raise AssertionError(element)
        body.drop_unused_places()
        if place not in map(str.strip, body.lines):
            return ()
        name = self._names.claim(record, field.name, "at")
        doc = comment([f"Reads {field.name}[index] from a payload that was received, unchecked."])
        text = function(f"static inline {type_} {name}", arguments, body)
        return ("\n".join([*doc, text]),)


def _read(step: IntegerStep, body: Lines) -> None:
    type_ = step.type
    if type_.role == "bool":
        body.add("return at[0] != 0U;")
    elif is_plain(type_):
        body.add(f"return {f'({integer_type(type_)})' if type_.signed else ''}at[0];")
    elif not type_.signed:
        body.add(*joined(type_, "at"))
    else:
        *before, last = joined(type_, "at")
        raw = last.removeprefix("return ").removesuffix(";")
        if is_whole(type_) or raw == "value":
            body.add(*before)
        else:
            body.add(*before, f"const {unsigned_type(type_.bits)} raw = {raw};")
            raw = "raw"
        body.add(f"return {sign_extended(type_, raw)};")
