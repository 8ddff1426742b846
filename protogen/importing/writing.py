"""Writing imported schemas: none over a file that was made or changed by hand.

The first line of a schema has the hash of all that follows. Where that still holds, nobody has
touched the file, and it may be written anew.
"""

from __future__ import annotations

import re
from collections.abc import Iterable
from enum import StrEnum
from hashlib import sha256
from pathlib import Path

from protogen.importing.remarks import Schema
from protogen.targets.output import with_plain_ends

SUFFIX = ".yaml"
_DIGITS = 16
_HEAD = re.compile(rb"# imported by protogen, sha256 ([0-9a-f]+) of what follows\n")


class State(StrEnum):
    """What a file is, compared with what is to stand in it."""

    NEW = "new"
    CURRENT = "current"
    OLD = "old"
    """Made by an import, and not changed since."""
    FOREIGN = "foreign"
    """Made by somebody else, or changed since."""


def content_of(schema: Schema) -> bytes:
    """Return the bytes of a schema's file."""
    body = schema.text.encode("utf-8")
    return f"# imported by protogen, sha256 {_hash(body)} of what follows\n".encode() + body


def path_of(schema: Schema, folder: Path) -> Path:
    """Return the file of a schema in a folder."""
    return folder / f"{schema.name}{SUFFIX}"


def foreign_files(schemas: Iterable[Schema], folder: Path) -> list[Path]:
    """Return the files that are in the way of schemas."""
    return [
        path_of(schema, folder)
        for schema in schemas
        if _state(path_of(schema, folder), content_of(schema)) is State.FOREIGN
    ]


def write_schema(schema: Schema, folder: Path) -> bool:
    """Write a schema's file, whatever is there; False if it is there already."""
    path, content = path_of(schema, folder), content_of(schema)
    if _state(path, content) is State.CURRENT:
        return False
    folder.mkdir(parents=True, exist_ok=True)
    path.write_bytes(content)
    return True


def _state(path: Path, content: bytes) -> State:
    if not path.exists() and not path.is_symlink():
        return State.NEW
    if not path.is_file():
        return State.FOREIGN
    present = with_plain_ends(path.read_bytes())
    if present == content:
        return State.CURRENT
    head = _HEAD.match(present)
    is_ours = head is not None and head[1].decode() == _hash(present[head.end() :])
    return State.OLD if is_ours else State.FOREIGN


def _hash(body: bytes) -> str:
    return sha256(body).hexdigest()[:_DIGITS]
