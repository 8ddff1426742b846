"""Numbers of payloads: what reads and writes one."""

from __future__ import annotations

from fractions import Fraction
from math import inf, nextafter

from protogen.model.numbers import FreeNumeral, Numeral
from protogen.model.payload_plan import FloatStep, IntegerStep, PartStep
from protogen.model.types import Float, Integer, Type
from protogen.targets.typescript.literals import (
    boolean,
    call,
    characters,
    integer,
    is_big,
    listed,
    mapping,
    real,
    text,
)
from protogen.targets.typescript.scope import Scope

_PLAIN = (8, 16, 32, 64)


def is_bigint(type_: Integer) -> bool:
    """True if the values are `bigint`."""
    return is_big(type_.bits) and type_.role != "bool"


def _base(type_: Integer | Float) -> str:
    return "128" if type_.byte_bits == 7 else "256"


def _is_little(type_: Integer | Float) -> str:
    return boolean(type_.byte_order == "little")


def _suffix(type_: Integer) -> str:
    return "be" if type_.byte_order == "big" and type_.size > 1 else ""


def _is_plain(type_: Integer) -> bool:
    return type_.byte_bits == 8 and type_.bits in _PLAIN


# --- reading --------------------------------------------------------------------------------------


def read_number(step: IntegerStep | FloatStep, at: str, scope: Scope) -> str:
    """The expression that reads a number."""
    type_ = step.type
    if isinstance(type_, Float):
        if type_.byte_bits == 7:
            return f"r.float7({type_.bits}, {_is_little(type_)}, {at})"
        return f"r.f{type_.bits}({_is_little(type_)}, {at})"
    found = _read_part(step, at) if isinstance(step, PartStep) else _read_integer(type_, at, scope)
    return closed("r", type_, found, at, scope)


def _read_part(step: PartStep, at: str) -> str:
    """The expression of a number that the frame has."""
    name = "r.bigPart" if is_bigint(step.type) else "r.part"
    found = call(name, text(step.part), at)
    return f"{found} !== 0" if step.type.role == "bool" else found


def closed(by: str, type_: Integer, found: str, at: str, scope: Scope) -> str:
    """The expression, of which a closed enum refuses some values; `by` reads or writes."""
    if type_.enum is None or not type_.enum.closed:
        return found
    return f"{by}.one({found}, {values_of(type_, scope)}, {at})"


def values_of(type_: Type, scope: Scope) -> str:
    """The constant with the values of a closed enum."""
    assert isinstance(type_, Integer)
    assert type_.enum is not None
    values = listed(integer(item.value, big=is_bigint(type_)) for item in type_.enum.values)
    kind = f"readonly {scope.names.types[type_.enum.name]}[]"
    return scope.constants.add("VALUES", kind, values)


def _read_integer(type_: Integer, at: str, scope: Scope) -> str:
    if type_.role == "bool":
        return f"r.bool({at})"
    if isinstance(type_.text, FreeNumeral):
        name = "rt.readBigNumeral" if is_bigint(type_) else "rt.readNumeral"
        return call(name, "r", _numeral(type_, type_.text, scope), at)
    if isinstance(type_.text, Numeral):
        name = "rt.readBigDigits" if is_bigint(type_) else "rt.readDigits"
        return call(name, "r", *_digits(type_, type_.text), at)
    sign = "i" if type_.signed else "u"
    if _is_plain(type_):
        return f"r.{sign}{type_.bits}{_suffix(type_)}({at})"
    kind = "big" if is_bigint(type_) else "int"
    name = f"r.{'s' if type_.signed else 'u'}{kind}"
    return call(name, str(type_.size), str(type_.bits), _is_little(type_), _base(type_), at)


def _digits(type_: Integer, form: Numeral) -> tuple[str, ...]:
    given = (str(form.size), str(type_.bits), boolean(type_.signed))
    return (characters(form.alphabet), *given)


def _numeral(type_: Integer, form: FreeNumeral, scope: Scope) -> str:
    big = is_bigint(type_)
    value = mapping(
        {
            "base": str(form.base),
            "padded": str(form.padded),
            "fraction": str(form.fraction),
            "signed": boolean(type_.signed),
            "upper": boolean(form.upper),
            "greatest": integer(form.greatest, big=big),
            "longest": str(form.longest(signed=type_.signed)),
            "absent": integer(form.absent, big=big),
            "separator": None if form.separator is None else str(form.separator),
            "leads": "true" if form.leads else None,
            "empty": "true" if form.empty else None,
        }
    )
    return scope.constants.add("NUMERAL", "rt.Numeral", value)


# --- writing --------------------------------------------------------------------------------------


def check_number(step: IntegerStep | FloatStep, value: str, at: str, scope: Scope) -> str:
    """The expression of a value that is one of the step's."""
    type_, field = step.type, step.field
    if isinstance(type_, Float):
        found = f"w.real({value}, {type_.bits}, {at})"
        if not field.ranged:
            return found
        least = None if field.least is None else _above(field.least)
        greatest = None if field.greatest is None else _below(field.greatest)
        bounds = ("null" if end is None else real(end) for end in (least, greatest))
        return call("w.ranged", found, *bounds, "[]", at)
    if type_.role == "bool":
        return f"w.truth({value}, {at})"
    assert isinstance(step, IntegerStep)
    big = is_bigint(type_)
    capacity = (integer(item, big=big) for item in (type_.least, type_.greatest))
    found = call(f"w.{'big' if big else 'int'}", value, *capacity, at)
    if field.ranged:
        bounds = (integer(item, big=big) for item in step.bounds)
        special = listed(integer(item.value, big=big) for item in field.special)
        found = call("w.ranged", found, *bounds, special, at)
    return closed("w", type_, found, at, scope)


def _above(bound: Fraction) -> float:
    """The least float that is no less."""
    found = float(bound)
    return nextafter(found, inf) if Fraction(found) < bound else found


def _below(bound: Fraction) -> float:
    """The greatest float that is no more."""
    found = float(bound)
    return nextafter(found, -inf) if Fraction(found) > bound else found


def write_number(step: IntegerStep | FloatStep, value: str, at: str, scope: Scope) -> str:
    """The statement that writes a checked value."""
    if isinstance(step, PartStep):
        return call("w.part", text(step.part), value) + ";"
    type_ = step.type
    if isinstance(type_, Float):
        return f"w.float({value}, {type_.bits}, {_is_little(type_)}, {_base(type_)});"
    if type_.role == "bool":
        return f"w.u8({value});"
    if isinstance(type_.text, FreeNumeral):
        return call("rt.writeNumeral", "w", value, _numeral(type_, type_.text, scope), at) + ";"
    if isinstance(type_.text, Numeral):
        alphabet, size, bits, _ = _digits(type_, type_.text)
        return call("rt.writeDigits", "w", value, alphabet, size, bits, at) + ";"
    if _is_plain(type_) and not is_bigint(type_):
        return f"w.u{type_.bits}{_suffix(type_)}({value});"
    sizes = (str(type_.size), str(type_.bits), _is_little(type_), _base(type_))
    return call("w.ubig" if is_bigint(type_) else "w.uint", value, *sizes) + ";"
