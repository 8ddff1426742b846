"""Values for the messages of a resolved protocol, as `to_dict` shows them; ends of ranges often."""

from __future__ import annotations

import struct
from collections.abc import Iterator, Mapping, Sequence
from fractions import Fraction
from functools import reduce
from math import ceil, floor, lcm
from operator import getitem
from types import MappingProxyType
from typing import Any

from expression_oracle import worked_out
from hypothesis import assume
from hypothesis import strategies as st

from protogen.model.expressions import Expression, Operand, Quotient, plain_name
from protogen.model.frame import Frame
from protogen.model.messages import Message
from protogen.model.parts import ChoicePart, CounterPart, IdentityPart, ValuePart
from protogen.model.types import (
    Array,
    Between,
    Counted,
    Extent,
    Field,
    Fixed,
    Float,
    Integer,
    Marked,
    Octets,
    Struct,
    Switch,
    Text,
    Type,
    Until,
)
from schema_fuzzing.held import Runs, held_runs, held_value
from schema_fuzzing.reference import value_bytes

_USUAL_COUNT = 5
_GREATEST_COUNT = 300
_ASCII = st.characters(max_codepoint=0x7F)

Scope = dict[str, Any]
"""The integers in front, which count and choose, and structs that hold some."""
Held = Mapping[str, Sequence[Runs]]
"""Parts of the frame that are fields, with what they may be in each frame."""
NOTHING_HELD: Held = MappingProxyType({})


@st.composite
def values_of(draw: st.DrawFn, message: Message, frames: Sequence[Frame]) -> dict[str, Any]:
    """Values that strict encoding takes, for any of these frames."""
    if message.unspecified:
        size = draw(_count(message.sizes.least, message.sizes.greatest))
        (field,) = message.fields
        assert isinstance(field.type, Octets)
        return {field.name: draw(_octets(size, field.type.byte_bits)).hex()}
    return draw(_struct(message.fields, {}, held_runs(message, frames)))


@st.composite
def parts_of(draw: st.DrawFn, frame: Frame, message: Message) -> dict[str, int | str]:
    """Values for counters, values and identities to choose; left out sometimes if they may be."""
    chosen = {
        part.name: part.shown(draw(_between(*draw(st.sampled_from(message.told_by.runs[index])))))
        for index, part in enumerate(frame.identity)
        if message.chooses(index) and draw(st.booleans())
    }
    others = {
        part.name: draw(_part(part))
        for part in frame.caller_parts
        if part.default is None or draw(st.booleans())
    }
    held = {field.part for field in message.held}
    return {name: value for name, value in (chosen | others).items() if name not in held}


def _part(part: ValuePart | CounterPart) -> st.SearchStrategy[int | str]:
    if isinstance(part, ChoicePart):
        return st.sampled_from(list(map(part.shown, part.values)))
    if part.between is not None:
        first, last = part.between
        each = st.characters(min_codepoint=first, max_codepoint=last)
        return st.text(each, min_size=part.type.size, max_size=part.type.size).filter(
            lambda text: text == text.rstrip("\0")
        )
    if part.type.is_text:
        return _text(0, part.type.size).map(lambda text: text.rstrip("\0"))
    return _between(part.least, part.greatest)


def all_parts(frame: Frame, message: Message, given: dict[str, int | str]) -> dict[str, int | str]:
    """Parts that an event shows: identity, counters and values."""
    identity = dict(zip((part.name for part in frame.identity), message.identity, strict=True))
    shown: dict[str, int | str] = {part.name: identity[part.name] for part in frame.told_identity}
    for part in frame.numbers:
        if isinstance(part, IdentityPart):
            shown[part.name] = given.get(part.name, part.shown(identity[part.name]))
        elif isinstance(part, CounterPart | ValuePart):
            default = -1 if part.default is None else part.shown(part.default)
            shown[part.name] = given.get(part.name, default)
    return shown


# --- structs ------------------------------------------------------------------------------------


