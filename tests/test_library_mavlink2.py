"""MAVLink 2, beside pymavlink."""

from __future__ import annotations

from itertools import product

import pytest
from library_support import cases_of, compare_frames, compare_recovery, encoded, engine_of
from mavlink_peer import Pymavlink, compare_definitions, frame_of

from protogen.fuzzing.trips import Case

HEARTBEAT = bytes([4, 0, 0, 0, 2, 3, 81, 4, 3])
EXTRA = 50
"""CRC_EXTRA of HEARTBEAT."""


@pytest.fixture(scope="module")
def pymavlink() -> Pymavlink:
    return Pymavlink("pymavlink.dialects.v20.common", "2")


@pytest.fixture(scope="module")
def drawn(pymavlink: Pymavlink) -> list[Case]:
    """All cases without a signature, and each third one with one: payloads are alike in both."""
    cases = cases_of("mavlink2")
    plain = [case for case in cases if "signature" not in case.parts]
    signed = [case for case in cases if "signature" in case.parts]
    chosen = [*plain, *signed[::3]]
    assert len(chosen) >= 4000
    return [pymavlink.sent(case) for case in chosen]


def test_both_have_the_same_definitions(pymavlink: Pymavlink) -> None:
    compare_definitions("mavlink2", pymavlink)


def test_both_make_and_read_the_same_frames(pymavlink: Pymavlink, drawn: list[Case]) -> None:
    """All messages, signed and not."""
    kinds = {(case.message.upper(), case.sender) for case in drawn}
    assert kinds == set(product(pymavlink.kinds, ("component_unsigned", "component_signed")))
    compare_frames("mavlink2", pymavlink, drawn)


def test_zeros_are_left_out(drawn: list[Case]) -> None:
    """Frames of one message differ in size, down to a payload of one byte."""
    sizes = {
        len(encoded("mavlink2", case))
        for case in drawn
        if (case.message, case.sender) == ("param_value", "component_unsigned")
    }
    assert min(sizes) < max(sizes) == 12 + 25


def test_no_frame_is_lost_that_it_finds(pymavlink: Pymavlink, drawn: list[Case]) -> None:
    compare_recovery("mavlink2", "component", pymavlink, drawn[::2])


@pytest.mark.parametrize(
    ("payload", "extra", "ours", "theirs"),
    [
        (HEARTBEAT, EXTRA, "message", "HEARTBEAT"),
        (HEARTBEAT[:7], EXTRA, "message", "HEARTBEAT"),
        (bytes(9), EXTRA, "message", "HEARTBEAT"),  # zeros that a sender need not leave out
        (HEARTBEAT, EXTRA + 1, "invalid", "BAD_DATA"),
        (HEARTBEAT + b"\1", EXTRA, "message", "HEARTBEAT"),  # a field of a newer definition
        (HEARTBEAT + bytes(246), EXTRA, "message", "HEARTBEAT"),  # as many bytes as there can be
    ],
)
def test_payloads_of_other_sizes_and_definitions(
    pymavlink: Pymavlink, payload: bytes, extra: int, ours: str, theirs: str
) -> None:
    frame = frame_of(pymavlink, "2", 0, payload, extra)
    assert engine_of("mavlink2").events("component_unsigned", [frame])[0].kind == ours
    assert pymavlink.types_read(frame) == [theirs]


def test_messages_of_other_dialects_are_not_verified_by_it(pymavlink: Pymavlink) -> None:
    """Decided: messages_of_other_dialects."""
    frame = frame_of(pymavlink, "2", 150, b"\1", 134)
    assert engine_of("mavlink2").events("component_unsigned", [frame])[0].kind == "invalid"
    assert pymavlink.types_read(frame) == ["UNKNOWN_150"]
