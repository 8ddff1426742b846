"""Constants that a schema states, checked to fit their fields."""

from __future__ import annotations

import math
import struct

from protogen.model.nesting import is_composite
from protogen.model.types import Array, Between, Constant, Fixed, Float, Integer, Octets, Text, Type
from protogen.passes.context import Context
from protogen.passes.types.declared import Effective
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


def read_constant(context: Context, key: str, type_: Type, field: Effective) -> Constant | None:
    """The raw value of `const` or `default`; None where there is none or it does not fit."""
    written = getattr(field.syntax, key)
    if written is None:
        return None
    if is_composite(type_):
        context.error("PG110", field.at(key), f"`{key}` is not for structs and switches")
        return None
    try:
        return _Reader(key, field).read(written, type_)
    except _UnfitError as why:
        context.error("PG114", field.at(key), why.text, why.hint)
        return None


class _UnfitError(Exception):
    """A constant that its field can't have."""

    def __init__(self, text: str, hint: str | None = None) -> None:
        super().__init__(text)
        self.text = text
        self.hint = hint


def _can_stand(key: str, written: str, between: Between) -> None:
    """Check that a text between separators has none but its characters."""
    wrong = next((it for it in written if ord(it) not in between.characters), None)
    if wrong is not None:
        raise _UnfitError(f"`{key}` has {wrong!r}, which can't stand between separators here")


class _Reader:
    """Reads one constant; raises _UnfitError."""

    def __init__(self, key: str, field: Effective) -> None:
        self._key = key
        self._item = field.syntax

    def read(self, written: object, type_: Type) -> Constant:
        """The raw value."""
        match type_:
            case Integer():
                return self._integer(written, type_)
            case Float() if isinstance(written, int | float) and not isinstance(written, bool):
                return self._float(written, type_)
            case Text() if isinstance(written, str):
                return self._text(written, type_)
            case Octets() if isinstance(written, bytes | tuple):
                return self._octets(written, type_)
            case Octets() if isinstance(written, int) and not isinstance(written, bool):
                return self._octets((written,), type_)
            case Array():
                return self._array(written, type_)
        raise _UnfitError(f"`{self._key}` is not a value of {self._item.type}")

    # -- numbers ------------------------------------------------------------------------------

    def _integer(self, written: object, type_: Integer) -> int:
        named = named_raw_value(type_, written)
        if named is not None and not type_.holds(named[0]):
            raise self._too_wide(named[0], type_)
        if named is not None:
            return self._allowed(named[0], type_)
        if isinstance(written, int) and not isinstance(written, bool):
            raise self._too_wide(written, type_)
        text = str(written).lower() if isinstance(written, bool) else written
        names = [entry.name for entry in type_.enum.values] if type_.enum else []
        hint = hint_for(str(written), names)
        raise _UnfitError(f"{text} is not a value of {self._item.type}", hint)

    def _allowed(self, value: int, type_: Integer) -> int:
        """Check that a value that fits is in the range, and has a name in a closed enum."""
        special = [entry.value for entry in (self._item.special or {}).values()]
        if value not in special:
            self._in_range(value)
        enum = type_.enum
        if enum and enum.closed and value not in [entry.value for entry in enum.values]:
            raise _UnfitError(f"{value} has no name, and `closed` allows no other values")
        return value

    def _in_range(self, value: float) -> None:
        if self._item.range is None:
            return
        low, high = sorted(self._item.range)
        if not low <= value <= high:
            raise _UnfitError(f"{value} is out of the field's range {low} to {high}")

    def _too_wide(self, value: int, type_: Integer) -> _UnfitError:
        bounds = f"{type_.least} to {type_.greatest}"
        return _UnfitError(f"{value} does not fit {self._item.type}: {bounds}")

    def _float(self, written: float, type_: Float) -> float:
        """The number that the bits can hold which is nearest to what was written."""
        form = "<f" if type_.bits == 32 else "<d"
        try:
            (value,) = struct.unpack(form, struct.pack(form, written))
        except (OverflowError, struct.error):
            value = math.inf
        if not math.isfinite(value):
            raise _UnfitError(f"`{self._key}` is no number that fits {self._item.type}")
        self._in_range(value)
        return float(value)

    def _array(self, written: object, type_: Array) -> tuple[int, ...]:
        element, counts = type_.element, type_.extent.counts
        if not isinstance(written, bytes | tuple) or not isinstance(element, Integer):
            raise _UnfitError(f"`{self._key}` of an array is a list of integers")
        if len(written) not in counts:
            raise _UnfitError(f"`{self._key}` has {len(written)} elements, the array {counts}")
        for value in written:
            if not element.holds(value):
                raise self._too_wide(value, element)
            self._allowed(value, element)
        return tuple(written)

    # -- texts and bytes ----------------------------------------------------------------------

    def _text(self, written: str, type_: Text) -> str:
        padded = isinstance(type_.extent, Fixed)
        if not written.isascii():
            raise _UnfitError(f"`{self._key}` is not ASCII")
        codec = type_.padded
        if codec is not None and (fault := codec.fault_of(written)):
            raise _UnfitError(f"`{self._key}` {fault}")
        self._has_size(len(written), type_, padded=padded)
        self._goes_on(written.encode("ascii"), type_)
        if isinstance(type_.extent, Between):
            _can_stand(self._key, written, type_.extent)
        return written

    def _octets(self, written: bytes | tuple[int, ...], type_: Octets) -> bytes:
        greatest = 0x7F if type_.byte_bits == 7 else 0xFF
        if any(not 0 <= item <= greatest for item in written):
            raise _UnfitError(f"bytes are numbers from 0 to {greatest} here")
        self._has_size(len(written), type_, padded=False)
        self._goes_on(bytes(written), type_)
        return bytes(written)

    def _goes_on(self, written: bytes, type_: Text | Octets) -> None:
        """Check that nothing ends in front of its last byte."""
        end = type_.terminator
        if end and end in written:
            raise _UnfitError(f"`{self._key}` has a byte {end.hex().upper()}, which would end it")

    def _has_size(self, size: int, type_: Text | Octets, *, padded: bool) -> None:
        counts = type_.extent.counts
        if not (0 if padded else counts.least) <= size <= counts.greatest:
            raise _UnfitError(f"`{self._key}` has {size} bytes, the field {counts}")
