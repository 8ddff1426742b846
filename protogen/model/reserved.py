"""Names and numbers that may not come back with another meaning."""

from __future__ import annotations

import msgspec


class ReservedIdentity(msgspec.Struct, frozen=True, kw_only=True):
    """The identity of a message that is no longer sent."""

    sender: str
    identity: tuple[int, ...]
    doc: str = ""


class ReservedNames(msgspec.Struct, frozen=True, kw_only=True):
    """Field names that a message may not use again."""

    message: str
    names: tuple[str, ...]


class ReservedValues(msgspec.Struct, frozen=True, kw_only=True):
    """Raw values that the enum at `path`, MESSAGE.FIELD or a type, may not use again."""

    path: str
    values: tuple[int, ...]


class Reserved(msgspec.Struct, frozen=True, kw_only=True):
    """All that is reserved in a protocol."""

    identities: tuple[ReservedIdentity, ...] = ()
    fields: tuple[ReservedNames, ...] = ()
    values: tuple[ReservedValues, ...] = ()


NOTHING_RESERVED = Reserved()
