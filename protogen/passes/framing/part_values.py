"""Values of parts as they are written: numbers, characters, or texts."""

from __future__ import annotations

from typing import Literal

from protogen.model.parts import NumberPart, PartType
from protogen.model.types import ByteOrder
from protogen.passes.context import Context, Loc
from protogen.schema.hints import number_hint
from protogen.schema.syntax.parts import Part

_LAST_OF_ASCII = 0x7F


def text_type(context: Context, loc: Loc, item: Part, byte_bits: Literal[7, 8]) -> PartType | None:
    """Type of a part that is a text; None where it can't be one."""
    before = context.tally.errors
    if item.type != "ascii":
        text = "only a text has a size; that of a number is part of its type"
        context.error("PG192", (*loc, "size"), text, "write `type: ascii`, or leave out `size`")
    elif item.size is None:
        text = "nothing says how many characters the text has"
        context.error("PG192", (*loc, "type"), text, "add `size`, such as `size: 3`")
    for key in ("counts", "counter", "algorithm"):
        if getattr(item, key) is not None:
            text = f"`{key}` is for a number, and this part is a text"
            context.error("PG192", (*loc, key), text, "give it a type such as `uint8`")
    for key in ("byte_order", "digits", "chars", "code"):
        if getattr(item, key) is not None:
            context.error("PG192", (*loc, key), f"a text has no `{key}`", f"leave out `{key}`")
    if context.tally.errors > before or item.size is None:
        return None
    order: ByteOrder = "big" if item.size > 1 else "little"
    bits = byte_bits * item.size
    return PartType(bits=bits, byte_bits=byte_bits, byte_order=order, role="ascii")


def text_bounds(context: Context, loc: Loc, item: Part, type_: PartType) -> tuple[int, int]:
    """The least and the greatest text: all characters are the first, or the last, that may be."""
    if item.range is None:
        return type_.least, type_.greatest
    first, last = item.range
    if first > last:
        text = f"the range is empty: {first} is greater than {last}"
        context.error("PG115", (*loc, "range"), text)
    elif not 0 <= first <= last <= _LAST_OF_ASCII:
        text = f"the characters of a text are 0 to {_LAST_OF_ASCII}, not {first} to {last}"
        context.error("PG114", (*loc, "range"), text)
    each = sum(1 << type_.byte_bits * place for place in range(type_.size))
    return first * each, last * each


def number_of(context: Context, loc: Loc, part: NumberPart, value: int | str) -> int | None:
    """The number that is meant; None where it is none of the part."""
    problem = _wrong(part, value)
    if problem is not None:
        context.error("PG192", loc, *problem)
        return None
    if isinstance(value, str) and not part.type.is_text:
        return ord(value)
    return part.raw(value)


def _wrong(part: NumberPart, value: int | str) -> tuple[str, str] | None:
    """Reason why the value is none of the part, and what to do about it."""
    size = part.type.size
    characters = "one character" if size == 1 else f"{size} characters"
    if not part.type.is_text:
        if isinstance(value, int) or len(value) == 1:
            return None
        text = f"`{value}` is no number, as `{part.name}` is"
        hint = number_hint(value) if any(map(str.isdigit, value)) else None
        kind = _as_text(part.type, value)
        return text, hint or f"write an integer or one character, or make it `{kind}`"
    if isinstance(value, int):
        return f"{value} is a number, and `{part.name}` a text", f"write {characters}, in quotes"
    if len(value) != size:
        return f"`{value}` has not {characters}, as `{part.name}` has", "fill it up, or cut it"
    if not value.isascii():
        return f"`{value}` has a character that is not ASCII", "write letters, digits and marks"
    return None


def _as_text(type_: PartType, value: str) -> str:
    return f"type: ascii, size: {max(type_.size, len(value))}"
