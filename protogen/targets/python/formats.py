"""Types of the model as construct declarations."""

from __future__ import annotations

from collections.abc import Iterator
from functools import lru_cache

from protogen.model.expressions import plain_name
from protogen.model.numbers import FreeNumeral, Numeral
from protogen.model.packing import FilledPacking
from protogen.model.protocol import Protocol
from protogen.model.types import (
    Array,
    Between,
    Case,
    Counted,
    Delimited,
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
    packing_of,
)
from protogen.runtime.attributes import held_argument
from protogen.targets.python.formulas import formula
from protogen.targets.python.literals import call, mapping, octets_in_class, text
from protogen.targets.python.names import Names
from protogen.targets.python.presence import where_present


def field_format(field: Field, names: Names) -> str:
    """The declaration of a field, its constant included."""
    found = _part(field, names) if field.part else _checked(field.type, names)
    if field.const is not None:
        found = call("_c.Fixed", _any_size(field.type, names), constant(field))
    if field.region is not None:
        found = call("_c.Region", extent(field.region), found)
    return where_present(field, found, conditional="_c.When", trailing="_c.IfLeft")


def _part(field: Field, names: Names) -> str:
    """The declaration of a number that the frame has."""
    found = call("_c.Part", text(held_argument(field.name)), *(["bool"] if field.is_bool else []))
    if isinstance(field.type, Integer) and field.type.enum and field.type.is_closed:
        return call("_c.Closed", found, names.types[field.type.enum.name])
    return found


def _any_size(type_: Type, names: Names) -> str:
    """The declaration of a constant's type: more bytes or fewer are another constant."""
    if not isinstance(type_, Text | Octets | Array) or not isinstance(type_.extent, Fill):
        return type_format(type_, names)
    if isinstance(type_, Array):
        return call(*_filled(type_), _checked(type_.element, names))
    return call(f"{_string_kind(type_)}Fill", seven_bit=_seven_bit(type_))


def _string_kind(type_: Text | Octets) -> str:
    return "_c.Latin1" if isinstance(type_, Text) else "_c.Octets"


def _seven_bit(type_: Text | Octets | Switch) -> str | None:
    return "True" if type_.byte_bits == 7 else None


def _checked(type_: Type, names: Names) -> str:
    """The declaration of a type that refuses values outside of a closed enum."""
    if isinstance(type_, Integer) and type_.enum and type_.enum.closed:
        return call("_c.Closed", type_format(type_, names), names.types[type_.enum.name])
    return type_format(type_, names)


def constant(field: Field) -> str:
    """The raw value of a field's constant, as `FORMAT` has it."""
    match field.const:
        case bytes():
            return octets_in_class(field.const)
        case str():
            return text(field.const)
        case tuple():
            return str(list(field.const))
        case int() if field.is_bool:
            return str(bool(field.const))
    return repr(field.const)


def type_format(type_: Type, names: Names) -> str:
    """The declaration of a type."""
    match type_:
        case Integer():
            return _integer(type_)
        case Float():
            kind = "_c.SevenBitFloat" if type_.byte_bits == 7 else "_c.Float"
            return call(kind, str(type_.bits), order=_order(type_))
        case Text() | Octets():
            return _string(type_)
        case Struct():
            return f"{names.types[type_.name]}.FORMAT"
        case Array():
            return _array(type_, names)
        case Switch():
            return _switch(type_, names)


@lru_cache(1024)
def _integer(type_: Integer) -> str:
    if type_.role == "bool":
        return "_c.Bit" if type_.packed else "_c.Flag01"
    if isinstance(type_.text, FreeNumeral):
        return call("_c.Written", numeral(type_))
    if type_.text is not None:
        return call("_c.Digits", *_digits(type_, type_.text))
    if type_.packed:
        return call("_c.Bits", str(type_.bits), signed="True" if type_.signed else None)
    kind = "_c.SevenBit" if type_.byte_bits == 7 else "_c.Int"
    signed = "signed=True" if type_.signed else None
    arguments = [str(type_.bits), *([signed] if signed else [])]
    return call(kind, *arguments, order=_order(type_))


def numeral(type_: Integer) -> str:
    """What reads and writes an integer as text."""
    form = type_.text
    if isinstance(form, Numeral):
        return call("_rt.Numeral", *_digits(type_, form))
    assert form is not None
    return call(
        "_rt.FreeNumeral",
        str(form.base),
        str(form.front),
        padded=str(form.padded) if form.padded > 1 else None,
        fraction=str(form.fraction) if form.fraction else None,
        signed="True" if type_.signed else None,
        upper=None if form.upper else "False",
        separated=_separated(form),
    )


def _separated(form: FreeNumeral) -> str | None:
    if form.separator is None:
        return None
    leads, empty = ("True" if stated else None for stated in (form.leads, form.empty))
    return call("_rt.Separated", f"0x{form.separator:02X}", leads=leads, empty=empty)


