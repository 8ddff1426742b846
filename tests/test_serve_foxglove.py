"""`serve` with a client that nobody here wrote: Foxglove's own, in node."""

from __future__ import annotations

import json
import os
import subprocess
from pathlib import Path
from typing import Any

from cli_support import PATIENCE, ROOT
from test_serve import MATTY, of_mcap, received, recording, serving
from tooling import require_tool, unavailable

from protogen.link.device import SimulatedDevice

__all__ = ["recording"]

MODULES = ROOT / ".cache" / "foxglove"


def client(address: str, count: int, *published: str) -> list[tuple[str, int, Any]]:
    """Topics, times and contents of the messages that come, behind what is published."""
    node = require_tool("node")
    if not (MODULES / "node_modules" / "@foxglove" / "ws-protocol").is_dir():
        unavailable("@foxglove/ws-protocol and ws are not installed in .cache/foxglove")
    done = subprocess.run(
        [node, str(ROOT / "tests" / "foxglove" / "client.mjs"), address, str(count), *published],
        env={**os.environ, "FOXGLOVE_MODULES": str(MODULES)},
        capture_output=True,
        text=True,
        timeout=PATIENCE,
        check=False,
    )
    assert done.returncode == 0, done.stderr
    lines = [json.loads(line) for line in done.stdout.splitlines()]
    return [(topic, int(when), row) for topic, when, row in lines]


def test_it_receives_a_whole_replay(recording: Path, tmp_path: Path) -> None:
    args = (str(recording), "--port", "0", "--speed", "2")
    with serving(*args) as address:
        found = client(address, 100 * 4)
    wanted = of_mcap(tmp_path, recording, "esp") + of_mcap(tmp_path, recording, "pc")
    order = lambda item: (item[1], item[0], json.dumps(item[2]))  # noqa: E731
    assert sorted(found, key=order) == sorted(wanted, key=order)


def test_what_it_publishes_reaches_the_device_as_exact_bytes() -> None:
    frames: list[bytes] = []
    with SimulatedDevice(MATTY, "esp") as board:
        board.on("go", lambda event: frames.append(event.raw) or [])
        with serving(f"esp={board.port}", "--port", "0", "--endpoint", "pc") as address:
            client(address, 1, "/matty/pc/go", '{"speed": 500, "steer": "-2.5deg"}')
            # length, counter, G, speed 500, steer -250, what makes the sum 0
            assert received(frames, 1) == [bytes.fromhex("55 06 00 47 F4 01 06 FF B9")]
