"""Identity of this program, for whatever is kept from one run to the next."""

from __future__ import annotations

import os
import sys
from hashlib import sha256
from importlib.util import find_spec
from pathlib import Path

from protogen.version import VERSION

_PACKAGE = Path(__file__).resolve().parent
_LIBRARIES = ("construct", "jinja2", "msgspec", "pydantic", "yaml")


def program() -> str:
    """Return a hash of the program: its files as they are now, and what it was built on.

    A version alone would not do: a checkout that is installed as it is changes without one.
    """
    parts = [VERSION, sys.version]
    for root, folders, names in os.walk(_PACKAGE):
        folders[:] = sorted(name for name in folders if name != "__pycache__")
        parts += (_file_part(Path(root, name)) for name in sorted(names))
    return sha256("\n".join([*parts, *map(_library, _LIBRARIES)]).encode()).hexdigest()


def _file_part(path: Path) -> str:
    return f"{path.relative_to(_PACKAGE).as_posix()} {sha256(path.read_bytes()).hexdigest()}"


def _library(name: str) -> str:
    """Return where a library is and since when; it is not imported for that."""
    spec = find_spec(name)
    if spec is None or spec.origin is None:
        return name
    status = Path(spec.origin).stat()
    return f"{name} {spec.origin} {status.st_size} {status.st_mtime_ns}"
