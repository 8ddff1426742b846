"""The monitor: what it counts, what it shows, and that it keeps up with real ports."""

from __future__ import annotations

import asyncio
import json
import math
import os
import re
import subprocess
import sys
import tempfile
import time
from collections.abc import AsyncIterator, Awaitable, Callable, Iterator
from contextlib import asynccontextmanager, contextmanager
from pathlib import Path
from types import ModuleType
from typing import Any

import pytest
from cli_support import PATIENCE, ROOT, run
from tooling import require_tool

from generated.python import matty
from protogen.api import load
from protogen.cli.line.monitor import has_screen
from protogen.cli.wire.codec import Codec
from protogen.link.device import SimulatedDevice
from protogen.link.ports.settings import LineSettings
from protogen.link.statistics import LineStatistics
from protogen.live.codec import kept_module
from protogen.monitor.fields import FilterError
from protogen.monitor.filters import parse_filter
from protogen.monitor.plain import watch
from protogen.monitor.rows import jitter_text
from protogen.monitor.session import Session
from protogen.recording import Recorder

pytest.importorskip("serialx")
pytest.importorskip("textual")
pytestmark = pytest.mark.skipif(os.name != "posix", reason="pseudo-terminals are of POSIX")

MATTY = str(ROOT / "schemas/matty.yaml")
PROTOCOL = load(MATTY)
SECOND = 10**9
STATUS = {"status": 0, "mode": 1, "voltage": 7260, "current": 123, "speed": 5, "angle": 0} | {
    f"encoder{number}": 0 for number in range(4)
}


def module() -> ModuleType:
    return kept_module(PROTOCOL)


def event_of(name: str, counter: int, **fields: int) -> Any:
    kind = module().MESSAGES[name]
    sender = kind.SENDERS[0]
    frame = module().encode(kind(**fields), counter=counter)
    return module().Decoder(sender).feed(frame)[0]


