"""Journal of parts written by a fleet, used to clean up after an interrupted run.

A run that was ended may have had other parts, smaller ones or any at all. So its files are known to
whatever run comes next, which would otherwise leave their rows beside its own.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from contextlib import suppress
from pathlib import Path

from protogen.convert.writers.pending_files import sweep, write_whole

MARKERS = ".protogen-convert-parts"
"""The folder of markers in the output folder."""
_SUFFIX = ".parquet"
_DIGITS = 6


def part_name(capture: str, number: int) -> str:
    """Name of the files of a part of a capture."""
    return f"{capture}.{number:0{_DIGITS}}"


def marker_of(folder: Path, part: str) -> Path:
    """Path of a part's marker."""
    return folder / MARKERS / f"{part}.json"


def is_unfinished(folder: Path, capture: str) -> bool:
    """True if a fleet has begun with a capture, and not finished."""
    return _journal(folder, capture).exists()


def begin(folder: Path, capture: str, parts: int) -> None:
    """Write down that files of so many parts of a capture are ours from now on. Raises OSError."""
    most = max(parts, _parts(folder, capture))
    write_whole(_journal(folder, capture), str(most).encode())


def finish(folder: Path, captures: Mapping[str, Iterable[str]], files: Iterable[str]) -> None:
    """Remove all that is left of the parts of captures but for these files.

    `captures` has the names of the parts of this run; those of earlier ones are known. All of them
    at once, as it takes a look at everything that is in the folders.
    """
    names, journals = set[str](), list[str]()
    for capture, parts in captures.items():
        names.update(parts)
        names.update(part_name(capture, number) for number in range(_parts(folder, capture)))
        journals.append(_journal(folder, capture).name)
    if not captures:
        return
    # A capture that could not be cut was a part itself, but its files may be another's.
    torn = [f"{capture}{_SUFFIX}" for capture in captures]
    sweep(folder, [f"{name}{_SUFFIX}" for name in names], files, torn=torn)
    # A worker that was killed may have left a marker that is not whole.
    markers = [marker_of(folder, name).name for name in (*names, *captures)]
    sweep(folder, [*markers, *journals], within=MARKERS)
    with suppress(OSError):  # It is not there, or has markers of other captures.
        (folder / MARKERS).rmdir()


def _journal(folder: Path, capture: str) -> Path:
    return folder / MARKERS / f"{capture}.journal"


def _parts(folder: Path, capture: str) -> int:
    """Most parts that a capture had in any run that began with it."""
    try:
        return int(_journal(folder, capture).read_bytes() or b"0")
    except (OSError, ValueError):
        return 0
