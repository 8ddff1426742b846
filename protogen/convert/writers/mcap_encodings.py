"""Encodings of messages in MCAP."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any, Protocol

from protogen.convert.columns.tables import Table


class Encoding(Protocol):
    """The encoding of messages: how MCAP calls it, and what they are in it."""

    profile: str
    compression: str
    """Of chunks: `zstd`, or empty where they are stored as they are."""
    has_checksums: bool
    """True if chunks have a CRC of what is in them before it is compressed."""
    schema_encoding: str
    message_encoding: str

    def schema(self, table: Table) -> tuple[str, bytes]:
        """The name of a table's schema, and the schema."""

    def encoder(self, table: Table) -> Callable[[Mapping[str, Any]], bytes]:
        """What makes messages of rows: values by the names of their columns."""
