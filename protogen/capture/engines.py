"""Engines that fill tables: generated C where there is a compiler, else Python."""

from __future__ import annotations

import warnings
from collections import deque
from collections.abc import Callable, Iterator
from functools import partial
from typing import Any, Literal, Protocol

from protogen.capture.errors import CaptureError, NoSilenceWarning, SlowCaptureWarning
from protogen.capture.layout import capture_schema
from protogen.capture.pure import PythonEngine, Reading
from protogen.capture.tables import Tables
from protogen.model.protocol import Protocol as Model
from protogen.model.protocol import Sender

EngineName = Literal["native", "python"]


class Engine(Protocol):
    """A stream that becomes tables."""

    def start(self, offset: int) -> None:
        """Begin a stream at this byte of the capture."""

    def feed(self, data: bytes | memoryview) -> Iterator[Tables]:
        """Take the next bytes: the tables of a stretch of the stream, or of several."""

    def flush(self) -> Iterator[Tables]:
        """Take the end of the stream."""


Maker = Callable[..., Any]
"""Makes an `Engine`; a native one can do what reading in parts needs, too, and takes `memory`."""


def makers(protocol: Model, sender: Sender, name: EngineName | None) -> tuple[Maker, bool]:
    """Maker of engines of that name, and whether several can read parts of a capture at once.

    Without a name they are the fastest that there are. Raises CaptureError if there is no such
    engine, or it can't be had.
    """
    if name not in (None, "native", "python"):
        raise CaptureError(f"there is no engine {name!r}; there are native and python")
    if sender.frame.told:
        parts = " and ".join(part.name for part in sender.frame.told)
        raise CaptureError(
            f"frames of {sender.name} do not say what they are: a decoder is told {parts}, and "
            "tables are not; decode the bytes of both ends instead"
        )
    if sender.plan.ends_idle:
        text = f"only a silence ends a frame of {sender.name}, and a capture without times has one"
        _warn(NoSilenceWarning, f"{text}: at its end, in front of which one frame is found at most")
    if name != "python":
        from protogen.capture.memory import KEPT, Memory
        from protogen.capture.native import NativeEngine, library_of
        from protogen.native.errors import NativeError

        try:
            library = library_of(protocol, sender)
            return partial(NativeEngine, library, memory=Memory(KEPT)), True
        except NativeError as error:
            if name == "native":
                raise CaptureError(f"no native engine: {error}") from None
            text = "columns are filled from Python's events, hundreds of times slower than by C"
            _warn(SlowCaptureWarning, f"{text}: {error}")
    return partial(_python, protocol, sender), False


_warned: set[str] = set()
_STACK = 6
"""The warning is about the line that calls `columns` or goes through `batches`: behind this one are
`makers`, the context manager of `read.py`, the library's, and `columns` or `batches`."""


def _warn(kind: type[UserWarning], text: str) -> None:
    """Say once what is slow, or what a capture can't show."""
    if text not in _warned:
        _warned.add(text)
        warnings.warn(text, kind, stacklevel=_STACK)


def reading_of(protocol: Model, sender: Sender) -> Reading:
    """Schema and specification by which Python reads the bytes of `sender`."""
    for model, name, found in _READINGS:
        if model is protocol and name == sender.name:
            return found
    from protogen.live.codec import module_of

    schema = capture_schema(protocol, sender)
    spec = module_of(protocol).PROTOCOL.sender(sender.name)
    found = Reading(schema, spec)
    _READINGS.append((protocol, sender.name, found))
    return found


_READINGS: deque[tuple[Model, str, Reading]] = deque(maxlen=16)
"""Those that were used last."""


def _python(protocol: Model, sender: Sender) -> PythonEngine:
    return PythonEngine(reading_of(protocol, sender))
