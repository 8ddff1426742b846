"""Enums, structs and messages as the template prints them."""

from __future__ import annotations

import re
from collections.abc import Container, Iterable
from functools import lru_cache

import msgspec

from protogen.model.computed import Computed, computed
from protogen.model.identities import Identities
from protogen.model.meanings import BitField, Enum, Flags
from protogen.model.messages import Message
from protogen.model.sizes import SizeSet
from protogen.model.types import Array, Field, Float, Integer, Octets, Struct, Switch, Text, Type
from protogen.runtime.attributes import attribute
from protogen.targets.escape import paragraphs, python_comment
from protogen.targets.module_names import RecordNames
from protogen.targets.python import describing
from protogen.targets.python import frames as tables
from protogen.targets.python.formats import constant, field_format, is_empty
from protogen.targets.python.literals import (
    bracketed,
    call,
    mapping,
    octets_in_class,
    text,
    tuple_of,
)
from protogen.targets.python.names import Names
from protogen.targets.python.rules import field_rule
from protogen.targets.python.spelling import member_name
from protogen.targets.python.wrapping import (
    WIDTH,
    docstring,
    method,
    one_of,
    remark,
    union,
    wrapped,
)

_INDENT = 4


class Member(msgspec.Struct, frozen=True):
    """A named value."""

    name: str
    value: str
    comment: str


class EnumClass(msgspec.Struct, frozen=True):
    """An enum or a set of flags."""

    name: str
    base: str
    doc: str
    members: tuple[Member, ...]


class Attribute(msgspec.Struct, frozen=True):
    """A field of a class, or a property that shows one."""

    text: str
    doc: str


class Constructor(msgspec.Struct, frozen=True):
    """The slots of a class and its `__init__`, whose head ends with the colon."""

    slots: str
    head: str
    body: tuple[str, ...]


class RecordClass(msgspec.Struct, frozen=True):
    """A struct or a message."""

    name: str
    base: str
    doc: str
    attributes: tuple[Attribute, ...]
    constants: tuple[str, ...]
    """Lines that only messages have: name, senders, identity and sizes."""
    format: tuple[str, ...]
    packed: str
    """Order of the bits, where the fields are packed."""
    rules: str
    views: tuple[Attribute, ...]
    made: Constructor


def enum_class(item: Enum, names: Names) -> EnumClass:
    """An enum."""
    members = tuple(
        Member(member_name(entry.name), str(entry.value), _comment(entry.about.doc))
        for entry in item.values
    )
    doc = docstring(describing.named(item.name, item.about), _INDENT)
    return EnumClass(names.types[item.name], "_rt.OpenEnum", doc, members)


def flags_class(item: Flags, names: Names) -> EnumClass:
    """A set of flags."""
    members = tuple(
        Member(member_name(entry.name), f"0x{1 << entry.bit:02X}", _comment(entry.about.doc))
        for entry in item.bits
    )
    doc = docstring(describing.named(item.name, item.about), _INDENT)
    return EnumClass(names.types[item.name], "_rt.Flags", doc, members)


def _comment(doc: str) -> str:
    first = next(iter(paragraphs(doc)), "")
    return python_comment(first) if len(first) <= 60 else ""


def struct_class(item: Struct, names: Names) -> RecordClass:
    """A struct."""
    doc = docstring(describing.named(item.name, item.about), _INDENT)
    packed = text(item.packed) if item.packed else ""
    return _record(item, "_rt.Record", doc, (), names, packed)


