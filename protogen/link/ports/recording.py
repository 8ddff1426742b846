"""Opens recordings as ports."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

from protogen.link.ports.port import PortError
from protogen.link.ports.recorded import RecordedPort
from protogen.recording import RecordKind, records
from protogen.recording.reader import is_recording

_PIECE = 1 << 16
"""The most bytes that are read of a file at once."""
_HEAD = 8
"""Bytes that show whether a file is a recording."""


def open_recording(name: str, speed: float, source: str | None = None) -> RecordedPort:
    """Open a recording, of what one source sent or of all. Raises PortError."""
    path = Path(name)
    try:
        with path.open("rb") as file:
            head = file.read(_HEAD)
    except OSError as error:
        raise PortError(f"{name}: {error.strerror}") from None
    if not is_recording(head):
        problem = f"{name} is a file, but no recording: its bytes have no times"
        raise PortError(problem, "read it by `protogen decode`, or record with `protogen record`")
    return RecordedPort(name, _pieces(path, source), speed)


def _pieces(path: Path, source: str | None) -> Iterator[tuple[bytes, int]]:
    for record in records(_read(path), lambda problem: None):
        if record.kind is RecordKind.BYTES and source in (None, record.source):
            yield record.data, record.when


def _read(path: Path) -> Iterator[bytes]:
    with path.open("rb") as file:
        while piece := file.read(_PIECE):
            yield piece