@st.composite
def _struct(
    draw: st.DrawFn, fields: Sequence[Field], outer: Scope, held: Held = NOTHING_HELD
) -> dict[str, Any]:
    scope = dict(outer)
    found: dict[str, Any] = {}
    goes_on = True
    for index, field in enumerate(fields):
        uses = list(_uses(field.name, fields[index + 1 :]))
        is_there = field.when is None or worked_out(field.when, scope)
        goes_on = goes_on and (not field.optional or draw(st.booleans()))
        is_there = is_there and goes_on
        drawn = _field(field, scope, uses)
        if field.part:
            drawn = _of_frames(field, uses, held[field.part])
        found[field.name] = draw(drawn) if is_there else None
        if field.region is not None and is_there:
            size = len(value_bytes(field.type, found[field.name], scope))
            if isinstance(field.region, Counted):
                told = _told_by(field.region.by)
                number = _telling(field.region.by, told, size, scope)
                teller = next(item for item in fields if item.name == told)
                assert isinstance(teller.type, Integer)
                least, greatest = _bounds(teller.type, teller)
                assume(least <= number <= greatest)  # What fills could have been more.
                found[told] = scope[told] = number
        scope.pop(field.name, None)
        if isinstance(field.type, Integer | Struct):
            scope[field.name] = found[field.name]
    return found


def _told_by(by: Expression) -> str:
    """Name of the number in front that says how many bytes a region has."""
    return plain_name(by) or str(by).partition(" ")[0]


def _telling(by: Expression, told: str, size: int, scope: Scope) -> int:
    """What that is for a region of this size."""
    return next(n for n in range(1000) if worked_out(by, {**scope, told: n}) == size)


def _uses(name: str, fields: Sequence[Field]) -> Iterator[Counted | Switch]:
    """The counts and switches behind a field that mean it."""
    for field in fields:
        yield from _uses_in(name, field.type)
        if field.name == name:
            return


def _uses_in(name: str, type_: Type) -> Iterator[Counted | Switch]:
    match type_:
        case Struct():
            yield from _uses(name, type_.fields)
        case Array():
            yield from _counted_by(name, type_.extent)
            yield from _uses_in(name, type_.element)
        case Text() | Octets():
            yield from _counted_by(name, type_.extent)
        case Switch():
            if plain_name(type_.selector) == name:
                yield type_
            for case in type_.cases:
                yield from _uses_in(name, case.type)


def _counted_by(name: str, extent: Extent) -> Iterator[Counted]:
    if isinstance(extent, Counted) and plain_name(_bytes_of(extent)) == name:
        yield extent


def _bytes_of(extent: Counted) -> Expression:
    """What counts, be it elements or their bytes."""
    return extent.by.operand if isinstance(extent.by, Quotient) else extent.by


def _each(extent: Counted) -> int:
    """What a number that counts has to be a multiple of."""
    return extent.by.size if isinstance(extent.by, Quotient) else 1


# --- values -------------------------------------------------------------------------------------


def _field(field: Field, scope: Scope, uses: list[Counted | Switch]) -> st.SearchStrategy[Any]:
    if field.const is not None:
        return st.just(_shown(field))
    if uses and isinstance(field.type, Integer):
        return _used(field, field.type, uses)
    return _value(field.type, field, scope)


def _shown(field: Field) -> Any:
    """A constant as JSON shows it."""
    constant = field.const
    if isinstance(field.type, Integer) and field.type.role == "bool":
        return bool(constant)
    if isinstance(constant, bytes):
        return list(constant) if isinstance(field.type, Array) else constant.hex()
    if isinstance(constant, tuple):
        return list(constant)
    return constant


def _value(type_: Type, field: Field | None, scope: Scope) -> st.SearchStrategy[Any]:
    match type_:
        case Integer():
            return _integer(type_, field)
        case Float():
            return _float(type_, field)
        case Text() | Octets():
            return _string(type_, scope)
        case Struct():
            return _struct(type_.fields, scope)
        case Array():
            return _array(type_, field, scope)
    return _switch(type_, scope)


def _integer(type_: Integer, field: Field | None) -> st.SearchStrategy[Any]:
    if type_.role == "bool":
        return st.booleans()
    if type_.enum is not None and type_.enum.closed:
        return st.sampled_from([entry.value for entry in type_.enum.values])
    least, greatest = _bounds(type_, field)
    special = [] if field is None else [entry.value for entry in field.special]
    named = [] if type_.enum is None else [entry.value for entry in type_.enum.values]
    known = [*special, *(value for value in named if least <= value <= greatest)]
    usual = _between(least, greatest)
    return usual | st.sampled_from(known) if known else usual


