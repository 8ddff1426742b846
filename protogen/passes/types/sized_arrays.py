"""Arrays whose number of bytes is told, instead of the number of their elements."""

from __future__ import annotations

from protogen.copying import replace
from protogen.model.expressions import Quotient
from protogen.model.types import Counted, Extent, Fill, Fixed
from protogen.passes.context import Context, Loc
from protogen.passes.types.declared import Effective
from protogen.passes.types.extents import Written
from protogen.schema.syntax.fields import FieldSyntax
from protogen.schema.syntax.fields import Fill as FillSyntax

_STRINGS = ("ascii", "bytes")


def is_sized_array(syntax: FieldSyntax) -> bool:
    """True if a field is an array whose size in bytes is told."""
    if syntax.size is None or syntax.type in _STRINGS or syntax.switch is not None:
        return False
    return syntax.fields is None or syntax.count is not None


def check_size(context: Context, item: Effective) -> None:
    """Report a size where something else says the same."""
    syntax = item.syntax
    if syntax.size is None or syntax.type in _STRINGS:
        return
    if not is_sized_array(syntax):
        what = "a switch has that of its cases" if syntax.switch else "a struct that of its fields"
        text = f"`size` is for ascii, bytes and arrays; {what}"
        hint = None if syntax.switch else "for several of them write `count: fill` beside the size"
        context.error_at_key("PG240", item.at("size"), text, hint)
    elif syntax.count is not None and not isinstance(syntax.count, FillSyntax):
        text = "`size` tells the number of elements already"
        hint = "leave `count` out, or say `count: fill`: as many as these bytes hold"
        context.error_at_key("PG240", item.at("count"), text, hint)


def in_elements(
    context: Context, written: Written, extent: Extent, size: int, item: Effective
) -> Extent:
    """An extent of bytes as one of elements of `size` bytes each, within the bounds of `count`."""
    found = _divided(context, written, extent, size, item.at("size"))
    count = item.syntax.count
    if not isinstance(count, FillSyntax) or isinstance(found, Fixed):
        return found
    return _bounded(context, found, count, item.at("count"))


def _divided(context: Context, written: Written, extent: Extent, size: int, loc: Loc) -> Extent:
    if size == 1:
        return extent
    match extent:
        case Fixed(count=count):
            if count % size:
                _not_whole(context, f"{count} bytes", size, loc)
            return Fixed(count=count // size)
        case Counted(by=by, least=least, greatest=greatest):
            if -(-least // size) > greatest // size:
                _not_whole(context, f"`{by.text}` bytes", size, loc)
                return Fixed(count=0)
            bounds = {"least": -(-least // size), "greatest": greatest // size}
            return replace(extent, by=Quotient(by, size, at=by.at), **bounds)
        case Fill(least=least, greatest=greatest):
            assert isinstance(written, FillSyntax)
            for key in ("min", "max"):
                bound = getattr(written, key)
                if bound is not None and bound % size:
                    _not_whole(context, f"{bound} bytes", size, (*loc, key))
            return replace(extent, least=-(-least // size), greatest=greatest // size)
    return extent


def _not_whole(context: Context, bytes_: str, size: int, loc: Loc) -> None:
    text = f"{bytes_} are no whole number of elements: each has {size}"
    context.error("PG239", loc, text, f"write a multiple of {size}")


def _bounded(context: Context, extent: Extent, count: FillSyntax, loc: Loc) -> Extent:
    """The extent within the bounds that `count: {fill: true, min: .., max: ..}` states."""
    if not isinstance(extent, Counted | Fill) or (count.min == 0 and count.max is None):
        return extent
    least = max(extent.least, count.min)
    greatest = extent.greatest if count.max is None else min(extent.greatest, count.max)
    if least > greatest:
        text = f"{least} are more than the {greatest} that there can be"
        context.error("PG180", loc, text)
        return extent
    stated = extent.stated or count.max is not None
    return replace(extent, least=least, greatest=greatest, stated=stated)
