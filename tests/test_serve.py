"""`serve`: what clients of Foxglove and PlotJuggler get, and what a client sends to a port."""

from __future__ import annotations

import json
import os
import re
import select
import signal
import socket
import struct
import subprocess
import sys
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import pytest
from cli_support import PATIENCE, ROOT, run

from generated.python import matty
from protogen.api import load
from protogen.convert.formats import OutputFormat
from protogen.convert.runs.conversion import Job, convert, plan
from protogen.link.device import SimulatedDevice
from protogen.live.codec import kept_module
from protogen.recording import Recorder

pytest.importorskip("serialx")
pytest.importorskip("foxglove")
connect = pytest.importorskip("websockets.sync.client").connect
pytestmark = pytest.mark.skipif(os.name != "posix", reason="pseudo-terminals are of POSIX")

MATTY = str(ROOT / "schemas/matty.yaml")
SECOND = 10**9
BEGIN = 1_700_000_000 * SECOND
STATUS = matty.Status(
    status=0,
    mode=matty.RobotMode.REMOTE,
    voltage=7260,
    current=123,
    speed=5,
    angle=-250,
    **{f"encoder{number}": number for number in range(4)},
)


@contextmanager
def serving(*args: str) -> Iterator[str]:
    """A server, and what it has said in its first line."""
    process = subprocess.Popen(
        [sys.executable, "-m", "protogen", "serve", MATTY, *args],
        stderr=subprocess.PIPE,
        text=True,
        cwd=ROOT,
    )
    assert process.stderr is not None
    try:
        assert select.select([process.stderr], [], [], PATIENCE)[0], "it said nothing"
        line = process.stderr.readline().strip()
        assert line.startswith("ws://"), f"{line}\n{process.communicate(timeout=PATIENCE)[1]}"
        yield line
        process.send_signal(signal.SIGINT)
        _, error = process.communicate(timeout=PATIENCE)
        assert process.returncode == 0, error
    finally:
        process.kill()
        process.communicate()


class Client:
    """A client that speaks the SDK's subprotocol."""

    def __init__(self, socket: Any) -> None:
        self._socket = socket
        self.info = self._next("serverInfo")
        self.channels: dict[str, Any] = {}
        while "/matty/invalid_spans" not in self.channels:
            found = self._next("advertise")["channels"]
            self.channels |= {channel["topic"]: channel for channel in found}
        self._topics = {channel["id"]: topic for topic, channel in self.channels.items()}

    def subscribe(self) -> None:
        numbers = [{"id": number, "channelId": number} for number in self._topics]
        self._socket.send(json.dumps({"op": "subscribe", "subscriptions": numbers}))

    def messages(self, count: int) -> list[tuple[str, int, Any]]:
        """Topic, time and content of the next messages."""
        found = []
        while len(found) < count:
            data = self._socket.recv(timeout=PATIENCE)
            if isinstance(data, bytes):
                kind, number, when = struct.unpack_from("<BIQ", data)
                assert kind == 1
                found.append((self._topics[number], when, json.loads(data[13:])))
        return found

    def publish(self, topic: str, text: str, encoding: str = "json", number: int = 1) -> None:
        channel = {"id": number, "topic": topic, "encoding": encoding, "schemaName": ""}
        self._socket.send(json.dumps({"op": "advertise", "channels": [channel]}))
        self._socket.send(struct.pack("<BI", 1, number) + text.encode())
        self._socket.send(json.dumps({"op": "unadvertise", "channelIds": [number]}))

    def status(self) -> str:
        """What the next status says; it has to be an error."""
        status = self._next("status")
        assert status["level"] == 2
        return str(status["message"])

    def _next(self, op: str) -> Any:
        while True:
            data = self._socket.recv(timeout=PATIENCE)
            if isinstance(data, str) and (found := json.loads(data))["op"] == op:
                return found


