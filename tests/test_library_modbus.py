"""Modbus RTU, beside pymodbus."""

from __future__ import annotations

from random import Random

import pytest
from compiled import module_at
from library_support import compare_frames, compare_recovery, encoded
from modbus_peer import ENDPOINTS, Pymodbus, cases_from

from protogen.library import FOLDER

PEER = "pymodbus"


@pytest.fixture(scope="module")
def peer() -> Pymodbus:
    return Pymodbus("rtu")


@pytest.mark.parametrize("endpoint", ENDPOINTS)
def test_both_make_and_read_the_same_frames(peer: Pymodbus, endpoint: str) -> None:
    compare_frames("modbus", peer, cases_from("modbus", endpoint))


@pytest.mark.parametrize("message", ["diagnostics", "encapsulated_interface"])
def test_both_make_and_read_the_same_requests_of_many_kinds(peer: Pymodbus, message: str) -> None:
    compare_frames("modbus", peer, cases_from("modbus", "client", [message]))


@pytest.mark.parametrize(
    "message",
    [
        "diagnostics_response",
        "encapsulated_interface_response",
        "exception_response",
        "file_record",
    ],
)
def test_both_make_and_read_the_same_responses_of_many_kinds(peer: Pymodbus, message: str) -> None:
    compare_frames("modbus", peer, cases_from("modbus", "server", [message]))


@pytest.mark.parametrize("endpoint", ENDPOINTS)
def test_all_function_codes_are_compared(endpoint: str) -> None:
    sender = module_at(FOLDER / "modbus.yaml").PROTOCOL.sender(endpoint)
    codes = {encoded("modbus", case)[1] for case in cases_from("modbus", endpoint)}
    public = {1, 2, 3, 4, 5, 6, 7, 8, 11, 12, 15, 16, 17, 20, 21, 22, 23, 24, 43}
    assert codes & set(range(128)) == public
    assert sender.frame.silence == 77 / 2 / 19200  # 3.5 characters of eleven bits


@pytest.mark.parametrize("endpoint", ENDPOINTS)
def test_no_frame_is_lost_that_it_finds(peer: Pymodbus, endpoint: str) -> None:
    compare_recovery("modbus", endpoint, peer, cases_from("modbus", endpoint))


@pytest.mark.parametrize("endpoint", ENDPOINTS)
def test_no_frame_behind_noise_is_lost_that_it_finds(peer: Pymodbus, endpoint: str) -> None:
    dice = Random(endpoint)
    decoder = module_at(FOLDER / "modbus.yaml").Decoder(endpoint)
    theirs = 0
    for case in cases_from("modbus", endpoint):
        frame = encoded("modbus", case)
        burst = dice.randbytes(dice.randrange(1, 8)) + frame
        events = [*decoder.feed(burst), *decoder.idle()]
        assert events[-1].raw == frame
        theirs += frame in peer.found(endpoint, burst)
    assert theirs  # It goes on behind noise that begins as no message of its.


def test_requests_and_responses_of_one_line_are_told_apart() -> None:
    decoder = module_at(FOLDER / "modbus.yaml").Decoder()
    seen = []
    for frame in ("11 03 00 6B 00 03 76 87", "11 83 02 C1 34"):  # The CRC of 11 83 02 is 34C1.
        (event,) = [*decoder.feed(bytes.fromhex(frame)), *decoder.idle()]
        seen.append((event.sender, event.message.NAME))
    assert seen == [("client", "read_holding_registers"), ("server", "exception_response")]
