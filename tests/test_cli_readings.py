"""Values in words: what `decode` prints, which `encode` reads again."""

from __future__ import annotations

import io
from fractions import Fraction
from pathlib import Path

import pytest
from cli_support import SINK, run

from protogen.cli.progress import progress
from protogen.model.reading.readings import decimal, physical
from protogen.model.types import Field, Integer


@pytest.fixture
def sink(tmp_path: Path) -> str:
    schema = tmp_path / "sink.yaml"
    schema.write_text(SINK)
    return str(schema)


def shown(schema: str, sender: str, message: str, *values: str) -> str:
    """Encode values, decode the frame, and return the line that is printed for it."""
    frame = run("encode", schema, message, *values, "--sender", sender)
    assert frame.exit_code == 0, frame.output
    lines = run("decode", schema, "--sender", sender, "--hex", frame.stdout).stdout.splitlines()
    assert len(lines) == 1
    return " ".join(lines[0].split()[1:])


def test_every_kind_of_number(sink: str) -> None:
    values = (
        "mode=run strict_mode=high angle=-90.5deg flags=ready|wet|0x40 control=0xC5 letter='N' "
        "on_line=true ratio=0.75V"
    )
    assert shown(sink, "pc", "numbers", *values.split()) == (
        "numbers @number=255 mode=run strict_mode=high angle=-90.5deg flags=ready|wet|0x40 "
        "control={speed=5, gear=rear} letter='N' on_line=true ratio=0.75V odd=66051"
    )


def test_values_without_a_name(sink: str) -> None:
    values = ("mode=9", "angle=missing", "control=0x80", "letter=7", "ratio=nan", "@number=1")
    assert shown(sink, "board", "numbers", *values) == (
        "numbers @number=1 mode=9 strict_mode=low angle=missing flags=0 "
        "control={speed=0, gear=2} letter=7 on_line=false ratio=nanV odd=66051"
    )


def test_lists_texts_and_bytes(sink: str) -> None:
    points = 'points=[{"x": -1, "y": 3}, {"x": 1, "y": 4}]'
    values = ("size=2", "levels=1,2", r'name="a\r\n"', "rest=text:\x1b|")
    assert shown(sink, "pc", "lists", points, *values) == (
        "lists @number=255 points=[{x=-1, y=3mm}, {x=1, y=4mm}] size=2 levels=[1, 2] "
        r'name="a\r\n" rest=hex:1b7c'
    )


def test_cases(sink: str) -> None:
    assert shown(sink, "board", "choice", "what=nothing").endswith("what=nothing value={}")
    assert shown(sink, "board", "choice", "what=speed", "value=3").endswith("value={value=3}")
    assert shown(sink, "board", "choice", "what=9", "value=AA").endswith("what=9 value=hex:aa")


@pytest.mark.parametrize(
    ("number", "text"),
    [
        (Fraction(3), "3"),
        (Fraction(-1, 2), "-0.5"),
        (Fraction(-1, 100), "-0.01"),
        (Fraction(1, 16), "0.0625"),
        (Fraction(100005, 100), "1000.05"),
        (Fraction(1, 3), "0.333333"),
        (Fraction(1, 1 << 20), "9.53674e-07"),
    ],
)
def test_decimals(number: Fraction, text: str) -> None:
    assert decimal(number) == text


def test_physical_values_are_exact() -> None:
    field = Field(
        name="x",
        type=Integer(bits=16),
        position=0,
        scale=Fraction(1, 100),
        offset=Fraction(-40),
        unit="degC",
    )
    assert physical(field, 6550) == "25.5degC"
    assert physical(field, 6550, gap=" ") == "25.5 degC"


def test_names_of_types(sink: str) -> None:
    from cli_support import compiled

    protocol = compiled(SINK)
    names = [field.type.label for field in protocol.message("lists").fields]
    assert names == ["lists_points[2]", "uint8", "uint16 big[size]", "ascii[4]", "bytes[fill]"]
    assert protocol.message("choice").fields[1].type.label == "switch(what)"
    assert protocol.message("numbers").fields[7].type.label == "float32 big"


# --- progress -------------------------------------------------------------------------------------


class Terminal(io.StringIO):
    """A stream that says that it is a terminal."""

    def isatty(self) -> bool:
        return True


def test_progress_is_shown_on_a_terminal(monkeypatch: pytest.MonkeyPatch) -> None:
    terminal = Terminal()
    monkeypatch.setattr("sys.stderr", terminal)
    monkeypatch.setenv("TERM", "xterm")
    with progress("counting", 2) as advance:
        advance(2)
    assert "counting" in terminal.getvalue()
    assert "2/2" in terminal.getvalue()


def test_progress_in_bytes(monkeypatch: pytest.MonkeyPatch) -> None:
    terminal = Terminal()
    monkeypatch.setattr("sys.stderr", terminal)
    monkeypatch.setenv("TERM", "xterm")
    with progress("reading", 2000, in_bytes=True) as advance:
        advance(2000)
    assert "2.0/2.0 kB" in terminal.getvalue()


def test_no_progress_beside_output_on_the_same_terminal(monkeypatch: pytest.MonkeyPatch) -> None:
    terminal = Terminal()
    monkeypatch.setattr("sys.stderr", terminal)
    monkeypatch.setattr("sys.stdout", terminal)
    with progress("reading", 2, shares_terminal=True) as advance:
        advance(2)
    assert terminal.getvalue() == ""


def test_no_progress_without_a_terminal(capsys: pytest.CaptureFixture[str]) -> None:
    with progress("reading", 2) as advance:
        advance(2)
    assert capsys.readouterr().err == ""
