"""Payloads whose zeros at the end are left out: beside pymavlink, and what changes of them do."""

from __future__ import annotations

import math
from collections.abc import Iterator
from random import Random
from types import ModuleType
from typing import Any

import pytest
from compiled import ROOT, module_at
from passes_support import compile_text

from protogen.evolution.findings import findings
from protogen.live.codec import module_of
from protogen.model.protocol import Protocol
from protogen.runtime.errors import DecodeError, EncodeError

STATION = ROOT / "tests" / "framings" / "trimmed.yaml"
STUFFED = ROOT / "tests" / "framings" / "trimmed_stuffed.yaml"
FORMS = ROOT / "tests" / "framings" / "trimmed_forms.yaml"
ENGINES = ["fast", "construct"]

# --- beside pymavlink ---------------------------------------------------------------------------

AUTOPILOT = """\
protocol: autopilot
endpoints: {pilot: Autopilot}
byte_order: little
frame:
  magic: {literal: 0xFD, unprotected: magic_in_data}
  length: {type: uint8, counts: payload}
  incompatible: {type: uint8, default: 0}
  compatible: {type: uint8, default: 0}
  number: {type: uint8, counter: true}
  system: {type: uint8, default: 1}
  component: {type: uint8, default: 1}
  kind: {type: uint24, id: true}
  payload: {trailing_zeros: trimmed}
  crc: {type: uint16, algorithm: CRC-16/MCRF4XX, covers: length..payload}
messages:
  heartbeat:
    id: 0
    from: pilot
    fields:
      custom_mode: uint32
      type: uint8
      autopilot: uint8
      base_mode: uint8
      system_status: uint8
      mavlink_version: uint8
  system_time: {id: 2, from: pilot, fields: {time_unix_usec: uint64, time_boot_ms: uint32}}
  attitude:
    id: 30
    from: pilot
    fields:
      time_boot_ms: uint32
      roll: float32
      pitch: float32
      yaw: float32
      rollspeed: float32
      pitchspeed: float32
      yawspeed: float32
  servo_output_raw:
    id: 36
    from: pilot
    fields:
      time_usec: uint32
      servo1_raw: {type: uint16, count: 8}
      port: uint8
      more_raw: {type: uint16, count: 8}
  statustext:
    id: 253
    from: pilot
    fields: {severity: uint8, text: {type: ascii, size: 50}, id: uint16, chunk_seq: uint8}
decisions:
  magic_in_data: {question: q, document: d, choice: c, because: The test is about payloads.}
"""
"""Messages of `common`, in wire order, without what each adds to its CRC."""

_COUNT = 120
"""Frames of each message."""


def _heartbeat(dice: Random) -> dict[str, Any]:
    names = ("custom_mode", "type", "autopilot", "base_mode", "system_status", "mavlink_version")
    return {name: _number(dice, 32 if name == "custom_mode" else 8) for name in names}


def _system_time(dice: Random) -> dict[str, Any]:
    return {"time_unix_usec": _number(dice, 64), "time_boot_ms": _number(dice, 32)}


def _attitude(dice: Random) -> dict[str, Any]:
    names = ("roll", "pitch", "yaw", "rollspeed", "pitchspeed", "yawspeed")
    angles = {name: dice.choice([0.0, 0.0, 1.5, -0.25, 0.0]) for name in names}
    return {"time_boot_ms": _number(dice, 32), **angles}


def _servo_output_raw(dice: Random) -> dict[str, Any]:
    return {
        "time_usec": _number(dice, 32),
        "servo1_raw": [_number(dice, 16) for _ in range(8)],
        "port": _number(dice, 8),
        "more_raw": [_number(dice, 16) for _ in range(8)],
    }


def _statustext(dice: Random) -> dict[str, Any]:
    text = "".join(dice.choices("abc", k=dice.choice([0, 1, 20, 50])))
    return {
        "severity": _number(dice, 8),
        "text": text,
        "id": dice.choice([0, 0, 0x0100, 7]),
        "chunk_seq": dice.choice([0, 0, 3]),
    }


