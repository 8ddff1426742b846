"""C decoders of frames that a protected end delimits, where messages alone are asked for."""

from __future__ import annotations

from pathlib import Path
from random import Random
from typing import Literal

import pytest
from c_engine import check_events, process_of, python_events
from compiled import ROOT, module_at, protocol_of
from corpus import marks_of, material_of, stream_of
from test_c_decoder import steps_of

from protogen.fuzzing.c_calls import Step
from protogen.targets.c.decoders.members import members_of, memory_of
from protogen.targets.c.emit import unit_of
from protogen.targets.c.options import COptions

MESSAGES = COptions(events="messages")
KINDS: tuple[Literal["push", "feed"], ...] = ("push", "feed")
LONG_COBS = """
protocol: long_cobs
endpoints: {station: Weather station}
byte_order: big
frame:
  id: {type: uint8, id: true}
  payload: {}
  check: {type: uint8, algorithm: sum-8, covers: [id, payload]}
  end: {literal: 0}
transparency: {encoding: cobs}
messages:
  picture: {id: 1, from: station, fields: {data: {type: bytes, size: {fill: true, max: 600}}}}
  wind: {id: 2, from: station, fields: {speed: uint16}}
"""
SHARED_START = """
protocol: shared_start
endpoints: {station: Weather station}
byte_order: big
frame:
  opening: {literal: 0x7E}
  id: {type: uint8, id: true}
  length: {type: uint8, counts: [length, payload], range: [1, 9]}
  payload: {}
  check: {type: uint8, algorithm: sum-8, covers: opening..payload}
  closing: {literal: 0x7E}
transparency: hdlc
messages:
  wind: {id: 1, from: station, fields: {speed: uint16, direction: uint8}}
  calm: {id: 2, from: station}
"""
DIGITS = """
protocol: digits_between
endpoints: {station: Weather station}
byte_order: big
frame:
  start: {literal: 2}
  kind: {literal: 0x5A}
  version: {type: uint8, range: [1, 3], default: 2}
  payload: {}
  check: {type: uint16, algorithm: CRC-16/KERMIT, covers: kind..payload}
  end: {literal: 3}
transparency: {covers: kind..check, encoding: base16-upper}
messages:
  text: {from: station, fields: {data: {type: bytes, size: {fill: true, max: 40}}}}
"""
NEWER = """
protocol: newer_between_zeros
endpoints: {station: Weather station}
byte_order: little
frame:
  id: {type: uint8, id: true}
  length: {type: uint8, counts: payload}
  payload: {longer: cut}
  check: {type: uint8, algorithm: sum-8, covers: [id, payload]}
  end: {literal: 0}
transparency: {encoding: cobs}
messages:
  state: {id: 1, from: station, fields: {mode: {type: uint8, values: {off: 1}, closed: true}}}
  calm: {id: 2, from: station}
"""
NEWER_BEHIND_STARTS = """
protocol: newer_behind_starts
endpoints: {station: Weather station}
byte_order: little
frame:
  start: {literal: 2}
  id: {type: uint8, id: true}
  length: {type: uint8, counts: payload}
  payload: {longer: cut}
  check: {type: uint8, algorithm: sum-8, covers: [id, payload]}
transparency: {covers: id..check, escape: {byte: 0x1B, of: [2, 0x1B], transform: {xor: 0x20}}}
messages:
  state: {id: 1, from: station, fields: {mode: {type: uint8, values: {off: 1}, closed: true}}}
  calm: {id: 2, from: station}
"""
VERSION = """
protocol: version_between
endpoints: {station: Weather station}
byte_order: big
frame:
  start: {literal: 0x7E}
  version: {literal: 5}
  payload: {}
  check: {type: uint8, algorithm: sum-8, covers: [version, payload]}
  end: {literal: 0x7C}
transparency:
  covers: version..check
  escape: {byte: 0x7D, of: [0x7C, 0x7D, 0x7E], transform: invert}
messages:
  wind: {from: station, fields: {speed: uint16}}
"""
SCHEMAS = {
    "long_cobs": LONG_COBS,
    "shared_start": SHARED_START,
    "digits_between": DIGITS,
    "newer_between_zeros": NEWER,
    "version_between": VERSION,
}
DIGITS_BEHIND_STARTS = """
protocol: digits_behind_starts
endpoints: {station: Weather station}
byte_order: big
frame:
  start: {literal: 0x3A}
  id: {type: uint8, id: true}
  length: {type: uint8, counts: payload}
  payload: {}
  check: {type: uint8, algorithm: sum-8, covers: [id, length, payload]}
transparency: {covers: id..check, encoding: base16-upper}
messages:
  text: {id: 1, from: station, fields: {data: {type: bytes, size: {fill: true, max: 120}}}}
  wind: {id: 2, from: station, fields: {speed: uint16}}
"""
ONE_SIZE = """
protocol: one_size
endpoints: {station: Weather station}
byte_order: big
frame:
  start: {literal: 0x7E}
  version: {literal: 5}
  length: {type: uint8, counts: payload}
  gain: {type: uint8, default: 2}
  id: {type: uint8, id: true}
  payload: {}
  check: {type: uint8, algorithm: sum-8, covers: version..payload}
transparency: {covers: version..check, escape: {byte: 0x7D, of: [0x7D, 0x7E], transform: invert}}
messages:
  wind: {id: 1, from: station, fields: {speed: uint16}}
  rain: {id: 2, from: station, fields: {fallen: uint16}}
"""
FLAT = {
    "one_size": ONE_SIZE,
    "newer_behind_starts": NEWER_BEHIND_STARTS,
    "digits_behind_starts": DIGITS_BEHIND_STARTS,
}
"""Those whose frames are told by their start."""


