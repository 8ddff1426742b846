"""Round trips of every message of every schema, dialect and framing.

values -> payload -> values, values -> frame -> event, and bytes -> values -> bytes. What the bytes
have to be is worked out a second time by `schema_fuzzing.reference`, which shares no code with the
generated codecs.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Mapping
from itertools import islice
from pathlib import Path
from random import Random
from types import ModuleType
from typing import Any

import construct
import pytest
from amounts import OF_A_MESSAGE
from compiled import SCHEMAS, module_at, protocol_of
from corpus import marks_of
from hypothesis import assume, given, settings
from hypothesis import strategies as st
from schema_fuzzing.held import held_of, held_parts
from schema_fuzzing.reference import frame_bytes, payload_bytes
from schema_fuzzing.values import all_parts, parts_of, values_of

from protogen.fuzzing.samples import boundary_rounds, samples
from protogen.model.expressions import Quotient
from protogen.model.messages import Message, given_parts
from protogen.model.protocol import Sender
from protogen.model.types import Array, Counted, Field, Struct, Switch, Type
from protogen.passes.framing.capacity import payload_range
from protogen.runtime.attributes import arguments, attribute, held_arguments
from protogen.runtime.errors import DecodeError, EncodeError
from protogen.runtime.values import as_dict


class Case:
    """One message of one sender of one schema."""

    def __init__(self, path: Path, sender: Sender, message: Message) -> None:
        self.path = path
        self.sender = sender
        self.message = message

    def __repr__(self) -> str:
        return f"{self.path.stem}-{self.sender.name}-{self.message.name}"

    @property
    def module(self) -> ModuleType:
        return module_at(self.path)

    @property
    def record(self) -> Any:
        """The generated class."""
        return self.module.MESSAGES[self.message.name]

    @property
    def format(self) -> Any:
        """The frame as a construct declaration."""
        return getattr(self.module, f"{self.sender.name.upper()}_FORMAT")

    @property
    def yielded(self) -> str:
        """The message that a decoder takes this one for: another one if nothing tells them."""
        for overload in self.sender.overloads:
            if self.message.name in overload.messages and overload.yields is not None:
                return overload.yields
        return self.message.name

    @property
    def identity(self) -> dict[str, int | str]:
        each = zip(self.sender.frame.identity, self.message.identity, strict=True)
        return {part.name: part.shown(value) for part, value in each}


CASES = [
    Case(path, sender, message)
    for path in SCHEMAS
    for sender in protocol_of(path).senders
    for message in sender.messages
]
EVERY_MESSAGE = pytest.mark.parametrize("case", CASES, ids=repr)
# There are so many messages that each needs fewer examples.
MOST_MARKS = 12
"""Bytes that mean something, with which each payload is tried."""
FEWER = settings(max_examples=OF_A_MESSAGE)

Values = dict[str, Any]


def boundaries(case: Case) -> Iterator[tuple[Values, Values]]:
    """Values and parts with each boundary of each: ends of ranges, 0, -1, names, special values,
    single bits, infinities, NaN; empty and full arrays, texts and bytes.
    """
    rounds = boundary_rounds(case.message, case.sender.frame)
    return islice(samples(case.message, case.sender.frame, Random(0)), rounds)


# --- values -> bytes -> values --------------------------------------------------------------------


@EVERY_MESSAGE
def test_boundary_values_come_back(case: Case) -> None:
    for values, parts in boundaries(case):
        check_values(case, values, parts)


@EVERY_MESSAGE
@FEWER
@given(data=st.data())
def test_values_come_back(case: Case, data: st.DataObject) -> None:
    if is_sized(case.message.fields):  # What is in it has to take just so many bytes.
        frame, seed = case.sender.frame, data.draw(st.integers(0, 2**32))
        rounds = boundary_rounds(case.message, frame)
        check_values(case, *next(islice(samples(case.message, frame, Random(seed)), rounds, None)))
        return
    values = as_text(data.draw(values_of(case.message, [case.sender.frame])))
    payload = payload_bytes(case.message.fields, values, {})
    assume(len(payload) <= case.message.sizes.greatest)  # Several fields may take all the room.
    check_values(case, values, data.draw(parts_of(case.sender.frame, case.message)))


def is_sized(fields: Iterable[Field]) -> bool:
    """True if something in a message has a number of bytes that a field says."""
    return any(field.region is not None or is_counted_in_bytes(field.type) for field in fields)


def is_counted_in_bytes(type_: Type) -> bool:
    match type_:
        case Struct():
            return is_sized(type_.fields)
        case Array(extent=Counted(by=Quotient())):
            return True
        case Array():
            return is_counted_in_bytes(type_.element)
        case Switch():
            return any(is_counted_in_bytes(item.type) for item in type_.cases)
    return False


def check_values(case: Case, values: Values, parts: Values) -> None:
    record = case.record.from_dict(values)
    payload = record.to_payload()
    assert payload == payload_bytes(case.message.fields, values, {})
    assert len(payload) in case.message.sizes
    held = held_arguments(held_of(case.message, values))
    assert same(case.record.from_payload(payload, **held).to_dict(), values)
    check_frame(case, record, payload, values, parts)


def check_frame(case: Case, record: Any, payload: bytes, values: Values, parts: Values) -> None:
    stated = payload_range(case.sender.frame)
    if not case.sender.is_only_form and stated is not None and len(payload) not in stated:
        return  # Another form of frame carries it.
    try:
        frame = case.module.encode(record, case.sender.name, **arguments(parts))
    except EncodeError as error:
        # Its own end stands in the frame, and a decoder would cut it there; or it is too long.
        if case.sender.framing.is_cut_off and "makes a frame of" in str(error):
            return
        length = case.sender.frame.length
        if length is not None and length.over_wire and "makes length" in str(error):
            return
        assert case.sender.framing.cut_ambiguous, error
        assert "decoder" in str(error), error
        return
    every = parts | held_parts(case.message, values)
    all_of_it = all_parts(case.sender.frame, case.message, every)
    assert frame == frame_bytes(case.sender.frame, case.message, payload, all_of_it)
    (event,) = events_of(case, frame)
    assert (event.kind, event.offset, event.raw) == ("message", 0, frame)
    assert event.payload == payload
    assert case.yielded == event.message.NAME
    assert as_dict(event.parts) == all_of_it
    if case.yielded == case.message.name:
        assert same(event.message.to_dict(), values)
        assert same(case.module.decode(frame, case.sender.name).to_dict(), values)


def events_of(case: Case, data: bytes) -> list[Any]:
    decoder = case.module.Decoder(case.sender.name)
    return [*decoder.feed(data), *decoder.flush()]


def as_text(values: Any) -> Any:
    """The values with the infinities as JSON lines have them."""
    if isinstance(values, dict):
        return {name: as_text(value) for name, value in values.items()}
    if isinstance(values, list):
        return [as_text(value) for value in values]
    return str(values) if isinstance(values, float) and math.isinf(values) else values


def same(left: Any, right: Any) -> bool:
    """True if values are equal, and zeros have the same sign."""
    if isinstance(left, dict):
        return left.keys() == right.keys() and all(same(left[key], right[key]) for key in left)
    if isinstance(left, list):
        return len(left) == len(right) and all(map(same, left, right))
    if isinstance(left, float) and left == 0:
        return right == 0 and math.copysign(1, left) == math.copysign(1, right)
    return bool(left == right)


# --- bytes -> values -> bytes ---------------------------------------------------------------------


@EVERY_MESSAGE
def test_payloads_of_delimiters_come_back(case: Case) -> None:
    """Every byte that means something in the frame, alone and after its neighbours.

    Where many bytes do, each message is tried with some of them, and another one with the others.
    """
    marks = marks_of(case.path, case.sender.name)
    step = -(-len(marks) // MOST_MARKS)
    turns = range(case.sender.messages.index(case.message) % step, len(marks), step)
    for payload in plain_payloads(case):
        for turn in turns:
            check_payload(case, marks[turn : turn + 1] * len(payload))
            circle = (marks[turn:] + marks[:turn]) * (len(payload) // len(marks) + 1)
            check_payload(case, circle[: len(payload)])
            place = turn % (len(payload) + 1)
            check_payload(case, (payload[:place] + circle)[: len(payload)])


@EVERY_MESSAGE
@FEWER
@given(data=st.data())
def test_any_payload_that_is_accepted_comes_back(case: Case, data: st.DataObject) -> None:
    """Arbitrary bytes, and valid payloads with some bytes changed, in a frame that is right."""
    marks = list(marks_of(case.path, case.sender.name))
    any_byte = st.sampled_from(marks) | st.integers(0, 127) | st.integers(0, 255)
    payload = bytearray(data.draw(st.sampled_from(plain_payloads(case))))
    if payload:
        for place in data.draw(st.lists(st.integers(0, len(payload) - 1), max_size=8)):
            payload[place] = data.draw(any_byte)
    if data.draw(st.booleans()):
        payload = bytearray(data.draw(st.lists(any_byte, max_size=12)))
    check_payload(case, bytes(payload), data.draw(parts_of(case.sender.frame, case.message)))


def plain_payloads(case: Case) -> list[bytes]:
    """A few valid payloads of different sizes: the shortest, the longest, and some between."""
    payloads = {payload_bytes(case.message.fields, values, {}) for values, _ in boundaries(case)}
    in_order = sorted(payloads, key=lambda payload: (len(payload), payload))
    return in_order[:: max(1, len(in_order) // 4)] + in_order[-1:]


def check_payload(case: Case, payload: bytes, parts: Mapping[str, int | str] | None = None) -> None:
    """Whatever the payload is, a frame that a decoder accepts is made of its values again."""
    if parts is None:
        greatest = ((part, part.greatest) for part in case.sender.frame.caller_parts)
        parts = {part.name: part.shown(value) for part, value in greatest}
    try:
        frame = case.format.build({**case.identity, **parts, "payload": payload})
    except construct.ConstructError:
        return  # No frame can carry it.
    (event, *others) = events_of(case, frame)
    if event.kind != "message" or others:
        assert event.kind == "invalid" or len(payload) not in case.message.sizes
        return
    is_trimmed, is_fitted = case.sender.plan.is_trimmed, case.sender.plan.is_fitted
    size = case.message.sizes.greatest if is_trimmed else 0
    is_cut = case.sender.plan.is_cut and case.message.cut_size is not None
    known = payload[: case.message.sizes.greatest] if is_cut else payload
    if case.sender.plan.is_cut and case.message.tells_its_end:
        known = payload[: len(event.payload)]
        assert len(known) in case.message.sizes
    assert event.payload == known.ljust(size, b"\0")
    chosen = given_parts(case.sender.frame, case.message)
    given = {part.name: getattr(event.parts, attribute(part.name)) for part in chosen}
    again = case.module.encode(event.message, case.sender.name, False, **arguments(given))
    one_spelling = case.message.plan.has_one_spelling and not is_fitted
    assert again == frame or not one_spelling or has_nan(event.message.to_dict())
    line = event.as_json()
    encode_line = case.module.PROTOCOL.encode_line
    assert encode_line(line) == frame
    raw = line.pop("raw", None)
    assert (raw is None) == (encode_line(line) == frame), "raw stands where it has to, only there"


def has_nan(values: Any) -> bool:
    """True if a float is not a number: JSON and most machines don't keep which one it is."""
    if isinstance(values, dict):
        return any(map(has_nan, values.values()))
    if isinstance(values, list):
        return any(map(has_nan, values))
    return bool(values == "nan")


