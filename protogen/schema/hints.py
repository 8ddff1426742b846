"""Hints about what people write out of habit: other names of keys and types, and wrong forms."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from itertools import takewhile
from typing import Any

from protogen.problems import hint_for

_KEYS: Mapping[str, Sequence[tuple[str, str]]] = {
    "min": [("range", "write `range: [MIN, MAX]`, in raw values")],
    "max": [("range", "write `range: [MIN, MAX]`, in raw values")],
    "minimum": [("range", "write `range: [MIN, MAX]`, in raw values")],
    "maximum": [("range", "write `range: [MIN, MAX]`, in raw values")],
    "endian": [("byte_order", "write `byte_order: little` or `byte_order: big`")],
    "endianness": [("byte_order", "write `byte_order: little` or `byte_order: big`")],
    "length": [
        ("counts", "write `counts: payload`, or `counts: [PART, PART]`"),
        ("count", "write `count: NUMBER` for an array, `size: NUMBER` for text and bytes"),
    ],
    "len": [("counts", "write `counts: payload`"), ("count", "write `count: NUMBER`")],
    "array": [("count", "write `count: NUMBER`")],
    "repeat": [
        ("repeats", "write `repeats: PART`, of what stands in front"),
        ("count", "write `count: NUMBER`"),
    ],
    "copy": [("repeats", "write `repeats: PART`, of what stands in front")],
    "inverse": [("complements", "write `complements: PART`, of what stands in front")],
    "inverted": [("complements", "write `complements: PART`, of what stands in front")],
    "complement": [("complements", "write `complements: PART`, of what stands in front")],
    "terminator": [("until", "write `until: BYTE`, such as `until: 0`")],
    "enum": [("values", "write `values: {NAME: NUMBER}`")],
    "factor": [("scale", "write `scale: FACTOR`, such as 1/10")],
    "resolution": [("scale", "write `scale: FACTOR`, such as 1/10")],
    "multiplier": [("scale", "write `scale: FACTOR`, such as 1/10")],
    "description": [("doc", "write `doc: TEXT`")],
    "comment": [("doc", "write `doc: TEXT`")],
    "desc": [("doc", "write `doc: TEXT`")],
    "opcode": [("id", "write `id: NUMBER`")],
    "sender": [("from", "write `from: ENDPOINT`")],
    "source": [("from", "write `from: ENDPOINT`")],
    "crc": [("algorithm", "write `algorithm: NAME`")],
    "checksum": [("algorithm", "write `algorithm: NAME`")],
    "value": [("literal", "write `literal: BYTES`"), ("const", "write `const: VALUE`")],
    "magic": [("literal", "write `literal: BYTES`")],
    "sync": [("literal", "write `literal: BYTES`")],
}
"""Keys of other languages, with ours: the first that is a key at the place is meant."""
_HEXADECIMAL = re.compile(r"(?:0[xX])?([0-9A-Fa-f]+)[hH]?")
_LONG_BYTES = 255
_PROSE = frozenset(("doc", "title", "summary", "note", "section")) | frozenset(
    ("question", "document", "choice", "because", "why")
)
"""Keys whose values are sentences."""
_OF_NAMES = frozenset(
    ("messages", "forms", "frame", "endpoints", "types", "values", "special", "flags", "bits")
) | frozenset(
    ("cases", "fields", "parts", "examples", "exchanges", "decisions", "overloads", "reserved")
)
"""Keys whose values are names, with what belongs to each."""


def key_hint(word: str, known: Sequence[str]) -> str | None:
    """What to write in the place of another language's key; None where it is none of those."""
    return next((hint for key, hint in _KEYS.get(word.casefold(), ()) if key in known), None)


def number_hint(written: object) -> str | None:
    """How a number is written that stands in quotes, or as in assembler."""
    if not isinstance(written, str):
        return None
    found = _HEXADECIMAL.fullmatch(written.strip())
    if found is None:
        return None
    if written.casefold().endswith("h"):
        return f"write 0x{found[1]}"
    return f"write it without quotes: {written.strip()}"


