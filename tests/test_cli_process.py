"""The command line as a process: how it starts, ends, and behaves on a terminal."""

from __future__ import annotations

import os
import pty
import signal
import subprocess
import sys
import time
from collections.abc import Callable
from pathlib import Path

import pytest
from cli_support import PATIENCE, ROOT, run, start

from protogen.cli.exits import guarded
from protogen.version import VERSION

MATTY = str(ROOT / "schemas" / "matty.yaml")
GPS = "55 03 00 50 E9 C4"
"""A sentence of one character, an e with an acute accent: 03 50 E9 add up to 3C."""
COMMANDS = ("check", "generate", "decode", "encode", "explain", "fuzz", "schema-json")


# --- start ----------------------------------------------------------------------------------------


def test_version() -> None:
    result = start("--version")
    assert (result.returncode, result.stdout.decode()) == (0, f"protogen {VERSION}\n")
    assert run("--version").output == f"protogen {VERSION}\n"


def test_help_names_every_command() -> None:
    result = run("--help")
    assert result.exit_code == 0
    assert all(f"\n  {command} " in result.output for command in COMMANDS)


@pytest.mark.parametrize("command", COMMANDS)
def test_help_has_an_example(command: str) -> None:
    result = run(command, "--help")
    assert result.exit_code == 0
    assert f"Example: protogen {command} " in result.output


@pytest.mark.parametrize("command", [command for command in COMMANDS if command != "generate"])
def test_examples_of_help_work(command: str) -> None:
    text = run(command, "--help").output.split("Example: protogen ")[1]
    arguments = text.replace("1000", "10").split()
    if command == "schema-json":
        arguments = [*arguments, "--check"]
    assert run(*arguments).exit_code == 0


def test_without_a_command() -> None:
    result = run()
    assert result.exit_code == 2
    assert "Usage:" in result.output


def test_shells_can_complete() -> None:
    words = {"_PROTOGEN_COMPLETE": "complete_bash", "COMP_WORDS": "protogen de", "COMP_CWORD": "1"}
    command = [sys.executable, "-c", "from protogen.cli import app; app(prog_name='protogen')"]
    result = subprocess.run(
        command, capture_output=True, env={**os.environ, **words}, cwd=ROOT, check=False
    )
    assert result.stdout.split() == [b"decode"]


HEAVY = ("protogen.model.protocol", "pydantic", "construct", "jinja2", "yaml", "rich")


@pytest.mark.parametrize("option", ["--help", "--version"])
def test_nothing_heavy_is_imported_to_help(option: str) -> None:
    code = (
        "import sys; from protogen.cli import app; app([sys.argv[1]], standalone_mode=False);"
        f"print([name for name in {HEAVY} if name in sys.modules])"
    )
    result = subprocess.run(
        [sys.executable, "-c", code, option], capture_output=True, cwd=ROOT, check=True
    )
    assert result.stdout.splitlines()[-1] == b"[]"


def test_characters_that_the_terminal_lacks() -> None:
    result = start("decode", MATTY, "--sender", "esp", "--hex", GPS, PYTHONIOENCODING="ascii")
    assert result.returncode == 0
    result = start("check", MATTY, PYTHONIOENCODING="ascii")
    assert result.returncode == 0


# --- end ------------------------------------------------------------------------------------------


def ended(command: Callable[[], int]) -> int:
    """Return the code that a command ends with."""
    import typer

    with pytest.raises(typer.Exit) as caught:
        guarded(command)()
    return int(caught.value.exit_code)


def crash() -> int:
    raise IndexError("no such thing")


def test_a_bug_says_that_it_is_one(capsys: pytest.CaptureFixture[str]) -> None:
    assert ended(crash) == 70
    text = capsys.readouterr().err
    assert "this is a bug in protogen: IndexError: no such thing" in text
    assert "Please report it" in text
    assert "Traceback" not in text


