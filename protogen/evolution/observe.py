"""Observation of a frame by a receiver: which message it sees, and what each field means."""

from __future__ import annotations

from collections import ChainMap
from collections.abc import Hashable, Iterator, Mapping
from contextlib import suppress
from functools import cached_property
from types import ModuleType
from typing import Any

import msgspec

from protogen.evolution.quantities import quantity
from protogen.fuzzing.engine import Refused
from protogen.fuzzing.python_engine import PythonEngine
from protogen.fuzzing.samples import Values
from protogen.live.codec import kept_module
from protogen.model.payload_builder import plan_of
from protogen.model.protocol import Protocol
from protogen.model.reading.dissect import Cursor, Row, dissect
from protogen.model.reading.readings import physical, value_name
from protogen.model.reading.wire import plain
from protogen.model.types import Field, NumberType
from protogen.runtime.attributes import arguments
from protogen.runtime.decoder import Decoder
from protogen.runtime.framing.extraction import payload_of
from protogen.runtime.values import as_dict


class Contents(msgspec.Struct, frozen=True, dict=True):
    """Content of a payload."""

    fields: tuple[Field, ...] = ()
    payload: bytes = b""
    sent: int | None = None
    """Bytes of it that were in the frame, where zeros at its end were left out."""
    numbers: tuple[tuple[str, int], ...] = ()
    """Those of the frame that are fields, by the names of their parts."""

    @cached_property
    def filled(self) -> frozenset[str]:
        """Paths of what was not in the frame: zeros, as an older sender may never have had it."""
        sent = len(self.payload) if self.sent is None else self.sent
        return frozenset(row.path for row in self._rows if row.offset >= sent)

    @cached_property
    def _rows(self) -> list[Row]:
        cursor = Cursor(plain(self.payload), 0)
        found = dissect(plan_of(self.fields), cursor, dict(self.numbers))
        return [row for row in found if row.value_type is not None]

    @cached_property
    def values(self) -> Mapping[str, str]:
        """Each number and text by its path, in words: `1280 (50.75 deg)`."""
        return {row.path: _words(row) for row in self._rows}

    @cached_property
    def raw(self) -> Mapping[str, int]:
        """The integers, as they are on the wire."""
        return {row.path: row.value for row in self._rows if isinstance(row.value, int)}

    @cached_property
    def meanings(self) -> Mapping[str, Hashable]:
        """Meaning of the values, the same for the same meaning in other words."""
        return {row.path: _meaning(row) for row in self._rows}


class Reading(msgspec.Struct, frozen=True):
    """Observation by a receiver."""

    message: str | None
    """None where it sees none."""
    why: str = ""
    """Reason why there is none."""
    contents: Contents = Contents()
    parts: Mapping[str, str] = msgspec.field(default_factory=dict)
    """Values that the sender chose in the frame itself."""

    @property
    def values(self) -> Mapping[str, str]:
        """Each number and text by its path, in words: `1280 (50.75 deg)`."""
        return ChainMap(dict(self.contents.values), dict(self.parts))

    @property
    def raw(self) -> Mapping[str, int]:
        """The integers among the fields, as they are on the wire."""
        return self.contents.raw

    @property
    def meanings(self) -> Mapping[str, Hashable]:
        """Their meaning, the same for the same meaning in other words: 0.0 is 0, 1 m is 100 cm."""
        return {**self.parts, **self.contents.meanings}


class Side:
    """One version of a protocol, with the codec that would be generated for it."""

    def __init__(self, protocol: Protocol) -> None:
        self.protocol = protocol
        self._decoders: dict[str, Decoder[Any, Any]] = {}

    @cached_property
    def _module(self) -> ModuleType:
        return kept_module(self.protocol)

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

    def _decoder(self, sender: str) -> Decoder[Any, Any]:
        """Receiver that takes one frame after the other, each with an end of input behind it.

        It takes all forms of an endpoint's frames.
        """
        if sender not in self._decoders:
            self._decoders[sender] = Decoder(self._codec.forms(sender))
        return self._decoders[sender]

    def _understood(self, sender: str, told: Mapping[str, int]) -> dict[str, int]:
        """What this version's receivers can be told, in which it may differ from the other."""
        parts = {part.name for form in self.protocol.forms(sender) for part in form.frame.told}
        return {name: value for name, value in told.items() if name in parts}

    def reads(
        self,
        sender: str,
        frame: bytes,
        like: Reading | None = None,
        told: Mapping[str, int] | None = None,
    ) -> Reading:
        """Observe a frame that stands alone, by a receiver that was `told` what is not sent.

        `like` is what another receiver made of it. Most messages of two versions are the same, and
        then so is what is in them.
        """
        decoder = self._decoder(sender)
        for name, value in self._understood(sender, told or {}).items():
            with suppress(ValueError):  # It takes no such frame.
                decoder.tell(**arguments({name: []}))
                decoder.tell(**arguments({name: value}))
        events = [*decoder.feed(frame), *decoder.flush()]
        found = [event for event in events if event.kind == "message"]
        if not found:
            return Reading(None, _why(events))
        event = found[0]
        name = event.message.NAME
        sent = len(payload_of(event.codec, event.raw))
        numbers = event.message.__holds__().items()
        contents = Contents(self.protocol.message(name).fields, event.payload, sent, (*numbers,))
        if like is not None and like.contents == contents:
            contents = like.contents
        parts = {f"frame.{part}": str(value) for part, value in as_dict(event.parts).items()}
        return Reading(name, "", contents, parts)


def _meaning(row: Row) -> Hashable:
    """A value as programs see it: the number, its names, and the quantity."""
    if row.value is None:
        return row.bytes
    if not isinstance(row.subject, Field) or isinstance(row.value, str):
        return row.value
    plain = str(row.value) if row.value != row.value else row.value  # Not a number is no other.
    if isinstance(row.value, float) or not isinstance(row.value_type, NumberType):
        return plain, quantity(row.subject, row.value)
    names = frozenset(_names(row.subject, row.value_type, row.value))
    return plain, None if _is_special(row) else quantity(row.subject, row.value), names


def _is_special(row: Row) -> bool:
    """True if the value has a name of its own, and so is no quantity."""
    return isinstance(row.subject, Field) and row.value in {v.value for v in row.subject.special}


def _names(field: Field, kind: NumberType, raw: int) -> Iterator[str]:
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
