"""The fast engine of generated Python against the reference: the same events, messages and bytes.

The reference cuts byte by byte and parses with construct. Wherever the fast engine decides at all
it has to decide alike; and on what is in order it has to decide, or it would not be fast.
"""

from __future__ import annotations

import struct
import sys
from array import array
from copy import copy
from decimal import Decimal
from enum import IntEnum
from fractions import Fraction
from functools import cache, partial
from itertools import product
from pathlib import Path
from random import Random
from threading import Thread
from types import ModuleType
from typing import Any
from unittest.mock import MagicMock, Mock

import numpy
import pytest
from compiled import DOCUMENTS, ROOT, module_at, name_of, protocol_of, senders
from corpus import known_frames, material_of, portions, single_bytes, stream_of
from hypothesis import given, settings
from hypothesis import strategies as st

from protogen.runtime import bulk_cut, fast
from protogen.runtime import decoder as runtime_decoder
from protogen.runtime.attributes import arguments, attribute, held_arguments
from protogen.runtime.errors import ByteError, DecodeError, EncodeError
from protogen.runtime.framing.assembly import encode_frame
from protogen.runtime.framing.machine import Candidate, Cut, verdict_on
from protogen.runtime.payload import pairs
from protogen.runtime.payload.number import Number
from protogen.runtime.payload.pairs import NeedsReference, PairLists, Pairs, pair_codes
from protogen.runtime.values import replace