def _bounds(type_: Integer, field: Field | None) -> tuple[int, int]:
    if field is None or field.least is None or field.greatest is None:
        return type_.least, type_.greatest
    return int(field.least), int(field.greatest)


def _between(least: int, greatest: int) -> st.SearchStrategy[int]:
    ends = [value for value in (least, greatest, 0, -1, 1) if least <= value <= greatest]
    return st.sampled_from(ends) | st.integers(least, greatest)


@st.composite
def _used(
    draw: st.DrawFn, field: Field, type_: Integer, uses: list[Counted | Switch]
) -> int | bool:
    """A value that counts or chooses what follows, so that it can follow."""
    counts = [use for use in uses if isinstance(use, Counted)]
    switches = [use for use in uses if isinstance(use, Switch)]
    least, greatest = _counting(type_, field, counts)
    if counts:
        usual = _count(least, greatest)
    elif type_.enum is not None and type_.enum.closed:
        usual = st.sampled_from([entry.value for entry in type_.enum.values])
    else:
        usual = _between(least, greatest)
    if switches:
        required = _required(switches)
        own = _cases(switches[0]) if required is None else required
        known = [value for value in own if least <= value <= greatest]
        assume(known)  # Two switches may have no case in common.
        usual = usual | st.sampled_from(known) if required is None else st.sampled_from(known)
    value = draw(usual)
    # One that counts bytes may be 0.
    value -= value % lcm(*map(_each, counts))
    return bool(value) if type_.role == "bool" else value


def _cases(switch: Switch) -> list[int]:
    return [case.value for case in switch.cases if case.value is not None]


def _required(switches: Sequence[Switch]) -> list[int] | None:
    """The values that are a case of each switch which has nothing for others; None for any."""
    closed = [
        _cases(switch)
        for switch in switches
        if switch.rest is None and len(_cases(switch)) == len(switch.cases)
    ]
    if not closed:
        return None
    return [value for value in closed[0] if all(value in own for own in closed)]


def _counting(type_: Integer, field: Field, counts: Sequence[Counted]) -> tuple[int, int]:
    """The bounds of a number, of which there has to be room for what it counts."""
    least, greatest = _bounds(type_, field)
    return least, min([greatest, *(use.greatest * _each(use) for use in counts)])


def _of_frames(
    field: Field, uses: list[Counted | Switch], frames: Sequence[Runs]
) -> st.SearchStrategy[int | bool]:
    """A value that each of the frames may have as its part."""
    type_ = field.type
    assert isinstance(type_, Integer)
    counts = [use for use in uses if isinstance(use, Counted)]
    switches = [use for use in uses if isinstance(use, Switch)]
    is_closed = type_.enum is not None and type_.enum.closed
    known = [entry.value for entry in type_.enum.values] if type_.enum and is_closed else None
    required = _required(switches)
    if required is not None:
        known = [value for value in required if known is None or value in known]
    bounds = _counting(type_, field, counts)
    return held_value(field, known, [*map(_each, counts)], bounds, frames)


def _count(least: int, greatest: int) -> st.SearchStrategy[int]:
    """Mostly few; as many as there can be, where that is not too many."""
    few = st.integers(least, max(least, min(greatest, _USUAL_COUNT)))
    return few | st.just(min(greatest, max(least, _GREATEST_COUNT)))


def _float(type_: Float, field: Field | None) -> st.SearchStrategy[float | str]:
    """Numbers; the infinities as texts."""
    if field is None or field.least is None or field.greatest is None:
        usual = st.floats(width=type_.bits, allow_nan=False, allow_infinity=False)
        return usual | st.sampled_from(["inf", "-inf"])
    least, greatest = field.least, field.greatest
    whole = (Fraction(ceil(least)), Fraction(floor(greatest)))
    steps = (least + (greatest - least) * Fraction(step, 8) for step in range(9))
    points = [_rounded(point, type_.bits) for point in (*steps, *whole)]
    return st.sampled_from([point for point in points if least <= point <= greatest])


