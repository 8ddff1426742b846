"""Opens recordings as ports."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

from protogen.link.ports.port import Arrival, PortError
from protogen.link.ports.recorded import RecordedPort
from protogen.recording import Record, RecordKind, records
from protogen.recording.reader import is_recording

_PIECE = 1 << 16
"""The most bytes that are read of a file at once."""
_HEAD = 8
"""Bytes that show whether a file is a recording."""


def open_recording(name: str, speed: float, source: str | None = None) -> RecordedPort:
    """Open a recording, of what one source sent or of all. Raises PortError."""
    return RecordedPort(name, _arrivals(name, source), speed)


def sources_of(name: str) -> list[str]:
    """The sources of a recording that have sent something. Raises PortError."""
    found = _records(_checked(name))
    return list(dict.fromkeys(item.source for item in found if item.kind is RecordKind.BYTES))


def pieces_of(name: str, source: str | None = None) -> Iterator[tuple[bytes, int]]:
    """Bytes of a recording with their times, of one source or of all. Raises PortError."""
    return ((item.data, item.when) for item in _arrivals(name, source))


def _arrivals(name: str, source: str | None) -> Iterator[Arrival]:
    path = _checked(name)
    return (
        Arrival(record.data, record.when, record.source)
        for record in _records(path)
        if record.kind is RecordKind.BYTES and source in (None, record.source)
    )


def _checked(name: str) -> Path:
    path = Path(name)
    try:
        with path.open("rb") as file:
            head = file.read(_HEAD)
    except OSError as error:
        raise PortError(f"{name}: {error.strerror}") from None
    if not is_recording(head):
        problem = f"{name} is a file, but no recording: its bytes have no times"
        raise PortError(problem, "read it by `protogen decode`, or record with `protogen record`")
    return path


def _records(path: Path) -> Iterator[Record]:
    return records(_read(path), lambda problem: None)


def _read(path: Path) -> Iterator[bytes]:
    with path.open("rb") as file:
        while piece := file.read(_PIECE):
            yield piece