def _number(dice: Random, bits: int) -> int:
    """A number that is often zero, or has zero bytes at its upper end."""
    return dice.choice([0, 0, 0, 1, (1 << bits) - 1, 1 << (bits - 1), dice.getrandbits(bits)])


DRAWS = {
    "heartbeat": _heartbeat,
    "system_time": _system_time,
    "attitude": _attitude,
    "servo_output_raw": _servo_output_raw,
    "statustext": _statustext,
}


@pytest.fixture(scope="module")
def autopilot() -> ModuleType:
    return module_of(_protocol(AUTOPILOT))


def _protocol(text: str) -> Protocol:
    compilation = compile_text(text)
    assert compilation.protocol is not None, compilation.problems
    return compilation.protocol


@pytest.fixture(scope="module")
def mavlink() -> Any:
    return pytest.importorskip("pymavlink.dialects.v20.common")


def _sum(data: bytes, extra: bytes = b"") -> bytes:
    from pymavlink.generator.mavcrc import x25crc

    return int(x25crc(data + extra).crc).to_bytes(2, "little")


def _theirs(mavlink: Any, name: str, values: dict[str, Any], number: int) -> tuple[Any, bytes]:
    """A message of pymavlink, and its frame with a CRC of the frame alone."""
    link = mavlink.MAVLink(None, srcSystem=1, srcComponent=1)
    link.seq = number
    made = dict(values)
    if name == "statustext":
        made["text"] = made["text"].encode()
    if name == "servo_output_raw":
        own, more = made.pop("servo1_raw"), made.pop("more_raw")
        made |= {f"servo{index}_raw": value for index, value in enumerate([*own, *more], 1)}
    message = getattr(mavlink, f"MAVLink_{name}_message")(**made)
    frame = bytes(message.pack(link))
    return message, frame[:-2] + _sum(frame[1:-2])


def _drawn(name: str) -> Iterator[tuple[int, dict[str, Any]]]:
    dice = Random(name)
    for number in range(_COUNT):
        yield number, DRAWS[name](dice)


@pytest.mark.parametrize("engine", ENGINES)
@pytest.mark.parametrize("name", DRAWS)
def test_frames_are_those_of_pymavlink(
    autopilot: Any, mavlink: Any, name: str, engine: str
) -> None:
    message = autopilot.MESSAGES[name]
    for number, values in _drawn(name):
        _, frame = _theirs(mavlink, name, values, number)
        own = message.from_dict(values)
        assert autopilot.encode(own, engine=engine, number=number) == frame
        assert autopilot.decode(frame, engine=engine) == own
        (event,) = autopilot.Decoder("pilot", engine).feed(frame)
        assert event.message == own
        assert event.payload == own.to_payload()
        assert "raw" not in event.as_json()


@pytest.mark.parametrize("engine", ENGINES)
@pytest.mark.parametrize("name", DRAWS)
def test_pymavlink_reads_as_much_out_of_any_frame(
    autopilot: Any, mavlink: Any, name: str, engine: str
) -> None:
    """The same values, however many of the zeros at the end were left out."""
    message = autopilot.MESSAGES[name]
    dice = Random(name)
    for number, values in _drawn(name):
        theirs, frame = _theirs(mavlink, name, values, number)
        own = message.from_dict(values)
        whole = own.to_payload()
        shortest = len(frame) - 12
        size = dice.randint(0 if not any(whole) else shortest, len(whole))
        head = frame[:1] + bytes([size]) + frame[2:10]
        carried = head + whole[:size]
        wire = carried + _sum(carried[1:])
        read = mavlink.MAVLink(None).decode(
            bytearray(carried + _sum(carried[1:], bytes([theirs.crc_extra])))
        )
        again = _theirs(mavlink, name, _values_of(read, name), number)
        assert again[1] == frame
        decoder = autopilot.Decoder("pilot", engine)
        (event,) = [*decoder.feed(wire), *decoder.flush()]
        assert event.message == own
        line = event.as_json()
        assert line.get("raw") == (None if wire == frame else wire.hex())
        assert autopilot.PROTOCOL.encode_line(line) == wire


