"""Types of TypeScript: interfaces of records, constants of enums, and what shows a field."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from protogen.model.computed import computed
from protogen.model.meanings import BitField, Enum, Flags
from protogen.model.messages import Message
from protogen.model.physical import line_of
from protogen.model.types import Array, Field, Float, Integer, Octets, Struct, Switch, Text, Type
from protogen.targets import descriptions
from protogen.targets.escape import paragraphs
from protogen.targets.typescript.declarations import (
    Declaration,
    Parameter,
    alias,
    comment,
    constants,
    function,
    interface,
)
from protogen.targets.typescript.literals import call, integer, key, listed, text
from protogen.targets.typescript.names import Names
from protogen.targets.typescript.numbers import is_bigint

_IN = "  "


def enum_of(item: Enum, names: Names) -> Iterator[Declaration]:
    """An enum: its values, and the type of them."""
    name = names.types[item.name]
    big = any(value.value.bit_length() > 53 for value in item.values)
    values = [
        (key(entry.name), integer(entry.value, big=big), _remark(entry.about.doc))
        for entry in item.values
    ]
    doc = comment(descriptions.of_named(item.name, item.about))
    yield constants(name, values, doc)
    yield alias(name, f"(typeof {name})[keyof typeof {name}]", doc)


def flags_of(item: Flags, names: Names) -> Iterator[Declaration]:
    """A set of flags: the bit of each."""
    big = any(entry.bit > 30 for entry in item.bits)
    values = [
        (key(entry.name), integer(1 << entry.bit, big=big), _remark(entry.about.doc))
        for entry in item.bits
    ]
    yield constants(
        names.types[item.name], values, comment(descriptions.of_named(item.name, item.about))
    )


def _remark(doc: str) -> str:
    return comment(paragraphs(doc), _IN)


def struct_of(item: Struct, names: Names) -> Iterator[Declaration]:
    """A struct."""
    doc = comment(descriptions.of_named(item.name, item.about))
    yield from _record(item, names, [], doc)


def message_of(item: Message, names: Names) -> Iterator[Declaration]:
    """A message."""
    doc = comment(descriptions.of_message(item))
    yield from _record(item, names, [f"{_IN}readonly message: {text(item.name)};"], doc)


def input_name(record: Struct | Message, names: Names) -> str:
    """The type of what an encoder takes for a record."""
    return (names.inputs if _has_input(record) else names.types)[record.name]


def _has_input(record: Struct | Message) -> bool:
    """True if an encoder takes less than a decoder gives."""
    counts = computed(record.fields)
    return any(_may_be_left_out(field) or field.name in counts for field in record.fields) or any(
        _has_input(inner) for field in record.fields for inner in _structs(field.type)
    )


def _may_be_left_out(field: Field) -> bool:
    return field.const is not None or field.default is not None or field.may_be_absent


def _structs(type_: Type) -> Iterator[Struct]:
    """The structs that a value of the type has directly inside."""
    match type_:
        case Struct():
            yield type_
        case Array():
            yield from _structs(type_.element)
        case Switch():
            for case in type_.cases:
                yield from _structs(case.type)


def _record(
    item: Struct | Message, names: Names, first: Sequence[str], doc: str
) -> Iterator[Declaration]:
    name, counts = names.types[item.name], computed(item.fields)
    own = (_member(field, item.name, names, "", field.name in counts) for field in item.fields)
    yield interface(name, [*first, *own], doc)
    if _has_input(item):
        taken = (
            _member(field, item.name, names, "Input", field.name in counts) for field in item.fields
        )
        given = [*first, *taken]
        what = comment([f"What an encoder takes for {name}."])
        yield interface(names.inputs[item.name], given, what)


def _member(field: Field, record: str, names: Names, kind: str, is_computed: bool) -> str:
    own = key(names.records[record].fields[field.name])
    type_ = field_type(field, names, kind)
    if kind and (_may_be_left_out(field) or is_computed):
        member = f"{_IN}readonly {own}?: {type_} | undefined;"
    else:
        member = f"{_IN}{'readonly ' if kind or field.const is not None else ''}{own}: {type_};"
    if kind:
        return member
    facts = descriptions.facts_of(field, "null", is_computed=is_computed)
    return comment(descriptions.of_field(field, facts), _IN) + member


def field_type(field: Field, names: Names, kind: str = "") -> str:
    """The type of a field's value; null where the field is not there."""
    found = _constant_type(field) if field.const is not None else _type(field.type, names, kind)
    is_absent = field.may_be_absent and not found.endswith("null")
    return f"{found} | null" if is_absent else found


def _constant_type(field: Field) -> str:
    match field.const:
        case tuple():
            big = field.integer is not None and is_bigint(field.integer)
            return f"readonly {'bigint' if big else 'number'}[]"
        case str():
            return text(field.const)
        case bytes():
            return "Uint8Array"
    if isinstance(field.type, Float):
        return "number"
    assert isinstance(field.type, Integer)
    assert field.const is not None
    if field.is_bool:
        return "true" if field.const else "false"
    return integer(int(field.const), big=is_bigint(field.type))


