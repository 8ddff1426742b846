"""MAVLink 1, beside pymavlink."""

from __future__ import annotations

import pytest
from library_support import cases_of, compare_frames, compare_recovery, engine_of
from mavlink_peer import Pymavlink, compare_definitions, frame_of

from protogen.fuzzing.trips import Case

HEARTBEAT = bytes([4, 0, 0, 0, 2, 3, 81, 4, 3])
EXTRA = 50
"""CRC_EXTRA of HEARTBEAT."""


@pytest.fixture(scope="module")
def pymavlink() -> Pymavlink:
    return Pymavlink("pymavlink.dialects.v10.common", "1")


@pytest.fixture(scope="module")
def drawn(pymavlink: Pymavlink) -> list[Case]:
    return [pymavlink.sent(case) for case in cases_of("mavlink1")]


def test_both_have_the_same_definitions(pymavlink: Pymavlink) -> None:
    compare_definitions("mavlink1", pymavlink)


def test_both_make_and_read_the_same_frames(pymavlink: Pymavlink, drawn: list[Case]) -> None:
    assert {case.message.upper() for case in drawn} == set(pymavlink.kinds)
    compare_frames("mavlink1", pymavlink, drawn)


def test_no_frame_is_lost_that_it_finds(pymavlink: Pymavlink, drawn: list[Case]) -> None:
    compare_recovery("mavlink1", "component", pymavlink, drawn)


@pytest.mark.parametrize(
    ("payload", "extra", "ours", "theirs"),
    [
        (HEARTBEAT, EXTRA, "message", "HEARTBEAT"),
        (HEARTBEAT, EXTRA + 1, "invalid", "BAD_DATA"),
        (HEARTBEAT[:7], EXTRA, "invalid", "HEARTBEAT"),  # decided: size_of_a_payload
        (HEARTBEAT + b"\1", EXTRA, "invalid", "HEARTBEAT"),  # decided: size_of_a_payload
    ],
)
def test_payloads_of_other_sizes_and_definitions(
    pymavlink: Pymavlink, payload: bytes, extra: int, ours: str, theirs: str
) -> None:
    frame = frame_of(pymavlink, "1", 0, payload, extra)
    assert engine_of("mavlink1").events("component", [frame])[0].kind == ours
    assert pymavlink.types_read(frame) == [theirs]


def test_messages_of_other_dialects_are_not_verified_by_it(pymavlink: Pymavlink) -> None:
    """Decided: messages_of_other_dialects."""
    frame = frame_of(pymavlink, "1", 150, b"\1", 134)
    assert engine_of("mavlink1").events("component", [frame])[0].kind == "invalid"
    assert pymavlink.types_read(frame) == ["UNKNOWN_150"]
