"""Ports: what goes in at one end comes out at the other, and what goes wrong is said."""

from __future__ import annotations

import asyncio
import os
import socket
import subprocess
import sys
import time
from collections.abc import Awaitable, Callable, Coroutine
from pathlib import Path
from typing import Any

import pytest
from cli_support import PATIENCE
from link_wire import run_in_virtual_time

from protogen.link.intake import Intake
from protogen.link.ports import pseudo_terminal
from protogen.link.ports.address import PortKind, parse_address
from protogen.link.ports.lasting import LastingPort
from protogen.link.ports.opening import open_port
from protogen.link.ports.port import Arrival, Port, PortError, PortLostError
from protogen.link.ports.pseudo_terminal import make_pseudo_terminal
from protogen.link.ports.settings import LineSettings
from protogen.recording import Recorder

pytest.importorskip("serialx")
POSIX = pytest.mark.skipif(os.name != "posix", reason="pseudo-terminals are of POSIX")
ALL_BYTES = bytes(range(256))


def run(test: Coroutine[Any, Any, None]) -> None:
    asyncio.run(asyncio.wait_for(test, PATIENCE))


async def taken(port: Port, size: int) -> bytes:
    """The next `size` bytes."""
    data = b""
    while len(data) < size:
        data += (await port.read()).data
    return data


class TestAddress:
    @pytest.mark.parametrize(
        ("text", "kind"),
        [
            ("/dev/ttyUSB0", PortKind.SERIAL),
            ("COM3", PortKind.SERIAL),
            ("socket://10.0.0.1:9000", PortKind.SOCKET),
            ("rfc2217://[::1]:2217", PortKind.RFC2217),
            ("pty:", PortKind.PSEUDO_TERMINAL),
            ("listen://:9000", PortKind.LISTENING),
            ("-", PortKind.STANDARD_INPUT),
            (__file__, PortKind.RECORDING),
        ],
    )
    def test_says_what_a_port_is(self, text: str, kind: PortKind) -> None:
        assert parse_address(text).kind is kind

    @pytest.mark.parametrize(
        ("text", "problem"),
        [
            ("http://host:80", "no port begins with `http://`"),
            ("socket://host", "lacks a port number"),
            ("socket://:9000", "lacks a host"),
            ("socket://host:many", "has no port number"),
            ("socket://host:99999", "has no port number"),
            ("udp:9", "`udp:9` is no port"),
            ("", "no port is named"),
        ],
    )
    def test_of_nothing_is_told_with_a_hint(self, text: str, problem: str) -> None:
        with pytest.raises(PortError, match=problem) as caught:
            parse_address(text)
        assert caught.value.hint


@POSIX
class TestSerialPort:
    def test_bytes_pass_as_they_are(self) -> None:
        async def both_ways() -> None:
            async with make_pseudo_terminal() as board, await open_port(board.name) as port:
                await port.write(ALL_BYTES)
                assert await taken(board, 256) == ALL_BYTES
                await board.write(ALL_BYTES)
                assert await taken(port, 256) == ALL_BYTES

        run(both_ways())

    def test_bytes_have_the_time_at_which_they_came(self) -> None:
        async def one() -> None:
            async with make_pseudo_terminal() as board, await open_port(board.name) as port:
                before = time.time_ns()
                await board.write(b"x")
                arrival = await port.read()
                assert before <= arrival.when <= time.time_ns()

        run(one())

    def test_a_writer_waits_while_nobody_reads(self) -> None:
        """A pseudo-terminal takes some kilobytes; all of a megabyte arrive."""
        data = os.urandom(1 << 20)

        async def much() -> None:
            async with make_pseudo_terminal() as board, await open_port(board.name) as port:
                writing = asyncio.create_task(board.write(data))
                await asyncio.sleep(0.1)
                assert not writing.done()
                assert await taken(port, len(data)) == data
                await writing

        run(much())

    def test_what_is_offered_to_nobody_is_lost(self) -> None:
        async def lost() -> None:
            async with make_pseudo_terminal() as board:
                assert await board.offer(b"first")
                while await board.offer(bytes(1000)):
                    pass
                reader = os.open(board.name, os.O_RDONLY | os.O_NOCTTY)
                assert os.read(reader, 5) == b"first"
                os.close(reader)

        run(lost())

    def test_two_programs_can_not_have_it(self) -> None:
        async def twice() -> None:
            async with make_pseudo_terminal() as board, await open_port(board.name):
                with pytest.raises(PortError, match="another program has it open") as caught:
                    await open_port(board.name)
                assert caught.value.hint == "close that one first"

        run(twice())

    @pytest.mark.parametrize(
        ("name", "problem"),
        [("/dev/no_such_port", "there is no such port"), ("/dev/null", "it is no serial port")],
    )
    def test_what_can_not_be_opened_is_told_with_cause_and_hint(
        self, name: str, problem: str
    ) -> None:
        with pytest.raises(PortError, match=problem) as caught:
            asyncio.run(open_port(name))
        assert caught.value.hint

    def test_a_port_that_goes_away_is_lost(self) -> None:
        async def gone() -> None:
            board = make_pseudo_terminal()
            async with await open_port(board.name) as port:
                await board.close()
                with pytest.raises(PortLostError, match="is gone"):
                    await port.read()

        run(gone())


