"""`record`, `tap` and `replay`, as processes, on real ports."""

from __future__ import annotations

import errno
import io
import os
import re
import select
import signal
import subprocess
import sys
import termios
import time
from collections.abc import Iterator
from contextlib import ExitStack, contextmanager
from pathlib import Path
from typing import IO, Any

import pytest
from cli_support import PATIENCE, ROOT, run

from protogen.cli.line.recorders import AnyRecorder
from protogen.link.damage import Damage, DamageRates
from protogen.recording import Record, Recorder, RecordKind, records

sys.path.append(str(ROOT / "benchmarks"))

from peers.pacing import device

pytest.importorskip("serialx")
pytestmark = pytest.mark.skipif(os.name != "posix", reason="pseudo-terminals are of POSIX")

MATTY = str(ROOT / "schemas/matty.yaml")
STOP = bytes.fromhex("55 02 01 53 AA")  # of the PC, with counter 1
ACK = bytes.fromhex("55 02 01 41 BC")  # of the ESP, for counter 1


@contextmanager
def started(*args: str) -> Iterator[subprocess.Popen[str]]:
    """A command that runs until it is stopped."""
    process = subprocess.Popen(
        [sys.executable, "-m", "protogen", *args],
        stdin=subprocess.PIPE,
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
        cwd=ROOT,
    )
    try:
        yield process
    finally:
        process.kill()
        process.communicate()


def line_of(stream: IO[str] | None) -> str:
    """The next line, which has to come soon. Nothing behind it is read yet."""
    assert stream is not None
    line = b""
    while not line.endswith(b"\n"):
        assert select.select([stream], [], [], PATIENCE)[0], "nothing was printed"
        byte = os.read(stream.fileno(), 1)
        if not byte:
            break
        line += byte
    return line.decode()


def stopped(process: subprocess.Popen[str]) -> tuple[str, str]:
    process.send_signal(signal.SIGINT)
    out, error = process.communicate(timeout=PATIENCE)
    assert process.returncode == 0, error
    return out, error


@contextmanager
def opened(name: str) -> Iterator[int]:
    """A port that is opened as a program does."""
    port = os.open(name, os.O_RDWR | os.O_NOCTTY)
    try:
        yield port
    finally:
        os.close(port)


def read(port: int, size: int) -> bytes:
    data = b""
    while len(data) < size:
        assert select.select([port], [], [], PATIENCE)[0], f"no more than {data.hex(' ')}"
        data += os.read(port, size - len(data))
    return data


def found_in(file: Path) -> list[Record]:
    return list(records([file.read_bytes()], pytest.fail))


def until(file: Path, size: int) -> None:
    """Wait until a file has grown."""
    end = time.monotonic() + PATIENCE
    while not file.exists() or file.stat().st_size < size:
        assert time.monotonic() < end, "nothing was recorded"
        time.sleep(0.01)


