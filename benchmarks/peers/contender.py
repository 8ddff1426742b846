"""What a contender can do, with one of the messages."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

from peers.cases import Row


@dataclass(frozen=True)
class Contender:
    """One program, with the bytes that it takes."""

    name: str
    data: bytes
    """A stream in this program's frames."""
    stream: Callable[[bytes], Any] | None = None
    """Decodes a stream: framing, checksum, validation, typed results."""
    rows: Callable[[Any], list[Row]] | None = None
    """The values in the result of `stream`."""
    places: Callable[[Any], list[tuple[int, bytes]]] | None = None
    """Offsets and raw bytes in the result of `stream`, where it has them."""
    decode: Callable[[], list[Any]] | None = None
    """Decodes some frames, each on its own."""
    row: Callable[[Any], Row] | None = None
    """The values of one that `decode` gave."""
    encode: Callable[[], list[bytes]] | None = None
    """Makes some frames, each on its own."""
    frames: tuple[bytes, ...] = ()
    """What `encode` is to make."""
