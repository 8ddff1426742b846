"""Costs of generated TypeScript, beside code by hand, Kaitai Struct and node-mavlink.

    python benchmarks/bench_typescript.py             # writes typescript.md
    python benchmarks/bench_typescript.py --rounds 3  # fewer rounds

Needs node. The first run installs the tools by npm into `.cache/typescript` and `.cache/bench`. A
contender that is not there has empty cells.
"""

from __future__ import annotations

import argparse
import gzip
import json
import platform
import shutil
import subprocess
import sys
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from random import Random
from statistics import median
from tempfile import TemporaryDirectory
from typing import Any

ROOT = Path(__file__).resolve().parent.parent
sys.path[:0] = [str(ROOT), str(ROOT / "benchmarks")]

import bench_generate  # noqa: E402
from peers import cases, timing, typescript_cases  # noqa: E402
from peers.typescript_cases import Message, Mix, mixes, signed  # noqa: E402

from protogen import load  # noqa: E402
from protogen.targets.typescript.emit import emit  # noqa: E402
from protogen.version import VERSION  # noqa: E402

OUT = ROOT / "benchmarks" / "typescript.md"
SCRIPTS = ROOT / "benchmarks" / "peers" / "typescript"
PACKAGE = ROOT / "generated" / "typescript" / "dist"
TOOLS = ROOT / ".cache" / "typescript"
OURS, HAND = "protogen", "by hand"
PORTIONS = (64, 1024)
AIM = 1.3
MAVLINK = ("heartbeat", "attitude", "global_position_int")

Times = Mapping[str, list[float]]
"""Nanoseconds of each contender, in each of the rounds."""


@dataclass
class Measured:
    """Frames, their bytes, and what they took by what was done with them."""

    frames: int
    size: int
    times: Mapping[str, Times]

    def each(self, what: str, name: str) -> float:
        """Nanoseconds for a frame."""
        return median(self.times[what][name]) / self.frames

    def ratio(self, what: str, name: str, other: str) -> float:
        return timing.ratio(self.times[what][name], self.times[what][other])


@dataclass
class Results:
    mixes: dict[str, Measured] = field(default_factory=dict)
    kaitai: dict[str, Measured] = field(default_factory=dict)
    mavlink: Measured | None = None
    sizes: list[tuple[str, ...]] = field(default_factory=list)


# --- running --------------------------------------------------------------------------------------


def run(script: str, request: Mapping[str, Any]) -> Any:
    """What a script of `peers/typescript` answers. Raises CalledProcessError."""
    done = subprocess.run(
        ["node", str(SCRIPTS / script)],
        input=json.dumps(request),
        stdout=subprocess.PIPE,
        text=True,
        check=True,
    )
    return json.loads(done.stdout)


def measured(answer: Mapping[str, Any]) -> Measured:
    return Measured(answer["frames"], answer.get("bytes", 0), answer["results"])


def built(folder: Path) -> Path:
    """The code by hand as JavaScript."""
    tsc = TOOLS / "node_modules" / ".bin" / "tsc"
    subprocess.run([tsc, "-p", SCRIPTS, "--outDir", folder], check=True)
    shutil.copy(SCRIPTS / "package.json", folder)
    return folder


def contenders(mix: Mix, hand: Path) -> Mapping[str, Mapping[str, str]]:
    module = str(PACKAGE / f"{mix.protocol}.js")
    return {
        OURS: {"module": module, "adapter": str(SCRIPTS / "ours.mjs")},
        HAND: {"module": str(hand / f"{mix.protocol}.js")},
    }


def request(mix: Mix, hand: Path, **more: Any) -> dict[str, Any]:
    return {**mix.request(), "portions": PORTIONS, "contenders": contenders(mix, hand), **more}


