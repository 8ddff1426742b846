"""Requests to a driver of generated C, and what its answers mean.

A call is bytes to send and a function that reads the answer, so that calls can be made one by one,
or all at once on a machine that takes a file.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from typing import Generic, Literal, TypeVar

import msgspec

from protogen.fuzzing.c_driver import DrivenDecoder, DrivenPart, Driver
from protogen.fuzzing.c_values import Answers, number, pack, unpack
from protogen.fuzzing.samples import NOTHING_HELD, Held, Values

OK, SIZE, VALUE, ENCODING, RANGE, SPACE = range(6)
"""The results of generated functions."""
REFUSED = 6
"""There is no frame: a function that makes one does not say why."""
RESULTS = {"size": SIZE, "value": VALUE, "encoding": ENCODING}
"""Reasons of the Python runtime as results."""
KINDS = ("message", "unknown", "invalid")
REASONS = (
    "",
    "size",
    "value",
    "encoding",
    "noise",
    "checksum",
    "length",
    "stuffing",
    "truncated",
)

T = TypeVar("T")


class Call(msgspec.Struct, Generic[T], frozen=True):
    """A request, and what reads its answer."""

    request: bytes
    read: Callable[[Answers], T]


class Encoded(msgspec.Struct, frozen=True):
    """Result of encoding, or of sending byte by byte."""

    result: int
    data: bytes
    intact: bool = True
    """Nothing was written outside of the buffer, and no size where there is none."""
    exact: bool = True
    """No other byte of the buffer was changed."""


class Decoded(msgspec.Struct, frozen=True):
    """Result of decoding; `intact`: where it failed, the struct was left alone."""

    result: int
    values: Values | None
    intact: bool = True


class CEvent(msgspec.Struct, frozen=True):
    """An event; what is None is not part of it, or was left out by `--events messages`."""

    kind: str
    offset: int | None = None
    size: int | None = None
    reason: str = ""
    message: str = ""
    parts: Values | None = None
    payload: bytes | None = None
    values: Values | None = None
    """Values that the message's handler was given."""
    form: str = ""
    """The form of the frame, where the decoder finds several."""


Step = tuple[Literal["feed", "push", "tell"], bytes] | tuple[Literal["flush", "clear"]]
"""A step that is done with a decoder.

`clear` gives it memory of zeros, without initialising it; `tell` takes bytes of `Calls.told`.
"""
_STEPS = {"feed": 1, "push": 2, "flush": 3, "clear": 4, "tell": 5}


