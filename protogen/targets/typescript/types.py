"""Types of TypeScript: interfaces of records, constants of enums, and what shows a field."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence

from protogen.model.computed import counting
from protogen.model.meanings import BitField, Enum, Flags
from protogen.model.messages import Message
from protogen.model.nesting import structs_in
from protogen.model.physical import line_of
from protogen.model.types import Array, Field, Float, Integer, Octets, Struct, Switch, Text, Type
from protogen.targets import descriptions
from protogen.targets.escape import paragraphs
from protogen.targets.typescript.declarations import (
    Declaration,
    alias,
    comment,
    constants,
    function,
    interface,
)
from protogen.targets.typescript.literals import (
    Code,
    call,
    integer,
    is_big,
    key,
    literal,
    member,
)
from protogen.targets.typescript.names import Names
from protogen.targets.typescript.numbers import is_bigint, spelled

_IN = "  "
_GREATEST_FLAG = 30
"""The highest bit that JavaScript's operators leave a number above 0."""


def constants_of(item: Enum | Flags, names: Names) -> Iterator[Declaration]:
    """The values of an enum, and the type of them; of a set of flags the bit of each."""
    name, doc = names.types[item.name], comment(descriptions.of_named(item.name, item.about))
    if isinstance(item, Enum):
        entries = [(it.name, it.value, it.about.doc) for it in item.values]
        big = any(is_big(it.value.bit_length()) for it in item.values)
    else:
        entries = [(it.name, 1 << it.bit, it.about.doc) for it in item.bits]
        big = any(it.bit > _GREATEST_FLAG for it in item.bits)
    values = [
        (key(entry), integer(value, big=big), comment(paragraphs(remark), _IN))
        for entry, value, remark in entries
    ]
    yield constants(name, values, doc)
    if isinstance(item, Enum):
        yield alias(name, f"(typeof {name})[keyof typeof {name}]", doc)


def struct_of(item: Struct, names: Names) -> Iterator[Declaration]:
    """A struct."""
    doc = comment(descriptions.of_named(item.name, item.about))
    yield from _record(item, names, [], doc)


def message_of(item: Message, names: Names) -> Iterator[Declaration]:
    """A message."""
    doc = comment(descriptions.of_message(item))
    yield from _record(item, names, [f"{_IN}readonly message: {literal(item.name)};"], doc)


def input_name(record: Struct | Message, names: Names) -> str:
    """The type of what an encoder takes for a record."""
    return (names.inputs if _has_input(record) else names.types)[record.name]


def _has_input(record: Struct | Message) -> bool:
    """True if an encoder takes less than a decoder gives."""
    counts = counting(record.fields)
    return any(_may_be_left_out(field) or field.name in counts for field in record.fields) or any(
        _has_input(inner) for field in record.fields for inner in structs_in(field.type)
    )


def _may_be_left_out(field: Field) -> bool:
    return field.const is not None or field.default is not None or field.may_be_absent


def _record(
    item: Struct | Message, names: Names, first: Sequence[str], doc: str
) -> Iterator[Declaration]:
    name = names.types[item.name]
    yield interface(name, [*first, *_members(item, names, "")], doc)
    if _has_input(item):
        what = comment([f"What an encoder takes for {name}."])
        yield interface(names.inputs[item.name], [*first, *_members(item, names, "Input")], what)


