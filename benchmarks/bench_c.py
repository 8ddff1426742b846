"""Costs of generated C, beside an expert's C by hand, MAVLink C and nanopb, with equal messages.

    python benchmarks/bench_c.py             # writes benchmarks/c.md
    python benchmarks/bench_c.py --rounds 5  # fewer rounds of the timings on this machine

Needs avr-gcc, arm-none-eabi-gcc, cc, libsimavr-dev and `pip install pymavlink`. The first run
fetches nanopb's C sources by npm into `.cache/bench`; without them its cells stay empty.
"""

from __future__ import annotations

import argparse
import os
import platform
import re
import shutil
import subprocess
import sys
import tarfile
import tempfile
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cache
from importlib.metadata import version
from importlib.util import find_spec
from math import isnan, nan
from pathlib import Path
from random import Random
from statistics import median
from xml.etree import ElementTree

ROOT = Path(__file__).resolve().parent.parent
sys.path[:0] = [str(ROOT), str(ROOT / "tests")]

import corpus  # noqa: E402

from protogen.version import VERSION  # noqa: E402

HERE = ROOT / "benchmarks" / "c"
OUT = ROOT / "benchmarks" / "c.md"
CACHE = ROOT / ".cache" / "bench"
TARGET = 1.15
"""The most that generated C may cost, by the expert's."""
SHARE = 2
"""The most time that a fed buffer may take, by that of the expert with SSE2."""
FED = 1000
"""The megabytes a second that a buffer is to be fed at."""
FRAMES = 8
"""Frames of each message that are decoded and encoded in simavr."""


# --- what is compared -----------------------------------------------------------------------------


@dataclass(frozen=True)
class Protocol:
    """Some messages of a schema that one program sends and receives."""

    name: str
    title: str
    schema: Path
    sender: str
    messages: tuple[str, ...]
    memory: int
    """Bytes for the greatest message."""
    timed: int
    """Frames in the stream of the timings."""
    marks: bytes
    """Bytes that mean something to a receiver, for the noise."""

    @property
    def label(self) -> str:
        """The document, whatever the schema is called here."""
        return self.title.split()[0]


PROTOCOLS = (
    Protocol(
        "rn1",
        "rn1 gyro + lidar",
        ROOT / "schemas" / "rn1.yaml",
        "brain",
        ("gyro", "lidar"),
        736,
        64,
        b"\x80\x84\xff\xfe\x00\x01",
    ),
    Protocol(
        "atrv",
        "rflex read_motor + sonar_data",
        HERE / "atrv.yaml",
        "flex",
        ("read_motor", "sonar_data"),
        96,
        256,
        b"\x1b\x02\x03\x7c\x00\x01\x04\x21",
    ),
    Protocol(
        "matty",
        "matty status",
        ROOT / "schemas" / "matty.yaml",
        "esp",
        ("status",),
        32,
        256,
        b"\x55\x56\xa9\xaaI\x00\x01\xff",
    ),
)


TOGETHER = Protocol("all", "all five", HERE, "", (), PROTOCOLS[0].memory, 0, b"")
"""The messages of all of them in one program."""


@dataclass(frozen=True)
class Subject:
    """A codec for the messages of a protocol."""

    kind: str
    protocol: Protocol
    header: Path
    """Its functions, in the words of `harness/bench.h`."""
    folders: tuple[Path, ...]
    sources: tuple[Path, ...]
    flags: tuple[str, ...] = ()


KINDS = {
    "messages": "protogen, `--events messages`",
    "all": "protogen, all events",
    "expert": "expert",
    "mavlink": "MAVLink C",
}
SMALL_KINDS = {**KINDS, "nanopb": "nanopb, no framing"}
"""Contenders on small machines."""
FED_KINDS = {**KINDS, "vector": "protogen, `NAME_SSE2`", "sse2": "expert with SSE2"}
"""Contenders that are fed whole buffers on this machine."""
HAS_SSE2 = platform.machine().lower() in ("x86_64", "amd64")


