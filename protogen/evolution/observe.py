"""What a receiver makes of a frame: which message it sees, and what each field means."""

from __future__ import annotations

from collections import ChainMap
from collections.abc import Hashable, Iterator, Mapping
from dataclasses import asdict, dataclass, field
from functools import cached_property
from types import ModuleType
from typing import Any

from protogen.evolution.quantities import quantity
from protogen.fuzzing.engine import Refused
from protogen.fuzzing.python_engine import PythonEngine
from protogen.fuzzing.samples import Values
from protogen.model.dissect import Cursor, Row, dissect
from protogen.model.fields import Field
from protogen.model.messages import Message
from protogen.model.protocol import Protocol
from protogen.model.readings import physical, value_name
from protogen.model.types import Integer
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
    meanings: Mapping[str, Hashable] = field(default_factory=dict)
    """What they mean, the same for the same meaning in other words: 0.0 is 0, and 1 m is 100 cm."""


class Side:
    """One version of a protocol, with the codec that would be generated for it."""

    def __init__(self, protocol: Protocol) -> None:
        self.protocol = protocol

    @cached_property
    def _module(self) -> ModuleType:
        return module_of(self.protocol)

    @property
    def _codec(self) -> Any:
        return self._module.PROTOCOL

    @cached_property
    def _engine(self) -> PythonEngine:
        return PythonEngine(self._codec, self._module.encode)

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
        meanings = {row.path: _meaning(row) for row in rows}
        return Reading(name, "", ChainMap(values, parts), raw, ChainMap(meanings, {**parts}))


def _rows(message: Message, payload: bytes) -> list[Row]:
    """The values of a payload."""
    units = tuple(Unit(byte, bytes((byte,))) for byte in payload)
    return [row for row in dissect(message.fields, Cursor(units, 0)) if row.value_type is not None]


def _meaning(row: Row) -> Hashable:
    """What programs get to see of a value: the number, its names, and the quantity."""
    if row.value is None:
        return row.bytes
    if not isinstance(row.subject, Field) or isinstance(row.value, str):
        return row.value
    plain = str(row.value) if row.value != row.value else row.value  # Not a number is no other.
    if isinstance(row.value, float) or not isinstance(row.value_type, Integer):
        return plain, quantity(row.subject, row.value)
    names = frozenset(_names(row.subject, row.value_type, row.value))
    return plain, None if _is_special(row) else quantity(row.subject, row.value), names


def _is_special(row: Row) -> bool:
    """Whether the value has a name of its own, and so is no quantity."""
    return isinstance(row.subject, Field) and row.value in {v.value for v in row.subject.special}


def _names(field: Field, kind: Integer, raw: int) -> Iterator[str]:
    """The names of the value, of bits that are set, and of runs that are not 0."""
    name = value_name(field, kind, raw)
    if name is not None:
        yield name
    if kind.flags is not None:
        yield from (flag.name for flag in kind.flags.bits if raw >> flag.bit & 1)
    for run in kind.bit_fields:
        number = (raw & run.mask) >> run.low
        values = () if run.enum is None else run.enum.values
        named = next((item.name for item in values if item.value == number), None)
        if number or named:
            yield f"{run.name}={named or number}" if named or number > 1 else run.name


def _words(row: Row) -> str:
    value = row.bytes.hex(" ").upper() if row.value is None else str(row.value)
    found = [row.meaning] if row.meaning and row.meaning != value else []
    field, raw = row.subject, row.value
    if isinstance(field, Field) and isinstance(raw, int | float) and not _is_special(row):
        shown = physical(field, raw, " ") if field.scaled or field.unit else ""
        found += [shown] if shown and shown not in found else []
    return f"{value} ({', '.join(found)})" if found else value


def _why(events: list[Any]) -> str:
    for event in events:
        if event.kind == "invalid":
            return str(event.reason)
        if event.kind == "unknown":
            return "unknown"
    return "nothing"
