"""A capture as lines of JSON is the whole capture: encoding the lines gives back every byte."""

from __future__ import annotations

import json
from collections.abc import Sequence
from itertools import pairwise
from pathlib import Path
from random import Random
from typing import Any

import pytest
from cli_support import run, start
from compiled import DOCUMENTS, ROOT, SCHEMAS, module_at, name_of, protocol_of, senders
from corpus import Stream, material_of, stream_of
from hypothesis import given, settings
from hypothesis import strategies as st

from protogen.runtime.errors import EncodeError

EVERY_SENDER = pytest.mark.parametrize(("path", "sender"), senders(), ids=name_of)


def capture_of(path: Path, sender: str, seed: int, count: int = 80) -> bytes:
    """Frames of all kinds, unknown ones too, with noise and damage."""
    return stream_at(path, sender, seed, count).data


def stream_at(path: Path, sender: str, seed: int, count: int = 80) -> Stream:
    return stream_of(material_of(path, sender), Random(seed), count)


def lines_of(path: Path, sender: str, capture: bytes, silences: Sequence[int] = ()) -> list[str]:
    """The lines of a capture. The JSON is strict: it has no NaN and no Infinity."""
    decoder = module_at(path).Decoder(sender)
    events = []
    for begin, end in pairwise((0, *silences, len(capture))):
        events += [*decoder.feed(capture[begin:end]), *decoder.flush()]
    return [json.dumps(event.as_json(), allow_nan=False) for event in events]


def encoded(path: Path, lines: list[str]) -> bytes:
    codec = module_at(path).PROTOCOL
    return b"".join(codec.encode_line(json.loads(line)) for line in lines)


# --- through the library --------------------------------------------------------------------------


@EVERY_SENDER
def test_the_lines_of_a_capture_give_it_back(path: Path, sender: str) -> None:
    for seed in range(5):
        stream = stream_at(path, sender, seed)
        capture = stream.data
        # Where only a silence ends frames, there is one behind each.
        is_ended = protocol_of(path).sender(sender).frame.silence is not None
        silences = [offset + len(frame) for offset, frame in stream.frames if is_ended]
        lines = lines_of(path, sender, capture, silences)
        assert encoded(path, lines) == capture
        kinds = {json.loads(line)["event"] for line in lines}
        assert kinds >= {"message", "invalid"}