class Workshop:
    """A folder where everything is generated and built."""

    def __init__(self, folder: Path) -> None:
        self.folder = folder
        self._built = 0

    def subject(self, kind: str, protocol: Protocol) -> Subject:
        makers = {
            "expert": self._expert,
            "sse2": self._sse2,
            "mavlink": self._mavlink,
            "nanopb": self._nanopb,
        }
        make = makers.get(kind)
        return make(protocol) if make else self._protogen(kind, protocol)

    def together(self, kind: str, parts: Sequence[Subject]) -> Subject:
        """One program with the messages of several subjects."""
        if kind in ("mavlink", "nanopb"):
            return self.subject(kind, TOGETHER)
        name = "expert" if kind == "expert" else "protogen"
        header = HERE / "subjects" / f"use_{name}_all.h"
        folders = tuple(folder for part in parts for folder in part.folders)
        sources = tuple(source for part in parts for source in part.sources)
        return Subject(kind, TOGETHER, header, folders, sources, parts[0].flags)

    def _protogen(self, events: str, protocol: Protocol) -> Subject:
        output = self.folder / events / protocol.name
        only = [word for name in protocol.messages for word in ("--only", name)]
        options = ["--target", "c", "--events", events, "--sender", protocol.sender, *only]
        command = [sys.executable, "-m", "protogen", "generate", str(protocol.schema)]
        run([*command, "-o", str(output), "--quiet", *options])
        source = output / "c" / f"{protocol.name}.c"
        header = HERE / "subjects" / f"use_protogen_{protocol.name}.h"
        flags = ("-DBENCH_POLLS",) if events == "messages" else ()
        return Subject(events, protocol, header, (source.parent,), (source,), flags)

    def _expert(self, protocol: Protocol) -> Subject:
        folder = HERE / "expert"
        header = HERE / "subjects" / f"use_expert_{protocol.name}.h"
        return Subject(
            "expert", protocol, header, (folder,), (folder / f"expert_{protocol.name}.c",)
        )

    def _sse2(self, protocol: Protocol) -> Subject:
        """It encodes as the other expert does, and takes single bytes as that does."""
        other = self._expert(protocol)
        source = HERE / "expert" / f"sse2_{protocol.name}.c"
        header = HERE / "subjects" / f"use_sse2_{protocol.name}.h"
        return Subject("sse2", protocol, header, other.folders, (*other.sources, source))

    def _nanopb(self, protocol: Protocol) -> Subject:
        runtime = nanopb()
        assert runtime is not None
        sends_lidar = protocol.name in ("rn1", TOGETHER.name)
        flags = ["-DPB_FIELD_16BIT", "-DPB_NO_ERRMSG"]
        flags += [] if sends_lidar else ["-DPB_BUFFER_ONLY"]
        sources = tuple(runtime / f"pb_{name}.c" for name in ("common", "encode", "decode"))
        header = HERE / "subjects" / f"use_nanopb_{protocol.name}.h"
        folders = (runtime, HERE / "nanopb")
        return Subject("nanopb", protocol, header, folders, sources, tuple(flags))

    def _dialect(self, protocol: Protocol) -> Path:
        """A dialect's definition; the one of all messages is made of the others."""
        folder = HERE / "mavlink"
        if protocol is not TOGETHER:
            return folder / f"{protocol.name}.xml"
        trees = [ElementTree.parse(folder / f"{item.name}.xml").getroot() for item in PROTOCOLS]
        whole = trees[0].find("messages")
        assert whole is not None
        whole.extend(message for tree in trees[1:] for message in tree.iter("message"))
        for number, message in enumerate(whole, 1):
            message.set("id", str(number))
        found = self.folder / f"{protocol.name}.xml"
        ElementTree.ElementTree(trees[0]).write(found)
        return found

    def _mavlink(self, protocol: Protocol) -> Subject:
        output = self.folder / "mavlink" / protocol.name
        definition = self._dialect(protocol)
        command = [sys.executable, "-m", "pymavlink.tools.mavgen", "--lang=C"]
        run([*command, "--wire-protocol=2.0", "-o", str(output), str(definition)])
        header = HERE / "subjects" / f"use_mavlink_{protocol.name}.h"
        return Subject("mavlink", protocol, header, (output, HERE / "subjects"), ())

    def build(
        self, toolchain: Toolchain, harness: str, subject: Subject, *more: str | Path
    ) -> Path:
        """Compile and link a harness with a subject."""
        self._built += 1
        program = self.folder / f"program{self._built}"
        folders = [f"-I{folder}" for folder in (HERE / "harness", *subject.folders)]
        command = [
            *(toolchain.compiler, *toolchain.flags, *subject.flags, *folders, *map(str, more)),
            f'-DSUBJECT="{subject.header}"',
            f"-DBENCH_MESSAGE_SIZE={subject.protocol.memory}",
            str(HERE / "harness" / f"{harness}.c"),
            *map(str, subject.sources),
            *("-o", str(program)),
        ]
        run(command)
        return program


NANOPB = "grpc@1.15.0"
"""An npm package that carries nanopb's C sources; nanopb's own on PyPI has none."""


@cache
def nanopb() -> Path | None:
    """The folder of nanopb's C sources; None where they can't be fetched."""
    folder = CACHE / "nanopb"
    if not (folder / "pb.h").exists():
        folder.mkdir(parents=True, exist_ok=True)
        command = ["npm", "pack", "--silent", NANOPB, "--pack-destination", str(folder)]
        try:
            subprocess.run(command, capture_output=True, check=True)
        except (OSError, subprocess.CalledProcessError):
            say(f"nanopb is left out: {' '.join(command)} failed")
            return None
        _unpack_nanopb(next(folder.glob("grpc-*.tgz")), folder)
    return folder


