"""Programs of the documentation on an ATmega328P in simavr, with interrupts at 115200 baud.

Bytes come without a pause, frames among noise and damage. What the board answers is compared with
what the Python decoder finds in the same bytes.
"""

from __future__ import annotations

import asyncio
import subprocess
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from functools import partial
from pathlib import Path
from random import Random
from types import ModuleType
from typing import Any

import pytest
from compiled import DOCUMENTS, module_at, protocol_of
from corpus import Material, material_of, stream_of
from doc_pages import ROOT, Page
from tooling import PROGRAM, require_arduino_core, require_compiler, require_tool

from protogen.link import RefusedError
from protogen.model.protocol import Protocol
from protogen.targets.c.emit import emit
from protogen.targets.c.options import COptions

BOARDS = ROOT / "tests" / "c_boards"
INTERRUPTS = Page("docs/howto/bytes-by-interrupt.md")
ARDUINO = Page("docs/howto/arduino.md")
CORE_SOURCES = (
    *("main.cpp", "hooks.c", "wiring.c", "wiring_digital.c", "abi.cpp"),
    *("HardwareSerial.cpp", "HardwareSerial0.cpp", "Print.cpp"),
)
MATTY = next(path for path in DOCUMENTS if path.stem == "matty")
FLAGS = (
    *("-mmcu=atmega328p", "-DF_CPU=16000000L", "-Os", "-ffunction-sections", "-fdata-sections"),
    *("-Wl,--gc-sections", "-Wall", "-Wextra", "-Werror"),
)
PATIENCE = 120
"""Seconds; nothing waits for them on purpose."""


def succeed(*command: str | Path, data: bytes = b"", cwd: Path | None = None) -> bytes:
    """Output of a program, which has to succeed."""
    done = subprocess.run(
        command, input=data, capture_output=True, timeout=PATIENCE, check=False, cwd=cwd
    )
    assert done.returncode == 0, (done.returncode, done.stderr.decode(errors="replace"))
    return done.stdout


def written(page: Page, name: str, folder: Path) -> Path:
    """The program of a page, as a file."""
    (text,) = (
        it.text for it in page.blocks if it.language in ("c", "cpp") and name in it.text[:40]
    )
    (folder / name).write_text(text, encoding="utf-8")
    return folder / name


def generated(protocol: Protocol, folder: Path) -> Path:
    """A folder with the C of a protocol that reports messages alone."""
    for file in emit([protocol], COptions(events="messages")):
        if file.path.suffix in (".c", ".h"):
            (folder / file.path.name).write_bytes(file.bytes)
    return folder


