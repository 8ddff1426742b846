"""Frames that are read in bulk: the same tables as by events, whatever the bytes are."""

from __future__ import annotations

from pathlib import Path
from random import Random
from typing import Any

import handwritten_streams
import pytest
from bulk_support import (
    check_bulk,
    left_to_events,
    pieces_of,
    reading,
    reading_at,
    tables_of,
)
from capture_support import assert_same_tables
from compiled import ROOT, SCHEMAS, module_at, name_of, protocol_of
from corpus import joined as pieces_joined
from corpus import known_frames, marks_of, material_of, stream_of
from hypothesis import HealthCheck, Phase, given, settings
from hypothesis import strategies as st
from schema_fuzzing import Schema, codec, schemas
from schema_fuzzing.streams import portions, streams
from schema_fuzzing.text import to_yaml
from schema_fuzzing.values import parts_of, values_of
from test_recovery import drawn_pieces

from protogen.capture import columns
from protogen.capture.bulk.stretch import Bulk
from protogen.capture.engines import reading_of
from protogen.capture.layout import capture_schema
from protogen.compiler import compile_file
from protogen.model.protocol import Protocol, Sender
from protogen.runtime.assembly import encode_frame
from protogen.targets.python.live import module_of

SAMPLERS = sorted((ROOT / "tests" / "c_schemas").glob("*.yaml"))
SENDERS = [
    (path, sender.name)
    for path in (*SCHEMAS, *SAMPLERS)
    for sender in protocol_of(path).senders
    if Bulk.can_read(sender)
]
EVERY_SENDER = pytest.mark.parametrize(("path", "sender"), SENDERS, ids=name_of)
EXAMPLES = settings().max_examples
SEEDS = range(max(3, EXAMPLES // 20))
ODD = """
protocol: odd
title: Frames with optional checksums, padded parts and literals in front
endpoints: {{one: One side}}
byte_order: big
frame:
  sync: {{literal: {{hex: 7E}}{unprotected}}}
  mark: {{literal: {{hex: 01 02}}}}
  level: {{type: uint4}}
  id: {{type: uint8, id: true}}
  length: {{type: uint8, counts: [payload, check]}}
  payload: {{}}
  check: {{type: uint8, algorithm: {algorithm}, covers: [mark, id, payload], when: payload}}
{more}
messages:
  full: {{id: 1, from: one, fields: {{a: uint16, b: uint8}}}}
  empty: {{id: 2, from: one, fields: {{}}}}
"""
STUFFING = """
transparency:
  covers: level..check
  escape: {byte: 0x7D, of: [0x7D, 0x7E], transform: invert}
"""
SYNC = """
  sync: {literal: {hex: 5A A5}, unprotected: sync_in_data}"""
DECISION = """
decisions:
  sync_in_data: {question: Is it protected?, document: No., choice: Accept., because: It is rare.}
"""


# --- every schema ---------------------------------------------------------------------------------


def test_all_framings_but_those_without_a_start_are_read_in_bulk() -> None:
    every = {(p.stem, s.name) for p in (*SCHEMAS, *SAMPLERS) for s in protocol_of(p).senders}
    left = every - {(path.stem, sender) for path, sender in SENDERS}
    assert {stem for stem, _ in left} == {"checksum_only", "elements", "sampler", "undelimited"}


@EVERY_SENDER
def test_clean_streams_have_the_tables_that_events_tell(path: Path, sender: str) -> None:
    frames = list(material_of(path, sender).frames)
    for seed in SEEDS:
        dice = Random(f"{path.stem} {sender} {seed}")
        dice.shuffle(frames)
        data = b"".join(frames * 2)
        check_bulk(path, sender, data, pieces_of(data, dice.choice([64, 300, 2000])))


@EVERY_SENDER
def test_every_message_is_read_in_bulk(path: Path, sender: str) -> None:
    data = b"".join(known_frames(path, protocol_of(path).sender(sender)))
    left = left_to_events(reading_at(path, sender, 1), data)
    # Where the next start ends a frame, nothing but the end of the input ends the last one.
    assert len(left) <= 1


@EVERY_SENDER
def test_noisy_streams_have_the_tables_that_events_tell(path: Path, sender: str) -> None:
    material = material_of(path, sender)
    for seed in SEEDS:
        dice = Random(f"{path.stem} {sender} {seed}")
        data = stream_of(material, dice, 80).data
        check_bulk(path, sender, data, pieces_of(data, dice.choice([1, 7, 64, 500])))


@EVERY_SENDER
def test_telling_bytes_have_the_tables_that_events_tell(path: Path, sender: str) -> None:
    """Delimiters, escapes and identities without any sense."""
    marks = marks_of(path, sender)
    spec = module_at(path).PROTOCOL.sender(sender)
    for seed in SEEDS:
        dice = Random(f"{path.stem} {sender} {seed}")
        data = bytes(dice.choice(marks) for _ in range(dice.randrange(500)))
        check_bulk(path, sender, data, pieces_of(data, dice.choice([1, 20, 100])))
        data = handwritten_streams.random_stream(spec, dice, 20)
        check_bulk(path, sender, data, pieces_of(data, dice.choice([1, 20, 100])))


@EVERY_SENDER
@settings(max_examples=max(8, EXAMPLES // 6))
@given(data=st.data())
def test_any_mixture_in_any_batches_has_the_tables_that_events_tell(
    path: Path, sender: str, data: st.DataObject
) -> None:
    stream = pieces_joined(data.draw(drawn_pieces(material_of(path, sender)))).data
    check_bulk(path, sender, stream, data.draw(portions(stream)))


# --- every type -----------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("name", "others"),
    [
        ("elements", {"varying", "without_values"}),
        ("sampler", {"nested", "filled_structs", "chosen"}),
    ],
)
def test_every_type_is_read_in_bulk(name: str, others: set[str], tmp_path: Path) -> None:
    """The samplers with a start: without, their frames begin anywhere.

    Others are messages with arrays whose elements vary in size, or hold nothing.
    """
    path = tmp_path / f"{name}.yaml"
    text = (ROOT / "tests" / "c_schemas" / f"{name}.yaml").read_text(encoding="utf-8")
    path.write_text(text.replace("\nframe:", f"\nframe:{SYNC}") + DECISION, encoding="utf-8")
    left: set[str] = set()
    for sender in protocol_of(path).senders:
        data = b"".join(known_frames(path, sender)) * 2
        events = left_to_events(reading_at(path, sender.name, 1), data)
        left |= {event.message.NAME for event in events}
        expected = check_bulk(path, sender.name, data, pieces_of(data, 700))
        assert all(len(table) for table in expected.messages.values())
        for seed in SEEDS:
            dice = Random(f"{name} {seed}")
            noisy = stream_of(material_of(path, sender.name), dice, 150).data
            check_bulk(path, sender.name, noisy, pieces_of(noisy, 400))
    assert left == others


@pytest.mark.parametrize("algorithm", ["xor-8", "sum-8/negated"])
@pytest.mark.parametrize("stuffed", [False, True])
def test_odd_frames_are_read_in_bulk(algorithm: str, stuffed: bool, tmp_path: Path) -> None:
    path = tmp_path / "odd.yaml"
    how = ("", STUFFING) if stuffed else (", unprotected: sync_in_data", DECISION)
    text = ODD.format(algorithm=algorithm, unprotected=how[0], more=how[1])
    path.write_text(text, encoding="utf-8")
    frames = b"".join(known_frames(path, protocol_of(path).sender("one")))
    assert len(left_to_events(reading_at(path, "one", 1), frames)) <= 1
    for seed in SEEDS:
        noisy = stream_of(material_of(path, "one"), Random(seed), 150).data
        check_bulk(path, "one", noisy, pieces_of(noisy, 100))
    for place in range(len(frames)):  # Padding, marks, lengths and checksums that are wrong.
        wrong = frames[:place] + bytes((frames[place] ^ 0x30,)) + frames[place + 1 :]
        check_bulk(path, "one", wrong)


def test_a_signalling_nan_is_quiet_however_it_is_read() -> None:
    path = ROOT / "tests" / "framings" / "cobs.yaml"
    spec = module_at(path).PROTOCOL.sender("station")
    frames = [
        encode_frame(spec, (0xB5,), bytes.fromhex(f"62 {bits}"), {}, strict=False)
        for bits in ("01 00 A0 7F", "00 00 C0 7F", "00 00 80 FF", "30 B5 FF A0")
    ]
    data = b"".join(frames)
    assert not left_to_events(reading_at(path, "station", 1), data)
    found = tables_of(reading_at(path, "station", 1), [data]).messages["sensor"]
    expected = tables_of(reading_at(path, "station", 0), [data]).messages["sensor"]
    assert found.tobytes() == expected.tobytes()
    assert len(found) == 4


# --- random schemas -------------------------------------------------------------------------------


@settings(
    max_examples=max(60, EXAMPLES),
    suppress_health_check=list(HealthCheck),
    phases=[phase for phase in Phase if phase is not Phase.explain],
)
@given(schemas(), st.data())
def test_random_schemas_have_the_tables_that_events_tell(
    tmp_path_factory: pytest.TempPathFactory, schema: Schema, data: st.DataObject
) -> None:
    path = tmp_path_factory.getbasetemp() / "drawn.yaml"
    path.write_text(to_yaml(schema.data), encoding="utf-8", newline="")
    protocol = compile_file(path).protocol
    assert protocol is not None
    module = module_of(protocol)
    for sender in protocol.senders:
        if Bulk.can_read(sender):
            _check_drawn(data, protocol, module, sender)


def _check_drawn(data: st.DataObject, protocol: Protocol, module: Any, sender: Sender) -> None:
    frames = _drawn_frames(data, module, sender)
    if not frames:
        return
    stream = data.draw(
        streams(data.draw(st.lists(st.sampled_from(frames), min_size=1, max_size=8)))
    ).data
    spec, tables = module.PROTOCOL.sender(sender.name), capture_schema(protocol, sender)
    for bulk in (stream, b"".join(frames)):
        pieces = data.draw(portions(bulk))
        expected = tables_of(reading(sender, spec, tables, 0), [bulk])
        for least in (1, 2):
            how = reading(sender, spec, tables, least)
            assert_same_tables(tables_of(how, [bulk]), expected)
            assert_same_tables(tables_of(how, pieces), expected)


def _drawn_frames(data: st.DataObject, module: Any, sender: Sender) -> list[bytes]:
    frames = []
    for message in sender.messages:
        for _ in range(data.draw(st.integers(1, 3))):
            values, parts = data.draw(values_of(message)), data.draw(parts_of(sender.frame))
            made = codec.check_payload(module, message, values)
            frame = made and codec.encode(module, sender, message, made, parts)
            frames += [frame] if frame else []
    return frames


# --- what is worth it -----------------------------------------------------------------------------


def test_without_asking_long_captures_are_read_in_bulk() -> None:
    path = ROOT / "schemas" / "rflex.yaml"
    protocol = protocol_of(path)
    how = reading_of(protocol, protocol.sender("flex"))
    assert how is reading_of(protocol, protocol.sender("flex"))
    data = b"".join(known_frames(path, protocol.sender("flex"))) * 30
    assert not left_to_events(how, data)
    found = columns(data, protocol, "flex", engine="python")
    assert_same_tables(found, tables_of(reading_at(path, "flex", 0), [data]))
