"""Reads the vectors of this folder. Needs PyYAML and nothing of protogen.

A file has the `schema` that it is about, `vectors` and `streams`. A vector is one frame with the
message, values and parts that it means; encoding these gives the frame, and decoding it gives them.
A stream is bytes and the events that a decoder cuts them into, after a flush.

Bytes are blocks of hexadecimal digits with comments; a line `repeat N: ..` stands for N times its
bytes. Values are given here as JSON lines have them: raw numbers or their names, bytes as
hexadecimal text, None for a switch case without bytes.
"""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import yaml

FOLDER = Path(__file__).resolve().parent
PROJECT = FOLDER.parent.parent

_REPEAT = re.compile(r"repeat (\d+): *(.*)")
_BYTES_KEYS = ({"hex"}, {"text"})


@dataclass(frozen=True)
class Vector:
    """One valid frame."""

    name: str
    sender: str
    message: str
    parts: Mapping[str, int]
    """Values of the frame's counters and other parts that an encoder is given."""
    values: Mapping[str, Any]
    """All fields of the message, as JSON lines have them; numbers may be named."""
    frame: bytes


@dataclass(frozen=True)
class ExpectedEvent:
    """One event of a stream. What is None is not stated; `parts` and `values` may be a choice."""

    offset: int
    size: int
    event: str
    """`message`, `unknown` or `invalid`."""
    reason: str | None = None
    message: str | None = None
    parts: Mapping[str, int] | None = None
    values: Mapping[str, Any] | None = None
    payload: bytes | None = None


@dataclass(frozen=True)
class Stream:
    """Bytes of one sender, and all events that a decoder makes of them."""

    name: str
    sender: str
    data: bytes
    events: tuple[ExpectedEvent, ...]


@dataclass(frozen=True)
class VectorFile:
    """The vectors of one schema."""

    name: str
    schema: Path
    vectors: tuple[Vector, ...]
    streams: tuple[Stream, ...]


def vector_files() -> tuple[Path, ...]:
    """All files of vectors."""
    return tuple(sorted(FOLDER.glob("*.yaml")))


def read_vectors(path: Path) -> VectorFile:
    """Read one file. Raises ValueError or KeyError where it is badly written."""
    data = yaml.load(path.read_text(encoding="utf-8"), _Loader)
    _check_keys(path.name, data, {"schema", "vectors", "streams"})
    vectors = tuple(_vector(item) for item in data["vectors"])
    streams = tuple(_stream(item) for item in data["streams"])
    _check_names(path, (*vectors, *streams))
    return VectorFile(path.stem, PROJECT / data["schema"], vectors, streams)


def to_bytes(block: str) -> bytes:
    """The bytes of a block of hexadecimal digits, comments and repetitions."""
    return b"".join(_line(line) for line in block.splitlines())


def _line(line: str) -> bytes:
    digits = line.partition("#")[0].strip()
    repeated = _REPEAT.fullmatch(digits)
    if repeated is not None:
        return int(repeated[1]) * bytes.fromhex(repeated[2])
    return bytes.fromhex(digits)


def _vector(item: Mapping[str, Any]) -> Vector:
    _check_keys(item["name"], item, {"name", "sender", "message", "parts", "values", "frame"})
    return Vector(
        item["name"],
        item["sender"],
        item["message"],
        item.get("parts", {}),
        {name: _value(value) for name, value in item.get("values", {}).items()},
        to_bytes(item["frame"]),
    )


def _stream(item: Mapping[str, Any]) -> Stream:
    _check_keys(item["name"], item, {"name", "sender", "bytes", "events"})
    data = to_bytes(item["bytes"])
    events = tuple(_event(item["name"], event) for event in item["events"])
    _check_cover(item["name"], len(data), events)
    return Stream(item["name"], item["sender"], data, events)


def _event(stream: str, item: Mapping[str, Any]) -> ExpectedEvent:
    _check_keys(stream, item, set(ExpectedEvent.__dataclass_fields__))
    more = dict(item)
    if "values" in more:
        more["values"] = {name: _value(value) for name, value in more["values"].items()}
    if "payload" in more:
        more["payload"] = bytes.fromhex(_value(more["payload"]))
    return ExpectedEvent(**more)


def _value(value: Any) -> Any:
    """A value as JSON lines have it: `{hex: ..}` and `{text: ..}` as digits, `{}` as None."""
    if isinstance(value, list):
        return [_value(item) for item in value]
    if not isinstance(value, dict):
        return value
    if set(value) in _BYTES_KEYS:
        return _octets(value).hex()
    return {name: _value(item) for name, item in value.items()} or None


def _octets(value: Mapping[str, Any]) -> bytes:
    form, written = next(iter(value.items()))
    if not isinstance(written, str):
        raise ValueError(f"{value}: write digits that look like a number in quotes")
    return bytes.fromhex(written) if form == "hex" else written.encode("latin-1")


def _check_keys(where: str, item: Mapping[str, Any], known: set[str]) -> None:
    if not known.issuperset(item):
        raise ValueError(f"{where}: {', '.join(set(item) - known)} is not known here")


def _check_names(path: Path, items: tuple[Vector | Stream, ...]) -> None:
    names = [(type(item), item.name) for item in items]
    for name in names:
        if names.count(name) > 1:
            raise ValueError(f"{path.name}: there are two {name[1]}")


def _check_cover(where: str, size: int, events: tuple[ExpectedEvent, ...]) -> None:
    """The events follow each other without a gap, and cover all bytes."""
    ends = [0, *(event.offset + event.size for event in events)]
    if [event.offset for event in events] != ends[:-1] or ends[-1] != size:
        raise ValueError(f"{where}: the events do not cover the {size} bytes: {ends}")


class _Loader(yaml.CSafeLoader):
    """Reads scalars as YAML 1.2 does: `on`, `off`, `yes` and `no` are texts."""


def _resolvers() -> Iterator[tuple[str, list[Any]]]:
    for first, resolvers in yaml.CSafeLoader.yaml_implicit_resolvers.items():
        yield first, [item for item in resolvers if item[0] != "tag:yaml.org,2002:bool"]


_Loader.yaml_implicit_resolvers = dict(_resolvers())
_Loader.add_implicit_resolver("tag:yaml.org,2002:bool", re.compile(r"^(true|false)$"), list("tf"))
