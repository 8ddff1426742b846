"""C decoders of frames in which a start may stand, where messages alone are asked for."""

from __future__ import annotations

from itertools import chain
from pathlib import Path
from random import Random

import pytest
from amounts import OF_TWO_ENGINES
from c_engine import Process, check_events, messages_of, process_of, python_events
from compiled import ROOT, module_at, protocol_of
from corpus import material_of, stream_of
from hypothesis import given, settings
from hypothesis import strategies as st
from test_c_decoder import steps_of

from protogen.fuzzing.c_calls import Step
from protogen.targets.c.decoders.decoder import DecoderView
from protogen.targets.c.decoders.members import members_of, memory_of
from protogen.targets.c.emit import emit, unit_of
from protogen.targets.c.options import COptions

MESSAGES = COptions(events="messages")
SCHEMA = """
protocol: kept
byte_order: big
endpoints:
  lamp: Start and end
  dial: Start of two bytes, and nothing is summed
  line: End of two bytes, and no start
  word: End of one byte behind an identity
  pair: Nothing but a payload and an end
  twin: An end of two bytes behind a payload of two
  three: An identity that is the end
  free: Nothing but a payload and its sum
  long_lamp: Start and end, around more than five bytes
  long_line: End of two bytes, and no start
  long_word: End of one byte behind an identity
  long_free: Nothing but a payload and its sum
  seal: Bytes behind the payload that are the same in each frame
  narrow: Length of one byte
  wide: Length of two bytes, and end of two
  late: Identity behind the payload
  bare: Nothing but a length in front
  table: Several messages of an identity
frame:
  lamp:
    start: {literal: 2, unprotected: anywhere}
    payload: {}
    check: {type: uint8, algorithm: sum-8, covers: payload}
    end: {literal: 3, unprotected: anywhere}
  dial:
    start: {literal: [2, 2], unprotected: anywhere}
    payload: {}
  line:
    payload: {}
    check: {type: uint8, algorithm: xor-8, covers: payload}
    end: {literal: [3, 2], unprotected: anywhere}
  word:
    id: {type: uint8, id: true}
    payload: {}
    check: {type: uint8, algorithm: xor-8, covers: [id, payload], when: payload}
    end: {literal: 3, unprotected: anywhere}
  pair:
    payload: {}
    end: {literal: 3, unprotected: anywhere}
  twin:
    payload: {}
    end: {literal: [1, 2], unprotected: anywhere}
  three:
    id: {type: uint8, id: true}
    payload: {}
    check: {type: uint8, algorithm: xor-8, covers: [id, payload], when: payload}
    end: {literal: 3, unprotected: anywhere}
  free:
    payload: {}
    check: {type: uint8, algorithm: sum-8, covers: payload}
  long_lamp:
    start: {literal: 2, unprotected: anywhere}
    payload: {}
    check: {type: uint8, algorithm: sum-8, covers: payload}
    end: {literal: 3, unprotected: anywhere}
  long_line:
    payload: {}
    check: {type: uint8, algorithm: xor-8, covers: payload}
    end: {literal: [3, 2], unprotected: anywhere}
  long_word:
    id: {type: uint8, id: true}
    payload: {}
    check: {type: uint8, algorithm: xor-8, covers: [id, payload], when: payload}
    end: {literal: 3, unprotected: anywhere}
  long_free:
    payload: {}
    check: {type: uint8, algorithm: sum-8, covers: payload}
  seal:
    start: {literal: 2, unprotected: anywhere}
    payload: {}
    version: {literal: 4}
    number: {type: uint8, digits: base10, range: [0, 5], default: 2}
    check: {type: uint8, algorithm: sum-8, covers: payload..number}
  narrow:
    start: {literal: 2, unprotected: anywhere}
    length: {type: uint8, counts: payload}
    id: {type: uint8, id: true}
    payload: {}
    check: {type: uint8, algorithm: xor-8, covers: [length, id, payload]}
  wide:
    start: {literal: [2, 3], unprotected: anywhere}
    length: {type: uint16, counts: [length, id, payload]}
    id: {type: uint8, id: true}
    payload: {}
    end: {literal: [3, 2], unprotected: anywhere}
  late:
    start: {literal: 2, unprotected: anywhere}
    length: {type: uint8, counts: payload}
    payload: {}
    id: {type: uint8, id: true}
    check: {type: uint8, algorithm: sum-8, covers: [length, payload, id]}
  bare:
    length: {type: uint8, counts: payload}
    payload: {}
    check: {type: uint8, algorithm: sum-8, covers: [length, payload]}
  table:
    start: {literal: 2, unprotected: anywhere}
    id: {type: uint8, id: true}
    length: {type: uint8, counts: payload}
    payload: {}
    check: {type: uint8, algorithm: xor-8, covers: payload}
    end: {literal: 3, unprotected: anywhere}
messages:
  light: {from: lamp, fields: {level: uint16}}
  angle: {from: dial, fields: {degrees: uint16}}
  weight: {from: line, fields: {grams: uint16}}
  go: {id: 2, from: word, fields: {speed: uint8}}
  stop: {id: 4, from: word, fields: {brake: uint8}}
  level: {from: pair, fields: {level: uint8}}
  depth: {from: twin, fields: {depth: uint16}}
  turn: {id: 3, from: three, fields: {speed: uint8}}
  halt: {id: 2, from: three, fields: {brake: uint8}}
  drop: {from: free, fields: {level: uint16}}
  bulb: {from: long_lamp, fields: {red: uint16, green: uint16}}
  load: {from: long_line, fields: {net: uint16, gross: uint16}}
  ahead: {id: 2, from: long_word, fields: {left: uint16, right: uint16}}
  aside: {id: 4, from: long_word, fields: {angle: uint32}}
  spring: {from: long_free, fields: {rate: uint16, level: uint32}}
  valve: {from: seal, fields: {opening: uint8}}
  small: {id: 2, from: [narrow, wide, late], fields: {one: uint8}}
  mode:
    id: 3
    from: [narrow, wide, late]
    fields: {mode: {type: uint8, values: {off: 2, on: 3}, closed: true}, more: uint8}
  text:
    id: 4
    from: [narrow, late]
    fields: {data: {type: bytes, size: {fill: true, max: 12}}}
  record:
    id: 4
    from: wide
    fields: {data: {type: bytes, size: {fill: true, max: 300}}}
  note: {from: bare, fields: {data: {type: bytes, size: {fill: true, max: 5}}}}
  brief: {id: 2, from: table, fields: {one: uint8}}
  long: {id: 2, from: table, fields: {one: uint16}}
  rest:
    id: 2
    from: table
    fields: {one: uint32, data: {type: bytes, size: {fill: true, max: 3}}}
  other: {id: 3, from: table}
overloads:
  by_size: {messages: [brief, long, rest], by: size}
decisions:
  anywhere:
    question: What keeps a delimiter out of the data?
    document: Nothing does.
    choice: A receiver looks for the next one inside of what fails.
    because: Most protocols of this shape do so.
"""
SMALL = {"lamp": 2, "dial": 2, "line": 2, "word": 1, "pair": 1, "twin": 2, "three": 1, "free": 2}
"""Senders whose frames have up to five bytes, and the size of all their payloads."""
ONE_SIZE = {**SMALL, "long_lamp": 4, "long_line": 4, "long_word": 4, "long_free": 6, "seal": 1}
"""Senders whose payloads all have a size, and that size."""
SIZED = ("narrow", "wide", "late", "bare", "table")
SENDERS = (*ONE_SIZE, *SIZED)
UNSUMMED = """
protocol: unsummed
byte_order: big
endpoints: {lamp: Sends, host: Receives}
frame:
  start: {literal: 1, unprotected: anywhere}
  length: {type: uint8, counts: [length, payload]}
  id: {type: uint8, id: true}
  payload: {}
  check: {type: uint32, algorithm: CRC-32/ISO-HDLC, covers: [id, payload], when: payload}
messages: {ping: {id: 1, from: lamp}}
decisions:
  anywhere: {question: Q, document: D, choice: C, because: B}
"""
PROBE = ROOT / "benchmarks" / "c" / "probe.yaml"
DAGNY = ROOT / "schemas" / "dagny.yaml"
COMMANDS = COptions(events="messages", only=("motor", "steering", "reflex", "power"))


