"""Generated TypeScript in Chromium gives the events of Python."""

from __future__ import annotations

import json
import shutil
from collections.abc import Iterator
from pathlib import Path
from random import Random
from typing import Any

import pytest
import typescript_engine as engine
from browser_pages import chromium, context_of, served
from compiled import DOCUMENTS, ROOT, module_at, name_of, protocol_of
from corpus import material_of, portions, stream_of

LIBRARY = [
    ROOT / "protogen" / "library" / f"{name}.yaml"
    for name in ("kiss", "mbus", "modbus", "nmea", "sbus", "xbee2")
]
PATHS = [*DOCUMENTS, *LIBRARY]
STREAMS = 3
ASK = """async ([module, requests]) => {
    const { answer } = await import("/requests.mjs");
    return answer(await import(module), { several: requests });
}"""


@pytest.fixture(scope="module")
def page() -> Iterator[Any]:
    """A page beside the modules."""
    folder = engine.modules()
    shutil.copy(engine.DRIVER.with_name("requests.mjs"), folder)
    (folder / "index.html").write_text("<!doctype html><title>modules</title>", encoding="utf-8")
    with served(folder) as address, chromium() as browser:
        found = context_of(browser).new_page()
        found.goto(f"{address}/index.html")
        yield found


def ask(page: Any, module: Path, requests: list[dict[str, Any]]) -> list[Any]:
    """The answers to requests about a module."""
    address = "/" + module.relative_to(engine.modules()).as_posix()
    found: list[Any] = page.evaluate(ASK, [address, requests])
    return found


@pytest.mark.parametrize("path", PATHS, ids=name_of)
def test_damaged_streams_are_cut_alike(page: Any, path: Path) -> None:
    module = module_at(path)
    for sender in protocol_of(path).senders:
        material = material_of(path, sender.name)
        streams: list[list[bytes | None]] = []
        for seed in range(STREAMS):
            dice = Random(f"browser {path.stem} {sender.name} {seed}")
            streams.append([*portions(stream_of(material, dice, 12).data, dice), None])
        digits = [[None if step is None else step.hex() for step in steps] for steps in streams]
        requests = [{"sender": sender.name, "steps": steps} for steps in digits]
        answers = ask(page, engine.module_at(path), requests)
        for steps, answer in zip(streams, answers, strict=True):
            found = [[json.loads(line) for line in lines] for lines in answer]
            expected = engine.python_events(module, sender.name, steps)
            assert not engine.first_difference(found, expected)
