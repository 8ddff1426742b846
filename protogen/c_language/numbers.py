"""Types of numbers, and constants, as C."""

from __future__ import annotations

from functools import cache, lru_cache

from protogen.model.types import Float, NumberType, counting_bits, storage_bits

_INT_MAX = 0x7FFF
"""The greatest `int` that every target has."""


@cache
def unsigned_type(bits: int) -> str:
    """The smallest unsigned type of so many bits."""
    return f"uint{storage_bits(bits)}_t"


@lru_cache(maxsize=1024)
def integer_type(type_: NumberType) -> str:
    """The type of a member that holds such integers."""
    if type_.role == "bool":
        return "bool"
    return f"{'' if type_.signed else 'u'}int{storage_bits(type_.bits)}_t"


def counting_type(greatest: int) -> str:
    """The type of a number of elements or bytes."""
    return f"uint{counting_bits(greatest)}_t"


@lru_cache(maxsize=1024)
def layout_name(type_: NumberType) -> str:
    """The name of a layout on the wire: `u14le`, `s32be`, `f32le`, `u7`."""
    order = "" if type_.size == 1 else f"{type_.byte_order[0]}e"
    kind = "f" if isinstance(type_, Float) else "s" if type_.signed else "u"
    return f"{kind}{type_.bits}{order}"


def number(value: int) -> str:
    """A signed constant."""
    if -_INT_MAX <= value <= _INT_MAX:
        return str(value)
    if value == -(1 << 63):
        return f"(-{(1 << 63) - 1}LL - 1)"
    suffix = "L" if -(1 << 31) < value < 1 << 31 else "LL"
    return f"{value}{suffix}"


def unsigned(value: int) -> str:
    """An unsigned constant in decimal digits."""
    return f"{value}{_suffix(value)}"


def hexadecimal(value: int, digits: int = 2) -> str:
    """An unsigned constant in hexadecimal digits."""
    return f"0x{value:0{digits}X}{_suffix(value)}"


def _suffix(value: int) -> str:
    if value <= 0xFFFF:
        return "U"
    return "UL" if value <= 0xFFFFFFFF else "ULL"


def constant(value: int, type_: NumberType) -> str:
    """A constant to compare with a value of that type."""
    return number(value) if type_.signed else unsigned(value)
