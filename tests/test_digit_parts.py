"""Numbers of frames that are digits, from the schema to every output."""

from __future__ import annotations

import json
from pathlib import Path
from types import ModuleType
from typing import Any

import pytest
from cli_support import run
from compiled import ROOT, module_at, protocol_of
from markdown_pages import page
from passes_support import compile_text

from protogen.live.codec import module_of
from protogen.runtime.api import EncodeError

SCHEMA = ROOT / "tests" / "framings" / "digit_parts.yaml"
ENGINES = ["fast", "construct"]
STATED = "digits: base16-upper, algorithm"
PING = b"$0A00000*41\r\n"
"""Address 0A, number 0: worked out in tests/vectors/digit_parts.yaml."""


@pytest.fixture(scope="module")
def station() -> ModuleType:
    return module_at(SCHEMA)


@pytest.mark.parametrize("engine", ENGINES)
def test_an_encoder_writes_digits(station: Any, engine: str) -> None:
    ping = station.Ping()
    assert station.encode(ping, engine=engine, number=0) == PING
    # 30 ^ 42 ^ 31 ^ 32 ^ 30 ^ 30 ^ 30: 0B, 12 and 000
    assert station.encode(ping, engine=engine, number=12, address=11) == b"$0B12000*41\r\n"
    (event,) = station.Decoder("station", engine=engine).feed(b"$0B12000*41\r\n")
    assert (event.parts.address, event.parts.number, event.parts.kind) == (11, 12, 0)


@pytest.mark.parametrize("engine", ENGINES)
@pytest.mark.parametrize(
    ("parts", "words"),
    [
        ({"number": 100}, r"number: 100 is not in 0\.\.99"),
        ({"number": -1}, r"number: -1 is not in 0\.\.99"),
        ({"number": 0, "address": 256}, r"address: 256 is not in 0\.\.255"),
        ({"number": "07"}, "number: must be an integer, not '07'"),
    ],
)
def test_a_number_that_the_digits_do_not_hold_is_refused(
    station: Any, engine: str, parts: Any, words: str
) -> None:
    with pytest.raises(EncodeError, match=words):
        station.encode(station.Ping(), engine=engine, **parts)


@pytest.mark.parametrize("engine", ENGINES)
def test_lenient_encoding_has_no_more_digits(station: Any, engine: str) -> None:
    with pytest.raises(EncodeError, match="number: 100 has more than 2 digits"):
        station.encode(station.Ping(), strict=False, engine=engine, number=100)


def test_a_counter_wraps_behind_its_digits(station: Any) -> None:
    encoder = station.Encoder("station")
    frames = [encoder.encode(station.Ping()) for _ in range(102)]
    numbers = [int(frame[3:5]) for frame in frames]
    assert numbers == [*range(100), 0, 1]


NOTES = """\
protocol: notes
endpoints: {host: Computer}
frame:
  start: {literal: 0xC0}
  length: {type: uint8, digits: base10, chars: 2, counts: length..sum}
  payload: {}
  sum: {type: uint8, digits: base16-lower, algorithm: sum-8, covers: payload}
  end: {literal: 0xC0}
transparency: slip
messages:
  note: {from: host, fields: {text: {type: bytes, size: {fill: true}}}}
"""


def test_digits_bound_the_payload_that_a_length_can_say() -> None:
    protocol = compile_text(NOTES).protocol
    assert protocol is not None
    # Two of the length itself and two of the sum leave 95 of 99.
    assert protocol.senders[0].framing.payload.greatest == 95
    module: Any = module_of(protocol)
    for engine in ENGINES:
        frame = module.encode(module.Note(text=b"\x01" * 95), engine=engine)
        assert frame == b"\xc099" + b"\x01" * 95 + b"5f\xc0"  # 95 = 5F
        with pytest.raises(EncodeError):
            module.encode(module.Note(text=b"\x01" * 96), engine=engine, strict=False)


def test_lines_of_json_have_numbers(station: Any) -> None:
    (event,) = station.Decoder("station").feed(PING)
    line = event.as_json()
    assert line["parts"] == {"address": 10, "number": 0, "kind": 0}
    assert "raw" not in line
    assert station.PROTOCOL.encode_line(json.loads(json.dumps(line))) == PING


def test_the_construct_declaration_has_numbers(station: Any) -> None:
    found = station.STATION_FORMAT.parse(PING)
    assert (found.address, found.number, found.kind) == (10, 0, 0)
    assert station.STATION_FORMAT.build(found) == PING


def test_the_command_line_takes_and_shows_them() -> None:
    made = run("encode", str(SCHEMA), "ping", "@number=0").output
    assert bytes.fromhex(made) == PING
    explained = run("explain", str(SCHEMA), "--sender", "station", "--hex", PING.hex()).output
    assert "uint8 as 2 digits base16-upper" in explained
    assert "uint10 as 3 digits base10" in explained


def test_the_reference_has_them() -> None:
    text = page(protocol_of(SCHEMA), "digit_parts.md")
    assert "| `uint8` as text, 2 decimal digits | `number` | 0..99 | Counts frames" in text
    assert "`uint8` as text, 2 hexadecimal digits (upper case) | `sum`" in text


def test_captures_have_columns_of_numbers() -> None:
    capture = pytest.importorskip("protogen.capture")
    pytest.importorskip("numpy")
    for engine in ("python", "native"):
        data = PING + b"$0B12000*41\r\n"
        tables = capture.columns(data, str(SCHEMA), sender="station", engine=engine)
        rows = tables.messages["ping"]
        assert rows["address"].tolist() == [10, 11]
        assert rows["number"].tolist() == [0, 12]


def test_digits_are_part_of_the_hash_only_where_there_are_some(tmp_path: Path) -> None:
    text = SCHEMA.read_text(encoding="utf-8")
    hashes = set()
    for digits in ("base16-upper", "base16-lower"):
        path = tmp_path / f"{digits}.yaml"
        path.write_text(
            text.replace("digits: base16-upper, algorithm", f"digits: {digits}, algorithm")
        )
        hashes.add(protocol_of(path).spec_hash)
    stated = tmp_path / "stated.yaml"
    stated.write_text(
        text.replace("digits: base16-upper, alg", "digits: base16-upper, chars: 2, alg")
    )
    hashes.add(protocol_of(stated).spec_hash)
    assert len(hashes) == 2
