"""Streams that arrive in small portions: what has not arrived whole is awaited, as far as possible.

The reference takes it byte by byte. The fast engine leaves it alone while it is plainly the
beginning of a frame, and nobody may see a difference.
"""

from __future__ import annotations

import gc
import tracemalloc
from collections.abc import Iterator
from itertools import islice
from pathlib import Path
from random import Random
from time import perf_counter
from typing import Any

import pytest
from compiled import module_at, name_of, protocol_of, senders
from corpus import (
    WHOLE,
    Material,
    Piece,
    joined,
    known_frames,
    material_of,
    pieces,
)
from hypothesis import settings

from protogen.runtime import decoder as runtime_decoder
from protogen.runtime.framing.machine import Candidate
from protogen.runtime.framing.prefix import prefix_of
from protogen.runtime.framing.sender import Cutter
from protogen.runtime.framing.starts import starts_of

EVERY_SENDER = pytest.mark.parametrize(("path", "sender"), senders(), ids=name_of)
SEEDS = range(max(4, settings().max_examples // 20))
GREATEST_PORTION = 100


def shown(events: list[Any]) -> list[tuple[Any, ...]]:
    return [(event.kind, event.offset, event.raw, repr(event)) for event in events]


def small_portions(data: bytes, dice: Random) -> Iterator[bytes]:
    """The data in portions of 1 to 100 bytes, mostly of like size."""
    most = dice.choice([1, 2, 7, 20, 64, GREATEST_PORTION])
    place = 0
    while place < len(data):
        size = dice.randint(1, most)
        yield data[place : place + size]
        place += size


def clean(material: Material, dice: Random) -> bytes:
    return joined([Piece(WHOLE, dice.choice(material.frames)) for _ in range(30)]).data


def noisy(material: Material, dice: Random) -> bytes:
    return joined(list(islice(pieces(material, dice), 40))).data


@EVERY_SENDER
@pytest.mark.parametrize("seed", SEEDS)
@pytest.mark.parametrize("stream", [clean, noisy])
def test_each_portion_gives_what_the_reference_gives(
    path: Path, sender: str, stream: Any, seed: int
) -> None:
    dice = Random(seed)
    data = stream(material_of(path, sender), dice)
    fast = module_at(path).Decoder(sender)
    reference = module_at(path).Decoder(sender, "construct")
    for piece in small_portions(data, dice):
        assert shown(fast.feed(piece)) == shown(reference.feed(piece))
        assert fast.pending == reference.pending
        if dice.random() < 0.02:
            assert shown(fast.flush()) == shown(reference.flush())
            assert fast.pending == reference.pending == 0
    assert shown(fast.flush()) == shown(reference.flush())


@EVERY_SENDER
@pytest.mark.parametrize("seed", SEEDS)
def test_nothing_is_awaited_behind_a_verdict(path: Path, sender: str, seed: int) -> None:
    """Also where the beginning of a frame is damaged: no verdict is left to a later byte."""
    spec = module_at(path).PROTOCOL.sender(sender)
    prefix = prefix_of(spec)
    if prefix is None:
        return
    dice = Random(seed)
    for piece in islice(pieces(material_of(path, sender), dice), 40):
        data = piece.data + dice.choice([b"", piece.data])
        start = starts_of(spec.frame)
        if start.context == 0 and start.find(data, 0, 1) != 0:
            continue
        candidate = Candidate(spec)
        due = 0
        for end, byte in enumerate(data, 1):
            is_seen = end >= due or byte not in prefix.plain
            wanted = prefix.wanted(data[:end], 0)
            assert prefix.wanted(b"\0\0" + data[:end], 2) == wanted
            if candidate.push(byte) is not None:
                assert wanted == 0
                assert is_seen
                break
            due = end + wanted if is_seen else due


AWAITED_BY_THE_REFERENCE = {
    ("checksum_only", "station"),  # Nothing marks where these frames start.
    ("idle_end", "station"),
    ("cobs", "station"),  # What a COBS group stands for is not clear before its end.
    ("hdlc", "station"),  # One flag ends a frame and starts the next.
    ("hdlc_lenient", "station"),
    ("separated_line", "receiver"),  # Behind the payload stands something that is no checksum.
    ("digit_parts", "station"),
    ("digit_lengths", "station"),
    ("mavlink_like", "craft_signed"),
    ("virtual_behind", "station"),
    ("virtual_parts", "station"),  # Where frames begin behind an end.
    ("escaped_counted", "station"),  # A length counts what is sent.
    ("sequences_counted", "station"),
    ("sequences_marked", "station"),  # What was put in has to be found.
    ("slip", "station"),
    ("told_numbers", "station"),
    ("told_presence", "station"),
    ("terminated", "station"),
    ("last_elements", "station"),
    ("sized_arrays", "station"),
    ("regions", "station"),
    ("last_elements_alone", "device"),
    ("terminated_alone", "device"),  # Nothing marks where these frames start.
    ("part_fields", "sensor"),  # Fields are numbers of the frame.
    ("part_fields", "host"),
    ("part_fields_alone", "device"),
}


@EVERY_SENDER
def test_who_awaits_frames(path: Path, sender: str) -> None:
    prefix = prefix_of(module_at(path).PROTOCOL.sender(sender))
    assert (prefix is None) == ((name_of(path), sender) in AWAITED_BY_THE_REFERENCE)


@pytest.fixture
def candidates(monkeypatch: pytest.MonkeyPatch) -> list[Any]:
    """The candidates that decoders make from now on."""
    made: list[Any] = []

    class Counted(Candidate):
        def __init__(self, *given: Any, **named: Any) -> None:
            super().__init__(*given, **named)
            made.append(self)

    monkeypatch.setattr(runtime_decoder, "Candidate", Counted)
    return made


@EVERY_SENDER
@pytest.mark.parametrize("size", [1, 8, 64])
def test_a_clean_stream_in_portions_does_not_need_the_reference(
    path: Path, sender: str, size: int, candidates: list[Any]
) -> None:
    """Wherever a portion ends: in a head, a checksum, an end or the stuffing of a byte."""
    if prefix_of(module_at(path).PROTOCOL.sender(sender)) is None:
        return
    messages = known_frames(path, protocol_of(path).sender(sender))
    frames = [frame for frame in messages if _is_cut_fast(path, sender, frame, candidates)]
    candidates.clear()
    data = b"".join(frames)
    decoder = module_at(path).Decoder(sender)
    split = [data[place : place + size] for place in range(0, len(data), size)]
    events = [event for piece in split for event in decoder.feed(piece)]
    assert [event.raw for event in events] == frames
    assert not candidates


def _is_cut_fast(path: Path, sender: str, frame: bytes, candidates: list[Any]) -> bool:
    candidates.clear()
    events = module_at(path).Decoder(sender).feed(frame)
    return [event.kind for event in events] == ["message"] and not candidates


# --- large frames in little portions --------------------------------------------------------------


@EVERY_SENDER
@pytest.mark.parametrize("looked", [0, 1, 20])
@pytest.mark.parametrize("stream", [clean, noisy])
def test_what_is_left_to_a_candidate_gives_the_same(
    path: Path, sender: str, stream: Any, looked: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Here with frames of any size, so that all that can happen to a large one does happen."""
    dice = Random(looked)
    portions = list(small_portions(stream(material_of(path, sender), dice), dice))
    flushes = {number for number in range(len(portions)) if dice.random() < 0.02}
    expected = steps(module_at(path).Decoder(sender, "construct"), portions, flushes)
    monkeypatch.setattr(runtime_decoder, "_LOOKED", looked)
    for engine in ("fast", "construct"):
        assert steps(module_at(path).Decoder(sender, engine), portions, flushes) == expected


def steps(decoder: Any, portions: list[bytes], flushes: set[int]) -> list[Any]:
    """Result of each step, and what it leaves behind."""
    found = []
    for number, portion in enumerate(portions):
        found.append((shown(decoder.feed(portion)), decoder.pending))
        if number in flushes:
            found.append((shown(decoder.flush()), decoder.pending))
    return [*found, shown(decoder.flush())]


LARGE = """
protocol: large
endpoints: {station: Station}
byte_order: little
frame:
  sync: {literal: 0x55, unprotected: accepted}
  id: {type: uint8, id: true}
  count: {type: uint16, counts: payload}
  payload: {}
  check: {type: uint8, algorithm: sum-8, covers: id..payload}
messages:
  list: {id: 2, from: station, fields: {a: {type: bytes, size: fill}}}
decisions: {accepted: {question: Q, document: D, choice: C, because: B}}
"""


def test_the_time_for_a_frame_grows_with_its_size(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Not with the square of it: how many bytes are looked at or copied, with each byte fed."""
    path = tmp_path / "large.yaml"
    path.write_text(LARGE, encoding="utf-8")
    monkeypatch.setattr(runtime_decoder, "_LOOKED", 64)
    fast = [looked_at(path, size, "fast") for size in (1000, 4000, 16000)]
    assert all(count < 64 * 64 * 2 + 20 * size for count, size in fast), fast
    reference = [looked_at(path, size, "construct") for size in (1000, 4000, 16000)]
    assert all(count < 64 * 64 * 2 + 20 * size for count, size in reference), reference


@EVERY_SENDER
def test_an_end_is_not_looked_for_behind_the_longest_frame(path: Path, sender: str) -> None:
    """Else many starts without an end in one portion take time that grows with its square."""
    spec = module_at(path).PROTOCOL.sender(sender)
    if spec.cut is None or spec.frame.end is None:
        return
    filler = b"0" * (spec.frame.greatest + 1)
    assert spec.frame.end.value not in filler
    for frame in islice(known_frames(path, protocol_of(path).sender(sender)), 0, None, 8):
        open_frame = frame.removesuffix(spec.frame.end.value) + filler
        looked = [seconds_to_cut(spec.cut, open_frame + b"0" * more) for more in (0, 10_000_000)]
        assert looked[1] < 10 * looked[0] + 50e-6


class Watched(bytes):
    """Bytes that note how large the pieces are that are taken of them."""

    def __new__(cls, data: bytes, taken: list[int]) -> Watched:
        watched = super().__new__(cls, data)
        watched.taken = taken
        return watched

    taken: list[int]

    def __getitem__(self, place: Any) -> Any:
        piece = super().__getitem__(place)
        if isinstance(piece, bytes):
            self.taken.append(len(piece))
        return piece


@EVERY_SENDER
def test_a_beginning_is_not_judged_by_more_than_the_longest_frame(path: Path, sender: str) -> None:
    """Else damaged frames in one portion take time that grows with its square."""
    spec = module_at(path).PROTOCOL.sender(sender)
    prefix = prefix_of(spec)
    if prefix is None:
        return
    for frame in islice(known_frames(path, protocol_of(path).sender(sender)), 0, None, 8):
        taken: list[int] = []
        behind = b"0" * (10 * spec.frame.greatest)
        assert prefix.wanted(Watched(frame + behind, taken), 0) == 0
        assert max(taken, default=0) <= spec.frame.greatest


def seconds_to_cut(cut: Cutter, data: bytes) -> float:
    """The time in which a cutter sees that no whole frame stands in front."""
    best = 1.0
    for _ in range(7):
        begun = perf_counter()
        assert cut(data, 0, 0, []) == 0
        best = min(best, perf_counter() - begun)
    return best


@pytest.mark.parametrize("engine", ["fast", "construct"])
def test_nothing_fed_leaves_nothing_behind(tmp_path: Path, engine: str) -> None:
    """As from a port that is read with a timeout, in the middle of a large frame."""
    path = tmp_path / "large.yaml"
    path.write_text(LARGE, encoding="utf-8")
    module = module_at(path)
    frame = module.encode(module.List(a=bytes(9000)), "station")
    decoder = module.Decoder("station", engine)
    assert decoder.feed(frame[:6000]) == []
    before = decoder._wanted, len(decoder._behind), decoder.pending
    assert [decoder.feed(b"") for _ in range(5)] == [[]] * 5
    assert (decoder._wanted, len(decoder._behind), decoder.pending) == before
    assert [event.raw for event in decoder.feed(frame[6000:])] == [frame]


@pytest.mark.parametrize("engine", ["fast", "construct"])
def test_a_frame_takes_memory_for_its_bytes_and_not_for_its_portions(
    tmp_path: Path, engine: str
) -> None:
    path = tmp_path / "large.yaml"
    path.write_text(LARGE, encoding="utf-8")
    module = module_at(path)
    frame = module.encode(module.List(a=bytes(place % 251 for place in range(30000))), "station")
    decoder = module.Decoder("station", engine)
    tracemalloc.start()
    try:
        for place in range(0, len(frame) - 2, 2):
            assert decoder.feed(frame[place : place + 2]) == []
        gc.collect()  # Else it would be a matter of when the interpreter last did.
        kept, _ = tracemalloc.get_traced_memory()
    finally:
        tracemalloc.stop()
    assert kept < 6 * len(frame)


def looked_at(path: Path, size: int, engine: str) -> tuple[int, int]:
    """Number of bytes looked at until a frame that comes byte by byte is whole, and its size."""
    module = module_at(path)
    frame = module.encode(module.List(a=bytes(place % 251 for place in range(size))), "station")
    decoder = module.Decoder("station", engine)
    looked = [0]

    def counted(function: Any) -> Any:
        def call(*given: Any) -> Any:
            looked[0] += len(decoder._data)
            return function(*given)

        return call

    for name in ("_lane", "_cut_frames", "_wanted_at", "_join", "_deliver"):
        if getattr(decoder, name) is not None:
            setattr(decoder, name, counted(getattr(decoder, name)))
    events = [event for byte in frame for event in decoder.feed(bytes([byte]))]
    assert [event.kind for event in events] == ["message"]
    return looked[0], len(frame)


# --- frames that no document has ------------------------------------------------------------------

TWO_MESSAGES = """
messages:
  reading: {id: 0x41, from: station, fields: {a: uint7, b: {type: uint7, count: 40}}}
  list: {id: 0x42, from: station, fields: {a: uint7, b: {type: uint7, count: a}}}
"""

RARE = {
    "numbers with padding in the head, and an end of two bytes": """
byte_bits: 7
byte_order: little
frame:
  sync: {literal: {hex: 80 81}}
  id: {type: uint9, id: true}
  count: {type: uint7, counts: payload}
  payload: {}
  check: {type: uint3, algorithm: CRC-3/GSM, covers: id..payload}
  end: {literal: {hex: 80 82}}
"""
    + TWO_MESSAGES,
    "stuffing behind the identity": """
frame:
  sync: {literal: 0x01}
  id: {type: uint8, id: true, range: [0x40, 0x60]}
  payload: {}
  check: {type: uint8, algorithm: xor-8, covers: id..payload}
transparency:
  escape: {byte: 0xFC, of: [0x01, 0xFC], transform: {xor: 0x20}}
  covers: payload..check
"""
    + TWO_MESSAGES.replace("uint7", "uint8"),
    "many bytes that are stuffed, and a literal among them": """
frame:
  sync: {literal: 0x01}
  count: {type: uint8, counts: payload}
  mark: {literal: 0xDA}
  id: {type: uint8, id: true}
  payload: {}
  check: {type: uint8, algorithm: xor-8, covers: id..payload}
transparency:
  escape: {byte: 0xFC, of: [0x01, 0x02, 0x11, 0x13, 0x40, 0xFC], transform: {xor: 0x20}}
  covers: count..check
"""
    + TWO_MESSAGES.replace("uint7", "uint8"),
    "a checksum behind the stuffing, and bytes of 7 bits": """
byte_bits: 7
byte_order: little
frame:
  sync: {literal: {hex: 81 82}}
  id: {type: uint7, id: true}
  count: {type: uint7, counts: payload}
  payload: {}
  check: {type: uint28, algorithm: {width: 28, poly: 0x1234567}, covers: payload}
  end: {literal: {hex: 83 84}}
transparency:
  escape: {byte: 0x76, of: [0x76, 0x42], transform: none}
  covers: payload..payload
"""
    + TWO_MESSAGES.replace("0x42", "0x43"),
    "any of several bytes starts a frame": """
byte_bits: 7
frame:
  id: {type: byte, id: true, range: [0x80, 0xFE]}
  payload: {}
  check: {type: uint3, algorithm: CRC-3/GSM, covers: id..payload}
"""
    + TWO_MESSAGES.replace("0x4", "0x8"),
    "digits behind numbers that are none": """
byte_order: little
frame:
  sync: {literal: 0x01}
  number: {type: uint8, default: 0x41, range: [0x40, 0xFF]}
  id: {type: uint8, id: true}
  count: {type: uint8, counts: payload}
  payload: {}
  check: {type: uint8, algorithm: xor-8, covers: id..payload}
  end: {literal: {hex: 02 03}}
transparency: {encoding: base16-upper, covers: id..check}
"""
    + TWO_MESSAGES.replace("uint7", "uint8"),
    "the byte that starts a frame may begin its end": """
frame:
  begin: {type: uint8, range: [0x80, 0xED]}
  version: {literal: 6}
  id: {type: uint8, id: true}
  payload: {}
  check: {type: uint8, algorithm: xor-8, covers: id..payload}
  end: {literal: {hex: 99 99 4E}}
transparency:
  escape: {byte: 0x9F, of: [0x99, 0x9F], transform: {xor: 0x20}}
  covers: id..check
"""
    + TWO_MESSAGES,
}


@pytest.mark.parametrize("frame", RARE)
def test_rare_frames(frame: str, tmp_path: Path, candidates: list[Any]) -> None:
    path = tmp_path / "rare.yaml"
    path.write_text(f"protocol: rare\nendpoints: {{station: Station}}\n{RARE[frame]}")
    for seed in range(8):
        for stream in (clean, noisy):
            test_each_portion_gives_what_the_reference_gives(path, "station", stream, seed)
        test_nothing_is_awaited_behind_a_verdict(path, "station", seed)
    module = module_at(path)
    whole = next(frame for frame in material_of(path, "station").frames if len(frame) > 40)
    candidates.clear()
    decoder = module.Decoder("station")
    assert not any(decoder.feed(byte) for byte in (whole[place : place + 1] for place in range(40)))
    assert decoder.pending == 40
    assert not candidates


# --- frames that a function could go on with for ever, or take too early --------------------------

UNCLEAR = {
    "nothing but the next start ends a frame, and an empty one is no more than its start": """
frame:
  sync: {literal: {hex: 7E D1 7E}}
  payload: {}
  check: {type: uint8, algorithm: sum-8/negated, when: payload, covers: payload}
transparency: {escape: {byte: 0x7D, of: [0x7D, 0x7E], transform: {xor: 0x20}}}
messages:
  empty: {from: station, fields: {}}
""",
    "the length does not count a checksum that is absent where there is no payload": """
frame:
  sync: {literal: {hex: D5}, unprotected: accepted}
  id: {type: uint8, id: true}
  count: {type: uint8, counts: payload}
  payload: {}
  check: {type: uint8, algorithm: sum-8, when: payload, covers: payload}
messages:
  empty: {id: 1, from: station, fields: {}}
  list: {id: 2, from: station, fields: {a: {type: bytes, size: fill}}}
decisions: {accepted: {question: Q, document: D, choice: C, because: B}}
""",
    "digits between numbers that are none": """
byte_order: little
decisions: {accepted: {question: Q, document: D, choice: C, because: B}}
frame:
  sync: {literal: 0x01, unprotected: accepted}
  number: {type: uint8, default: 0x41}
  id: {type: uint8, id: true}
  count: {type: uint8, counts: payload}
  payload: {}
  check: {type: uint8, algorithm: xor-8, covers: id..payload}
  end: {literal: 0x02, unprotected: accepted}
transparency: {encoding: base16-upper, covers: id..payload}
"""
    + TWO_MESSAGES.replace("uint7", "uint8"),
}


@pytest.mark.parametrize("frame", UNCLEAR)
def test_unclear_frames(frame: str, tmp_path: Path) -> None:
    path = tmp_path / "unclear.yaml"
    path.write_text(f"protocol: unclear\nendpoints: {{station: Station}}\n{UNCLEAR[frame]}")
    for seed in range(12):
        for stream in (clean, noisy):
            test_each_portion_gives_what_the_reference_gives(path, "station", stream, seed)
        test_nothing_is_awaited_behind_a_verdict(path, "station", seed)
