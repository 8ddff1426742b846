"""Zaber's binary protocol without identifiers, beside zaber-serial."""

from __future__ import annotations

import pytest
from compiled import protocol_of
from library_support import FRAMES, cases_of, compare_frames, compare_recovery
from zaber_peer import ZaberSerial

from protogen.library import FOLDER

PEER = "zaber_serial"


@pytest.fixture(scope="module")
def zaber_serial() -> ZaberSerial:
    return ZaberSerial(with_identifiers=False)


def messages_from(endpoint: str) -> list[str]:
    sender = protocol_of(FOLDER / "zaber.yaml").sender(endpoint)
    return sorted(message.name for message in sender.messages)


@pytest.mark.parametrize("endpoint", ["host", "device"])
def test_both_make_and_read_the_same_frames(zaber_serial: ZaberSerial, endpoint: str) -> None:
    drawn = cases_of("zaber", messages_from(endpoint))
    drawn = [case for case in drawn if case.sender == endpoint]
    assert len(drawn) >= FRAMES
    compare_frames("zaber", zaber_serial, drawn)


@pytest.mark.parametrize("endpoint", ["host", "device"])
def test_no_frame_is_lost_that_it_finds(zaber_serial: ZaberSerial, endpoint: str) -> None:
    drawn = cases_of("zaber", messages_from(endpoint))
    compare_recovery("zaber", endpoint, zaber_serial, drawn)
