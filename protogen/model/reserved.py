"""Names and numbers that may not come back with another meaning."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True, slots=True, kw_only=True)
class ReservedIdentity:
    """The identity of a message that is no longer sent."""

    sender: str
    identity: tuple[int, ...]
    doc: str = ""


@dataclass(frozen=True, slots=True, kw_only=True)
class ReservedNames:
    """Field names that a message may not use again."""

    message: str
    names: tuple[str, ...]


@dataclass(frozen=True, slots=True, kw_only=True)
class ReservedValues:
    """Raw values that the enum at `path`, MESSAGE.FIELD or a type, may not use again."""

    path: str
    values: tuple[int, ...]


@dataclass(frozen=True, slots=True, kw_only=True)
class Reserved:
    """All that is reserved in a protocol."""

    identities: tuple[ReservedIdentity, ...] = ()
    fields: tuple[ReservedNames, ...] = ()
    values: tuple[ReservedValues, ...] = ()


NOTHING_RESERVED = Reserved()
