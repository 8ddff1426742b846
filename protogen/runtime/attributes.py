"""Names of attributes and arguments: the schema's own, with `_` behind those that Python takes.

No name of a schema ends with `_`, so an escaped one is nobody else's, and its end tells it.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

KEYWORDS = """
and as assert async await break class continue def del elif else except finally for from global if
import in is lambda nonlocal not or pass raise return try while with yield
"""
_METHODS = "violations to_dict from_dict to_payload from_payload parse_payload"
"""Of messages and structs: a field of the name would hide one."""
_PARAMETERS = "message sender strict engine form"
"""Of generated encoders, beside the parts whose values the caller gives."""
_PARSED = "payload data stream cls"
"""Parameters of what reads payloads, beside the numbers of the frame that are fields."""


def _escaped(*words: str) -> Mapping[str, str]:
    return {word: f"{word}_" for word in " ".join((*words, "self")).split()}


ATTRIBUTES = _escaped(KEYWORDS, _METHODS)
"""The attributes of fields and parts that are not called as the schema calls them."""
ARGUMENTS = _escaped(KEYWORDS, _PARAMETERS)
"""The arguments of encoders that are not called as the schema calls the parts that they give."""
HELD_ARGUMENTS = _escaped(KEYWORDS, _PARSED)
"""The same, of what reads payloads, by the fields that are numbers of the frame."""


def attribute(name: str) -> str:
    """The attribute of a field or part: `class_` for `class`."""
    return ATTRIBUTES.get(name, name)


def argument(name: str) -> str:
    """The argument of an encoder that gives a part: `message_` for `message`."""
    return ARGUMENTS.get(name, name)


def arguments(parts: Mapping[str, Any]) -> dict[str, Any]:
    """The arguments of an encoder that give parts, which the mapping has by the schema's names."""
    return {argument(name): value for name, value in parts.items()}


def held_argument(name: str) -> str:
    """The argument of what reads payloads that gives a field: `data_` for `data`."""
    return HELD_ARGUMENTS.get(name, name)


def held_arguments(held: Mapping[str, int]) -> dict[str, int]:
    """The arguments that give fields, which the mapping has by the schema's names."""
    return {held_argument(name): value for name, value in held.items()}


def schema_name(name: str) -> str:
    """The schema's name of an attribute or argument."""
    return name.removesuffix("_")