def install() -> None:
    options = ["npm", "install", "--no-audit", "--no-fund", "--no-package-lock", "--prefix"]
    if not (TOOLS / "node_modules").exists():
        TOOLS.mkdir(parents=True, exist_ok=True)
        shutil.copy(ROOT / "tests" / "typescript" / "package.json", TOOLS)
        subprocess.run([*options, TOOLS], check=True)
    cache = bench_generate.CACHE
    if bench_generate.kaitai() and not (cache / "node_modules" / "kaitai-struct").exists():
        subprocess.run([*options, cache, "kaitai-struct"], check=True)


# --- Kaitai Struct --------------------------------------------------------------------------------

_COMPILE = """\
const fs = require('fs'), yaml = require('js-yaml');
const compiler = require('kaitai-struct-compiler');
const [definition, folder] = process.argv.slice(2);
compiler.compile('javascript', yaml.load(fs.readFileSync(definition, 'utf8')), null, false)
  .then(files => {
    for (const [name, text] of Object.entries(files)) fs.writeFileSync(`${folder}/${name}`, text);
  });
"""


def kaitai(rounds: int) -> Iterator[tuple[str, Measured]]:
    """Payloads of the five messages of `bench_python.py`."""
    cache = bench_generate.CACHE
    folder = cache / "javascript"
    folder.mkdir(exist_ok=True)
    script = cache / "kaitai_javascript.js"
    script.write_text(_COMPILE, encoding="utf-8")
    for case in cases.cases():
        definition = ROOT / "benchmarks" / "peers" / "kaitai" / f"{case.message}.ksy"
        subprocess.run(["node", script, definition, folder], cwd=cache, check=True)
        name = "".join(word.capitalize() for word in case.message.split("_"))
        answer = run(
            "kaitai.mjs",
            {
                "tools": str(script),
                "kaitai": str(folder / f"{name}.js"),
                "class": name,
                "module": str(PACKAGE / f"{case.protocol}.js"),
                "runtime": str(PACKAGE / "runtime" / "index.js"),
                "plan": f"planOf{name}",
                "payloads": [bytes(item.to_payload()).hex() for item in case.messages],
                "rounds": rounds,
            },
        )
        yield case.title, measured(answer)


# --- MAVLink --------------------------------------------------------------------------------------


def mavlink_messages(count: int = 999) -> Iterator[Message]:
    dice = Random("mavlink")
    for index in range(count):
        name = MAVLINK[index % len(MAVLINK)]
        time = {"time_boot_ms": dice.getrandbits(32)}
        if name == "heartbeat":
            fields = ("type", "autopilot", "base_mode", "system_status")
            rest = {field: dice.randrange(1, 9) for field in fields}
            yield {
                "message": name,
                "custom_mode": dice.getrandbits(32),
                **rest,
                "mavlink_version": 3,
            }
        elif name == "attitude":
            fields = ("roll", "pitch", "yaw", "rollspeed", "pitchspeed", "yawspeed")
            yield {
                "message": name,
                **time,
                **{item: dice.randrange(-99, 99) / 8 for item in fields},
            }
        else:
            wide = {item: signed(dice, 32) for item in ("lat", "lon", "alt", "relative_alt")}
            narrow = {item: signed(dice, 16) for item in ("vx", "vy", "vz")}
            yield {"message": name, **time, **wide, **narrow, "hdg": dice.randrange(36000)}


def mavlink(rounds: int, folder: Path) -> Measured:
    for file in emit([load(ROOT / "protogen" / "library" / "mavlink2.yaml")]):
        path = folder / file.path
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_bytes(file.bytes)
    return measured(
        run(
            "mavlink.mjs",
            {
                "tools": str(TOOLS / "package.json"),
                "module": str(folder / "dist" / "mavlink2.js"),
                "senders": {"component": 0},
                "form": "unsigned",
                "messages": list(mavlink_messages()),
                "rounds": rounds,
            },
        )
    )


# --- sizes ----------------------------------------------------------------------------------------


