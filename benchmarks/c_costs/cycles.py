"""Cycles of decoding and encoding on small machines, in simulators."""

from __future__ import annotations

import tempfile
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from math import nan
from pathlib import Path
from statistics import median

from c_costs import cortex_m0
from c_costs.events import Event, said, spans
from c_costs.protocols import FOLDER
from c_costs.toolchains import ARM, AVR, AVR_APART, HOST, Toolchain, run
from c_costs.workshop import Subject, Workshop, frames_of

FRAMES = 8
"""Frames of each message that are decoded and encoded."""


@dataclass(frozen=True)
class Machine:
    """A small machine that counts cycles."""

    builds: Mapping[str, Toolchain]
    events: Callable[[Path], list[Event]]
    """Runs a program, and returns what it tells."""
    loop: int
    """Cycles of the harness's own loop for each byte: load, increment, compare and branch."""


def atmega328p(counter: Path) -> Machine:
    """The one of simavr."""
    return Machine(AVR, lambda program: _avr_events(run([str(counter), str(program)])), 7)


CORTEX_M0 = Machine(ARM, cortex_m0.events, 7)


def build_counter(workshop: Workshop) -> Path:
    program = workshop.folder / "counter"
    source = FOLDER / "harness" / "counter.c"
    run(["cc", "-O2", "-o", str(program), str(source), "-lsimavr", "-lelf"])
    return program


@dataclass
class Cycles:
    """Of one message on a small machine."""

    bytes: float
    decode: float
    """Not a number where a frame was not decoded."""
    encode: float


def cycles(workshop: Workshop, machine: Machine, build: str, subject: Subject) -> list[Cycles]:
    """Decode and encode frames of each message on a machine."""
    host = workshop.build(HOST, "host", subject)
    return [
        _cycles_of(workshop, machine, build, subject, which, frames_of(host, which, FRAMES))
        for which in range(len(subject.protocol.messages))
    ]


def _cycles_of(
    workshop: Workshop,
    machine: Machine,
    build: str,
    subject: Subject,
    which: int,
    frames: list[bytes],
) -> Cycles:
    program = _with_frames(workshop, machine.builds[build], subject, which, frames)
    told = machine.events(program)
    sizes = [len(frame) for frame in frames]
    heard = list(zip(*[iter(said(told))] * 3, strict=True))
    made = [low | high << 8 for _, low, high in heard]
    # MAVLink cuts zeros off at the end, which nobody counts where it sends byte by byte.
    if not all(made) if subject.kind == "mavlink" else made != sizes:
        where = machine.builds[build].title
        text = f"{subject.kind} {subject.protocol.name} {which} on {where}: {heard}, {sizes}"
        raise SystemExit(text)
    encoded = median(spans(told, 3))
    if any(seen != 1 for seen, _, _ in heard):
        return Cycles(median(sizes), nan, encoded)
    # The first decode only wakes the decoder up. A payload without a frame is handed over at once.
    loop = 0 if subject.kind == "nanopb" else machine.loop * median(sizes)
    return Cycles(median(sizes), median(spans(told, 1)[1:]) - loop, encoded)


def _with_frames(
    workshop: Workshop, toolchain: Toolchain, subject: Subject, which: int, frames: list[bytes]
) -> Path:
    folder = Path(tempfile.mkdtemp(dir=workshop.folder))
    (folder / "frames.h").write_text(_table(which, frames), encoding="utf-8")
    return workshop.build(toolchain, "cycles", subject, f"-I{folder}")


def cycles_apart(workshop: Workshop, counter: Path, subject: Subject) -> list[tuple[str, float]]:
    """Cycles for one byte in each function, while frames of the first message are decoded."""
    frames = frames_of(workshop.build(HOST, "host", subject), 0, FRAMES)
    program = _with_frames(workshop, AVR_APART, subject, 0, frames)
    symbols = run([f"{AVR_APART.prefix}nm", "-S", "--defined-only", str(program)])
    rows = [line.split() for line in symbols.splitlines()]
    places = [(int(row[0], 16), int(row[1], 16), row[3]) for row in rows if len(row) == 4]
    spent: dict[str, int] = {}
    for words in map(str.split, run([str(counter), str(program)]).splitlines()):
        if words[0] == "pc":
            at = int(words[1])
            names = [name for start, size, name in places if start <= at < start + size]
            name = names[0] if names else "libgcc"
            spent[name] = spent.get(name, 0) + int(words[2])
    # The first frame is decoded twice.
    whole = len(frames[0]) + sum(map(len, frames))
    ranked = sorted(spent.items(), key=lambda item: -item[1])
    return [(name, number / whole) for name, number in ranked if name not in _HARNESS][:12]


_HARNESS = ("decode", "bench_seen", "subject_push", "main")


def _avr_events(text: str) -> list[Event]:
    """What harness/counter.c prints."""
    told = []
    for words in map(str.split, text.splitlines()):
        match words:
            case ["say", byte]:
                told.append(Event(0, said=int(byte)))
            case ["mark", mark, cycle]:
                told.append(Event(int(cycle), mark=int(mark)))
    return told


def _table(which: int, frames: Sequence[bytes]) -> str:
    offsets = [sum(map(len, frames[:index])) for index in range(len(frames))]
    arrays = (
        ("uint8_t", "frame_which", [which] * len(frames)),
        ("uint16_t", "frame_at", offsets),
        ("uint16_t", "frame_size", list(map(len, frames))),
        ("uint8_t", "frame_bytes", list(b"".join(frames))),
    )
    lines = [f"#define FRAMES {len(frames)}"]
    for type_, name, values in arrays:
        lines.append(f"static const {type_} {name}[] PROGMEM = {{{', '.join(map(str, values))}}};")
    return "\n".join(lines) + "\n"
