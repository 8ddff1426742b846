"""The decoder of generated C for all forms of an endpoint's frames: its events are Python's."""

from __future__ import annotations

from itertools import chain
from pathlib import Path
from random import Random
from typing import Any

import handwritten_streams
import pytest
from amounts import OF_TWO_ENGINES
from c_engine import check_events, process_of
from compiled import FRAMINGS, ROOT, module_at, name_of, protocol_of
from corpus import Material, joined, marks_of, material_of, stream_of
from hypothesis import given, settings
from hypothesis import strategies as st
from test_c_decoder import ALL, MESSAGES, PIECES, SEEDS, drawn_steps, steps_of
from test_forms import TRIO
from test_forms import stream as trio_stream
from test_recovery import drawn_pieces

from protogen.fuzzing.c_calls import Step

KINDS = sorted((ROOT / "tests" / "form_schemas").glob("*.yaml"))
"""Forms whose starts are found in each of the ways that there are."""
FORMS = [
    (path, endpoint)
    for path in (*FRAMINGS, *KINDS)
    for endpoint in protocol_of(path).sending
    if len(protocol_of(path).forms(endpoint)) > 1
]
STARTS = ROOT / "tests" / "c_proof" / "bounded" / "forms_starts.yaml"
"""The greatest frame has the shorter start."""
EVERY_ENDPOINT = pytest.mark.parametrize(("path", "endpoint"), FORMS, ids=name_of)
EVENTS = pytest.mark.parametrize("options", [ALL, MESSAGES], ids=["all", "messages"])


def material_of_forms(path: Path, endpoint: str) -> Material:
    """Frames of all forms, and marks of any of them."""
    each = [material_of(path, form.name) for form in protocol_of(path).forms(endpoint)]
    frames = chain.from_iterable(item.frames for item in each)
    return Material(tuple(frames), b"".join(item.marks for item in each))


def marks_of_forms(path: Path, endpoint: str) -> bytes:
    return b"".join(bytes(marks_of(path, form.name)) for form in protocol_of(path).forms(endpoint))


@EVENTS
@EVERY_ENDPOINT
def test_a_stream_has_the_events_that_python_finds(path: Path, endpoint: str, options: Any) -> None:
    material = material_of_forms(path, endpoint)
    for seed in SEEDS:
        dice = Random(f"{path.stem} {endpoint} {seed}")
        steps = steps_of(stream_of(material, dice, PIECES).data, dice)
        check_events(process_of(path, options), module_at(path), endpoint, steps)


@EVERY_ENDPOINT
def test_a_stream_of_telling_bytes_has_the_events_that_python_finds(
    path: Path, endpoint: str
) -> None:
    marks = marks_of_forms(path, endpoint)
    for seed in SEEDS:
        dice = Random(f"{path.stem} {endpoint} {seed}")
        data = bytes(dice.choice(marks) for _ in range(dice.randrange(400)))
        check_events(process_of(path), module_at(path), endpoint, steps_of(data, dice))


@EVERY_ENDPOINT
def test_short_payloads_of_any_kind_have_the_events_that_python_finds(
    path: Path, endpoint: str
) -> None:
    specs = module_at(path).PROTOCOL.forms(endpoint)
    for seed in SEEDS:
        dice = Random(f"{path.stem} {endpoint} {seed}")
        each = [handwritten_streams.random_stream(dice.choice(specs), dice, 3) for _ in range(8)]
        steps = steps_of(b"".join(each), dice)
        check_events(process_of(path), module_at(path), endpoint, steps)


@EVERY_ENDPOINT
@settings(max_examples=OF_TWO_ENGINES)
@given(data=st.data())
def test_any_mixture_has_the_events_that_python_finds(
    path: Path, endpoint: str, data: st.DataObject
) -> None:
    mixture = drawn_pieces(material_of_forms(path, endpoint))
    streams = [joined(data.draw(mixture)).data for _ in range(data.draw(st.integers(1, 2)))]
    steps = list(chain.from_iterable(data.draw(drawn_steps(stream)) for stream in streams))
    check_events(process_of(path), module_at(path), endpoint, steps)


@EVENTS
@EVERY_ENDPOINT
def test_a_decoder_in_memory_of_zeros_is_like_one_that_was_initialised(
    path: Path, endpoint: str, options: Any
) -> None:
    material = material_of_forms(path, endpoint)
    dice = Random(f"{path.stem} {endpoint}")
    starts = [bytes((value,)) for value in range(256)]
    starts += [bytes(dice.choices(material.marks, k=2)) for _ in range(200)]
    starts += [
        frame[cut:] + frame for frame in dice.choices(material.frames, k=20) for cut in (0, 1)
    ]
    steps: list[Step] = []
    for start in starts:
        steps += [("clear",), ("feed" if dice.random() < 0.5 else "push", start), ("flush",)]
    check_events(process_of(path, options), module_at(path), endpoint, steps)


@pytest.mark.parametrize("seed", range(10))
def test_forms_inside_of_each_other_have_the_events_that_python_finds(seed: int) -> None:
    dice = Random(seed)
    steps = steps_of(trio_stream(dice), dice)
    check_events(process_of(TRIO), module_at(TRIO), "station", steps)


def test_a_long_start_that_a_longest_candidate_ends_with_has_room() -> None:
    """The last byte of the first frame, a wrong sum, is the first one of the second frame."""
    wrong = bytes.fromhex("AB 04 02 00000000")  # its sum would be 06
    right = bytes.fromhex("AA 55 02 01 1234 49")
    steps: list[Step] = [("push", wrong + right + right), ("flush",)]
    check_events(process_of(STARTS), module_at(STARTS), "board", steps)