@pytest.fixture(scope="module")
def path(tmp_path_factory: pytest.TempPathFactory) -> Path:
    found = tmp_path_factory.mktemp("kept") / "kept.yaml"
    found.write_text(SCHEMA, encoding="utf-8")
    return found


def decoder_of(path: Path, sender: str, options: COptions = MESSAGES) -> DecoderView:
    decoders = unit_of(protocol_of(path), options).framing.decoders
    return next(decoder for decoder in decoders if decoder.name == sender)


# --- streams --------------------------------------------------------------------------------------


def mixed(path: Path, sender: str, dice: Random) -> bytes:
    """Frames, damaged ones, and beginnings of some inside of which others stand."""
    material = material_of(path, sender)
    data = stream_of(material, dice, 20).data[:3000]
    for _ in range(12):
        frame = dice.choice(material.frames)
        data += frame[: dice.randrange(len(frame))] + dice.choice(material.frames)
    return data


def single(data: bytes, dice: Random) -> list[Step]:
    """A step for each byte, so that a message that comes too early or too late is seen."""
    kinds = ("push", "feed")
    return [(dice.choice(kinds), bytes((byte,))) for byte in data] + [("flush",)]


@pytest.mark.parametrize("sender", SENDERS)
def test_streams_have_the_messages_that_python_finds(path: Path, sender: str) -> None:
    decoder = decoder_of(path, sender)
    assert decoder.kept is not None
    assert decoder.kept.has_window == (sender in SMALL)
    assert (decoder.kept.only_size, decoder.gives_more) == (ONE_SIZE.get(sender), sender in SIZED)
    process = process_of(path, MESSAGES)
    for seed in range(6):
        dice = Random(f"{sender} {seed}")
        data = mixed(path, sender, dice)
        steps: list[Step] = [("clear",)] if seed % 2 else []
        steps += steps_of(data, dice) if seed % 3 else single(data[-1000:], dice)
        check_events(process, module_at(path), sender, steps)


