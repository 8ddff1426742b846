"""Payloads read field by field, by the rules of the design: what generated C has to say of bytes.

It differs from the Python runtime in one thing: a number that counts more elements or bytes than
there can be, or fewer, is wrong as soon as they are due, because no struct of C has room for them.
"""

from __future__ import annotations

import re
import struct
from collections.abc import Mapping, Sequence
from fractions import Fraction
from typing import Any

from bit_runs import bits_of, number_of
from expression_oracle import worked_out

from protogen.fuzzing.samples import NOTHING_HELD
from protogen.model.messages import Message
from protogen.model.types import (
    Array,
    Between,
    Counted,
    Extent,
    Field,
    Fill,
    Fixed,
    Float,
    Integer,
    Marked,
    Octets,
    Struct,
    Switch,
    Tail,
    Text,
    Type,
    Until,
)
from protogen.runtime.errors import ByteError
from protogen.runtime.payload.number import Number

Scope = dict[str, Any]


class Wrong(Exception):  # noqa: N818 - a verdict, not a failure
    """Bytes are no payload. `missing`: where they have to end at least; 0: more don't help."""

    def __init__(self, reason: str, missing: int = 0, *, count: bool = False) -> None:
        super().__init__(reason, missing)
        self.reason = reason
        self.missing = missing
        self.count = count
        """True if a number counts too many or too few."""


def check(message: Message, payload: bytes, held: Mapping[str, int]) -> None:
    """Raise Wrong unless the bytes are the message's payload.

    `held` are the fields that are numbers of the frame.
    """
    sizes = message.sizes
    if sizes.fixed is not None and len(payload) != sizes.fixed:
        raise Wrong("size")
    reader = _Reader(payload, held)
    reader.fields(message.fields, {})
    if reader.at != len(payload) or len(payload) not in sizes:
        raise Wrong("size")


