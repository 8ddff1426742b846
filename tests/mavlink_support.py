"""What pymavlink has of MAVLink, and what comes of it by `protogen import mavlink`.

The definitions are read where they lie, in the installed package, which has them once for MAVLink 1
and once for 2. For each there is a module that mavgen made, by others.
"""

from __future__ import annotations

from collections.abc import Iterator
from functools import cache
from importlib.metadata import version
from importlib.util import find_spec
from pathlib import Path
from tempfile import TemporaryDirectory
from types import ModuleType
from typing import Any

from cli_support import run
from library_support import peer_module
from tooling import require_module

from protogen.compiler import compile_file
from protogen.fuzzing.python_engine import PythonEngine
from protogen.fuzzing.trips import Case, cases
from protogen.importing.names import snake_case
from protogen.live.codec import module_of
from protogen.model.protocol import Protocol

FOLDERS = {"1": "v10", "2": "v20"}
"""Where the package has the definitions, by the version of the protocol."""
TESTED = "2.4.50"
"""Version of the package whose definitions were looked at; others have more messages."""
KEY = bytes(range(32))
TIME = 123_456_789
LINK = 7


def definitions(wire: str) -> Path:
    """The folder of the package's definitions."""
    require_module("pymavlink")
    return _folder(wire)


def _folder(wire: str) -> Path:
    spec = find_spec("pymavlink")
    assert spec is not None and spec.origin is not None
    return Path(spec.origin).parent / "dialects" / FOLDERS[wire]


def dialects() -> list[str]:
    """Names of the package's dialects; of none that is not installed."""
    if find_spec("pymavlink") is None:
        return []
    return sorted(file.stem for file in _folder("2").glob("*.xml"))


def is_tested_version() -> bool:
    return version("pymavlink") == TESTED


def schema_name(dialect: str) -> str:
    return snake_case(dialect)


@cache
def imported(wire: str) -> tuple[Path, str]:
    """The folder of the schemas of all dialects, and what the command prints."""
    folder = TemporaryDirectory()
    FOLDERS_IN_USE.append(folder)
    done = run("import", "mavlink", str(definitions(wire)), "-o", folder.name, "--wire", wire)
    assert done.exit_code == 0, done.output
    return Path(folder.name), done.output


FOLDERS_IN_USE: list[TemporaryDirectory[str]] = []
"""They go with the process."""


@cache
def protocol_of(dialect: str, wire: str) -> Protocol:
    compilation = compile_file(imported(wire)[0] / f"{schema_name(dialect)}.yaml")
    assert compilation.protocol is not None, compilation.problems
    return compilation.protocol


@cache
def engine_of(dialect: str, wire: str) -> PythonEngine:
    """The codec of a dialect that is generated from its schema."""
    return PythonEngine(module_of(protocol_of(dialect, wire)).PROTOCOL)


class Mavgen:
    """What mavgen made of a dialect."""

    def __init__(self, dialect: str, wire: str) -> None:
        self.module: ModuleType = peer_module(f"pymavlink.dialects.{FOLDERS[wire]}.{dialect}")
        self.kinds: dict[str, Any] = {
            kind.msgname: kind for kind in self.module.mavlink_map.values()
        }

    def frame(self, title: str, case: Case) -> bytes:
        """The frame of a case. Parts of a signature follow from the key."""
        link = self.link(is_signed="signature" in case.parts)
        link.seq, link.srcSystem, link.srcComponent = (
            case.parts[name] for name in ("seq", "sysid", "compid")
        )
        made: bytes = self.kinds[title](**self._theirs(title, case)).pack(link)
        return made

    def link(self, *, is_signed: bool) -> Any:
        """One that sends and receives."""
        link = self.module.MAVLink(None)
        if is_signed:
            link.signing.secret_key = KEY
            link.signing.sign_outgoing = True
            link.signing.timestamp = TIME
            link.signing.link_id = LINK
        return link

    def read(self, title: str, frame: bytes, *, is_signed: bool) -> list[str]:
        """The values that it reads in a frame."""
        link = self.link(is_signed=is_signed)
        link.signing.timestamp = 0
        (message,) = link.parse_buffer(bytearray(frame))
        assert message.get_type() == title
        assert message.get_signed() == is_signed
        return held(message)

    def values(self, title: str, case: Case) -> list[str]:
        """The values of a case as it holds them."""
        return held(self.kinds[title](**self._theirs(title, case)))

    def _theirs(self, title: str, case: Case) -> dict[str, Any]:
        """The values under its names: both have the fields in wire order."""
        kind = self.kinds[title]
        types = dict(zip(kind.fieldnames, kind.fieldtypes, strict=True))
        names = zip(kind.ordered_fieldnames, case.values.values(), strict=True)
        return {name: as_theirs(value, types[name]) for name, value in names}

    def found(self, data: bytes) -> Iterator[bytes]:
        """The frames that it finds in a stream."""
        link = self.link(is_signed=False)
        link.robust_parsing = True
        for message in link.parse_buffer(bytearray(data)) or ():
            if message.get_type() not in ("BAD_DATA",) and message.get_msgId() >= 0:
                yield bytes(message.get_msgbuf())


def held(message: Any) -> list[str]:
    """The values that one of its messages holds, in wire order; NaN is like another one."""
    values: list[str] = []
    for name in message.ordered_fieldnames:
        raw = getattr(message, f"_{name}_raw", None)
        value = getattr(message, name) if raw is None else raw.rstrip(b"\0")
        values.append(repr(value))
    return values


def as_theirs(value: Any, kind: str) -> Any:
    """A value of JSON lines as it has it."""
    if isinstance(value, list):
        return [as_theirs(item, kind) for item in value]
    if kind in ("float", "double"):
        return float(value)
    if kind == "char":
        return bytes([value]) if isinstance(value, int) else value.encode("latin-1")
    return value


def drawn(dialect: str, wire: str, count: int = 10) -> Iterator[tuple[str, Case]]:
    """Values of all messages, boundaries and random ones, with their names in the definitions."""
    protocol = protocol_of(dialect, wire)
    titles = {message.name: message.title for message in protocol.messages}
    for case in cases(protocol, count, seed=1):
        yield titles[case.message], sent_by_mavgen(case)


def sent_by_mavgen(case: Case) -> Case:
    """A case with what its encoder does not let its caller choose."""
    fixed = {"compat_flags": 0, "link_id": LINK, "timestamp": TIME}
    parts = {name: fixed.get(name, value) for name, value in case.parts.items()}
    return Case(case.sender, case.message, case.values, parts)
