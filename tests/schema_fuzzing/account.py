"""Account of what the language offers, by its JSON Schema, and of what a schema uses of it.

Each key is an entry, and so is each alternative form of its value and each word that may stand
there. So a new key, a new form or a new word of one is an entry, without being listed here.
"""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Iterator, Mapping
from functools import cache
from typing import Any

from protogen.schema.json_schema import json_schema

JsonSchema = Mapping[str, Any]

ROOT = "ProtocolSyntax"
_OF_A_CATALOGUE = frozenset({"Algorithms", "AlgorithmsInOtherCase"})
"""Definitions of which one word stands for all."""
_PREFIX = "#/definitions/"
_TYPES: Mapping[str, tuple[type, ...]] = {
    "object": (dict,),
    "array": (list,),
    "string": (str,),
    "integer": (int,),
    "number": (int, float),
    "boolean": (bool,),
}
_WORDS = {"object": "mapping", "array": "list", "string": "text"}


_DRAWN_ELSEWHERE: Mapping[str, str] = {
    "ProtocolSyntax.extends": "tests/test_extends.py draws dialects, which are merged as data",
    "MessageSyntax.examples": "made of what a codec encodes, see `examples.py`",
    "Example.": "as examples are",
    "Contradiction.": "as examples are",
    "Step.example": "as examples are",
    "ProtocolSyntax.content_covers": "as examples are",
    "ReservedIdentity.id: ": "read as the `id` of a message is, of which all forms are drawn",
}
"""Beginnings of entries that no drawn schema uses, each with the reason."""


class Account:
    """What schemas that were drawn use of the language."""

    def __init__(self) -> None:
        self.counted = Counter[str]()
        self._beside: dict[str, set[str]] = {}
        self._offered = offered()
        unknown = [start for start in _DRAWN_ELSEWHERE if not self._known(start)]
        assert not unknown, "no entry begins so"

    def _known(self, start: str) -> bool:
        return any(entry.startswith(start) for entry in self._offered)

    def add(self, data: Mapping[str, Any]) -> None:
        """Add what one schema uses."""
        found = used(data)
        assert found <= self._offered
        self.counted.update(found)
        keys = {entry for entry in found if ":" not in entry and "=" not in entry}
        for key in keys:
            self._beside.setdefault(key, set()).update(keys)

    @property
    def missing(self) -> list[str]:
        """What the language offers and nothing uses, but for what is drawn elsewhere."""
        return sorted(
            entry
            for entry in self._offered - self.counted.keys()
            if not entry.startswith(tuple(_DRAWN_ELSEWHERE))
        )

    def lonely(self, share: float) -> list[str]:
        """Keys that were used beside less than such a share of all."""
        least = share * len(self._beside)
        return sorted(key for key, beside in self._beside.items() if len(beside) < least)


def offered() -> frozenset[str]:
    """All that a schema without `extends` can use."""
    found: set[str] = set()
    seen: set[str] = set()
    waiting = {ROOT}
    while waiting:
        name = waiting.pop()
        seen.add(name)
        for key, value in _definition(name).get("properties", {}).items():
            entries = dict(_offered_by(value, f"{name}.{key}"))
            found.update(entries)
            waiting.update(set(entries.values()) - seen - {""})
    return frozenset(found)


def used(data: Mapping[str, Any]) -> frozenset[str]:
    """What a schema uses."""
    return frozenset(_used_of({"$ref": _PREFIX + ROOT}, data, ""))


@cache
def _definitions() -> Mapping[str, JsonSchema]:
    definitions: Mapping[str, JsonSchema] = json_schema()["definitions"]
    return definitions


def _definition(name: str) -> JsonSchema:
    return _definitions()[name]


def _name(schema: JsonSchema) -> str:
    reference: str = schema.get("$ref", "")
    return reference.removeprefix(_PREFIX)


def _is_mapping_of_keys(name: str) -> bool:
    return bool(name) and "properties" in _definition(name)


# --- what there is ------------------------------------------------------------------------------


