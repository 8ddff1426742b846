"""The order of keys: that in which the schema language documents them.

The JSON Schema knows it. Names of messages, fields, parts and so on keep their places: their order
has a meaning.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from functools import cache
from typing import Any

from protogen.layout.nodes import Alias, Collection, Item, Node, Scalar, walk
from protogen.schema.json_schema import json_schema

JsonObject = Mapping[str, Any]

_DIRECTIVES = ("rename", "remove", "replace", "after", "before")
"""They say how a dialect differs, and stand first."""
_OPEN: JsonObject = {}


@cache
def _schema() -> JsonObject:
    return json_schema()


def put_in_order(root: Collection) -> None:
    """Put the keys of a schema, and of everything in it, in the documented order."""
    schema = _schema()
    is_dialect = any(_name(item) == "extends" for item in root.items)
    _order(root, schema["then" if is_dialect else "else"])


def _order(node: Node, schema: JsonObject) -> None:
    if not isinstance(node, Collection):
        return
    chosen = next((item for item in _choices(schema) if _accepts(item, node)), _OPEN)
    for item in node.items:
        _order(item.value, _inner(chosen, item))
    if node.is_mapping and _has_fixed_keys(chosen):
        _sort(node, [*_DIRECTIVES, *chosen["properties"]])


def _has_fixed_keys(schema: JsonObject) -> bool:
    return (
        "properties" in schema
        and schema.get("additionalProperties") is False
        and ("patternProperties" not in schema)
    )


def _sort(node: Collection, order: list[str]) -> None:
    ranks = {name: rank for rank, name in reversed(list(enumerate(order)))}
    ordered = sorted(node.items, key=lambda item: ranks.get(_name(item), len(ranks)))
    # Every alias has to mean what it meant.
    if _bindings(node.items) == _bindings(ordered):
        node.items = ordered


def _bindings(items: list[Item]) -> dict[int, int | None]:
    """Return for each alias, by its place in the text, the place of what it stands for."""
    anchors: dict[str, int] = {}
    bound: dict[int, int | None] = {}
    for item in items:
        for node in (*walk(item.key), *walk(item.value)):
            if isinstance(node, Alias):
                bound[node.start] = anchors.get(node.name)
            elif node.anchor is not None:
                anchors[node.anchor] = node.start
    return bound | {-1 - place: place for place in anchors.values()}


def _choices(schema: JsonObject) -> Iterator[JsonObject]:
    """Yield what the schema may be, without references."""
    if "$ref" in schema:
        yield from _choices(_schema()["definitions"][schema["$ref"].rpartition("/")[2]])
    elif "anyOf" in schema:
        for choice in schema["anyOf"]:
            yield from _choices(choice)
    else:
        yield schema


def _accepts(schema: JsonObject, node: Node) -> bool:
    """Tell whether a schema without references describes the node."""
    kind = schema.get("type")
    if not isinstance(node, Collection):
        return kind not in ("object", "array")
    if kind is None or not node.is_mapping:
        return kind in (None, "array")
    return kind == "object" and all(_accepts_item(schema, item) for item in node.items)


def _accepts_item(schema: JsonObject, item: Item) -> bool:
    if _has_fixed_keys(schema) and _name(item) not in schema["properties"]:
        return False
    inner = _inner(schema, item)
    return any(_accepts(choice, item.value) for choice in _choices(inner))


def _inner(schema: JsonObject, item: Item) -> JsonObject:
    """Return what describes the value of an item."""
    found: Any
    if item.key is None:
        found = schema.get("items")
    elif (name := _name(item)) in schema.get("properties", {}):
        found = schema["properties"][name]
    else:
        patterns = list(schema.get("patternProperties", {}).values())
        found = patterns[0] if patterns else schema.get("additionalProperties")
    return found if isinstance(found, Mapping) else _OPEN


def _name(item: Item) -> str:
    return item.key.value if isinstance(item.key, Scalar) else ""