class TestNetwork:
    def test_both_ends_of_tcp(self) -> None:
        async def both_ways() -> None:
            async with await open_port("listen://127.0.0.1:0") as board:
                for _ in range(2):  # The line outlives who is connected.
                    async with await open_port(board.name) as port:
                        await port.write(ALL_BYTES)
                        assert await taken(board, 256) == ALL_BYTES
                        await board.write(ALL_BYTES)
                        assert await taken(port, 256) == ALL_BYTES

        run(both_ways())

    def test_one_who_comes_second_is_sent_away(self) -> None:
        async def second() -> None:
            async with (
                await open_port("listen://127.0.0.1:0") as board,
                await open_port(board.name) as first,
            ):
                await first.write(b"x")
                await board.read()
                async with await open_port(board.name) as other:
                    with pytest.raises(PortLostError):
                        await other.read()
                await board.write(b"y")
                assert await taken(first, 1) == b"y"

        run(second())

    def test_a_place_where_nobody_listens(self) -> None:
        with socket.socket() as free:
            free.bind(("127.0.0.1", 0))
            number = free.getsockname()[1]
        with pytest.raises(PortError, match="nobody listens there"):
            asyncio.run(open_port(f"socket://127.0.0.1:{number}"))

    def test_a_number_that_is_taken(self) -> None:
        with socket.socket() as taken_:
            taken_.bind(("127.0.0.1", 0))
            taken_.listen()
            number = taken_.getsockname()[1]
            with pytest.raises(PortError, match="can't listen"):
                asyncio.run(open_port(f"listen://127.0.0.1:{number}"))


class TestRecording:
    @pytest.fixture
    def recording(self, tmp_path: Path) -> str:
        with Recorder(tmp_path / "run.pgrec") as recorder:
            recorder.write(b"a", t_ns=1_000_000_000)
            recorder.note("nothing to be sent")
            recorder.write(b"b", t_ns=1_300_000_000)
            recorder.write(b"c", t_ns=1_600_000_000)
        return str(tmp_path / "run.pgrec")

    @pytest.mark.parametrize(("speed", "seconds"), [(1.0, 0.6), (3.0, 0.2)])
    def test_comes_at_its_pace(self, recording: str, speed: float, seconds: float) -> None:
        async def paced() -> None:
            port = await open_port(recording, speed=speed)
            began = time.monotonic()
            assert [(await port.read()).data for _ in range(4)] == [b"a", b"b", b"c", b""]
            assert seconds - 0.01 <= time.monotonic() - began < seconds + PATIENCE

        run(paced())

    def test_comes_at_once_with_its_own_times(self, recording: str) -> None:
        async def at_once() -> None:
            port = await open_port(recording, speed=0)
            found = [await port.read() for _ in range(3)]
            assert [item.data for item in found] == [b"a", b"b", b"c"]
            assert [item.when for item in found] == [10**9, 13 * 10**8, 16 * 10**8]

        run(at_once())

    def test_can_not_be_written(self, recording: str) -> None:
        async def write() -> None:
            await (await open_port(recording)).write(b"x")

        with pytest.raises(PortError, match="nothing can be sent"):
            run(write())

    def test_another_file_is_none(self) -> None:
        with pytest.raises(PortError, match="is a file, but no recording"):
            asyncio.run(open_port(__file__))


READER = """
import asyncio
from protogen.link.ports.opening import open_port

async def main():
    port = await open_port("-")
    while data := (await port.read()).data:
        print(len(data), flush=True)

asyncio.run(main())
"""


class TestStandardInput:
    def test_comes_as_it_is_written_and_ends(self) -> None:
        reader = subprocess.Popen(
            [sys.executable, "-c", READER], stdin=subprocess.PIPE, stdout=subprocess.PIPE
        )
        assert reader.stdin is not None
        assert reader.stdout is not None
        for size in (3, 5):
            reader.stdin.write(bytes(size))
            reader.stdin.flush()
            assert reader.stdout.readline() == b"%d\n" % size
        reader.stdin.close()
        assert reader.stdout.read() == b""
        assert reader.wait(PATIENCE) == 0


@POSIX
class TestLastingPort:
    def test_a_port_that_comes_back_goes_on(self) -> None:
        names: list[str] = []
        news: list[str] = []

        async def lasting() -> None:
            def reopened() -> Awaitable[Port]:
                return open_port(names[-1])

            board = make_pseudo_terminal()
            names.append(board.name)
            port = LastingPort(await reopened(), reopened, news.append)
            await board.write(b"before")
            assert await taken(port, 6) == b"before"
            names.append("/dev/no_such_port")  # The old one may soon be that of another test.
            await board.close()
            reading = asyncio.create_task(taken(port, 5))
            while port.is_there:
                await asyncio.sleep(0.01)
            with pytest.raises(PortLostError, match="nothing is sent until it is back"):
                await port.write(b"lost")
            board = make_pseudo_terminal()
            names.append(board.name)
            while not port.is_there:
                await asyncio.sleep(0.01)
            await board.write(b"after")
            assert await reading == b"after"
            await port.close()
            await board.close()

        run(lasting())
        assert len(news) == 2
        assert news[0].endswith("waiting for it")
        assert news[1].endswith("is back")