def _offered_by(schema: JsonSchema, place: str) -> Iterator[tuple[str, str]]:
    """Entries of a place, each with the definition that it leads to."""
    name = _name(schema)
    if _is_mapping_of_keys(name):
        yield place, name
        return
    if name:
        schema = _definition(name)
    yield place, ""
    for word in [] if name in _OF_A_CATALOGUE else _words(schema):
        yield f"{place} = {word}", ""
    at = _place_of_choices(schema, place)
    for label, choice in _choices(schema):
        yield from _offered_by(choice, f"{at}{label}")
    for inner in _inner(schema):
        yield from _offered_by(inner, place)


def _words(schema: JsonSchema) -> Iterator[str]:
    """Words that may stand here; of types with a number of bits, one for all."""
    found = [re.sub(r"int\d+$", "int", str(word)) for word in schema.get("enum", ())]
    yield from dict.fromkeys(found)
    if schema.get("type") == "boolean" and "const" not in schema:
        yield "True"


def _choices(schema: JsonSchema) -> Iterator[tuple[str, JsonSchema]]:
    choices = schema.get("anyOf", ())
    if any(choice.get("type") == "number" for choice in choices):
        # A text, which YAML may take for a number.
        choices = [choice for choice in choices if choice.get("type") not in ("number", "integer")]
    for choice in choices:
        yield f": {_label(choice)}" if len(choices) > 1 else "", choice


def _place_of_choices(schema: JsonSchema, place: str) -> str:
    """The place itself; of sources one for all, as they stand everywhere."""
    names = map(_name, schema.get("anyOf", ()))
    return "source" if "Source" in names else place


def _label(schema: JsonSchema) -> str:
    if "$ref" in schema:
        return _name(schema)
    type_ = schema["type"]
    if type_ == "object" and ("$ref" in (inner := next(_inner(schema))) or "anyOf" not in inner):
        return f"mapping of {_label(inner)}"
    return _WORDS.get(type_, type_)


def _inner(schema: JsonSchema) -> Iterator[JsonSchema]:
    """What stands inside a list, or under the names of a mapping."""
    inner = [*schema.get("patternProperties", {}).values(), schema.get("additionalProperties")]
    yield from (item for item in [*inner, schema.get("items")] if isinstance(item, dict))


# --- what is used -------------------------------------------------------------------------------


def _used_of(schema: JsonSchema, data: Any, place: str) -> Iterator[str]:
    name = _name(schema)
    if name:
        schema = _definition(name)
    if place:
        yield place
    if _is_mapping_of_keys(name):
        for key, value in data.items():
            yield from _used_of(schema["properties"][key], value, f"{name}.{key}")
        return
    text = re.sub(r"int\d+$", "int", str(data))
    if name not in _OF_A_CATALOGUE and text in _words(schema):
        yield f"{place} = {text}"
    at = _place_of_choices(schema, place)
    for label, choice in _choices(schema):
        if _fits(choice, data):
            yield from _used_of(choice, data, f"{at}{label}")
    for inner in _inner(schema):
        for item in data.values() if isinstance(data, dict) else data:
            yield from _used_of(inner, item, place)


def _fits(schema: JsonSchema, data: Any) -> bool:
    """True if a value has this form, as far as that tells it from the other forms of its place."""
    if "$ref" in schema:
        schema = _definition(_name(schema))
    if "anyOf" in schema:
        return any(_fits(choice, data) for choice in schema["anyOf"])
    if "enum" in schema and data not in schema["enum"]:
        return False
    type_ = schema.get("type")
    if type_ is not None and not isinstance(data, _TYPES[type_]):
        return False
    if isinstance(data, bool) and type_ != "boolean":
        return False
    if isinstance(data, str):
        return bool(re.search(schema.get("pattern", ""), data))
    if isinstance(data, list):
        return all(_fits(inner, item) for inner in _inner(schema) for item in data)
    return not isinstance(data, dict) or _holds(schema, data)


def _holds(schema: JsonSchema, data: Mapping[Any, Any]) -> bool:
    known = schema.get("properties", {})
    others = list(_inner(schema))
    if not set(schema.get("required", ())) <= data.keys():
        return False
    return all(
        _fits(known[key], value) if key in known else any(_fits(it, value) for it in others)
        for key, value in data.items()
    )
