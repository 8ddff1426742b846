"""Compiled schemas in the user's folder for caches: commands that read bytes start much sooner.

What is kept holds for the same program and the same contents of each file that was read. It is
never needed: whatever is wrong with it, the schema is compiled.
"""

from __future__ import annotations

import os
import pickle
from collections.abc import Iterable
from hashlib import sha256
from pathlib import Path

import msgspec

from protogen.cache_folder import CacheError, cache_folder, check, safe_folder
from protogen.live.modules import Modules
from protogen.model.protocol import Protocol
from protogen.problems.sources import SourceMap
from protogen.program import program

_FOLDER = "schemas"
_MOST = 100
"""Schemas that are kept; the oldest ones go first."""
_DIGEST_SIZE = sha256().digest_size


class Compiled(msgspec.Struct, frozen=True):
    """A protocol without errors, and the modules that would be generated for it."""

    protocol: Protocol
    modules: Modules


def read(schema: Path) -> Compiled | None:
    """Return what is kept of a schema; None if that is nothing, or something has changed since."""
    try:
        folder = safe_folder(cache_folder(_FOLDER))
        file = folder / _name(schema)
        data = file.read_bytes()
        check(file)
    except (OSError, CacheError):
        return None
    digest, contents = data[:_DIGEST_SIZE], data[_DIGEST_SIZE:]
    if sha256(contents).digest() != digest:
        return None
    identity, inputs, kept = pickle.loads(contents)  # noqa: S301 - only this user writes there
    if identity != program() or any(_digest(path) != known for path, known in inputs.items()):
        return None
    compiled: Compiled = pickle.loads(kept)  # noqa: S301 - by this program, as it says
    return compiled


def keep(schema: Path, sources: SourceMap, compiled: Compiled) -> None:
    """Keep what a schema was compiled to. What can't be kept is not."""
    inputs = {file: _digest_of_text(file, sources.text(file)) for file in sources.files}
    if None in inputs.values():
        return
    contents = pickle.dumps((program(), inputs, pickle.dumps(compiled)))
    try:
        folder = safe_folder(cache_folder(_FOLDER))
        file = folder / _name(schema)
        temporary = file.with_suffix(f".{os.getpid()}")
        temporary.touch(mode=0o600)
        temporary.write_bytes(sha256(contents).digest() + contents)
        temporary.replace(file)
        _remove_oldest(folder.iterdir())
    except (OSError, CacheError):
        return


def _name(schema: Path) -> str:
    """Name of what is kept of a schema; places in it are named from the working directory."""
    return sha256(f"{Path.cwd()}\n{schema}".encode(errors="surrogateescape")).hexdigest()


def _digest(file: str) -> bytes | None:
    try:
        return sha256(Path(file).read_bytes()).digest()
    except OSError:
        return None


def _digest_of_text(file: str, text: str | None) -> bytes | None:
    """Digest of a file, if it still holds the text that was read."""
    data = Path(file).read_bytes()
    return sha256(data).digest() if data.decode("utf-8-sig", "replace") == text else None


def _remove_oldest(files: Iterable[Path]) -> None:
    newest_first = sorted(files, key=lambda file: file.stat().st_mtime_ns, reverse=True)
    for file in newest_first[_MOST:]:
        file.unlink(missing_ok=True)
