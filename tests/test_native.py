"""Generated C that fills columns, against the Python decoder; and where its libraries are kept."""

from __future__ import annotations

import ctypes
import json
import os
import subprocess
import sys
import warnings
from pathlib import Path
from random import Random
from types import SimpleNamespace
from typing import Any

import handwritten_streams
import pytest
from capture_support import assert_same_tables
from cli_support import run
from compiled import ROOT, SCHEMAS, covering, module_at, name_of, protocol_of
from corpus import joined as pieces_joined
from corpus import known_frames, marks_of, material_of, stream_of
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from schema_fuzzing import Schema, codec, schemas
from schema_fuzzing.streams import streams
from schema_fuzzing.text import to_yaml
from schema_fuzzing.values import parts_of, values_of
from test_recovery import drawn_pieces
from tooling import require_module, require_tool

import protogen
from protogen import cache_folder
from protogen.capture import (
    CaptureError,
    SlowCaptureWarning,
    Tables,
    batches,
    columns,
    engines,
    gather,
)
from protogen.capture.gather import Gathering, gathered
from protogen.capture.native import NativeEngine, library_of
from protogen.compiler import compile_file
from protogen.live.rows import driver_of
from protogen.model.protocol import Sender
from protogen.native import build as building
from protogen.native import cache, compiler
from protogen.native.errors import NativeError
from protogen.native.library import Decoder, Library
from protogen.runtime.framing.assembly import encode_frame

