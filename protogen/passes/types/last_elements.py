"""Arrays that end with the element that says that it is the last."""

from __future__ import annotations

from math import ceil, floor

from protogen.model.expressions import Operand
from protogen.model.types import Field, Marked, Struct, Type, is_integer
from protogen.passes.context import Context, Loc
from protogen.passes.types.declared import Effective
from protogen.passes.types.delimited import Ending, bounds_within
from protogen.passes.types.expressions import inside_of
from protogen.passes.types.setting import Setting
from protogen.schema.syntax.fields import FieldSyntax, UntilElement

_NOT_FOUND = Operand(("last",))
"""Stands for a mark that was reported."""


def is_marked_array(syntax: FieldSyntax) -> bool:
    """True if a field is an array whose last element says so."""
    return isinstance(syntax.until, UntilElement)


def check_last_element(context: Context, name: str, item: Effective) -> None:
    """Report a last element where there are no elements that could say so, or more says it."""
    syntax, loc = item.syntax, item.at("until")
    if syntax.fields is None:
        text = f"a field of the last element ends an array of structs; `{name}` has no fields"
        hint = "give the elements `fields`, or name a type that has some"
        context.error_at_key("PG265", loc, text, hint)
    elif item.setting.layout.separator is not None:
        text = f"`{name}` has fields that are text, and ends where its last separator does"
        hint = "take as many as there are, `count: fill`, or count them"
        context.error_at_key("PG265", loc, text, hint)
    elif syntax.count is not None or syntax.size is not None:
        key = "size" if syntax.count is None else "count"
        text = f"the last element ends `{name}`, so nothing else says how many there are"
        hint = f"leave `{key}` out; the greatest number is `until: {{element: ..., max: ...}}`"
        context.error_at_key("PG265", item.at(key), text, hint)


def marked_extent(
    context: Context, written: UntilElement, loc: Loc, element: Type, setting: Setting
) -> Marked:
    """The number of elements up to the one that says that it is the last.

    What the schema does not bound is bounded by the frame.
    """
    mark = _mark(context, written.element, (*loc, "element"), element)
    greatest = written.max
    if greatest is None:
        greatest = (setting.room or 0) // max(1, element.sizes.least)
    ending = Ending(
        code="PG268",
        name="the last element",
        example=f"{{element: {written.element}, max: 8}}",
        instead=f"`count: {greatest}` in place of `until`",
        least=1,
    )
    least, greatest = bounds_within(context, written, loc, setting, greatest, ending)
    return Marked(mark=mark, least=least, greatest=greatest, stated=written.max is not None)


def _mark(context: Context, written: str, loc: Loc, element: Type) -> Operand:
    """What an element says, as a name of one of its members, or of bits of one."""
    if not isinstance(element, Struct):
        return _NOT_FOUND  # Which was reported.
    found = inside_of(context, written, loc, element, "PG266")
    if found is None:
        return Operand((written,))
    mark, field = found
    assert is_integer(field.type)
    if field.type.signed:
        text = f"`{mark.label}` is no unsigned number, so it does not say what is the last"
        context.error(
            "PG266", loc, text, "name a bool, a flag, a run of bits or an unsigned number"
        )
    elif mark.run is None:
        _can_change(context, mark, loc, field)
    return mark


def _can_change(context: Context, mark: Operand, loc: Loc, field: Field) -> None:
    """Report a number that is never 0, or always, whatever element it is in."""
    least = 0 if field.least is None else ceil(field.least)
    greatest = None if field.greatest is None else floor(field.greatest)
    values = [0] * (least <= 0) + [1] * (greatest is None or greatest > 0)
    if isinstance(field.const, int):
        values = [field.const]
    elif is_integer(field.type) and field.type.enum is not None and field.type.is_closed:
        values = [item.value for item in field.type.enum.values]
    else:
        values += [item.value for item in field.special]
    if 0 in values and any(values):
        return
    always = "always 0, so no element" if 0 in values else "never 0, so every element"
    text = f"`{mark.label}` is {always} says that it is the last"
    context.error("PG267", loc, text, "name a field that is 0 in all elements but the last")