def bytes_hint(written: object) -> str | None:
    """How several bytes are written that stand in one number."""
    if not isinstance(written, int) or isinstance(written, bool) or written <= _LONG_BYTES:
        return None
    data = written.to_bytes((written.bit_length() + 7) // 8, "big")
    listed = ", ".join(f"0x{byte:02X}" for byte in data)
    return f"write the bytes in their order: [{listed}]"


def form_hint(words: str, key: str, written: object) -> str | None:
    """How something of another form is written, by what stands there."""
    if "one character" in words:
        return number_hint(written)
    if words.endswith("from 0 to 255") or "a byte is" in words:
        return bytes_hint(written)
    if isinstance(written, list):
        return list_hint(key, written)
    if written is None and key:
        return f"indent what belongs to `{key}`"
    return None


def pair_hint(key: object, pairs: object) -> str | None:
    """How names and their numbers are written where the numbers stand in front."""
    if not isinstance(pairs, dict) or not all(isinstance(name, str) for name in pairs.values()):
        return None
    turned = ", ".join(f"{name}: {number}" for number, name in pairs.items())
    return f"the name stands in front of its number: `{key}: {{{turned}}}`"


def missing_hint(loc: Sequence[str | int], data: Any) -> str | None:
    """What to write for a key that is missing."""
    if loc[0] != "messages" or loc[-1] != "from":
        return None
    if len(loc) > 1 and loc[1] in ("fields", "id", "from", "examples"):
        return f"`{loc[1]}` is a key of a message: indent it below the message's name"
    endpoints = data.get("endpoints") if isinstance(data, dict) else None
    names = [str(name) for name in endpoints] if isinstance(endpoints, dict) else []
    return f"say who sends it: `from: {' or '.join(names[:3])}`" if names else None


def endpoint_hint(detail: Any, data: Any) -> str | None:
    """The endpoint that is meant by its title, or by its name in other letters."""
    endpoints = data.get("endpoints") if isinstance(data, dict) else None
    written = detail["input"]
    if "from" not in detail["loc"] or not isinstance(endpoints, dict):
        return None
    if not isinstance(written, str):
        return None
    for name, item in endpoints.items():
        title = item.get("title") if isinstance(item, dict) else item
        if title == written:
            return f"that is a title; write the endpoint's name: `{name}`"
    names = [str(name) for name in endpoints]
    return hint_for(written, names) or f"endpoints are {', '.join(names)}"


def list_hint(key: str, written: object) -> str | None:
    """How a mapping is written where a list stands."""
    if not isinstance(written, list) or not written or key not in _OF_NAMES:
        return None
    if key in ("values", "flags", "special") and all(isinstance(item, str) for item in written):
        pairs = ", ".join(f"{name}: {number}" for number, name in enumerate(written))
        return f"each name has its number: `{{{pairs}}}`"
    marks = "`-` or `[ ]`"
    return f"leave out the {marks}: `{key}:` holds names, each with a `:` and what belongs to it"


def indent_hint(around: Any, key: str, mappings: Sequence[str]) -> str | None:
    """The key that a mapping probably belongs to, where it is not indented."""
    if not isinstance(around, dict) or not isinstance(around.get(key), dict | str):
        return None
    empty = [name for name in mappings if name in around and not around[name]]
    return f"indent it, if it belongs to `{empty[0]}`" if len(empty) == 1 else None


def comma_hint(around: Any, key: str) -> str | None:
    """How to write a text between braces that commas have cut into a text and keys."""
    if not isinstance(around, dict) or around.get(key, "") is not None:
        return None
    names = [str(name) for name in around]
    first = names.index(key)
    while first and around.get(names[first]) is None:
        first -= 1
    text = around.get(names[first])
    if names[first] not in _PROSE or not isinstance(text, str):
        return None
    pieces = takewhile(lambda name: around.get(name) is None, names[first + 1 :])
    return f'a comma ends a text: `{names[first]}: "{", ".join((text, *pieces))}"`'
