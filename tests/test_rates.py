"""How often messages are sent by themselves: what a schema says of it, and who goes by it."""

from __future__ import annotations

import json
from fractions import Fraction
from pathlib import Path

import pytest
from cli_support import run
from passes_support import protocol_of

from protogen.model.load import line_load
from protogen.model.protocol import Protocol
from protogen.targets.markdown.pages.page import page_view
from protogen.targets.markdown.text.words import how_often

SCHEMA = """\
protocol: rig
endpoints: {{host: Host, board: Board}}
link: {{baud: 9600}}
frame:
  kind: {{type: uint8, id: true}}
  payload: {{}}
  pad: {{type: uint8, algorithm: sum-8, covers: kind..payload}}
  end: {{literal: 0xC0}}
transparency: slip
messages:
  ping: {{id: 1, from: host}}
  state: {{id: 2, from: [host, board]{rate}, fields: {{n: {{type: uint8, range: [0, 9]}}}}}}
  more: {{id: 3, from: board{rate}}}
"""


def rig(rate: str, baud: int = 9600) -> Protocol:
    text = SCHEMA.format(rate=f", rate: {rate}" if rate else "")
    return protocol_of(text.replace("9600", str(baud)))


@pytest.mark.parametrize(
    ("written", "hertz", "words"),
    [
        ("50 Hz", 50, "50 times a second"),
        ("50Hz", 50, "50 times a second"),
        ("50", 50, "50 times a second"),
        ("1", 1, "once a second"),
        ("1.5 kHz", 1500, "1500 times a second"),
        ("0.1", Fraction(1, 10), "every 10 s"),
        ("1e-2", Fraction(1, 100), "every 100 s"),
        ("1/60", Fraction(1, 60), "every 60 s"),
        ("12.8", Fraction(64, 5), "every 78.125 ms"),
        ("20 ms", 50, "50 times a second"),
        ("3 ms", Fraction(1000, 3), "every 3 ms"),
        ("500 us", 2000, "2000 times a second"),
        ("2.5 s", Fraction(2, 5), "every 2.5 s"),
        ("1.1", Fraction(11, 10), "1.1 times a second"),
    ],
)
def test_is_a_frequency_or_a_time(written: str, hertz: Fraction, words: str) -> None:
    assert rig(written, baud=1_000_000).message("state").rate == hertz
    assert how_often(Fraction(hertz)) == words


def test_is_no_layout() -> None:
    plain, rated = rig(""), rig("50 Hz")
    assert plain.spec_hash == rated.spec_hash
    assert plain.message("state").rate is None


def test_the_line_is_as_busy_as_its_frames_take() -> None:
    protocol = rig("20 ms")
    # A state has 4 bytes of 10 bits each, or 5 if its sum is escaped, and `more` has 3.
    host, board = (line_load(protocol, name) for name in ("host", "board"))
    assert host is not None
    assert board is not None
    assert (host.least, host.greatest) == (Fraction(40 * 50, 9600), Fraction(50 * 50, 9600))
    assert (board.least, board.greatest) == (Fraction(70 * 50, 9600), Fraction(80 * 50, 9600))
    assert (host.shown, board.shown) == ("21 to 27 %", "37 to 42 %")
    assert line_load(rig(""), "host") is None


def test_is_shown(tmp_path: Path) -> None:
    path = tmp_path / "rig.yaml"
    path.write_text(SCHEMA.format(rate=", rate: 20 ms"))
    shown = run("check", str(path))
    assert (shown.exit_code, "busy line           37 to 42 %, with the rates" in shown.stdout) == (
        0,
        True,
    )
    (report,) = json.loads(run("check", str(path), "--format", "json").stdout)["protocols"]
    assert set(report["busy"]) == {"host", "board"}
    assert report["busy"]["host"] == {"least": 0.208333, "greatest": 0.260417}
    page = page_view(rig("20 ms"))
    busy = "What `board` sends by itself keeps the line busy for 37 to 42 % of the time."
    assert busy in page["link"]
    assert [message["facts"][0] for message in page["messages"][1:]] == [
        "sent 50 times a second"
    ] * 2


def test_is_no_breaking_change(tmp_path: Path) -> None:
    for name, rate in (("old", ""), ("new", ", rate: 5 Hz")):
        (tmp_path / f"{name}.yaml").write_text(SCHEMA.format(rate=rate))
    done = run("diff", str(tmp_path / "old.yaml"), str(tmp_path / "new.yaml"))
    assert done.exit_code == 0
