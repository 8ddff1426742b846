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
    """Return a hash of the program: its files and libraries, by their places, sizes and times.

    A version alone would not do: a checkout that is installed as it is changes without one.
    Libraries are not imported for that.
    """
    parts = [VERSION, sys.version]
    for root, folders, names in os.walk(_PACKAGE):
        folders[:] = sorted(name for name in folders if name != "__pycache__")
        parts += (_stamp(Path(root, name)) for name in sorted(names))
    specs = (find_spec(name) for name in _LIBRARIES)
    parts += (
        _stamp(Path(spec.origin)) for spec in specs if spec is not None and spec.origin is not None
    )
    return sha256("\n".join(parts).encode()).hexdigest()


def _stamp(path: Path) -> str:
    status = path.stat()
    return f"{path} {status.st_size} {status.st_mtime_ns}"