def _values_of(read: Any, name: str) -> dict[str, Any]:
    """The values of a message of pymavlink, by the names of the schema."""
    found = {field: getattr(read, field) for field in read.fieldnames}
    if name == "servo_output_raw":
        every = [found.pop(f"servo{index}_raw") for index in range(1, 17)]
        found |= {"servo1_raw": every[:8], "more_raw": every[8:]}
    assert not any(isinstance(value, float) and math.isnan(value) for value in found.values())
    return found


# --- what is no frame ---------------------------------------------------------------------------


def test_a_value_that_zeros_can_not_be_is_found_behind_the_payload() -> None:
    module = module_at(STATION)
    frame = bytes.fromhex("FD 01 09 FD 00 00 00 9B A1")
    with pytest.raises(DecodeError, match="version") as caught:
        module.decode(frame)
    assert caught.value.offset == 6
    short = bytes.fromhex("FD 05 07 7E 00 00 C0 00 DB FE 00 6C 5A")
    with pytest.raises(DecodeError, match="no message of this identity has 5 bytes"):
        module.decode(short)


@pytest.mark.parametrize("engine", ENGINES)
def test_a_length_that_is_never_so_small_keeps_zeros(engine: str) -> None:
    module: Any = module_at(STUFFED)
    frame = module.encode(module.Status(flags=0), engine=engine)
    assert frame == bytes.fromhex("7E 7D 5E 04 00 00 7D 5E")  # 7E + 04 = 82; 100 - 82 = 7E


def test_each_form_leaves_out_what_it_does() -> None:
    module: Any = module_at(FORMS)
    wind = module.Wind(direction=192, speed=0)
    whole = bytes.fromhex("FE 04 05 C0 00 00 00 51 05")
    short = bytes.fromhex("FD 01 05 C0 5B DB")
    for engine in ENGINES:
        assert module.encode(wind, engine=engine) == whole
        assert module.encode(wind, engine=engine, form="whole") == whole
        assert module.encode(wind, engine=engine, form="short") == short


def test_an_unknown_frame_is_sent_as_it_is() -> None:
    module: Any = module_at(STATION)
    wire = bytes.fromhex("FD 02 09 77 00 00 05 00 D0 3A")
    made = module.PROTOCOL.encode_unknown("station", {"number": 9, "kind": 0x77}, b"\5\0")
    assert made == wire


def test_what_does_not_fit_the_message_is_refused_as_ever() -> None:
    module: Any = module_at(STATION)
    with pytest.raises(EncodeError, match="direction"):
        module.encode(module.Wind(direction=360, speed=0), number=0)


# --- changes ------------------------------------------------------------------------------------

LINK = """\
protocol: demo
endpoints: {board: Sensor board}
byte_order: little
frame:
  start:   {literal: 0xAA}
  length:  {type: uint8, counts: payload}
  kind:    {type: uint8, id: true}
  payload: {trailing_zeros: trimmed}
  crc:     {type: uint16, algorithm: CRC-16/KERMIT, covers: [kind, payload]}
transparency:
  covers: length..crc
  escape: {byte: 0xAB, of: [0xA5, 0xAA, 0xAB], transform: {xor: 0x20}}
messages:
  reading: {id: 1, from: board, fields: FIELDS}
"""


def _changes(before: str, after: str) -> set[tuple[str, str, str, str]]:
    old, new = (_protocol(LINK.replace("FIELDS", fields)) for fields in (before, after))
    return {
        (finding.change.rule, finding.change.place, finding.affected, str(finding.harm))
        for finding in findings(old, new)[1]
    }


def test_a_field_at_the_end_is_zero_in_old_frames() -> None:
    found = _changes("{value: uint16}", "{value: uint16, extra: float32}")
    assert found == {("field-added", "reading.extra", "old receiver of new frames", "rejected")}


def test_a_field_in_front_is_misread() -> None:
    found = _changes("{value: uint16}", "{extra: uint8, value: uint16}")
    assert {finding[2] for finding in found} == {"both"}


def test_a_field_that_can_not_be_zero_is_refused_in_old_frames() -> None:
    found = _changes("{value: uint16}", "{value: uint16, extra: {type: uint8, const: 7}}")
    assert {finding[3] for finding in found} == {"rejected"}
    assert {finding[2] for finding in found} == {"both"}
