"""Numbers of payloads: what reads, checks and writes one."""

from __future__ import annotations

from protogen.model.floats import float_within
from protogen.model.numbers import FreeNumeral
from protogen.model.payload_plan import FloatStep, IntegerStep, PartStep
from protogen.model.types import Array, Constant, Float, Integer, Octets, Switch, Text, Type
from protogen.targets.typescript.literals import (
    Code,
    Data,
    call,
    characters,
    given,
    integer,
    is_big,
    literal,
    told,
)
from protogen.targets.typescript.scope import Scope

_PLAIN = (8, 16, 32, 64)


def is_bigint(type_: Integer) -> bool:
    """True if the values are `bigint`."""
    return is_big(type_.bits) and type_.role != "bool"


def is_little(item: Integer | Float) -> bool:
    """True if the least significant byte stands first."""
    return item.byte_order == "little"


def is_seven(type_: Integer | Float | Text | Octets | Switch) -> bool:
    """True if no byte of a value has its most significant bit set."""
    return type_.byte_bits == 7


def spelled(type_: Type, value: Constant | None) -> Data:
    """A constant or default of a type."""
    assert value is not None
    match value:
        case tuple():
            assert isinstance(type_, Array)
            return [spelled(type_.element, item) for item in value]
        case str() | bytes():
            return value
    if isinstance(type_, Float):
        return float(value)
    assert isinstance(type_, Integer)
    is_bool = type_.role == "bool"
    return bool(value) if is_bool else integer(int(value), big=is_bigint(type_))


def _sized(type_: Integer) -> tuple[Data, ...]:
    return type_.size, type_.bits, is_little(type_), 128 if is_seven(type_) else 256


def _plain(type_: Integer) -> str:
    """The name of what reads or writes whole bytes, such as `16be`; empty if nothing does."""
    if is_seven(type_) or type_.bits not in _PLAIN:
        return ""
    return f"{type_.bits}{'' if is_little(type_) or type_.size == 1 else 'be'}"


def _seven(type_: Integer) -> str:
    """The same for all bits of one or two bytes of 7 bits."""
    is_one = type_.bits == 7 and not type_.signed
    is_two = type_.bits == 14 and is_little(type_)
    return str(type_.bits) if is_seven(type_) and (is_one or is_two) else ""


def closed(by: str, type_: Integer, found: str, at: str, scope: Scope) -> Code:
    """The expression, of which a closed enum refuses some values; `by` reads or writes."""
    if not type_.is_closed:
        return Code(found)
    return Code(f"{by}.one({found}, {values_of(type_, scope)}, {at})")


def values_of(type_: Type, scope: Scope) -> Code:
    """The constant with the values of a closed enum."""
    assert isinstance(type_, Integer)
    assert type_.enum is not None
    values = [integer(item.value, big=is_bigint(type_)) for item in type_.enum.values]
    kind = f"readonly {scope.names.types[type_.enum.name]}[]"
    return scope.constants.add("VALUES", kind, literal(values))


def _text(type_: Integer, scope: Scope) -> tuple[str, Code]:
    """What reads and writes an integer as text, and the constant that says how."""
    form, big = type_.text, is_bigint(type_)
    if isinstance(form, FreeNumeral):
        value = {
            **told(form, "base padded fraction upper leads empty"),
            **given(separator=form.separator),
            "signed": type_.signed,
            "greatest": integer(form.greatest, big=big),
            "longest": form.longest(signed=type_.signed),
            "absent": integer(form.absent, big=big),
        }
        return "Numeral", scope.constants.add("NUMERAL", "rt.Numeral", literal(value))
    assert form is not None
    value = {"alphabet": characters(form.alphabet), "size": form.size}
    value |= told(type_, "bits signed")
    return "Digits", scope.constants.add("DIGITS", "rt.Digits", literal(value))


def read_number(step: IntegerStep | FloatStep, at: Code, scope: Scope) -> Code:
    """The expression that reads a number."""
    type_ = step.type
    if isinstance(type_, Float):
        return _call("r", type_, at)
    if isinstance(step, PartStep):
        found = call("r.bigPart" if is_bigint(type_) else "r.part", step.part, at)
        found = Code(f"{found} !== 0") if type_.role == "bool" else found
    elif type_.text is not None:
        kind, form = _text(type_, scope)
        found = call(f"rt.read{'Big' if is_bigint(type_) else ''}{kind}", Code("r"), form, at)
    else:
        found = _call("r", type_, at)
    return closed("r", type_, found, at, scope)


def write_number(step: IntegerStep | FloatStep, value: Code, at: Code, scope: Scope) -> Code:
    """The expression that writes a value; it has to be checked unless `is_checked`."""
    type_ = step.type
    if isinstance(step, PartStep):
        return call("w.part", step.part, value)
    if isinstance(type_, Integer) and type_.text is not None:
        kind, form = _text(type_, scope)
        return call(f"rt.write{kind}", Code("w"), value, form, at)
    if isinstance(type_, Integer) and is_bigint(type_):
        return call("w.ubig", value, *_sized(type_))
    return _call("w", type_, value, at)


def _call(by: str, type_: Integer | Float, *around: Code) -> Code:
    """What reads or writes whole bytes; it is given a value, if it writes one, and the path."""
    *value, at = around
    how: list[Data] = []
    if isinstance(type_, Float):
        name, how = f"f{type_.bits}", [is_little(type_)]
        if is_seven(type_):
            name, how = "float7", [type_.bits, *how]
    elif type_.role == "bool":
        name = "bool"
    elif plain := _plain(type_) or _seven(type_):
        name = f"{'i' if type_.signed else 'u'}{plain}"
    else:
        name = f"{'s' if type_.signed else 'u'}{'big' if is_bigint(type_) else 'int'}"
        how = [*_sized(type_)]
    return call(f"{by}.{name}", *value, *how, at)


def is_checked(step: IntegerStep | FloatStep) -> bool:
    """True if what writes a value checks all of it."""
    if step.field.ranged or isinstance(step, PartStep):
        return False
    type_ = step.type
    if isinstance(type_, Float) or type_.role == "bool":
        return True
    return type_.text is None and not is_bigint(type_) and not type_.is_closed


def check_number(step: IntegerStep | FloatStep, value: str, at: Code, scope: Scope) -> Code:
    """The expression of a value that is one of the step's."""
    type_, field, own = step.type, step.field, Code(value)
    if isinstance(type_, Float):
        found = call("w.real", own, type_.bits, at)
        if not field.ranged:
            return found
        least = None if field.least is None else float_within(field.least, 64, up=True)
        greatest = None if field.greatest is None else float_within(field.greatest, 64, up=False)
        return call("w.ranged", found, literal(least), literal(greatest), (), at)
    if type_.role == "bool":
        return call("w.truth", own, at)
    assert isinstance(step, IntegerStep)
    big = is_bigint(type_)
    ends = (integer(item, big=big) for item in (type_.least, type_.greatest))
    found = call(f"w.{'big' if big else 'int'}", own, *ends, at)
    if field.ranged:
        bounds = (integer(item, big=big) for item in step.bounds)
        special = [integer(item.value, big=big) for item in field.special]
        found = call("w.ranged", found, *bounds, special, at)
    return closed("w", type_, found, at, scope)