def _rounded(value: Fraction, bits: int) -> float:
    code = "f" if bits == 32 else "d"
    return float(struct.unpack(code, struct.pack(code, float(value)))[0])


# --- several ------------------------------------------------------------------------------------


@st.composite
def _string(draw: st.DrawFn, type_: Text | Octets, scope: Scope) -> str:
    size = draw(_size(type_.extent, scope))
    if isinstance(type_, Octets):
        return _without_end(type_.extent, draw(_octets(size, type_.byte_bits))).hex()
    if isinstance(type_.extent, Between):
        characters = st.sampled_from(type_.extent.characters.decode())
        return draw(st.text(characters, min_size=size, max_size=size))
    if not isinstance(type_.extent, Fixed):
        return _without_end(type_.extent, draw(_text(size, size)).encode()).decode()
    text = draw(_text(0, size))
    padding = chr(type_.form.padding)
    return (text.replace("\0", "\x01") if padding != "\0" else text).rstrip(padding)


def _without_end(extent: Extent, data: bytes) -> bytes:
    """The bytes with another one in the place of each that would end them."""
    if not isinstance(extent, Until):
        return data
    other = 0x41 if extent.byte != 0x41 else 0x42
    return bytes(other if byte == extent.byte else byte for byte in data)


def _text(least: int, greatest: int) -> st.SearchStrategy[str]:
    return st.text(_ASCII, min_size=least, max_size=greatest)


def _octets(size: int, byte_bits: int) -> st.SearchStrategy[bytes]:
    if byte_bits == 8:
        return st.binary(min_size=size, max_size=size)
    return st.lists(st.integers(0, 0x7F), min_size=size, max_size=size).map(bytes)


def _size(extent: Extent, scope: Scope) -> st.SearchStrategy[int]:
    match extent:
        case Fixed():
            return st.just(extent.count)
        case Counted():
            number = worked_out(extent.by, scope)
            assume(0 <= number <= extent.greatest)
            return st.just(number)
    return _count(extent.counts.least, extent.greatest)


@st.composite
def _array(draw: st.DrawFn, type_: Array, field: Field | None, scope: Scope) -> list[Any]:
    count = draw(_size(type_.extent, scope))
    elements = _value(type_.element, field, scope)
    if count > _USUAL_COUNT and not isinstance(type_.extent, Marked):
        few = [draw(elements) for _ in range(3)]
        return [few[index % 3] for index in range(count)]
    found = [draw(elements) for _ in range(count)]
    if isinstance(type_.extent, Marked):
        _mark_last(type_, type_.extent.mark, found)
    return found


def _mark_last(type_: Array, mark: Operand, elements: list[dict[str, Any]]) -> None:
    """Have the last of the elements say that it is the last, and no other."""
    *outer, name = mark.path
    for index, element in enumerate(elements):
        is_last = index == len(elements) - 1
        record = reduce(getitem, outer, element)
        if isinstance(record[name], bool):
            record[name] = is_last
        elif mark.run is None:
            record[name] = (record[name] or _other_than_zero(type_, mark)) if is_last else 0
        else:
            low, high = mark.run
            bits = sum(1 << bit for bit in range(low, high + 1))
            record[name] &= ~bits
            record[name] |= bits if is_last else 0


def _other_than_zero(type_: Array, mark: Operand) -> int:
    """A value that the last element may have."""
    found: Type = type_.element
    for name in mark.path:
        assert isinstance(found, Struct)
        found = next(field.type for field in found.fields if field.name == name)
    assert isinstance(found, Integer)
    closed = found.enum.values if found.enum is not None and found.enum.closed else ()
    return next((item.value for item in closed if item.value), 1)


@st.composite
def _switch(draw: st.DrawFn, type_: Switch, scope: Scope) -> Any:
    chosen = worked_out(type_.selector, scope)
    case = next((case for case in type_.cases if case.value in (chosen, None)), None)
    if case is None:
        assert type_.rest is not None
        return draw(_octets(draw(_count(0, type_.rest)), 7)).hex()
    if isinstance(case.type, Struct) and not case.type.fields:
        return None
    return draw(_value(case.type, None, scope))
