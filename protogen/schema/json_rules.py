"""Rules of the JSON Schema about keys that stand beside each other.

The passes ask the same, with a message of their own. Here are those that an editor can see within
one mapping, so that it underlines the mistake while it is typed. None of them holds in a schema
with `extends`, where a mapping states only what differs.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import Any

from protogen.schema.syntax.base import INTEGER_PATTERN
from protogen.schema.syntax.fields import OF_PAYLOADS

JsonObject = dict[str, Any]

_BUILT_IN_PATTERN = (
    f"^({INTEGER_PATTERN}|byte|char|bool|float32|float64|decimal|hexadecimal|ascii|bytes)$"
)
"""Names of types where none are declared."""

_NO_TEXT = f"^({INTEGER_PATTERN}|byte|char|bool|float32|float64|decimal|hexadecimal|bytes)$"
"""Names of types that have no padding."""

_FORMS = ("fields", "switch")
_NUMERIC = ("scale", "offset", "unit", "special", "range")
_NAMED = ("values", "flags", "bits")
_LENGTHS = ("size", "until")
_LAST_ELEMENT: JsonObject = {"type": "object", "required": ["element"]}
"""What ends an array, and no text."""
_FIXED_COUNT: JsonObject = {"type": "integer", "minimum": 1}
_MAPPING: JsonObject = {"type": "object"}
_WRITTEN = ("digits", "code", "chars")
_MIRRORS = ("repeats", "complements")
_PART_ROLES = (
    "literal",
    "bits",
    *_MIRRORS,
    "id",
    "virtual",
    "told",
    "counts",
    "counter",
    "algorithm",
    "idle",
)


def _with(*keys: str) -> JsonObject:
    return {"required": list(keys)}


def _any_of(keys: Iterable[str]) -> JsonObject:
    return {"anyOf": [_with(key) for key in keys]}


def _none_of(keys: Iterable[str]) -> JsonObject:
    return {"not": _any_of(keys)}


def _one_of(words: str, keys: Iterable[str]) -> JsonObject:
    return {"$comment": words, "oneOf": [_with(key) for key in keys]}


def _at_most_one_of(words: str, keys: Iterable[str]) -> JsonObject:
    alone = [_with(key) for key in keys]
    return {"$comment": words, "oneOf": [*alone, _none_of(keys)]}


def _without(role: str) -> list[str]:
    return [key for key in _PART_ROLES if key != role]


def _where(condition: JsonObject, words: str, rule: JsonObject) -> JsonObject:
    return {"$comment": words, "if": condition, "then": rule}


def _together(words: str, needed: Mapping[str, list[str]]) -> JsonObject:
    """Rule that a key stands only beside others."""
    return {"$comment": words, "dependencies": dict(needed)}


def _type_like(pattern: str) -> JsonObject:
    """Condition that the field names a built-in type of this pattern."""
    return {"required": ["type"], "properties": {"type": {"pattern": f"^({pattern})$"}}}


def _bounded(type_: str, least: int, greatest: int) -> JsonObject:
    """Rule that the numbers of a field are values of its type."""
    bounds = {"minimum": least, "maximum": greatest}
    keys = dict.fromkeys(("const", "default"), bounds)
    lists = {"range": {"items": bounds}}
    names = dict.fromkeys(("values", "special"), _each(bounds))
    text = f"A {type_} holds {least} to {greatest}."
    return _where(_type_like(type_), text, {"properties": {**keys, **lists, **names}})


def _integers_bounded() -> Iterable[JsonObject]:
    for bits in (8, 16, 32):
        yield _bounded(f"uint{bits}", 0, 2**bits - 1)
        yield _bounded(f"sint{bits}", -(2 ** (bits - 1)), 2 ** (bits - 1) - 1)
        flags = {"flags": _each({"maximum": bits - 1})}
        text = f"The bits of a uint{bits} are 0 to {bits - 1}."
        yield _where(_type_like(f"uint{bits}"), text, {"properties": flags})


def _each(inner: JsonObject) -> JsonObject:
    return {"additionalProperties": inner}


_ONE_KIND_OF_DIGITS: JsonObject = {
    "$comment": "An integer is written as digits, or as characters of a code.",
    "not": _with("digits", "code"),
}

_FIELD_RULES = (
    _one_of("A field has a type, or is a struct of fields, or a switch.", ("type", *_FORMS)),
    _where(
        _with("part"),
        "A field that is a part of the frame has no bytes in the payload.",
        {**_with("type"), **_none_of((*_FORMS, *OF_PAYLOADS))},
    ),
    _together("A switch has cases.", {"cases": ["switch"], "switch": ["cases"]}),
    _at_most_one_of("An integer has only one of these.", _NAMED),
    _where(
        _any_of(_FORMS),
        "These are for numbers.",
        _none_of((*_NUMERIC, *_NAMED, *_WRITTEN, "padding", "const", "default", "closed")),
    ),
    _where(
        _with("fields"),
        "An array of structs is ended by what an element says.",
        {"properties": {"until": _LAST_ELEMENT}},
    ),
    _where(_with("switch"), "Nothing ends a switch but its cases.", _none_of(("until",))),
    {"$comment": "Elements are counted, or the last one says so.", "not": _with("count", "until")},
    _where(
        _with("count", "size"),
        "As many elements as the bytes hold.",
        {"properties": {"count": {"not": {"type": "integer"}}}},
    ),
    _where(
        _type_like("ascii|bytes"),
        "These are for numbers; the length is the `size`.",
        _none_of((*_NUMERIC, *_NAMED, "count", "closed", "packed")),
    ),
    _where(
        _type_like("ascii|bytes"),
        "What an element says ends an array of structs.",
        {"properties": {"until": {"not": _LAST_ELEMENT}}},
    ),
    _where(
        _with("without"),
        "A text between separators can be without some characters.",
        {"properties": {"type": {"not": {"enum": ["bytes", "char", "decimal", "hexadecimal"]}}}},
    ),
    _where(_any_of(_FORMS), "Only a text is without some characters.", _none_of(("without",))),
    {"$comment": "A size is told, or a terminator ends it.", "not": _with(*_LENGTHS)},
    {
        "$comment": "The size of what is always the same never changes.",
        "not": _with("until", "const"),
    },
    _where(_type_like("bool"), "A bool is no number.", _none_of((*_NUMERIC, *_NAMED, "closed"))),
    _where(
        _type_like("float32|float64"),
        "These are for integers.",
        _none_of((*_NAMED, "closed", "packed")),
    ),
    _where(
        _type_like("byte|char|bool|float32|float64|bytes"),
        "Only integers have digits.",
        _none_of(_WRITTEN),
    ),
    _where(_type_like("ascii"), "Only integers have digits.", _none_of(("digits", "chars"))),
    _where(
        _with("padding"),
        "Only a text of a fixed size has padding.",
        {"properties": {"type": {"not": {"pattern": _NO_TEXT}}, "size": {"type": "integer"}}},
    ),
    _where(
        {**_type_like("ascii"), "required": ["type", "code"]},
        "Only a text of a fixed size has a code.",
        {"properties": {"size": {"type": "integer"}}},
    ),
    _where(
        {**_type_like(INTEGER_PATTERN), "required": ["type", "code"]},
        "The characters of an integer are not shifted.",
        {"properties": {"code": {"properties": {"shift": {"const": 0}}}}},
    ),
    _ONE_KIND_OF_DIGITS,
    _where(
        {"required": ["optional"], "properties": {"optional": {"const": True}}},
        "The end of the payload says whether it is there, and nothing else does.",
        _none_of(("when", "const", "default")),
    ),
    _where(_with("switch"), "A switch has nothing to pack.", _none_of(("packed",))),
    _where(
        {**_type_like(f"{INTEGER_PATTERN}|byte|char|bool"), "required": ["type", "packed"]},
        "A single integer has nothing to follow; several are counted.",
        _with("count"),
    ),
    _where(
        {"required": ["packed", "count"], "properties": {"fields": False}},
        "The number of packed integers is always the same, or they fill what is left.",
        {"properties": {"count": {"anyOf": [_FIXED_COUNT, {"const": "fill"}, _MAPPING]}}},
    ),
    _where(
        {**_type_like("[us]int[1-7]|bool"), "required": ["type", "packed", "count"]},
        "Bytes do not tell the number of integers of fewer than 8 bits.",
        {"properties": {"count": _FIXED_COUNT}},
    ),
    _where(
        _type_like("sint[0-9]+"),
        "These name bits of an unsigned integer.",
        _none_of(("flags", "bits")),
    ),
    _where(
        _type_like(f"{INTEGER_PATTERN}|byte|char|bool|float32|float64"),
        "Only ascii and bytes are ended by a terminator.",
        _none_of(("until",)),
    ),
    _where(
        _type_like(f"{INTEGER_PATTERN}|byte|char"),
        "A range is one of raw values, which are integers.",
        {"properties": {"range": {"items": {"type": ["integer", "string"]}}}},
    ),
    {"$comment": "Zero leaves nothing.", "properties": {"scale": {"not": {"const": 0}}}},
    *_integers_bounded(),
)

_PART_RULES = (
    _at_most_one_of("A part does one of these.", _without("told")),
    _at_most_one_of("A part does one of these, and a length may be told.", _without("counts")),
    _where(_any_of(_PART_ROLES[1:-1]), "A part that is a number has a type.", _with("type")),
    _where(
        _with("idle"),
        "A silence is all that its part is.",
        {"propertyNames": {"enum": ["idle", "doc", "source"]}},
    ),
    _where(
        _with("literal"),
        "A literal is all that its part is.",
        {"propertyNames": {"enum": ["literal", "unprotected", "type", "doc", "source"]}},
    ),
    _where(
        _any_of(("trailing_zeros", "longer")),
        "Only the payload is trimmed, or cut.",
        {"propertyNames": {"enum": ["trailing_zeros", "longer", "unprotected", "doc", "source"]}},
    ),
    _where(
        _with("literal", "type"),
        "Only a choice of literals can be a text.",
        {"properties": {"literal": {"type": "object"}, "type": {"const": "ascii"}}},
    ),
    _where(_type_like("byte|char|ascii"), "Only integers have digits.", _none_of(_WRITTEN)),
    _ONE_KIND_OF_DIGITS,
    _where(_with("size"), "Only a text has a size.", {"properties": {"type": {"const": "ascii"}}}),
    _where(_with("algorithm"), "A checksum says what it covers.", _with("covers")),
    _where(
        _with("algorithm"),
        "A checksum's value follows from what it covers.",
        _none_of(("range", "default")),
    ),
    _where(
        _with("bits"),
        "Bits of a number are parts, and it is none itself.",
        {"propertyNames": {"enum": ["type", "bits", "byte_order", "unprotected", "doc", "source"]}},
    ),
    _where(
        _any_of(_MIRRORS),
        "What follows from another number has nothing of its own.",
        {"propertyNames": {"enum": [*_MIRRORS, "type", "byte_order", "doc", "source"]}},
    ),
    _where(
        _any_of(("virtual", "told")),
        "No delimiter can be mistaken for what is not sent.",
        _none_of(("unprotected",)),
    ),
    _where(
        {**_any_of(("virtual", "told")), **_none_of(("counts",))},
        "What is not sent has no bounds, but for lengths.",
        _none_of(("range",)),
    ),
    _where(_with("told", "counts"), "What is told is not stuffed.", _none_of(("over",))),
    _where(_with("told"), "What is told has no bytes, and so no order.", _none_of(("byte_order",))),
    *(_bounded(f"uint{bits}", 0, 2**bits - 1) for bits in (8, 16, 32)),
    _where(_with("over"), "This is for a checksum or a length.", _any_of(("algorithm", "counts"))),
    _together("These are for a part that is told.", {key: ["told"] for key in ("set_by", "once")}),
    _together("These are for a checksum.", {key: ["algorithm"] for key in ("covers", "when")}),
)

_OF_SUMS = ("algorithm", "covers", "takes")
"""Keys of bits that are a checksum."""
_OF_MEMBERS = ("id", "counts", "counter", "range", "default")
"""Keys of bits that are a part of their own."""

_PART_BITS_RULES = (
    _where(
        _with("const"),
        "Bits that are the same in each frame are no part.",
        _none_of((*_MIRRORS, *_OF_SUMS, *_OF_MEMBERS)),
    ),
    _at_most_one_of("Bits follow from one number.", _MIRRORS),
    _where(
        _any_of(_MIRRORS),
        "Bits that follow from another number are no part.",
        _none_of((*_OF_SUMS, *_OF_MEMBERS)),
    ),
    _where(
        _with("algorithm"),
        "A checksum's value follows from what it covers.",
        _none_of(_OF_MEMBERS),
    ),
    _where(_with("algorithm"), "A checksum says what it covers.", _with("covers")),
    _together("These are for a checksum.", {key: ["algorithm"] for key in ("covers", "takes")}),
    _at_most_one_of("Bits have one purpose.", ("id", "counts", "counter")),
    _where(
        _any_of(("id", "counts")),
        "What tells the message, or its length, is not chosen.",
        _none_of(("default",)),
    ),
)

_MESSAGE_RULES = (
    _where(
        _any_of(("min_size", "max_size")),
        "The size is stated where the fields are unspecified.",
        {"required": ["fields"], "properties": {"fields": {"const": "unspecified"}}},
    ),
)

_EXAMPLE_RULES = (
    _one_of("An example has either all bytes or the content.", ("frame", "content")),
    _together("The parts are those of the content.", {"covers": ["content"]}),
)

_OVERLOAD_RULES = (
    _where(
        {"properties": {"by": {"const": "undecidable"}}},
        "Where nothing tells them apart, a decoder yields one of them.",
        _with("yields"),
    ),
    _where({"properties": {"by": {"const": "size"}}}, "Nothing is chosen.", _none_of(("yields",))),
)

_EXCHANGE_RULES = (
    _one_of("An exchange is a sequence or a request.", ("steps", "request")),
    _together(
        "These are for a request, which has a reply.",
        {
            "request": ["reply"],
            **{key: ["request"] for key in ("reply", "refusal", "match", "timeout", "retries")},
        },
    ),
    _together(
        "Without `match`, no refusal is matched.", {"unmatched_refusal": ["refusal", "match"]}
    ),
)

_TRANSPARENCY_RULES = (
    _one_of("A transparency is one of these.", ("substitute", "escape", "encoding", "preset")),
)


_BUILT_IN = "#/definitions/BuiltInField"
_BUILT_IN_FIELDS = _each({"$ref": _BUILT_IN})

_ROOT_RULES = (
    _one_of("A protocol has a kind of frame, or several forms.", ("frame", "forms")),
    _together("With forms, each has a transparency of its own.", {"transparency": ["frame"]}),
    _where(
        _with("types"),
        "A type of one's own is not called as a built-in one.",
        {"properties": {"types": {"propertyNames": {"not": {"pattern": _BUILT_IN_PATTERN}}}}},
    ),
    {
        "$comment": "A protocol has messages, and somebody who sends them.",
        "properties": {key: {"minProperties": 1} for key in ("messages", "endpoints")},
    },
    _where(
        _none_of(("types",)),
        "Where no types are declared, a field has a built-in one.",
        {"properties": {"messages": _each({"properties": {"fields": _BUILT_IN_FIELDS}})}},
    ),
)

RULES: Mapping[str, tuple[JsonObject, ...]] = {
    "FieldSyntax": _FIELD_RULES,
    "Part": _PART_RULES,
    "PartBits": _PART_BITS_RULES,
    "MessageSyntax": _MESSAGE_RULES,
    "Example": _EXAMPLE_RULES,
    "Overload": _OVERLOAD_RULES,
    "Exchange": _EXCHANGE_RULES,
    "TransparencySyntax": _TRANSPARENCY_RULES,
    "ProtocolSyntax": _ROOT_RULES,
}
"""Rules of the definitions, by the names of their classes."""

BUILT_IN_FIELD: JsonObject = {
    "title": "Field of a built-in type",
    "description": "A field where no types are declared.",
    "if": {"type": "string"},
    "then": {"pattern": _BUILT_IN_PATTERN, "not": {"enum": ["ascii", "bytes"]}},
    "else": {
        "properties": {
            "type": {"pattern": _BUILT_IN_PATTERN},
            "fields": _BUILT_IN_FIELDS,
            "cases": _BUILT_IN_FIELDS,
        },
        **_where(_type_like("ascii|bytes"), "It has a `size` or a terminator.", _any_of(_LENGTHS)),
    },
}
"""A field that names no declared type, and whose text has its size beside it."""