class TestRecord:
    def test_bytes_with_times_and_the_endpoint_that_was_named(self, tmp_path: Path) -> None:
        file = tmp_path / "run.pgrec"
        before = time.time_ns()
        with (
            device() as (own, name),
            started("record", MATTY, f"esp={name}", "-o", str(file)) as it,
        ):
            assert line_of(it.stderr) == f"recording {name}; Ctrl-C ends it\n"
            os.write(own, ACK)
            until(file, 8 + 16 + 3 + 16 + 5)
            os.write(own, ACK)
            until(file, 8 + 16 + 3 + 2 * (16 + 5))
            out, _ = stopped(it)
        assert re.fullmatch(rf"10 bytes in [0-9.]+ s: {re.escape(str(file))}\n", out)
        found = found_in(file)
        assert b"".join(item.data for item in found) == ACK * 2
        assert {item.source for item in found} == {"esp"}
        assert before < found[0].when < found[-1].when < time.time_ns()
        decoded = run("decode", MATTY, str(file)).stdout.splitlines()
        ack = ["esp", "ack", "@counter=1"]
        assert [line.split() for line in decoded] == [["0", *ack], ["5", *ack]]

    def test_a_port_that_comes_back_is_noted(self, tmp_path: Path) -> None:
        file, link = tmp_path / "run.pgrec", tmp_path / "port"
        with started("record", MATTY, str(link), "-o", str(file)) as it:
            assert "there is no such port" in line_of(it.stderr)
        with ExitStack() as stack:
            with device() as (own, name):
                link.symlink_to(name)
                args = ("record", MATTY, str(link), "-o", str(file), "--force")
                it = stack.enter_context(started(*args))
                assert line_of(it.stderr) == f"recording {link}; Ctrl-C ends it\n"
                os.write(own, STOP)
                until(file, 8 + 16 + 5)
                link.unlink()  # Soon the port of another test may have the same name.
            assert "is gone" in line_of(it.stderr)
            own, name = stack.enter_context(device())
            link.symlink_to(name)
            assert line_of(it.stderr) == f"{link} is back\n"
            os.write(own, STOP)
            end = time.monotonic() + PATIENCE
            while found_in(file)[-1].kind is not RecordKind.BYTES and time.monotonic() < end:
                time.sleep(0.01)
            stopped(it)
        kinds = [item.kind.name for item in found_in(file)]
        assert kinds == ["BYTES", "NOTE", "NOTE", "BYTES"]

    def test_several_files(self, tmp_path: Path) -> None:
        recorded = tmp_path / "long.pgrec"
        with Recorder(recorded) as recorder:
            for number in range(10):
                recorder.write(bytes([number]) * 100, t_ns=number)
        done = run(
            *("record", MATTY, str(recorded), "-o", str(tmp_path / "run.pgrec")),
            *("--max-size", "0.0004"),
        )
        assert done.exit_code == 0, done.output
        files = sorted(tmp_path.glob("run-*.pgrec"))
        assert [file.name for file in files][:2] == ["run-0001.pgrec", "run-0002.pgrec"]
        assert all(file.stat().st_size <= 400 for file in files)
        data = b"".join(item.data for file in files for item in found_in(file))
        assert data == b"".join(bytes([number]) * 100 for number in range(10))

    def test_pcapng(self, tmp_path: Path) -> None:
        recorded, file = tmp_path / "short.pgrec", tmp_path / "run.pcapng"
        with Recorder(recorded) as recorder:
            recorder.write(b"abc", t_ns=0x0102030405060708)
        done = run("record", MATTY, str(recorded), "-o", str(file), "--format", "pcapng")
        assert done.exit_code == 0, done.output
        section = "0A0D0D0A 1C000000 4D3C2B1A 0100 0000 FFFFFFFFFFFFFFFF 1C000000"
        # Link type 147; if_name `line`; if_tsresol 9: nanoseconds; end of options
        interface = "01000000 28000000 9300 0000 00000000 0200 0400 6C696E65"
        interface += "0900 0100 09000000 0000 0000 28000000"
        packet = "06000000 24000000 00000000 04030201 08070605 03000000 03000000 61626300 24000000"
        assert file.read_bytes() == bytes.fromhex(section + interface + packet)

    def test_a_file_that_is_there_stays(self, tmp_path: Path) -> None:
        file = tmp_path / "run.pgrec"
        file.write_text("old")
        done = run("record", MATTY, "-", "-o", str(file))
        assert done.exit_code == 2
        assert "is there already" in done.stderr
        assert file.read_text() == "old"

    @pytest.mark.parametrize(
        ("args", "problem"),
        [
            (("/dev/no_such_port",), "there is no such port"),
            (("espp=/dev/ttyUSB0",), "`espp` is no endpoint of matty"),
            (("socket://nowhere",), "lacks a port number"),
        ],
    )
    def test_mistakes_are_told(self, tmp_path: Path, args: tuple[str, ...], problem: str) -> None:
        done = run("record", MATTY, *args, "-o", str(tmp_path / "run.pgrec"))
        assert done.exit_code == 2
        assert problem in done.stderr
        assert "hint" in done.stderr
        assert list(tmp_path.iterdir()) == [], "a file that is in the way of the next attempt"

    def test_without_a_port_an_old_recording_stays(self, tmp_path: Path) -> None:
        file = tmp_path / "run.pgrec"
        file.write_text("old")
        done = run("record", MATTY, "/dev/no_such_port", "-o", str(file), "--force")
        assert done.exit_code == 2
        assert file.read_text() == "old"


