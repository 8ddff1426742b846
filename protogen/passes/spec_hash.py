"""Hash of the wire format: layout, framing and the meaning of values.

Texts for people, sources, decisions and examples do not count; both ends of a wire can compare the
hash to know whether they speak the same protocol.
"""

from __future__ import annotations

import hashlib
import json
from collections.abc import Callable
from fractions import Fraction
from functools import cache
from typing import Any

from protogen.copying import defaults_of
from protogen.model.meanings import Enum, Flags
from protogen.model.messages import Message
from protogen.model.protocol import Protocol
from protogen.model.types import Struct

_LEFT_OUT = frozenset(
    {
        "about", "doc", "title", "summary", "source", "span", "examples", "exchanges", "decision",
        "decisions", "unprotected", "unknown", "version", "files", "link", "endpoints", "framing",
        "ranged", "stated", "preset", "spec_hash", "reserved", "plan", "needs", "holds_values",
        "renamed_from", "behind",
    }
)  # fmt: skip
"""Text for readers, and facts that follow from the rest."""

_LISTED = frozenset({"messages", "enums", "flags", "structs"})
"""Members of a protocol that stand in other places, too: messages under their senders."""

_NAMED: tuple[type[Any], ...] = (Enum, Flags, Struct)
"""Types that count once; where they are used their names stand for them."""


def spec_hash(protocol: Protocol) -> str:
    """SHA-256 in hex of everything that changes bytes or what they mean."""
    listed: list[Enum | Flags | Struct] = [*protocol.enums, *protocol.flags, *protocol.structs]
    listed.sort(key=lambda item: item.name)
    return _sha256([_whole(protocol), *map(_whole, listed)], _named)


def message_hash(message: Message) -> str:
    """SHA-256 in hex of a message: its identity, its layout and what its values mean."""
    return _sha256(message, _plain)


def _sha256(value: Any, plain: Callable[[Any], Any]) -> str:
    """The hash of a value as JSON; `plain` turns into such what JSON does not have."""
    text = json.dumps(value, separators=(",", ":"), ensure_ascii=True, default=plain)
    return hashlib.sha256(text.encode()).hexdigest()


def _whole(value: Any) -> dict[str, Any]:
    """A data class as a mapping tagged with its kind, without what is left out.

    What holds its default is left out as well: a field that comes with a later version of the
    compiler changes no hash of a schema that does not use it.
    """
    kind: Any = type(value)
    found: dict[str, Any] = {"kind": kind.__name__}
    for name, default in _kept(kind):
        item = getattr(value, name)
        if item is not default and item != default:
            found[name] = item
    return found


@cache
def _kept(kind: Any) -> tuple[tuple[str, Any], ...]:
    """The fields that count, each with its default."""
    left_out = _LEFT_OUT | _LISTED if kind is Protocol else _LEFT_OUT
    return tuple(sorted(item for item in defaults_of(kind).items() if item[0] not in left_out))


def _named(value: Any) -> Any:
    """What JSON does not have; a named type as its name."""
    return value.name if isinstance(value, _NAMED) else _plain(value)


def _plain(value: Any) -> Any:
    """What JSON does not have: fractions, bytes, and data classes."""
    if isinstance(value, Fraction):
        return str(value)
    return value.hex() if isinstance(value, bytes) else _whole(value)
