"""Verification that each example of a schema holds.

An example is decoded and encoded by the Python that would be generated, so there is no second
codec whose mistakes could hide in the first. What a document prints without delimiters is put into
a frame first.
"""

from __future__ import annotations

import io
from collections.abc import Mapping, Sequence
from types import ModuleType
from typing import Any

import msgspec

from protogen.live.codec import module_of
from protogen.model.frame import Frame
from protogen.model.messages import Example, Message, given_parts
from protogen.model.parts import LiteralPart, NumberPart
from protogen.model.protocol import Protocol
from protogen.passes.messages.byte_strings import with_hex_digits
from protogen.problems import Problems
from protogen.runtime.attributes import arguments
from protogen.runtime.errors import EncodeError
from protogen.runtime.events import InvalidEvent, MessageEvent, UnknownEvent
from protogen.runtime.framing.assembly import encode_frame, join_parts
from protogen.runtime.framing.extraction import payload_of
from protogen.runtime.framing.lines import split_parts
from protogen.runtime.values import as_dict

_GREATEST_SHOWN = 512
"""Bytes of the longest frame that a hint shows."""


def verify_examples(protocol: Protocol, problems: Problems) -> None:
    """Report every example that does not hold."""
    if not any(message.examples for message in protocol.messages):
        return
    module = module_of(protocol)
    for message in protocol.messages:
        for example in message.examples:
            _Verification(protocol, module, message, example, problems).run()


class _Reading(msgspec.Struct, frozen=True):
    """Result of decoding the example's frame."""

    fails: str
    """The reason, `unknown`, or nothing where it is a message."""
    event: MessageEvent[Any, Any] | None = None
    parts: Mapping[str, int | str] = {}

    @property
    def message(self) -> Any:
        """The message, if it is one."""
        return None if self.event is None else self.event.message


