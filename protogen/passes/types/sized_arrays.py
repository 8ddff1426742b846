"""Arrays whose number of bytes is told, and structs and switches in regions of so many bytes."""

from __future__ import annotations

from protogen.copying import replace
from protogen.model.expressions import Quotient
from protogen.model.types import Array, Counted, Extent, Fill, Fixed, Type
from protogen.passes.context import Context, Loc
from protogen.passes.types.declared import Effective
from protogen.passes.types.extents import Written
from protogen.passes.types.setting import Setting
from protogen.schema.syntax.fields import FieldSyntax
from protogen.schema.syntax.fields import Fill as FillSyntax

_STRINGS = ("ascii", "bytes")


def is_sized_array(syntax: FieldSyntax) -> bool:
    """True if a field is an array of numbers whose size in bytes is told."""
    is_number = syntax.type is not None and syntax.type not in _STRINGS
    return syntax.size is not None and is_number and not has_region(syntax)


def has_region(syntax: FieldSyntax) -> bool:
    """True if a field is a struct, some of them or a switch, in a region of so many bytes."""
    return syntax.size is not None and (syntax.fields is not None or syntax.switch is not None)


def check_size(context: Context, item: Effective) -> None:
    """Report a size where something else says the same, or nothing can have one."""
    syntax = item.syntax
    if syntax.size is None or syntax.type in _STRINGS:
        return
    if item.setting.layout.separator is not None:
        text = "a field beside a separator has no size: it ends where the next one begins"
        context.error_at_key("PG240", item.at("size"), text, "leave `size` out")
    elif has_region(syntax) and syntax.count is None and isinstance(syntax.size, FillSyntax):
        text = "this says nothing: what comes last ends where the payload does"
        context.error_at_key("PG240", item.at("size"), text, "leave `size` out")
    elif syntax.count is not None and not isinstance(syntax.count, FillSyntax):
        text = "`size` tells the number of elements already"
        hint = "leave `count` out, or say `count: fill`: as many as these bytes hold"
        context.error_at_key("PG240", item.at("count"), text, hint)


def in_elements(
    context: Context, extent: Extent, size: int, item: Effective, stated: Extent | None = None
) -> Extent:
    """An extent of bytes as one of elements of `size` bytes each, within what `count` states."""
    found = _divided(context, item.syntax.size, extent, size, item.at("size"))
    if not isinstance(stated, Fill):
        return found
    least = max(found.counts.least, stated.least)
    greatest = min(found.counts.greatest, stated.greatest)
    if least > greatest:
        text = f"{least} are more than the {greatest} that there can be"
        context.error("PG180", item.at("count"), text)
        return found
    if not isinstance(found, Counted | Fill):
        return found
    is_stated = found.stated or stated.stated
    return replace(found, least=least, greatest=greatest, stated=is_stated)


def in_region(setting: Setting, region: Extent) -> Setting:
    """The setting of what lies in a region of so many bytes, where that says how many."""
    if not isinstance(region, Fixed | Counted):
        bounded = replace(setting, capacity=region.counts.greatest, used=0)
        return bounded if region.stated else setting
    return replace(setting, capacity=region.counts.greatest, used=0, delimited=True, last=True)


def region_of(
    context: Context, type_: Type, extent: Extent, item: Effective
) -> tuple[Type, Fixed | Counted | None]:
    """A type, and the region that it lies in: none for elements that so many bytes count."""
    if isinstance(type_, Array) and type_.element.sizes.fixed:
        stated = type_.extent
        found = in_elements(context, extent, type_.element.sizes.fixed, item, stated)
        return replace(type_, extent=found), None
    if not isinstance(type_, Array) and isinstance(extent, Fill):
        return type_, None  # Which was reported.
    if not isinstance(extent, Fixed | Counted):
        text = "elements have to be of one size, so that bytes to the end tell their number"
        context.error_at_key("PG240", item.at("size"), text, "leave `size` out")
        return type_, None
    bounds = extent.counts
    fitting = type_.sizes.within(bounds.least, bounds.greatest)
    if fitting is None:
        text = f"this takes {type_.sizes} bytes, and the region has {bounds}"
        context.error("PG241", item.at("size"), text)
        return type_, None
    if isinstance(extent, Counted):  # No other number of bytes can be right.
        is_stated = extent.stated or fitting != bounds
        bounded = {"least": fitting.least, "greatest": fitting.greatest}
        extent = replace(extent, **bounded, stated=is_stated)
    return type_, extent


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
