"""Enums, flags, runs of bits, and the macros that say what raw values mean."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from fractions import Fraction
from functools import lru_cache

import msgspec

from protogen.c_language.numbers import constant, hexadecimal, number, unsigned, unsigned_type
from protogen.model.meanings import BitField, Enum, Flags, NamedBit, NamedValue
from protogen.model.origin import About
from protogen.model.types import Field, Float
from protogen.targets import descriptions, naming
from protogen.targets.c import comments
from protogen.targets.c.lines import INDENT
from protogen.targets.c.spelling import Names
from protogen.targets.escape import one_line, paragraphs
from protogen.targets.naming import Thing, inside, named_type

_LEAST_INT, _GREATEST_INT = -0x8000, 0x7FFF
_SIGNIFICANT = 63
"""Characters by which C tells names apart: two bounds differ in their last word alone."""


class Macro(msgspec.Struct, frozen=True):
    """A name for a constant."""

    name: str
    value: str
    doc: tuple[str, ...] = ()


class EnumView(msgspec.Struct, frozen=True):
    """Names of values: an enum where each of them fits an `int` of 16 bits, else macros."""

    tag: str
    doc: tuple[str, ...]
    values: tuple[Macro, ...]
    macros: bool
    number: str = ""
    """A type that holds every value; of an enum alone."""
    name_of: str = ""
    """The function that says the name of a value; of an enum alone."""
    names: tuple[tuple[str, str], ...] = ()
    """The values, and their names in the schema as literals."""


def enum_view(item: Enum, names: Names) -> EnumView:
    """An enum."""
    fits = all(_LEAST_INT <= entry.value <= _GREATEST_INT for entry in item.values)
    unsigned_ones = all(entry.value >= 0 for entry in item.values)
    write = unsigned if unsigned_ones and not fits else number
    values = tuple(_named(item, entry, write(entry.value), names, INDENT) for entry in item.values)
    tag = names.claim_tag(named_type(item.name), item.name)
    spelled = [string(entry.name) for entry in item.values]
    return EnumView(
        tag,
        _doc_of(item),
        values,
        not fits,
        _number_type([entry.value for entry in item.values]),
        names.claim(named_type(item.name), item.name, "name"),
        tuple(zip([value.name for value in values], spelled, strict=True)),
    )


def _number_type(values: Sequence[int]) -> str:
    """The narrowest type of numbers that holds these values."""
    least, greatest = min(values, default=0), max(values, default=0)
    bits = max(greatest.bit_length(), (-least - 1).bit_length()) + 1
    return unsigned_type(max(bits - 1, 1)) if least >= 0 else unsigned_type(bits)[1:]


def flags_view(item: Flags, names: Names) -> EnumView:
    """A set of flags."""
    values = tuple(_named(item, entry, hexadecimal(1 << entry.bit), names) for entry in item.bits)
    return EnumView(item.name, _doc_of(item), values, True)


def _named(
    item: Enum | Flags, entry: NamedValue | NamedBit, value: str, names: Names, indent: int = 0
) -> Macro:
    of = naming.value if isinstance(item, Enum) else naming.flag
    name = names.claim_macro(of(item.name, entry.name), item.name, entry.name)
    return Macro(name, value, _remark(entry.about, indent))


def _doc_of(item: Enum | Flags) -> tuple[str, ...]:
    return comments.comment(descriptions.of_named(item.name, item.about))


def _remark(item: About, indent: int = 0) -> tuple[str, ...]:
    """Comment of a name; nothing where it has no doc."""
    texts = list(paragraphs(item.doc))
    return comments.comment([descriptions.sentence(texts[0]), *texts[1:]], indent) if texts else ()


class BitsView(msgspec.Struct, frozen=True):
    """A run of bits, and the functions that read and write it."""

    doc: tuple[str, ...]
    mask: Macro
    shift: Macro
    type: str
    get: str
    set: str


def bits_views(record: str, field: Field, names: Names) -> tuple[BitsView, ...]:
    """The runs of bits of a field's integer."""
    integer = field.integer
    if integer is None or not integer.bit_fields:
        return ()
    kind = unsigned_type(integer.bits)
    return tuple(_bits(record, field, kind, item, names) for item in integer.bit_fields)


