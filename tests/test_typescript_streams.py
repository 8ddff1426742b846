"""Generated TypeScript in node gives the events, messages and frames of Python."""

from __future__ import annotations

import os
from itertools import islice
from pathlib import Path
from random import Random
from typing import Any

import pytest
import typescript_engine as engine
from compiled import DIALECTS, DOCUMENTS, FRAMINGS, ROOT, module_at, name_of, protocol_of
from corpus import material_of, portions, single_bytes, stream_of
from vectors import VectorFile, read_vectors, vector_files

from protogen.fuzzing.samples import boundary_rounds, samples
from protogen.runtime.attributes import arguments
from protogen.runtime.errors import EncodeError

FOLDERS = ("c_schemas", "stuffed_schemas", "form_schemas", "told_schemas")
OTHERS = [path for name in FOLDERS for path in sorted((ROOT / "tests" / name).glob("*.yaml"))]
LIBRARY = sorted((ROOT / "protogen" / "library").glob("*.yaml"))
ALL = [*DOCUMENTS, *DIALECTS, *FRAMINGS, *OTHERS, *LIBRARY]
SCHEMAS = [path for path in ALL if path not in LIBRARY]
FILES = [read_vectors(path) for path in vector_files()]

STREAMS = int(os.environ.get("PROTOGEN_TYPESCRIPT_STREAMS", "40"))
"""Streams of each sender of the documents. With 10,000, there are 100,000 of all of them."""
FEW = 12
"""Messages that are tried of a sender in the library."""

of_schema = pytest.mark.parametrize("path", SCHEMAS, ids=name_of)
of_library = pytest.mark.parametrize("path", LIBRARY, ids=name_of)
of_vectors = pytest.mark.parametrize("file", FILES, ids=lambda file: file.name)


@of_vectors
def test_streams_of_the_vectors_are_cut_as_python_cuts_them(file: VectorFile) -> None:
    for item in file.streams:
        for steps in ([item.data, None], [*single_bytes(item.data), None]):
            check_events(file.schema, item.sender, steps)


@of_vectors
def test_frames_of_the_vectors_are_made_and_read(file: VectorFile) -> None:
    protocol, module = protocol_of(file.schema), module_at(file.schema)
    for item in file.vectors:
        record = module.MESSAGES[item.message].from_dict(item.values)
        message = engine.message_of(protocol, item.message, record.to_dict())
        assert made(file.schema, item.sender, message, dict(item.parts)) == item.frame.hex()
        check_events(file.schema, item.sender, [item.frame, None])


def test_a_part_that_differs_from_the_field_is_an_error_with_its_name() -> None:
    path = ROOT / "tests" / "framings" / "part_fields.yaml"
    message = {"message": "answer", "code": 0x82, "text": ""}
    assert made(path, "host", message, {"id": 0x82}) == made(path, "host", message, {})
    answer = made(path, "host", message, {"id": 0x81})
    assert answer == {"path": "id", "problem": "is 130, as the message says, and not 129"}


@of_schema
def test_samples_of_all_messages_are_encoded_alike(path: Path) -> None:
    check_samples(path, most=6)


@of_library
def test_samples_of_the_library_are_encoded_alike(path: Path) -> None:
    check_samples(path, most=1, messages=FEW)


@of_schema
def test_damaged_streams_are_cut_alike(path: Path) -> None:
    check_streams(path, seeds=range(3))


@of_library
def test_damaged_streams_of_the_library_are_cut_alike(path: Path) -> None:
    if len(protocol_of(path).messages) <= 5 * FEW:  # Else it takes long to make their frames.
        check_streams(path, seeds=range(1))


@pytest.mark.parametrize("path", DOCUMENTS, ids=name_of)
def test_many_streams_of_the_documents_are_cut_alike(path: Path) -> None:
    check_streams(path, seeds=range(100, 100 + STREAMS))


def check_streams(path: Path, seeds: range) -> None:
    """Streams of each sender, in portions, with a silence somewhere, give the events of Python."""
    for sender in protocol_of(path).senders:
        material = material_of(path, sender.name)
        if not material.frames or sender.plan.greatest > 2048:  # Python takes minutes for noise.
            continue
        for seed in seeds:
            dice = Random(f"{path.stem} {sender.name} {seed}")
            cut: list[bytes | None] = [*portions(stream_of(material, dice, 12).data, dice)]
            cut.insert(dice.randint(0, len(cut)), None)
            check_events(path, sender.name, [*cut, None])


def check_events(path: Path, sender: str, steps: engine.Steps) -> None:
    """Each step gives the events of Python, so that none comes earlier or later."""
    found = engine.events(engine.module_at(path), sender, steps)
    difference = engine.first_difference(
        found, engine.python_events(module_at(path), sender, steps)
    )
    if difference:
        pytest.fail(difference, pytrace=False)


def check_samples(path: Path, most: int, messages: int = 1000) -> None:
    protocol, module = protocol_of(path), module_at(path)
    for sender in protocol.senders:
        for item in sender.messages[:: 1 + len(sender.messages) // messages]:
            usual = samples(item, sender.frame, Random(f"{sender.name} {item.name}"))
            rounds = min(most, boundary_rounds(item, sender.frame)) + 1
            for values, parts in islice(usual, rounds):
                record = module.MESSAGES[item.name].from_dict(values)
                message = engine.message_of(protocol, item.name, record.to_dict())
                try:
                    frame = module.encode(record, sender.name, **arguments(parts))
                except EncodeError:
                    assert isinstance(made(path, sender.name, message, parts), dict)
                    continue
                assert made(path, sender.name, message, parts) == frame.hex(), values
                told = sender.plan.told_before(item, parts, len(frame))
                answer = engine.node().ask(
                    engine.module_at(path), frame=frame.hex(), sender=sender.name, told=told
                )
                assert answer == {"found": None}, values


def made(path: Path, sender: str, message: dict[str, Any], parts: dict[str, Any]) -> Any:
    """The frame that TypeScript makes, as digits, or its error."""
    big = {name: {"$big": str(it)} if is_big(it) else it for name, it in parts.items()}
    request = {"message": message, "sender": sender, "parts": big, "strict": False}
    answer = engine.node().ask(engine.module_at(path), **request)
    return answer.get("found", answer)


def is_big(value: Any) -> bool:
    return isinstance(value, int) and value >= 1 << 53
