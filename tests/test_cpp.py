"""The header for C++, held against Python: what it makes, and what it finds in streams."""

from __future__ import annotations

import re
import subprocess
from collections.abc import Sequence
from functools import cache
from itertools import islice
from pathlib import Path
from random import Random

import pytest
from c_engine import Process, check_events
from compiled import DOCUMENTS, ROOT, SCHEMAS, module_at, name_of, protocol_of
from corpus import material_of, stream_of
from cpp_shim import WARNINGS, build_over_cpp
from test_c_decoder import check_corpus, check_details, events_of, parts_of, shown, steps_of
from test_c_frames import frames_of
from test_vectors import FILES, brief, message_of
from tooling import require_tool

from protogen.fuzzing.c_calls import OK, RANGE, REFUSED, Encoded, Step
from protogen.targets.c.cpp.names import cpp_names
from protogen.targets.c.emit import emit
from protogen.targets.c.options import COptions

TESTED = [
    *DOCUMENTS,
    # Forms; numbers that are told; parts that are fields; names that are taken.
    *(
        ROOT / "tests" / "framings" / f"{name}.yaml"
        for name in ("forms", "told_numbers", "part_fields", "taken_names")
    ),
]
ALL = COptions(hpp=True)
MESSAGES = COptions(hpp=True, events="messages")
BUILDS = [(path, ALL) for path in TESTED]
BUILDS += [(path, MESSAGES) for path in TESTED if path.stem in ("rn1", "matty", "forms")]
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
                expected = (REFUSED, b"") if frame is None else (OK, frame)
                assert (made.result, made.data) == expected
                if process.calls.sends(sender.name, message.name):
                    call = process.calls.send(sender.name, message.name, values, parts)
                    sent = Encoded(RANGE, b"") if frame is None else Encoded(OK, frame)
                    assert process.do(call) == sent


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


# --- compilers ------------------------------------------------------------------------------------

PROGRAMS = Path(__file__).with_name("cpp_programs")
ROVER = ROOT / "benchmarks" / "c" / "rover.yaml"
MATTY = ROOT / "schemas" / "matty.yaml"
BOARDS = {
    "avr": (
        ("avr-gcc", "-std=c99", "-mmcu=atmega328p"),
        ("avr-g++", "-std=c++11", "-mmcu=atmega328p"),
        ("avr-gcc", "-mmcu=atmega328p"),
    ),
    "arm": (
        ("arm-none-eabi-gcc", "-std=c99", "-mcpu=cortex-m0", "-mthumb"),
        ("arm-none-eabi-g++", "-std=c++17", "-mcpu=cortex-m0", "-mthumb"),
        ("arm-none-eabi-gcc", "-mcpu=cortex-m0", "-mthumb", "-nostartfiles", "-Wl,-emain"),
    ),
}
"""How C, C++ and programs are made for a board."""
SMALL = ("-Os", "-ffunction-sections", "-fdata-sections", "-fno-exceptions")
MOST = 1.02
"""Flash of a program in C++ in that of the same program in C."""


def written(path: Path, options: COptions, folder: Path) -> Path:
    """The folder, with the C of a schema and the header for C++."""
    for file in emit([protocol_of(path)], options):
        if file.path.suffix in (".c", ".h", ".hpp"):
            (folder / file.path.name).write_bytes(file.bytes)
    return folder


@pytest.mark.parametrize("compiler", ["g++", "clang++"])
def test_the_header_is_used_in_each_standard_without_a_warning(
    compiler: str, tmp_path: Path
) -> None:
    written(ROVER, ALL, tmp_path)
    source = PROGRAMS / "uses.cc"
    run([require_tool("cc"), "-DROVER_NAMES", "-c", "rover.c", "-o", "rover.o"], tmp_path)
    for standard in STANDARDS:
        options = [standard.replace("23", "2b"), *WARNINGS, "-I.", "-DROVER_NAMES"]
        command = [require_tool(compiler), *options]
        if standard == STANDARDS[-1] or (compiler, standard) == ("g++", STANDARDS[0]):
            run([*command, "-O1", source, "rover.o", "-o", "uses"], tmp_path)
            run(["./uses"], tmp_path)
        else:
            run([*command, "-fsyntax-only", source], tmp_path)


def test_all_headers_are_for_one_source(tmp_path: Path) -> None:
    """Names of one protocol are none of another's, and none are alike in one."""
    for path in SCHEMAS:
        written(path, ALL, tmp_path)
    headers = sorted(path.name for path in tmp_path.glob("*.hpp"))
    text = "".join(f'#include "{name}"\n' for name in headers)
    (tmp_path / "every.cc").write_text(text, encoding="utf-8")
    for compiler in ("g++", "clang++"):
        flags = [STANDARDS[0], *WARNINGS, "-fsyntax-only"]
        run([require_tool(compiler), *flags, "every.cc"], tmp_path)