class _Reader:
    def __init__(self, payload: bytes, held: Mapping[str, int] = NOTHING_HELD) -> None:
        self._payload = payload
        self._held = held
        self.at = 0

    def _take(self, size: int) -> bytes:
        end = self.at + size
        if end > len(self._payload):
            raise Wrong("size", end)
        data, self.at = self._payload[self.at : end], end
        return data

    @property
    def _left(self) -> int:
        return len(self._payload) - self.at

    def fields(self, fields: Sequence[Field], scope: Scope) -> Scope:
        inner, numbers = dict(scope), Scope()
        for field in fields:
            if field.when is not None and not worked_out(field.when, inner):
                continue
            if field.optional and not self._left:
                continue
            found = self._of_field(field, inner)
            if field.const is not None and not _is(found, field.const):
                raise Wrong("value")
            if isinstance(field.type, Integer | Struct):
                inner[field.name] = numbers[field.name] = found
        return numbers

    def _of_field(self, field: Field, scope: Scope) -> Any:
        if field.part:
            return self._of_frame(field)
        constant = field.const is not None
        if field.region is None:
            return self._value(field.type, scope, constant=constant)
        size = self._count(field.region, scope, constant=False)
        assert size is not None
        inner = _Reader(self._take(size))
        try:
            found = inner._value(field.type, scope, constant=constant)
        except Wrong as wrong:  # What its region has no room for, no more bytes help.
            raise Wrong(wrong.reason, count=wrong.count) from None
        if inner._left:
            raise Wrong("size")
        return found

    def _of_frame(self, field: Field) -> int:
        """A number of the frame, which may be none that the message knows."""
        value, type_ = self._held[field.name], field.type
        assert isinstance(type_, Integer)
        is_closed = type_.enum is not None and type_.enum.closed
        if is_closed and value not in _names(type_):
            raise Wrong("value")
        return value

    def _value(self, type_: Type, scope: Scope, *, constant: bool = False) -> Any:
        if isinstance(type_, Struct | Array) and type_.packed is not None:
            return self._packed(type_, type_.packed, constant=constant)
        match type_:
            case Integer() | Float():
                return self._number(type_, constant=constant)
            case Text() | Octets():
                return self._bytes(type_, scope, constant=constant)
            case Struct(fields=fields):
                return self.fields(fields, scope)
            case Array():
                return self._elements(type_, scope, constant=constant)
            case Switch():
                return self._case(type_, scope)

    def _packed(self, type_: Struct | Array, order: str, *, constant: bool) -> Any:
        if isinstance(type_, Array) and isinstance(type_.extent, Fill):
            return self._packed_fill(type_.element, type_.extent, order, constant=constant)
        run = _Run(bits_of(self._take(type_.sizes.least), order), order)
        if isinstance(type_, Array):
            found = run.numbers(type_, constant=constant)
        else:
            found = Scope()
            for field in type_.fields:
                inner = found[field.name] = run.value(field.type, constant=field.const is not None)
                if field.const is not None and not _is(inner, field.const):
                    raise Wrong("value")
        if any(run.bits):
            raise Wrong("value")
        return found

    def _packed_fill(self, element: Type, extent: Fill, order: str, *, constant: bool) -> Any:
        """Numbers as long as there are bits for one; the bits behind the last are less than 8."""
        assert isinstance(element, Integer)
        run = _Run(bits_of(self._take(self._left), order), order)
        count, left = divmod(len(run.bits), element.bits)
        if left >= 8 or (count not in extent.counts and not constant):
            raise Wrong("size")
        padding = run.bits[len(run.bits) - left :]
        if any(padding):
            raise Wrong("value")
        return [run.value(element, constant=constant) for _ in range(count)]

    def _number(self, type_: Integer | Float, *, constant: bool) -> int | float:
        if isinstance(type_, Integer) and type_.is_free:
            return self._free(type_)
        data = self._take(type_.size)
        if isinstance(type_, Integer) and type_.text is not None:
            return _written(type_, type_.text.alphabet, data, constant=constant)
        signed = isinstance(type_, Integer) and type_.signed
        if isinstance(type_, Integer) and type_.role == "bool" and data[0] > 1:
            raise Wrong("value")
        number = Number(type_.bits, signed, type_.byte_order, seven_bit=type_.byte_bits == 7)
        try:
            value = number.decode(data)
        except ByteError as error:
            raise Wrong(error.reason) from None
        if isinstance(type_, Float):
            return _float(type_, value)
        closed = type_.enum is not None and type_.enum.closed
        if closed and not constant and value not in _names(type_):
            raise Wrong("value")
        return value

    def _free(self, type_: Integer) -> int:
        """A number in as many digits as there are characters, up to the next separator."""
        form = type_.text
        if form.leads and self._take(1)[0] != form.separator:
            raise Wrong("value")
        left = self._payload[self.at :]
        mark = None if form.separator is None else bytes([form.separator])
        text = self._take(len(left if mark is None else left.split(mark)[0])).decode("latin-1")
        longest = type_.signed + form.front + (1 + form.fraction if form.fraction else 0)
        if not text and form.empty:
            return 0 if form.base == 256 else form.base ** (form.front + form.fraction)
        if not 1 <= len(text) <= longest:
            raise Wrong("size")
        value = _number_in(text, form, signed=type_.signed)
        if form.base == 256 and form.empty and value == 0:
            raise Wrong("value")
        if type_.enum is not None and type_.enum.closed and value not in _names(type_):
            raise Wrong("value")
        return value

    def _count(self, extent: Extent, scope: Scope, *, constant: bool) -> int | None:
        if isinstance(extent, Fixed):
            return extent.count
        if isinstance(extent, Between | Fill | Until | Marked):
            return None
        count = worked_out(extent.by, scope)
        if not constant:
            _bounded(extent, count)
        return count

    def _up_to(self, type_: Text | Octets, extent: Until) -> bytes:
        """Bytes in front of a terminator, behind which it goes on."""
        left = self._payload[self.at :]
        if len(left) <= extent.least:
            raise Wrong("size", self.at + extent.least + 1)
        size = left.find(extent.byte)
        if size < 0 and len(left) <= extent.greatest:
            raise Wrong("size", len(self._payload) + 1)
        if not extent.least <= size <= extent.greatest:
            raise Wrong("size")
        data, _ = self._take(size), self._take(1)
        if type_.byte_bits == 7 and not data.isascii():
            raise Wrong("encoding")
        return data

    def _between(self, extent: Between) -> bytes:
        """Characters in front of the next separator, or all where it may be one of them."""
        if extent.leads and self._take(1)[0] != extent.separator:
            raise Wrong("value")
        left = self._payload[self.at :]
        if extent.separator not in extent.characters:
            left = left.split(bytes([extent.separator]))[0]
        data = self._take(len(left))
        if not extent.least <= len(data) <= extent.greatest:
            raise Wrong("size")
        if not set(data) <= set(extent.characters):
            raise Wrong("value")
        return data

    def _bytes(self, type_: Text | Octets, scope: Scope, *, constant: bool) -> bytes:
        if isinstance(type_.extent, Between):
            return self._between(type_.extent)
        if isinstance(type_.extent, Until):
            return self._up_to(type_, type_.extent)
        count = self._count(type_.extent, scope, constant=constant)
        if count is None:
            assert isinstance(type_.extent, Fill)
            if self._left not in type_.extent.counts and not constant:
                raise Wrong("size")
            count = self._left
        data = self._take(count)
        if type_.byte_bits == 7 and not data.isascii():
            raise Wrong("encoding")
        return _characters(type_, data) if isinstance(type_, Text) and _is_fixed(type_) else data

    def _elements(self, type_: Array, scope: Scope, *, constant: bool) -> list[Any]:
        count = self._count(type_.extent, scope, constant=constant)
        if count is not None:
            return [self._value(type_.element, scope) for _ in range(count)]
        found: list[Any] = []
        if isinstance(type_.extent, Marked):
            return self._up_to_last(type_.element, type_.extent, scope)
        assert isinstance(type_.extent, Fill)
        if type_.extent.tail is not None:
            count = self._in_front(type_.extent.tail)
            if count not in type_.extent.counts:
                raise Wrong("size")
            return [self._value(type_.element, scope) for _ in range(count)]
        while self._left:
            if len(found) == type_.extent.greatest and not constant:
                raise Wrong("size")
            found.append(self._value(type_.element, scope))
        if len(found) < type_.extent.least and not constant:
            raise Wrong("size")
        return found

    def _in_front(self, tail: Tail) -> int:
        """Whole elements that are left if what has to stand behind them does."""
        left = self._payload[self.at :]
        units = len(left) if tail.separator is None else left.count(tail.separator)
        return max(0, units - tail.least) // tail.element

    def _up_to_last(self, element: Type, extent: Marked, scope: Scope) -> list[Any]:
        """Elements up to the first that says that it is the last."""
        found: list[Any] = []
        while not found or not worked_out(extent.mark, found[-1]):
            if len(found) == extent.greatest:
                raise Wrong("size")
            found.append(self._value(element, scope))
        if len(found) < extent.least:
            raise Wrong("size")
        return found

    def _case(self, type_: Switch, scope: Scope) -> None:
        for case in type_.cases:
            if case.value in (worked_out(type_.selector, scope), None):  # That of all others: last.
                self._value(case.type, scope)
                return
        if type_.rest is None:
            raise Wrong("value")
        if self._left > type_.rest:
            raise Wrong("size")
        if type_.byte_bits == 7 and not self._payload[self.at :].isascii():
            raise Wrong("encoding")
        self.at = len(self._payload)