@contextmanager
def client(address: str) -> Iterator[Client]:
    with connect(
        address, subprotocols=["foxglove.sdk.v1"], open_timeout=PATIENCE, close_timeout=PATIENCE
    ) as socket:
        yield Client(socket)


@pytest.fixture(scope="module")
def recording(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Both directions, in which the ends do not take turns, with noise and an unknown frame."""
    file = tmp_path_factory.mktemp("serve") / "run.pgrec"
    unknown = bytes.fromhex("55 02 01 7A 83")
    with Recorder(file) as recorder:
        for number in range(100):
            when = BEGIN + number * SECOND // 200
            status = matty.encode(STATUS, counter=number)
            go = matty.encode(matty.Go(speed=number, steer=-250), counter=number)
            recorder.write(status[:5], t_ns=when, source="esp")
            recorder.write(go, t_ns=when + 1000, source="pc")
            recorder.write(status[5:] + b"?" + unknown, t_ns=when + 2000, source="esp")
    return file


def of_mcap(folder: Path, recording: Path, sender: str) -> list[tuple[str, int, Any]]:
    """Topics, times and contents of what `convert` makes of a recording."""
    reader = pytest.importorskip("mcap.reader")
    protocol = load(MATTY)
    runtime = kept_module(protocol).PROTOCOL
    spec = protocol.sender(sender)
    # An engine that compiles nothing: tests of `convert` hold all of them to the same rows.
    job = Job(protocol, runtime, spec, OutputFormat.MCAP, folder / sender, engine="events")
    list(convert(job, plan(job, [str(recording)]), lambda problem: None, lambda count: None))
    (file,) = (folder / sender).glob("*.mcap")
    with file.open("rb") as stream:
        return [
            (channel.topic, message.log_time, json.loads(message.data))
            for _, channel, message in reader.make_reader(stream).iter_messages()
        ]


@pytest.fixture(scope="module")
def replayed(recording: Path) -> tuple[Client, list[tuple[str, int, Any]], str]:
    """A client, what it got of a replay, and what it was told when it published something."""
    args = (str(recording), "--port", "0", "--speed", "2", "--endpoint", "pc")
    with serving(*args) as address, client(address) as viewer:
        viewer.publish("/matty/pc/stop", "{}")
        problem = viewer.status()
        viewer.subscribe()
        return viewer, viewer.messages(100 * 4), problem


class TestReplay:
    def test_a_client_receives_all_of_it_as_convert_writes_it(
        self, replayed: Any, recording: Path, tmp_path: Path
    ) -> None:
        _, found, _ = replayed
        wanted = of_mcap(tmp_path, recording, "esp") + of_mcap(tmp_path, recording, "pc")
        assert len(wanted) == len(found)
        order = lambda item: (item[1], item[0], json.dumps(item[2]))  # noqa: E731
        assert sorted(found, key=order) == sorted(wanted, key=order)

    def test_channels_have_schemas_with_units(self, replayed: Any) -> None:
        viewer, _, _ = replayed
        assert viewer.info["capabilities"] == ["clientPublish"]
        assert viewer.info["supportedEncodings"] == ["json"]
        topics = set(viewer.channels)
        channel = viewer.channels["/matty/esp/status"]
        assert {
            "/matty/pc/go",
            "/matty/esp/ack",
            "/matty/esp/unknown_frames",
            "/matty/pc/invalid_spans",
        } <= topics
        assert (channel["encoding"], channel["schemaEncoding"]) == ("json", "jsonschema")
        assert channel["schemaName"] == "matty.status"
        members = json.loads(channel["schema"])["properties"]
        assert members["voltage"]["x-unit"] == "mV"
        assert "[mV]" in members["voltage"]["description"]
        angle = members["angle_deg"]
        assert (angle["type"], angle["x-unit"]) == ("number", "deg")

    def test_nothing_is_sent_there(self, replayed: Any) -> None:
        assert "nothing can be sent to the recording" in replayed[2]


def received(frames: list[bytes], count: int) -> list[bytes]:
    end = time.monotonic() + PATIENCE
    while len(frames) < count:
        assert time.monotonic() < end, "it did not come"
        time.sleep(0.01)
    return list(frames)


class TestPublishing:
    def test_what_a_client_publishes_reaches_the_device(self) -> None:
        frames: list[bytes] = []
        with SimulatedDevice(MATTY, "esp") as board:
            board.on("go", lambda event: frames.append(event.raw) or [])
            args = (f"esp={board.port}", "--port", "0", "--endpoint", "pc")
            with serving(*args) as address, client(address) as viewer:
                viewer.subscribe()
                viewer.publish("/matty/pc/go", '{"speed": 500, "steer": "-2.5deg"}')
                ((topic, _, row),) = viewer.messages(1)
                viewer.publish("/matty/pc/go", '{"speed": 0, "steer": 0, "@counter": 85}')
                viewer.publish("/matty/pc/go", '{"speed": 0, "steer": 0}')
                found = received(frames, 3)
        assert found == [
            # length, counter, G, speed 500, steer -250, what makes the sum 0
            bytes.fromhex("55 06 00 47 F4 01 06 FF B9"),
            # counter 85 is 55, which is sent as 56 AA
            bytes.fromhex("55 06 56 AA 47 00 00 00 00 5E"),
            bytes.fromhex("55 06 01 47 00 00 00 00 B2"),
        ]
        assert (topic, row["@counter"], row["steer_deg"]) == ("/matty/pc/go", 0, -2.5)

    def test_what_is_wrong_is_told_and_not_sent(self) -> None:
        mistakes = [
            ("/matty/pc/go", '{"speed": 40000, "steer": 0}', r"/matty/pc/go: speed: .*32767"),
            ("/matty/pc/go", '{"speed": 1}', r"steer"),
            ("/matty/pc/go", '{"sped": 1, "steer": 0}', r"no field `sped` .*speed"),
            ("/matty/pc/go", '{"speed": 1, "steer": 0, "@count": 1}', r"no part `count` .*counter"),
            ("/matty/pc/go", "{", "not JSON"),
            ("/matty/pc/go", "[1]", "an object"),
            ("/matty/pc/gone", "{}", r"`gone`.*go"),
            ("/matty/esp/ack", "{}", "sent as pc, not as esp"),
            ("matty/pc/go", "{}", "no topic to publish on"),
            ("/pc/go", "{}", "no topic to publish on"),
            ("/rn1/pc/go", "{}", "no topic to publish on"),
        ]
        frames: list[bytes] = []
        with SimulatedDevice(MATTY, "esp") as board:
            board.on("go", lambda event: frames.append(event.raw) or [])
            args = (f"esp={board.port}", "--port", "0", "--endpoint", "pc")
            with serving(*args) as address, client(address) as viewer:
                for topic, text, problem in mistakes:
                    viewer.publish(topic, text)
                    assert re.search(problem, viewer.status()), problem
                viewer.publish("/matty/pc/go", "{}", encoding="cdr")
                assert "publish JSON" in viewer.status()
                viewer.publish("/matty/pc/go", '{"speed": 0, "steer": 0}')
                assert viewer._next("removeStatus")["statusIds"] == ["/matty/pc/go"]
                assert received(frames, 1) == [bytes.fromhex("55 06 00 47 00 00 00 00 B3")]
            assert board.counts.received == {"go": 1}


def test_nobody_can_publish_unless_it_is_said_as_whom() -> None:
    with SimulatedDevice(MATTY, "esp") as board:
        with serving(f"esp={board.port}", "--port", "0") as address, client(address) as viewer:
            viewer.publish("/matty/pc/stop", "{}")
            assert "sent as nobody, not as pc" in viewer.status()
        assert board.counts.received == {}


def test_plotjuggler_gets_a_datagram_for_each_message(tmp_path: Path) -> None:
    file = tmp_path / "run.pgrec"
    with Recorder(file) as recorder:
        recorder.write(matty.encode(STATUS, counter=7), t_ns=BEGIN + SECOND // 2, source="esp")
        recorder.write(b"?", t_ns=BEGIN + SECOND // 2, source="esp")
        recorder.write(matty.encode(matty.Stop(), counter=1), t_ns=BEGIN + SECOND, source="pc")
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as plotter:
        plotter.bind(("127.0.0.1", 0))
        plotter.settimeout(PATIENCE)
        port = plotter.getsockname()[1]
        done = run("serve", MATTY, str(file), "--plotjuggler", f"127.0.0.1:{port}")
        assert done.exit_code == 0, done.output
        status, noise, stop = (json.loads(plotter.recv(65536)) for _ in range(3))
    assert status["timestamp"] == 1_700_000_000.5
    assert set(status) == {"timestamp", "esp"}
    values = status["esp"]["status"]
    assert (values["voltage"], values["mode_name"], values["angle_deg"]) == (7260, "remote", -2.5)
    assert values["@counter"] == 7
    assert noise["esp"]["invalid_spans"] == {
        "offset": 23,
        "size": 1,
        "reason": "noise",
        "raw": "3f",
    }
    assert stop == {
        "timestamp": 1_700_000_001.0,
        "pc": {"stop": {"offset": 0, "size": 5, "@counter": 1}},
    }


def test_names_with_dots_are_nested() -> None:
    """Also where the physical values of `turn` are called as a struct is."""
    from protogen.convert.columns.tables import Table
    from protogen.serving.live_rows import LiveRow, Topic
    from protogen.serving.plotjuggler import _datagram, _paths_of

    values = {"t_ns": 5, "a.b.c": 1, "a.b.d": None, "a.e": b"\1", "turn_deg.x": 2, "turn_deg": 3}
    topic = Topic("rover", ("board", "state"), Table("state", (), (), {}))
    row = LiveRow(topic, values, 2 * SECOND)
    assert json.loads(_datagram(row, _paths_of(row))) == {
        "timestamp": 2.0,
        "board": {
            "state": {
                "a": {"b": {"c": 1}, "e": "01"},
                "turn_deg": {"x": 2},
                "turn_deg_value": 3,
            }
        },
    }


class TestMistakes:
    @pytest.mark.parametrize(
        ("args", "problem"),
        [
            (("esp=/dev/no_such_port",), "there is no such port"),
            (("pty:", "pty:"), "two ports need the names of who is there"),
            (("pty:", "--endpoint", "esq"), "did you mean `esp`"),
            (("pty:", "--plotjuggler", "localhost"), "write it as 127.0.0.1:9870"),
            (("pty:", "--plotjuggler", "no.such.host.invalid:9870"), "is no address"),
            (("pty:", "--host", "no.such.host.invalid"), "can't be served at"),
        ],
    )
    def test_they_are_told(self, args: tuple[str, ...], problem: str) -> None:
        done = run("serve", MATTY, *args)
        assert done.exit_code == 2
        assert problem in done.stderr
        assert "served 0" not in done.stderr  # It has not begun.

    def test_a_port_that_is_taken(self) -> None:
        with socket.create_server(("127.0.0.1", 0)) as taken:
            done = run("serve", MATTY, "pty:", "--port", str(taken.getsockname()[1]))
        assert done.exit_code == 2
        assert "choose --host and --port" in done.stderr

    def test_a_package_that_is_missing(self, monkeypatch: pytest.MonkeyPatch) -> None:
        monkeypatch.setitem(sys.modules, "foxglove", None)
        done = run("serve", MATTY, "pty:")
        assert done.exit_code == 2
        assert "pip install 'protogen-serial[foxglove]'" in done.stderr