@pytest.mark.parametrize("sender", SENDERS)
@settings(max_examples=OF_TWO_ENGINES)
@given(data=st.lists(st.sampled_from((0, 1, 2, 3, 4, 5)), max_size=60), dice=st.randoms())
def test_bytes_that_tell_something_make_the_same_messages(
    path: Path, sender: str, data: list[int], dice: Random
) -> None:
    steps = single(bytes(data), dice)
    check_events(process_of(path, MESSAGES), module_at(path), sender, [("clear",), *steps])


@pytest.mark.parametrize(
    ("schema", "sender", "options"),
    [
        (DAGNY, "host", COMMANDS),
        (PROBE, "sensor", MESSAGES),
        (PROBE, "sensor", COptions(events="messages", only=("power",))),
    ],
    ids=["dagny", "probe", "power"],
)
def test_documents_have_the_messages_that_python_finds(
    schema: Path, sender: str, options: COptions
) -> None:
    assert decoder_of(schema, sender, options).kept
    process = process_of(schema, options)
    for seed in range(6):
        dice = Random(f"{sender} {seed}")
        data = mixed(schema, sender, dice)
        steps = steps_of(data, dice) if seed % 2 else single(data[-1000:], dice)
        check_events(process, process.module, sender, steps)


def test_a_checksum_that_no_frame_has_leaves_no_function_that_nobody_calls(tmp_path: Path) -> None:
    path = tmp_path / "unsummed.yaml"
    path.write_text(UNSUMMED, encoding="utf-8")
    [source] = [
        file.text for file in emit([protocol_of(path)], MESSAGES) if file.path.suffix == ".c"
    ]
    assert "_load_u32be" not in source


# --- by hand --------------------------------------------------------------------------------------

# Start, length 0C and identity of a text; then one of 7, 02 01 02 07 04, and one of 8,
# 02 01 02 08 0B, which the text would have as its data; its last two bytes; and 00, no sum of it.
INSIDE = bytes.fromhex("02 0C 04  02 01 02 07 04  02 01 02 08 0B  00 00  00")
FIRST_TWO = [("small", {"one": 7}), ("small", {"one": 8})]


def values_of(
    process: Process, steps: list[Step], sender: str = "narrow"
) -> list[list[tuple[str, object]]]:
    """The messages of each step, which are those that Python finds."""
    found = process.do(process.calls.events(sender, steps))
    assert found == messages_of(python_events(process.module, sender, steps))
    return [[(event.message, event.values) for event in events] for events in found]


def test_a_byte_that_makes_a_candidate_fail_gives_all_messages_inside(path: Path) -> None:
    steps: list[Step] = [("push", INSIDE[:-1]), ("push", INSIDE[-1:])]
    assert values_of(process_of(path, MESSAGES), steps) == [[], FIRST_TWO]


def test_the_end_of_the_input_gives_all_messages_inside(path: Path) -> None:
    steps: list[Step] = [("feed", INSIDE[:-1]), ("flush",), ("push", INSIDE[3:8]), ("flush",)]
    assert values_of(process_of(path, MESSAGES), steps) == [[], FIRST_TWO, FIRST_TWO[:1], []]


