"""Fields that a separator stands between: each is text, which the next separator ends."""

from __future__ import annotations

from collections.abc import Mapping

from protogen.copying import replace
from protogen.model.meanings import Enum, NamedValue
from protogen.model.numbers import FreeNumeral
from protogen.model.types import Between, Fixed, Integer, NumberType, Type, is_integer
from protogen.passes.context import Context, Loc
from protogen.passes.types.declared import Effective
from protogen.passes.types.extents import extent_of
from protogen.schema.syntax.fields import FieldSyntax, Fill
from protogen.schema.syntax.messages import MessageSyntax, Separator

_TYPES = ("decimal", "hexadecimal", "char")
_PRINTABLE = bytes(range(0x20, 0x7F))
"""Characters that a text between separators can have."""


def separator_of(context: Context, syntax: MessageSyntax, loc: Loc) -> Separator | None:
    """The separator of a message's fields, if it has one and may have one."""
    found, here = syntax.separator, (*loc, "separator")
    if found is None:
        return None
    if isinstance(syntax.fields, str) or not syntax.fields:
        context.error_at_key("PG226", here, "there are no fields to separate")
        return None
    if context.syntax.byte_bits != 8:
        text = "fields that are text have bytes of 8 bits, and `byte_bits` is 7"
        context.error_at_key("PG226", here, text)
        return None
    return found


def check_separated(context: Context, name: str, item: Effective) -> bool:
    """Report a field that no separator can stand beside; False where there is one."""
    syntax, setting = item.syntax, item.setting
    if syntax.without is not None and (setting.layout.separator is None or syntax.type != "ascii"):
        text = "only an ascii field between separators is without some characters"
        context.error_at_key("PG298", item.at("without"), text, "leave `without` out")
    if setting.layout.separator is None:
        if syntax.empty is not None:
            text = "nothing is empty where no separator stands beside it"
            hint = "give the message a `separator`"
            context.error_at_key("PG228", item.at("empty"), text, hint)
        return True
    is_text = syntax.type in (*_TYPES, "ascii") and syntax.const is None
    if syntax.empty is not None and (not is_text or syntax.type == "ascii"):
        text = f"`{name}` can't be empty: only decimal, hexadecimal and char can"
        context.error_at_key("PG228", item.at("empty"), text)
    if syntax.type is None or is_text:
        if setting.leads or (is_text and syntax.count is None):
            return True
        text = f"`{name}` comes first, so no separator stands in front of it, but inside"
        hint = "put a single number in front of it, or let a separator stand there: `in_front`"
        context.error_at_key("PG226", item.chain[0][1], text, hint)
        return False
    kinds = "decimal, hexadecimal, ascii and closed char"
    text = f"`{name}` can't be separated: only {kinds} can"
    hint = "leave `separator` out, or write the number as text"
    context.error_at_key("PG226", item.chain[0][1], text, hint)
    return False


def text_between(context: Context, item: Effective) -> Between:
    """The characters of a text that stands between separators, or behind the last one."""
    written, setting, loc = item.syntax.size, item.setting, item.at("size")
    separator = setting.layout.separator or 0
    bounds = Fixed(count=0).counts
    if not isinstance(written, Fill) or item.syntax.until is not None:
        text = "a text between separators ends where the next one begins"
        hint = "say how long it can be, `size: {max: 20}`, or take all that is left, `size: fill`"
        key = "until" if item.syntax.until is not None else "size"
        context.error_at_key("PG298", item.at(key), text, hint)
    elif written.min and written.min == written.max:
        bounds = Fixed(count=written.min).counts
    else:
        filled = written.model_copy(update={"fill": True})
        bounds = extent_of(context, filled, loc, 1, setting).counts
    fills = isinstance(written, Fill) and written.fill is not None
    excluded = {*(item.syntax.without or ()), *(() if fills else (separator,))}
    return Between(
        separator=separator,
        leads=setting.leads,
        characters=bytes(character for character in _PRINTABLE if character not in excluded),
        least=bounds.least,
        greatest=bounds.greatest,
        stated=isinstance(written, Fill) and written.max is not None,
    )