class TestStatistics:
    def test_rate_and_jitter(self) -> None:
        statistics = LineStatistics(PROTOCOL)
        times = [0.0, 0.09, 0.2, 0.31, 0.4]  # 0.1 s apart, off by 10 ms: 90, 110, 110, 90 ms
        for number, when in enumerate(times):
            statistics.take(event_of("ack", number), round(when * SECOND))
        found = statistics.messages["esp", "ack"]
        assert found.rate(round(0.4 * SECOND)) == pytest.approx(10.0)
        assert found.jitter == pytest.approx(0.01)
        assert found.rate(5 * SECOND) == pytest.approx(4 / 5)

    def test_gaps_of_a_counter_that_wraps(self) -> None:
        statistics = LineStatistics(PROTOCOL)
        for counter in (254, 255, 0, 3, 4):
            statistics.take(event_of("ack", counter), 0)
        statistics.take(event_of("status", 6, **STATUS), 0)
        assert statistics.messages["esp", "ack"].gaps == 2
        assert statistics.messages["esp", "status"].gaps == 1

    def test_a_frame_that_is_sent_again_is_no_gap(self) -> None:
        statistics = LineStatistics(PROTOCOL)
        for counter in (7, 7, 8, 8, 10):
            statistics.take(event_of("ack", counter), 0)
        assert statistics.messages["esp", "ack"].gaps == 1

    def test_what_has_changed(self) -> None:
        statistics = LineStatistics(PROTOCOL)
        statistics.take(event_of("status", 0, **STATUS), 0)
        assert statistics.messages["esp", "status"].changed == frozenset()
        statistics.take(event_of("status", 1, **STATUS | {"speed": 6}), 0)
        assert statistics.messages["esp", "status"].changed == {"speed"}

    def test_load_of_the_line(self) -> None:
        """115200 baud are 11520 bytes a second, of 10 bits each."""
        statistics = LineStatistics(PROTOCOL)
        statistics.take_bytes("esp", 1152, 0)
        statistics.take_bytes("esp", 1152, SECOND // 2)
        assert statistics.load("esp", SECOND // 2) == pytest.approx(0.2)
        assert statistics.load("esp", 2 * SECOND) == 0
        assert statistics.load("pc", 0) is None

    def test_what_is_no_message(self) -> None:
        statistics = LineStatistics(PROTOCOL)
        for event in module().Decoder("esp").feed(b"noise" + bytes.fromhex("55 02 01 7A 83")):
            statistics.take(event, 0)
        assert (statistics.invalid, statistics.invalid_bytes) == ({"noise": 1}, 5)
        assert statistics.unknown == 1


class TestFilter:
    @pytest.mark.parametrize(
        ("text", "kept"),
        [
            ("", True),
            ("status", True),
            ("ack", False),
            ("esp", True),
            ("pc or status.speed > 4", True),
            ("status.speed > 5", False),
            ("status.speed>=5 and status.voltage < 8000", True),
            ("status.speed = 5 and ack", False),
            ("status.angle_deg <= 0.0", True),
            ("status.mode == remote", True),
            ("status.mode != REMOTE", False),
            ("invalid", False),
        ],
    )
    def test_keeps(self, text: str, kept: bool) -> None:
        event = event_of("status", 0, **STATUS)
        assert parse_filter(text, module()).keeps(event) is kept

    @pytest.mark.parametrize(
        ("text", "problem"),
        [
            ("statsu", "there is no message `statsu`"),
            ("status.spede > 1", "`status` has no field `spede`"),
            ("status.speed", "does not say what the field is to be"),
            ("status > 1", "does not say what is compared"),
            ("invalid.size > 1", "`invalid` has no fields"),
            ("status.speed >", "is no condition"),
            ("status.to_dict < 1", "`status` has no field `to_dict`"),
            ("status.angle_deg < 11deg", "`11deg` is no number"),
            ("status.speed = fast", "`fast` is no number"),
            ("status.mode < remote", "`remote` is no number"),
            ("status.mode = remoet", "`mode` is never `remoet`"),
            ("status..mode = 1", "names no field"),
        ],
    )
    def test_mistakes_are_told(self, text: str, problem: str) -> None:
        with pytest.raises(FilterError, match=problem) as caught:
            parse_filter(text, module())
        assert caught.value.hint


PACK = """
protocol: pack
endpoints: {pack: Battery}
byte_order: little
transparency: {encoding: cobs}
frame:
  type: {type: uint8, id: true}
  payload: {}
  end: {literal: 0}
messages:
  cells:
    id: 1
    from: pack
    fields:
      volts: {type: uint16, count: 2, scale: 0.001, unit: V}
      name: {type: ascii, size: 8}
      raw: {type: bytes, size: 2}
      temp: float32
      pose: {fields: {x: sint8, y: {type: sint8, count: 2}}}
"""


class TestFilterOfValues:
    @pytest.mark.parametrize(
        ("text", "kept"),
        [
            ("cells.volts_v[1] < 3.6", True),
            ("cells.volts[0] = 3600", True),
            ("cells.volts[9] > 0", False),
            ("cells.name = 'my pack'", True),
            ('cells.name != "my pack"', False),
            ("cells.name < 3", False),
            ("cells.raw = 0aff", True),
            ("cells.temp > 0", False),  # It is not a number.
            ("cells.pose.x = -1 and cells.pose.y[1] = 5", True),
            ("cells.pose.nothing = 1", False),
        ],
    )
    def test_keeps(self, tmp_path: Path, text: str, kept: bool) -> None:
        own = self.module(tmp_path)
        message = own.Cells.from_dict(
            {"volts": [3600, 3500], "name": "my pack", "raw": "0AFF", "temp": math.nan}
            | {"pose": {"x": -1, "y": [4, 5]}}
        )
        (event,) = own.Decoder("pack").feed(own.encode(message))
        assert parse_filter(text, own).keeps(event) is kept

    @pytest.mark.parametrize(
        ("text", "problem"),
        [
            ("cells.volts < 3", r"`cells.volts` has several values"),
            ("cells.volts_v < 3", r"`cells.volts_v` has several values"),
            ("cells.pose = 1", "`cells.pose` has fields of its own"),
            ("cells.volts[x] = 1", "is no condition|names no field"),
        ],
    )
    def test_what_is_not_one_value_is_told(self, tmp_path: Path, text: str, problem: str) -> None:
        with pytest.raises(FilterError, match=problem) as caught:
            parse_filter(text, self.module(tmp_path))
        assert caught.value.hint

    def module(self, folder: Path) -> ModuleType:
        path = folder / "pack.yaml"
        path.write_text(PACK)
        return kept_module(load(path))


@pytest.mark.parametrize(
    ("seconds", "text"),
    [(0.0049, "4.9ms"), (0.0999, "99.9ms"), (0.1787, "179ms"), (2.34, "2.3s")],
)
def test_a_jitter_is_never_cut(seconds: float, text: str) -> None:
    assert jitter_text(seconds) == text


Test = Callable[[Any, Any, Any], Awaitable[None]]


def watched(ends: dict[str, str], test: Test) -> None:
    """Run the full screen at 80 x 24, driven by textual's pilot."""

    async def drive() -> None:
        async with driven(Codec(PROTOCOL, module()), ends) as (app, pilot, session):
            await test(app, pilot, session)

    asyncio.run(asyncio.wait_for(drive(), PATIENCE))


@asynccontextmanager
async def driven(codec: Codec, ends: dict[str, str]) -> AsyncIterator[tuple[Any, Any, Any]]:
    """The full screen, its pilot and its session.

    A session that outlives a failed test would take the next test's port, as soon as that has the
    name of the one that it lost.
    """
    from protogen.monitor.app import MonitorApp
    from protogen.monitor.session import Session

    session = Session(codec, ends, LineSettings())
    session.start()
    try:
        app = MonitorApp(session)
        async with app.run_test(size=(80, 24)) as pilot:
            yield app, pilot, session
    finally:
        session.stop()


async def until(pilot: Any, holds: Callable[[], bool]) -> None:
    end = time.monotonic() + PATIENCE
    while not holds():
        assert time.monotonic() < end, "it did not come"
        await pilot.pause(0.05)


async def typed(pilot: Any, key: str, text: str) -> None:
    """Open the line to type in by its key, and enter a text at once: each key is a drawing."""
    from textual.widgets import Input

    await pilot.press(key)
    pilot.app.query_one(Input).value = text
    await pilot.press("enter")
    await pilot.pause(0.3)


class TestScreen:
    def test_rows_log_plot_and_details(self) -> None:
        from textual.widgets import DataTable, RichLog, Sparkline, Static

        async def test(app: Any, pilot: Any, session: Any) -> None:
            table = app.query_one(DataTable)
            await until(pilot, lambda: table.row_count == 2)
            table.move_cursor(row=table.get_row_index("esp status"))
            await pilot.press("d")
            await until(
                pilot, lambda: "voltage: " in str(app.query_one("#detail", Static).render())
            )
            await typed(pilot, "p", "status.voltage")
            await until(pilot, lambda: len(app.query_one(Sparkline).data or []) > 3)
            await typed(pilot, "p", "ack")  # Names no field: the plot stays.
            assert len(app.query_one(Sparkline).data) > 3
            await pilot.press("escape")
            await typed(pilot, "f", "ack")
            log = app.query_one(RichLog)
            await until(pilot, lambda: bool(log.lines))
            assert [line.text for line in log.lines if " ack " not in line.text] == []
            await typed(pilot, "f", "statsu")  # Is told, and what was typed stays.
            assert app.query_one("#typed").display
            await pilot.press("escape")
            await pilot.press("space")
            status = app.query_one("#status", Static)
            await until(pilot, lambda: "PAUSED" in str(status.render()))

        rates = {"status": 20, "ack": 10}
        with SimulatedDevice(MATTY, "esp", rates=rates) as board:
            watched({"esp": board.port}, test)

    def test_sends_and_saves(self, tmp_path: Path) -> None:
        async def test(app: Any, pilot: Any, session: Any) -> None:
            await typed(pilot, "s", "go speed=5 steer=0 @counter=7")
            await until(pilot, lambda: board.counts.received == {"go": 1})
            await until(pilot, lambda: len(session.log) > 5)
            await typed(pilot, "w", "")  # Is told.
            assert app.query_one("#typed").display
            await pilot.press("escape")
            await typed(pilot, "w", str(tmp_path / "log.jsonl"))
            await pilot.press("ctrl+c")
            await until(pilot, lambda: not app.is_running)

        with SimulatedDevice(MATTY, "esp", rates={"ack": 50}) as board:
            watched({"esp": board.port}, test)
        lines = (tmp_path / "log.jsonl").read_text().splitlines()
        assert len(lines) > 5
        assert all('"message": "ack"' in line for line in lines)
        times = [json.loads(line)["t_ns"] for line in lines]
        assert times == sorted(times)
        assert abs(times[-1] / SECOND - time.time()) < 60

    def test_two_hundred_messages(self, tmp_path: Path) -> None:
        from textual.widgets import DataTable

        schema = tmp_path / "many.yaml"
        rest = "from: board, fields: {x: uint8}"
        names = "".join(f"  m{n}: {{id: {n}, {rest}}}\n" for n in range(200))
        schema.write_text(
            "protocol: many\nendpoints: {board: Board}\nframe:\n"
            "  type: {type: uint8, id: true}\n  payload: {}\n"
            "  sum: {type: uint8, algorithm: sum-8, covers: type..payload}\n"
            "  end: {literal: 0}\ntransparency: {encoding: cobs}\n"
            f"messages:\n{names}"
        )
        protocol = load(schema)
        own = kept_module(protocol)
        with Recorder(tmp_path / "run.pgrec") as recorder:
            for number in range(200):
                recorder.write(own.encode(own.MESSAGES[f"m{number}"](x=1)), t_ns=number)

        async def drive() -> None:
            ends = {"board": f"{tmp_path}/run.pgrec"}
            async with driven(Codec(protocol, own), ends) as (app, pilot, _):
                await until(pilot, lambda: app.query_one(DataTable).row_count == 200)

        asyncio.run(drive())


@contextmanager
def terminal(command: str) -> Iterator[Callable[[], str]]:
    """A real terminal of 80 x 24, and what is on its screen."""
    tmux = [require_tool("tmux"), "-L", f"protogen{os.getpid()}"]
    start = [*tmux, "new-session", "-d", "-x", "80", "-y", "24", command]
    subprocess.run(start, check=True, cwd=ROOT)
    try:
        yield (
            lambda: (
                subprocess.run(
                    [*tmux, "capture-pane", "-p"], check=True, capture_output=True, text=True
                ).stdout
            )
        )
    finally:
        subprocess.run([*tmux, "kill-server"], check=False)


def shown(screen: Callable[[], str], pattern: str, seconds: float = PATIENCE) -> re.Match[str]:
    end = time.monotonic() + seconds
    while time.monotonic() < end:
        if found := re.search(pattern, screen()):
            return found
        time.sleep(0.2)
    raise AssertionError(screen())


def are_right(text: str) -> bool:
    """True if the rates on a screen are those at which the board sends, but for 2 %."""
    found = {name: re.search(rf"esp {name} +\d+ +([0-9.]+)", text) for name in ("status", "ack")}
    rates = {name: float(it[1]) for name, it in found.items() if it is not None}
    return rates == pytest.approx({"status": 100, "ack": 20}, rel=0.02)


@pytest.mark.slow
def test_in_a_terminal_rates_are_right_and_a_port_comes_back() -> None:
    port = Path(tempfile.mkdtemp(dir="/tmp")) / "port"  # Short, to fit a line of the screen.
    program = f"{sys.executable} -m protogen monitor {MATTY} esp={port}"
    with SimulatedDevice(MATTY, "esp", rates={"status": 100, "ack": 20}) as board:
        port.symlink_to(board.port)
        with terminal(program) as screen:
            shown(screen, r"esp status +1[2-9]\d\d ")  # Rates are those of ten seconds.
            end = time.monotonic() + PATIENCE
            while not are_right(screen()):
                # A machine that stood still shows others for ten seconds.
                assert time.monotonic() < end, screen()
                time.sleep(0.2)
            port.unlink()  # Soon the port of another test may have the same name.
            board.stop()
            shown(screen, "is gone")
            with SimulatedDevice(MATTY, "esp", rates={"ack": 20}) as again:
                port.symlink_to(again.port)
                shown(screen, "is back")
                count = int(shown(screen, r"esp ack +(\d+)")[1])
                shown(screen, rf"esp ack +(?!{count} )\d+")


@pytest.mark.parametrize(
    ("term", "addresses", "has"),
    [
        ("xterm", ["/dev/ttyUSB0"], True),
        ("dumb", ["/dev/ttyUSB0"], False),
        ("xterm", ["-"], False),  # The keys would be the line.
    ],
)
def test_lines_where_there_is_no_screen_or_no_keyboard(
    monkeypatch: pytest.MonkeyPatch, term: str, addresses: list[str], has: bool
) -> None:
    monkeypatch.setenv("TERM", term)
    for stream in (sys.stdin, sys.stdout):
        monkeypatch.setattr(stream, "isatty", lambda: True, raising=False)
    assert has_screen(addresses) is has


class TestPlain:
    def test_lines_for_a_pipe(self, tmp_path: Path) -> None:
        with Recorder(tmp_path / "run.pgrec") as recorder:
            frame = matty.encode(matty.Ack(), counter=1)
            recorder.write(b"?" + frame, t_ns=1_500_000_000, source="esp")
        done = run("monitor", MATTY, f"esp={tmp_path}/run.pgrec", "--plain")
        assert done.exit_code == 0, done.output
        assert [line.split() for line in done.stdout.splitlines()] == [
            ["1.500000", "0", "esp", "invalid", "noise", "3F"],
            ["1.500000", "1", "esp", "ack", "@counter=1"],
        ]
        done = run("monitor", MATTY, f"esp={tmp_path}/run.pgrec", "--plain", "--filter", "ack")
        assert len(done.stdout.splitlines()) == 1

    def test_says_what_a_slow_output_misses(
        self, tmp_path: Path, capsys: pytest.CaptureFixture[str]
    ) -> None:
        with Recorder(tmp_path / "run.pgrec") as recorder:
            for number in range(10_100):
                frame = matty.encode(matty.Ack(), counter=number % 256)
                recorder.write(frame, t_ns=1, source="esp")
        ends = {"esp": f"{tmp_path}/run.pgrec"}
        session = Session(Codec(PROTOCOL, module()), ends, LineSettings())
        session.start()
        end = time.monotonic() + PATIENCE
        while not session.is_over and time.monotonic() < end:
            time.sleep(0.01)
        watch(session, parse_filter("", module()), None)
        session.stop()
        out, err = capsys.readouterr()
        assert "100 events left out" in err
        assert len(out.splitlines()) == 10_000

    @pytest.mark.parametrize(
        ("args", "problem"),
        [
            (("esp=/dev/no_such_port",), "there is no such port"),
            (("esp=pty:", "--filter", "statsu"), "there is no message `statsu`"),
            (("pty:", "pty:"), "two ports need the names of who is there"),
        ],
    )
    def test_mistakes_are_told(self, args: tuple[str, ...], problem: str) -> None:
        done = run("monitor", MATTY, *args)
        assert done.exit_code == 2
        assert problem in done.stderr
