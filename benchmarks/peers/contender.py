"""Contenders: what each can do with one of the messages."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

from peers.cases import FEW, Case, Row


@dataclass(frozen=True)
class Contender:
    """One program, with the bytes that it takes."""

    name: str
    rows: Callable[[Any], list[Row]]
    """The values in the result of `stream`."""
    data: bytes
    """A stream in this program's frames."""
    stream: Callable[[bytes], Any] | None = None
    """Decodes a stream: framing, checksum, validation, typed results."""
    places: Callable[[Any], list[tuple[int, bytes]]] | None = None
    """Offsets and raw bytes in the result of `stream`, where it has them."""
    decode: Callable[[], list[Any]] | None = None
    """Decodes some frames, each on its own."""
    decoded: Callable[[list[Any]], list[Row]] | None = None
    """The values in the result of `decode`, where `rows` cannot tell."""
    encode: Callable[[], list[bytes]] | None = None
    """Makes some frames, each on its own."""
    frames: tuple[bytes, ...] = ()
    """Frames that `encode` is to make, unless its frames count on."""
    feeder: Callable[[], Callable[[bytes], Any]] | None = None
    """Gives what takes the next bytes of a live stream."""
    loops: int = 1
    """Number of times the case's stream is in `data`."""


def check(contender: Contender, case: Case) -> None:
    """Raise ValueError unless it reads and writes what the reference does."""
    name = f"{contender.name}, {case.title}"
    if contender.stream:
        found = contender.stream(contender.data if contender.loops == 1 else case.stream)
        _same(name, contender.rows(found), case.rows)
        if contender.places:
            _same(f"{name}, raw", [raw for _, raw in contender.places(found)], case.frames)
    if contender.decode:
        _same(name, (contender.decoded or contender.rows)(contender.decode()), case.rows[:FEW])
    if contender.encode:
        made = contender.encode()
        if contender.frames:
            _same(f"{name}, frames", made, list(contender.frames))
        elif contender.stream:
            _same(name, contender.rows(contender.stream(b"".join(made))), case.rows[:FEW])


def _same(name: str, found: list[Any], wanted: list[Any]) -> None:
    if found != wanted:
        pairs = enumerate(zip(found, wanted, strict=False))
        place = next((n for n, (one, two) in pairs if one != two), min(len(found), len(wanted)))
        raise ValueError(
            f"{name}: {len(found)} of {len(wanted)}; from {place} on "
            f"{found[place : place + 1]} instead of {wanted[place : place + 1]}"
        )