def minified(program: str, folder: Path) -> tuple[int, int]:
    """Bytes of a program with all that it needs, and of the same compressed."""
    entry = folder / "entry.js"
    entry.write_text(program, encoding="utf-8")
    esbuild = TOOLS / "node_modules" / ".bin" / "esbuild"
    command = [esbuild, entry, "--bundle", "--minify", "--format=esm", "--tree-shaking=true"]
    made = subprocess.run(command, stdout=subprocess.PIPE, check=True).stdout
    return len(made), len(gzip.compress(made, 9))


def sizes(folder: Path) -> Iterator[tuple[str, ...]]:
    for path in sorted((ROOT / "schemas").glob("*.yaml")):
        protocol = load(path)
        module = PACKAGE / f"{protocol.name}.js"
        first = protocol.messages[0].name
        plan = "planOf" + "".join(word.capitalize() for word in first.split("_"))
        decoder = f'export {{ Decoder }} from "{module}";'
        both = f'export {{ Decoder, encode, decode }} from "{module}";'
        one = (
            f'import {{ {plan} }} from "{module}";\n'
            f'import {{ readPayload }} from "{PACKAGE / "runtime" / "index.js"}";\n'
            f"export const read = (payload) => readPayload({plan}, payload);"
        )
        cells = [minified(program, folder) for program in (decoder, both, one)]
        yield protocol.name, *(f"{plain:,} ({packed:,})" for plain, packed in cells)


# --- the page -------------------------------------------------------------------------------------


def measure(rounds: int) -> Results:
    install()
    results = Results()
    with TemporaryDirectory() as name:
        folder = Path(name)
        hand = built(folder / "hand")
        for mix in mixes():
            answer = run("measure.mjs", request(mix, hand, rounds=rounds))
            results.mixes[mix.protocol] = measured(answer)
            print(mix.protocol, file=sys.stderr)
        if bench_generate.kaitai():
            results.kaitai.update(kaitai(rounds))
        results.mavlink = mavlink(rounds, folder / "mavlink")
        results.sizes = list(sizes(folder))
    return results


def table(head: Sequence[str], rows: Sequence[Sequence[str]]) -> str:
    marks = ["---", *["---:"] * (len(head) - 1)]
    return "\n".join("| " + " | ".join(cells) + " |" for cells in (head, marks, *rows))


def mixes_table(results: Results) -> str:
    rows = []
    for name, item in results.mixes.items():
        for what in item.times:
            title = "encoding" if what == "encode" else f"decoding, {portion(what)}"
            ratio = item.ratio(what, OURS, HAND)
            ours, hand = item.each(what, OURS), item.each(what, HAND)
            wide = item.size / item.frames
            verdict = "reached" if ratio <= AIM else "**missed**"
            cells = [f"{ours:,.0f}", f"{hand:,.0f}", f"{ours / wide:.1f}", f"{hand / wide:.1f}"]
            rows.append([f"{name}, {title}", *cells, f"{ratio:.2f} x", verdict])
    units = ("protogen, ns a frame", "by hand", "protogen, ns a byte", "by hand", "factor")
    return table(["", *units, f"at most {AIM} x"], rows)


def portion(what: str) -> str:
    return "at once" if what == "whole" else f"{int(what):,} bytes at a time"


def peer_table(found: Mapping[str, tuple[Measured, str]], peer: str) -> str:
    rows = []
    for title, (item, what) in found.items():
        ours, theirs = item.each(what, OURS), item.each(what, peer)
        ratio = item.ratio(what, OURS, peer)
        rows.append([title, f"{ours:,.0f}", f"{theirs:,.0f}", f"{ratio:.2f} x"])
    return table(["ns each", OURS, peer, "factor"], rows)


