"""`protogen send`: a message onto a line, and what answers it."""

from __future__ import annotations

import json
import os
import time
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
from cli_support import PATIENCE, ROOT, run
from link_board import SCHEMA

from protogen.link.device import SimulatedDevice

pytest.importorskip("serialx")
pytestmark = pytest.mark.skipif(os.name != "posix", reason="pseudo-terminals are of POSIX")

MATTY = str(ROOT / "schemas/matty.yaml")
PATIENT = ("--timeout", str(PATIENCE))
"""Sent once, however busy the machine is."""


@pytest.fixture
def rig(tmp_path: Path) -> str:
    path = tmp_path / "rig.yaml"
    path.write_text(SCHEMA)
    return str(path)


@pytest.fixture
def board(rig: str) -> Iterator[SimulatedDevice]:
    """A board that obeys, unless the value is 0, and sends states without being asked."""
    with SimulatedDevice(rig, "board", rates={"state": 50}) as device:
        of = device.messages

        def answer(event: Any) -> Any:
            value = event.message.value
            reply = of["done"](value=value) if value else of["failed"](code=1)
            yield reply, {"counter": event.parts.counter}

        device.on("set", answer)
        device.on("reset", lambda event: [])
        yield device


def test_the_reply_is_printed(rig: str, board: SimulatedDevice) -> None:
    result = run("send", rig, board.port, "set", "value=512")
    assert (result.exit_code, result.stdout.split()) == (0, ["done", "@counter=0", "value=512"])
    result = run("send", rig, board.port, "set", "value=3", "@counter=9", "--format", "jsonl")
    line = json.loads(result.stdout)
    assert (line["message"], line["parts"]["counter"], line["fields"]) == ("done", 9, {"value": 3})


def test_a_refusal_and_another_reply_are_findings(rig: str, board: SimulatedDevice) -> None:
    result = run("send", rig, board.port, "set", "value=0")
    assert (result.exit_code, result.stdout) == (1, "")
    assert "set was refused: failed (code=1)" in result.stderr
    result = run("send", rig, board.port, "set", "value=1", "--expect", "failed")
    assert (result.exit_code, result.stdout.split()[0]) == (1, "done")
    assert "the reply is done, not failed" in result.stderr
    result = run("send", rig, board.port, "set", "value=0", "--expect", "failed")
    assert (result.exit_code, result.stderr) == (0, "")
    assert "set was refused: failed (code=1)" in result.stdout


def test_what_is_no_reply_can_be_waited_for_as_well(rig: str, board: SimulatedDevice) -> None:
    result = run(
        *("send", rig, f"board={board.port}", "set", "value=1", "--expect", "state"), *PATIENT
    )
    assert (result.exit_code, result.stdout.split()[0]) == (0, "state")
    result = run("send", rig, board.port, "set", "value=1", "--expect", "reset")
    assert (result.exit_code, "nobody else sends `reset`" in result.stderr) == (2, True)
    assert board.counts.received == {"set": 1}  # The second was not sent.


def test_without_a_reply_it_says_what_came_instead(rig: str, board: SimulatedDevice) -> None:
    result = run("send", rig, board.port, "reset", "--timeout", "0.2", "--retries", "1")
    assert result.exit_code == 1
    assert "no reply to reset, sent 2 times, waited 0.2 s each time: instead came" in result.stderr
    assert "x state" in result.stderr
    end = time.monotonic() + PATIENCE
    while board.counts.received["reset"] < 2 and time.monotonic() < end:
        time.sleep(0.01)
    assert board.counts.received["reset"] == 2


def test_without_an_exchange_nothing_is_waited_for_unless_it_is_asked_for(
    rig: str, board: SimulatedDevice
) -> None:
    result = run("send", rig, board.port, "note", "text=hi")
    assert (result.exit_code, result.stdout, result.stderr) == (0, "", "")
    result = run("send", rig, board.port, "note", "text=hi", "--expect", "state")
    assert (result.exit_code, result.stdout.split()[0]) == (0, "state")
    result = run("send", rig, board.port, "note", "text=hi", "--expect", "pong", "--timeout", "0.1")
    assert (result.exit_code, "no reply to note, sent once" in result.stderr) == (1, True)


def test_mistakes_are_told_with_what_may_be_given(rig: str, board: SimulatedDevice) -> None:
    result = run("send", rig, board.port, "set", "value=70000")
    assert (result.exit_code, "70000 is not in 0..65535" in result.stderr) == (2, True)
    result = run("send", rig, board.port, "note", "text=hi", "--expect", "set")
    assert (result.exit_code, "nobody else sends `set`" in result.stderr) == (2, True)
    result = run("send", rig, f"baord={board.port}", "reset")
    assert (result.exit_code, "did you mean `board`?" in result.stderr) == (2, True)
    result = run("send", rig, board.port, "reset", "--timeout", "0")
    assert (result.exit_code, "0.0 is no timeout" in result.stderr) == (2, True)
    result = run("send", rig, "/dev/no_such_port", "reset")
    assert (result.exit_code, "there is no such port" in result.stderr) == (2, True)