class _Run:
    """Bits of packed numbers that were not taken yet."""

    def __init__(self, bits: list[int], order: str) -> None:
        self.bits = bits
        self._order = order

    def value(self, type_: Type, *, constant: bool) -> Any:
        if isinstance(type_, Array):
            return self.numbers(type_, constant=constant)
        assert isinstance(type_, Integer)
        own, self.bits = self.bits[: type_.bits], self.bits[type_.bits :]
        found = number_of(own, self._order)
        if type_.signed and found >= 2 ** (type_.bits - 1):
            found -= 2**type_.bits
        is_closed = type_.enum is not None and type_.enum.closed and not constant
        if is_closed and found not in _names(type_):
            raise Wrong("value")
        return found

    def numbers(self, type_: Array, *, constant: bool) -> list[int]:
        count = type_.extent.counts.least
        return [self.value(type_.element, constant=constant) for _ in range(count)]


def _number_in(text: str, form: Any, *, signed: bool) -> int:
    """The number that a text is."""
    sign = "[+-]?" if signed else ""
    if form.base == 256:
        return ord(text)
    if form.base == 16:
        written = re.fullmatch(r"[0-9A-Fa-f]+", text)
    elif form.fraction:
        written = re.fullmatch(rf"{sign}([0-9]+\.?[0-9]*|\.[0-9]+)", text)
    else:
        written = re.fullmatch(rf"{sign}[0-9]+", text)
    if written is None:
        raise Wrong("value")
    exact = Fraction(int(text, 16)) if form.base == 16 else Fraction(_with_zeros(text))
    value = exact * 10**form.fraction if form.base == 10 else exact
    if value.denominator != 1 or abs(value) >= form.base ** (form.front + form.fraction):
        raise Wrong("value")
    return int(value)