@pytest.fixture(scope="module")
def line(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The program that runs a board and the line to it."""
    require_tool("simavr")
    program = tmp_path_factory.mktemp("line") / "line"
    compiler = require_compiler("cc", "-lsimavr", source=f"#include <simavr/sim_avr.h>\n{PROGRAM}")
    warnings = ("-Wall", "-Wextra", "-Werror")
    succeed(compiler, "-O2", *warnings, BOARDS / "line.c", "-o", program, "-lsimavr")
    return program


@pytest.fixture(scope="module")
def matty_c(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder with matty's C, compiled for the board."""
    folder = generated(protocol_of(MATTY), tmp_path_factory.mktemp("matty"))
    succeed(require_tool("avr-gcc"), "-std=c99", *FLAGS, "-c", "matty.c", cwd=folder)
    return folder


def board(name: str, folder: Path) -> Path:
    """A program of the page about interrupts, for the board."""
    written(INTERRUPTS, name, folder)
    program = folder / f"{name}.elf"
    command = (require_tool("avr-gcc"), "-std=gnu99", *FLAGS, name, "matty.o", "-o", program)
    succeed(*command, cwd=folder)
    return program


@pytest.fixture(scope="module")
def robot(matty_c: Path) -> Path:
    return board("robot.c", matty_c)


@pytest.fixture(scope="module")
def sketch(tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, Path]:
    """The sketch of the page about Arduinos, with Arduino's own core; and its schema."""
    arduino = require_arduino_core()
    folder = tmp_path_factory.mktemp("sketch")
    schema = folder / "blink.yaml"
    (text,) = (it.text for it in ARDUINO.blocks if it.language == "yaml")
    schema.write_text(text, encoding="utf-8")
    generated(protocol_of(schema), folder)
    source = written(ARDUINO, "blink.ino", folder)
    paths = (folder, arduino / "cores" / "arduino", arduino / "variants" / "standard")
    flags = (*FLAGS, "-DARDUINO=10808", *(f"-I{path}" for path in paths))
    core = [arduino / "cores" / "arduino" / name for name in CORE_SOURCES]
    compiler = require_tool("avr-g++")
    # One call for each language; `-w`: Arduino's own sources have warnings.
    as_cpp = ("-std=gnu++11", "-fpermissive", "-c")
    run = partial(succeed, cwd=folder)
    run(compiler, *flags, *as_cpp, "-w", *(it for it in core if it.suffix == ".cpp"))
    run(require_tool("avr-gcc"), *flags, "-c", "-w", *(it for it in core if it.suffix == ".c"))
    run(require_tool("avr-gcc"), *flags, "-std=c99", "-c", "blink.c")
    run(compiler, *flags, *as_cpp, "-include", "Arduino.h", "-x", "c++", source, "-o", "sketch.o")
    run(compiler, *flags, *folder.glob("*.o"), "-o", "sketch.elf")
    return folder / "sketch.elf", schema


# --- noise ----------------------------------------------------------------------------------------


def noisy(schema: Path, sender: str, unwanted: Sequence[str], seed: int) -> bytes:
    """Frames of a sender among noise and damaged frames, but none of the unwanted messages."""
    module = module_at(schema)
    known = material_of(schema, sender)
    wanted = tuple(
        frame
        for frame in known.frames
        if not {it.message.NAME for it in messages(module, sender, frame)} & {*unwanted}
    )
    return stream_of(Material(wanted, known.marks), Random(seed), 200).data


def messages(module: ModuleType, sender: str, data: bytes) -> list[Any]:
    decoder = module.Decoder(sender=sender)
    return [it for it in [*decoder.feed(data), *decoder.flush()] if it.kind == "message"]


@pytest.mark.parametrize("seed", range(3))
def test_a_ring_loses_no_frame_in_noise(line: Path, robot: Path, seed: int) -> None:
    matty = module_at(MATTY)
    data = noisy(MATTY, "pc", ["timing"], seed)
    answers = messages(matty, "esp", succeed(line, robot, data=data))
    found = [(it.message.NAME, it.parts.counter) for it in answers if it.message.NAME != "status"]
    expected = list(confirmations(messages(matty, "pc", data)))
    assert len(expected) > 50
    assert found == expected
    assert len(answers) > len(found), "it sends its status, too"


def confirmations(commands: Sequence[Any]) -> Iterator[tuple[str, int]]:
    """What the robot has to answer: a refusal has the counter of the last command understood."""
    understood = 0
    for event in commands:
        is_refused = event.message.NAME == "mode" and event.message.mode > 2
        if not is_refused:
            understood = event.parts.counter
        yield ("nack" if is_refused else "ack"), understood


def test_an_interrupt_that_decodes_keeps_the_newest(line: Path, matty_c: Path) -> None:
    matty = module_at(MATTY)
    data = noisy(MATTY, "pc", [], 1)
    commands = [it.message for it in messages(matty, "pc", data) if it.message.NAME == "go"]
    sent = [(it.speed, it.steer) for it in commands]
    output = succeed(line, board("follow.c", matty_c), data=data)
    found = [(it.message.speed, it.message.angle) for it in messages(matty, "esp", output)]
    assert found[-1] == sent[-1]
    assert len(found) > len(sent) // 3
    rest = iter(sent)
    assert all(item in rest for item in found), "in their order"


@pytest.mark.parametrize("seed", range(3))
def test_a_sketch_loses_no_frame_in_noise(line: Path, sketch: tuple[Path, Path], seed: int) -> None:
    program, schema = sketch
    blink = module_at(schema)
    dice = Random(seed)
    frames = tuple(
        blink.encode(blink.Led(is_on=dice.random() < 0.5), counter=dice.randrange(256))
        for _ in range(100)
    )
    data = stream_of(Material(frames, b"\x55\x56\x01\x03"), dice, 200).data
    commands = messages(blink, "host", data)
    assert len(commands) > 80
    answers = messages(blink, "board", succeed(line, program, data=data))
    found = [(it.parts.counter, it.message.is_lit) for it in answers]
    assert found == [(it.parts.counter, it.message.is_on) for it in commands]


# --- Python at the other end ----------------------------------------------------------------------


@contextmanager
def running(line: Path, program: Path) -> Iterator[str]:
    """The name of the pseudo-terminal at which a board is."""
    simulated = subprocess.Popen(
        [line, program, "pty"], stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True
    )
    assert simulated.stdout
    try:
        yield simulated.stdout.readline().strip()
    finally:
        simulated.communicate(timeout=PATIENCE)


def test_python_commands_a_robot(line: Path, robot: Path) -> None:
    pytest.importorskip("serialx")
    with running(line, robot) as port:
        asyncio.run(asyncio.wait_for(drive(module_at(MATTY), port), PATIENCE))


async def drive(matty: Any, port: str) -> None:
    """Commands, each confirmed; one refused; and the status that says what came of them."""
    async with matty.connect(port, "pc") as link:
        states = link.messages(matty.Status)
        commands = (
            matty.Timing(period=20, timeout=1000),
            matty.Mode(mode=matty.RobotMode.AUTONOMOUS),
            matty.Limits(max_speed=800, max_steer=3000),
            matty.GpsMode(mode=matty.GpsModeMode.SWITCHED_OFF),
            matty.Go(speed=0x5556, steer=-1234),  # Stuffed, in both directions.
        )
        for command in commands:
            assert await link.request(command, timeout=PATIENCE) == matty.Ack()
        with pytest.raises(RefusedError) as refused:
            await link.request(matty.Mode(mode=7), timeout=PATIENCE)
        assert refused.value.refusal == matty.Nack()
        await until(states, mode=2, speed=0x5556, angle=-1234)
        assert await link.request(matty.Stop(), timeout=PATIENCE) == matty.Ack()
        await until(states, mode=2, speed=0, angle=-1234)
        assert not [name for name in link.counts.received if name.startswith("invalid")]


async def until(states: Any, **values: int) -> None:
    """Wait for a status with these values."""
    while True:
        status = await states.get(PATIENCE)
        if all(getattr(status, name) == value for name, value in values.items()):
            return