@pytest.fixture(scope="module")
def paths(tmp_path_factory: pytest.TempPathFactory) -> dict[str, Path]:
    folder = tmp_path_factory.mktemp("delimited")
    found = {name: folder / f"{name}.yaml" for name in SCHEMAS | FLAT}
    for name, path in found.items():
        path.write_text((SCHEMAS | FLAT)[name], encoding="utf-8")
    return found


@pytest.mark.parametrize("name", [*SCHEMAS, "digits_behind_starts", "one_size"])
def test_streams_have_the_messages_that_python_finds(name: str, paths: dict[str, Path]) -> None:
    path = paths[name]
    [decoder] = unit_of(protocol_of(path), MESSAGES).framing.decoders
    assert decoder.flat if name in FLAT else decoder.delimited
    process, material = process_of(path, MESSAGES), material_of(path, "station")
    marks = marks_of(path, "station")
    for seed in range(12):
        dice = Random(f"{name} {seed}")
        data = stream_of(material, dice, 40).data
        data += bytes(dice.choice(marks) for _ in range(dice.randrange(200)))
        steps: list[Step] = [("clear",)] if seed % 2 else []
        check_events(process, module_at(path), "station", [*steps, *steps_of(data, dice)])


def test_groups_of_cobs_may_be_full(paths: dict[str, Path]) -> None:
    path = paths["long_cobs"]
    process, module = process_of(path, MESSAGES), module_at(path)
    steps: list[Step] = []
    for size in (*range(249, 257), *range(503, 511), 600):
        for data in (b"\x11" * size, b"\x11" * (size - 1) + b"\0", b"\0" + b"\x11" * (size - 1)):
            frame = module.encode(module.Picture(data=data))
            steps += [("push", frame), ("feed", frame), ("feed", needless(frame)), ("feed", frame)]
    check_events(process, module, "station", [*steps, ("flush",)])


def needless(frame: bytes) -> bytes:
    """The frame with a group behind the last that says nothing more: no encoder makes it."""
    return frame[:-1] + b"\x01\0"


# Each: id 01, length 00, check 01; id 01, length 01, mode 01, check 02; id 01, length 02, mode 01,
# then 09, check 0B.
SHORT_TO_LONG = {
    "newer_between_zeros": (
        b"\x02\x01\x02\x01\0",
        b"\x05\x01\x01\x01\x02\0",
        b"\x06\x01\x02\x01\x09\x0b\0",
    ),
    "newer_behind_starts": (
        b"\x02\x01\x00\x01",
        b"\x02\x01\x01\x01\x1b\x22",
        b"\x02\x01\x1b\x22\x01\x09\x0b",
    ),
}