def is_for_separators(syntax: FieldSyntax, types: Mapping[str, FieldSyntax]) -> bool:
    """True if a declared type is a number that is written as text, or has nothing but texts."""
    items = (syntax.fields or {"": syntax}).values()
    if any(_is_text_between(item) for item in items):
        return True
    kinds = {item.type for item in items}
    return not kinds.isdisjoint(_TYPES[:2]) and all(it in _TYPES or it in types for it in kinds)


def _is_text_between(syntax: FieldSyntax) -> bool:
    """True for a text that can stand nowhere else."""
    is_open = isinstance(syntax.size, Fill) and syntax.size.fill is None
    return syntax.type == "ascii" and (is_open or syntax.without is not None)


def character(context: Context, item: Effective) -> Integer | None:
    """The type of a char that separators stand beside; None for other fields."""
    layout, syntax = item.setting.layout, item.syntax
    if layout.separator is None or syntax.type != "char":
        return None
    if not syntax.values or not syntax.closed:
        text = "nothing says that this is not the separator: the values are not known"
        hint = "name the characters, and say that there are no others: `values`, `closed: true`"
        context.error_at_key("PG226", item.at("type"), text, hint)
    form = FreeNumeral(
        base=256,
        separator=layout.separator,
        leads=item.setting.leads,
        empty=syntax.empty is not None,
    )
    return Integer(bits=8, role="char", text=form)


def with_absent(context: Context, found: NumberType, item: Effective) -> NumberType:
    """The number, with a name for having no text where it is a character."""
    form = found.text
    if not isinstance(form, FreeNumeral) or form.separator is None or not is_integer(found):
        return found
    _check_separator(context, found, form, item)
    if not form.empty:
        return found
    _check_names(context, found, item)
    if form.base != 256 or found.enum is None:
        return found
    return replace(found, enum=_with_value(found.enum, item.syntax.empty or "", form.absent))


def absent_value(type_: Type, item: Effective) -> tuple[NamedValue, ...]:
    """The special value that having no text is, of a number."""
    form = type_.text if is_integer(type_) else None
    if not isinstance(form, FreeNumeral) or not form.empty or form.base == 256:
        return ()
    return (NamedValue(name=item.syntax.empty or "", value=form.absent),)


def _with_value(enum: Enum, name: str, value: int) -> Enum:
    return replace(enum, values=(*enum.values, NamedValue(name=name, value=value)))


def _check_separator(context: Context, found: Integer, form: FreeNumeral, item: Effective) -> None:
    """Report a separator that can also be part of the text."""
    if form.base != 256:
        characters = form.alphabet(signed=found.signed)
    else:
        characters = bytes(found.enum.characters) if found.enum else b""
    byte = form.separator
    if byte is not None and byte in characters:
        shown = f"`{chr(byte)}`" if 0x20 < byte < 0x7F else f"{byte:02X}"
        text = f"{shown} separates the fields, and can occur in this one"
        context.error("PG227", item.at("type"), text, "take a separator that no field can have")


def _check_names(context: Context, found: Integer, item: Effective) -> None:
    """Report names that stand in the way of that of having no text."""
    syntax, name = item.syntax, item.syntax.empty
    loc = item.at("empty")
    if name in {**(syntax.values or {}), **(syntax.special or {})}:
        context.error("PG228", loc, f"`{name}` is another value already")
    elif found.role == "char":
        if found.enum is not None and any(value.value == 0 for value in found.enum.values):
            context.error("PG228", loc, "the character 0 is what having none stands for")
    elif syntax.flags is not None or syntax.bits is not None or syntax.closed:
        text = "having no text is a number of its own, which has neither name nor bits here"
        hint = "leave `empty` out, or `flags`, `bits` and `closed`"
        context.error("PG228", loc, text, hint)