@EVERY_SENDER
@settings(max_examples=max(20, settings().max_examples // 3))
@given(data=st.data())
def test_any_bytes_come_back(path: Path, sender: str, data: st.DataObject) -> None:
    material = material_of(path, sender)
    marks = st.lists(st.sampled_from(list(material.marks)), max_size=20).map(bytes)
    portion = st.binary(max_size=20) | marks | st.sampled_from(material.frames)
    capture = b"".join(data.draw(st.lists(portion, max_size=6)))
    assert encoded(path, lines_of(path, sender, capture)) == capture


@EVERY_SENDER
def test_a_line_has_raw_bytes_only_where_they_are_needed(path: Path, sender: str) -> None:
    """Of what a sender made itself nothing but a NaN's payload is not in the values."""
    for frame in material_of(path, sender).frames:
        (line,) = map(json.loads, lines_of(path, sender, frame))
        assert "raw" not in line
        assert line["size"] == len(frame)


STATION = ROOT / "tests" / "framings" / "sync_length_crc.yaml"


def one_line(path: Path, sender: str, frame: bytes) -> dict[str, Any]:
    (line,) = lines_of(path, sender, frame)
    assert encoded(path, [line]) == frame
    return dict(json.loads(line))


@pytest.mark.parametrize(
    ("value", "text", "is_raw"),
    [
        ("0000c07f", "nan", False),  # the NaN that encoders write
        ("0100807f", "nan", True),  # a signalling NaN
        ("efbeffff", "nan", True),  # a negative one with a payload
        ("0000807f", "inf", False),
        ("000080ff", "-inf", False),
        ("00000080", -0.0, False),
        ("01000000", 2.0**-149, False),
    ],
)
def test_floats_come_back_bit_by_bit(value: str, text: Any, is_raw: bool) -> None:
    payload = b"\x62" + bytes.fromhex(value)
    frame = module_at(STATION).STATION_FORMAT.build({"id": 0xB5, "payload": payload})
    line = one_line(STATION, "station", frame)
    assert str(line["fields"]["reading"]["value"]) == str(text)
    assert ("raw" in line) == is_raw


def test_a_needless_escape_comes_back() -> None:
    path = ROOT / "tests" / "framings" / "hdlc_lenient.yaml"
    line = one_line(path, "station", bytes.fromhex("7E 7D 20 78 F0 7E"))
    assert (line["message"], line["raw"]) == ("ping", "7e7d2078f07e")
    assert "raw" not in one_line(path, "station", bytes.fromhex("7E 00 78 F0 7E"))


def test_an_unknown_frame_comes_back_from_its_parts_and_payload() -> None:
    path = ROOT / "schemas" / "rflex.yaml"
    frame = bytes.fromhex("1B 02 06 05 01 03 01 02 1B 00 18 1B 03")
    assert one_line(path, "flex", frame) == {
        "offset": 0,
        "size": 13,
        "event": "unknown",
        "sender": "flex",
        "parts": {"class": 6, "number": 5, "subclass": 1},
        "payload": "01021b",
    }


@pytest.mark.parametrize(
    ("line", "path"),
    [
        ({"message": "ack", "parts": {"counter": True}, "fields": {}}, "counter"),
        ({"message": "gps", "parts": {"counter": 1}, "fields": {"nmea": True}}, "fields.nmea"),
        ({"message": "ack", "parts": {"counter": 1, "command": 65.5}, "fields": {}}, "command"),
        ({"event": "unknown", "parts": {"command": True, "counter": 1}, "payload": ""}, "command"),
        ({"event": "unknown", "parts": {"command": 90, "counter": True}, "payload": ""}, "counter"),
        ({"event": "unknown", "parts": {"command": 9.5, "counter": 1}, "payload": ""}, "command"),
    ],
)
def test_true_and_floats_are_no_integers_to_json(line: dict[str, Any], path: str) -> None:
    matty = module_at(ROOT / "schemas" / "matty.yaml")
    with pytest.raises(EncodeError) as caught:
        matty.PROTOCOL.encode_line({"sender": "esp", **line})
    assert caught.value.path == path


def test_parts_that_contradict_the_message_are_refused() -> None:
    matty = module_at(ROOT / "schemas" / "matty.yaml")
    line = {"sender": "pc", "message": "stop", "fields": {}, "parts": {"counter": 1, "command": 71}}
    with pytest.raises(EncodeError, match="command: 71 is not stop, whose command is 83"):
        matty.PROTOCOL.encode_line(line)
    line["parts"] = {"counter": 1, "command": 83}
    assert matty.PROTOCOL.encode_line(line) == bytes.fromhex("55 02 01 53 AA")


def test_bytes_that_are_no_frame_come_back_from_their_digits() -> None:
    path = ROOT / "schemas" / "matty.yaml"
    assert one_line(path, "pc", b"\x55\x02\x01\x53\xab") == {
        "offset": 0,
        "size": 5,
        "event": "invalid",
        "sender": "pc",
        "reason": "checksum",
        "raw": "55020153ab",
    }


def test_values_that_no_strict_encoder_takes_come_back() -> None:
    """Out of range, without a name, reserved bits: they were on the wire, and go there again."""
    path = ROOT / "schemas" / "rn1.yaml"
    frame = bytes.fromhex("FE 42 11 7A 53 09 FF")  # motor controller 9 of 1 to 4
    line = one_line(path, "host", frame)
    assert "raw" not in line
    codec = module_at(path)
    message = codec.decode(frame, "host")
    assert message.violations() != []
    with pytest.raises(ValueError, match="motor_controller"):
        codec.encode(message)


# --- through the commands -------------------------------------------------------------------------


@EVERY_SENDER
def test_the_commands_give_a_capture_back(path: Path, sender: str, tmp_path: Path) -> None:
    capture = capture_of(path, sender, seed=7, count=40)
    file = tmp_path / "capture.bin"
    file.write_bytes(capture)
    lines = run("decode", str(path), str(file), "--sender", sender, "--format", "jsonl")
    assert lines.exit_code == 0
    raw = run("encode", str(path), "--format", "raw", input=lines.stdout_bytes)
    assert (raw.exit_code, raw.stdout_bytes) == (0, capture)
    digits = run("encode", str(path), input=lines.stdout_bytes)
    assert bytes.fromhex(digits.stdout) == capture


@pytest.mark.parametrize("path", DOCUMENTS, ids=name_of)
def test_two_processes_give_a_capture_back(path: Path) -> None:
    """As a user types it: `protogen decode ... | protogen encode ... --format raw`."""
    sender = protocol_of(path).senders[0].name
    capture = capture_of(path, sender, seed=8, count=60)
    options = ("--sender", sender, "--format", "jsonl")
    lines = start("decode", str(path), "-", *options, input=capture)
    assert lines.returncode == 0
    encoding = start("encode", str(path), "--format", "raw", input=lines.stdout)
    assert (encoding.returncode, encoding.stdout) == (0, capture)


def test_every_schema_is_tried() -> None:
    assert {path for path, _ in senders()} == set(SCHEMAS)