def _unpack_nanopb(archive: Path, folder: Path) -> None:
    with tarfile.open(archive) as members:
        for member in sorted(members, key=lambda item: item.name):
            place = re.fullmatch(r".*/third_party/nanopb/(pb\w*\.[ch]|LICENSE.txt)", member.name)
            data = members.extractfile(member) if place else None
            if place and data:
                (folder / place[1]).write_bytes(data.read())
    archive.unlink()


def nanopb_version() -> str:
    """As its header has it."""
    folder = nanopb()
    text = (folder / "pb.h").read_text(encoding="utf-8") if folder else ""
    found = re.search(r"NANOPB_VERSION nanopb-(\S+)", text)
    return found[1] if found else "missing"


def run(command: Sequence[str], data: bytes | None = None) -> str:
    """Run a program and return what it prints; end with what it says if it fails."""
    environment = {**os.environ, "PYTHONPATH": str(ROOT)}
    done = subprocess.run(command, input=data, capture_output=True, env=environment, check=False)
    if done.returncode != 0:
        said = (done.stdout + done.stderr).decode()
        raise SystemExit(f"{' '.join(command)} failed:\n{said[:3000]}")
    return done.stdout.decode()


@dataclass(frozen=True)
class Toolchain:
    """A compiler with its flags, and the tools that go with it."""

    title: str
    prefix: str
    flags: tuple[str, ...]
    compiler_name: str = "gcc"

    @property
    def compiler(self) -> str:
        return self.prefix + self.compiler_name

    def version(self) -> str:
        return run([self.compiler, "--version"]).splitlines()[0]


_SMALL = ("-std=gnu99", "-w", "-Os", "-flto", "-ffunction-sections", "-fdata-sections")
_LINK = ("-Wl,--gc-sections",)
_APART = ("-fno-inline-functions-called-once", "-fno-inline-small-functions", "-fno-ipa-sra")
AVR = Toolchain("ATmega328P", "avr-", ("-mmcu=atmega328p", *_SMALL, *_LINK))
AVR_APART = Toolchain(
    "ATmega328P", "avr-", (*(flag for flag in AVR.flags if flag != "-flto"), *_APART)
)
ARM = Toolchain(
    "Cortex-M0",
    "arm-none-eabi-",
    (
        *("-mcpu=cortex-m0", "-mthumb", *_SMALL, *_LINK, "-nostartfiles", "-specs=nano.specs"),
        f"-Wl,-T,{HERE / 'harness' / 'cortex_m0.ld'}",
    ),
)
HOST = Toolchain("host", "", ("-std=gnu99", "-w", "-O2"), "cc")


# --- flash and RAM --------------------------------------------------------------------------------


@dataclass(frozen=True)
class Memory:
    """Memory that a linked program takes, less an empty one."""

    flash: int
    ram: int


def memory(workshop: Workshop, toolchain: Toolchain, subject: Subject) -> Memory:
    program = workshop.build(toolchain, "size", subject)
    empty = workshop.build(toolchain, "size", nothing(subject.protocol))
    whole, base = _size(toolchain, program), _size(toolchain, empty)
    return Memory(whole.flash - base.flash, whole.ram - base.ram)


def nothing(protocol: Protocol) -> Subject:
    return Subject("empty", protocol, HERE / "subjects" / "use_empty.h", (), ())


def _size(toolchain: Toolchain, program: Path) -> Memory:
    said = run([f"{toolchain.prefix}size", str(program)])
    text, data, bss = map(int, said.splitlines()[1].split()[:3])
    return Memory(text + data, data + bss)


def spenders(workshop: Workshop, subject: Subject, most: int = 14) -> list[tuple[str, int]]:
    """The largest functions and constants, with nothing inlined."""
    program = workshop.build(AVR_APART, "size", subject)
    said = run([f"{AVR_APART.prefix}nm", "-S", "--size-sort", "--reverse-sort", str(program)])
    rows = [line.split() for line in said.splitlines()]
    return [(row[3], int(row[1], 16)) for row in rows if row[2] in "tTwWrR"][:most]


# --- cycles ---------------------------------------------------------------------------------------


@dataclass
class Cycles:
    """Of one message in simavr."""

    bytes: float
    decode: float
    """Not a number where a frame was not decoded."""
    encode: float


def cycles(workshop: Workshop, counter: Path, subject: Subject) -> list[Cycles]:
    """Decode and encode frames of each message on an ATmega328P."""
    host = workshop.build(HOST, "host", subject)
    return [
        _cycles_of(workshop, counter, subject, which, _frames(host, which))
        for which in range(len(subject.protocol.messages))
    ]


def _frames(host: Path, which: int) -> list[bytes]:
    lines = run([str(host), "frames", str(which), str(FRAMES)]).split()
    return [bytes.fromhex(line) for line in lines]