# --- the construct declarations -------------------------------------------------------------------


@EVERY_MESSAGE
def test_a_format_can_be_embedded_and_agrees_with_the_dataclass(case: Case) -> None:
    own = construct.Struct("stamp" / construct.Int32ub, "body" / case.record.FORMAT)
    for values, _ in boundaries(case):
        record = case.record.from_dict(values)
        data = b"\x00\x00\x01\x02" + record.to_payload()
        parsed = own.parse(data, **held_arguments(held_of(case.message, values)))
        assert parsed.stamp == 0x0102
        assert own.build(parsed) == data
        assert same(plain(parsed.body), plain(dict(attributes(record))))


@EVERY_MESSAGE
def test_a_frame_format_can_be_embedded_and_agrees_with_encode(case: Case) -> None:
    """A log of frames with a time and a mark: the frame says itself where it ends.

    Nothing stands behind one that only a silence ends.
    """
    mark = b"\xa5\x5a" if case.sender.frame.silence is None else b""
    own = construct.Struct(
        "time" / construct.Int16ul, "frame" / case.format, "mark" / construct.Const(mark)
    )
    for values, parts in islice(boundaries(case), 8):
        record = case.record.from_dict(values)
        try:
            frame = case.module.encode(record, case.sender.name, **arguments(parts))
        except EncodeError:
            assert case.sender.framing.cut_ambiguous or case.sender.framing.is_cut_off
            continue
        data = b"\x07\x00" + frame + mark
        parsed = own.parse(data)
        shown = {name: value for name, value in parsed.frame.items() if name != "payload"}
        assert parsed.frame.payload == carried(case, record.to_payload())
        assert shown == all_parts(case.sender.frame, case.message, parts)
        assert own.build(parsed) == data