def _digits(type_: Integer, form: Numeral) -> tuple[str, ...]:
    """The arguments of what reads and writes an integer as so many digits."""
    alphabet = octets_in_class(form.alphabet)
    if not form.known:
        first = form.alphabet[0]
        alphabet = f"bytes(range(0x{first:02X}, 0x{first + form.base:02X}))"
    signed = ["signed=True"] if type_.signed else []
    return (str(type_.bits), alphabet, str(form.size), *signed)


def _order(type_: Integer | Float) -> str | None:
    return text(type_.byte_order) if type_.size > 1 else None


def _string(type_: Text | Octets) -> str:
    kind, seven = _string_kind(type_), _seven_bit(type_)
    if isinstance(type_, Text) and not type_.form.is_plain:
        return call("_c.Padded", *_text_form(type_), seven_bit=seven)
    match type_.extent:
        case Fill(greatest=greatest) as of:
            return call(f"{kind}Fill", str(greatest), seven_bit=seven, least=least(of))
        case Until(byte=byte, greatest=greatest) as of:
            bounds = (f"0x{byte:02X}", str(greatest))
            return call(f"{kind}Until", *bounds, seven_bit=seven, least=least(of))
        case Between() as of:
            return call("_c.TextBetween", *between(of), least=least(of))
    return call(kind, extent(type_.extent), seven_bit=seven)


def between(of: Between) -> tuple[str, ...]:
    """Arguments that say what stands around a text, and which characters it can have."""
    leads = ("leads=True",) if of.leads else ()
    return f"0x{of.separator:02X}", str(of.greatest), octets_in_class(of.characters), *leads


def padded_text(type_: Text) -> str:
    """The codec of a text of a fixed size."""
    return call("_rt.PaddedText", *_text_form(type_))


def _text_form(type_: Text) -> tuple[str, ...]:
    form = type_.form
    given = {"bits": (form.bits, 8), "shift": (form.shift, 0), "add": (form.add, 0)}
    stated = [f"{name}={value}" for name, (value, usual) in given.items() if value != usual]
    return (extent(type_.extent), f"0x{form.padding:02X}", *stated)


def extent(of: Extent) -> str:
    """A number, or what earlier fields count by."""
    match of:
        case Fixed():
            return str(of.count)
        case Counted() if of.stated or plain_name(of.by) is None:
            return call("_c.Count", formula(of.by), str(of.least), str(of.greatest))
        case Counted():
            return formula(of.by)
        case Delimited():
            return str(of.greatest)


def least(of: Delimited) -> str | None:
    """The least number, where it is not the least that there can be."""
    usual = 1 if isinstance(of, Marked) else 0
    return str(of.least) if of.least > usual else None


def _array(type_: Array, names: Names) -> str:
    element = _checked(type_.element, names)
    if isinstance(type_.extent, Fill):
        bounds = (element, str(type_.extent.greatest))
        tail = _tail(type_.extent.tail)
        return call(*_filled(type_), *bounds, least=least(type_.extent), tail=tail)
    if isinstance(type_.extent, Marked):
        of = type_.extent
        return call("_c.UpToLast", element, formula(of.mark), str(of.greatest), least=least(of))
    counted = call("_c.Counted", extent(type_.extent), element)
    return counted if type_.packed is None else call("_c.Packed", text(type_.packed), counted)


def _filled(type_: Array) -> tuple[str, ...]:
    """What reads and writes elements that take what is left, and how they are packed."""
    packing = packing_of(type_)
    if isinstance(packing, FilledPacking):
        return "_c.PackedFill", text(packing.order), str(packing.width)
    return ("_c.Fill",)


def _tail(of: Tail | None) -> str | None:
    """What stands behind elements: where they end."""
    if of is None:
        return None
    separator = None if of.separator is None else f"0x{of.separator:02X}"
    return call("_c.Tail", str(of.element), str(of.least), separator=separator)


def _switch(type_: Switch, names: Names) -> str:
    cases = mapping({str(case.value): _case(case, names) for case in type_.cases})
    seven = _seven_bit(type_)
    rest = None if type_.rest is None else call("_c.OctetsFill", str(type_.rest), seven_bit=seven)
    return call("_c.Cases", formula(type_.selector), cases, rest=rest)


def _case(case: Case, names: Names) -> str:
    return "_c.Pass" if is_empty(case.type) else type_format(case.type, names)


def is_empty(type_: Type) -> bool:
    """True if the type is a struct without fields, which Python shows as None."""
    return isinstance(type_, Struct) and not type_.fields


def classes_of(protocol: Protocol) -> tuple[Struct, ...]:
    """The structs that need a class: all but those that are only cases without bytes."""
    named = {name for fields in _field_lists(protocol) for item in fields for name in _named(item)}
    return tuple(item for item in protocol.structs if item.fields or item.name in named)


def _field_lists(protocol: Protocol) -> Iterator[tuple[Field, ...]]:
    yield from (message.fields for message in protocol.messages)
    yield from (struct.fields for struct in protocol.structs)


def _named(field: Field) -> Iterator[str]:
    """The struct that a field is, or has as its elements."""
    type_ = field.type
    while isinstance(type_, Array):
        type_ = type_.element
    if isinstance(type_, Struct):
        yield type_.name
