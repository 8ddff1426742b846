"""The library: schemas of protocols in the wild, installed with protogen.

`extends: library:NAME` takes one, and states what a device does differently. Commands take
`library:NAME` where they take a schema.
"""

from __future__ import annotations

from pathlib import Path

FOLDER = Path(__file__).resolve().parent
"""The folder of the schemas."""

PREFIX = "library:"
"""Beginning of what stands for a schema of the library where a path may stand."""


def library_names() -> tuple[str, ...]:
    """Names of the schemas, in order."""
    return tuple(sorted(path.stem for path in FOLDER.glob("*.yaml")))


def library_file(name: str) -> Path | None:
    """File of a schema; None if the library has none of that name."""
    return FOLDER / f"{name}.yaml" if name in library_names() else None
