"""Inline functions that read an element of an array straight out of a payload."""

from __future__ import annotations

from protogen.model.fields import Field
from protogen.model.types import Array, Integer
from protogen.targets.c.comments import comment
from protogen.targets.c.helpers import is_plain, is_whole, joined, sign_extended
from protogen.targets.c.lines import Lines, function
from protogen.targets.c.spelling import Names, integer_type, unsigned_type


def accessor(record: str, field: Field, names: Names) -> str:
    """The function that reads an element of `field`, which lies at a fixed place."""
    assert isinstance(field.type, Array) and isinstance(field.type.element, Integer)
    type_ = field.type.element
    name = names.claim(record, field.name, "at")
    body = Lines()
    start = f"payload + {field.position}" if field.position else "payload"
    step = f"{type_.size} * index" if type_.size > 1 else "index"
    body.add(f"const uint8_t *at = {start} + {step};")
    _read(type_, body)
    doc = comment([f"Reads {field.name}[index] from a payload that was received, unchecked."])
    head = f"static inline {integer_type(type_)} {name}"
    return "\n".join([*doc, function(head, ("const uint8_t *payload", "size_t index"), body)])


def _read(type_: Integer, body: Lines) -> None:
    if type_.role == "bool":
        body.add("return at[0] != 0u;")
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