EVERY_SENDER = pytest.mark.parametrize(("path", "sender"), senders(), ids=name_of)
DAGNY, MATTY, RFLEX, RN1 = (
    next(path for path in DOCUMENTS if path.stem == name)
    for name in ("dagny", "matty", "rflex", "rn1")
)
SEEDS = range(max(6, settings().max_examples // 10))


def events_of(path: Path, sender: str, engine: str, portions: Any) -> list[Any]:
    decoder = module_at(path).Decoder(sender, engine)
    events = [event for portion in portions for event in decoder.feed(portion)]
    return [*events, *decoder.flush()]


def shown(events: list[Any]) -> list[tuple[Any, ...]]:
    """All there is to events, in a form in which what is not a number equals itself."""
    return [
        (event.kind, event.offset, event.raw, event.sender, repr(event), event.as_json())
        for event in events
    ]


@cache
def material(path: Path, sender: str) -> Any:
    return material_of(path, sender)


@EVERY_SENDER
class TestEvents:
    @pytest.mark.parametrize("seed", SEEDS)
    def test_of_a_noisy_stream(self, path: Path, sender: str, seed: int) -> None:
        random = Random(seed)
        data = stream_of(material(path, sender), random, 40).data
        due = shown(events_of(path, sender, "construct", [data]))
        assert shown(events_of(path, sender, "fast", [data])) == due
        assert shown(events_of(path, sender, "fast", portions(data, random))) == due

    def test_as_early_as_by_the_reference(self, path: Path, sender: str) -> None:
        """Each portion gives the same events, so nothing is held back that is certain."""
        random = Random(99)
        data = stream_of(material(path, sender), random, 25).data
        for pieces in (list(single_bytes(data)), list(portions(data, random))):
            fast = module_at(path).Decoder(sender)
            reference = module_at(path).Decoder(sender, "construct")
            for piece in pieces:
                assert shown(fast.feed(piece)) == shown(reference.feed(piece))
                assert fast.pending == reference.pending
            assert shown(fast.flush()) == shown(reference.flush())


# --- that it is taken at all ----------------------------------------------------------------------


def known(path: Path, sender: str) -> list[bytes]:
    return list(known_frames(path, protocol_of(path).sender(sender)))


@EVERY_SENDER
def test_clean_frames_are_cut_without_the_reference(
    path: Path, sender: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Only the last frame may need it: some frames end where the next one starts."""
    if module_at(path).PROTOCOL.sender(sender).cut is None:
        assert (name_of(path), sender) in CUT_BY_THE_REFERENCE
        return
    frames = [frame for frame in known(path, sender) if len(frame) < 200][:40]
    candidates: list[Any] = []

    class Counted(Candidate):
        def __init__(self, *given: Any, **named: Any) -> None:
            super().__init__(*given, **named)
            candidates.append(self)

    monkeypatch.setattr(runtime_decoder, "Candidate", Counted)
    decoder = module_at(path).Decoder(sender)
    events = decoder.feed(b"".join(frames))
    taken_one_by_one = len(candidates)
    events += decoder.flush()
    if [event.raw for event in events] == frames:  # Some frames are cut elsewhere, by any engine.
        assert taken_one_by_one <= 1 or (name_of(path), sender) in PARTLY_CUT_BY_THE_REFERENCE


@EVERY_SENDER
def test_the_payload_of_an_event_is_that_of_its_message(path: Path, sender: str) -> None:
    data = stream_of(material(path, sender), Random(5), 20).data
    for engine in ("fast", "construct"):
        for event in events_of(path, sender, engine, [data]):
            if event.kind == "message":
                again = type(event.message).from_payload(event.payload, **held_of(event))
                assert repr(again) == repr(event.message)
                carried = byte_by_byte(event.codec, event.raw)
                if event.codec.layout.payload.kept is not None:
                    carried = carried.ljust(type(event.message).SIZES.greatest, b"\0")
                assert event.payload == carried


def held_of(event: Any) -> dict[str, int]:
    """The fields that are numbers of the frame, out of its parts."""
    held = event.message.HELD.items()
    found = {name: int(getattr(event.parts, attribute(part))) for name, part in held}
    return held_arguments(found)


def byte_by_byte(sender: Any, raw: bytes) -> bytes:
    """The payload of a frame as the reference finds it."""
    layout = sender.layout
    begins_inside = layout.shares_delimiter and not raw.startswith(layout.start)
    cut, _ = verdict_on(sender, raw, shares_start=begins_inside)
    assert isinstance(cut, Cut)
    return cut.payload


STUFFED_IN_PART = """
protocol: parts
endpoints: {robot: Robot, host: Host}
frame:
  start: {literal: {hex: C0}, unprotected: start_in_checksum}
  sort: {type: uint8, id: true}
  length: {type: uint8, counts: payload, range: [0, 8]}
  payload: {}
  check: {type: uint8, algorithm: sum-8, covers: [sort, payload]MORE}
transparency: {covers: COVERS, preset: slip}
decisions:
  start_in_checksum:
    question: What keeps the start out of the checksum?
    document: Nothing does.
    choice: The length says where a frame ends.
    because: Nothing else would.
messages:
  note: {id: 1, from: robot, fields: {text: {type: bytes, size: {fill: true, max: 8}}}}
"""


@pytest.mark.parametrize("more", ["", ", when: payload"])
@pytest.mark.parametrize("covers", ["sort..length", "sort..payload"])
def test_the_payload_of_a_frame_that_is_stuffed_in_part(
    covers: str, more: str, tmp_path: Path
) -> None:
    path = tmp_path / "parts.yaml"
    text = STUFFED_IN_PART.replace("COVERS", covers).replace("MORE", more)
    path.write_text(text, encoding="utf-8")
    stuffed = "DB DC" if covers.endswith("payload") else "C0"
    (event,) = (
        module_at(path)
        .Decoder("robot")
        .feed(
            bytes.fromhex(f"C0 01 02 {stuffed} 05 C6")  # 01 + C0 + 05 = C6
        )
    )
    assert event.payload == b"\xc0\x05"


CHECKED_WITH_PAYLOAD = """
protocol: sparse
byte_bits: 7
endpoints: {robot: Robot, host: Host}
frame:
  start: {literal: {hex: C0}}
  sort: {type: uint7, id: true}
  length: {type: uint7, counts: payload}
  number: {type: uint7}
  payload: {}
  inner: {type: uint7, algorithm: {width: 7, poly: 9}, covers: [sort, length, payload]INNER}
  check: {type: uint7, algorithm: {width: 7, poly: 9}, covers: [sort, inner]OUTER}
  end: {literal: {hex: FF}}
transparency: {covers: COVERS, preset: hdlc}
messages:
  ping: {id: 9, from: robot, fields: {}}
  note: {id: 1, from: robot, fields: {text: {type: bytes, size: {fill: true, max: 8}}}}
"""
WITH_PAYLOAD = ", when: payload"


@pytest.mark.parametrize("covers", ["sort..payload", "payload..inner", "length..check"])
@pytest.mark.parametrize("inner", ["", WITH_PAYLOAD])
@pytest.mark.parametrize("outer", ["", WITH_PAYLOAD])
def test_frames_whose_checksums_come_with_a_payload(
    outer: str, inner: str, covers: str, tmp_path: Path
) -> None:
    """Parts in front of absent ones are where these would be."""
    path = tmp_path / "sparse.yaml"
    text = CHECKED_WITH_PAYLOAD.replace("INNER", inner).replace("OUTER", outer)
    path.write_text(text.replace("COVERS", covers), encoding="utf-8")
    module = module_at(path)
    data = b""
    for item in (module.Ping(), *(module.Note(text=text) for text in (b"", b"}", b"~~", b"abc"))):
        for number in (5, 0x7D, 0x7E):
            frame = module.encode(item, number=number, engine="construct")
            assert module.encode(item, number=number) == frame
            # Whole, without stuffing, without the byte in front of the end.
            data += frame + frame.replace(b"}]", b"}").replace(b"}^", b"~") + frame[:-2] + b"\xff"
    for split in ([data], single_bytes(data)):
        pieces = list(split)
        due = shown(events_of(path, "robot", "construct", pieces))
        assert shown(events_of(path, "robot", "fast", pieces)) == due


CHECKED_TWICE = """
protocol: twice
byte_order: big
endpoints: {robot: Robot}
frame:
  sort: {type: uint8, id: true}
  length: {type: uint8, counts: payload}
  payload: {}
  inner: {type: uint16, algorithm: CRC-16/KERMIT, covers: payload}
  outer: {type: uint8, algorithm: xor-8, covers: payload..inner}
  last: {type: uint8, algorithm: sum-8, covers: inner..outer}
messages:
  fixed: {id: 1, from: robot, fields: {text: {type: bytes, size: SIZE}}}
  varying: {id: 2, from: robot, fields: {text: {type: bytes, size: {fill: true, max: 40}}}}
"""


@pytest.mark.parametrize("size", [1, 2, 3, 15, 16, 31, 32, 40])
def test_checksums_that_cover_a_checksum(size: int, tmp_path: Path) -> None:
    """More than the payload stands in front of the second of them."""
    path = tmp_path / "twice.yaml"
    path.write_text(CHECKED_TWICE.replace("SIZE", str(size)), encoding="utf-8")
    module = module_at(path)
    text = Random(size).randbytes(size)
    for item in (module.Fixed(text=text), module.Varying(text=text), module.Varying(text=b"")):
        frame = module.encode(item, engine="construct")
        assert module.encode(item) == frame
        assert module.decode(frame, "robot") == item


ZEROS = """
protocol: zeros
byte_order: big
endpoints: {robot: Robot}
frame:
  sort: {type: uint8, id: true}
  payload: {}
  check: {type: uint8, algorithm: xor-8, covers: sort..payload}
messages:
  note:
    id: 1
    from: robot
    fields:
      a: {type: float64, const: 0}
      b: {type: float32, const: -0.0}
"""


def test_a_constant_is_written_with_its_own_sign(tmp_path: Path) -> None:
    path = tmp_path / "zeros.yaml"
    path.write_text(ZEROS, encoding="utf-8")
    module = module_at(path)
    for a, b in product((0.0, -0.0), repeat=2):
        item = module.Note(a=a, b=b)
        frame = module.encode(item)
        assert frame == module.encode(item, engine="construct")
        assert frame[:-1] == struct.pack(">Bdf", 1, 0.0, -0.0)


STARTS_WITH_A_VALUE = """
protocol: counted
endpoints: {robot: Robot, host: Host}
frame:
  number: {type: uint8, range: [26, 211]}
  sort: {type: uint8, id: true}
  payload: {}
  check: {type: uint8, algorithm: sum-8, covers: payload}
messages:
  note: {id: 1, from: robot, fields: {a: uint8}}
"""


def test_frames_that_start_with_a_value_start_in_its_range(tmp_path: Path) -> None:
    path = tmp_path / "counted.yaml"
    path.write_text(STARTS_WITH_A_VALUE, encoding="utf-8")
    module = module_at(path)
    for number in (0, 25, 26, 211, 212, 255):
        frame = bytes((number, 1, 5, 5))
        fast, due = (
            events_of(path, "robot", engine, [frame, frame]) for engine in ("fast", "construct")
        )
        assert shown(fast) == shown(due)
        assert {event.kind for event in due} == {"message" if 26 <= number < 212 else "invalid"}
        if 26 <= number < 212:
            assert module.decode(frame, "robot") == module.Note(a=5)
        else:
            with pytest.raises(DecodeError, match="no frame starts so"):
                module.decode(frame, "robot")


STUFFED_INSIDE = """
protocol: inside
byte_bits: 7
endpoints: {robot: Robot, host: Host}
frame: {PARTS}
transparency: {covers: payload..payload, preset: hdlc}
messages:
  note: {id: 9, from: robot, fields: {text: {type: bytes, size: {fill: true, max: 2}}}}
"""
START, END = "start: {literal: {hex: C0}}", "end: {literal: {hex: FF}}"
SORT = "sort: {type: uint7, id: true}"
NUMBER = "number: {type: byte, range: [64, 191]}"
LENGTH = "length: {type: uint7, counts: payload}"
PAYLOAD = "payload: {}"
CHECK = "check: {type: uint7, algorithm: {width: 7, poly: 9}, covers: [length, payload]}"


@pytest.mark.parametrize(
    "parts",
    [
        (START, SORT, LENGTH, PAYLOAD, CHECK),
        (START, SORT, LENGTH, PAYLOAD, CHECK, END),
        (SORT, LENGTH, PAYLOAD, CHECK, END),
        (SORT, NUMBER, PAYLOAD, END),
        (START, SORT, NUMBER, PAYLOAD, END),
    ],
    ids=range(5),
)
def test_what_is_too_short_for_a_frame_is_none(parts: tuple[str, ...], tmp_path: Path) -> None:
    """No byte is in front of what is stuffed and behind it, or in the end, at once."""
    path = tmp_path / "inside.yaml"
    path.write_text(STUFFED_INSIDE.replace("PARTS", ", ".join(parts)), encoding="utf-8")
    module = module_at(path)
    assert module.PROTOCOL.sender("robot").cut is not None
    start, end = b"\xc0" if START in parts else b"", b"\xff" if END in parts else b"\xc0"
    for size in range(5):
        for between in product((0, 1, 9, 0x40, 0x5D), repeat=size):
            data = start + bytes(between) + end
            due = shown(events_of(path, "robot", "construct", [data]))
            assert shown(events_of(path, "robot", "fast", [data])) == due


class TestChecksumsOfManyFrames:
    """An exclusive or is compared for many frames at once, after their events were made."""

    def stream(self, wrong: tuple[int, ...]) -> bytes:
        """Frames of several sizes, some of them with a wrong byte."""
        flex = module_at(RFLEX)
        frames = []
        for number in range(700):
            few = flex.ConfirmMotorCommand(unknown=1, timestamp=number, axis=0)
            many = flex.ReadMotor(
                unknown=number,
                timestamp=number * 7919,
                axis=1,
                position=-number,
                velocity=5,
                acceleration=0,
                torque=-1,
            )
            message = many if number % 90 else few
            frame = bytearray(flex.encode(message, number=number & 0xFF))
            if number in wrong:
                frame[-6] ^= 0x40
            frames.append(bytes(frame))
        return b"".join(frames)

    @pytest.mark.parametrize(
        "wrong", [(), (0,), (1,), (254,), (255,), (256,), (257,), (699,), (3, 4, 300, 698)]
    )
    def test_the_same_events(self, wrong: tuple[int, ...]) -> None:
        path, data = RFLEX, self.stream(wrong)
        due = shown(events_of(path, "flex", "construct", [data]))
        assert shown(events_of(path, "flex", "fast", [data])) == due
        assert shown(events_of(path, "flex", "fast", portions(data, Random(3)))) == due
        assert sum(item[0] == "message" for item in due) == 700 - len(wrong)


@pytest.mark.parametrize("wrong", [0, 10, 100, 600])
def test_few_events_of_unknown_frames_are_taken_back(wrong: int) -> None:
    """Else the time for a damaged capture of them would grow with the square of its size."""
    made: list[Any] = []

    class Counted(list[Any]):
        def append(self, event: Any) -> None:
            made.append(event)
            super().append(event)

    sender = module_at(RFLEX).PROTOCOL.sender("flex")
    frame = encode_frame(sender, (0x77, 1), b"unknown", {"number": 5}, strict=False)
    spoilt = frame[:-3] + bytes((frame[-3] ^ 1,)) + frame[-2:]
    events = Counted()
    assert sender.cut is not None
    end = sender.cut(frame * wrong + spoilt + frame * 900, 0, 0, events)
    assert (len(events), end) == (wrong, wrong * len(frame))
    assert len(made) - wrong <= 64


def damaged(frames: list[bytes], random: Random) -> list[bytes]:
    """Streams of the frames: as they are, and each with something wrong, or another, somewhere."""
    place = random.randrange(len(frames) // 4, len(frames))
    frame = frames[place]
    at = random.randrange(1, len(frame))
    wrong = [
        frame,
        frame[:at] + bytes((frame[at] ^ 1 << random.randrange(8),)) + frame[at + 1 :],
        frame[:at],
        frame[:at] + bytes((random.randrange(256),)) + frame[at:],
        frame + frame[-2:],
    ]
    return [b"".join([*frames[:place], one, *frames[place + 1 :]]) for one in wrong]


def codec_at(path: Path) -> ModuleType:
    """The machine text of a schema's module."""
    module = module_at(path)
    return sys.modules[f"{module.__package__}._{module.PROTOCOL.name}_codec"]


@EVERY_SENDER
def test_runs_of_one_message(path: Path, sender: str) -> None:
    """They are taken all at once, as long as they are in order and alike."""
    if not hasattr(codec_at(path), "_BULK_0"):
        return
    random = Random(11)
    by_name = {event.message.NAME: event.raw for event in decoded(path, sender)}
    for frame in [*by_name.values()][:4]:
        frames = [frame] * (5000 // len(frame))
        for data in damaged(frames, random):
            due = shown(events_of(path, sender, "construct", [data]))
            assert shown(events_of(path, sender, "fast", [data])) == due


class TestRuns:
    def frames(self, count: int) -> list[bytes]:
        esp = module_at(MATTY)
        random = Random(2)
        return [
            esp.encode(
                esp.Status(
                    status=0,
                    mode=random.randrange(3),
                    voltage=random.randrange(1 << 16),
                    current=0x5655,
                    speed=-1,
                    angle=random.randrange(-500, 500),
                    encoder0=random.randrange(1 << 16),
                    encoder1=0,
                    encoder2=1,
                    encoder3=2,
                ),
                counter=number & 0xFF,
            )
            for number in range(count)
        ]

    def taken(self, data: bytes) -> tuple[int, list[Any]]:
        esp = codec_at(MATTY)
        events: list[Any] = []
        end = esp._BULK_0.take(data, 0, 0, events, esp._cut_esp, esp._ESP_HEADS)
        return end, events

    def test_they_are_taken(self) -> None:
        data = b"".join(self.frames(900))
        end, events = self.taken(data)
        assert len(data) - end <= bulk_cut.MIN_DATA
        assert b"".join(event.raw for event in events) == data[:end]
        assert shown(events) == shown(events_of(MATTY, "esp", "construct", [data]))[: len(events)]

    def test_others_are_left(self) -> None:
        frames = self.frames(200)
        ack = module_at(MATTY).encode(module_at(MATTY).Ack(), counter=1)
        unknown = bytes.fromhex("55 02 01 5A A3")
        for other in (ack, unknown, b"\x55\x56\x00", b"\x56"):
            for place in (0, 1, 50):
                data = b"".join([*frames[:place], other, *frames[place:]])
                end, events = self.taken(data)
                assert end <= len(b"".join(frames[:place]))
                assert len(events) <= place
                due = shown(events_of(MATTY, "esp", "construct", [data]))
                assert shown(events_of(MATTY, "esp", "fast", [data])) == due

    def test_longer_frames_than_there_are_are_left(self) -> None:
        data = b"".join(self.frames(200))
        esp = codec_at(MATTY)
        short = copy(esp._BULK_0)
        short.greatest = 20
        assert short.take(data, 0, 0, [], esp._cut_esp, esp._ESP_HEADS) == 0

    @pytest.mark.parametrize("seed", range(6))
    def test_the_same_events(self, seed: int) -> None:
        random = Random(seed)
        for data in damaged(self.frames(700), random):
            due = shown(events_of(MATTY, "esp", "construct", [data]))
            assert shown(events_of(MATTY, "esp", "fast", [data])) == due
            halves = [data[: len(data) // 2], data[len(data) // 2 :]]
            assert shown(events_of(MATTY, "esp", "fast", halves)) == due

    def test_few_heads_are_remembered(self) -> None:
        esp = codec_at(MATTY)
        data = b"".join(self.frames(200))
        others: dict[bytes, Any] = {bytes((number,)): [] for number in range(40)}
        remembering = copy(esp._BULK_0)
        remembering.numbers = others
        assert remembering.take(data, 0, 0, [], esp._cut_esp, esp._ESP_HEADS) > 0
        assert len(remembering.numbers) == 1


SENT_BY_THE_REFERENCE = {
    ("separated_line", "receiver"),
    ("digit_parts", "station"),
    ("digit_lengths", "station"),
    ("mavlink_like", "craft_plain"),  # The same messages go in the form below, too.
    ("mavlink_like", "craft_signed"),
    ("virtual_behind", "station"),
    ("virtual_parts", "station"),  # One checksum is always there, and one with a payload.
    ("escaped_counted", "station"),  # A length counts what is sent.
    ("sequences_counted", "station"),
    ("part_fields", "sensor"),  # Fields are numbers of the frame.
    ("part_fields", "host"),
    ("part_fields_alone", "device"),
}
"""Behind the payload stands something that is no checksum, but for what is said of some."""
CUT_BY_THE_REFERENCE = {
    ("checksum_only", "station"),
    ("idle_end", "station"),
    ("sequences_marked", "station"),  # What was put in has to be found.
    ("last_elements_alone", "device"),
    ("terminated_alone", "device"),
    *SENT_BY_THE_REFERENCE,
} - {("mavlink_like", "craft_plain")}
"""Nothing marks where the others' frames start, so a frame may begin at every byte."""
PARTLY_CUT_BY_THE_REFERENCE = {("told_regions", "device")}
"""Some of their payloads alone tell where they end."""


@EVERY_SENDER
def test_messages_are_sent_without_the_reference(
    path: Path, sender: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    module = module_at(path)
    spec = module.PROTOCOL.sender(sender)
    is_left = (name_of(path), sender) in SENT_BY_THE_REFERENCE
    assert is_left != all(message in module._ENCODERS for message in spec.messages)
    if is_left or spec.form:
        return  # Of several forms, the encoder takes the first that fits.
    sent = [(event.message, event.numbers) for event in decoded(path, sender)]
    names = [part.name for part in spec.layout.values]
    due = [
        module.encode(message, sender, **arguments(dict(zip_values(spec, numbers, names))))
        for message, numbers in sent
    ]

    def refuse(*_: Any, **__: Any) -> bytes:
        raise AssertionError("the reference was asked")

    monkeypatch.setattr(module.PROTOCOL, "encode", refuse)
    for (message, numbers), frame in zip(sent, due, strict=True):
        parts = arguments(dict(zip_values(spec, numbers, names)))
        assert module.encode(message, sender, **parts) == frame


def test_an_encoder_goes_the_shortest_way(monkeypatch: pytest.MonkeyPatch) -> None:
    matty = module_at(MATTY)
    encoder = matty.Encoder("pc")
    with pytest.raises(EncodeError, match="pc does not send Ack"):
        encoder.encode(matty.Ack())
    with pytest.raises(EncodeError, match="speed"):
        encoder.encode(matty.Go(speed=1 << 15, steer=0))
    monkeypatch.setattr(matty.Encoder, "encode_next", None)
    # Start, size (counter and "S"), counter, "S", and what makes the sum 0.
    assert encoder.encode(matty.Stop()) == bytes.fromhex("55 02 00 53 AB")
    assert encoder.encode(matty.Stop()) == bytes.fromhex("55 02 01 53 AA")
    for _ in range(2, 256):
        encoder.encode(matty.Stop())
    assert encoder.encode(matty.Stop()) == bytes.fromhex("55 02 00 53 AB")


LIKE_BYTES = [
    bytes,
    bytearray,
    memoryview,
    lambda data: array("B", data),
    lambda data: memoryview(bytes(byte for byte in data for _ in "12"))[::2],
    lambda data: numpy.frombuffer(data, "u1"),
    lambda data: numpy.array([data], f"S{len(data)}"),  # Which adds itself to bytes as text.
]


@pytest.mark.parametrize("engine", ["fast", "construct"])
@pytest.mark.parametrize("like", LIKE_BYTES)
def test_anything_like_bytes_is_taken(engine: Any, like: Any) -> None:
    matty = module_at(MATTY)
    due = matty.Gps(nmea="$GPRMC")
    frame = like(matty.encode(due, counter=1))
    assert matty.decode(frame, "esp", engine) == due
    assert [event.message for event in matty.Decoder("esp", engine).feed(frame)] == [due]


@pytest.mark.parametrize("engine", ["fast", "construct"])
@pytest.mark.parametrize("other", ["55", None, 5, [0x55]], ids=repr)
def test_what_is_not_like_bytes_is_refused(engine: Any, other: Any) -> None:
    matty = module_at(MATTY)
    says = "needs bytes, a bytearray or a memoryview, not"
    with pytest.raises(TypeError, match=says):
        matty.decode(other, "esp", engine)
    for decoder in (matty.Decoder("esp", engine), module_at(DAGNY).Decoder("robot", engine)):
        decoder.feed(b"\x55")
        before = decoder.pending
        with pytest.raises(TypeError, match=says):
            decoder.feed(other)
        assert decoder.pending == before


def decoded(path: Path, sender: str) -> list[Any]:
    """Events of known messages that strict encoding takes back."""
    events = []
    for frame in known(path, sender):
        found = events_of(path, sender, "construct", [frame])
        if [event.kind for event in found] == ["message"]:
            event = found[0]
            if not any(violation.forbidden for violation in event.message.violations()):
                events.append(event)
    return events


def zip_values(spec: Any, numbers: tuple[int, ...], names: list[str]) -> list[tuple[str, Any]]:
    texts = dict(spec.layout.texts)
    shown = enumerate(zip(spec.layout.shown, numbers, strict=True))
    return [
        (name, texts[index].text(value) if index in texts else value)
        for index, (name, value) in shown
        if name in names
    ]


# --- values that are not in order -----------------------------------------------------------------


class Similar(int):
    """An integer of another type."""


class Indexed:
    """Values that Python takes for an integer."""

    def __index__(self) -> int:
        return 5


class Numbered(IntEnum):
    FIVE = 5
    MANY = 300


STRANGE: list[Any] = [
    None, True, False, -1, 0, 1, 2**7, 2**15, 2**16, -(2**31), 2**64, 1.0, 0.5, float("nan"), 1e39,
    "", "text", "\xff", "\u20ac", "nul\0", b"", b"\xff", b"bytes", bytearray(b"b"), [], [1], (1,),
    [True], [2**70], [None], Fraction(1, 2), object(), Similar(5), Indexed(), Numbered.FIVE,
    Numbered.MANY, 5.0, Fraction(5), Decimal(5), numpy.int8(-5), numpy.uint8(5),
    numpy.uint16(65000), numpy.int64(5), numpy.float64(5), numpy.bool_(True), [5.0],
    [Numbered.FIVE], [numpy.int8(5)], [numpy.bool_(True)], [Indexed()],
]  # fmt: skip


STRANGE_VALUES = st.sampled_from(STRANGE)


def outcome(encode: Any, *given: Any, **named: Any) -> tuple[str, ...]:
    try:
        return ("frame", encode(*given, **named).hex())
    except EncodeError as error:
        return ("refused", error.path, error.problem)
    except Exception as error:
        return ("raised", type(error).__name__)


@EVERY_SENDER
def test_strange_values_have_the_same_outcome(path: Path, sender: str) -> None:
    module = module_at(path)
    spec = module.PROTOCOL.sender(sender)
    names = [part.name for part in spec.layout.values]
    by_message = {event.message.NAME: event for event in decoded(path, sender)}
    for event in by_message.values():
        parts = dict(zip_values(spec, event.numbers, names))
        for field in event.message.__fields__:
            for value in STRANGE:
                item = replace(event.message, **{field: value})
                due = outcome(module.encode, item, sender, engine="construct", **parts)
                assert outcome(module.encode, item, sender, **parts) == due
        for name in names:
            for value in STRANGE:
                given = {**parts, name: value}
                due = outcome(module.encode, event.message, sender, engine="construct", **given)
                assert outcome(module.encode, event.message, sender, **given) == due


@pytest.mark.parametrize(("words", "size"), [(100, 399), (100, 143), (37, 147), (37, 403)])
@pytest.mark.parametrize("kind", [int, numpy.uint8, numpy.int8, numpy.uint16])
def test_sizes_are_worked_out_in_exact_integers(
    kind: Any, words: int, size: int, recwarn: pytest.WarningsRecorder
) -> None:
    """Of `words * 4 - 1` bytes; in 8 bits, 100 * 4 is 144."""
    module = module_at(ROOT / "tests" / "framings" / "told_numbers.yaml")
    numbers = {"n": 1, "pairs": [0, 0], "all_but_one": [], "length": 8, "points": [], "tail": 0}
    item = module.Lines(words=kind(words), data=bytes(size), rest="    ", **numbers)
    due = outcome(module.encode, item, engine="construct")
    assert outcome(module.encode, item) == due
    assert (due[0] == "frame") == (size == words * 4 - 1)
    assert list(recwarn) == []


@pytest.mark.parametrize("bits", [7, 14])
@pytest.mark.parametrize("place", [-4, -3, -2, -1, 0, 1, 2, 3, 4])
def test_what_lists_wrap_around_is_out_of_range(bits: int, place: int) -> None:
    """A list of `1 << bits` values has one at each index down to the negative of its length."""
    module = module_at(RN1)
    made = {
        7: module.MoveManual(speed=0, arc=0),
        14: module.Gyro(status=1, int_x=0, int_y=0, int_z=0),
    }
    name = {7: "speed", 14: "int_x"}[bits]
    border = place * (1 << bits - 1)
    for value in range(border - 2, border + 3):
        item = replace(made[bits], **{name: value})
        due = outcome(module.encode, item, engine="construct")
        assert outcome(module.encode, item) == due
        assert (due[0] == "frame") == (-(1 << bits - 1) <= value < 1 << bits - 1)


def test_messages_of_others_have_the_same_outcome(tmp_path: Path) -> None:
    """Neither a class of one's own is a message of a module, nor one that another module has."""
    module = module_at(MATTY)
    copied = tmp_path / MATTY.name
    copied.write_bytes(MATTY.read_bytes())
    twin = module_at(copied)

    class Own(module.Gps):  # type: ignore[name-defined,misc]
        """Not a module's."""

    class Odd:
        def __encode__(self, *_: Any) -> bytes:
            raise AssertionError("it is no message")

    gps = {"nmea": "$GPRMC"}
    gyro = module_at(RN1).Gyro(status=1, int_x=0, int_y=0, int_z=0)
    mocks = (Mock(), MagicMock())
    for other in (Own(**gps), twin.Gps(**gps), gyro, Odd(), None, module.Gps, *mocks):
        due = outcome(module.encode, other, engine="construct")
        assert due[0] != "frame"
        assert outcome(module.encode, other) == due
    assert outcome(twin.encode, twin.Gps(**gps)) == outcome(module.encode, module.Gps(**gps))


def test_classes_of_ones_own_have_the_other_bases_they_are_given() -> None:
    module = module_at(MATTY)
    told: dict[str, str] = {}

    class Registered:
        def __init_subclass__(cls, under: str = "", **others: Any) -> None:
            super().__init_subclass__(**others)
            told[cls.__name__] = under

    class First(Registered, module.Gps, under="a"):  # type: ignore[name-defined,misc]
        pass

    class Last(module.Gps, Registered, under="b"):  # type: ignore[name-defined,misc]
        pass

    assert told == {"First": "a", "Last": "b"}
    for own in (First, Last):
        assert outcome(module.encode, own(nmea="$GPRMC"))[0] == "refused"


OF_ONE_SIZE = """
protocol: unsaid
byte_order: big
endpoints: {robot: Robot, host: Host}
frame:
  start: {literal: {hex: C0}, unprotected: start_in_data}
  sort: {type: TYPE, id: true}
  payload: {}
decisions:
  start_in_data:
    question: What keeps the start out of the data?
    document: Nothing does.
    choice: The size says where a frame ends.
    because: Nothing else would.
messages:
  blob: {id: 1, from: robot, fields: unspecified, min_size: 4, max_size: 4}
"""


@pytest.mark.parametrize("type_", ["uint8", "uint24"])
def test_data_of_one_size_have_the_same_outcome(type_: str, tmp_path: Path) -> None:
    """The bytes are as many as there are, so it is the payload whose size is wrong."""
    path = tmp_path / "unsaid.yaml"
    path.write_text(OF_ONE_SIZE.replace("TYPE", type_), encoding="utf-8")
    module = module_at(path)
    for size in range(7):
        item = module.Blob(data=bytes(size))
        due = outcome(module.encode, item, engine="construct")
        assert outcome(module.encode, item) == due
        assert (due[0] == "frame") == (size == 4)


@pytest.mark.parametrize(
    "value",
    [*STRANGE, 255, 256, 2**31, 2**32],
    ids=lambda value: repr(value)[:20],
)
def test_strange_values_in_records_have_the_same_outcome(value: Any) -> None:
    module = rflex()
    for name in ("cluster", "distance"):
        for place in range(3):
            readings = [module.SonarDataReadings(cluster=1, distance=2) for _ in range(3)]
            setattr(readings[place], name, value)
            item = module.SonarData(unknown=1, timestamp=2, readings=readings)
            due = outcome(module.encode, item, "flex", engine="construct")
            assert outcome(module.encode, item, "flex") == due


def test_records_of_another_class_have_the_same_outcome() -> None:
    module = rflex()
    reading = module.SonarDataReadings(cluster=1, distance=2)

    class More(module.SonarDataReadings):  # type: ignore[name-defined,misc]
        pass

    class Like:
        cluster, distance = 1, 2

    for other in (More(cluster=3, distance=4), Like(), None, 5):
        for readings in ([other], [reading, other], [other, reading], [other, other], (reading,)):
            item = module.SonarData(unknown=1, timestamp=2, readings=readings)
            due = outcome(module.encode, item, "flex", engine="construct")
            assert outcome(module.encode, item, "flex") == due


def test_records_are_written_without_the_reference(monkeypatch: pytest.MonkeyPatch) -> None:
    module = rflex()
    made = module.SonarDataReadings
    readings = [made(cluster=count, distance=count << 8) for count in range(82)]
    item = module.SonarData(unknown=2**32 - 1, timestamp=0, readings=readings)
    due = module.encode(item, engine="construct")
    monkeypatch.setattr(module.PROTOCOL, "encode", None)
    assert module.encode(item) == due


def test_not_all_numbers_of_records_are_kept() -> None:
    packers = fast.Packers("<B", "BH")
    for count in range(1000):
        assert packers[count](7, *[1, 2] * count) == b"\7" + b"\1\2\0" * count
        assert 2 * sum(packers) <= 1 << 16
    few = fast.Packers("<B", "BH")
    for count in range(100):
        assert few[count] is few[count]
    assert len(few) == 100


def test_tables_are_full_for_each_thread() -> None:
    """Whoever is told that they are filled finds all values, whatever another thread is doing."""
    tables = fast.Tables()
    others: list[Thread] = []
    found: list[tuple[int, int]] = []

    def number(raw: int) -> int:
        while others:
            other = others.pop()
            other.start()
            other.join()
        return raw

    named: Any = number
    first, second = tables.members(named, 3), tables.members(named, 4)

    def fill() -> None:
        if not tables.are_filled:
            tables.fill()
        found.append((len(first), len(second)))

    others.append(Thread(target=fill))
    fill()
    assert found == [(8, 16)] * 2


def test_tables_are_filled_again_after_an_interruption() -> None:
    tables = fast.Tables()
    interruptions = [KeyboardInterrupt()]

    def number(raw: int) -> int:
        if raw == 5 and interruptions:
            raise interruptions.pop()
        return raw

    named: Any = number
    table = tables.members(named, 3)
    with pytest.raises(KeyboardInterrupt):
        tables.fill()
    assert not tables.are_filled
    tables.fill()
    assert table == [*range(8)]


def test_not_all_heads_are_kept() -> None:
    asked = []

    def read(head: bytes) -> tuple[Any, ...]:
        asked.append(head)
        return (head,)

    heads = fast.Heads(read)
    for _ in range(2):
        for number in range(5000):
            head = number.to_bytes(2, "big")
            assert heads[head] == (head,)
    assert len(heads) == 4096
    assert len(asked) == 5000 + 5000 - 4096


@EVERY_SENDER
def test_a_single_frame_has_the_same_outcome(path: Path, sender: str) -> None:
    """Whole, cut, with a byte more, with a bit turned, twice: the same message or error."""
    module, random = module_at(path), Random(7)

    def read(frame: bytes, engine: str) -> Any:
        try:
            return repr(module.decode(frame, sender, engine))
        except DecodeError as error:
            return (error.reason, error.offset, error.path, error.problem)

    for frame in known(path, sender)[:30]:
        turned = bytearray(frame)
        turned[random.randrange(len(turned))] ^= 1 << random.randrange(8)
        for data in (frame, frame[:-1], frame + b"\0", bytes(turned), frame + frame, b""):
            assert read(data, "fast") == read(data, "construct")


def test_a_payload_that_is_not_stuffed_stays_as_it_is(tmp_path: Path) -> None:
    """The stuffed region may end in front of the payload."""
    path = tmp_path / "head.yaml"
    path.write_text("""
protocol: head
title: A head that is stuffed
endpoints: {one: One side}
frame:
  sync: {literal: {hex: 7E}, unprotected: sync_in_data}
  length: {type: uint8, counts: [payload]}
  id: {type: uint8, id: true}
  payload: {}
transparency: {preset: hdlc, covers: id..id}
messages:
  data: {id: 0x7D, from: one, fields: unspecified, min_size: 1}
decisions:
  sync_in_data: {question: Is it protected?, document: No., choice: Accept., because: It is rare.}
""")
    module = module_at(path)
    message = module.Data(data=b"\x7d\x01\x7e")
    for engine in ("fast", "construct"):
        assert module.encode(message, "one", engine=engine) == b"\x7e\x03\x7d\x5d\x7d\x01\x7e"
    wire = module.encode(message, "one") * 2
    due = shown(events_of(path, "one", "construct", [wire]))
    assert len(due) == 2
    assert shown(events_of(path, "one", "fast", [wire])) == due


def test_another_engine() -> None:
    module = module_at(DOCUMENTS[0])
    sender = next(iter(module.PROTOCOL.senders))
    for call in (module.Decoder, partial(module.decode, b"")):
        with pytest.raises(ValueError, match="there is no engine 'slow'; there are: fast, constr"):
            call(sender, "slow")


# --- integers of two bytes of 7 bits --------------------------------------------------------------


@given(
    bits=st.integers(8, 14),
    signed=st.booleans(),
    order=st.sampled_from(["little", "big"]),
    data=st.binary(max_size=40).map(lambda data: data[: len(data) // 2 * 2]),
)
def test_lists_of_pairs_are_read_as_their_numbers_are(
    bits: int, signed: bool, order: Any, data: bytes
) -> None:
    number = Number(bits, signed, order, seven_bit=True)
    lists, one = PairLists(bits, signed, order), Pairs(bits, signed, order)
    try:
        due = [number.decode(data[place : place + 2]) for place in range(0, len(data), 2)]
    except ByteError:
        with pytest.raises(NeedsReference):
            lists.decode(data)
        return
    assert lists.decode(data) == due
    assert [one[code] for code in unpack(("<" if order == "little" else ">"), data)] == due


def test_lists_of_pairs_on_a_machine_of_the_other_order(monkeypatch: pytest.MonkeyPatch) -> None:
    """Here an array reads as that machine's would, so the numbers come out swapped."""
    monkeypatch.setattr(pairs, "_IS_SWAPPED", sys.byteorder == "little")
    assert PairLists(14, False, "little").decode(b"\x02\x00\x01\x02") == [0x0200, 0x0101]


def unpack(order: str, data: bytes) -> tuple[int, ...]:
    return struct.unpack(f"{order}{len(data) // 2}H", data)


@given(
    bits=st.integers(8, 14),
    signed=st.booleans(),
    order=st.sampled_from(["little", "big"]),
    data=st.data(),
)
def test_lists_of_pairs_are_written_as_their_numbers_are(
    bits: int, signed: bool, order: Any, data: Any
) -> None:
    number = Number(bits, signed, order, seven_bit=True)
    lists, codes = PairLists(bits, signed, order), pair_codes(bits)
    inside = st.integers(number.least, number.greatest)
    values = data.draw(st.lists(inside, max_size=20))
    due = b"".join(map(number.encode, values))
    assert lists.encode(values) == due
    written = unpack("<" if order == "little" else ">", due)
    assert tuple(codes[value] for value in values) == written
    outside = data.draw(
        st.integers().filter(lambda value: not number.least <= value <= number.greatest)
    )
    with pytest.raises((NeedsReference, struct.error)):
        lists.encode([*values, outside])
    with pytest.raises(ValueError, match="is not in"):
        number.encode(outside)


def rflex() -> Any:
    return module_at(next(path for path in DOCUMENTS if path.stem == "rflex"))