class Calls:
    """The calls that a driver takes. `room`: the most bytes that can be fed at once."""

    def __init__(self, driver: Driver, room: int = 1 << 16) -> None:
        self._driver = driver
        self._room = room

    # --- payloads -------------------------------------------------------------------------------

    def encode(self, message: str, values: Values, capacity: int | None = None) -> Call[Encoded]:
        """Encode a payload. Raises Unfit where no struct can have the values."""
        index = self._driver.message(message)
        model = self._driver.messages[index].model
        room = model.sizes.greatest if capacity is None else capacity
        head = b"P" + number(index, 2) + number(room, 4)
        return Call(head + pack(model.plan, values), _read_encoded)

    def decode(self, message: str, payload: bytes, held: Held = NOTHING_HELD) -> Call[Decoded]:
        """Decode a payload; `held` are the fields that are parts of the frame."""
        index = self._driver.message(message)
        request = b"D" + number(index, 2) + number(len(payload), 4) + payload
        for item in self._driver.messages[index].held:
            request += number(int(held[item.name]), item.size)
        return Call(request, lambda answers: self._decoded(answers, index))

    def _decoded(self, answers: Answers, index: int) -> Decoded:
        result = answers.number(1)
        if result != OK:
            return Decoded(result, None, bool(answers.number(1)))
        return Decoded(result, unpack(self._driver.messages[index].model.plan, answers))

    # --- frames ---------------------------------------------------------------------------------

    def frame(
        self,
        sender: str,
        message: str,
        values: Values,
        parts: Mapping[str, int | str],
        capacity: int | None = None,
    ) -> Call[Encoded]:
        """Make a frame; raises Unfit."""
        frame = self._driver.frame(sender, message)
        room = frame.room if capacity is None else capacity
        head = b"F" + number(frame.index, 2) + number(room, 4)
        return Call(head + self._content(frame.parts, message, values, parts), _read_encoded)

    def sends(self, sender: str, message: str) -> bool:
        """True if the message can be sent byte by byte."""
        return bool(self._driver.frame(sender, message).send)

    def send(
        self, sender: str, message: str, values: Values, parts: Mapping[str, int | str]
    ) -> Call[Encoded]:
        """Send a frame byte by byte; raises Unfit."""
        frame = self._driver.frame(sender, message)
        head = b"S" + number(frame.index, 2)
        return Call(head + self._content(frame.parts, message, values, parts), _read_sent)

    def _content(
        self,
        taken: Iterable[DrivenPart],
        message: str,
        values: Values,
        parts: Mapping[str, int | str],
    ) -> bytes:
        numbers = [number(part.part.raw(parts[part.name]), part.size) for part in taken]
        model = self._driver.messages[self._driver.message(message)].model
        return b"".join(numbers) + pack(model.plan, values)

    # --- events ---------------------------------------------------------------------------------

    def events(self, sender: str, steps: Iterable[Step]) -> Call[list[list[CEvent]]]:
        """Take a new decoder through some steps; the events of each of them."""
        decoder = self._driver.decoder(sender)
        request = [b"X", number(decoder.index, 1)]
        counts = []
        for step in steps:
            portions = [b""] if len(step) == 1 else self._portions(step[1])
            for portion in portions:
                request.append(number(_STEPS[step[0]], 1))
                if len(step) == 2:
                    request.append(number(len(portion), 4) + portion)
            counts.append(len(portions))
        request.append(b"\0")
        return Call(b"".join(request), lambda answers: self._events(answers, decoder, counts))

    def told(self, sender: str, values: Mapping[str, int]) -> list[bytes]:
        """What a decoder is told, for `tell`: each part by its place, and its value."""
        names = [name for name, _, _ in self._driver.decoder(sender).told]
        return [number(names.index(name), 1) + number(value, 4) for name, value in values.items()]

    def _portions(self, data: bytes) -> list[bytes]:
        places = range(0, max(1, len(data)), self._room)
        return [data[place : place + self._room] for place in places]

    def _events(
        self, answers: Answers, decoder: DrivenDecoder, counts: list[int]
    ) -> list[list[CEvent]]:
        found = []
        for count in counts:
            events: list[CEvent] = []
            for _ in range(count):
                while answers.take(1) != b",":
                    events.append(self._event(answers, decoder))
            found.append(events)
        return found

    def _event(self, answers: Answers, decoder: DrivenDecoder) -> CEvent:
        kind, reason, offset, size = "message", "", None, None
        if decoder.all_events:
            kind, reason = KINDS[answers.number(1)], REASONS[answers.number(1)]
            offset, size = answers.number(4), answers.number(4)
        index = answers.number(2)
        if kind == "invalid":
            return CEvent(kind, offset, size, reason)
        form = ""
        if decoder.forms:
            found = decoder.forms[answers.number(1)]
            form, decoder = found.name, self._driver.decoders[found.decoder]
        parts = _parts(answers, decoder)
        payload = answers.data()
        message, values = "", None
        if index < len(self._driver.messages):
            message = self._driver.messages[index].model.name
        if answers.take(1) == b"H":
            values = self._handled(answers, decoder, index, parts)
            assert answers.take(1) == b"."
        return CEvent(kind, offset, size, reason, message, parts, payload, values, form)

    def _handled(
        self, answers: Answers, decoder: DrivenDecoder, index: int, parts: Values
    ) -> Values:
        """The values that a handler was given, which is that of the message."""
        assert answers.number(1) == 1
        assert answers.number(2) == index
        assert _parts(answers, decoder) == parts
        return unpack(self._driver.messages[index].model.plan, answers)


def _parts(answers: Answers, decoder: DrivenDecoder) -> Values:
    return {item.name: item.part.shown(answers.number(item.size)) for item in decoder.parts}


def _read_encoded(answers: Answers) -> Encoded:
    result, data = answers.number(1), answers.data()
    intact, exact = answers.number(1), answers.number(1)
    return Encoded(result, data, bool(intact), bool(exact))


def _read_sent(answers: Answers) -> Encoded:
    data = bytearray()
    while (mark := answers.number(1)) != 0:
        assert mark == 1, "the writer was called with something else"
        data += answers.take(1)
    return Encoded(answers.number(1), bytes(data))