def message_class(item: Message, identity: str, names: Names, *, is_cut: bool) -> RecordClass:
    """A message; `identity` says in words what its identity is.

    It is cut where some frames of it have payloads that may be longer than known.
    """
    values = tuple_of(f"0x{value:02X}" for value in item.identity)
    several = () if item.identities is None else (f"IDENTITIES = {_identities(item.identities)}",)
    is_told = item.cut_size is None or item.sizes.fixed is not None
    cut = () if is_told else (f"CUT_SIZE = {item.cut_size}",)
    constants = (
        f"NAME = {text(item.name)}",
        f"SPEC_HASH = {text(item.spec_hash)}",
        f"SENDERS = {tuple_of(map(text, item.senders))}",
        f"IDENTITY = {values}" + (f"  # {identity}" if identity else ""),
        *several,
        f"SIZES = {_sizes(item.sizes)}",
        *cut,
        *(("TELLS_ITS_END = True",) if is_cut and item.tells_its_end else ()),
        *((f"HELD = {_held(item)}",) if item.held else ()),
    )
    doc = docstring(describing.message(item), _INDENT)
    return _record(item, "_rt.Message", doc, constants, names)


def _held(item: Message) -> str:
    """The fields that are parts of the frame."""
    expression = mapping({text(field.name): text(field.part) for field in item.held})
    return wrapped(expression, _INDENT + len("HELD = "), _INDENT, after=0)


def _identities(identities: Identities) -> str:
    """All identities of a message that has several."""
    expression = tables.identities(identities)
    return wrapped(expression, _INDENT + len("IDENTITIES = "), _INDENT, after=0)


def _sizes(sizes: SizeSet) -> str:
    step = str(sizes.step) if sizes.step > 1 else None
    return call("_rt.Sizes", str(sizes.least), str(sizes.greatest), step=step)


class _Scope(msgspec.Struct, frozen=True):
    """Names that a class can use in its body."""

    module: Names
    own: RecordNames
    taken: frozenset[str]
    """Attributes of fields, which hide built-in types of the same names."""


def _record(
    item: Struct | Message,
    base: str,
    doc: str,
    constants: tuple[str, ...],
    names: Names,
    packed: str = "",
) -> RecordClass:
    own, fields, counts = names.records[item.name], item.fields, computed(item.fields)
    scope = _Scope(names, own, frozenset(own.fields.values()))
    return RecordClass(
        name=names.types[item.name],
        base=base,
        doc=doc,
        attributes=tuple(_attribute(field, scope, counts) for field in fields),
        constants=constants,
        format=tuple(_format_line(field, names, 4 if packed else 3) for field in fields),
        packed=packed,
        rules=_rules(fields, names),
        views=tuple(view for field in fields for view in _views(field, scope)),
        made=_constructor(fields, scope),
    )


def slots_of(names: Iterable[str]) -> str:
    """The line or lines that name a class's slots, numbers in names by their value."""
    ordered = sorted(names, key=_natural)
    return wrapped(tuple_of(map(text, ordered)), _INDENT + len("__slots__ = "), _INDENT, after=0)


@lru_cache(4096)
def _natural(name: str) -> list[tuple[int, str]]:
    """A key that sorts `servo2` before `servo10`."""
    return [(int(part), "") if part.isdigit() else (0, part) for part in re.split("([0-9]+)", name)]


def _constructor(fields: tuple[Field, ...], scope: _Scope) -> Constructor:
    """The constructor of a record, which takes keywords only."""
    parameters, body, counts = ["*"], [], computed(fields)
    for field in fields:
        name = value = scope.own.fields[field.name]
        kind, default = _field_annotation(field, scope), _default(field, scope.module)
        if isinstance(default, list) or field.name in counts:
            made = _counted(counts[field.name]) if field.name in counts else str(default)
            value = f"{made} if {name} is _rt.OMITTED else {name}"
            default = "_rt.OMITTED"
        parameters.append(f"{name}: {kind}" + (f" = {default}" if default else ""))
        body.append(f"self.{name} = {value}")
    body.sort(key=_is_made_later)
    head = method("def __init__(", ", ".join(["self", *parameters]), ") -> None:", _INDENT)
    return Constructor(slots_of(scope.own.fields.values()), head, tuple(body))


