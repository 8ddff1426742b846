"""How soon the page of a large schema is there, and how soon its search answers.

    python benchmarks/bench_page.py             # writes benchmarks/page.md
    python benchmarks/bench_page.py --runs 3    # fewer runs

Times are those of Chromium's own clock. Search is timed from the press of a key to the frame that
is painted behind the list of what was found.
"""

from __future__ import annotations

import argparse
import json
import os
import shutil
import tempfile
from collections.abc import Mapping, Sequence
from pathlib import Path
from statistics import median
from typing import Any, NamedTuple

from protogen.compiler import compile_file
from protogen.targets.html.emit import emit
from protogen.version import VERSION

ROOT = Path(__file__).resolve().parent.parent
RESULT = ROOT / "benchmarks" / "page.md"
MESSAGES = (30, 100, 300)
WORDS = ("m1", "motor", "speed of", "02 21", "nothing like it")
"""What is typed into the search, key by key: names, words of documents, bytes, and what is not."""

TIMED = """() => {
    globalThis.taken = [];
    document.addEventListener("keydown", ({ timeStamp }) => {
        requestAnimationFrame(() => setTimeout(() => taken.push(performance.now() - timeStamp)));
    }, true);
}"""
WAIT = """(count) => new Promise((done) => {
    const look = () => taken.length < count ? setTimeout(look, 5) : done();
    look();
})"""
PAINT = """() => ({
    paint: performance.getEntriesByName("first-contentful-paint")[0]?.startTime ?? 0,
    load: performance.getEntriesByType("navigation")[0].domComplete,
})"""


class Taken(NamedTuple):
    """Milliseconds of a run."""

    paint: float
    load: float
    keys: list[float]


def schema(messages: int) -> dict[str, Any]:
    """A schema of so many messages, each with eight fields, documents and an enum of its own."""
    kinds = ("motor", "sensor", "battery", "radio", "gripper", "camera", "lamp", "clock")
    states = {"off": 0, "ready": 1, "busy": 2, "hot": 3, "blocked": 4, "lost": 5}

    def one(index: int) -> dict[str, Any]:
        kind = kinds[index % len(kinds)]
        return {
            "id": {"group": index // 256, "number": index % 256},
            "from": "board",
            "summary": f"State of {kind} {index}",
            "doc": f"Sent by the board whenever {kind} {index} changes, and each second.",
            "fields": {
                "state": {"type": "uint8", "values": states, "doc": f"State of {kind} {index}"},
                "flags": {"type": "uint8", "flags": {"on": 0, "error": 1, "limit": 2}},
                "speed": {
                    "type": "sint16",
                    "unit": "m/s",
                    "scale": 0.01,
                    "doc": f"Speed of {kind}",
                },
                "current": {"type": "uint16", "unit": "A", "scale": 0.001, "doc": "Of the supply"},
                "position": {"type": "sint32", "unit": "mm", "doc": "From the stop on the left"},
                "temperature": {"type": "sint8", "unit": "degC", "doc": "Of its case"},
                "hours": {"type": "uint32", "unit": "h", "doc": "Since it was made"},
                "serial": {"type": "ascii", "size": 8, "doc": "As on its label"},
            },
        }

    return {
        "protocol": f"large_{messages}",
        "title": f"A board with {messages} messages",
        "endpoints": {"board": "Board"},
        "byte_order": "little",
        "frame": {
            "sync": {"literal": {"hex": "B5 62"}, "unprotected": "in_data"},
            "group": {"type": "uint8", "id": True},
            "number": {"type": "uint8", "id": True},
            "length": {"type": "uint8", "counts": "payload"},
            "payload": {},
            "crc": {"type": "uint16", "algorithm": "CRC-16/XMODEM", "covers": "group..payload"},
        },
        "messages": {f"{kinds[it % len(kinds)]}_{it}": one(it) for it in range(messages)},
        "decisions": {
            "in_data": {
                "question": "What if the data holds a start?",
                "document": "There is none; the schema is made for the benchmark.",
                "choice": "Length and checksum tell.",
                "because": "Nothing keeps it out.",
            }
        },
    }


def written(messages: int, folder: Path) -> Path:
    """The page of such a schema."""
    source = folder / f"large_{messages}.yaml"
    source.write_text(json.dumps(schema(messages)), encoding="utf-8")
    protocol = compile_file(source).protocol
    assert protocol is not None
    for file in emit([protocol]):
        (folder / file.path).write_bytes(file.bytes)
    return folder / f"large_{messages}.html"


def run(browser: Any, path: Path) -> Taken:
    """Open a page in a new context, and type words into its search."""
    context = browser.new_context(viewport={"width": 1600, "height": 1000})
    page = context.new_page()
    page.goto(path.as_uri())
    page.wait_for_function("performance.getEntriesByName('first-contentful-paint').length")
    times = page.evaluate(PAINT)
    page.evaluate(TIMED)
    count = 0
    for word in WORDS:
        page.fill("#query", "")
        page.focus("#query")
        for key in word:
            page.keyboard.type(key)
            count += 1
            page.evaluate(WAIT, count)
    keys = page.evaluate("taken")
    context.close()
    return Taken(times["paint"], times["load"], keys)


TEXT = """\
# How soon a page is there, and its search answers

<!-- Written by benchmarks/bench_page.py, do not edit. -->

Made by `python benchmarks/bench_page.py --runs {runs}`: milliseconds in {browser}, median and
most of {runs} runs, each in a new context; of the search, of all keys of all runs. First paint is
that of the first contents, load ends when scripts have run. Search is from the press of a key to
the frame that is painted behind the list. Each message has eight fields and an enum.

The aim: first paint in a second and an answer in 200 ms for a schema of 300 messages.

protogen {version}. {cpus} CPUs.

| messages | page, KB | first paint | most | load | most | key to list | most |
| ---: | ---: | ---: | ---: | ---: | ---: | ---: | ---: |
"""


def row(messages: int, size: int, runs: Sequence[Taken]) -> str:
    """Times of a page."""
    keys = [key for item in runs for key in item.keys]
    series = ([item.paint for item in runs], [item.load for item in runs], keys)
    cells = [f"{of(item):.0f}" for item in series for of in (median, max)]
    return f"| {messages} | {size / 1024:.0f} | {' | '.join(cells)} |\n"


def measure(runs: int) -> str:
    """The whole page of results."""
    from playwright.sync_api import sync_playwright

    program = shutil.which("chromium")
    with tempfile.TemporaryDirectory() as name, sync_playwright() as playwright:
        pages: Mapping[int, Path] = {count: written(count, Path(name)) for count in MESSAGES}
        browser = playwright.chromium.launch(executable_path=program, args=["--no-sandbox"])
        taken: dict[int, list[Taken]] = {count: [] for count in pages}
        for turn in range(runs + 1):
            for count, path in pages.items():
                found = run(browser, path)
                if turn:  # The first run warms the browser up.
                    taken[count].append(found)
        head = TEXT.format(
            runs=runs,
            browser=f"Chromium {browser.version.partition('.')[0]}",
            version=VERSION,
            cpus=os.cpu_count(),
        )
        browser.close()
        rows = [row(count, path.stat().st_size, taken[count]) for count, path in pages.items()]
    return head + "".join(rows)


def main() -> None:
    """Measure, and write the page."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--runs", type=int, default=5)
    RESULT.write_text(measure(parser.parse_args().runs), encoding="utf-8")
    print(RESULT.read_text(encoding="utf-8"))


if __name__ == "__main__":
    main()