RN1 = ROOT / "schemas" / "rn1.yaml"
SAMPLERS = sorted((ROOT / "tests" / "c_schemas").glob("*.yaml"))
SENDERS = [
    (path, sender.name) for path in (*SCHEMAS, *SAMPLERS) for sender in protocol_of(path).senders
]
STUFFED = [
    (path, sender)
    for path, sender in SENDERS
    if protocol_of(path).sender(sender).frame.transparency is not None
]
EVERY_SENDER = pytest.mark.parametrize(("path", "sender"), SENDERS, ids=name_of)
EXAMPLES = settings().max_examples
SEEDS = range(max(4, EXAMPLES // 20))


@pytest.fixture(scope="module", autouse=True)
def _has_compiler() -> None:
    require_tool("cc")


def python_tables(path: Path, sender: str, data: bytes) -> Tables:
    return columns(data, protocol_of(path), sender, engine="python")


def native_tables(path: Path, sender: str, data: bytes) -> Tables:
    found = columns(data, protocol_of(path), sender, engine="native")
    assert found.engine == "native"
    return found


def check(path: Path, sender: str, data: bytes) -> None:
    native = native_tables(path, sender, data)
    assert_same_tables(native, python_tables(path, sender, data))


# --- equality -------------------------------------------------------------------------------------


@EVERY_SENDER
def test_noisy_streams_have_the_tables_that_python_fills(path: Path, sender: str) -> None:
    material = material_of(path, sender)
    for seed in SEEDS:
        dice = Random(f"{path.stem} {sender} {seed}")
        check(path, sender, stream_of(material, dice, 80).data)


@pytest.mark.usefixtures("compiled_as_for_users")
@pytest.mark.parametrize(
    ("path", "sender"), [it for it in SENDERS if it[0] in covering()], ids=name_of
)
def test_libraries_as_users_have_them_fill_the_same_tables(path: Path, sender: str) -> None:
    material = material_of(path, sender)
    check(path, sender, stream_of(material, Random(f"{path.stem} {sender}"), 300).data)


@EVERY_SENDER
def test_clean_streams_have_the_tables_that_python_fills(path: Path, sender: str) -> None:
    frames = list(material_of(path, sender).frames)
    Random(path.stem).shuffle(frames)
    check(path, sender, b"".join(frames * 2))


@EVERY_SENDER
def test_telling_bytes_have_the_tables_that_python_fills(path: Path, sender: str) -> None:
    marks = marks_of(path, sender)
    spec = module_at(path).PROTOCOL.sender(sender)
    for seed in SEEDS:
        dice = Random(f"{path.stem} {sender} {seed}")
        check(path, sender, bytes(dice.choice(marks) for _ in range(dice.randrange(500))))
        check(path, sender, handwritten_streams.random_stream(spec, dice, 20))


@pytest.mark.parametrize(("path", "sender"), STUFFED, ids=name_of)
def test_a_byte_that_is_another_anywhere_has_the_tables_that_python_fills(
    path: Path, sender: str
) -> None:
    """Whole frames are taken where much stands behind them: what differs must be seen there too."""
    frames = list(dict.fromkeys(material_of(path, sender).frames))
    dice, marks, data = Random(path.stem), marks_of(path, sender), bytearray()
    for frame in dice.sample(frames, min(len(frames), 12)):
        for place in dice.sample(range(len(frame)), min(len(frame), 40)):
            other = dice.choice((*marks, dice.randrange(256)))
            data += frame[:place] + bytes((other,)) + frame[place + 1 :] + frame
    check(path, sender, bytes(data))


@EVERY_SENDER
@settings(max_examples=max(6, EXAMPLES // 12))
@given(data=st.data())
def test_any_mixture_in_any_pieces_has_the_tables_that_python_fills(
    path: Path, sender: str, data: st.DataObject
) -> None:
    stream = pieces_joined(data.draw(drawn_pieces(material_of(path, sender)))).data
    chunk, budget = data.draw(st.integers(1, 300)), data.draw(st.sampled_from([1, 300, 1 << 20]))
    engine = NativeEngine(library_of(protocol_of(path), protocol_of(path).sender(sender)), budget)
    found = []
    for start in range(0, len(stream), chunk):
        found += engine.feed(stream[start : start + chunk])
    assert_same_tables(
        gathered([*found, *engine.flush()], None, 1), python_tables(path, sender, stream)
    )


@EVERY_SENDER
@settings(max_examples=max(6, EXAMPLES // 12))
@given(data=st.data())
def test_rows_may_be_written_where_they_stay(path: Path, sender: str, data: st.DataObject) -> None:
    """Whatever was foreseen: too few rows, too many, or those of other messages.

    What the rows hold is compared with Python above: here they are those of an engine that copies.
    """
    stream = pieces_joined(data.draw(drawn_pieces(material_of(path, sender)))).data
    stream *= 1 + 20_000 // max(1, len(stream))
    chunk = data.draw(st.integers(100, 9000))
    budget = data.draw(st.sampled_from([300, 1 << 20]))
    total = data.draw(st.sampled_from([None, len(stream), len(stream) // 3 + 1]))
    whole = Gathering(total)
    library = library_of(protocol_of(path), protocol_of(path).sender(sender))
    engine = NativeEngine(library, budget, whole)
    for start in range(0, len(stream), chunk):
        for piece in engine.feed(stream[start : start + chunk]):
            whole.add(piece)
        of_any = st.dictionaries(st.integers(0, library.tables - 1), st.floats(0, 20))
        if data.draw(st.booleans()):
            whole.rates = data.draw(of_any)
    for piece in engine.flush():
        whole.add(piece)
    copying = NativeEngine(library)
    copied = gathered([*copying.feed(stream), *copying.flush()], None, 1)
    assert_same_tables(whole.tables, copied)


def test_hardly_any_rows_are_copied(monkeypatch: pytest.MonkeyPatch) -> None:
    """The first reading tells how many rows there will be; the others are written in place."""
    copied: list[int] = []

    def move(place: int, source: int, size: int) -> None:
        copied.append(size)
        ctypes.memmove(place, source, size)

    monkeypatch.setattr(gather, "ctypes", SimpleNamespace(memmove=move))
    data = stream_of(material_of(RN1, "brain"), Random(1), 2000).data
    data *= (40 << 20) // len(data)
    found = columns(data, protocol_of(RN1), "brain", engine="native")
    assert found.nbytes > 40 << 20
    assert sum(copied) < found.nbytes // 8


def test_rows_that_never_come_do_not_let_all_be_copied(monkeypatch: pytest.MonkeyPatch) -> None:
    """A dense stretch foresees rows for the quiet one behind it, for which there is little room."""
    library = library_of(protocol_of(RN1), protocol_of(RN1).sender("brain"))
    frame = min(material_of(RN1, "brain").frames, key=len)
    first = frame * (90_000 // len(frame)) + bytes(10_000)
    pieces = [first, frame * (150_000 // len(frame)), bytes(20_000)]
    whole = Gathering(sum(map(len, pieces)))
    engine = NativeEngine(library, memory=whole)
    for piece in pieces:
        for tables in engine.feed(piece):
            whole.add(tables)
    for tables in engine.flush():
        whole.add(tables)
    monkeypatch.setattr(gather, "concatenated", lambda _: pytest.fail("all rows are copied"))
    assert whole.tables.events > 240_000 // len(frame)


PARTS_LIKE_VARIABLES = """
protocol: parts_like_variables
endpoints: {station: A station}
byte_order: big
frame:
  opening: {literal: 0x7E}
  size: {type: uint8, id: true}
  tail: {type: uint8}
  code: {type: uint8, counter: true}
  payload: {}
  fcs: {type: uint16, algorithm: crc-16/x-25, covers: size..payload}
  closing: {literal: 0x7E}
transparency: {preset: hdlc, lenient: true}
messages:
  reading: {id: 1, from: station, fields: {a: uint8, b: uint16}}
"""


def test_parts_may_be_called_as_variables_of_c_are(tmp_path: Path) -> None:
    """Also where frames are made again, to see whether an encoder makes other bytes of them."""
    path = tmp_path / "parts_like_variables.yaml"
    path.write_text(PARTS_LIKE_VARIABLES, encoding="utf-8")
    check(path, "station", stream_of(material_of(path, "station"), Random(1), 200).data)
    reading = module_at(path).Reading(a=1, b=0x3141)
    frame = module_at(path).encode(reading, tail=5, code=7)
    data = frame + frame.replace(b"\x31\x41", b"\x31\x7d\x61")
    library = library_of(protocol_of(path), protocol_of(path).sender("station"))
    rows = native_tables(path, "station", data).messages["reading"]
    assert library.differs(0, rows, data, 0).tolist() == [0, 1]


def test_a_full_table_ends_a_batch() -> None:
    sender = protocol_of(RN1).sender("brain")
    data = stream_of(material_of(RN1, "brain"), Random(1), 3000).data
    engine = NativeEngine(library_of(protocol_of(RN1), sender), 4096)
    found = [*engine.feed(data), *engine.flush()]
    assert len(found) > 20
    greatest = max(table.nbytes for part in found for table in part.messages.values())
    assert greatest <= 2 * 4096
    assert_same_tables(gathered(found, None, 1), python_tables(RN1, "brain", data))


def test_a_signalling_nan_means_the_same_in_both() -> None:
    """C keeps its bits, Python makes it a quiet one; in a union other members show them."""
    path = ROOT / "tests" / "framings" / "cobs.yaml"
    spec = module_at(path).PROTOCOL.sender("station")
    frame = encode_frame(spec, (0xB5,), bytes.fromhex("62 30 B5 FF A0"), {}, strict=False)
    for bits in ("62 01 00 A0 7F", "62 00 00 C0 7F", "62 00 00 80 FF"):
        frame += encode_frame(spec, (0xB5,), bytes.fromhex(bits), {}, strict=False)
    check(path, "station", frame)
    assert len(native_tables(path, "station", frame).messages["sensor"]) == 4


@settings(max_examples=max(4, EXAMPLES // 25), suppress_health_check=list(HealthCheck))
@given(schemas(), st.data())
def test_random_schemas_have_the_tables_that_python_fills(
    tmp_path_factory: pytest.TempPathFactory, schema: Schema, data: st.DataObject
) -> None:
    path = tmp_path_factory.getbasetemp() / "drawn.yaml"
    path.write_text(to_yaml(schema.data), encoding="utf-8", newline="")
    protocol = compile_file(path).protocol
    assert protocol is not None
    module = protogen.module_of(protocol)
    for sender in protocol.senders:
        if sender.frame.told:
            continue  # Tables are told nothing.
        frames = drawn_frames(data, module, sender)
        if frames:
            some = data.draw(st.lists(st.sampled_from(frames), min_size=1, max_size=8))
            for stream in (data.draw(streams(some)).data, b"".join(frames * 3)):
                native = columns(stream, protocol, sender.name, engine="native")
                python = columns(stream, protocol, sender.name, engine="python")
                assert_same_tables(native, python)


def drawn_frames(data: st.DataObject, module: Any, sender: Sender) -> list[bytes]:
    frames = []
    for message in sender.messages:
        for _ in range(data.draw(st.integers(1, 3))):
            values = data.draw(values_of(message, [sender.frame]))
            parts = data.draw(parts_of(sender.frame, message))
            made = codec.check_payload(module, message, values)
            frame = made and codec.encode(module, sender, message, made, parts)
            frames += [frame] if frame else []
    return frames


ODD = """
protocol: odd
title: Frames with optional checksums, padded parts and literals in front
endpoints: {{one: One side}}
byte_order: big
frame:
  sync: {{literal: {{hex: 7E}}{unprotected}}}
  mark: {{literal: {{hex: 01 02}}}}
  level: {{type: uint12}}
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


@pytest.mark.parametrize("algorithm", ["xor-8", "sum-8/negated"])
@pytest.mark.parametrize("stuffed", [False, True])
def test_odd_frames_have_the_tables_that_python_fills(
    algorithm: str, stuffed: bool, tmp_path: Path
) -> None:
    path = tmp_path / "odd.yaml"
    how = ("", STUFFING) if stuffed else (", unprotected: sync_in_data", DECISION)
    text = ODD.format(algorithm=algorithm, unprotected=how[0], more=how[1])
    path.write_text(text, encoding="utf-8")
    frames = b"".join(known_frames(path, protocol_of(path).sender("one")))
    check(path, "one", frames)
    for seed in SEEDS:
        check(path, "one", stream_of(material_of(path, "one"), Random(seed), 150).data)
    for place in range(len(frames)):  # Padding, marks, lengths and checksums that are wrong.
        wrong = frames[:place] + bytes((frames[place] ^ 0x30,)) + frames[place + 1 :]
        check(path, "one", wrong + frames)


@pytest.mark.parametrize("name", ["elements", "sampler"])
def test_whole_frames_of_every_type_have_the_tables_that_python_fills(
    name: str, tmp_path: Path
) -> None:
    """The samplers with a start: without, no frame is taken whole."""
    path = tmp_path / f"{name}.yaml"
    text = (ROOT / "tests" / "c_schemas" / f"{name}.yaml").read_text(encoding="utf-8")
    path.write_text(text.replace("\nframe:", f"\nframe:{SYNC}") + DECISION, encoding="utf-8")
    for sender in protocol_of(path).senders:
        check(path, sender.name, b"".join(known_frames(path, sender)) * 2)
        for seed in SEEDS:
            dice = Random(f"{name} {seed}")
            check(path, sender.name, stream_of(material_of(path, sender.name), dice, 150).data)


# --- the compiler ---------------------------------------------------------------------------------


def test_without_a_compiler_python_fills_the_tables_and_says_so_once(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    data = stream_of(material_of(RN1, "brain"), Random(1), 50).data
    monkeypatch.setattr(engines, "_warned", set())
    monkeypatch.setenv("CC", "no-such-cc -m32")
    with pytest.warns(SlowCaptureWarning, match="no C compiler 'no-such-cc'") as warned:
        found = columns(data, protocol_of(RN1), "brain")
    assert found.engine == "python"
    assert [item.filename for item in warned] == [__file__]
    monkeypatch.setattr(engines, "_warned", set())
    with pytest.warns(SlowCaptureWarning) as warned:
        next(batches(data, protocol_of(RN1), "brain"))
    assert [item.filename for item in warned] == [__file__]
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        assert next(batches(data, protocol_of(RN1), "brain")).engine == "python"
    with pytest.raises(CaptureError, match="no native engine: there is no C compiler"):
        columns(data, protocol_of(RN1), "brain", engine="native")


@pytest.mark.parametrize(
    ("given", "problem"),
    [
        ("'", "CC is no command"),
        ("false", "false does not compile the decoder: exit code 1"),
        ("true", "true ends without an error, but makes no library"),
        ("cc --no-such-option", "does not compile the decoder: .*no-such-option"),
    ],
)
def test_a_compiler_that_does_not_work_is_named(
    given: str, problem: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("CC", given)
    with pytest.raises(NativeError, match=problem):
        build(RN1, "brain")


def test_what_does_not_compile_is_named(tmp_path: Path) -> None:
    source = tmp_path / "source.c"
    source.write_text("int ours(void) {\n    return absent;\n}\n", encoding="utf-8")
    with pytest.raises(NativeError, match=r"error: .*absent"):
        compiler.working(compiler.compilers()).build(source, tmp_path / "library")


def test_a_compiler_that_does_not_run_is_named(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    broken = tmp_path / "broken-cc"
    broken.write_bytes(b"\x7fELF")
    broken.chmod(0o755)
    monkeypatch.setenv("CC", str(broken))
    with pytest.raises(NativeError, match="broken-cc does not run"):
        build(RN1, "brain")


def test_a_compiler_that_speaks_another_encoding_is_understood_in_part(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    foreign = tmp_path / "foreign-cc"
    foreign.write_bytes(b"#!/bin/sh\nprintf 'g\\377nzlich kaputt' >&2\nexit 1\n")
    foreign.chmod(0o755)
    monkeypatch.setenv("CC", str(foreign))
    with pytest.raises(NativeError, match=r"foreign-cc does not compile the decoder: g.*kaputt"):
        build(RN1, "brain")


def test_the_usual_names_are_looked_for(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.delenv("CC", raising=False)
    assert compiler.compilers()[0].command[0].startswith("/")
    without_compilers(monkeypatch)
    with pytest.raises(NativeError, match=r"no cc, gcc or clang .*protogen-serial\[compiler\]"):
        compiler.compilers()


def without_compilers(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("PATH", "")
    monkeypatch.setattr(compiler, "ziglang", lambda: ())


def compilers_at(folder: Path, monkeypatch: pytest.MonkeyPatch, **scripts: str) -> None:
    """Let nothing but these scripts be on the PATH."""
    folder.mkdir()
    for name, script in scripts.items():
        (folder / name).write_text(f"#!/bin/sh\n{script}\n", encoding="utf-8")
        (folder / name).chmod(0o755)
    monkeypatch.delenv("CC", raising=False)
    monkeypatch.setenv("PATH", str(folder))


def test_the_first_compiler_that_works_is_taken(
    tmp_path: Path, folder: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    real = require_tool("cc")
    lacking = "echo 'stdlib.h: no such file' >&2; exit 1"
    working = f'PATH={os.defpath} exec {real} "$@"'
    compilers_at(tmp_path / "bin", monkeypatch, cc=lacking, gcc=working)
    assert compiler.working(compiler.compilers()).command == (str(tmp_path / "bin" / "gcc"),)
    assert build().is_new
    assert not build().is_new


def test_where_no_compiler_works_all_are_named(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    compilers_at(tmp_path / "bin", monkeypatch, cc="exit 1", clang="exit 1")
    monkeypatch.setattr(compiler, "ziglang", lambda: ())
    with pytest.raises(NativeError, match=r"no C compiler works of .*/cc, .*/clang; pip install"):
        build()


def test_the_package_ziglang_brings_a_compiler(
    folder: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """With no other on the PATH it is found, compiles, and what it compiles reads columns."""
    require_module("ziglang")
    monkeypatch.delenv("CC", raising=False)
    monkeypatch.setenv("PATH", "")
    (zig,) = compiler.compilers()
    assert "ziglang" in zig.command[0]
    for path, sender in ((RN1, "brain"), (ROOT / "schemas" / "rflex.yaml", "flex")):
        check(path, sender, stream_of(material_of(path, sender), Random(1), 300).data)
    assert len(cache.libraries()) == 2
    assert {build(RN1, "brain").is_new, build(RN1, "host").is_new} == {False, True}


# --- stuffed frames, sixteen bytes at a time ------------------------------------------------------

SHAPES = [
    (path, sender.name)
    for path in sorted((ROOT / "tests" / "stuffed_schemas").glob("*.yaml"))
    for sender in protocol_of(path).senders
]


def stuffed_stream(path: Path, sender: str, dice: Random, count: int) -> bytes:
    """Noise, and frames into which bytes were put that mean something."""
    material, marks = material_of(path, sender, greatest=20_000), marks_of(path, sender)
    found = bytearray(stream_of(material, dice, count).data)
    for _ in range(count):
        frame = bytearray(dice.choice(material.frames))
        if dice.random() < 0.5:
            place = dice.randrange(len(frame))
            frame[place : place + dice.randrange(2)] = bytes([dice.choice(marks)])
        found += frame
    return bytes(found)


@pytest.mark.parametrize(("path", "sender"), SHAPES, ids=name_of)
def test_stuffed_frames_of_many_shapes_are_read_alike(path: Path, sender: str) -> None:
    protocol = protocol_of(path)
    assert "_take_whole(decoder, &data" in driver_of(protocol, protocol.sender(sender)).text
    dice = Random(f"{path.stem} {sender}")
    data = stuffed_stream(path, sender, dice, 100)
    expected = python_tables(path, sender, data)
    assert sum(map(len, expected.messages.values())) > 20
    for chunk in (5, 1000, len(data)):
        each = batches(data, protocol, sender, chunk=chunk, engine="native")
        assert_same_tables(gathered(each, None, 1), expected)


BEHIND = """
import ctypes, json, mmap, sys
from pathlib import Path
import protogen
from protogen.capture.native import library_of
from protogen.native.library import Decoder

forbid = ctypes.CDLL(None, use_errno=True).mprotect
forbid.argtypes = (ctypes.c_void_p, ctypes.c_size_t, ctypes.c_int)
for schema, sender, file in json.load(sys.stdin):
    protocol = protogen.load(schema)
    decoder = Decoder(library_of(protocol, protocol.sender(sender)), 1 << 20)
    data = Path(file).read_bytes()
    most = -(-len(data) // mmap.PAGESIZE) * mmap.PAGESIZE
    memory = mmap.mmap(-1, most + mmap.PAGESIZE)
    start = ctypes.addressof(ctypes.c_char.from_buffer(memory))
    assert forbid(start + most, mmap.PAGESIZE, 0) == 0
    for cut in range(min(1500, len(data))):
        size = len(data) - cut
        ctypes.memmove(start + most - size, data, size)
        decoder.start(0, 0)
        taken = 0
        while taken < size:
            taken += decoder.feed(start + most - size + taken, size - taken)
            decoder.clear()
    print(file, flush=True)
"""
"""Reads captures that end, byte by byte, where memory does: what reads on is killed."""


@pytest.mark.skipif(sys.platform == "win32", reason="needs mprotect")
def test_no_byte_behind_the_last_is_read(tmp_path: Path) -> None:
    asked = []
    for path, sender in [*STUFFED, *SHAPES, (RN1, "brain")]:
        material = material_of(path, sender, greatest=700)
        file = tmp_path / f"{path.stem} {sender}"
        file.write_bytes(b"".join((material.frames * 3000)[:3000])[-6000:])
        library_of(protocol_of(path), protocol_of(path).sender(sender))
        asked.append([str(path), sender, str(file)])
    command = [sys.executable, "-c", BEHIND]
    given = json.dumps(asked)
    done = subprocess.run(
        command, input=given, cwd=ROOT, capture_output=True, text=True, check=False
    )
    # The first that is missing is the one that was read too far.
    assert done.stdout.splitlines() == [file for _, _, file in asked], done.stderr
    assert done.returncode == 0, done.stderr


# --- the cache ------------------------------------------------------------------------------------


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """An empty cache."""
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path))
    return tmp_path / "protogen" / "native"


def build(path: Path = RN1, sender: str = "host") -> building.Built:
    return building.build(driver_of(protocol_of(path), protocol_of(path).sender(sender)))


def test_a_library_is_compiled_once(folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    first = build()
    assert (first.is_new, first.path.parent) == (True, folder)
    assert folder.stat().st_mode & 0o777 == 0o700
    second = build()
    assert (second.is_new, second.path) == (False, first.path)
    assert build(sender="brain").path != first.path
    monkeypatch.setattr(building, "VERSION", "9.9.9")
    assert build().is_new
    monkeypatch.setenv("CC", "cc -O1")
    assert build().is_new
    assert sorted(item.suffix for item in folder.iterdir()) == [".sha256"] * 4 + [".so"] * 4
    assert len(cache.libraries()) == 4
    assert cache.clean() == 4
    assert cache.libraries() == []


@pytest.mark.parametrize("size", [0, 64, 4096])
def test_a_library_that_was_cut_off_is_built_again(size: int, folder: Path) -> None:
    whole = build().path.read_bytes()
    build().path.write_bytes(whole[:size])
    again = build()
    assert again.is_new
    assert again.path.read_bytes()[:4] == whole[:4]
    assert not build().is_new
    check(RN1, "host", b"")


def test_what_was_built_ahead_serves_where_no_compiler_is_any_more(
    folder: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.delenv("CC", raising=False)
    first = build()
    without_compilers(monkeypatch)
    again = build()
    assert (again.path, again.is_new) == (first.path, False)
    with pytest.raises(NativeError, match="no cc, gcc or clang"):
        build(sender="brain")
    first.path.chmod(0o777)
    with pytest.raises(NativeError, match="others can write to"):
        build()
    first.path.chmod(0o700)
    for owner, name, other in (
        (building.platform, "machine", lambda: "another"),
        (sys.implementation, "_multiarch", "x86_64-linux-another"),
    ):
        with monkeypatch.context() as patch:
            patch.setattr(owner, name, other, raising=False)
            with pytest.raises(NativeError, match="no cc, gcc or clang"):
                build()
    assert build().path == first.path
    monkeypatch.setenv("CC", "no-such-cc")
    with pytest.raises(NativeError, match="'no-such-cc', as CC says"):
        build()


def test_a_cache_that_can_not_be_looked_at_is_no_reason_to_end(
    folder: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def refuse(self: Path) -> bool:
        raise PermissionError(self)

    monkeypatch.delenv("CC", raising=False)
    without_compilers(monkeypatch)
    monkeypatch.setattr(Path, "is_dir", refuse)
    with pytest.raises(NativeError, match="no cc, gcc or clang"):
        build()


def test_of_several_built_ahead_the_newest_serves(
    folder: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("CC", "cc -O1")
    newest = build().path
    monkeypatch.delenv("CC")
    older = build().path
    assert older != newest
    os.utime(older, (1, 1))
    without_compilers(monkeypatch)
    assert build().path == newest


def test_two_processes_may_build_at_once(folder: Path) -> None:
    program = (
        "import protogen; from protogen.capture import columns;"
        "print(columns(b'', protogen.load('schemas/rn1.yaml'), 'host').engine)"
    )
    command = [sys.executable, "-W", "error", "-c", program]
    each = [
        subprocess.Popen(command, cwd=ROOT, stdout=subprocess.PIPE, text=True) for _ in range(3)
    ]
    assert [one.communicate()[0].strip() for one in each] == ["native"] * 3
    assert len(cache.libraries()) == 1


def test_code_that_others_could_have_put_there_is_not_loaded(folder: Path) -> None:
    path = build().path
    path.chmod(0o777)
    with pytest.raises(NativeError, match=r"others can write to .*code from there is not loaded"):
        build()
    path.chmod(0o700)
    folder.chmod(0o770)
    with pytest.raises(NativeError, match="others can write to"):
        build()
    folder.chmod(0o700)
    folder.parent.chmod(0o777)
    with pytest.raises(NativeError, match="others can write to"):
        build()
    folder.parent.chmod(0o1777)
    assert not build().is_new


def test_code_of_somebody_else_is_not_loaded(folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    build()
    monkeypatch.setattr(cache_folder.os, "geteuid", lambda: 12345)
    with pytest.raises(NativeError, match="belongs to somebody else"):
        build()


def test_a_folder_that_can_not_be_made_is_named(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    (tmp_path / "file").touch()
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "file"))
    with pytest.raises(NativeError, match=r"file/protogen/native: Not a directory"):
        build()
    with pytest.raises(cache_folder.CacheError, match="No such file"):
        cache_folder.check(tmp_path / "nothing")


def test_each_platform_has_its_folder(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("XDG_CACHE_HOME", "relative/is/ignored")
    monkeypatch.setenv("HOME", "/home/me")
    monkeypatch.setenv("LOCALAPPDATA", "/local")
    usual = {"linux": "/home/me/.cache", "darwin": "/home/me/Library/Caches", "win32": "/local"}
    for platform, expected in usual.items():
        monkeypatch.setattr(cache_folder.sys, "platform", platform)
        assert cache.cache_folder() == Path(expected, "protogen", "native")
    cache_folder.check(Path("/no/such/file"))  # Nothing is asked on Windows.


def test_a_user_without_a_home_has_no_cache(monkeypatch: pytest.MonkeyPatch) -> None:
    def home() -> Path:
        raise RuntimeError

    monkeypatch.delenv("XDG_CACHE_HOME")
    monkeypatch.setattr(cache_folder.Path, "home", home)
    with pytest.raises(NativeError, match="no home folder"):
        cache.cache_folder()


def test_a_library_that_is_none_or_another_is_not_used(tmp_path: Path) -> None:
    protocol = protocol_of(RN1)
    driver = driver_of(protocol, protocol.sender("host"))
    file = tmp_path / "broken.so"
    file.write_bytes(b"nothing")
    with pytest.raises(NativeError, match=r"broken\.so can't be loaded"):
        Library(file, driver)
    other = driver_of(protocol, protocol.sender("brain"))
    assert other.layout != driver.layout
    with pytest.raises(NativeError, match="lays structs out"):
        Library(build().path, other)


# --- the command ----------------------------------------------------------------------------------


def test_the_command_builds_ahead_finds_and_removes(
    folder: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(ROOT)
    assert run("native", "path").output.strip() == str(folder)
    assert "rn1 brain: compiled" in run("native", "build", "schemas/rn1.yaml").output
    again = run("native", "build", "schemas/rn1.yaml")
    kinds = ("", " to jsonl", " to csv", " to mcap", " to mcap-ros2")
    names = [f"rn1 {sender}{kind}" for sender in ("host", "brain") for kind in kinds]
    assert again.output.splitlines() == [f"{name}: is there" for name in names]
    assert not build().is_new
    assert run("native", "clean").output.strip() == "removed 10 libraries"
    assert run("native", "clean").output.strip() == "removed 0 libraries"


def test_the_command_says_why_it_can_not(folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(ROOT)
    monkeypatch.setenv("CC", "no-such-cc")
    result = run("native", "build", "schemas/rn1.yaml")
    assert result.exit_code == 2
    assert "there is no C compiler 'no-such-cc'" in result.output
    assert "captures can still be read in Python" in result.output

    def home() -> Path:
        raise RuntimeError

    monkeypatch.delenv("XDG_CACHE_HOME")
    monkeypatch.setattr(cache_folder.Path, "home", home)
    assert "no home folder" in run("native", "path").output


def test_memory_that_is_not_there_is_an_error(monkeypatch: pytest.MonkeyPatch) -> None:
    library = library_of(protocol_of(RN1), protocol_of(RN1).sender("brain"))
    decoder = Decoder(library, 1)
    decoder._state.failed = 1
    with pytest.raises(MemoryError):
        decoder.flush()
    monkeypatch.setattr(library, "new", lambda budget: None)
    with pytest.raises(MemoryError):
        Decoder(library, 1)
