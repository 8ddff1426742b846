"""One set of vectors through generated C on every machine: bytes, values and events as Python's.

On x86-64 by three compilers, on a big-endian s390x, on a 32-bit RISC-V without a C library, on a
Cortex-M3, on an ATmega328P, and, by SDCC, on an STM8 and an 8051. Frames, payloads and streams are
the boundaries of every field, random ones, and damaged ones; all follow from fixed seeds.
"""

from __future__ import annotations

import io
import os
import subprocess
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from functools import cache
from itertools import chain, islice
from pathlib import Path
from random import Random
from typing import Any

import pytest
from c_engine import MACHINES, build, comparable, first_difference, python_events, same_events
from c_library import FLAGS
from compiled import DIALECTS, DOCUMENTS, SCHEMAS, covering, module_at, name_of, protocol_of
from corpus import material_of, stream_of
from test_c_codecs import Case, Content
from test_c_decoder import steps_of
from test_c_frames import frame_of
from tooling import PROGRAM, require_compiler, require_tool

from protogen.fuzzing.c_calls import OK, RANGE, REFUSED, Calls, Encoded
from protogen.fuzzing.c_driver import Driver
from protogen.fuzzing.c_values import Answers
from protogen.fuzzing.samples import boundary_rounds, samples
from protogen.fuzzing.trips import same
from protogen.live.codec import module_of
from protogen.model.protocol import Sender
from protogen.passes.selection import select
from protogen.targets.c.fuzz_driver.driver import driver_of
from protogen.targets.c.options import COptions

SMALL = 64
"""The greatest payload of the messages that small machines are given."""
TOO_MUCH = [("rflex", "mcs51")]
"""Documents that take more than the 64 KB that an 8051 has for programs."""
FLASH, RAM, STACK = 32768, 2048, 512
"""Bytes that it has; so much of the RAM is left to the stack."""


@dataclass(frozen=True)
class Machine:
    """Compiling a driver for a machine, and running it there with a folder to work in."""

    compiler: str
    flags: tuple[str, ...]
    source: str
    run: Callable[[Path, Path], bytes]
    """Takes the program and the file of requests, gives the answers."""
    greatest: int = 1 << 20
    room: int = 1 << 16
    build: Callable[..., Path] = build


def on_streams(*launcher: str) -> Callable[[Path, Path], bytes]:
    """Requests come from the standard input, answers go to the standard output."""

    def run(program: Path, requests: Path) -> bytes:
        command = [*map(require_tool, launcher[:1]), *launcher[1:], str(program)]
        with requests.open("rb") as stream:
            return output_of(command, stdin=stream)

    return run


def on_cortex_m3(program: Path, requests: Path) -> bytes:
    qemu = [require_tool("qemu-system-arm"), "-M", "mps2-an385", "-display", "none"]
    quiet = ["-serial", "none", "-monitor", "none"]
    semihosting = ["-semihosting-config", "enable=on,target=native"]
    output_of([*qemu, *quiet, *semihosting, "-kernel", str(program)], cwd=requests.parent)
    return (requests.parent / "answers").read_bytes()


def on_atmega328p(program: Path, requests: Path) -> bytes:
    sizes = output_of([require_tool("avr-size"), str(program)]).splitlines()[1].split()
    text, data, bss = map(int, sizes[:3])
    assert text + data <= FLASH
    assert data + bss <= RAM - STACK
    with requests.open("rb") as stream:
        return output_of([str(simulator()), str(program)], stdin=stream)


@cache
def simulator() -> Path:
    """Runner of a program for the ATmega328P, with the machine's registers as its streams."""
    require_tool("simavr")
    folder = Path(_folders().mktemp("simulator"))
    source = MACHINES / "simulator.c"
    compiler = require_compiler("cc", "-lsimavr", source=f"#include <simavr/sim_avr.h>\n{PROGRAM}")
    output_of([compiler, "-O2", "-o", str(folder / "run"), str(source), "-lsimavr"])
    return folder / "run"


def in_ucsim(simulator: str, memory: str) -> Callable[[Path, Path], bytes]:
    """A byte of memory is the simulator's interface, by which programs read and write files."""

    def run(program: Path, requests: Path) -> bytes:
        data, answers = requests.read_bytes(), requests.with_name("answers")
        requests.write_bytes(len(data).to_bytes(4, "big") + data)
        interface = f"if={memory}[0x7fff],in={requests},out={answers}"
        console, typed = os.pipe()  # It stops where its console ends.
        try:
            output_of([require_tool(simulator), "-G", "-I", interface, str(program)], stdin=console)
        finally:
            os.close(console)
            os.close(typed)
        return answers.read_bytes()

    return run