PAGE = """\
# What generated TypeScript takes

<!-- Written by benchmarks/bench_typescript.py, do not edit. -->

Made by `python benchmarks/bench_typescript.py --rounds {rounds}`: protogen {version}, node
{node}, {system}.

CPU time of the process, of which the garbage collector is a part, medians of {rounds} rounds.
In each round every contender has its turn, every second round in the reverse order; factors are
medians of the rounds' factors. Before anything is timed, the messages that each contender reads
and the frames that it writes are compared with those of the reference in Python, and everything
runs for 0.6 seconds, so that it is compiled. Each protocol has a process of its own.

## Beside code by hand

What one endpoint sends, in a mix as robots send it
([typescript_cases.py](peers/typescript_cases.py)): of rn1 a turn of the LIDAR for ten of
everything else, of rflex both motors with sonars, status and joystick, of matty status,
acknowledgements and positions. The frames are in order, the values random. A mix has about
{kilobytes} kB.

{mixes}

* **protogen** is the generated `Decoder` with its runtime: every message of the protocol known,
  events with offset, raw bytes, parts and messages, the reason of everything that is no frame.
  Encoding is `encode` with the sender and its counter; it is strict and knows the path of a
  wrong value.
* **by hand** is what an expert writes for what an endpoint sends
  ([rn1.ts](peers/typescript/rn1.ts), [rflex.ts](peers/typescript/rflex.ts),
  [matty.ts](peers/typescript/matty.ts)): events with offset, size, counter and message; bytes
  that are no frame without a reason; the same messages in noise, which tests compare. It keeps
  what is left of a portion and begins a frame anew when more has come. Of rflex it knows four
  messages.

{notes}

## Kaitai Struct

Payloads of one message alone, which are read. Code of Kaitai's compiler has no framing and
writes nothing. The distances of the LIDAR are converted by hand, as instances would need an
object for each; those of the gyroscope are asked for.

{kaitai}

## node-mavlink

Frames of MAVLink 2 with `heartbeat`, `attitude` and `global_position_int`, by the schema
`mavlink2` of the library, 1,024 bytes at a time. protogen looks for frames with a signature and
without, byte by byte. node-mavlink decodes by its two transforms, and is given the classes of
these three messages. Before that both have to make the same bytes.

{mavlink}

## Size

Bytes of one minified module with all that it needs, made by esbuild, and in brackets compressed
by gzip: the decoder with all messages of all endpoints; the same with `encode` and `decode`;
and what reads the payload of one message.

{sizes}
"""

NOTES = """\
What costs more than by hand: the message is looked up by its identity, and its function called;
whatever fits no fixed bounds is left to a description of the frame. Frames that are there as a
whole are taken by a printed function, which takes stuffing off and sums up in one loop, as code by
hand does. The parts of an event are one number until they are asked for. A frame in pieces goes by
the description, and is tried by that function again once much more of it has come. In small
portions this counts less, because code by hand copies what is left and begins the frame anew each
time. Encoders write the payload first, as only then its size is known, and put plain frames
together by a printed function: it sums up, and stuffs only where a byte has to be stuffed, where
code by hand does all of it in one pass. They look the message up by its name, and see to it that
callers give no part that there is none of.
"""


def page(results: Results, rounds: int) -> str:
    assert results.mavlink is not None
    mavlink_found = {
        "decoding": (results.mavlink, "decode"),
        "encoding": (results.mavlink, "encode"),
    }
    kaitai_found = {title: (item, "decode") for title, item in results.kaitai.items()}
    node = subprocess.run(["node", "--version"], stdout=subprocess.PIPE, text=True, check=True)
    return PAGE.format(
        rounds=rounds,
        version=VERSION,
        node=node.stdout.strip().removeprefix("v"),
        system=f"{platform.system()} {platform.machine()}",
        kilobytes=typescript_cases.STREAM // 1000,
        mixes=mixes_table(results),
        notes=NOTES,
        kaitai=peer_table(kaitai_found, "Kaitai") if kaitai_found else "Not installed.",
        mavlink=peer_table(mavlink_found, "node-mavlink"),
        sizes=table(["", "decoder", "decoder and encoder", "one message"], results.sizes),
    )


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--rounds", type=int, default=9)
    rounds = parser.parse_args().rounds
    OUT.write_text(page(measure(rounds), rounds), encoding="utf-8")


if __name__ == "__main__":
    main()
