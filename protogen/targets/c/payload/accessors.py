"""Inline functions that read a value, or an element of an array, straight out of a payload."""

from __future__ import annotations

from protogen.c_language.numbers import integer_type, unsigned, unsigned_type
from protogen.model.payload_builder import plan_of_struct
from protogen.model.payload_plan import (
    AnyStep,
    FloatStep,
    IntegerStep,
    NumberStep,
    RecordStep,
    RepeatStep,
)
from protogen.model.types import NumberType
from protogen.targets.c.comments import comment
from protogen.targets.c.lines import Lines, function
from protogen.targets.c.payload.helpers import Helpers
from protogen.targets.c.payload.loading import Load
from protogen.targets.c.payload.number_bytes import is_plain, is_whole, joined, sign_extended
from protogen.targets.c.payload.numerals import Digits
from protogen.targets.c.payload.records import Records
from protogen.targets.c.spelling import Names
from protogen.targets.naming import inside


def is_readable(step: AnyStep) -> bool:
    """True if there is such a function: elements of one size lie at a place that is known."""
    is_placed = isinstance(step, RepeatStep) and step.field.position is not None
    return is_placed and has_fixed_elements(step)


def has_fixed_elements(step: AnyStep) -> bool:
    """True for an array of elements of one size that begin at whole bytes."""
    if not isinstance(step, RepeatStep) or step.packing is not None:
        return False
    element = step.element
    if isinstance(element, RecordStep):
        # Nothing outside of it may say what is in it.
        return bool(element.sizes.fixed and element.holds_values) and not element.type.needs
    if isinstance(element, IntegerStep) and element.type.is_free:
        return False  # It ends at a separator, however few digits it may have.
    return isinstance(element, NumberStep) and element.sizes.fixed is not None


def claim_accessor(names: Names, record: str, field: str) -> str:
    """The name of the function that reads an element of a field."""
    return names.claim(inside(record, "field", field), record, field, "at")


def accessor(
    record: str, step: AnyStep, names: Names, helpers: Helpers, records: Records
) -> str | None:
    """The function that reads an element, where it `is_readable` and has anything to read."""
    if not isinstance(step, RepeatStep) or not is_readable(step):
        return None
    field, size = step.field, step.element.sizes.greatest
    start = f"payload + {unsigned(field.position)}" if field.position else "payload"
    place = f"{start} + {f'{unsigned(size)} * index' if size > 1 else 'index'}"
    doc = f"Reads {field.name}[index] from a payload that was received, unchecked."
    name = claim_accessor(names, record, field.name)
    return reader(name, ("size_t index",), pointing(place), doc, step.element, helpers, records)


def pointing(place: str, body: Lines | None = None) -> Lines:
    """Statements behind which `at` points to a place; those in front declare what that needs."""
    lines = Lines() if body is None else body
    lines.add(f"const uint8_t *at = {place};")
    return lines


def reader(
    name: str,
    arguments: tuple[str, ...],
    body: Lines,
    doc: str,
    element: AnyStep,
    helpers: Helpers,
    records: Records,
) -> str | None:
    """The inline function that reads what lies where `body` points to; None if that is nothing."""
    declaration = body.lines[-1]
    arguments = ("const uint8_t *payload", *arguments)
    with helpers.public():
        match element:
            case IntegerStep():
                type_ = integer_type(element.type)
                if element.type.text is None:
                    _read(element.type, body)
                else:
                    body.add(f"return {Digits.of(element.type).value(helpers, 'at')};")
            case FloatStep():
                type_ = helpers.float_type(element.type)
                body.add(f"return {helpers.load(element.type)}(at);")
            case RecordStep():
                type_ = "void"
                arguments = (*arguments, f"{records.spelled(element.type)} *out")
                load = Load(helpers, body)
                load.pointed(plan_of_struct(element.type), "out->")
                if load.reads_size:
                    return None  # A text goes up to a separator, or to the end of the payload.
            case _:
                raise AssertionError(element)
    body.drop_unused_places()
    if declaration not in body.lines:
        return None
    return "\n".join([*comment([doc]), function(f"static inline {type_} {name}", arguments, body)])


def _read(type_: NumberType, body: Lines) -> None:
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
        body.add(*sign_extended(type_, raw))