def build_by_sdcc(driver: Driver, folder: Path, command: Sequence[str], machine: str) -> Path:
    """Compile a driver by SDCC, which takes one source at a time, and no flag of other compilers.

    It has to have nothing to say of what was generated.
    """
    flags = [flag for flag in command if flag not in FLAGS]
    sources = [*driver.write(folder), MACHINES / machine]
    for source in sources:
        given = [f"-I{folder}", "-c", str(source), "-o", f"{source.stem}.rel"]
        done = subprocess.run([*flags, *given], capture_output=True, check=False, cwd=folder)
        is_ours = source.name == f"{driver.protocol.name}.c"
        said = (done.stdout + done.stderr).decode()
        assert done.returncode == 0 and not (is_ours and said), said
    objects = [f"{source.stem}.rel" for source in sources]
    output_of([*flags, *objects, "-o", "driver.ihx"], cwd=folder)
    return folder / "driver.ihx"


_FACTORY: list[pytest.TempPathFactory] = []


def _folders() -> pytest.TempPathFactory:
    return _FACTORY[0]


@pytest.fixture(scope="session", autouse=True)
def _keep_factory(tmp_path_factory: pytest.TempPathFactory) -> None:
    _FACTORY.append(tmp_path_factory)


def output_of(command: Sequence[str], **more: Any) -> bytes:
    """Output of a program, which has to end well, and soon."""
    done = subprocess.run(command, capture_output=True, check=False, timeout=300, **more)
    assert done.returncode == 0, (done.returncode, done.stderr.decode(errors="replace"))
    return done.stdout


_CORTEX_M3 = (
    *("-Os", "-mcpu=cortex-m3", "-mthumb", "--specs=rdimon.specs", "-lrdimon"),
    *("-Wl,--gc-sections", f"-T{MACHINES / 'mps2_an385.ld'}"),
)
_RISCV32 = (
    *("-Os", "-march=rv32imac", "-mabi=ilp32", "-ffreestanding", "-nostdlib", "-static"),
    *(f"-isystem{MACHINES / 'freestanding'}", "-Wl,--no-relax"),
)
_SDCC = (
    *("--std-c99", "--disable-warning", "110", "-DDRIVER_CHUNK=32u"),
    *("--max-allocs-per-node", "200"),  # A search for registers that takes a tenth of the time.
)
_STM8 = ("-mstm8", *_SDCC)
_MCS51 = ("-mmcs51", "--model-large", "--stack-auto", *_SDCC)
_ATMEGA328P = ("-Os", "-mmcu=atmega328p", "-DDRIVER_CHUNK=32u")
ALL = {
    "gcc": Machine("gcc", ("-O2",), "streams.c", on_streams()),
    "clang": Machine("clang", ("-O2",), "streams.c", on_streams()),
    "tcc": Machine("tcc", (), "streams.c", on_streams()),
    "s390x": Machine(
        "s390x-linux-gnu-gcc", ("-O2", "-static"), "streams.c", on_streams("qemu-s390x")
    ),
    "riscv32": Machine("riscv64-unknown-elf-gcc", _RISCV32, "riscv.c", on_streams("qemu-riscv32")),
    "cortex-m3": Machine("arm-none-eabi-gcc", _CORTEX_M3, "files.c", on_cortex_m3),
    "atmega328p": Machine("avr-gcc", _ATMEGA328P, "avr.c", on_atmega328p, SMALL, 32),
    "stm8": Machine(
        *("sdcc", _STM8, "ucsim.c", in_ucsim("sstm8", "rom")), SMALL, 32, build_by_sdcc
    ),
    "mcs51": Machine(
        *("sdcc", _MCS51, "ucsim.c", in_ucsim("s51", "xram")), SMALL, 32, build_by_sdcc
    ),
}


# --- vectors --------------------------------------------------------------------------------------


@dataclass(frozen=True)
class Vector:
    """A call of a driver, and what its answer has to be."""

    name: str
    call: Callable[[Calls], Any]
    check: Callable[[Any], bool]
    expected: Any


def selection(path: Path, greatest: int) -> tuple[str, ...] | None:
    """The messages that are small enough; None: all of them."""
    messages = protocol_of(path).messages
    small = tuple(item.name for item in messages if item.sizes.greatest <= greatest)
    return None if len(small) == len(messages) else small


@cache
def vectors(path: Path, greatest: int) -> list[Vector]:
    """All vectors of a schema's messages that are small enough."""
    only = selection(path, greatest)
    protocol = select(protocol_of(path), only)
    found: list[Vector] = []
    for sender in protocol.senders:
        for message in sender.messages:
            found += _payloads(Case(path, message))
            found += _frames(path, sender, message.name)
        found += _streams(path, sender, only)
    return found


def _payloads(case: Case) -> Iterator[Vector]:
    name = case.message.name
    for values in case.samples(6):
        payload = case.payload(values)
        expected = Encoded(RANGE, b"") if payload is None else Encoded(OK, payload)
        yield Vector(name, _encode(name, values), expected.__eq__, expected)
    contents = case.contents()
    dice = Random(name)
    each = (islice(case.damages(item, contents, dice), 8, 40) for item in contents[:4])
    for content in dict.fromkeys([*contents, *chain.from_iterable(each)]):
        if len(content.payload) > case.message.sizes.greatest + 9:
            continue
        result, values = case.values(content)
        yield Vector(name, _decode(name, content), _is_decoded(result, values), (result, values))


