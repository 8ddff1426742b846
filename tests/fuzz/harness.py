"""Fuzzers for generated decoders: one program for each protocol, with frames to start from.

    .venv/bin/python tests/fuzz/harness.py --runs 1050000 schemas/*.yaml

prints how many inputs each one has tried, and what of the generated code they have reached.
"""

from __future__ import annotations

import argparse
import re
import shutil
import subprocess
import sys
from dataclasses import dataclass
from pathlib import Path
from random import Random
from tempfile import TemporaryDirectory
from time import monotonic

if __name__ == "__main__":
    sys.path.insert(0, str(Path(__file__).resolve().parent.parent))

from c_proof.generated import generate
from compiled import protocol_of
from corpus import material_of, stream_of
from tooling import require_compiler, require_tool

from fuzz.corpora import unpack
from protogen.model.protocol import Protocol
from protogen.targets.c.options import EVENTS, COptions, Events

HERE = Path(__file__).resolve().parent
SANITIZERS = "-fsanitize=fuzzer,address,undefined"
SEEDS = 30
_PUSH = re.compile(r"(void|enum \w+) (\w+)_decoder_push\(")
"""A decoder that is polled returns which message is complete."""
_DONE = re.compile(r"stat::number_of_executed_units: +(\d+)")

_HEAD = """#include <stdint.h>
#include <stdlib.h>
#include <string.h>
#include "{name}.h"

#define JOIN_(a, b) a##b
#define JOIN(a, b) JOIN_(a, b)
#define ALL_EVENTS {all_events:d}
#define NO_MESSAGE {upper}_NO_MESSAGE
#define REQUIRE(fact) do {{ if (!(fact)) {{ abort(); }} }} while (0)
"""
_INCLUDE = """
#define PREFIX {prefix}
#define POLLS {polls:d}
#include "{harness}"
#undef PREFIX
#undef POLLS
"""
_ENTRY = """
int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {{
    static void (*const runs[])(const uint8_t *, size_t, uint8_t, uint8_t) = {{{runs}}};
    if (size >= 2) {{
        const size_t sender = data[0] % {count}u;
        runs[sender](data + 2, size - 2, (uint8_t)(data[0] / {count}u), data[1]);
    }}
    return 0;
}}
"""


def harness_of(name: str, header: str) -> str:
    """The source of a fuzzer that knows every decoder of the header."""
    pushes = _PUSH.findall(header)
    includes = [
        _INCLUDE.format(prefix=prefix, polls=result != "void", harness=HERE / "harness.c")
        for result, prefix in pushes
    ]
    runs = ", ".join(f"{prefix}_run" for _, prefix in pushes)
    entry = _ENTRY.format(runs=runs, count=len(pushes))
    all_events = "_event_kind kind;" in header
    head = _HEAD.format(name=name, upper=name.upper(), all_events=all_events)
    return "".join([head, *includes, entry])


@dataclass(frozen=True)
class Fuzzer:
    """A program that tries inputs."""

    program: Path
    corpus: Path
    longest: int

    def run(self, *options: str) -> str:
        """Try inputs; returns what it prints. Raises AssertionError where one fails."""
        # No input takes longer than a millisecond, but the machine may be busy.
        limits = (f"-max_len={self.longest}", "-timeout=120", "-print_final_stats=1")
        command = [str(self.program), *limits, *options, str(self.corpus)]
        done = subprocess.run(
            command, capture_output=True, text=True, check=False, cwd=self.program.parent
        )
        assert done.returncode == 0, done.stderr[-6000:]
        return done.stderr


def build(
    protocol: Protocol, seeds: Path, folder: Path, *flags: str, events: Events = "all"
) -> Fuzzer:
    """Compile the fuzzer of a protocol.

    Its corpus begins with streams of the schema at `seeds`, and with what was kept for that.
    """
    made = generate(protocol, folder, COptions(events=events))
    fuzzer = build_from(made.header, protocol, seeds, *flags)
    unpack(seeds, fuzzer.corpus)
    return fuzzer


_ANY = (
    "#include <stddef.h>\n#include <stdint.h>\n"
    "int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);\n"
    "int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)\n"
    "{ (void)data; (void)size; return 0; }\n"
)


def require_fuzzer() -> str:
    """Path of a clang that has libFuzzer and its sanitizers; without it, skip the test or fail."""
    return require_compiler("clang", SANITIZERS, source=_ANY, arguments=("-runs=0",))