def _is_made_later(line: str) -> tuple[bool, bool]:
    """Order of assignments: what is counted has to be there first, and regions hold what counts."""
    return "_rt.region_size(" in line, "_rt.count_of(" in line


def _counted(item: Computed) -> str:
    """The number that tells how many elements or bytes a field has."""
    count, (_, factor, offset, size) = f"_rt.count_of(self.{attribute(item.field)})", item.line
    if item.is_region:
        count = f"_rt.region_size(self, {text(item.field)})"
    count = f"{count} * {size}" if size > 1 else count
    if factor < 0:
        count = f"{offset} - {count}"
    elif offset:
        count = f"{count} {_signed(-offset)}"
    return count if abs(factor) == 1 else f"{bracketed(count)} // {abs(factor)}"


def _signed(number: int) -> str:
    return f"- {-number}" if number < 0 else f"+ {number}"


def _format_line(field: Field, names: Names, depth: int) -> str:
    """One line of FORMAT; a long one is broken before the slash, as formatters do."""
    name, indent = text(field.name), depth * _INDENT
    expression = field_format(field, names)
    if indent + len(name) + 3 + len(expression) + 1 <= 100 or "(" not in expression:
        return f"{name} / {expression},"
    broken = wrapped(expression, indent + 2, indent)
    return f"{name}\n{' ' * indent}/ {broken},"


def _rules(fields: tuple[Field, ...], names: Names) -> str:
    """The rules of all fields; several stand below each other."""
    if not fields:
        return "()"
    indent = " " * _INDENT
    if len(fields) < 2:
        only = tuple_of(f"({text(field.name)}, {field_rule(field, names)})" for field in fields)
        whole = f"_rt.lazily(lambda: {only})"
        if _INDENT + len("RULES = ") + len(whole) <= WIDTH:
            return whole
        made = wrapped(only, 2 * _INDENT + len("lambda: "), 2 * _INDENT, after=0)
        return f"_rt.lazily(\n{2 * indent}lambda: {made}\n{indent})"
    lines = [3 * indent + _rule_line(field, names) for field in fields]
    head, end = f"_rt.lazily(\n{2 * indent}lambda: (", f"{2 * indent})\n{indent})"
    return "\n".join([head, *lines, end])


def _rule_line(field: Field, names: Names) -> str:
    expression = f"({text(field.name)}, {field_rule(field, names)})"
    return wrapped(expression, 3 * _INDENT, 3 * _INDENT) + ","


def _attribute(field: Field, scope: _Scope, counts: Container[str]) -> Attribute:
    name = scope.own.fields[field.name]
    line = union(f"{name}: ", _field_annotation(field, scope), _INDENT)
    about = describing.field(field, is_computed=field.name in counts)
    return Attribute(line, remark(about, _INDENT))


def _field_annotation(field: Field, scope: _Scope) -> str:
    """The type of a field's attribute, which is None where the field is not there."""
    kind = _annotation(field.type, scope)
    is_absent = field.may_be_absent and not kind.endswith("None")
    return f"{kind} | None" if is_absent else kind


def _annotation(type_: Type, scope: _Scope) -> str:
    """The type of a field's attribute. Named values may also be given as numbers.

    A built-in type whose name a field has taken is named by its module.
    """
    match type_:
        case Integer():
            return _integer_annotation(type_, scope)
        case Float():
            return _builtin("float", scope)
        case Text():
            return _builtin("str", scope)
        case Octets():
            return _builtin("bytes", scope)
        case Struct():
            return scope.module.types[type_.name]
        case Array():
            return f"{_builtin('list', scope)}[{_annotation(type_.element, scope)}]"
        case Switch():
            return _switch_annotation(type_, scope)


def _builtin(name: str, scope: _Scope) -> str:
    return f"_builtins.{name}" if name in scope.taken else name


