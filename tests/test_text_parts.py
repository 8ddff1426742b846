"""Parts of the frame that are texts, from the schema to every output."""

from __future__ import annotations

import json
import subprocess
from pathlib import Path
from types import ModuleType
from typing import Any

import pytest
from c_library import write_sources
from cli_support import run
from compiled import ROOT, module_at, protocol_of
from markdown_pages import page
from passes_support import HEAD, compile_text
from tooling import require_tool

from protogen.runtime.api import EncodeError

SCHEMA = ROOT / "tests" / "framings" / "text_parts.yaml"
BOUNDED = ROOT / "tests" / "framings" / "bounded_texts.yaml"
ENGINES = ["fast", "construct"]
PING = bytes.fromhex("24 57 49 50 49 4E 2A 41 22 0D 0A")
"""Of the station WI, with *A: worked out in tests/vectors/text_parts.yaml."""


@pytest.fixture(scope="module")
def station() -> ModuleType:
    return module_at(SCHEMA)


@pytest.mark.parametrize("engine", ENGINES)
def test_an_encoder_writes_the_default_or_what_it_is_given(station: Any, engine: str) -> None:
    ping = station.Ping()
    assert station.encode(ping, engine=engine) == PING
    assert station.encode(ping, engine=engine, talker="WI", state="*A") == PING
    assert station.Encoder("station").encode(ping, talker="WI") == PING
    wire = station.encode(ping, engine=engine, talker="G")
    (event,) = station.Decoder("station", engine=engine).feed(wire)
    assert (event.parts.talker, event.parts.name, event.parts.state) == ("G", "PIN", "*A")


@pytest.mark.parametrize("engine", ENGINES)
@pytest.mark.parametrize("strict", [True, False])
@pytest.mark.parametrize(
    ("parts", "words"),
    [
        ({"talker": "GPS"}, "talker: 'GPS' has 3 characters, and 2 fit"),
        ({"talker": 0x4750}, "talker: must be a text of 2 characters, not 18256"),
        ({"talker": "漢"}, "talker: '漢' has a character that is not one byte"),
        ({"state": "*B"}, "state: 10818 is not one of"),
        ({"name": "MWV"}, "name: 'MWV' is not ping, whose name is 'PIN'"),
    ],
)
def test_another_text_is_refused(
    station: Any, engine: str, strict: bool, parts: Any, words: str
) -> None:
    with pytest.raises(EncodeError, match=words.replace("*", r"\*")):
        station.encode(station.Ping(), strict=strict, engine=engine, **parts)


@pytest.mark.parametrize("engine", ENGINES)
def test_only_lenient_encoding_takes_what_is_not_ascii(station: Any, engine: str) -> None:
    with pytest.raises(EncodeError, match="talker: 'Gÿ' has a character that is not ASCII"):
        station.encode(station.Ping(), engine=engine, talker="Gÿ")
    wire = station.encode(station.Ping(), strict=False, engine=engine, talker="Gÿ")
    (event,) = station.Decoder("station", engine=engine).feed(wire)
    assert event.parts.talker == "Gÿ"


@pytest.mark.parametrize("engine", ENGINES)
@pytest.mark.parametrize("tag", ["aBc", "ab", "a{b", "ab\0"])
def test_a_text_has_its_characters_in_range(engine: str, tag: str) -> None:
    module: Any = module_at(BOUNDED)
    assert module.encode(module.Ping(), engine=engine, tag="zaz")[1:4] == b"zaz"
    for strict in (True, False):  # A receiver refuses others, as a start can stand in the data.
        with pytest.raises(EncodeError, match="is not a text of 3 characters from a to z"):
            module.encode(module.Ping(), strict=strict, engine=engine, tag=tag)


def test_lines_of_json_have_the_texts(station: Any) -> None:
    wire = station.encode(station.Note(text="A"), name="NOT", talker="GP", state="*V")
    (event,) = station.Decoder("station").feed(wire)
    line = event.as_json()
    assert line["parts"] == {"talker": "GP", "name": "NOT", "state": "*V"}
    assert "raw" not in line
    assert station.PROTOCOL.encode_line(json.loads(json.dumps(line))) == wire
    unknown = station.PROTOCOL.encode_unknown(
        "station", {"talker": "GP", "name": "NOP", "state": "*V"}, b""
    )
    (event,) = station.Decoder("station").feed(unknown)
    assert (event.kind, event.parts.name) == ("unknown", "NOP")
    assert station.PROTOCOL.encode_line(event.as_json()) == unknown


