"""Numbers as bytes: what is stored of them, and the C that takes them apart and joins them."""

from __future__ import annotations

from functools import lru_cache

from protogen.c_language.numbers import hexadecimal, integer_type, unsigned, unsigned_type
from protogen.copying import replace
from protogen.model.types import NumberType, is_text, storage_bits

_MOST_TERMS = 4
"""Bytes that are joined in one expression; more of them are joined in a loop."""


def stored_type(type_: NumberType) -> str:
    """The type of a number that is written.

    Of 16 bits it is that of a register, where only the bytes are cut out that are written: machines
    with wider registers would make a number with a sign one without, and then cut it again.
    """
    layout = cut(type_)
    is_short = layout.bits == 16 and layout.byte_bits == 8
    return "uint_fast16_t" if is_short else unsigned_type(type_.bits)


def is_plain(type_: NumberType) -> bool:
    """True if the number is a byte as it is."""
    if is_text(type_):
        return False
    return type_.size == 1 and (type_.bits == 8 or not type_.signed)


@lru_cache(maxsize=256)
def widened(type_: NumberType) -> NumberType:
    """The unsigned layout that has the same bytes and the same type in C, but no padding."""
    bits = min(64, type_.byte_bits * type_.size)
    is_same = storage_bits(bits) == storage_bits(type_.bits)
    return replace(type_.unsigned, bits=bits) if is_same else type_.unsigned


def cut(type_: NumberType) -> NumberType:
    """The layout that a writer needs: of a signed number the bits above its own are cut off."""
    is_unpadded = is_whole(type_) or type_.bits == 8 * type_.size
    return type_ if type_.signed and not is_unpadded else widened(type_)


def is_whole(type_: NumberType) -> bool:
    """True if the number has just as many bits as its C type, so that a cast changes its sign."""
    return type_.bits in (8, 16, 32, 64)


def sign_extended(type_: NumberType, raw: str) -> list[str]:
    """The statements that return the signed value of a raw one.

    The sum has no sign, so that it may wrap, and changes its type where it is no sum any more.
    """
    if is_whole(type_):
        return [f"return ({integer_type(type_)}){raw};"]
    top, target = hexadecimal(1 << (type_.bits - 1)), unsigned_type(type_.bits)
    return [
        f"const {target} extended = ({target})(({raw} ^ {top}) - {top});",
        f"return ({integer_type(type_)})extended;",
    ]


def joined(type_: NumberType, at: str) -> list[str]:
    """The statements that return the unsigned number at `at`."""
    size, group, target = type_.size, type_.byte_bits, unsigned_type(type_.bits)
    if size > _MOST_TERMS:
        return _joined_in_a_loop(type_, at)
    order = range(size) if type_.byte_order == "little" else range(size - 1, -1, -1)
    cast = "uint16_t" if target == "uint8_t" else target
    terms = [
        f"(({cast}){at}[{index}] << {group * place})" if place else f"{at}[{index}]"
        for place, index in enumerate(order)
    ]
    return [f"return ({target})({' | '.join(terms)});" if size > 1 else f"return {terms[0]};"]


def _joined_in_a_loop(type_: NumberType, at: str) -> list[str]:
    target, size = unsigned_type(type_.bits), type_.size
    index = "i" if type_.byte_order == "big" else f"{unsigned(size - 1)} - i"
    return [
        f"{target} value = 0U;",
        f"for (size_t i = 0; i < {unsigned(size)}; i++) {{",
        f"    value = ({target})(value << {type_.byte_bits}) | {at}[{index}];",
        "}",
        "return value;",
    ]


def parted(type_: NumberType, value: str) -> tuple[str, ...]:
    """The bytes of an unsigned number in wire order; of a signed one, its own bits only."""
    items = []
    for place in range(type_.size):
        shift = type_.byte_bits * place
        shifted = _shifted(type_, value, shift)
        mask = _mask(type_, place)
        if mask is not None:
            shifted = f"({shifted}) & {mask}" if shift else f"{shifted} & {mask}"
        items.append(f"(uint8_t)({shifted})" if shift or mask else f"(uint8_t){shifted}")
    return tuple(items if type_.byte_order == "little" else reversed(items))


def _shifted(type_: NumberType, value: str, shift: int) -> str:
    """The number without its lowest bits."""
    if shift == 7 and type_.bits <= 16:
        # Seven steps on an 8-bit controller; this is one, and a byte.
        return f"(uint16_t)({value} << 1) >> 8"
    return f"{value} >> {shift}" if shift else value


def _mask(type_: NumberType, place: int) -> str | None:
    """Mask of the bits that belong to a byte; None where a cast cuts off the others."""
    left = type_.bits - type_.byte_bits * place
    bits = min(type_.byte_bits, left)
    if bits == 8 or (bits == left and not type_.signed):
        return None
    return hexadecimal((1 << bits) - 1)
