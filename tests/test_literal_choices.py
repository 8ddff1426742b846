"""Literals of which a frame has one, from the schema to every output."""

from __future__ import annotations

import json
from types import ModuleType
from typing import Any

import pytest
from cli_support import run
from compiled import ROOT, module_at, protocol_of
from markdown_pages import page
from passes_support import HEAD, compile_text
from passes_support import protocol_of as model_of

from protogen.model.framing import StartSet
from protogen.runtime.api import EncodeError

ADDRESSES = ROOT / "tests" / "framings" / "several_addresses.yaml"
SYNCS = ROOT / "tests" / "framings" / "several_syncs.yaml"
ENGINES = ["fast", "construct"]


@pytest.fixture(scope="module")
def addresses() -> ModuleType:
    return module_at(ADDRESSES)


@pytest.mark.parametrize("engine", ENGINES)
def test_an_encoder_writes_the_default_or_what_it_is_given(addresses: Any, engine: str) -> None:
    ping = addresses.Ping()
    assert addresses.encode(ping, engine=engine) == bytes.fromhex("C8 02 00 00")
    assert addresses.encode(ping, engine=engine, address=0xEE) == bytes.fromhex("EE 02 00 00")


@pytest.mark.parametrize("engine", ENGINES)
@pytest.mark.parametrize("strict", [True, False])
def test_an_encoder_refuses_what_no_receiver_takes(
    addresses: Any, engine: str, strict: bool
) -> None:
    with pytest.raises(EncodeError, match="address: 201 is not one of 0xC8, 0xEA, 0xEE"):
        addresses.encode(addresses.Ping(), strict=strict, engine=engine, address=0xC9)


def test_without_a_default_one_has_to_be_given() -> None:
    module = module_at(SYNCS)
    with pytest.raises(EncodeError, match=r"side: the value is missing.*side=76"):
        module.encode(module.Ping())


def test_a_line_of_json_says_which_one_it_was(addresses: Any) -> None:
    wire = addresses.encode(addresses.Ping(), address=0xEA)
    (event,) = addresses.Decoder("station").feed(wire)
    line = event.as_json()
    assert line["parts"] == {"address": 0xEA, "id": 0}
    assert "raw" not in line
    assert addresses.PROTOCOL.encode_line(json.loads(json.dumps(line))) == wire


def test_the_reference_lists_them() -> None:
    text = page(protocol_of(SYNCS), "station_syncs.md")
    assert (
        "| `1B 02`, `1B 05` or `1C 1B` | One of these, which the sender chooses. `1B 05` by" in text
    )
    assert "| `4C` 'L' or `52` 'R' | One of these, which the sender chooses. |" in text


def test_explain_shows_which_one_it_is_and_which_ones_there_are() -> None:
    shown = run("explain", str(ADDRESSES), "--hex", "EA 02 00 00").output
    assert "address" in shown and "234" in shown
    wrong = run("explain", str(SYNCS), "--hex", "1B 02 4D 00 01 00 4C 1B 03").output
    assert "must be 4C or 52" in wrong


FRAME = """\
frame:
  start: {literal: {any_of: [0x10, 0x11]}}
  payload: {}
  sum: {type: uint8, algorithm: sum-8, covers: payload}
"""
MESSAGE = "messages: {m: {from: robot, fields: {a: uint8}}}\n"


def test_a_start_is_protected_where_none_of_them_occurs_in_data() -> None:
    stuffed = "transparency: {escape: {byte: 0x20, of: [0x10, 0x11, 0x20], transform: invert}}\n"
    framing = model_of(HEAD + FRAME + stuffed + MESSAGE).sender("robot").framing
    assert framing.start == StartSet(words=(b"\x10", b"\x11"), protected=True)
    assert framing.finds_start == "at a byte 10 to 11, which occurs nowhere else in a frame"


def test_a_start_that_is_protected_in_part_is_not() -> None:
    stuffed = "transparency: {escape: {byte: 0x20, of: [0x10, 0x20], transform: invert}}\n"
    (problem,) = compile_text(HEAD + FRAME + stuffed + MESSAGE).problems
    assert problem.code == "PG142"
    assert "11" in problem.message


def test_a_wrong_byte_may_make_one_literal_of_another() -> None:
    undetected = protocol_of(SYNCS).sender("station").framing.undetected
    words = "a wrong `sync` that makes it another of its literals: no checksum covers it"
    assert words in undetected
    assert not any("side" in sentence or "mark" in sentence for sentence in undetected)
