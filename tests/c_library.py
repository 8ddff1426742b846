"""Generated C, compiled into a shared library and called through ctypes."""

from __future__ import annotations

import ctypes
import subprocess
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

from c_structs import Values, fill, read, structure_of
from program_store import kept
from tooling import require_tool

from protogen.model.messages import Message
from protogen.model.protocol import Protocol
from protogen.targets.c.emit import texts, unit_of
from protogen.targets.c.module import Module
from protogen.targets.c.options import COptions
from protogen.targets.c.payload.messages import MessageView
from protogen.targets.c.protocol_names import is_stateless, writer_parameter

OK, SIZE, VALUE, ENCODING, RANGE, SPACE = range(6)
RESULTS = {"size": SIZE, "value": VALUE, "encoding": ENCODING}
"""Reasons of the Python runtime as the results of C."""

FLAGS = (
    "-std=c99",
    "-Wall",
    "-Wextra",
    "-Wpedantic",
    "-Wconversion",
    "-Wsign-conversion",
    "-Wshadow",
    "-Werror",
)
_GUARD = 0xA5
_GUARDS = 16
"""Bytes around each buffer, which nothing may change."""

_SHIM = """#include "{file}.c"

struct {name}_writer {{
    uint8_t **next;
}};

typedef void (*{name}_put)(void *user, uint8_t byte);

void {name}_write({writer}, uint8_t byte) {{
    {take};
}}
"""
_PUT = """
size_t shim_{prefix}_put({parameter}uint8_t *bytes) {{
    uint8_t *next = bytes;
    struct {name}_writer writer = {{&next}};
    {put}({writing});
    return (size_t)(next - bytes);
}}
"""
_CHECK = """
enum {name}_result shim_{prefix}_check({arguments}) {{
    return {check}({given});
}}
"""


def write_sources(protocol: Protocol, folder: Path, *, payloads_only: bool = False) -> str:
    """Write the header and the source of a protocol, perhaps without its frames and decoders.

    Returns the name of the files, but for its end.
    """
    header, source = texts(protocol, COptions(), payloads_only=payloads_only)
    name = unit_of(protocol, COptions()).module.file
    (folder / f"{name}.h").write_text(header, encoding="utf-8")
    (folder / f"{name}.c").write_text(source, encoding="utf-8")
    return name


def shim_of(protocol: Protocol, module: Module) -> str:
    """A source that includes the generated one and makes its static functions callable."""
    stateless = is_stateless(protocol)
    next_ = f"((struct {module.name}_writer *)user)->next" if stateless else "writer->next"
    take = f"{'(void)put; ' if stateless else ''}*(*{next_})++ = byte"
    head = {
        "name": module.name,
        "file": module.file,
        "writer": writer_parameter(protocol),
        "take": take,
    }
    parts = [_SHIM.format(**head), *module.sinks]
    for message in module.messages:
        given = {
            "name": module.name,
            "prefix": message.name,
            "parameter": f"const {message.struct} *message, " if message.struct else "",
            "put": message.put,
            "check": message.check,
            "writing": ", ".join(
                [
                    *(["message"] if message.struct else []),
                    *(["NULL"] if stateless else []),
                    "&writer",
                ]
            ),
        }
        parts += [message.put_function, _PUT.format(**given)]
        parts += [_check_of(module, message)] if message.checks else []
    return "\n".join(parts)


def _check_of(module: Module, message: MessageView) -> str:
    arguments = ["const uint8_t *payload", "size_t size", "size_t *need"]
    arguments += [f"{number.type} {number.name}" for number in message.held]
    given = ["payload", "size", "need", *(number.name for number in message.held)]
    return _CHECK.format(
        name=module.name,
        prefix=message.name,
        check=message.check,
        arguments=", ".join(arguments),
        given=", ".join(given),
    )


def held_of(message: Message, values: Mapping[str, Any]) -> dict[str, int]:
    """The fields among values that are numbers of the frame."""
    return {field.name: int(values[field.name]) for field in message.held}


@dataclass(frozen=True)
class Encoded:
    """Outcome of encoding; `intact`: nothing was written where nothing may be."""

    result: int
    payload: bytes
    intact: bool


@dataclass(frozen=True)
class Decoded:
    """Outcome of decoding; `intact`: the struct was left as it was."""

    result: int
    values: Values | None
    intact: bool