def _type(type_: Type, names: Names, kind: str) -> str:
    match type_:
        case Integer():
            return _integer_type(type_, names)
        case Float():
            return "number"
        case Text():
            return "string"
        case Octets():
            return "Uint8Array"
        case Struct():
            own = names.types[type_.name]
            return input_name(type_, names) if kind else own
        case Array():
            element = _type(type_.element, names, kind)
            element = f"({element})" if " | " in element else element
            return f"{'readonly ' if kind else ''}{element}[]"
        case Switch():
            return _switch_type(type_, names, kind)


def _integer_type(type_: Integer, names: Names) -> str:
    if type_.role == "bool":
        return "boolean"
    number = "bigint" if is_bigint(type_) else "number"
    if type_.enum is None:
        return number
    name = names.types[type_.enum.name]
    return name if type_.enum.closed else f"{name} | ({number} & {{}})"


def _switch_type(type_: Switch, names: Names, kind: str) -> str:
    choices = [
        "null" if is_nothing(case.type) else _type(case.type, names, kind) for case in type_.cases
    ]
    if type_.rest is not None:
        choices.append("Uint8Array")
    distinct = dict.fromkeys(choices)
    ordered = [choice for choice in distinct if choice != "null"]
    return " | ".join([*ordered, *(["null"] if "null" in distinct else [])])


def is_nothing(type_: Type) -> bool:
    """True if the type is a struct without fields, which is null in a case."""
    return isinstance(type_, Struct) and not type_.fields


# --- what shows a field in another way ------------------------------------------------------------


def views_of(record: Struct | Message, names: Names) -> Iterator[Declaration]:
    """Functions that give physical values, raw ones of these, and runs of bits."""
    for field in record.fields:
        if field.scaled:
            yield _physical(field, record.name, names)
            yield _nearest(field, record.name, names)
        for item in field.bit_fields:
            yield _bits(field, item, record.name, names)


def _holder(field: Field, record: str, names: Names) -> tuple[Parameter, str]:
    """The parameter that has the field, and the expression of its value."""
    own = names.records[record].fields[field.name]
    type_ = f"Pick<{names.types[record]}, {text(own)}>"
    member = key(own)
    return Parameter("record", type_), f"record{member if member[0] == '[' else f'.{member}'}"


def _physical(field: Field, record: str, names: Names) -> Declaration:
    parameter, value = _holder(field, record, names)
    line = line_of(field)
    numbers = f"{line.factor}n, {line.term}n, {line.divisor}n"
    big = field.integer is not None and is_bigint(field.integer)
    special = listed(integer(item.value, big=big) for item in field.special)
    raw = "raw" if isinstance(field.type, Array) else value
    found = f"rt.physical({raw}, {numbers})"
    result = "number"
    if field.special:
        result = "number | null"
        found = f"{special}.includes({raw}) ? null : {found}"
    if isinstance(field.type, Array):
        many = f"({result})" if " | " in result else result
        result, found = f"{many}[]", f"{value}.map((raw) => {found})"
    if field.may_be_absent:
        result = result if result.endswith("| null") else f"{result} | null"
        found = f"{value} === null ? null : {found}"
    unit = f" in {field.unit}" if field.unit else ", scaled"
    what = next(iter(paragraphs(field.about.doc)), field.name.replace("_", " ").capitalize())
    none = "; null: no reading" if field.special else ""
    doc = comment([f"{what.rstrip('.')}{unit}{none}."])
    name, _ = names.records[record].reading(field)
    return function(name, [parameter], result, [f"return {found};"], doc, exported=True)


def _nearest(field: Field, record: str, names: Names) -> Declaration:
    _, name = names.records[record].reading(field)
    line, parameter = line_of(field), Parameter("value", "number")
    doc = comment([f"The raw `{field.name}` nearest to a value in {field.unit or 'its unit'}."])
    if field.integer is None:
        back = f"(value * {line.divisor} - {line.term}) / {line.factor}"
        return function(name, [parameter], "number", [f"return {back};"], doc, exported=True)
    big = is_bigint(field.integer)
    ends = (f"{field.integer.least}n", f"{field.integer.greatest}n")
    special = listed(f"{item.value}n" for item in field.special)
    numbers = (f"{line.factor}n", f"{line.term}n", f"{line.divisor}n")
    found = call("rt.nearest", "value", *numbers, *ends, special)
    body = f"return {found if big else f'Number({found})'};"
    result = "bigint" if big else "number"
    return function(name, [parameter], result, [body], doc, exported=True)


def _bits(field: Field, item: BitField, record: str, names: Names) -> Declaration:
    parameter, value = _holder(field, record, names)
    name = names.records[record].run(field, item)
    found = f"rt.bits({value}, {item.low}, {item.high})"
    if item.gaps:
        found = f"{found} & {item.mask >> item.low}"
    result = "number"
    if item.enum is not None:
        result = f"{names.types[item.enum.name]} | (number & {{}})"
    if field.may_be_absent:
        result, found = f"{result} | null", f"{value} === null ? null : {found}"
    what = next(iter(paragraphs(item.about.doc)), item.name.replace("_", " ").capitalize())
    doc = comment([f"{what.rstrip('.')}; {item.words} of {field.name}."])
    return function(name, [parameter], result, [f"return {found};"], doc, exported=True)