def _with_zeros(text: str) -> str:
    """A decimal number as `Fraction` reads it: with a digit on each side of the point."""
    front, point, behind = text.partition(".")
    front = front if front[-1:].isdigit() else f"{front}0"
    return f"{front}.{behind or 0}" if point else front


def _written(type_: Integer, alphabet: bytes, data: bytes, *, constant: bool) -> int:
    """An integer as digits, the highest one first."""
    if not set(data) <= set(alphabet):
        raise Wrong("value")
    raw = sum(
        alphabet.index(digit) * len(alphabet) ** place for place, digit in enumerate(reversed(data))
    )
    if raw >= 2**type_.bits:
        raise Wrong("value")
    value = raw - 2**type_.bits if type_.signed and raw >= 2 ** (type_.bits - 1) else raw
    is_closed = type_.enum is not None and type_.enum.closed and not constant
    if is_closed and value not in _names(type_):
        raise Wrong("value")
    return value


def _bounded(extent: Counted, count: int) -> None:
    if not extent.least <= count <= extent.greatest:
        raise Wrong("size", count=True)


def _float(type_: Float, bits: int) -> float:
    form = "<f" if type_.bits == 32 else "<d"
    value: float = struct.unpack(form, bits.to_bytes(type_.bits // 8, "little"))[0]
    return value


def _is_fixed(type_: Text) -> bool:
    return isinstance(type_.extent, Fixed)


def _characters(type_: Text, data: bytes) -> bytes:
    """The characters of a text of a fixed size, without the padding."""
    form = type_.form
    found = [(byte - form.add) / (1 << form.shift) for byte in data]
    least = 1 if form.padding else 0
    if any(code != int(code) or not least <= code < 1 << form.bits for code in found):
        raise Wrong("value")
    return bytes(map(int, found)).rstrip(bytes([form.padding]))


def _names(type_: Integer) -> set[int]:
    assert type_.enum is not None
    return {item.value for item in type_.enum.values}


def _is(found: Any, constant: Any) -> bool:
    """True if what was read is the constant."""
    if isinstance(constant, str):
        return bool(found == constant.encode("latin-1"))
    return bool(found == (list(constant) if isinstance(constant, tuple) else constant))
