"""What identifies the wire format: layout, framing and the meaning of values.

Texts for people, sources, decisions and examples do not count; both ends of a wire can compare the
hash to know whether they speak the same protocol.
"""

from __future__ import annotations

import hashlib
import json
from dataclasses import fields
from fractions import Fraction
from functools import cache
from typing import Any

from protogen.model.protocol import Protocol

_LEFT_OUT = frozenset(
    {
        "about", "doc", "title", "summary", "source", "span", "examples", "exchanges", "decision",
        "decisions", "unprotected", "unknown", "version", "files", "link", "endpoints", "framing",
        "ranged", "stated", "preset", "spec_hash",
    }
)  # fmt: skip
"""What people read, and what follows from the rest."""

_IN_OTHER_PLACES = frozenset({"enums", "flags", "structs", "messages"})
"""What a protocol lists once more: it is found where it is used."""

_LEAVES = frozenset({int, str, bool, float, type(None)})


def spec_hash(protocol: Protocol) -> str:
    """SHA-256 in hex of everything that changes bytes or what they mean."""
    text = json.dumps(_plain(protocol), separators=(",", ":"), ensure_ascii=True)
    return hashlib.sha256(text.encode()).hexdigest()


def _plain(value: Any) -> Any:
    """Data classes as mappings tagged with their kind, without what is left out."""
    kind = type(value)
    if kind in _LEAVES:
        return value
    if kind is tuple:
        return [_plain(item) for item in value]
    if kind is Fraction:
        return str(value)
    if kind is bytes:
        return value.hex()
    return {"kind": kind.__name__} | {name: _plain(getattr(value, name)) for name in _kept(kind)}


@cache
def _kept(kind: type[Any]) -> tuple[str, ...]:
    left_out = _LEFT_OUT | _IN_OTHER_PLACES if kind is Protocol else _LEFT_OUT
    return tuple(sorted({field.name for field in fields(kind)} - left_out))
