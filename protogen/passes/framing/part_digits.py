"""Numbers in frames that are written as text digits."""

from __future__ import annotations

import re

from protogen.copying import replace
from protogen.model.parts import PartType
from protogen.passes.context import Context, Loc
from protogen.passes.types.fixed_digits import (
    NOT_IN_SEVEN_BITS,
    FixedDigits,
    digits_of,
    has_no_order,
)
from protogen.passes.types.type_names import type_hint
from protogen.schema.syntax.parts import Part


def is_written(item: Part) -> bool:
    """True if a part says how it is written as text, rightly or not."""
    return any(key is not None for key in (item.digits, item.code, item.chars))


def part_type_hint(name: str) -> str | None:
    """Type that was probably meant for a part."""
    signed = re.fullmatch(r"sint(\d+)", name)
    if signed is not None:
        return f"parts have no sign: uint{signed[1]}"
    if name.startswith("float"):
        return "parts are integers, such as uint32, or texts"
    if name not in ("decimal", "hexadecimal"):
        return type_hint(name)
    digits = "base10" if name == "decimal" else "base16-upper"
    text = "a receiver has to know where the part ends, so it has as many digits each time"
    return f"{text}: `{{type: uint16, digits: {digits}, chars: 5}}`"


def digits_type(context: Context, loc: Loc, item: Part, found: PartType) -> PartType | None:
    """Type of a part that is written as digits; None where it can't be."""
    before = context.tally.errors
    fixed = _digits(context, loc, item)
    if found.role != "number":
        text = f"`{fixed.key}` is for integers such as uint16, and not for {found.name}"
        context.error_at_key("PG224", (*loc, fixed.key), text)
        return None
    if found.byte_bits == 7:
        context.error_at_key("PG224", (*loc, fixed.key), NOT_IN_SEVEN_BITS)
    numeral = fixed.of(found) if fixed.is_one_kind() else None
    if numeral is None or context.tally.errors > before:
        return None
    type_ = replace(found, text=numeral, byte_order="little")
    if item.algorithm is None:
        no_byte_order(context, loc, item, type_)
    return type_


def no_byte_order(context: Context, loc: Loc, item: Part, type_: PartType) -> None:
    """Report a byte order of digits; a checksum may have one for the words that it adds."""
    if type_.text is not None:
        has_no_order(context, item.byte_order, (*loc, "byte_order"))


def too_few_digits(context: Context, loc: Loc, item: Part, what: str, greatest: int) -> None:
    """Report that a checksum has values that its digits can't stand for."""
    fixed = _digits(context, loc, item)
    numeral = fixed.of(PartType(bits=greatest.bit_length()))
    if numeral is not None:
        fixed.too_few(what, digits_of(greatest, numeral.base), numeral.size)


def _digits(context: Context, loc: Loc, item: Part) -> FixedDigits:
    return FixedDigits(context, item, lambda key: (*loc, key))
