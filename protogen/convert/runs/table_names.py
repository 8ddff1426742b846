"""Names of captures' tables: those of the captures' files, and no two of a run alike."""

from __future__ import annotations

import os
from collections import Counter
from collections.abc import Sequence
from pathlib import PurePosixPath

from protogen.convert.errors import ConvertError
from protogen.convert.inputs.compression import SUFFIXES

STANDARD_INPUT = "-"
_PARENT = "up"
"""Stands for `..` in a name."""


def names_of(places: Sequence[str]) -> list[str]:
    """A name for each capture that no other has: that of its file, with folders where it must.

    Raises ConvertError where a capture is given twice.
    """
    plain = [plain_name(place) for place in places]
    times = Counter(plain)
    names = [
        name if times[name] == 1 else _long_name(place)
        for name, place in zip(plain, places, strict=True)
    ]
    first: dict[str, str] = {}
    for name, place in zip(names, places, strict=True):
        if name not in first:
            first[name] = place
            continue
        other = first[name]
        if os.path.normpath(place) == os.path.normpath(other):
            raise ConvertError(f"{place} is given twice")
        raise ConvertError(
            f"the tables of {other} and {place} would both be called {name}",
            "convert them into two folders, with --output",
        )
    return names


def plain_name(place: str) -> str:
    """The name that a capture's tables get if no other capture has it: that of the file, bare."""
    if place == STANDARD_INPUT:
        return "stdin"
    path = PurePosixPath(place.partition("://")[2] or place)
    if path.suffix in SUFFIXES:
        path = path.with_suffix("")
    return _usable(path.stem)


def _long_name(place: str) -> str:
    path = os.path.normpath(place.partition("://")[2] or place).replace(os.sep, "/").strip("/")
    return _usable("-".join(_PARENT if step == ".." else step for step in path.split("/")))


def _usable(name: str) -> str:
    """A name that all formats can hold, and that readers of folders of tables do not pass over.

    Those take what begins with a dot or an underscore for something of their own. Bytes of a file's
    name that are no text have no place in the metadata of tables.
    """
    text = name.encode("utf-8", "surrogateescape").decode("utf-8", "backslashreplace")
    if text != name:
        text = text.replace("\\", "%")
    return f"capture{text}" if text.startswith((".", "_")) or not text else text