def carried(case: Case, payload: bytes) -> bytes:
    """What a frame has of a payload, where zeros at its end are left out."""
    kept = case.sender.frame.payload.kept
    while kept is not None and payload[kept:].endswith(b"\0"):
        payload = payload[:-1]
    return payload


def attributes(record: Any) -> Iterator[tuple[str, Any]]:
    """The fields of a record with their Python values."""
    return ((name, getattr(record, attribute(name))) for name, _ in record.RULES)


def plain(value: Any) -> Any:
    """Records, containers, enums and lists as what they are made of."""
    if hasattr(value, "RULES"):
        return plain(dict(attributes(value)))
    if isinstance(value, Mapping):
        return {name: plain(item) for name, item in value.items() if not name.startswith("_")}
    if isinstance(value, list):
        return [plain(item) for item in value]
    if isinstance(value, float) and math.isnan(value):
        return "nan"
    return int(value) if isinstance(value, int) else value


# --- what is refused ------------------------------------------------------------------------------


@EVERY_MESSAGE
def test_a_payload_of_another_size_is_no_message(case: Case) -> None:
    """Trailing and missing bytes are refused, as far as the message does not take any number."""
    payload = plain_payloads(case)[0]
    for wrong in (payload + b"\x00", payload[:-1]):
        if len(wrong) in case.message.sizes:
            continue
        with pytest.raises(DecodeError) as caught:
            case.record.from_payload(wrong)
        assert caught.value.reason == "size"


def test_the_cases_are_all_there_is() -> None:
    named = {(case.path, case.message.name) for case in CASES}
    declared = {(path, name) for path in SCHEMAS for name in module_at(path).MESSAGES}
    assert named == declared


def undecidable() -> Iterable[Case]:
    return (case for case in CASES if case.yielded != case.message.name)


def test_some_messages_come_back_as_another_one() -> None:
    """The document leaves open what tells them apart; the payload is the same."""
    assert {repr(case): case.yielded for case in undecidable()} == {
        "dagny-host-power_down": "power",
        "dagny-robot-speed": "odometry",
    }
