"""What identifies the wire format: layout, framing and the meaning of values.

Texts for people, sources, decisions and examples do not count; both ends of a wire can compare the
hash to know whether they speak the same protocol.
"""

from __future__ import annotations

import dataclasses
import hashlib
import json
from fractions import Fraction
from typing import Any

from protogen.model.framing import Framing
from protogen.model.messages import Example
from protogen.model.origin import About, Source
from protogen.model.protocol import Protocol

_LEFT_OUT = frozenset(
    {
        "spec_hash", "files", "title", "summary", "doc", "version", "span", "examples", "exchanges",
        "decisions", "decision", "unprotected", "unknown", "link", "endpoints", "ranged", "preset",
        "enums", "flags", "structs",
    }
)  # fmt: skip
_TEXTS = (About, Source, Example, Framing)


def spec_hash(protocol: Protocol) -> str:
    """SHA-256 in hex of everything that changes bytes or what they mean."""
    text = json.dumps(_plain(protocol), sort_keys=True, separators=(",", ":"), ensure_ascii=True)
    return hashlib.sha256(text.encode()).hexdigest()


def _plain(value: Any) -> Any:
    """Data classes as mappings tagged with their kind, without what people read."""
    if isinstance(value, _TEXTS):
        return None
    if dataclasses.is_dataclass(value) and not isinstance(value, type):
        kept = {
            field.name: _plain(getattr(value, field.name))
            for field in dataclasses.fields(value)
            if field.name not in _LEFT_OUT and not isinstance(getattr(value, field.name), _TEXTS)
        }
        return {"kind": type(value).__name__, **kept}
    return _plain_leaf(value)


def _plain_leaf(value: Any) -> Any:
    match value:
        case tuple():
            return [_plain(item) for item in value]
        case Fraction():
            return str(value)
        case bytes():
            return value.hex()
    return value
