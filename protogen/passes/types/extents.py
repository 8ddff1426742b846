"""Extents: the number of elements or bytes of a field."""

from __future__ import annotations

from fractions import Fraction

from protogen.model.expressions import Number, named
from protogen.model.nesting import can_count
from protogen.model.types import Counted, Extent, Field, Fill, Fixed, is_integer
from protogen.passes.context import Context, Loc
from protogen.passes.types.expressions import Worked, number
from protogen.passes.types.setting import Setting
from protogen.schema.syntax.fields import Fill as FillSyntax

Written = int | str | FillSyntax | None


def extent_of(
    context: Context, written: Written, loc: Loc, element: Fraction | int, setting: Setting
) -> Extent:
    """Number of elements of at least `element` bytes each, which `count` or `size` states.

    What the schema does not bound is bounded by the frame.
    """
    if isinstance(written, FillSyntax):
        return _fill(context, written, loc, element, setting)
    if not isinstance(written, str):
        return Fixed(count=written or 0)
    field = setting.outer.get(written)
    if field is not None and not can_count(field.type):
        context.error("PG117", loc, *_why_not(field))
        return Fixed(count=0)
    found = number(context, written, loc, setting)
    if found is None:
        return Fixed(count=0)
    if field is not None:
        return _counted_by(field, element, setting.room)
    return _worked_out(context, found, loc, element, setting)


def _worked_out(
    context: Context, found: Worked, loc: Loc, element: Fraction | int, setting: Setting
) -> Extent:
    """The number of an expression, which is refused where it is out of bounds."""
    least, greatest = found.bounds
    if isinstance(found.expression, Number):
        least = greatest = found.expression.value
    if greatest < 0:
        text = f"`{found.expression.text}` is never more than {greatest}"
        what = "is no number of bytes" if loc[-1] == "size" else "counts nothing"
        context.error("PG203", loc, f"{text}, and {what}")
        return Fixed(count=0)
    if isinstance(found.expression, Number):
        return Fixed(count=greatest)
    if setting.room is not None and not found.is_ranged:
        greatest = min(greatest, setting.room // element)
    least = min(max(0, least), greatest)
    by, is_stated = found.expression, found.is_ranged
    return Counted(by=by, least=least, greatest=greatest, stated=is_stated)


def _why_not(field: Field) -> tuple[str, str | None]:
    """The reason why a field can't count, and what to do."""
    type_ = field.type
    if is_integer(type_) and (type_.flags is not None or type_.bit_fields):
        text = f"`{field.name}` can't count: it is made of single bits, which would all be counted"
        return text, "declare the number without `bits` and `flags`, or let `fill` take the rest"
    return f"`{field.name}` can't count: it is not an unsigned integer", None


def _fill(
    context: Context, written: FillSyntax, loc: Loc, element: Fraction | int, setting: Setting
) -> Fill:
    if written.fill is None:
        text = "nothing says where this ends: only a text between separators does so by itself"
        context.error("PG298", loc, text, "take all that is left: `fill: true`, or count it")
    elif not setting.delimited:
        text = "the frame does not say where the payload ends, so nothing can fill it"
        context.error("PG118", loc, text, "give a count, or a length part to the frame")
    elif written.max is None and setting.room is None:
        text = "nothing bounds this: the frame has no length part"
        hint = "give it a bound: {fill: true, max: 64}, or all frames: `max_frame: 256`"
        context.error("PG118", loc, text, hint)
    greatest = (setting.room or 0) // element if written.max is None else written.max
    least = written.min
    is_bounded = written.max is not None or setting.room is not None
    if least and is_bounded and least >= greatest:
        _no_choice(context, written, (*loc, "min"), greatest)
        least = 0
    return Fill(least=least, greatest=greatest, stated=written.max is not None)


def _no_choice(context: Context, written: FillSyntax, loc: Loc, greatest: int) -> None:
    """Report a least number that leaves nothing to the payload's size."""
    if written.min > greatest:
        what = "`max` allows" if written.max is not None else "the frame has room for"
        context.error("PG180", loc, f"{written.min} are more than the {greatest} that {what}")
    else:
        text = f"there are always {greatest}, so nothing depends on where the payload ends"
        context.error("PG180", loc, text, f"write the number {greatest} in place of the fill")


def _counted_by(field: Field, element: Fraction | int, room: int | None) -> Counted:
    by = named(field.name)
    if isinstance(field.const, int):
        return Counted(by=by, least=field.const, greatest=field.const, stated=True)
    least, greatest = int(field.least or 0), int(field.greatest or 0)
    if room is not None and not field.ranged:
        greatest = min(greatest, room // element)
    return Counted(by=by, least=least, greatest=greatest, stated=field.ranged)
