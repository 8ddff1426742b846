"""The protocol that a capture is read by: a model, a schema's path, or its name."""

from __future__ import annotations

import os
from pathlib import Path

import msgspec

from protogen.capture.errors import CaptureError
from protogen.model.protocol import Protocol, Sender


class _Kept(msgspec.Struct, frozen=True):
    """A protocol, and the text of each file that it was compiled from."""

    protocol: Protocol
    texts: dict[str, str]

    @property
    def is_current(self) -> bool:
        """True if the files hold the same as then."""
        return all(_holds(file, text) for file, text in self.texts.items())


_KEPT: dict[tuple[str, str], _Kept] = {}
"""By working directory, from which files are named, and path; the oldest ones in front."""
_MOST = 16


def protocol_of(protocol: Protocol | str | os.PathLike[str]) -> Protocol:
    """The resolved protocol.

    A name, as `rflex`, stands for the schema `rflex.yaml` of the project around the working
    directory, or in the folder `schemas`, or here. Raises CaptureError where there is none, and
    SchemaError where it has errors.
    """
    if isinstance(protocol, Protocol):
        return protocol
    path = _found(Path(protocol))
    key = str(Path.cwd()), str(path)
    kept = _KEPT.get(key)
    if kept is None or not kept.is_current:
        kept = _compiled(path)
        _KEPT.pop(key, None)
        _KEPT[key] = kept
        for oldest in list(_KEPT)[:-_MOST]:
            _KEPT.pop(oldest, None)  # Another thread may have done so.
    return kept.protocol


def sender_of(protocol: Protocol, name: str) -> Sender:
    """Sender of the bytes. Raises CaptureError that lists who sends."""
    try:
        return protocol.sender(name)
    except KeyError:
        names = " and ".join(item.name for item in protocol.senders)
        raise CaptureError(f"{name!r} sends nothing in {protocol.name}; {names} do") from None


def _compiled(path: Path) -> _Kept:
    from protogen.api import SchemaError
    from protogen.compiler import compile_file

    done = compile_file(path)
    if done.protocol is None:
        raise SchemaError(done.problems, done.sources)
    texts = {file: done.sources.text(file) or "" for file in done.sources.files}
    return _Kept(done.protocol, texts)


def _holds(file: str, text: str) -> bool:
    try:
        return Path(file).is_file() and Path(file).read_bytes().decode("utf-8-sig") == text
    except (OSError, ValueError):
        return False


def _found(path: Path) -> Path:
    if path.is_file():
        return path
    if path.suffix or len(path.parts) > 1:
        raise CaptureError(f"there is no schema {str(path)!r}")
    every = _schemas()
    for schema in every:
        if schema.stem == path.name:
            return schema
    names = ", ".join(dict.fromkeys(schema.stem for schema in every))
    hint = f"there are {names}" if every else "give the path of its YAML file"
    raise CaptureError(f"there is no schema {path.name!r} here; {hint}")


def _schemas() -> list[Path]:
    from protogen.problems import Problems, SourceMap
    from protogen.project.find import find_project
    from protogen.project.read import read_project
    from protogen.schema.files import NoSchemaError, schema_files

    file = find_project()
    project = None if file is None else read_project(file, Problems(), SourceMap())
    if project is None:
        places = [Path("schemas"), *sorted(Path().glob("*.yaml"))]
    else:
        places = [project.folder / name for name in project.settings.schemas]
    try:
        return list(schema_files(place for place in places if place.exists()))
    except NoSchemaError:
        return []
