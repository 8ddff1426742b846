"""Hash of the wire format: layout, framing and the meaning of values.

Texts for people, sources, decisions and examples do not count; both ends of a wire can compare the
hash to know whether they speak the same protocol.
"""

from __future__ import annotations

import hashlib
from collections.abc import Callable
from fractions import Fraction
from functools import cache
from json import JSONEncoder
from operator import attrgetter
from typing import Any, NamedTuple

from protogen.copying import defaults_of
from protogen.model.expressions import Expression
from protogen.model.meanings import Enum, Flags
from protogen.model.messages import Message
from protogen.model.protocol import Protocol
from protogen.model.types import Struct

_LEFT_OUT = frozenset(
    {
        "about", "doc", "title", "summary", "source", "span", "examples", "exchanges", "decision",
        "decisions", "unprotected", "unknown", "version", "files", "link", "endpoints", "framing",
        "ranged", "stated", "preset", "spec_hash", "reserved", "plan", "needs", "holds_values",
        "renamed_from", "rate", "behind", "constants", "agrees_with",
    }
)  # fmt: skip
"""Text for readers, and facts that follow from the rest."""

CALLED = {"by": "field"}
"""Members by names that they had before: hashes and locks of old schemas stay."""

_LISTED = frozenset({"messages", "enums", "flags", "structs"})
"""Members of a protocol that stand in other places, too: messages under their senders."""

_NAMED: tuple[type[Any], ...] = (Enum, Flags, Struct)
"""Types that count once; where they are used their names stand for them."""


class Hashes:
    """Hashes of a protocol and of its messages.

    What messages hold is in the hash of the protocol, too, but is looked at once.
    """

    def __init__(self) -> None:
        self._seen: dict[int, tuple[Any, Any]] = {}
        """Values, by their addresses, with what stands for them in JSON."""
        self._in_full = _encoder(self._plain)
        self._by_name = _encoder(self._named)

    def protocol(self, protocol: Protocol) -> str:
        """SHA-256 in hex of everything that changes bytes or what they mean."""
        listed: list[Enum | Flags | Struct] = [*protocol.enums, *protocol.flags, *protocol.structs]
        listed.sort(key=lambda item: item.name)
        return _sha256(self._by_name.encode([_whole(protocol), *map(self._plain, listed)]))

    def message(self, message: Message) -> str:
        """SHA-256 in hex of a message: its identity, its layout and what its values mean."""
        return _sha256(self._in_full.encode(message))

    def _named(self, value: Any) -> Any:
        """What JSON does not have; a named type as its name."""
        return value.name if isinstance(value, _NAMED) else self._plain(value)

    def _plain(self, value: Any) -> Any:
        """What JSON does not have; a named type as it is."""
        known = self._seen.get(id(value))
        if known is None:
            known = self._seen[id(value)] = value, _plain(value)
        return known[1]


def _sha256(text: str) -> str:
    return hashlib.sha256(text.encode()).hexdigest()


def _whole(value: Any) -> dict[str, Any]:
    """A data class as a mapping tagged with its kind, without what is left out.

    What holds its default is left out as well: a field that comes with a later version of the
    compiler changes no hash of a schema that does not use it.
    """
    of: Any = type(value)
    kind = _kind(of)
    stated = {
        name: item
        for name, default, item in zip(kind.fields, kind.defaults, kind.values(value), strict=True)
        if item is not default and (default is None or item != default)
    }
    return {"kind": kind.name, **stated}


class _Kind(NamedTuple):
    """The fields of a data class that count, by their names in the hash."""

    name: str
    fields: tuple[str, ...]
    defaults: tuple[Any, ...]
    values: Callable[[Any], tuple[Any, ...]]
    """The values of the fields, in their order."""


@cache
def _kind(kind: Any) -> _Kind:
    left_out = _LEFT_OUT | _LISTED if kind is Protocol else _LEFT_OUT
    kept = {name: default for name, default in defaults_of(kind).items() if name not in left_out}
    fields = tuple(sorted(kept))
    called = tuple(CALLED.get(name, name) for name in fields)
    return _Kind(kind.__name__, called, tuple(map(kept.get, fields)), _getter(fields))


def _getter(fields: tuple[str, ...]) -> Callable[[Any], tuple[Any, ...]]:
    if len(fields) > 1:
        return attrgetter(*fields)
    return lambda value: tuple(getattr(value, name) for name in fields)


def _plain(value: Any) -> Any:
    """What JSON does not have: fractions, expressions, bytes, and data classes."""
    kind = type(value)
    # Not `isinstance` of a fraction, which takes long for a class of `numbers`.
    if kind is Fraction or isinstance(value, Expression):
        return str(value)
    return value.hex() if kind is bytes else _whole(value)


def _encoder(plain: Callable[[Any], Any]) -> JSONEncoder:
    """An encoder of the model, which has no cycles; `plain` turns into JSON what is none."""
    return JSONEncoder(separators=(",", ":"), check_circular=False, default=plain)
