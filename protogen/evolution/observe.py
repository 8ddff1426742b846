"""What a receiver makes of a frame: which message it sees, and what each field means."""

from __future__ import annotations

from collections import ChainMap
from collections.abc import Mapping
from dataclasses import asdict, dataclass, field
from functools import cached_property
from typing import Any

from protogen.fuzzing.engine import Refused
from protogen.fuzzing.python_engine import PythonEngine
from protogen.fuzzing.samples import Values
from protogen.model.dissect import Cursor, Row, dissect
from protogen.model.fields import Field
from protogen.model.messages import Message
from protogen.model.protocol import Protocol
from protogen.model.readings import physical
from protogen.model.wire import Unit
from protogen.runtime.decoder import Decoder
from protogen.targets.python.live import module_of


@dataclass(frozen=True, slots=True)
class Reading:
    """What a receiver sees."""

    message: str | None
    """None where it sees none."""
    why: str = ""
    """Why there is none."""
    values: Mapping[str, str] = field(default_factory=dict)
    """Each number and text by its path, in words: `1280 (50.75 deg)`."""
    raw: Mapping[str, int] = field(default_factory=dict)
    """The integers among them, as they are on the wire."""


class Side:
    """One version of a protocol, with the codec that would be generated for it."""

    def __init__(self, protocol: Protocol) -> None:
        self.protocol = protocol

    @cached_property
    def _codec(self) -> Any:
        return module_of(self.protocol).PROTOCOL

    @cached_property
    def _engine(self) -> PythonEngine:
        return PythonEngine(self._codec)

    def frame(self, sender: str, message: str, values: Values, parts: Values) -> bytes | None:
        """The frame of a message; None where the encoder refuses it."""
        try:
            return self._engine.frame(sender, message, values, parts)
        except (Refused, KeyError, TypeError, ValueError):
            return None  # Values of the other version may be none of this one's.

    def reads(self, sender: str, frame: bytes) -> Reading:
        """What a receiver makes of a frame that stands alone."""
        decoder = Decoder(self._codec.sender(sender))
        events = [*decoder.feed(frame), *decoder.flush()]
        found = [event for event in events if event.kind == "message"]
        if not found:
            return Reading(None, _why(events))
        event = found[0]
        name = event.message.NAME
        rows = _rows(self.protocol.message(name), event.payload)
        values = {row.path: _words(row) for row in rows}
        parts = {f"frame.{part}": str(value) for part, value in asdict(event.parts).items()}
        raw = {row.path: row.value for row in rows if isinstance(row.value, int)}
        return Reading(name, "", ChainMap(values, parts), raw)


def _rows(message: Message, payload: bytes) -> list[Row]:
    """The values of a payload."""
    units = tuple(Unit(byte, bytes((byte,))) for byte in payload)
    return [row for row in dissect(message.fields, Cursor(units, 0)) if row.value_type is not None]


def _words(row: Row) -> str:
    value = row.bytes.hex(" ").upper() if row.value is None else str(row.value)
    found = [row.meaning] if row.meaning and row.meaning != value else []
    field = row.subject
    if isinstance(field, Field) and isinstance(row.value, int | float):
        quantity = physical(field, row.value, " ") if field.scaled or field.unit else ""
        found += [quantity] if quantity and quantity not in found else []
    return f"{value} ({', '.join(found)})" if found else value


def _why(events: list[Any]) -> str:
    for event in events:
        if event.kind == "invalid":
            return str(event.reason)
        if event.kind == "unknown":
            return "unknown"
    return "nothing"