def test_what_is_left_in_front_of_the_next_frame_is_looked_at(path: Path) -> None:
    """Behind the two that stand inside, a third begins, and the rest of it follows."""
    third = bytes.fromhex("02 01 02 09 0A")  # 01 xor 02 xor 09 is 0A.
    data = INSIDE[:-3] + third
    steps: list[Step] = [("push", data[: len(INSIDE)]), ("push", data[len(INSIDE) :])]
    found = list(chain.from_iterable(values_of(process_of(path, MESSAGES), steps)))
    assert found == [*FIRST_TWO, ("small", {"one": 9})]


# --- small frames, by hand ------------------------------------------------------------------------


def commands(*steps: Step) -> list[list[tuple[str, object]]]:
    """What each step brings of dagny's commands."""
    return values_of(process_of(DAGNY, COMMANDS), list(steps), "host")


def test_a_newline_inside_of_a_command_is_a_byte_like_any_other() -> None:
    """4D xor 0A is 47, and 4D xor 47 is 0A."""
    data = bytes.fromhex("4D 0A 47 0A  4D 47 0A 0A")
    found = [("motor", {"s": 0x0A}), ("motor", {"s": 0x47})]
    assert commands(("feed", data)) == [found]
    assert (
        list(chain.from_iterable(commands(*(("push", bytes((byte,))) for byte in data)))) == found
    )


def test_a_command_is_found_behind_a_newline_of_what_failed() -> None:
    """5A is no command; one begins behind its newline, before the four bytes of the other end."""
    assert commands(("push", bytes.fromhex("5A 0A 4D 05 48 0A"))) == [[("motor", {"s": 5})]]


def test_a_command_that_stands_behind_no_newline_is_none() -> None:
    assert commands(("push", bytes.fromhex("00 4D 05 48 0A")), ("flush",)) == [[], []]


def test_a_silence_is_as_good_as_a_newline_and_ends_a_command_that_was_begun() -> None:
    steps: list[Step] = [("push", b"\x4d\x05"), ("flush",), ("push", b"\x48\x0a")]
    assert commands(*steps) == [[], [], []]
    steps = [("push", b"\x4d\x05"), ("flush",), ("push", b"\x4d\x05\x48\x0a")]
    assert commands(*steps) == [[], [], [("motor", {"s": 5})]]


def test_a_silence_divides_an_end_of_two_bytes(path: Path) -> None:
    """03 02 is an end of `line`; 02 alone is none, and what follows it stands behind no end."""
    weight = bytes.fromhex("00 07 07 03 02")
    found = [("weight", {"grams": 7})]
    process = process_of(path, MESSAGES)
    steps: list[Step] = [("push", b"\x04\x03"), ("push", b"\x02" + weight)]
    assert values_of(process, steps, "line") == [[], found]
    steps = [("push", b"\x04\x03"), ("flush",), ("push", b"\x02" + weight)]
    assert values_of(process, steps, "line") == [[], [], []]


@settings(max_examples=OF_TWO_ENGINES)
@given(
    data=st.lists(st.sampled_from((0x0A, 0x4D, 0x47, 0x50, 0x52, 0x02)), max_size=60),
    dice=st.randoms(),
)
def test_bytes_of_commands_make_the_same_messages(data: list[int], dice: Random) -> None:
    """4D and 47, 50 and 0A, 52 and 02 are halves of commands."""
    steps: list[Step] = [("clear",), *single(bytes(data), dice)]
    for _ in range(dice.randrange(3)):
        steps.insert(dice.randrange(1, len(steps) + 1), ("flush",))
    process = process_of(DAGNY, COMMANDS)
    check_events(process, process.module, "host", steps)


# --- memory ---------------------------------------------------------------------------------------


def test_small_frames_behind_an_end_need_no_more_than_their_size() -> None:
    """Of dagny's commands: identity, a byte and its sum; and a bit for each end among them."""
    host = decoder_of(DAGNY, "host", COMMANDS)
    assert {item.name: item.size for item in members_of(host)} == {"passed": 1, "buffer": 3}
    assert memory_of(host) == 4


@pytest.mark.parametrize("sender", SMALL)
def test_small_frames_need_no_more_than_their_bytes_and_a_counter(path: Path, sender: str) -> None:
    decoder = decoder_of(path, sender)
    assert memory_of(decoder) <= decoder.plan.greatest + 1


def test_no_more_is_kept_than_the_greatest_frame() -> None:
    """Of the probe: two bytes of start, length, identity, ten of attitude, and four of a sum."""
    sensor = decoder_of(PROBE, "sensor")
    assert {item.name: item.size for item in members_of(sensor)} == {
        "content": 1,
        "due": 1,
        "ending": 1,
        "buffer": 2 + 1 + 1 + 10 + 4,
    }
