"""Packed fields: integers whose bits follow each other without byte boundaries."""

from __future__ import annotations

from collections.abc import Iterable
from fractions import Fraction
from itertools import count

from protogen.copying import replace
from protogen.model.packing import FilledPacking
from protogen.model.types import Array, BitOrder, Field, Type, is_integer
from protogen.passes.context import Context
from protogen.passes.types.declared import Effective
from protogen.passes.types.setting import Setting
from protogen.passes.types.sized_arrays import is_sized_array
from protogen.schema.syntax.fields import Fill

_BYTE = 8


def check_packing(context: Context, name: str, item: Effective) -> bool:
    """Report `packed` where there is nothing to pack, and what can't lie among packed integers.

    False for the latter.
    """
    syntax, inside = item.syntax, item.setting.layout.packed is not None
    if syntax.packed is not None:
        _can_pack(context, name, item)
    if inside and not _is_packable(item):
        what = "what is not always there" if item.syntax.when is not None else f"`{name}`"
        text = f"{what} can't be packed: only integers can, and arrays of a fixed number of them"
        hint = "end the packed struct in front of it, and go on behind it"
        context.error_at_key("PG221", item.chain[0][1], text, hint)
        return False
    if (inside or syntax.packed is not None) and syntax.byte_order is not None:
        text = "bits that are packed have no byte order: `packed` says all about their order"
        context.error("PG222", item.at("byte_order"), text, "leave `byte_order` out")
    return True


def _can_pack(context: Context, name: str, item: Effective) -> None:
    syntax, loc = item.syntax, item.at("packed")
    if syntax.fields is None and syntax.count is None and not is_sized_array(syntax):
        what = "a switch" if syntax.switch is not None else "a single value"
        text = f"`packed` is for arrays and structs of integers, and `{name}` is {what}"
        hint = "make a packed struct of it and its neighbours"
        context.error_at_key("PG220", loc, text, hint)
    elif item.setting.layout.packed is not None:
        text = f"`{name}` is packed already, with the struct that it is in"
        context.error_at_key("PG220", loc, text, "leave `packed` out here")
    elif item.setting.layout.byte_bits != 8:
        text = "integers are packed into bytes of 8 bits, and `byte_bits` is 7"
        context.error_at_key("PG223", loc, text)


def _is_packable(item: Effective) -> bool:
    """True if a field may lie in a packed struct; what its type is called is asked elsewhere."""
    syntax = item.syntax
    if syntax.fields is not None or syntax.switch is not None or syntax.when is not None:
        return False
    is_counted = _is_fixed(item) if syntax.count is not None else syntax.size is None
    return is_counted and syntax.type not in ("float32", "float64", "ascii", "bytes")


def _is_fixed(item: Effective) -> bool:
    return isinstance(item.syntax.count, int) and item.syntax.count > 0


def _is_filled(item: Effective) -> bool:
    return isinstance(item.syntax.count, Fill) and item.syntax.size is None


def packed_elements(context: Context, item: Effective, setting: Setting) -> Setting:
    """The setting of an array's elements, which are packed if the array is."""
    order = item.syntax.packed
    if order is None or item.syntax.fields is not None:
        return setting
    if _is_fixed(item) or _is_filled(item):
        return _packed(setting, order)
    text = "the number of packed integers is always the same, or they fill what is left"
    hint = "write a number from 1 on, or `count: fill`: in a struct with a `size` they fill that"
    key = "size" if item.syntax.size is not None else "count"
    context.error("PG221", item.at(key), text, hint)
    return setting


def bytes_of_element(context: Context, element: Type, item: Effective) -> Fraction | int:
    """The least number of bytes of an element; a part of one where elements are packed.

    Reports packed integers that fill the payload, where their bytes don't tell their number.
    """
    if not is_integer(element) or not element.packed:
        return max(1, element.sizes.least)
    if element.bits < _BYTE and _is_filled(item):
        packing = FilledPacking("lsb_first", element.bits)
        alike = next(n for n in count(1) if packing.size_of(n) == packing.size_of(n + 1))
        size = "a byte" if alike == 1 else f"{packing.size_of(alike)} bytes"
        width = "1 bit" if element.bits == 1 else f"{element.bits} bits"
        both = f"{alike} and {alike + 1} integers of {width} both take {size}"
        text = f"nothing tells how many there are: {both}"
        hint = "write their number, or a switch with a case for each number that there can be"
        context.error("PG302", item.at("count"), text, hint)
    return Fraction(element.bits, _BYTE)


def packed_fields(item: Effective, setting: Setting) -> Setting:
    """The setting of a struct's fields, which are packed if the struct is."""
    order = item.syntax.packed
    return setting if order is None else _packed(setting, order)


def _packed(setting: Setting, order: BitOrder) -> Setting:
    return replace(setting, layout=replace(setting.layout, packed=order))


def order_of_elements(
    context: Context, element: Type, item: Effective, setting: Setting
) -> BitOrder | None:
    """The order in which elements of this setting are packed."""
    order = setting.layout.packed
    if order is None or item.setting.layout.packed is not None:
        return None
    if is_integer(element):
        return order
    text = f"only integers can be packed, and {item.syntax.type} is none"
    context.error("PG221", item.at("type"), text)
    return None


def order_of_fields(context: Context, fields: Iterable[Field], item: Effective) -> BitOrder | None:
    """The order in which a struct's fields are packed; None where that makes no sense."""
    types = [field.type for field in fields]
    if item.syntax.packed is not None and not types:
        context.error_at_key("PG220", item.at("packed"), "there is nothing to pack: no fields")
    sound = types and all(map(_holds_integers, types))
    return item.syntax.packed if sound else None


def _holds_integers(type_: Type) -> bool:
    return is_integer(type_.element if isinstance(type_, Array) else type_)
