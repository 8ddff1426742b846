"""Meanings of values as the runtime's rules."""

from __future__ import annotations

from fractions import Fraction

from protogen.copying import replace
from protogen.model.types import (
    Array,
    Between,
    Case,
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
    Text,
    Type,
    Until,
)
from protogen.targets.python.formats import constant, is_empty, least, padded_text
from protogen.targets.python.formulas import formula
from protogen.targets.python.literals import call, mapping, number, octets_in_class, text
from protogen.targets.python.names import Names
from protogen.targets.python.presence import where_present


def field_rule(field: Field, names: Names) -> str:
    """The rule of a field."""
    found = _rule(field.type, field, names)
    return where_present(field, found, conditional="_rt.WhenRule", trailing="_rt.OptionalRule")


def _rule(type_: Type, field: Field | None, names: Names) -> str:
    """The rule of a type, with what the field says of its values where it is the field's own."""
    match type_:
        case Integer():
            return _integer(type_, field, names)
        case Float():
            return _float(type_, field)
        case Text():
            form = padded_text(type_) if not type_.form.is_plain else None
            extent = _extent("size", type_.extent)
            return call("_rt.TextRule", **extent, const=_const(field), form=form)
        case Octets():
            return call("_rt.OctetsRule", **_extent("size", type_.extent), const=_const(field))
        case Struct():
            return call("_rt.StructRule", names.types[type_.name])
        case Array():
            return _array(type_, field, names)
        case Switch():
            return _switch(type_, names)


def _integer(type_: Integer, field: Field | None, names: Names) -> str:
    if type_.role == "bool":
        return call("_rt.BoolRule", const=_const(field))
    named = type_.enum or type_.flags
    signed = ["signed=True"] if type_.signed else []
    return call(
        "_rt.IntegerRule",
        str(type_.bits),
        *signed,
        named=names.types[named.name] if named else None,
        closed="True" if type_.enum and type_.enum.closed else None,
        **(_range(field) if field else {}),
        const=_const(field),
        special=_special(field),
        **(_physical(field) if field else {}),
        holds=f"({type_.least}, {type_.greatest})" if type_.is_bound_by_text else None,
    )


def _float(type_: Float, field: Field | None) -> str:
    return call(
        "_rt.FloatRule",
        str(type_.bits),
        **(_range(field) if field else {}),
        const=_const(field),
        **(_physical(field) if field else {}),
    )


def _range(field: Field) -> dict[str, str | None]:
    if not field.ranged or field.least is None or field.greatest is None:
        return {}
    return {"least": number(field.least), "greatest": number(field.greatest)}


def _const(field: Field | None) -> str | None:
    return None if field is None or field.const is None else constant(field)


def _special(field: Field | None) -> str | None:
    if field is None or not field.special:
        return None
    return mapping({text(item.name): str(item.value) for item in field.special})


def _physical(field: Field) -> dict[str, str | None]:
    """What turns raw values into physical ones, and their unit."""
    unit = {"unit": text(field.unit) if field.unit else None}
    if not field.scaled:
        return unit
    return {
        "scale": _fraction(field.scale) if field.scale != 1 else None,
        "offset": _fraction(field.offset) if field.offset != 0 else None,
        **unit,
    }


def _fraction(value: Fraction) -> str:
    return f"_rt.Fraction({value.numerator}, {value.denominator})"


def _extent(key: str, extent: Extent) -> dict[str, str | None]:
    match extent:
        case Fixed():
            return {key: str(extent.count)}
        case Counted():
            return {key: formula(extent.by)}
        case Fill() | Until():
            until = f"0x{extent.byte:02X}" if isinstance(extent, Until) else None
            return {"greatest": str(extent.greatest), "least": least(extent), "until": until}
        case Between():
            bounds = {"greatest": str(extent.greatest), "least": least(extent)}
            return {**bounds, "characters": octets_in_class(extent.characters)}
        case Marked(mark=mark, greatest=greatest):
            bounds = {"greatest": str(greatest), "least": str(extent.least)}
            return {**bounds, "mark": formula(mark)}


def _array(type_: Array, field: Field | None, names: Names) -> str:
    """The rule of an array: range, scale and special values hold for each element."""
    inner = None if field is None else replace(field, const=None)
    element = _rule(type_.element, inner, names)
    const = _const(field) if field else None
    return call("_rt.ArrayRule", element, **_extent("count", type_.extent), const=const)


def _switch(type_: Switch, names: Names) -> str:
    cases = mapping({str(case.value): _case(case, names) for case in type_.cases})
    rest = None if type_.rest is None else call("_rt.OctetsRule", greatest=str(type_.rest))
    return call("_rt.SwitchRule", formula(type_.selector), cases, rest=rest)


def _case(case: Case, names: Names) -> str:
    return "None" if is_empty(case.type) else _rule(case.type, None, names)