class TestTap:
    def test_passes_on_records_and_shows_both_directions(self, tmp_path: Path) -> None:
        file = tmp_path / "run.pgrec"
        with device() as (board, name):
            ports = (f"esp={name}", "pc=pty:")
            with started("tap", MATTY, *ports, "-o", str(file)) as it:
                made = line_of(it.stderr).split()[-1]
                with opened(made) as program:
                    os.write(program, STOP)
                    assert read(board, 5) == STOP
                    assert line_of(it.stdout).split()[1:3] == ["pc", "stop"]
                    os.write(board, ACK)
                    assert read(program, 5) == ACK
                    assert line_of(it.stdout).split()[1:3] == ["esp", "ack"]
                    _, error = stopped(it)
        assert re.search(r"pc: 5 bytes passed on, held [0-9.]+ ms on average", error)
        assert [(item.source, item.data) for item in found_in(file)] == [("pc", STOP), ("esp", ACK)]

    def test_does_damage_that_it_is_asked_for(self, tmp_path: Path) -> None:
        sent, file = bytes(10_000), tmp_path / "run.pgrec"
        with device() as (board, name):
            options = ("--drop", "0.1", "--flip", "0.1", "--seed", "7", "-q", "-o", str(file))
            with started("tap", MATTY, f"esp={name}", "pc=pty:", *options) as it:
                made = line_of(it.stderr).split()[-1]
                with opened(made) as program:
                    for start in range(0, len(sent), 1000):
                        os.write(board, sent[start : start + 1000])
                        time.sleep(0.02)
                    # How many come out does not depend on the pieces that go in.
                    left = Damage(DamageRates(drop=0.1, flip=0.1), "7 esp").of(sent)
                    received = read(program, len(left))
                stopped(it)
        assert 8_700 < len(received) < 9_300
        assert 700 < sum(byte.bit_count() for byte in received) < 1_100
        assert b"".join(item.data for item in found_in(file)) == received

    def test_a_port_that_does_not_open_leaves_the_old_recording(self, tmp_path: Path) -> None:
        file = tmp_path / "run.pgrec"
        file.write_bytes(b"of yesterday")
        missing = str(tmp_path / "ttyUSB7")
        done = run("tap", MATTY, f"esp={missing}", "pc=pty:", "-o", str(file), "--force")
        assert done.exit_code == 2
        assert missing in done.stderr
        assert file.read_bytes() == b"of yesterday"

    def test_one_endpoint_can_not_be_at_both_ends(self) -> None:
        done = run("tap", MATTY, "esp=pty:", "esp=pty:")
        assert done.exit_code == 2
        assert "both ports are said to lead to esp" in done.stderr


