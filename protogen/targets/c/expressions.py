"""Integers of frames as bytes, in C."""

from __future__ import annotations

from protogen.model.types import Integer
from protogen.targets.c.spelling import unsigned_type


def octets(data: bytes) -> str:
    """The bytes of an initialiser."""
    return ", ".join(f"0x{byte:02X}" for byte in data)


def wire_bytes(type_: Integer, value: str) -> tuple[str, ...]:
    """The bytes of an unsigned `value`, in wire order."""
    places = range(0, type_.byte_bits * type_.size, type_.byte_bits)
    mask = " & 0x7F" if type_.byte_bits == 7 else ""
    items = [_byte_of(value, shift, mask) for shift in places]
    return tuple(items if type_.byte_order == "little" else reversed(items))


def _byte_of(value: str, shift: int, mask: str) -> str:
    shifted = f"({value} >> {shift})" if shift and mask else f"{value} >> {shift}"
    if not shift:
        shifted = value
    return f"(uint8_t)({shifted}{mask})" if shift or mask else f"(uint8_t){value}"


def number_of(type_: Integer, at: str, offset: int, less: str = "") -> str:
    """The unsigned value of the bytes from `at[offset]` on, padding bits included.

    `less` is C that is put behind each index.
    """
    if type_.size == 1:
        return f"{at}[{offset}{less}]"
    target = unsigned_type(type_.byte_bits * type_.size)
    order = range(type_.size) if type_.byte_order == "little" else range(type_.size - 1, -1, -1)
    terms = []
    for place, index in enumerate(order):
        shift = place * type_.byte_bits
        term = f"({target}){at}[{offset + index}{less}]"
        terms.append(f"({target})({term} << {shift})" if shift else term)
    return f"({target})({' | '.join(terms)})"