def test_a_bug_shows_its_place_if_asked(
    capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("PROTOGEN_DEBUG", "1")
    assert ended(crash) == 70
    text = capsys.readouterr().err
    assert "Traceback" in text
    assert "in crash" in text


def test_a_file_that_can_not_be_written_is_no_bug(tmp_path: Path) -> None:
    result = run("schema-json", "-o", str(tmp_path / "nowhere" / "a.json"))
    assert result.exit_code == 2
    assert "nowhere/a.json: No such file or directory" in result.stderr


def test_an_error_of_the_system_without_a_file(capsys: pytest.CaptureFixture[str]) -> None:
    def full() -> int:
        raise OSError(28, "No space left on device")

    assert ended(full) == 2
    assert capsys.readouterr().err == "error: No space left on device\n"


def test_interrupt() -> None:
    def interrupted() -> int:
        raise KeyboardInterrupt

    assert ended(interrupted) == 130


def launch(*arguments: str) -> subprocess.Popen[bytes]:
    return subprocess.Popen(
        [sys.executable, "-m", "protogen", *arguments],
        stdin=subprocess.PIPE,
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        cwd=ROOT,
    )


def test_interrupt_of_a_process_that_waits_for_input() -> None:
    process = launch("decode", MATTY, "--sender", "pc")
    assert process.stdin is not None
    assert process.stdout is not None
    process.stdin.write(bytes.fromhex("55020153AA"))
    process.stdin.flush()
    # The frame is shown before the input ends.
    assert process.stdout.readline().split() == [b"0", b"stop", b"@counter=1"]
    process.send_signal(signal.SIGINT)
    output, errors = process.communicate(timeout=PATIENCE)
    assert (process.returncode, output, errors) == (130, b"", b"")


def test_reader_that_goes_away() -> None:
    process = launch("decode", MATTY, "--sender", "pc")
    assert process.stdin is not None
    assert process.stdout is not None
    process.stdout.close()
    try:
        process.stdin.write(bytes.fromhex("55020153AA") * 50_000)
        process.stdin.close()
    except BrokenPipeError:
        pass
    assert process.wait(timeout=PATIENCE) == 141
    assert process.stderr is not None
    assert process.stderr.read() == b""
    process.stderr.close()


@pytest.mark.skipif(not Path("/proc/self/status").exists(), reason="Linux says how much was used")
def test_memory_does_not_grow_with_the_capture(tmp_path: Path) -> None:
    """The peak of a capture of 4 MB is that of half a MB, but for a little."""
    peaks = []
    for count in (2_000, 16_000):
        file = tmp_path / f"{count}.bin"
        file.write_bytes((bytes.fromhex("55020153AA") + b"\0" * 251) * count)
        code = (
            "import sys; from protogen.cli import app;"
            "app(sys.argv[1:], standalone_mode=False);"
            "[sys.stderr.write(line) for line in open('/proc/self/status') if 'VmHWM' in line]"
        )
        result = subprocess.run(
            [sys.executable, "-c", code, "decode", MATTY, str(file), "--sender", "pc"],
            capture_output=True,
            cwd=ROOT,
            check=True,
        )
        peaks.append(int(result.stderr.split()[1]))
    assert peaks[1] - peaks[0] < 2_000


# --- terminals ------------------------------------------------------------------------------------


def on_terminal(*arguments: str, **environment: str) -> str:
    """Run a command whose output and errors are a terminal; return what it shows."""
    ours, theirs = pty.openpty()
    process = subprocess.Popen(
        [sys.executable, "-m", "protogen", *arguments],
        stdin=subprocess.DEVNULL,
        stdout=theirs,
        stderr=theirs,
        cwd=ROOT,
        env={**os.environ, "TERM": "xterm", **environment},
    )
    os.close(theirs)
    shown = b""
    while piece := read(ours):
        shown += piece
    os.close(ours)
    assert process.wait(timeout=PATIENCE) is not None
    return shown.decode()


def read(terminal: int) -> bytes:
    try:
        return os.read(terminal, 4096)
    except OSError:  # the other side is closed
        return b""


def test_colour_on_a_terminal() -> None:
    shown = on_terminal("decode", MATTY, "--sender", "pc", "--hex", "00 55 02 01 53 AA")
    assert "\x1b[1;31minvalid" in shown
    assert "\x1b[1;36mstop" in shown


def test_no_colour_if_asked() -> None:
    shown = on_terminal(
        "decode", MATTY, "--sender", "pc", "--hex", "00 55 02 01 53 AA", NO_COLOR="1"
    )
    assert "invalid" in shown
    assert "\x1b" not in shown


def test_progress_on_a_terminal() -> None:
    shown = on_terminal("fuzz", MATTY, "--examples", "50", "--seed", "1")
    assert "matty through 3 engines" in shown or "matty through 2 engines" in shown
    assert "all came back (seed 1)" in shown


def test_no_progress_elsewhere() -> None:
    result = start("fuzz", MATTY, "--examples", "50", "--seed", "1")
    assert result.stderr == b""


def test_progress_of_a_file_if_the_events_go_elsewhere(tmp_path: Path) -> None:
    capture = tmp_path / "capture.bin"
    capture.write_bytes(bytes.fromhex("55020153AA") * 20_000)
    ours, theirs = pty.openpty()
    with (tmp_path / "events").open("wb") as events:
        process = subprocess.Popen(
            [sys.executable, "-m", "protogen", "decode", MATTY, str(capture), "--sender", "pc"],
            stdout=events,
            stderr=theirs,
            cwd=ROOT,
            env={**os.environ, "TERM": "xterm"},
        )
    os.close(theirs)
    shown = b""
    while piece := read(ours):
        shown += piece
    os.close(ours)
    assert process.wait(timeout=PATIENCE) == 0
    assert b"reading" in shown
    assert (tmp_path / "events").read_bytes().count(b"\n") == 20_000


def test_progress_does_not_disturb_events_on_the_same_terminal(tmp_path: Path) -> None:
    capture = tmp_path / "capture.bin"
    capture.write_bytes(bytes.fromhex("55020153AA"))
    shown = on_terminal("decode", MATTY, str(capture), "--sender", "pc", NO_COLOR="1")
    assert shown.split() == ["0", "stop", "@counter=1"]


def test_lines_of_json_are_not_awaited_from_a_terminal() -> None:
    ours, theirs = pty.openpty()
    result = subprocess.run(
        [sys.executable, "-m", "protogen", "encode", MATTY],
        stdin=theirs,
        capture_output=True,
        cwd=ROOT,
        check=False,
        timeout=PATIENCE,
    )
    os.close(ours)
    os.close(theirs)
    assert result.returncode == 2
    assert b"name one, or pipe lines of JSON in" in result.stderr


def test_names_of_files_need_no_locale(tmp_path: Path) -> None:
    """A bare container has the locale C, and Python may be told to take it at its word."""
    schema = tmp_path / "m\u00f6we.yaml"
    schema.write_bytes(Path(MATTY).read_bytes())
    (tmp_path / "protogen.toml").write_text('schemas = ["m\u00f6we.yaml"]\n', encoding="utf-8")
    bare = {"LC_ALL": "C", "PYTHONCOERCECLOCALE": "0", "PYTHONUTF8": "0"}
    for arguments in (["generate"], ["generate", "--check"], ["lock"], ["check", "m\u00f6we.yaml"]):
        done = subprocess.run(
            [sys.executable, "-m", "protogen", *arguments],
            env={**os.environ, **bare},
            cwd=tmp_path,
            capture_output=True,
            check=False,
            timeout=PATIENCE,
        )
        assert done.returncode == 0, done.stderr
    made = (tmp_path / "generated" / "python" / "matty.py").read_text(encoding="utf-8")
    assert " from m\u00f6we.yaml (spec" in made.splitlines()[0]
    assert '"m\u00f6we.yaml"' in (tmp_path / "protogen.lock").read_text(encoding="utf-8")


def test_a_live_stream_is_shown_as_it_comes() -> None:
    process = launch("decode", MATTY, "--sender", "pc", "--format", "jsonl")
    assert process.stdin is not None
    assert process.stdout is not None
    for _ in range(3):
        process.stdin.write(bytes.fromhex("55020153AA"))
        process.stdin.flush()
        assert b'"stop"' in process.stdout.readline()
        time.sleep(0.01)
    process.stdin.close()
    assert process.wait(timeout=PATIENCE) == 0
    process.stdout.close()
    assert process.stderr is not None
    process.stderr.close()
