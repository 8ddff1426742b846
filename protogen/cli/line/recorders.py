"""Where a command records to: files, their format, and when the next one begins."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Literal, Protocol

import typer

from protogen.cli.exits import UsageError
from protogen.recording.pcapng import PcapngRecorder
from protogen.recording.recorder import Recorder
from protogen.recording.rotation import RotatingRecorder

RecordingFormat = Annotated[
    Literal["pgrec", "pcapng"],
    typer.Option("--format", help="pgrec is read by decode and convert; pcapng by Wireshark."),
]
Output = Annotated[
    Path, typer.Option("--output", "-o", metavar="FILE", help="The recording to write.")
]
MostMegabytes = Annotated[
    float | None,
    typer.Option(
        min=0.000_001,
        metavar="MB",
        help="Begin the next file, FILE-0002 and so on, behind so many.",
    ),
]
MostMinutes = Annotated[
    float | None,
    typer.Option(min=0.001, metavar="MINUTES", help="Begin the next file after so long."),
]
Force = Annotated[bool, typer.Option("--force", help="Write over a file that is there.")]


class _Writes(Protocol):
    def write(self, data: bytes, t_ns: int, source: str = "") -> None: ...
    def note(self, text: str, t_ns: int) -> None: ...
    def sync(self) -> None: ...
    def close(self) -> None: ...


class AnyRecorder:
    """Writes a recording in the format that was asked for."""

    def __init__(self, writes: _Writes, files: list[Path]) -> None:
        self._writes = writes
        self._files = files
        self._is_closed = False

    @property
    def where(self) -> str:
        """The files, for a summary."""
        first, *more = self._files
        return f"{first} to {more[-1].name}" if more else str(first)

    def write(self, data: bytes, t_ns: int, source: str = "") -> None:
        """Record what a source sent. Raises OSError, which names the file."""
        try:
            self._writes.write(data, t_ns, source)
        except OSError as error:
            raise OSError(error.errno, error.strerror, str(self._files[-1])) from None

    def note(self, text: str) -> None:
        """Record what happened just now. Raises OSError."""
        import time

        self._writes.note(text, time.time_ns())

    def sync(self) -> None:
        """Wait until the disk has all. Raises OSError."""
        if not self._is_closed:
            self._writes.sync()

    def close(self) -> None:
        """End the recording."""
        self._is_closed = True
        self._writes.close()


def check_output(path: Path, *, force: bool) -> None:
    """Raise UsageError where a recording can't be written, or would write over a file."""
    if str(path) == "-":
        raise UsageError("a recording is written to a file, not to standard output", "name one")
    if path.exists() and not force:
        hint = "give another name, or --force to write over it"
        raise UsageError(f"{path} is there already", hint)
    if not path.parent.is_dir():
        raise UsageError(f"{path}: No such file or directory", "make the folder first")


def open_recorder(
    path: Path,
    format: Literal["pgrec", "pcapng"],
    max_size: float | None,
    max_time: float | None,
    *,
    force: bool,
) -> AnyRecorder:
    """Begin a recording. Raises UsageError where a file is there already, or can't be made."""
    if max_size is not None or max_time is not None:
        if format != "pgrec":
            raise UsageError(f"--max-size and --max-time are not for {format}", "leave them out")
        most_bytes = None if max_size is None else int(max_size * 1e6)
        most_seconds = None if max_time is None else max_time * 60
        rotating = RotatingRecorder(path, most_bytes, most_seconds)
        return AnyRecorder(rotating, rotating.files)
    check_output(path, force=force)
    stream = path.open("wb" if force else "xb", buffering=0)
    writes = PcapngRecorder(stream) if format == "pcapng" else Recorder(stream, owned=True)
    return AnyRecorder(writes, [path])