def _members(item: Struct | Message, names: Names, kind: str) -> Iterator[str]:
    """The members of a record; of another kind than itself, of what an encoder takes for it."""
    own, counts = names.records[item.name].fields, counting(item.fields)
    for field in item.fields:
        name, type_, is_computed = (
            key(own[field.name]),
            field_type(field, names, kind),
            field.name in counts,
        )
        if not kind:
            readonly = "readonly " if field.const is not None else ""
            facts = descriptions.facts_of(field, "null", is_computed=is_computed)
            doc = comment(descriptions.of_field(field, facts), _IN)
            yield f"{doc}{_IN}{readonly}{name}: {type_};"
        elif is_computed or _may_be_left_out(field):
            yield f"{_IN}readonly {name}?: {type_} | undefined;"
        else:
            yield f"{_IN}readonly {name}: {type_};"


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
        case bytes():
            return "Uint8Array"
    assert field.const is not None
    return "number" if isinstance(field.type, Float) else literal(spelled(field.type, field.const))


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
    choices = dict.fromkeys(
        "null"
        if isinstance(case.type, Struct) and not case.type.fields
        # A struct without fields is null in a case.
        else _type(case.type, names, kind)
        for case in type_.cases
    )
    has_nothing = choices.pop("null", "") is None
    rest = [] if type_.rest is None else ["Uint8Array"]
    return " | ".join(dict.fromkeys([*choices, *rest, *(["null"] if has_nothing else [])]))


# --- what shows a field in another way ------------------------------------------------------------


def views_of(record: Struct | Message, names: Names) -> Iterator[Declaration]:
    """Functions that give physical values, raw ones of these, and runs of bits."""
    own = names.records[record.name]
    for field in record.fields:
        holder = f"Pick<{names.types[record.name]}, {literal(own.fields[field.name])}>"
        value = member("record", own.fields[field.name])
        if field.scaled:
            yield _physical(own.reading(field), {"record": holder}, field, value)
            yield _nearest(own.raw(field), field)
        for item in field.bit_fields:
            enum = None if item.enum is None else names.types[item.enum.name]
            yield _bits(own.run(field, item), {"record": holder}, field, item, value, enum)


def _view(
    name: str, parameters: Mapping[str, str], result: str, value: str, doc: str
) -> Declaration:
    body = [f"return {value};"]
    return function(name, parameters, result, body, comment([doc]), exported=True)


def _line(field: Field) -> tuple[Code, ...]:
    return tuple(map(integer, line_of(field)))


def _physical(name: str, record: Mapping[str, str], field: Field, value: Code) -> Declaration:
    big = field.integer is not None and is_bigint(field.integer)
    special = [integer(item.value, big=big) for item in field.special]
    result = "number | null" if special else "number"
    if isinstance(field.type, Array):
        result = f"({result})[]" if special else "number[]"
    if field.may_be_absent and not result.endswith("null"):
        result = f"{result} | null"
    found = call("rt.physical", value, *_line(field), special or None)
    unit = f" in {field.unit}" if field.unit else ", scaled"
    none = "; null: no reading" if field.special else ""
    return _view(name, record, result, found, f"{_summary(field)}{unit}{none}.")


def _nearest(name: str, field: Field) -> Declaration:
    doc = f"The raw `{field.name}` nearest to a value in {field.unit or 'its unit'}."
    type_, line = field.integer, line_of(field)
    if type_ is None:
        back = f"(value * {line.divisor} - {line.term}) / {line.factor}"
        return _view(name, {"value": "number"}, "number", back, doc)
    special = [integer(item.value) for item in field.special]
    ends = integer(type_.least), integer(type_.greatest)
    found = call("rt.nearest", Code("value"), *_line(field), *ends, special)
    if is_bigint(type_):
        return _view(name, {"value": "number"}, "bigint", found, doc)
    return _view(name, {"value": "number"}, "number", f"Number({found})", doc)


def _bits(
    name: str,
    record: Mapping[str, str],
    field: Field,
    item: BitField,
    value: Code,
    enum: str | None,
) -> Declaration:
    found = f"{call('rt.bits', value, item.low, item.high)}"
    if item.gaps:
        found = f"{found} & {item.mask >> item.low}"
    result = "number" if enum is None else f"{enum} | (number & {{}})"
    if field.may_be_absent:
        result, found = f"{result} | null", f"{value} === null ? null : {found}"
    return _view(name, record, result, found, f"{_summary(item)}; {item.words} of {field.name}.")


def _summary(item: Field | BitField) -> str:
    """The first paragraph of a doc, or the name in words; without a full stop."""
    return next(iter(paragraphs(item.about.doc)), descriptions.words(item.name)).rstrip(".")