def test_an_unknown_frame_needs_its_text(station: Any) -> None:
    with pytest.raises(EncodeError, match="name: an unknown frame needs"):
        station.PROTOCOL.encode_unknown("station", {"talker": "GP", "state": "*V"}, b"")
    with pytest.raises(EncodeError, match="name: 'NAME' has 4 characters, and 3 fit"):
        station.PROTOCOL.encode_unknown("station", {"name": "NAME"}, b"")


def test_the_identity_of_a_class_is_the_number(station: Any) -> None:
    assert station.Ping.IDENTITY == (0x50494E,)
    assert (0x4E4F54,) in station.Note.IDENTITIES


def test_the_construct_declaration_shows_texts(station: Any) -> None:
    found = station.STATION_FORMAT.parse(PING)
    assert (found.talker, found.name, found.state) == ("WI", "PIN", "*A")


def test_the_command_line_takes_and_shows_them() -> None:
    made = run("encode", str(SCHEMA), "ping", "@talker=WI", '@state="*A"').output
    assert bytes.fromhex(made) == PING
    shown = run("decode", str(SCHEMA), "--sender", "station", "--hex", PING.hex()).output
    assert '@talker="WI"' in shown and '@state="*A"' in shown
    explained = run("explain", str(SCHEMA), "--sender", "station", "--hex", PING.hex()).output
    assert '"PIN"' in explained and "ascii" in explained


def test_the_reference_has_them() -> None:
    text = page(protocol_of(SCHEMA), "sentences.md")
    assert "`50 49 4E` 'PIN' ping" in text
    assert "| `ascii` | `talker` | 2 characters |" in text
    assert "`57 49` 'WI' by default." in text


def test_captures_have_columns_of_text(tmp_path: Path) -> None:
    capture = pytest.importorskip("protogen.capture")
    pytest.importorskip("numpy")
    for engine in ("python", "native"):
        tables = capture.columns(PING + PING, str(SCHEMA), sender="station", engine=engine)
        rows = tables.messages["ping"]
        assert rows["talker"].tolist() == [b"WI", b"WI"]
        assert rows["name"].tolist() == [b"PIN", b"PIN"]


PROGRAM = """\
#include <string.h>
#include "sentences.h"

int main(void) {
    char text[9] = "????????";
    sentences_characters_3(SENTENCES_PING_ID, text);
    if (memcmp(text, "PIN\\0????", 8) != 0) {
        return 1;
    }
    if (sentences_text_3("PIN") != 0x50494EU || sentences_text_2("W") != 0x5700U) {
        return 2;
    }
    sentences_characters_2(0x5700U, text);
    return strcmp(text, "W") == 0 && sentences_text_2("\\xFF\\xFE!") == 0xFFFEU ? 0 : 3;
}
"""


def test_c_makes_texts_of_numbers_and_numbers_of_texts(tmp_path: Path) -> None:
    write_sources(protocol_of(SCHEMA), tmp_path)
    (tmp_path / "main.c").write_text(PROGRAM)
    program = tmp_path / "main"
    flags = ["-std=c99", "-Wall", "-Wextra", "-Werror", "-fsanitize=undefined,address"]
    sources = [tmp_path / "main.c", tmp_path / "sentences.c"]
    compiler = require_tool("cc")
    subprocess.run([compiler, *flags, *sources, "-o", program], check=True)
    assert subprocess.run([program], check=False).returncode == 0


def test_a_fixed_literal_is_no_text() -> None:
    frame = "frame: {start: {literal: 0x41, size: 1}, payload: {}, end: {literal: 0xC0}}\n"
    problems = compile_text(HEAD + frame + "messages: {m: {from: robot}}\n").problems
    assert "`size` does not go together with `literal`" in [item.message for item in problems]