def _bits(record: str, field: Field, kind: str, item: BitField, names: Names) -> BitsView:
    words = (record, field.name, item.name)
    thing = inside(record, "run of bits", field.name, "bits", item.name)
    first = next(iter(paragraphs(item.about.doc)), descriptions.words(item.name))
    named = f", {names.values_of(item.enum.name)}" if item.enum else ""
    return BitsView(
        comments.comment([f"{first.rstrip('.')}{named}; {item.words} of {field.name}."]),
        Macro(names.claim_macro(thing, *words, "mask"), hexadecimal(item.mask)),
        Macro(names.claim_macro(thing, *words, "shift"), f"{item.low}U"),
        kind,
        names.claim(thing, *words, "get"),
        names.claim(thing, *words, "set"),
    )


# --- what raw values mean -------------------------------------------------------------------------


def meaning(record: str, fields: Sequence[Field], names: Names) -> tuple[Macro, ...]:
    """The macros of a record's fields."""
    return tuple(macro for field in fields for macro in _meaning(record, field, names))


def claim_fields(names: Names, record: str, fields: Sequence[Field]) -> None:
    """The names that come of a record's fields: macros, and functions of runs of bits."""
    meaning(record, fields, names)
    for field in fields:
        bits_views(record, field, names)


def _meaning(record: str, field: Field, names: Names) -> Iterable[Macro]:
    own = inside(record, "field", field.name)

    def macro(word: str, value: str, doc: tuple[str, ...] = (), thing: Thing = own) -> Macro:
        return Macro(names.claim_macro(thing, record, field.name, word), _operand(value), doc)

    if field.scaled and field.scale != 1:
        yield from _fraction(macro, "scale", field.scale)
    if field.scaled and field.offset != 0:
        yield from _fraction(macro, "offset", field.offset)
    if field.unit:
        yield macro("unit", string(field.unit))
    integer = field.integer
    if integer is not None:
        for word, bound in _bounds(field, f"{names.prefix}_{record}_{field.name}_"):
            yield macro(word, constant(bound, integer))
        for item in field.special:
            thing = inside(record, "special value", field.name, "special", item.name)
            value = constant(item.value, integer)
            yield macro(item.name, value, _remark(item.about), thing)
        if isinstance(field.default, int):
            yield macro("default", constant(int(field.default), integer))
    elif isinstance(field.element, Float) and isinstance(field.default, int | float):
        suffix = "f" if field.element.bits == 32 else ""
        yield macro("default", repr(float(field.default)) + suffix)


def _bounds(field: Field, start: str) -> Iterable[tuple[str, int]]:
    """The least and the greatest raw value that the schema states, as words behind `start`."""
    if field.ranged and len(start) + len("min") <= _SIGNIFICANT:
        special = {item.name for item in field.special}
        for word, bound in (("min", field.least), ("max", field.greatest)):
            if bound is not None and word not in special:
                yield word, int(bound)


def _operand(text: str) -> str:
    """A number that may stand behind any operator."""
    return f"({text})" if text.startswith("-") else text


def _fraction(macro: object, word: str, value: Fraction) -> Iterable[Macro]:
    assert callable(macro)
    yield macro(f"{word}_num", number(value.numerator))
    yield macro(f"{word}_den", number(value.denominator))


@lru_cache(maxsize=1024)
def string(text: str) -> str:
    """A string literal; what is not ASCII is written as the bytes of UTF-8, in octal digits.

    A protocol has few of them, such as units, for many fields.
    """
    return '"' + "".join(_character(byte) for byte in one_line(text).encode("utf-8")) + '"'


def _character(byte: int) -> str:
    character = chr(byte)
    if character in '"\\?' or not 0x20 <= byte < 0x7F:
        return f"\\{byte:03o}"
    return character