def _cycles_of(
    workshop: Workshop, counter: Path, subject: Subject, which: int, frames: list[bytes]
) -> Cycles:
    folder = Path(tempfile.mkdtemp(dir=workshop.folder))
    (folder / "frames.h").write_text(_table(which, frames), encoding="utf-8")
    program = workshop.build(AVR, "cycles", subject, f"-I{folder}")
    spans, said = _spans(run([str(counter), str(program)]))
    sizes = [len(frame) for frame in frames]
    heard = list(zip(*[iter(said)] * 3, strict=True))
    made = [low | high << 8 for _, low, high in heard]
    # MAVLink cuts zeros off at the end, which nobody counts where it sends byte by byte.
    if not all(made) if subject.kind == "mavlink" else made != sizes:
        raise SystemExit(f"{subject.kind} {subject.protocol.name} {which} on AVR: {heard}, {sizes}")
    if any(seen != 1 for seen, _, _ in heard):
        return Cycles(median(sizes), nan, median(spans[3]))
    # The first decode only wakes the decoder up. A payload without a frame is handed over at once.
    loop = 0 if subject.kind == "nanopb" else _loop(sizes)
    return Cycles(median(sizes), median(spans[1][1:]) - loop, median(spans[3]))


def _loop(sizes: Sequence[int]) -> float:
    """Cycles of the harness's own loop: `lpm`, increment, compare and branch for each byte."""
    return 7 * median(sizes)


def cycles_apart(workshop: Workshop, counter: Path, subject: Subject) -> list[tuple[str, float]]:
    """Cycles for one byte in each function, while frames of the first message are decoded."""
    frames = _frames(workshop.build(HOST, "host", subject), 0)
    folder = Path(tempfile.mkdtemp(dir=workshop.folder))
    (folder / "frames.h").write_text(_table(0, frames), encoding="utf-8")
    program = workshop.build(AVR_APART, "cycles", subject, f"-I{folder}")
    said = run([f"{AVR_APART.prefix}nm", "-S", "--defined-only", str(program)])
    rows = [line.split() for line in said.splitlines()]
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


def _spans(text: str) -> tuple[dict[int, list[int]], list[int]]:
    """Cycles between the marks 1 and 2, and 3 and 4; and the bytes that were said."""
    spans: dict[int, list[int]] = {1: [], 3: []}
    said: list[int] = []
    begin = 0
    for words in map(str.split, text.splitlines()):
        match words:
            case ["say", byte]:
                said.append(int(byte))
            case ["mark", ("1" | "3"), cycle]:
                begin = int(cycle)
            case ["mark", ("2" | "4") as mark, cycle]:
                spans[int(mark) - 1].append(int(cycle) - begin)
    return spans, said


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


# --- speed on this machine ------------------------------------------------------------------------


@dataclass
class Speed:
    """Of one message on this machine, in ns for one frame: one number for each round."""

    bytes: float = 0
    push: list[float] = field(default_factory=list)
    feed: list[float] = field(default_factory=list)
    encode: list[float] = field(default_factory=list)


BYTES_OF_A_ROUND = 20_000_000


def speeds(
    programs: dict[str, Path], protocol: Protocol, which: int, rounds: int
) -> dict[str, Speed]:
    """Time every kind in turn, so that a busy machine slows down all of them alike."""
    found = {kind: Speed() for kind in programs}
    for _ in range(rounds):
        for kind, program in programs.items():
            # A lidar turn is 90 times as long as a gyro's frame.
            count = 8 if protocol.messages[which] == "lidar" else protocol.timed
            words = ["time", str(which), str(count), str(BYTES_OF_A_ROUND)]
            bytes_, push, feed, encode = map(float, run([str(program), *words]).split())
            speed = found[kind]
            speed.bytes = bytes_
            speed.push.append(push)
            speed.feed.append(feed)
            speed.encode.append(encode)
    return found


# --- noisy streams --------------------------------------------------------------------------------

PIECES = (1 << 20, 1, 17, 1000)
"""Sizes in which streams are fed; the first of them is the whole stream."""


def same_messages(programs: Mapping[str, Path], protocol: Protocol, seeds: int) -> None:
    """Nobody has to be fast with other messages than the expert's, of a clean or a noisy stream."""
    frames = [
        frame
        for which in range(len(protocol.messages))
        for frame in _frames(programs["expert"], which)
    ]
    material = corpus.Material(tuple(frames), protocol.marks)
    for seed in range(seeds):
        dice = Random(f"{protocol.name} {seed} same")
        clean = b"".join(dice.choice(frames) for _ in range(100))
        for data in (clean, corpus.stream_of(material, dice, 100).data):
            expected = run([str(programs["expert"]), "messages", "0"], data)
            for kind, program in programs.items():
                for piece in PIECES:
                    found = run([str(program), "messages", str(piece)], data)
                    if found != expected:
                        raise SystemExit(f"{kind} {protocol.name} {seed} {piece}: other messages")


