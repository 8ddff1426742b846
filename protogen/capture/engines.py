"""What fills tables: generated C where there is a compiler, else the Python decoder."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Literal, Protocol

from protogen.capture.errors import CaptureError
from protogen.capture.layout import capture_schema
from protogen.capture.pure import PythonEngine
from protogen.capture.tables import Tables
from protogen.model.protocol import Protocol as Model
from protogen.model.protocol import Sender

EngineName = Literal["native", "python"]


class Engine(Protocol):
    """A stream that becomes tables."""

    def feed(self, data: bytes | memoryview) -> Iterator[Tables]:
        """Take the next bytes: the tables of a stretch of the stream, or of several."""

    def flush(self) -> Iterator[Tables]:
        """Take the end of the stream."""


def engine_of(protocol: Model, sender: Sender, name: EngineName | None) -> Engine:
    """The engine of that name; None: the fastest one that there is.

    Raises CaptureError if there is no such engine, or it can't be had.
    """
    if name not in (None, "native", "python"):
        raise CaptureError(f"there is no engine {name!r}; there are native and python")
    return _python(protocol, sender)


def _python(protocol: Model, sender: Sender) -> PythonEngine:
    from protogen.runtime.decoder import Decoder
    from protogen.targets.python.live import module_of

    spec = module_of(protocol).PROTOCOL.sender(sender.name)
    return PythonEngine(capture_schema(protocol, sender), Decoder(spec))
