"""Modbus RTU, beside pymodbus."""

from __future__ import annotations

from itertools import count
from random import Random

import pytest
from compiled import module_at, protocol_of
from library_support import cases_of, compare_frames, compare_recovery, encoded
from modbus_peer import ENDPOINTS, Pymodbus, bits_of, bytes_of, is_read

from protogen.copying import replace
from protogen.fuzzing.trips import Case
from protogen.library import FOLDER

PEER = "pymodbus"


def understood(case: Case) -> Case:
    """The case, with what pymodbus makes of it: less than the document leaves open."""
    values = case.values
    if case.message == "write_multiple_coils":
        states = bits_of(values["coils"]["states"])[: values["quantity"]]
        values = {**values, "coils": {"states": bytes_of(states).hex()}}
    elif "state" in values:
        values = {**values, "state": 0 if values["state"] % 2 else 0xFFFF}
    elif case.message == "server_id":
        data = values["data"][:-2] + ("ff" if values["bytes"] % 2 else "00")
        values = {"bytes": len(data) // 2, "data": data}
    elif "objects" in values.get("data", ()):
        objects = {item["id"]: item for item in values["data"]["objects"]}
        data = {**values["data"], "count": len(objects), "objects": list(objects.values())}
        values = {**values, "data": data}
    return replace(case, values=values)


def cases_from(endpoint: str, messages: list[str]) -> list[Case]:
    """Values that pymodbus can say, of which it also reads 500 at least."""
    drawn: list[Case] = []
    seeds = count(1)
    while sum(map(is_read, drawn)) < 500:
        cases = cases_of("modbus", messages, next(seeds))
        drawn += [understood(case) for case in cases if case.sender == endpoint]
    return drawn


def messages_from(endpoint: str) -> list[str]:
    protocol = protocol_of(FOLDER / "modbus.yaml")
    return [message.name for message in protocol.sender(endpoint).messages]


@pytest.fixture(scope="module")
def peer() -> Pymodbus:
    return Pymodbus()


@pytest.mark.parametrize("endpoint", ENDPOINTS)
def test_both_make_and_read_the_same_frames(peer: Pymodbus, endpoint: str) -> None:
    compare_frames("modbus", peer, cases_from(endpoint, messages_from(endpoint)))


@pytest.mark.parametrize("message", ["diagnostics", "encapsulated_interface"])
def test_both_make_and_read_the_same_requests_of_many_kinds(peer: Pymodbus, message: str) -> None:
    compare_frames("modbus", peer, cases_from("client", [message]))


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
    compare_frames("modbus", peer, cases_from("server", [message]))


@pytest.mark.parametrize("endpoint", ENDPOINTS)
def test_all_function_codes_are_compared(endpoint: str) -> None:
    sender = module_at(FOLDER / "modbus.yaml").PROTOCOL.sender(endpoint)
    codes = {encoded("modbus", case)[1] for case in cases_from(endpoint, messages_from(endpoint))}
    public = {1, 2, 3, 4, 5, 6, 7, 8, 11, 12, 15, 16, 17, 20, 21, 22, 23, 24, 43}
    assert codes & set(range(128)) == public
    assert sender.frame.silence == 77 / 2 / 19200  # 3.5 characters of eleven bits


@pytest.mark.parametrize("endpoint", ENDPOINTS)
def test_no_frame_is_lost_that_it_finds(peer: Pymodbus, endpoint: str) -> None:
    compare_recovery("modbus", endpoint, peer, cases_from(endpoint, messages_from(endpoint)))


@pytest.mark.parametrize("endpoint", ENDPOINTS)
def test_no_frame_behind_noise_is_lost_that_it_finds(peer: Pymodbus, endpoint: str) -> None:
    dice = Random(endpoint)
    decoder = module_at(FOLDER / "modbus.yaml").Decoder(endpoint)
    theirs = 0
    for case in cases_from(endpoint, messages_from(endpoint)):
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