def test_control_lines_are_left_alone_unless_asked_for(monkeypatch: pytest.MonkeyPatch) -> None:
    """A board that resets when DTR changes must not do so because a port was opened."""
    import serialx

    from protogen.link.ports import serial_port

    asked: list[dict[str, Any]] = []
    monkeypatch.setattr(serialx, "async_serial_for_url", _noting(asked), raising=True)
    address = parse_address("/dev/ttyUSB0")
    for settings in (LineSettings(), LineSettings(dtr=False, rts=True)):
        with pytest.raises(PortError):
            asyncio.run(serial_port.open_serial_port(address, settings))
    left, low, high = serialx.PinState.UNDEFINED, serialx.PinState.LOW, serialx.PinState.HIGH
    pins = [(item["dtr_on_open"], item["rts_on_open"]) for item in asked]
    assert pins == [(left, left), (low, high)]
    assert all(item["dtr_on_close"] is left and item["rts_on_close"] is left for item in asked)


def _noting(asked: list[dict[str, Any]]) -> Callable[..., Any]:
    class Nothing:
        async def open(self) -> None:
            raise OSError(2, "not there")

    def opened(url: str, **keywords: Any) -> Nothing:
        asked.append(keywords)
        return Nothing()

    return opened


@POSIX
class TestPassingOn:
    """A tap's line goes on where one end does not take what the other sends."""

    def test_a_pseudo_terminal_that_nobody_reads(self, monkeypatch: pytest.MonkeyPatch) -> None:
        monkeypatch.setattr(pseudo_terminal, "PATIENCE", 0.1)

        async def passed_on() -> None:
            async with make_pseudo_terminal() as made:
                taken = 0
                while (sent := await made.pass_on(bytes(1000))) == 1000:
                    taken += sent
                taken += sent
                began = time.monotonic()
                found = [await made.pass_on(bytes(1000)) for _ in range(1000)]
                taken += sum(found)
                assert sum(found) < 50_000  # The system may find some room yet.
                assert time.monotonic() - began < 50, "each waits for itself"
                program = os.open(made.name, os.O_RDWR | os.O_NOCTTY)
                while taken:
                    taken -= len(os.read(program, 4096))
                while not await made.pass_on(b"back"):  # The system gives room a moment later.
                    await asyncio.sleep(0.01)
                assert os.read(program, 10) == b"back"
                os.close(program)

        run(passed_on())

    def test_to_nobody_who_is_connected(self) -> None:
        async def passed_on() -> None:
            async with await open_port("listen://127.0.0.1:0") as made:
                assert await made.pass_on(b"lost") == 0
                async with await open_port(made.name) as program:
                    await made.joined()
                    assert await made.pass_on(b"there") == 5
                    assert (await program.read()).data == b"there"

        run(passed_on())

    def test_to_a_port_that_is_gone(self) -> None:
        async def passed_on() -> None:
            made, news = make_pseudo_terminal(), list[str]()
            lasting = LastingPort(made, lambda: open_port("/dev/no_such_port"), news.append)
            await made.close()
            assert [await lasting.pass_on(b"x") for _ in range(2)] == [0, 0]
            assert len(news) == 1
            assert "waiting for it" in news[0]

        run(passed_on())


class Portions(Port):
    """A port that has portions of these sizes, and notes where bytes were left to gather."""

    def __init__(self, *sizes: int) -> None:
        super().__init__("portions")
        self.left = list(sizes)
        self.steps: list[str] = []

    async def read(self) -> Arrival:
        size = self.left.pop(0) if self.left else 0
        self.steps.append(f"read {size}")
        await asyncio.sleep(0.001)
        return Arrival(bytes(size), 0)

    async def gather(self, seconds: float) -> None:
        assert 0.0005 < seconds < 0.01
        self.steps.append("gather")

    async def write(self, data: bytes) -> None:
        raise AssertionError("nothing is sent")

    async def close(self) -> None:
        return


@pytest.mark.parametrize("silence", [None, 0.02])
def test_bytes_gather_behind_large_portions_only(silence: float | None) -> None:
    port = Portions(10, 100, 200, 5000, 5)
    intake = Intake(port)

    async def read() -> None:
        arrivals = [await intake.next(silence) for _ in range(6)]
        sizes = [-1 if item is None else len(item.data) for item in arrivals]
        assert sizes == [10, 100, 200, 5000, 5, 0]

    run_in_virtual_time(read())
    gathered = ["read 100", "gather", "read 200", "gather", "read 5000"]  # Of which more may wait.
    assert port.steps == ["read 10", *gathered, "read 5", "read 0"]


def test_bytes_do_not_gather_where_a_short_silence_ends_frames() -> None:
    port = Portions(100, 100)
    intake = Intake(port)

    async def read() -> None:
        for _ in range(2):
            await intake.next(0.002)

    run_in_virtual_time(read())
    assert port.steps == ["read 100", "read 100"]
