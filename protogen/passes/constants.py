"""Do the constants that a schema states fit their fields?"""

from __future__ import annotations

import math
import struct
from protogen.model.fields import Constant
from protogen.model.types import (
    Array,
    Fixed,
    Float,
    Integer,
    Octets,
    Struct,
    Switch,
    Text,
    Type,
)
from protogen.passes.context import Context
from protogen.passes.declared import Effective
from protogen.problems import hint_for

def named_raw_value(type_: Integer, key: object) -> tuple[int, str] | None:
    """The raw value that a number, a character or an enum's name stands for, and its name.

    None where the integer can't have it. A value without a name is called after its number.
    """
    if isinstance(key, bool) and type_.role != "bool":
        return None
    if isinstance(key, int):
        return (int(key), _name_of(type_, int(key))) if type_.holds(key) else None
    for entry in type_.enum.values if type_.enum else ():
        if entry.name == key:
            return entry.value, entry.name
    if type_.role == "char" and isinstance(key, str) and len(key) == 1:
        return named_raw_value(type_, ord(key))
    return None


def _name_of(type_: Integer, value: int) -> str:
    for entry in type_.enum.values if type_.enum else ():
        if entry.value == value:
            return entry.name
    return f"case_{value}" if value >= 0 else f"case_minus_{-value}"


class Constants:
    """Reads `const` or `default` of one field."""

    def __init__(self, context: Context, key: str, type_: Type, field: Effective) -> None:
        self._context = context
        self._key = key
        self._type = type_
        self._field = field
        self._item = field.syntax

    def read(self) -> Constant | None:
        """The raw value, or None where there is none or it does not fit."""
        written = getattr(self._item, self._key)
        match self._type:
            case _ if written is None:
                return None
            case Integer():
                return self._integer(written, self._type)
            case Float() if isinstance(written, int | float) and not isinstance(written, bool):
                return self._float(written, self._type)
            case Text() if isinstance(written, str):
                return self._text(written, self._type)
            case Octets() if isinstance(written, bytes | tuple):
                return self._octets(written, self._type)
            case Array():
                return self._array(written, self._type)
            case Struct() | Switch():
                return self._wrong(f"`{self._key}` is not for structs and switches", code="PG110")
        return self._wrong(f"`{self._key}` is not a value of {self._item.type}")

    def _wrong(self, text: str, hint: str | None = None, *, code: str = "PG114") -> None:
        self._context.error(code, self._field.at(self._key), text, hint)

    # -- numbers ------------------------------------------------------------------------------

    def _integer(self, written: object, type_: Integer) -> int | None:
        named = named_raw_value(type_, written)
        if named is not None:
            return self._allowed(named[0], type_)
        if isinstance(written, int) and not isinstance(written, bool):
            return self._unfit(written, type_)
        text = str(written).lower() if isinstance(written, bool) else written
        names = [entry.name for entry in type_.enum.values] if type_.enum else []
        hint = hint_for(str(written), names)
        return self._wrong(f"{text} is not a value of {self._item.type}", hint)

    def _allowed(self, value: int, type_: Integer) -> int | None:
        """What fits the bits must also be in the range, and have a name in a closed enum."""
        special = (entry.value for entry in (self._item.special or {}).values())
        low, high = sorted(self._item.range or (value, value))
        if not low <= value <= high and value not in special:
            return self._wrong(f"{value} is out of the field's range {low} to {high}")
        enum = type_.enum
        if enum and enum.closed and value not in (entry.value for entry in enum.values):
            return self._wrong(f"{value} has no name, and `closed` allows no other values")
        return value

    def _unfit(self, value: int, type_: Integer) -> None:
        bounds = f"{type_.least} to {type_.greatest}"
        self._wrong(f"{value} does not fit {self._item.type}: {bounds}")

    def _float(self, written: float, type_: Float) -> float | None:
        """The number that the bits can hold which is nearest to what was written."""
        form = "<f" if type_.bits == 32 else "<d"
        try:
            (value,) = struct.unpack(form, struct.pack(form, written))
        except (OverflowError, struct.error):
            value = math.inf
        if not math.isfinite(value):
            return self._wrong(f"`{self._key}` is no number that fits {self._item.type}")
        low, high = sorted(self._item.range or (value, value))
        if not low <= value <= high:
            return self._wrong(f"{written} is out of the field's range {low} to {high}")
        return float(value)

    def _array(self, written: object, type_: Array) -> tuple[int, ...] | None:
        element, counts = type_.element, type_.extent.counts
        if not isinstance(written, bytes | tuple) or not isinstance(element, Integer):
            return self._wrong(f"`{self._key}` of an array is a list of integers")
        if len(written) not in counts:
            return self._wrong(f"`{self._key}` has {len(written)} elements, the array {counts}")
        for value in written:
            if not element.holds(value):
                return self._unfit(value, element)
            if self._allowed(value, element) is None:
                return None
        return tuple(written)

    # -- texts and bytes ----------------------------------------------------------------------

    def _text(self, written: str, type_: Text) -> str | None:
        fixed = isinstance(type_.extent, Fixed)
        if not written.isascii():
            return self._wrong(f"`{self._key}` is not ASCII")
        if fixed and written.endswith("\0"):
            return self._wrong(f"`{self._key}` ends with NUL, which is padding here")
        least = 0 if fixed else type_.extent.counts.least
        return written if self._has_size(len(written), least, type_) else None

    def _octets(self, written: bytes | tuple[int, ...], type_: Octets) -> bytes | None:
        greatest = 0x7F if type_.byte_bits == 7 else 0xFF
        if any(not 0 <= item <= greatest for item in written):
            return self._wrong(f"bytes are numbers from 0 to {greatest} here")
        fits = self._has_size(len(written), type_.extent.counts.least, type_)
        return bytes(written) if fits else None

    def _has_size(self, size: int, least: int, type_: Text | Octets) -> bool:
        counts = type_.extent.counts
        if least <= size <= counts.greatest:
            return True
        self._wrong(f"`{self._key}` has {size} bytes, the field {counts}")
        return False