@pytest.mark.parametrize("name", SHORT_TO_LONG)
def test_what_is_too_short_to_be_cut_is_no_message(paths: dict[str, Path], name: str) -> None:
    """Its checksum, 01, stands where the mode of a payload would, and is one."""
    path, frames = paths[name], SHORT_TO_LONG[name]
    steps: list[Step] = [(kind, data) for data in frames for kind in KINDS]
    found = python_events(module_at(path), "station", steps)
    assert [event.kind for events in found for event in events] == ["invalid"] * 2 + ["message"] * 4
    check_events(process_of(path, MESSAGES), module_at(path), "station", steps)


def test_what_stands_in_the_head_of_no_frame_is_no_message(paths: dict[str, Path]) -> None:
    """A frame of the schema, then the same with another byte in its head, and the checksum of that.

    Behind each is one of which no byte is wrong.
    """
    between = b"\x7e\x05\x01\x02\x08\x7c"
    others = (b"\x7e\x06\x01\x02\x09\x7c", b"\x7e\x04\x01\x02\x07\x7c")
    check_heads(paths["version_between"], between, others)
    one_size = b"\x7e\x05\x02\x02\x01\x01\x02\x0d"
    check_heads(
        paths["one_size"],
        one_size,
        (
            b"\x7e\x04\x02\x02\x01\x01\x02\x0c",
            b"\x7e\x05\x02\x02\x03\x01\x02\x0f",
            b"\x7e\x05\x03\x02\x01\x01\x02\x03\x11",
            b"\x7e\x05\x03\x02\x01\x01\x02\x0e",
            b"\x7e\x05\x01\x02\x01\x01\x0b",
            b"\x7e\x05\x00\x02\x01\x08",
        ),
    )


def check_heads(path: Path, frame: bytes, others: tuple[bytes, ...]) -> None:
    steps: list[Step] = []
    for kind in KINDS:
        steps += [(kind, data) for other in others for data in (frame, other, other + frame)]
    steps.append(("flush",))
    found = python_events(module_at(path), "station", steps)
    assert sum(event.kind == "message" for events in found for event in events) == 4 * len(others)
    check_events(process_of(path, MESSAGES), module_at(path), "station", steps)


def test_the_buffer_is_as_large_as_the_greatest_message() -> None:
    """Of README's rover: identity, five bytes, a checksum, and the zero that COBS begins with."""
    rover = protocol_of(ROOT / "benchmarks" / "c" / "rover.yaml")
    decoders = unit_of(rover, MESSAGES).framing.decoders
    [board] = [decoder for decoder in decoders if decoder.name == "board"]
    assert {member.name: member.size for member in members_of(board)} == {
        "content": 1,
        "node": 1,
        "buffer": 1 + 1 + 5 + 2,
    }
    assert memory_of(board) == 11


def test_no_start_is_kept() -> None:
    """Of the tether: identity, eight bytes and a checksum stand between two flags."""
    tether = protocol_of(ROOT / "benchmarks" / "c" / "tether.yaml")
    [winch] = unit_of(tether, MESSAGES).framing.decoders
    assert {member.name: member.size for member in members_of(winch)} == {
        "content": 1,
        "node": 1,
        "buffer": 1 + 8 + 2,
    }


def test_a_length_that_is_kept_is_not_counted_again() -> None:
    """rFLEX's sonars vary in number; class, number, subclass, length and checksum are kept."""
    atrv = protocol_of(ROOT / "benchmarks" / "c" / "atrv.yaml")
    [flex] = [d for d in unit_of(atrv, MESSAGES).framing.decoders if d.name == "flex"]
    assert {member.name: member.size for member in members_of(flex)} == {
        "content": 1,
        "node": 1,
        "buffer": 4 + flex.delimited.greatest_payload + 1,
    }