class _Verification:
    """One example."""

    def __init__(
        self,
        protocol: Protocol,
        module: ModuleType,
        message: Message,
        example: Example,
        problems: Problems,
    ) -> None:
        sender = protocol.sender(example.sender)
        self._frame = sender.frame
        self._form = "" if sender.is_only_form else f" in form `{sender.form}`"
        self._sender = module.PROTOCOL.sender(example.sender)
        self._class = module.MESSAGES[message.name]
        self._received_as = protocol.sender(example.sender).received_as(message.name)
        self._protocol = protocol
        self._module = module
        self._message = message
        self._example = example
        self._problems = problems
        self._chosen = [part.name for part in given_parts(self._frame, message)]
        self._reading = _Reading("")

    def run(self) -> None:
        """Decode it and encode it again."""
        wire = self._wire()
        if wire is None:
            return
        reading = self._reading = self._read(wire)
        if self._example.contradicts is not None:
            self._contradicts(reading)
            return
        if reading.fails:
            self._report("PG160", f"a decoder rejects it: {reading.fails}{self._wrong_end(wire)}")
            return
        if self._values_hold(reading, self._example.values):
            self._parts_hold(reading)
            self._encodes(reading, wire)

    def _report(self, code: str, text: str) -> None:
        where = f"`{self._example.name}` of `{self._message.name}`{self._form}"
        other = "if it is a frame of another form, say `form:`" if self._form else None
        hint = self._made_hint() or other
        self._problems.add(code, self._example.span, f"{where}: {text}", hint)

    def _made_hint(self) -> str | None:
        """The frame that the values make, to be copied; None where they make none."""
        values, numbers = self._example.values or {}, self._numbers()
        given = given_parts(self._frame, self._message)
        parts = {part.name: part.shown(numbers[part.name]) for part in given}
        if self._reading.message is not None and self._received_as == self._reading.message.NAME:
            values = {**self._reading.message.to_dict(), **values}
            parts |= {name: self._reading.parts[name] for name in self._chosen}
        stated = self._example.parts
        parts = {name: stated.get(name, parts[name]) for name in self._chosen}
        try:
            message = self._class.from_dict(with_hex_digits(self._message.fields, values))
            made = self._encoded(message, parts, strict=True)
        except ValueError:  # EncodeError is one.
            return None
        if len(made) > _GREATEST_SHOWN or self._example.contradicts is not None:
            return None
        return f"the encoder makes of its values: `frame: {{hex: {_hex(made)}}}`"

    def _wrong_end(self, wire: bytes) -> str:
        """Say what the last bytes should be; a decoder only knows that the end did not come."""
        last = self._frame.parts[-1]
        if not isinstance(last, LiteralPart) or wire.endswith(last.bytes):
            return ""
        seen = _hex(wire[-len(last.bytes) :])
        return f"; `{last.name}` must be {_hex(last.bytes)}, and the last bytes are {seen}"

    # -- bytes --------------------------------------------------------------------------------

    def _wire(self) -> bytes | None:
        """The example as a frame on the wire."""
        covers, data = self._example.covers, self._example.bytes
        if covers is None:
            return data
        pieces = _pieces(self._frame, covers, data)
        if pieces is None:
            self._report("PG162", f"{len(data)} bytes are too few for {', '.join(covers)}")
            return None
        payload = pieces.get(self._frame.payload.name, b"")
        return join_parts(self._sender, payload, self._numbers(), pieces)

    def _numbers(self) -> dict[str, int]:
        """Identity, counters and values of the parts that the example does not print."""
        parts: dict[NumberPart, int] = dict(
            zip(self._frame.identity, self._message.identity, strict=True)
        )
        for part in self._frame.caller_parts:
            parts[part] = part.default if part.default is not None else part.least
        stated = self._example.parts
        return {
            part.name: part.raw(stated[part.name]) if part.name in stated else value
            for part, value in parts.items()
        }

    def _read(self, wire: bytes) -> _Reading:
        decoder = self._module.Decoder(sender=self._sender.name)
        numbers = self._numbers()
        # What is out of bounds is said where the parts are compared.
        told = (part for part in self._frame.told_identity if part.holds(numbers[part.name]))
        decoder.tell(**arguments({part.name: numbers[part.name] for part in told}))
        layout = self._sender.layout
        for part in filter(None, (layout.told_length,)):
            value = layout.told_of(wire).get(part.name, 0)
            if layout.counted_payload(part, value) is not None:
                decoder.tell(**arguments({part.name: value}))
        events = [*decoder.feed(wire), *decoder.flush()]
        bad = next((event for event in events if isinstance(event, InvalidEvent)), None)
        if bad is not None:
            return _Reading((bad.problem and f"{bad.reason}: {bad.problem}") or bad.reason)
        if len(events) != 1:
            return _Reading(f"it is {len(events)} frames")
        event = events[0]
        if isinstance(event, UnknownEvent):
            return _Reading("unknown", parts=as_dict(event.parts))
        assert isinstance(event, MessageEvent)
        return _Reading("", event, as_dict(event.parts))

    # -- meaning ------------------------------------------------------------------------------

    def _values_hold(self, reading: _Reading, values: dict[str, Any] | None) -> bool:
        if self._received_as != reading.message.NAME:
            self._report("PG160", f"it is a `{reading.message.NAME}`")
            return False
        wrong = self._differences(reading, values)
        for text in wrong:
            self._report("PG160", text)
        return not wrong

    def _parts_hold(self, reading: _Reading) -> None:
        for name, value in self._example.parts.items():
            found = reading.parts[name]
            if found != value:
                self._report("PG160", f"`{name}` is {found}, not {value}")

    def _encodes(self, reading: _Reading, wire: bytes) -> None:
        """The values, encoded, are the example's bytes."""
        parts = {name: reading.parts[name] for name in self._chosen}
        try:
            held = self._class.__held__(reading.message.__holds__())
            message = self._class.from_payload(reading.message.to_payload(strict=False), **held)
            made = self._encoded(message, parts, strict=False)
        except EncodeError as error:
            self._report("PG161", str(error))
            return
        if made != wire and not self._is_cut(reading, message):
            self._report("PG161", f"its values encode to {_hex(made)}, not to {_hex(wire)}")

    def _is_cut(self, reading: _Reading, message: Any) -> bool:
        """True if all that the encoder leaves out is what a newer sender has behind the fields."""
        event = reading.event
        assert event is not None
        sender = event.codec
        whole = payload_of(sender, event.raw, sender.told_among(event.numbers))
        unknown = whole[len(event.payload) :]
        if not unknown:
            return False
        identity, given = split_parts(sender, reading.parts)
        carried = sender.layout.payload.trimmed(message.to_payload(strict=False) + unknown)
        return encode_frame(sender, identity, carried, given, strict=False) == event.raw

    def _encoded(self, message: Any, parts: dict[str, int | str], *, strict: bool) -> bytes:
        sender = self._sender
        form = sender.form or None
        made: bytes = self._module.PROTOCOL.encode(
            message, sender.name, strict=strict, form=form, **arguments(parts)
        )
        return made

    def _contradicts(self, reading: _Reading) -> None:
        """It fails, and in just the way that the schema says."""
        stated = self._example.contradicts
        assert stated is not None
        found = reading.fails.partition(":")[0] or "values"
        if found != stated.fails:
            text = f"it does not fail by `{stated.fails}` but by `{found}`"
            self._report("PG163", text if reading.fails else f"{text}: it decodes")
        elif found == "values":
            self._values_hold(reading, stated.reads)
            if not self._differences(reading, self._example.values):
                self._report("PG163", "its bytes mean just what the document says")

    def _differences(self, reading: _Reading, stated: Mapping[str, Any] | None) -> list[str]:
        """Statements of the example about fields that the bytes contradict."""
        fields = self._protocol.message(reading.message.NAME).fields
        found = reading.message.to_dict()
        texts = []
        for name, value in (stated or {}).items():
            if name not in found:
                texts.append(f"there is no field `{name}`")
                continue
            try:
                whole = with_hex_digits(fields, {**found, name: value})
                expected = type(reading.message).from_dict(whole).to_dict()[name]
            except ValueError as error:  # EncodeError is one.
                texts.append(f"`{name}`: {error}")
                continue
            if expected != found[name]:
                texts.append(f"`{name}` is {found[name]}, not {expected}")
        return texts


def _pieces(frame: Frame, covers: Sequence[str], data: bytes) -> dict[str, bytes] | None:
    """The printed bytes by part; None where they are too few for the parts of fixed size."""
    sizes = {name: frame.part(name).size for name in covers}
    left = len(data) - sum(sizes.values())
    if left < 0 or (left and frame.payload.name not in covers):
        return None
    stream = io.BytesIO(data)
    return {
        name: stream.read(left if name == frame.payload.name else size)
        for name, size in sizes.items()
    }


def _hex(data: bytes) -> str:
    return data.hex(" ").upper()