class TestReplay:
    @pytest.fixture
    def recording(self, tmp_path: Path) -> str:
        with Recorder(tmp_path / "run.pgrec") as recorder:
            recorder.write(STOP[:2], t_ns=0, source="pc")
            recorder.write(ACK, t_ns=50_000_000, source="esp")
            recorder.write(STOP[2:] + b"?" + STOP, t_ns=300_000_000, source="pc")
        return str(tmp_path / "run.pgrec")

    def test_at_its_pace(self, recording: str) -> None:
        with device() as (own, name):
            began = time.monotonic()
            done = run("replay", recording, name, "--source", "pc")
            assert done.exit_code == 0, done.output
            assert time.monotonic() - began > 0.3
            assert read(own, 11) == STOP + b"?" + STOP
        assert done.stderr == "11 bytes sent\n"

    def test_message_by_message(self, recording: str) -> None:
        with device() as (own, name):
            args = ("replay", recording, name, "--source", "pc", "--schema", MATTY, "--step")
            with started(*args) as it:
                assert it.stdin is not None
                assert "stop" in line_of(it.stderr)
                assert not select.select([own], [], [], 0.2)[0], "it did not wait"
                it.stdin.write("\n")
                it.stdin.flush()
                assert read(own, 5) == STOP
                assert "stop" in line_of(it.stderr)
                it.stdin.write("\n")
                it.stdin.flush()
                assert read(own, 6) == b"?" + STOP
                assert line_of(it.stderr) == "11 bytes sent\n"

    def test_waits_until_a_port_that_it_made_is_opened_and_read(self, recording: str) -> None:
        args = ("replay", recording, "pty:", "--source", "pc", "--speed", "0")
        began, took = 0.0, 1.0
        while took > 0.4:  # Where the machine stood still for so long, the command has sent before.
            with ExitStack() as stack:
                it = stack.enter_context(started(*args))
                made = line_of(it.stderr).split()[-1]
                assert line_of(it.stderr) == "waiting until it is opened\n"
                assert not select.select([it.stderr], [], [], 0.3)[0], "it did not wait"
                began = time.monotonic()
                port = stack.enter_context(opened(made))
                time.sleep(0.1)
                termios.tcflush(port, termios.TCIFLUSH)  # As programs do that open a port.
                took = time.monotonic() - began
                if took > 0.4:
                    continue
                assert not termios.tcgetattr(port)[3] & (termios.ICANON | termios.ECHO)
                assert select.select([port], [], [], PATIENCE)[0]
                assert it.poll() is None, "it took the port away from its reader"
                assert read(port, 11) == STOP + b"?" + STOP
                assert line_of(it.stderr) == "11 bytes sent\n"

    def test_says_what_nobody_read(self, recording: str) -> None:
        args = ("replay", recording, "pty:", "--source", "pc", "--speed", "0")
        with started(*args) as it:
            made = line_of(it.stderr).split()[-1]
            line_of(it.stderr)
            with opened(made):
                assert line_of(it.stderr) == "the other end has not read all of it\n"

    def test_asks_whose_bytes_are_sent(self, recording: str) -> None:
        done = run("replay", recording, "pty:")
        assert done.exit_code == 2
        assert "give --source pc or --source esp" in done.stderr
        done = run("replay", recording, "pty:", "--source", "nobody")
        assert "has nothing of `nobody`" in done.stderr


@pytest.mark.parametrize(
    ("options", "problem"),
    [
        (("-o", "-"), "a recording is written to a file"),
        (("-o", "run.pgrec", "--max-size", "0"), "greater than or equal to"),
        (("-o", "run.pgrec", "--for", "-1"), "greater than or equal to"),
        (("-o", "run.pgrec", "--baud", "0"), "greater than or equal to"),
        (("-o", "no/such/run.pgrec"), "no/such/run.pgrec: No such file"),
    ],
)
def test_a_recording_that_can_not_be_is_told(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, options: tuple[str, ...], problem: str
) -> None:
    monkeypatch.chdir(tmp_path)
    done = run("record", MATTY, "pty:", *options)
    assert done.exit_code == 2
    assert problem in done.stderr
    assert list(tmp_path.iterdir()) == []


def test_a_full_disk_is_told_with_the_file() -> None:
    class Full(Recorder):
        def write(self, *args: Any, **settings: Any) -> None:
            raise OSError(errno.ENOSPC, "No space left on device")

    recorder = AnyRecorder(Full(io.BytesIO()), [Path("run.pgrec")])
    with pytest.raises(OSError, match=r"No space left on device: 'run\.pgrec'"):
        recorder.write(b"x", 0)


def test_a_pseudo_terminal_passes_control_characters(tmp_path: Path) -> None:
    """No byte is a signal, an end or a newline: the device that is made is raw."""
    with started("record", MATTY, "pty:", "-o", str(tmp_path / "run.pgrec")) as it:
        made = line_of(it.stderr).split()[-1]
        assert line_of(it.stderr).startswith("recording /dev/")
        port = os.open(made, os.O_RDWR | os.O_NOCTTY)
        assert not termios.tcgetattr(port)[3] & (termios.ICANON | termios.ECHO | termios.ISIG)
        os.write(port, bytes(range(256)))
        until(tmp_path / "run.pgrec", 8 + 16 + 256)
        stopped(it)
        os.close(port)
    assert b"".join(r.data for r in found_in(tmp_path / "run.pgrec")) == bytes(range(256))