@dataclass
class Recovery:
    undamaged: int = 0
    found: int = 0

    @property
    def share(self) -> str:
        """Never rounded up to all."""
        if self.found == self.undamaged:
            return "100 %"
        return f"{int(self.found / self.undamaged * 10_000) / 100:.2f} %"


def recovery(program: Path, subject: Subject, seeds: int) -> Recovery:
    """Count the undamaged frames behind whose last byte a message was delivered."""
    frames: list[bytes] = []
    for which in range(len(subject.protocol.messages)):
        frames += _recovered_frames(program, subject, which)
    material = corpus.Material(tuple(frames), subject.protocol.marks + b"\xfd\xfe")
    figures = Recovery()
    for seed in range(seeds):
        stream = corpus.stream_of(material, Random(f"{subject.protocol.name} {seed}"), 100)
        silence = b"\xaa" * 300
        said = run([str(program), "stream"], stream.data + silence)
        ends = {int(line.split()[0]) for line in said.splitlines()}
        figures.undamaged += len(stream.frames)
        figures.found += sum(at + len(frame) in ends for at, frame in stream.frames)
    return figures


def _recovered_frames(program: Path, subject: Subject, which: int) -> list[bytes]:
    """Frames of a message; MAVLink's lidar goes out in four, which are no message by themselves."""
    if subject.kind == "mavlink" and subject.protocol.messages[which] == "lidar":
        return []
    lines = run([str(program), "frames", str(which), "40"]).split()
    return [bytes.fromhex(line) for line in lines]


# --- everything -----------------------------------------------------------------------------------


@dataclass
class Results:
    """Measurements, by kind and protocol."""

    avr: dict[tuple[str, str], Memory] = field(default_factory=dict)
    arm: dict[tuple[str, str], Memory] = field(default_factory=dict)
    cycles: dict[tuple[str, str], list[Cycles]] = field(default_factory=dict)
    speeds: dict[tuple[str, str], Speed] = field(default_factory=dict)
    """By kind, and protocol and message."""
    recovery: dict[tuple[str, str], Recovery] = field(default_factory=dict)
    spenders: dict[tuple[str, str], list[tuple[str, int]]] = field(default_factory=dict)
    cycle_spenders: dict[tuple[str, str], list[tuple[str, float]]] = field(default_factory=dict)


def measure(workshop: Workshop, rounds: int, seeds: int) -> Results:
    results = Results()
    counter = build_counter(workshop)
    kinds = [kind for kind in SMALL_KINDS if kind != "nanopb" or nanopb() is not None]
    parts: dict[str, list[Subject]] = {kind: [] for kind in kinds}
    for protocol in PROTOCOLS:
        small = {kind: workshop.subject(kind, protocol) for kind in kinds}
        same_bytes(workshop, small)
        for kind, subject in small.items():
            say(f"{protocol.name}: {kind}")
            parts[kind].append(subject)
            key = kind, protocol.name
            results.avr[key] = memory(workshop, AVR, subject)
            results.arm[key] = memory(workshop, ARM, subject)
            results.cycles[key] = cycles(workshop, counter, subject)
            if kind in _OPENED:
                results.spenders[key] = spenders(workshop, subject)
                results.cycle_spenders[key] = cycles_apart(workshop, counter, subject)
        subjects = {kind: small[kind] for kind in KINDS}
        if HAS_SSE2:
            subjects["sse2"] = workshop.subject("sse2", protocol)
            own = small["messages"]
            vector = f"-D{protocol.name.upper()}_SSE2=1"
            subjects["vector"] = replace(own, kind="vector", flags=(*own.flags, vector))
        programs = {kind: workshop.build(HOST, "host", item) for kind, item in subjects.items()}
        say(f"{protocol.name}: the same messages")
        alike = {kind: program for kind, program in programs.items() if kind != "mavlink"}
        same_messages(alike, protocol, seeds)
        for which, message in enumerate(protocol.messages):
            say(f"{protocol.name} {message}: timing")
            for kind, speed in speeds(programs, protocol, which, rounds).items():
                results.speeds[kind, f"{protocol.label} {message}"] = speed
        for kind in KINDS:
            results.recovery[kind, protocol.name] = recovery(programs[kind], small[kind], seeds)
    for kind, items in parts.items():
        say(f"{TOGETHER.name}: {kind}")
        subject = workshop.together(kind, items)
        results.avr[kind, TOGETHER.name] = memory(workshop, AVR, subject)
        results.arm[kind, TOGETHER.name] = memory(workshop, ARM, subject)
    return results


def say(text: str) -> None:
    print(text, file=sys.stderr)


def build_counter(workshop: Workshop) -> Path:
    program = workshop.folder / "counter"
    source = HERE / "harness" / "counter.c"
    run(["cc", "-O2", "-o", str(program), str(source), "-lsimavr", "-lelf"])
    return program