class CLibrary:
    """The codec of a protocol, in C."""

    def __init__(self, protocol: Protocol, flags: Sequence[str] = ("-O1",)) -> None:
        self.protocol = protocol
        self.module = unit_of(protocol, COptions()).module
        self._folder = TemporaryDirectory(prefix="protogen-c-")
        folder = Path(self._folder.name)
        write_sources(protocol, folder, payloads_only=True)
        shim = folder / f"{protocol.name}_shim.c"
        shim.write_text(shim_of(protocol, self.module), encoding="utf-8")
        command = [require_tool("cc"), *FLAGS, *flags, "-fPIC", "-shared"]
        sources = sorted(folder.iterdir())
        library = kept(command, sources, lambda: _compiled(command, shim))
        self._library = ctypes.CDLL(str(library))
        self._codecs = {m.name: _Codec(self._library, m, self._view(m)) for m in protocol.messages}

    def _view(self, message: Message) -> MessageView:
        return self.module.message(message.name)

    def __getitem__(self, message: str) -> _Codec:
        return self._codecs[message]


def _compiled(command: Sequence[str], source: Path) -> Path:
    library = source.with_suffix(".so")
    done = subprocess.run(
        [*command, "-o", library, source], capture_output=True, text=True, check=False
    )
    assert done.returncode == 0, done.stderr
    return library


class _Codec:
    """The functions of one message."""

    def __init__(self, library: ctypes.CDLL, message: Message, view: MessageView) -> None:
        self._message = message
        self.view = view
        self.structure = structure_of(message.fields)
        self._encode = getattr(library, view.encode)
        self._decode = getattr(library, view.decode)
        self._put = getattr(library, f"shim_{view.name}_put")
        self._put.restype = ctypes.c_size_t
        self._check = getattr(library, f"shim_{view.name}_check") if view.checks else None

    def record(self, values: Values) -> Any:
        """The struct that has these values. Raises Unfit."""
        record = self.structure()
        fill(record, self._message.fields, values, {})
        return record

    def encode(self, values: Values, capacity: int | None = None) -> Encoded:
        """Encode into a buffer of so many bytes; None: as many as any payload needs."""
        return self.encode_record(self.record(values), capacity)

    def encode_record(self, record: Any, capacity: int | None = None) -> Encoded:
        """Encode a struct."""
        room = self.view.greatest if capacity is None else capacity
        buffer = (ctypes.c_uint8 * (room + 2 * _GUARDS))(*[_GUARD] * (room + 2 * _GUARDS))
        size = ctypes.c_size_t(12345)
        payload = ctypes.byref(buffer, _GUARDS)
        result = self._encode(
            *self._given(record), payload, ctypes.c_size_t(room), ctypes.byref(size)
        )
        written = size.value if result == OK else 0
        around = bytes(buffer[:_GUARDS]) + bytes(buffer[_GUARDS + written :])
        intact = set(around) == {_GUARD} and (result == OK or size.value == 12345)
        return Encoded(result, bytes(buffer[_GUARDS : _GUARDS + written]), intact)

    def put(self, values: Values) -> bytes:
        """The bytes that a writer is given."""
        buffer = (ctypes.c_uint8 * (self.view.greatest + 1))()
        size = self._put(*self._given(self.record(values)), buffer)
        return bytes(buffer[:size])

    def decode(self, payload: bytes, held: Mapping[str, int]) -> Decoded:
        """Decode a payload; `held` are the fields that are numbers of the frame."""
        record = self.structure()
        before = bytes([_GUARD]) * ctypes.sizeof(record)
        ctypes.memmove(ctypes.byref(record), before, len(before))
        given = (ctypes.c_uint8 * max(1, len(payload)))(*payload)
        size = ctypes.c_size_t(len(payload))
        message = self._given(record)
        result = self._decode(*message, given, size, *self._arguments(held))
        intact = bytes(record) == before
        values = read(record, self._message.fields, {}) if result == OK else None
        return Decoded(result, values, intact)

    def _given(self, record: Any) -> list[Any]:
        """The message as an argument, where it has a struct."""
        return [ctypes.byref(record)] if self.view.struct else []

    def _arguments(self, held: Mapping[str, int]) -> list[Any]:
        """The numbers of the frame as further arguments."""
        return [
            getattr(ctypes, f"c_{number.type.removesuffix('_t')}")(held[number.field])
            for number in self.view.held
        ]

    def check(self, start: bytes, held: Mapping[str, int]) -> tuple[int, int]:
        """The result of `check` for the start of a payload, and how many bytes it needs."""
        assert self._check is not None
        given = (ctypes.c_uint8 * max(1, len(start)))(*start)
        need = ctypes.c_size_t(0)
        size, held_ = ctypes.c_size_t(len(start)), self._arguments(held)
        result = self._check(given, size, ctypes.byref(need), *held_)
        return result, need.value