def _integer_annotation(type_: Integer, scope: _Scope) -> str:
    if type_.role == "bool":
        return _builtin("bool", scope)
    named = type_.enum or type_.flags
    number = _builtin("int", scope)
    return f"{scope.module.types[named.name]} | {number}" if named else number


def _switch_annotation(type_: Switch, scope: _Scope) -> str:
    choices = [
        "None" if is_empty(case.type) else _annotation(case.type, scope) for case in type_.cases
    ]
    if type_.rest is not None:
        choices.append(_builtin("bytes", scope))
    distinct = dict.fromkeys(choices)
    ordered = [choice for choice in distinct if choice != "None"]
    return one_of([*ordered, *(["None"] if "None" in distinct else [])])


def _default(field: Field, names: Names) -> str | list[int | str] | None:
    """The default of an attribute, a list as such: a constant needs not be given."""
    if field.may_be_absent:
        return "None"
    value = field.const if field.const is not None else field.default
    match value:
        case None:
            return None
        case tuple():
            return list(value)
        case bytes():
            return octets_in_class(value)
        case str():
            return text(value)
        case int() if isinstance(field.type, Integer):
            return _named_default(field.type, value, names)
    return constant(field) if field.const is not None else repr(value)


def _named_default(type_: Integer, value: int, names: Names) -> str:
    if type_.role == "bool":
        return str(bool(value))
    if type_.enum:
        members = {entry.value: entry.name for entry in type_.enum.values}
        if value in members:
            return f"{names.types[type_.enum.name]}.{member_name(members[value])}"
    return str(value)


# --- properties -----------------------------------------------------------------------------------


def _views(field: Field, scope: _Scope) -> list[Attribute]:
    views = [_physical(field, scope.own)] if field.scaled else []
    return views + [_bits(field, item, scope) for item in field.bit_fields]


def _physical(field: Field, names: RecordNames) -> Attribute:
    name = names.reading(field)
    kind = "PhysicalList" if isinstance(field.type, Array) else "Physical"
    kind += "OrNone" if field.special else ""
    unit = f" in {field.unit}" if field.unit else ", scaled"
    what = next(iter(paragraphs(field.about.doc)), field.name.replace("_", " ").capitalize())
    none = "; None: no reading" if field.special else ""
    texts = describing.escaped([f"{what.rstrip('.')}{unit}{_physical_range(field)}{none}."])
    view = _if_there(field, call(f"_rt.{kind}", text(field.name)))
    return Attribute(f"{name} = {view}", remark(texts, _INDENT))


def _if_there(field: Field, view: str) -> str:
    return call("_rt.IfThere", view) if field.may_be_absent else view


def _physical_range(field: Field) -> str:
    """The range of the readings: no special value at its ends, as none of them is a reading."""
    if field.least is None or field.greatest is None:
        return ""
    special = {item.value for item in field.special}
    least, greatest = field.least, field.greatest
    while least in special and least <= greatest:
        least += 1
    while greatest in special and least <= greatest:
        greatest -= 1
    if least > greatest:
        return ""
    ends = sorted(float(end * field.scale + field.offset) for end in (least, greatest))
    return f", {ends[0]:.10g}..{ends[1]:.10g}"


def _bits(field: Field, item: BitField, scope: _Scope) -> Attribute:
    name = scope.own.run(field, item)
    bounds = (text(field.name), str(item.low), str(item.high))
    gaps = f"0x{item.gaps:X}" if item.gaps else None
    if item.enum:
        view = call("_rt.EnumRange", *bounds, scope.module.types[item.enum.name], gaps=gaps)
    else:
        view = call("_rt.BitRange", *bounds, gaps=gaps)
    what = next(iter(paragraphs(item.about.doc)), item.name.replace("_", " ").capitalize())
    texts = describing.escaped([f"{what.rstrip('.')}; {item.words} of {field.name}."])
    return Attribute(f"{name} = {_if_there(field, view)}", remark(texts, _INDENT))
