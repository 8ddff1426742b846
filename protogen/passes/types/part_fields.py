"""Fields that are parts of the frame: numbers of which the payload has no bytes."""

from __future__ import annotations

from collections.abc import Iterable

from protogen.model.types import Field
from protogen.passes.context import Context, Loc
from protogen.passes.types.declared import Effective
from protogen.passes.types.type_names import Layout
from protogen.schema.syntax.fields import OF_PAYLOADS

BITS = Layout(8, None, packed="lsb_first")
"""The layout of a number that has no bytes of its own."""


def check_part_field(
    context: Context, name: str, item: Effective, in_front: Iterable[Field]
) -> bool:
    """Report what can't be a part of the frame; False where the field can't go on as one."""
    loc = item.at("part")
    if not _is_of_message(item):
        text = "only a field of a message itself is a part of the frame"
        hint = "give the message a field for it, and name that in expressions"
        context.error_at_key("PG291", loc, text, hint)
        return False
    if item.syntax.type in (None, "ascii", "bytes", "float32", "float64", "decimal", "hexadecimal"):
        text = f"`{name}` is a number of the frame, which is an unsigned integer"
        context.error_at_key("PG291", loc, text, "give it the `type` that the part has")
        return False
    for key in OF_PAYLOADS:
        if key in item.syntax.model_fields_set and getattr(item.syntax, key) is not None:
            text = f"`{name}` is a part of the frame, of which the payload has no bytes"
            context.error_at_key("PG291", item.at(key), text, f"leave `{key}` out")
    _check_order(context, name, item, in_front)
    return True


def _is_of_message(item: Effective) -> bool:
    """True for a field of a message; the key stands with the field and in no declared type."""
    loc = item.chain[0][1]
    own = loc[0] == "messages" and len(loc) == 4
    return own and all(link.part is None for link, _ in item.chain[1:])


def _check_order(context: Context, name: str, item: Effective, in_front: Iterable[Field]) -> None:
    loc: Loc = item.at("part")
    for field in in_front:
        if field.part == item.syntax.part:
            text = f"`{field.name}` is the part `{field.part}` already"
            context.error("PG291", loc, text, f"leave `{name}` out")
            return
        if not field.part:
            text = f"`{name}` is a part of the frame, and stands behind `{field.name}`"
            context.error("PG291", loc, text, "fields that are parts come first")
            return