def _encode(name: str, values: Any) -> Callable[[Calls], Any]:
    return lambda calls: calls.encode(name, values)


def _decode(name: str, content: Content) -> Callable[[Calls], Any]:
    return lambda calls: calls.decode(name, content.payload, content.held)


def _is_decoded(result: int, values: Any) -> Callable[[Any], bool]:
    return lambda found: found.result == result and found.intact and same(found.values, values)


def _frames(path: Path, sender: Sender, message: str) -> Iterator[Vector]:
    model = protocol_of(path).message(message)
    found = samples(model, sender.frame, Random(message))
    for values, parts in islice(found, boundary_rounds(model, sender.frame) + 3):
        frame = frame_of(path, sender.name, message, values, parts)
        result = (REFUSED, b"") if frame is None else (OK, frame)
        given = (sender.name, message, values, parts)
        yield Vector(message, _frame(*given), _is_frame(*result), result)
        if frame is not None:
            yield Vector(message, _send(*given), _is_sent(frame), frame)


def _frame(*given: Any) -> Callable[[Calls], Any]:
    return lambda calls: calls.frame(*given)


def _is_frame(result: int, frame: bytes) -> Callable[[Any], bool]:
    return lambda found: (found.result, found.data, found.intact) == (result, frame, True)


def _send(*given: Any) -> Callable[[Calls], Any]:
    """Send where that is possible, else make the frame again."""
    return lambda calls: (calls.send if calls.sends(*given[:2]) else calls.frame)(*given)


def _is_sent(frame: bytes) -> Callable[[Any], bool]:
    return lambda found: (found.result, found.data) == (OK, frame) and isinstance(found, Encoded)


def _streams(path: Path, sender: Sender, only: tuple[str, ...] | None) -> Iterator[Vector]:
    whole = protocol_of(path)
    module = module_at(path) if only is None else module_of(select(whole, only))
    material = material_of(path, sender.name)
    for seed in range(6):
        dice = Random(f"{path.stem} {sender.name} {seed}")
        steps = steps_of(stream_of(material, dice, 20).data, dice)
        expected = python_events(module, sender.name, steps)
        assert comparable(whole, expected) is None
        yield Vector(sender.name, _events(sender.name, steps), _are_events(expected), expected)


def _events(sender: str, steps: Any) -> Callable[[Calls], Any]:
    return lambda calls: calls.events(sender, steps)


def _are_events(expected: Any) -> Callable[[Any], bool]:
    return lambda found: all(
        same_events(one, other) for one, other in zip(found, expected, strict=True)
    )


# --- machines -------------------------------------------------------------------------------------


NARROW, SWAPPED = "atmega328p", "s390x"
"""Numbers of 16 bits, which compilers warn of; and the other order of bytes."""


def machines_of(path: Path) -> Iterator[str]:
    """Machines on which a schema is tried: our documents on all, each framing on the narrowest."""
    for name in ALL:
        is_tried = name == NARROW or (name == SWAPPED and path in {*covering(), *DIALECTS})
        if is_tried or (path in DOCUMENTS and (path.stem, name) not in TOO_MUCH):
            yield name


TRIED = [(path, name) for path in SCHEMAS for name in machines_of(path)]


@pytest.mark.parametrize(
    ("path", "name"), TRIED, ids=[f"{name_of(path)}-{name}" for path, name in TRIED]
)
def test_every_machine_gives_the_same(path: Path, name: str, tmp_path: Path) -> None:
    machine = ALL[name]
    only = selection(path, machine.greatest)
    driver = driver_of(protocol_of(path), COptions(only=only))
    command = [require_tool(machine.compiler), *FLAGS, *machine.flags]
    if machine.compiler == "arm-none-eabi-gcc":
        command.remove("-Wpedantic")  # newlib's own headers
    program = machine.build(driver, tmp_path, command, machine.source)
    calls = Calls(driver, machine.room)
    tried = [(vector, vector.call(calls)) for vector in vectors(path, machine.greatest)]
    requests = tmp_path / "requests"
    requests.write_bytes(b"".join(call.request for _, call in tried))
    answers = io.BytesIO(machine.run(program, requests))
    reader = Answers(answers)
    for vector, call in tried:
        found = call.read(reader)
        assert vector.check(found), f"{vector.name}: {difference(found, vector.expected)}"
    assert answers.read() == b""


def difference(found: Any, expected: Any) -> str:
    """Output of a machine, and of Python."""
    if isinstance(found, list):
        for one, other in zip(found, expected, strict=True):
            if not same_events(one, other):
                return first_difference(one, other)
    return f"{found} is not {expected}"