def build_from(header: Path, protocol: Protocol, seeds: Path, *flags: str) -> Fuzzer:
    """Compile the fuzzer of the generated C beside a header."""
    clang = require_fuzzer()
    folder = header.parent
    program, source = folder / "fuzzer", folder / "fuzzer.c"
    text = harness_of(protocol.name, header.read_text(encoding="utf-8"))
    source.write_text(text, encoding="utf-8")
    generated = folder / f"{protocol.name}.c"
    options = ["-std=c99", "-O1", "-g", SANITIZERS, "-fno-sanitize-recover=all", *flags]
    command = [clang, *options, f"-I{folder}", "-o", str(program), str(source), str(generated)]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    corpus = folder / "corpus"
    corpus.mkdir()
    longest = 0
    for index, sender in enumerate(protocol.senders):
        longest = max(longest, sender.framing.greatest)
        for number in range(SEEDS):
            dice = Random(f"{sender.name} {number}")
            stream = stream_of(material_of(seeds, sender.name), dice, 1 + number % 4).data
            first = bytes([dice.randrange(256 // 8) * len(protocol.senders) + index, number % 3])
            (corpus / f"{sender.name}_{number}").write_bytes(first + stream)
    return Fuzzer(program, corpus, 2 * longest + 64)


def executions(said: str) -> int:
    """Number of inputs that were tried."""
    found = _DONE.findall(said)
    assert found, said[-2000:]
    return sum(map(int, found))


def main() -> None:
    """Fuzz the schemas that are named, and print a table."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("schemas", nargs="+", type=Path)
    parser.add_argument("--runs", type=int, default=1_050_000)
    parser.add_argument("--flag", action="append", default=[], help="for the compiler")
    given = parser.parse_args()
    tell("| protocol | events | inputs | seconds | lines of the decoder reached | branches |")
    tell("| --- | --- | ---: | ---: | ---: | ---: |")
    for path, events in ((path, events) for path in given.schemas for events in EVENTS):
        with TemporaryDirectory(prefix="protogen-fuzz-") as folder:
            protocol = protocol_of(path.resolve())
            fuzzer = build(protocol, path.resolve(), Path(folder), *given.flag, events=events)
            before = monotonic()
            said = fuzzer.run(f"-runs={given.runs}", "-seed=1", "-rss_limit_mb=4096")
            seconds = monotonic() - before
            lines, branches = coverage(protocol, fuzzer)
            count = f"{executions(said):,}"
            tell(f"| {path.stem} | {events} | {count} | {seconds:.0f} | {lines} | {branches} |")


def tell(line: str) -> None:
    """Print a line now."""
    sys.stdout.write(f"{line}\n")
    sys.stdout.flush()


_ENCODING = (
    *("_encode", "_room", "_payload", "_stuff", "_wrap", "_write"),
    *("_ends_early", "_send_head", "_send_tail"),
)
_DECODING = ("_check", "_load", "_decode")


def coverage(protocol: Protocol, fuzzer: Fuzzer) -> tuple[str, str]:
    """Share of the decoders' lines and branches that the corpus reaches, in percent."""
    folder = fuzzer.program.parent
    program, raw, merged = folder / "covered", folder / "raw", folder / "merged"
    flags = ["-std=c99", "-O0", "-g", "-fsanitize=fuzzer", "-fprofile-instr-generate"]
    sources = [str(folder / "fuzzer.c"), str(folder / f"{protocol.name}.c")]
    clang = [require_fuzzer(), *flags, "-fcoverage-mapping", f"-I{folder}"]
    subprocess.run([*clang, "-o", str(program), *sources], check=True)
    subprocess.run(
        [str(program), "-runs=0", str(fuzzer.corpus)],
        check=True,
        capture_output=True,
        env={"LLVM_PROFILE_FILE": str(raw)},
    )
    merge = [_llvm("llvm-profdata"), "merge", "-o", str(merged), str(raw)]
    subprocess.run(merge, check=True)
    report = [_llvm("llvm-cov"), "report", f"-instr-profile={merged}", "-show-functions"]
    done = subprocess.run(
        [*report, str(program), sources[1]], check=True, capture_output=True, text=True
    )
    senders = [f"{protocol.name}_{sender.name}_" for sender in protocol.senders]
    decodes = [f"{protocol.name}_{message.name}_" for message in protocol.messages]
    lines = [0, 0]
    branches = [0, 0]
    for row in done.stdout.splitlines():
        name, *cells = row.split() or [""]
        name = name.rpartition(":")[2]
        is_decoder = any(name.startswith(s) for s in senders) and not name.endswith(_ENCODING)
        is_decode = any(name.startswith(d) for d in decodes) and name.endswith(_DECODING)
        if (is_decoder or is_decode) and len(cells) == 9:
            for counted, at in ((lines, 3), (branches, 6)):
                counted[0] += int(cells[at])
                counted[1] += int(cells[at + 1])
    return _share(lines), _share(branches)


def _share(counted: list[int]) -> str:
    whole, missed = counted
    return f"{100 * (whole - missed) / whole:.1f} % of {whole}" if whole else "-"


def _llvm(name: str) -> str:
    """A program of LLVM; Debian puts the version behind its name."""
    names = [name, *(f"{name}-{version}" for version in range(14, 23))]
    return next(filter(None, map(shutil.which, names)), None) or require_tool(name)


if __name__ == "__main__":
    main()
