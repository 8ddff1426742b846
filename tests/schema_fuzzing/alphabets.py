"""The bytes that the payloads of drawn messages can hold, worked out apart from the compiler."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from typing import Any

from schema_fuzzing.setting import ELSE

EVERY = frozenset(range(256))
_DIGITS = {
    "base10": frozenset(b"0123456789"),
    "base16-upper": frozenset(b"0123456789ABCDEF"),
    "base16-lower": frozenset(b"0123456789abcdef"),
}
_PRINTABLE = frozenset(range(0x20, 0x7F))
_WRITTEN = ("digits", "code", "fraction", "case", "padding")

Types = Mapping[str, Any]
"""What is declared."""


def payload_alphabet(messages: Iterable[Any], types: Types, *, delimited: bool) -> frozenset[int]:
    """The bytes of payloads: any, unless something in them is a number that is written as text."""
    found = list(messages)
    fields = [message.get("fields", {}) for message in found]
    if "unspecified" in fields:
        return EVERY
    fields = [_of_payload(item) for item in fields]
    separators = [message["separator"] for message in found if "separator" in message]
    is_text = bool(separators) or any(_is_text(item, types) for item in fields)
    if not is_text:
        return EVERY
    between = {_code(item["byte"] if isinstance(item, dict) else item) for item in separators}
    found = (_of_fields(item, types, last=delimited) for item in fields)
    return frozenset(between).union(*found) or EVERY


def _of_payload(fields: Mapping[str, Any]) -> dict[str, Any]:
    """The fields that have bytes: those that are parts of the frame have none."""
    return {
        name: field
        for name, field in fields.items()
        if not (isinstance(field, dict) and "part" in field)
    }


def _full(item: Any, types: Types) -> dict[str, Any]:
    """A field with what its declared type says."""
    found = {"type": item} if isinstance(item, str) else dict(item)
    while found.get("type") in types:
        declared = types[found.pop("type")]
        found = {**({"type": declared} if isinstance(declared, str) else declared), **found}
    return found


def _inner(item: Mapping[str, Any]) -> Iterator[Any]:
    yield from item.get("fields", {}).values()
    yield from item.get("cases", {}).values()


def _is_text(fields: Mapping[str, Any], types: Types) -> bool:
    for field in fields.values():
        full = _full(field, types)
        written = full.get("type") in ("decimal", "hexadecimal")
        if written or any(key in full for key in _WRITTEN):
            return True
        if any(_is_text({"": inner}, types) for inner in _inner(full)):
            return True
    return False


def _of_fields(fields: Mapping[str, Any], types: Types, *, last: bool) -> frozenset[int]:
    found: frozenset[int] = frozenset()
    for index, field in enumerate(fields.values()):
        found |= _of_field(_full(field, types), types, last=last and index == len(fields) - 1)
    return found


def _of_field(item: dict[str, Any], types: Types, *, last: bool) -> frozenset[int]:
    if "size" in item and "count" not in item and ("switch" in item or "fields" in item):
        last = True  # Of a region, whose end is known.
    if "switch" in item:
        if last and ELSE not in item["cases"]:
            return EVERY  # The bytes of a value without a case.
        return frozenset().union(
            *(_of_field(_full(case, types), types, last=last) for case in item["cases"].values())
        )
    if "packed" in item:
        return EVERY
    if "fields" in item:
        return _of_fields(item["fields"], types, last=last and "count" not in item)
    if "without" in item:
        return _PRINTABLE - frozenset(map(_code, item["without"]))
    return _of_value(item)


def _of_value(item: dict[str, Any]) -> frozenset[int]:
    if item["type"] == "hexadecimal":
        return frozenset(b"0123456789ABCDEFabcdef")
    if item["type"] == "decimal":
        signs = b"+-" if item.get("range", [-1])[0] < 0 else b""
        return frozenset(b"0123456789" + signs + (b"." if item.get("fraction") else b""))
    if item["type"] == "ascii" and "const" not in item and ("code" in item or "padding" in item):
        form = item.get("code", {"bits": 8})
        least = 1 if "padding" in item else 0
        shift, add = form.get("shift", 0), form.get("add", 0)
        return frozenset((code << shift) + add for code in range(least, 2 ** form["bits"]))
    if "code" in item and item["type"] != "ascii":
        first = _code(item["code"]["add"])
        return frozenset(range(first, first + 2 ** item["code"]["bits"]))
    if "digits" in item:
        return _DIGITS[item["digits"]]
    named = {
        name: entry["value"] if isinstance(entry, dict) else entry
        for name, entry in item.get("values", {}).items()
    }
    if "const" in item and "count" not in item:
        return _of_constant(item, named)
    if item["type"] == "char" and item.get("closed"):
        return frozenset(map(_code, named.values()))
    return EVERY


def _of_constant(item: Mapping[str, Any], named: Mapping[str, Any]) -> frozenset[int]:
    constant = item["const"]
    if item["type"] == "char":
        return frozenset({_code(named.get(constant, constant))})
    if item["type"] == "ascii":
        form = item.get("code", {})
        shift, add = form.get("shift", 0), form.get("add", 0)
        text = constant.ljust(item["size"], _padding(item))
        return frozenset((ord(character) << shift) + add for character in text)
    return frozenset(bytes.fromhex(constant["hex"])) if item["type"] == "bytes" else EVERY


def _padding(item: Mapping[str, Any]) -> str:
    padding = item.get("padding", 0)
    return padding if isinstance(padding, str) else chr(padding)


def _code(value: Any) -> int:
    return ord(value) if isinstance(value, str) else value
