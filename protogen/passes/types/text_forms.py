"""Texts of a fixed size with padding other than NUL, or whose characters are in a code."""

from __future__ import annotations

from protogen.model.types import Extent, Fixed, TextForm
from protogen.passes.context import Context
from protogen.passes.types.declared import Effective
from protogen.schema.syntax.digits import CharacterCode

_BITS = 7
"""Of a character of ASCII."""
_GREATEST_BYTE = 0xFF


def text_form(context: Context, item: Effective, extent: Extent) -> TextForm:
    """The form that a text states; what is wrong with it is reported, and then it is plain."""
    padding, code = item.syntax.padding, item.syntax.code
    if padding is None and code is None:
        return TextForm()
    if not _is_of_fixed_size(context, item, extent) or not _is_of_whole_bytes(context, item):
        return TextForm()
    if padding is not None and padding >> _BITS:
        text = f"{padding:#x} is no character of ASCII"
        context.error("PG295", item.at("padding"), text, 'give a character, such as `" "`')
        return TextForm()
    if code is None:
        return TextForm(padding=padding or 0)
    if not _holds_characters(context, item, code):
        return TextForm()
    return TextForm(padding=padding or 0, bits=7, shift=code.shift, add=code.add)


def _is_of_fixed_size(context: Context, item: Effective, extent: Extent) -> bool:
    if isinstance(extent, Fixed):
        return True
    key = "padding" if item.syntax.padding is not None else "code"
    text = f"`{key}` is for ascii of a fixed size, which nothing in the payload says"
    context.error_at_key("PG294", item.at(key), text, "give its `size` as a number")
    return False


def _is_of_whole_bytes(context: Context, item: Effective) -> bool:
    if item.syntax.code is None or item.setting.layout.byte_bits == 8:
        return True
    text = "characters have no `code` where `byte_bits` is 7"
    context.error_at_key("PG294", item.at("code"), text)
    return False


def _holds_characters(context: Context, item: Effective, code: CharacterCode) -> bool:
    """True if there is a byte for each character of ASCII."""
    if code.bits != _BITS:
        text = f"a character of ascii has {_BITS} bits, not {code.bits}"
        context.error("PG295", (*item.at("code"), "bits"), text)
        return False
    last = (((1 << _BITS) - 1) << code.shift) + code.add
    if last > _GREATEST_BYTE:
        key = "add" if code.add else "shift"
        text = f"characters would go up to {last}, and a byte goes up to {_GREATEST_BYTE}"
        context.error("PG295", (*item.at("code"), key), text)
        return False
    return True
