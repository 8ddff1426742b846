"""Modbus ASCII, beside pymodbus."""

from __future__ import annotations

from pathlib import Path

import pytest
from compiled import module_at
from library_support import compare_frames, compare_recovery, encoded, peer_module
from modbus_peer import ENDPOINTS, Pymodbus, cases_from

from protogen.library import FOLDER

NAME = "modbus_ascii"
PEER = "pymodbus"


@pytest.fixture(scope="module")
def peer() -> Pymodbus:
    return Pymodbus("ascii")


@pytest.mark.parametrize("endpoint", ENDPOINTS)
def test_both_make_and_read_the_same_frames(peer: Pymodbus, endpoint: str) -> None:
    compare_frames(NAME, peer, cases_from(NAME, endpoint))


@pytest.mark.parametrize("endpoint", ENDPOINTS)
def test_no_frame_is_lost_that_it_finds(peer: Pymodbus, endpoint: str) -> None:
    compare_recovery(NAME, endpoint, peer, cases_from(NAME, endpoint))


@pytest.mark.parametrize("endpoint", ENDPOINTS)
def test_digits_in_small_letters_are_read_too(peer: Pymodbus, endpoint: str) -> None:
    decoder = module_at(FOLDER / f"{NAME}.yaml").Decoder(endpoint)
    for case in cases_from(NAME, endpoint)[::5]:
        frame = encoded(NAME, case)
        (event,) = decoder.feed(frame.lower())
        assert case.message == event.message.NAME
        assert peer.values(case, frame.lower()) == case.values


def test_a_frame_that_is_broken_off_hides_none() -> None:
    whole = b":110600010003E5\r\n"
    *_, event = module_at(FOLDER / f"{NAME}.yaml").Decoder("client").feed(b":1106" + whole)
    assert event.raw == whole


DASHES = """\
protocol: dashes
extends: library:modbus_ascii
frame: {client: {end: &end {literal: {text: "\\r-"}}}, server: {end: *end}}
"""


@pytest.mark.parametrize("endpoint", ENDPOINTS)
def test_a_dialect_ends_lines_with_another_character(
    peer: Pymodbus, endpoint: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """pymodbus keeps the character in its control block, as a request changes it."""
    file = tmp_path / "dashes.yaml"
    file.write_text(DASHES)
    monkeypatch.setattr(peer_module("pymodbus.framer.ascii"), "_MCB", _Block)
    decoder = module_at(file).Decoder(endpoint)
    for case in cases_from(NAME, endpoint):
        frame = peer.frame(case)
        assert frame == encoded(NAME, case)[:-1] + b"-"
        (event,) = decoder.feed(frame)
        assert case.message == event.message.NAME
        assert peer.values(case, frame) == case.values


class _Block:
    Delimiter = b"-"


def test_lf_does_not_end_a_line_of_the_dialect(tmp_path: Path) -> None:
    file = tmp_path / "dashes.yaml"
    file.write_text(DASHES)
    whole = b":110600010003E5\r-"
    assert (
        module_at(file).encode(
            module_at(file).WriteSingleRegister(address=1, value=3), "client", address=17
        )
        == whole
    )
    *_, event = module_at(file).Decoder("client").feed(b":110600010003E5\r\n" + whole)
    assert event.raw == whole
