"""Terminators: the bytes that end texts and bytes whose size nothing tells."""

from __future__ import annotations

from protogen.model.types import Until
from protogen.passes.context import Context, Loc
from protogen.passes.types.declared import Effective
from protogen.passes.types.delimited import Ending, bounds_within
from protogen.passes.types.last_elements import check_last_element
from protogen.passes.types.setting import Setting
from protogen.schema.syntax.fields import Until as UntilSyntax
from protogen.schema.syntax.fields import UntilElement

_STRINGS = ("ascii", "bytes")


def check_until(context: Context, name: str, item: Effective) -> None:
    """Report a terminator where nothing ends at one."""
    syntax = item.syntax
    if syntax.until is None:
        return
    loc = item.at("until")
    if isinstance(syntax.until, UntilElement):
        check_last_element(context, name, item)
    elif syntax.type not in _STRINGS:
        text = f"`until` a byte is for ascii and bytes; `{name}` is neither"
        hint = (
            "structs end behind one with a field that says so (`until: {element: FIELD}`), or are "
            "counted by `count`; bytes up to a terminator are `type: bytes`"
        )
        context.error_at_key("PG229", loc, text, hint)
    elif syntax.size is not None:
        text = f"a terminator ends `{name}`, so nothing else says its size"
        hint = "leave `size` out; the greatest size is `until: {byte: ..., max: ...}`"
        context.error_at_key("PG229", item.at("size"), text, hint)
    elif syntax.const is not None:
        text = f"`{name}` is always the same, so its size never changes"
        hint = "write the `size`, and the terminator as the last byte of the constant"
        context.error_at_key("PG229", loc, text, hint)


def until_of(context: Context, written: UntilSyntax, loc: Loc, setting: Setting) -> Until:
    """The number of bytes in front of a terminator.

    What the schema does not bound is bounded by the frame.
    """
    if setting.layout.byte_bits == 7 and written.byte > 0x7F:
        text = f"no byte of this payload is {written.byte:02X}: each carries 7 bits"
        context.error("PG230", loc, text, "take a terminator up to 0x7F")
    ending = Ending(
        code="PG230",
        name="the terminator",
        example=f"{{byte: {written.byte}, max: 64}}",
        instead="a `size`, and a constant byte behind it",
        least=0,
    )
    greatest = _greatest(written, setting)
    least, greatest = bounds_within(context, written, loc, setting, greatest, ending)
    return Until(byte=written.byte, least=least, greatest=greatest, stated=written.max is not None)


def _greatest(written: UntilSyntax, setting: Setting) -> int:
    """The greatest number of bytes in front of the terminator."""
    return max(0, (setting.room or 0) - 1) if written.max is None else written.max
