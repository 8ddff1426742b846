"""XBee's API without escapes, beside digi-xbee."""

from __future__ import annotations

import pytest
from library_support import FRAMES, cases_of, compare_frames, compare_recovery
from xbee_peer import CALLS, PACKETS, DigiXbee

from protogen.fuzzing.trips import Case


@pytest.fixture(name="digi_xbee", scope="module")
def in_its_mode() -> DigiXbee:
    return DigiXbee(escaped=False)


@pytest.fixture(scope="module")
def drawn(digi_xbee: DigiXbee) -> list[Case]:
    samples = [case for seed in (1, 2) for case in cases_of("xbee1", PACKETS, seed)]
    return list(filter(digi_xbee.knows, [*CALLS, *samples]))


def test_both_make_and_read_the_same_frames(digi_xbee: DigiXbee, drawn: list[Case]) -> None:
    """All messages."""
    assert {case.message for case in drawn} == set(PACKETS)
    assert len(drawn) >= FRAMES
    compare_frames("xbee1", digi_xbee, drawn)


@pytest.mark.parametrize("endpoint", ["host", "module"])
def test_no_frame_is_lost_that_it_finds(
    digi_xbee: DigiXbee, drawn: list[Case], endpoint: str
) -> None:
    compare_recovery("xbee1", endpoint, digi_xbee, drawn)