@pytest.mark.parametrize("board", BOARDS)
@pytest.mark.parametrize(
    ("path", "options"), [(ROVER, ALL), (MATTY, MESSAGES)], ids=("rover", "matty")
)
def test_it_takes_hardly_more_flash_than_c(
    path: Path, options: COptions, board: str, tmp_path: Path
) -> None:
    written(path, options, tmp_path)
    c, cpp, link = ([require_tool(name), *flags] for name, *flags in BOARDS[board])
    name = path.stem
    run([*c, *SMALL, "-c", f"{name}.c", "-o", "codec.o"], tmp_path)
    sizes = []
    for suffix, command in ((".c", c), (".cc", [*cpp, "-Wall", "-Wextra", "-Werror"])):
        source = PROGRAMS / f"{name}{suffix}"
        run([*command, *SMALL, "-I.", "-c", source, "-o", "program.o"], tmp_path)
        run([*link, "program.o", "codec.o", "-Wl,--gc-sections", "-o", "program"], tmp_path)
        size = require_tool(link[0].replace("gcc", "size"))
        text, data, *_ = run([size, "program"], tmp_path).splitlines()[1].split()
        sizes.append(int(text) + int(data))
    assert sizes[1] <= MOST * sizes[0], sizes


def run(command: Sequence[str | Path], folder: Path) -> str:
    """What a program says, which has to succeed."""
    done = subprocess.run(command, cwd=folder, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    return done.stdout


@pytest.mark.parametrize(
    ("handler", "said"),
    [
        ("[](const rover::drive &) {}", ""),
        ("[](const rover::host_event &) {}", ""),
        ("[](const rover::state &) {}", "each handler has to take an event of host"),
        ("[](rover::drive &) {}", "each handler has to take an event of host"),
    ],
)
def test_a_handler_that_takes_nothing_does_not_compile(
    handler: str, said: str, tmp_path: Path
) -> None:
    written(ROVER, ALL, tmp_path)
    text = f'#include "rover.hpp"\nvoid f(rover::host_decoder &d) {{ d.push(1, {handler}); }}\n'
    (tmp_path / "handler.cc").write_text(text, encoding="utf-8")
    command = [require_tool("g++"), "-std=c++11", "-fsyntax-only", "handler.cc"]
    done = subprocess.run(command, cwd=tmp_path, capture_output=True, text=True, check=False)
    assert (done.returncode == 0) == (not said)
    assert said in done.stderr


def test_what_takes_all_forms_is_held_to_the_same(tmp_path: Path) -> None:
    path = next(path for path in TESTED if path.stem == "forms")
    written(path, ALL, tmp_path)
    room = 'static_assert(trio::frame_room<trio::dump>() >= {}, "");'
    said = "each handler has to take an event of"
    rooms = re.findall(r"TRIO_DUMP_FROM_\w+_FRAME_ROOM(?= )", (tmp_path / "trio.h").read_text())
    assert len(rooms) > 1
    for handler, refused in (("const trio::ping &", False), ("const alien &", True)):
        lines = [
            '#include "trio.hpp"',
            *map(room.format, rooms),
            "struct alien {};",
            f"void f(trio::station_decoder &d) {{ d.push(1, []({handler}) {{}}); }}",
        ]
        (tmp_path / "forms.cc").write_text("\n".join(lines), encoding="utf-8")
        command = [require_tool("g++"), "-std=c++11", *WARNINGS, "-fsyntax-only", "forms.cc"]
        done = subprocess.run(command, cwd=tmp_path, capture_output=True, text=True, check=False)
        assert (done.returncode != 0) == refused, done.stderr
        assert (said in done.stderr) == refused


# --- names ----------------------------------------------------------------------------------------


def test_names_that_are_taken_are_escaped() -> None:
    names = cpp_names(protocol_of(ROOT / "tests" / "framings" / "taken_names.yaml"))
    escaped = {name for table in names.tables for found in table.escaped.values() for name in found}
    # The message `result`; the value `class`; the value and the struct `true`.
    assert {"result_", "class_", "true_"} <= escaped


PARTS = """
protocol: parts
endpoints: {board: Board}
byte_order: little
frame:
  start: {literal: 0x7E}
  id: {type: uint8, id: true}
  give: {type: uint8, default: 0}
  put: {type: uint8, default: 0}
  result: {type: uint8, default: 0}
  data: {type: uint8, default: 0}
  payload: {}
  sum: {type: uint8, algorithm: CRC-8/SMBUS, covers: id..payload}
  end: {literal: 0x7E}
transparency: hdlc
messages:
  data: {id: 1, from: board, fields: {pace: {type: sint16, scale: 1/73786976294838206464}}}
  received: {id: 2, from: board}
"""
"""Names of what is in the functions of the header, and a scale of 2^-66, which no integer holds."""


def test_parts_and_messages_are_called_as_parameters_of_the_header(tmp_path: Path) -> None:
    path = tmp_path / "parts.yaml"
    path.write_text(PARTS, encoding="utf-8")
    written(path, ALL, tmp_path)
    text = """#include "parts.hpp"
    static_assert(parts::data_pace_raw(parts::data_pace_physical(5)) == 5, "");
    parts::result f(parts::board_decoder &decoder, void (&put)(uint8_t)) {
        decoder.push(1, [](const parts::data &) {});
        return parts::send(parts::data(), 1, 2, 3, 4, put);
    }"""
    (tmp_path / "parts.cc").write_text(text, encoding="utf-8")
    for compiler in ("g++", "clang++"):
        run(
            [require_tool(compiler), "-std=c++11", *WARNINGS, "-fsyntax-only", "parts.cc"], tmp_path
        )


def test_the_header_is_made_where_it_is_asked_for() -> None:
    protocol = protocol_of(MATTY)
    plain = [file.path.name for file in emit([protocol], COptions())]
    single = [file.path.name for file in emit([protocol], COptions(style="single", hpp=True))]
    assert "matty.hpp" not in plain
    assert single == ["matty.h", "matty.hpp"]
