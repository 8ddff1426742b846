"""The header for C++, held against Python: what it makes, and what it finds in streams."""

from __future__ import annotations

from functools import cache
from itertools import islice
from pathlib import Path
from random import Random

import pytest
from c_engine import Process, check_events
from compiled import DOCUMENTS, ROOT, module_at, name_of, protocol_of
from corpus import material_of, stream_of
from cpp_shim import build_over_cpp
from test_c_decoder import check_corpus, check_details, events_of, parts_of, shown, steps_of
from test_c_frames import frames_of, refusal
from test_vectors import FILES, brief, message_of

from protogen.fuzzing.c_calls import OK, Encoded, Step
from protogen.targets.c.options import COptions

TESTED = [
    *DOCUMENTS,
    # Messages of several senders; forms; numbers that are told; parts that are fields; taken names.
    *(
        ROOT / "tests" / "framings" / f"{name}.yaml"
        for name in ("forms", "told_numbers", "part_fields", "taken_names", "cobs")
    ),
    ROOT / "tests" / "c_schemas" / "sampler.yaml",
]
ALL = COptions(hpp=True)
MESSAGES = COptions(hpp=True, events="messages")
BUILDS = [(path, ALL) for path in TESTED]
BUILDS += [(path, MESSAGES) for path in TESTED if path.stem in ("rn1", "matty", "cobs", "forms")]
EVERY_BUILD = pytest.mark.parametrize(
    ("path", "options"), BUILDS, ids=[f"{path.stem}-{options.events}" for path, options in BUILDS]
)
STANDARDS = ("-std=c++11", "-std=c++14", "-std=c++17", "-std=c++20", "-std=c++23")
SAMPLES = 8
"""Samples of each message; test_c_frames.py has all boundaries."""


@cache
def process_over_cpp(path: Path, options: COptions) -> Process:
    """The driver of a schema, whose calls go through C++."""
    protocol = protocol_of(path)
    standard = STANDARDS[BUILDS.index((path, options)) % len(STANDARDS)]
    return Process(protocol, options, ("-O0",), build_over_cpp(protocol, options, standard))


@EVERY_BUILD
def test_a_stream_has_the_events_that_python_finds(path: Path, options: COptions) -> None:
    process = process_over_cpp(path, options)
    for sender in protocol_of(path).senders:
        check_corpus(process, module_at(path), sender.name, path)


def test_a_decoder_of_all_forms_finds_what_python_finds() -> None:
    path = next(path for path in TESTED if path.stem == "forms")
    for options in (ALL, MESSAGES):
        process, dice = process_over_cpp(path, options), Random(5)
        for decoder in process.driver.decoders:
            forms = [form.name for form in protocol_of(path).forms(decoder.name)]
            if decoder.forms:
                streams = [stream_of(material_of(path, name), dice, 40).data for name in forms]
                steps = steps_of(b"".join(streams), dice)
                check_events(process, module_at(path), decoder.name, steps)


@pytest.mark.parametrize("path", TESTED, ids=name_of)
def test_a_frame_has_the_bytes_that_python_makes(path: Path) -> None:
    process = process_over_cpp(path, ALL)
    for sender in protocol_of(path).senders:
        for message in sender.messages:
            for values, parts, frame in islice(frames_of(path, sender.name, message.name), SAMPLES):
                made = process.do(process.calls.frame(sender.name, message.name, values, parts))
                refused = (refusal(path, sender.name), b"")
                assert (made.result, made.data) == (refused if frame is None else (OK, frame))
                if process.calls.sends(sender.name, message.name):
                    call = process.calls.send(sender.name, message.name, values, parts)
                    assert process.do(call) == Encoded(OK, frame or b"")


@pytest.mark.parametrize("path", DOCUMENTS, ids=name_of)
def test_what_was_worked_out_by_hand_holds(path: Path) -> None:
    process = process_over_cpp(path, ALL)
    for file in (file for file in FILES if file.schema == path):
        for item in file.vectors:
            message = message_of(module_at(path), item)
            protocol = protocol_of(path)
            model = protocol.message(item.message)
            parts = parts_of(protocol.sender(item.sender), model, item.parts)
            if not message.violations():
                call = process.calls.frame(item.sender, item.message, message.to_dict(), parts)
                assert process.do(call).data == item.frame
            (event,) = events_of(process, item.sender, [("feed", item.frame), ("flush",)])
            assert (event.kind, event.message) == ("message", item.message)
        for stream in file.streams:
            steps: list[Step] = [("feed", stream.data), ("flush",)]
            events = events_of(process, stream.sender, steps)
            assert list(map(shown, events)) == list(map(brief, stream.events))
            for expected, event in zip(stream.events, events, strict=True):
                check_details(expected, event)