def same_bytes(workshop: Workshop, subjects: dict[str, Subject]) -> None:
    """The expert's frames have to be protogen's, or nothing is worth comparing."""
    made = []
    for kind in ("messages", "all", "expert"):
        host = workshop.build(HOST, "host", subjects[kind])
        count = len(subjects[kind].protocol.messages)
        made.append([_frames(host, which) for which in range(count)])
    if made[0] != made[1] or made[0] != made[2]:
        raise SystemExit(f"other bytes in {subjects['expert'].protocol.name}")


# --- the page -------------------------------------------------------------------------------------


def page(results: Results, rounds: int, seeds: int) -> str:
    return PAGE.format(
        nanopb=nanopb_version(),
        carrier=f"`{NANOPB}`",
        rounds=rounds,
        fed=FED,
        seeds=seeds,
        versions=versions(),
        avr=memory_table(results.avr),
        arm=memory_table(results.arm),
        cycles=cycles_table(results),
        push=speed_table(results, "push"),
        feed=feed_table(results),
        encode=speed_table(results, "encode"),
        recovery=recovery_table(results),
        misses=misses(results),
        flash_spenders=spenders_text(results.spenders, ",.0f"),
        cycle_spenders=spenders_text(results.cycle_spenders, ".1f"),
        frames=FRAMES,
        target=TARGET,
        pieces=100,
    )


PAGE = """\
# What generated C costs

<!-- Written by benchmarks/bench_c.py, do not edit. -->

Made by `python benchmarks/bench_c.py --rounds {rounds} --seeds {seeds}`.

{versions}

These programs send and receive the same messages:

* protogen with `--only` these messages, once with `--events messages` and once with all events.
* The expert is C by hand in [c/expert](c/expert/expert_atrv.c), specialised to these messages, with
  the same checks: no heap, bounded, ranges checked before anything is written, resynchronisation.
  Its frames are compared with protogen's, byte for byte, before anything is measured. It returns
  from `push` which message is complete, and needs no handler. Nor do protogen's decoders of these
  frames with `--events messages`, which are measured with their own interface: `push` and `feed`
  return what is complete. With all events, a handler is called.
* MAVLink C is mavgen's, version 2 of the wire, from the dialects in [c/mavlink](c/mavlink/rn1.xml),
  with `MAVLINK_MAX_PAYLOAD_LEN` as small as the messages allow and one channel. It has other bytes
  on the wire: 12 more for each frame. A lidar turn does not fit its payload and goes out in four.
* nanopb {nanopb}, of 2016, as the npm package {carrier} carries it: nanopb's own packages
  on PyPI have no C sources (0.3.9.8, 0.4.0, 0.4.7 and 0.4.9.1 were looked at). Its messages are in
  [c/nanopb](c/nanopb/messages.proto), the tables by hand as its generator makes them. It frames
  nothing: a payload is handed over with the number of its message. No start, length, checksum or
  resynchronisation is in its figures, nor the buffer for a frame.
* The expert with SSE2 takes messages out of whole buffers, 16 bytes at a time: delimiters by
  `movemask`, runs between escapes as they are, checksums and numbers in vectors. Out of clean and
  noisy streams, whole and in pieces of 1, 17 and 1,000 bytes, it takes the very messages that the
  expert takes byte by byte, and so do both programs of protogen; that is tried before the timings.

rflex's sonar_data has room for the 17 sonars of an ATRV-Jr here ([c/atrv.yaml](c/atrv.yaml)), in
every program. The aim is {target} times the expert's at most, with `--events messages`.

## Flash and RAM

Bytes of a linked program that decodes and encodes, with decoder and framing, less an empty one:
`-Os -flto -ffunction-sections -fdata-sections`, `--gc-sections`. RAM is what stands there all the
time (`.data` and `.bss`): the decoder, with all events also the addresses of handler and user.
Messages belong to the application and are not counted. The lidar is sent byte by byte on these
machines. All five are one program with three links: protogen and the expert have a decoder for each
protocol, MAVLink one dialect with three channels.

### ATmega328P

{avr}

### Cortex-M0

{arm}

## Cycles on an ATmega328P

The programs above in simavr: pushing all bytes of a frame and decoding its message into a struct,
less the harness's loop, and encoding it again. Medians of {frames} frames of random values. At
1 Mbaud and 16 MHz there are 160 cycles for each byte. nanopb decodes a payload that lies in memory,
of other bytes than a frame's; bytes are those of protogen's frame.

{cycles}

## This machine

`-O2`, one core, a clean stream of frames of random values, messages decoded into a struct. Medians
of {rounds} rounds; in each round every program has its turn. The ratio is that of `--events
messages` to the expert, in time: less is faster. It is the median of the rounds' ratios, which need
not be the ratio of the medians.

### push, byte by byte

{push}

### feed, a whole buffer

The aim for protogen is {fed:,} MB/s and half the speed of the expert with SSE2: the second ratio is
the time of protogen with `NAME_SSE2`, which is `--events messages` too, to twice that expert's.

{feed}

### Encoding a frame

{encode}

## Frames found in noisy streams

{seeds} streams of {pieces} pieces as in [resync.md](resync.md): frames, damaged frames and noise.
Found are undamaged frames behind whose last byte the message was delivered. MAVLink C of rn1 has
gyro frames only.

{recovery}

## Where the aim is missed

{misses}

## What the flash is spent on

The largest functions on the ATmega328P by `avr-nm`, in bytes, without link-time optimisation and
with nothing inlined, so that each function shows. They add up to more than the table above.

{flash_spenders}

## What the cycles are spent on

Cycles for one byte in each function of the same programs while frames of the first message are
decoded, in simavr. Calls cost more here than above, where they are inlined.

{cycle_spenders}
"""


def versions() -> str:
    names = (AVR.version(), ARM.version(), HOST.version())
    return (
        f"protogen {VERSION}, pymavlink {version('pymavlink')} on Python "
        f"{platform.python_version()}; {', '.join(names)}. {os.cpu_count()} CPUs."
    )


def row(cells: Iterable[object]) -> str:
    return f"| {' | '.join(map(str, cells))} |"


def header(*cells: str) -> list[str]:
    return [row(cells), row("---" if index == 0 else "---:" for index in range(len(cells)))]


NOTHING = "-"
"""Mark for what was not measured."""


def ratio(own: float, other: float) -> str:
    return f"{own / other:.2f}" if other else NOTHING


def memory_table(found: dict[tuple[str, str], Memory]) -> str:
    lines = header("flash / RAM", *SMALL_KINDS.values(), "ratio to expert")
    for protocol in (*PROTOCOLS, TOGETHER):
        own, expert = found["messages", protocol.name], found["expert", protocol.name]
        cells = [_memory(found.get((kind, protocol.name))) for kind in SMALL_KINDS]
        last = f"{ratio(own.flash, expert.flash)} / {ratio(own.ram, expert.ram)}"
        lines.append(row([protocol.title, *cells, last]))
    return "\n".join(lines)


def _memory(item: Memory | None) -> str:
    return f"{item.flash:,} / {item.ram:,}" if item else NOTHING


def messages() -> Iterator[tuple[Protocol, int, str]]:
    for protocol in PROTOCOLS:
        for which, message in enumerate(protocol.messages):
            yield protocol, which, message


def cycles_table(results: Results) -> str:
    lines = header(
        "decode / encode", "bytes", *SMALL_KINDS.values(), "ratio to expert", "decode, per byte"
    )
    for protocol, which, message in messages():
        found = {
            kind: results.cycles[kind, protocol.name][which]
            for kind in SMALL_KINDS
            if (kind, protocol.name) in results.cycles
        }
        own, expert = found["messages"], found["expert"]
        cells = [f"{_cycles(item.decode)} / {item.encode:,.0f}" for item in found.values()]
        cells += [NOTHING] * (len(SMALL_KINDS) - len(found))
        ratios = f"{ratio(own.decode, expert.decode)} / {ratio(own.encode, expert.encode)}"
        per_byte = ", ".join(_cycles(item.decode / item.bytes) for item in found.values())
        title = f"{protocol.label} {message}"
        lines.append(row([title, f"{own.bytes:.0f}", *cells, ratios, per_byte]))
    return "\n".join(lines)


def _cycles(value: float) -> str:
    return "fails" if isnan(value) else f"{value:,.0f}"


def speed_table(results: Results, what: str) -> str:
    lines = header("ns per frame (MB/s)", "bytes", *KINDS.values(), "ratio to expert")
    for protocol, _, message in messages():
        name = f"{protocol.label} {message}"
        found = {kind: results.speeds[kind, name] for kind in KINDS}
        cells = [_speed(item, getattr(item, what)) for item in found.values()]
        bytes_ = f"{found['messages'].bytes:.1f}"
        lines.append(row([name, bytes_, *cells, f"{_time_ratio(results, name, what):.2f}"]))
    return "\n".join(lines)


def feed_table(results: Results) -> str:
    last = ("ratio to expert", "to half the speed of SSE2")
    lines = header("ns per frame (MB/s)", "bytes", *FED_KINDS.values(), *last)
    for protocol, _, message in messages():
        name = f"{protocol.label} {message}"
        found = [results.speeds.get((kind, name)) for kind in FED_KINDS]
        cells = [_speed(item, item.feed) if item else NOTHING for item in found]
        half = f"{_half_ratio(results, name):.2f}" if HAS_SSE2 else NOTHING
        bytes_ = f"{results.speeds['messages', name].bytes:.1f}"
        ratios = f"{_time_ratio(results, name, 'feed'):.2f}", half
        lines.append(row([name, bytes_, *cells, *ratios]))
    return "\n".join(lines)


def _half_ratio(results: Results, name: str) -> float:
    """The median of the rounds' ratios of protogen's time to twice the expert's, both with SSE2."""
    own, other = results.speeds["vector", name].feed, results.speeds["sse2", name].feed
    return median(mine / (SHARE * theirs) for mine, theirs in zip(own, other, strict=True))


def _speed(item: Speed, rounds: list[float]) -> str:
    time = median(rounds)
    return f"{time:,.1f} ({item.bytes / time * 1000:,.0f})"


def _time_ratio(results: Results, name: str, what: str) -> float:
    """The median of the rounds' ratios."""
    own: list[float] = getattr(results.speeds["messages", name], what)
    expert: list[float] = getattr(results.speeds["expert", name], what)
    return median(mine / theirs for mine, theirs in zip(own, expert, strict=True))


def recovery_table(results: Results) -> str:
    lines = header("found of undamaged", *KINDS.values())
    for protocol in PROTOCOLS:
        found = [results.recovery[kind, protocol.name] for kind in KINDS]
        cells = [f"{item.found:,} of {item.undamaged:,}: {item.share}" for item in found]
        lines.append(row([protocol.title, *cells]))
    return "\n".join(lines)


def misses(results: Results) -> str:
    found = sorted(_ratios(results), key=lambda item: (not isnan(item[1]), -item[1]))
    missed = [f"* {name}: {value:.2f}" for name, value in found if not value <= TARGET]
    met = sum(value <= TARGET for _, value in found)
    lines = [f"All {met} figures are within {TARGET}."]
    if missed:
        lines = [f"{met} of {len(found)} figures are within {TARGET}. The others:", "", *missed]
    if HAS_SSE2:
        halves = [_half_ratio(results, f"{p.label} {message}") for p, _, message in messages()]
        fast = sum(value <= 1 for value in halves)
        half = f"{fast} of {len(halves)} messages are fed at half the speed of the expert with SSE2"
        vectors = [item for (kind, _), item in results.speeds.items() if kind == "vector"]
        quick = sum(item.bytes / median(item.feed) * 1000 >= FED for item in vectors)
        lines += ["", f"{half} or faster, and {quick} at {FED:,} MB/s."]
    return "\n".join(lines)


def _ratios(results: Results) -> Iterator[tuple[str, float]]:
    for title, found in (("ATmega328P", results.avr), ("Cortex-M0", results.arm)):
        for protocol in (*PROTOCOLS, TOGETHER):
            own, expert = found["messages", protocol.name], found["expert", protocol.name]
            yield f"{title}, flash, {protocol.title}", own.flash / expert.flash
            yield f"{title}, RAM, {protocol.title}", own.ram / expert.ram
    for protocol, which, message in messages():
        own_cycles = results.cycles["messages", protocol.name][which]
        expert_cycles = results.cycles["expert", protocol.name][which]
        name = f"{protocol.label} {message}"
        yield f"cycles of decoding, {name}", own_cycles.decode / expert_cycles.decode
        yield f"cycles of encoding, {name}", own_cycles.encode / expert_cycles.encode
        for what in ("push", "feed", "encode"):
            yield f"this machine, {what}, {name}", _time_ratio(results, name, what)


_OPENED = ("messages", "expert")
"""Whose functions are listed one by one."""


def spenders_text(found: Mapping[tuple[str, str], Sequence[tuple[str, float]]], form: str) -> str:
    lines = []
    for protocol in PROTOCOLS:
        lines += [f"* {protocol.title}"]
        for kind in _OPENED:
            items = [f"`{name}` {size:{form}}" for name, size in found[kind, protocol.name]]
            lines += [f"  * {KINDS[kind]}: {', '.join(items)}"]
    return "\n".join(lines)


def missing_tools() -> list[str]:
    checks: list[tuple[str, Callable[[], bool]]] = [
        *((tool, lambda tool=tool: shutil.which(tool) is not None) for tool in _TOOLS),
        ("pymavlink", lambda: find_spec("pymavlink") is not None),
        ("libsimavr-dev", lambda: Path("/usr/include/simavr/sim_avr.h").exists()),
    ]
    return [name for name, is_there in checks if not is_there()]


_TOOLS = ("avr-gcc", "arm-none-eabi-gcc", "cc")


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--rounds", type=int, default=9, help="rounds of the timings")
    parser.add_argument("--seeds", type=int, default=100, help="noisy streams of each protocol")
    parser.add_argument("--output", type=Path, default=OUT, help="the page")
    arguments = parser.parse_args()
    missing = missing_tools()
    if missing:
        sys.exit(f"not there: {', '.join(missing)}")
    with tempfile.TemporaryDirectory(prefix="protogen-bench-") as folder:
        results = measure(Workshop(Path(folder)), arguments.rounds, arguments.seeds)
    text = page(results, arguments.rounds, arguments.seeds)
    arguments.output.write_text(text, encoding="utf-8")


if __name__ == "__main__":
    main()
