"""Swift Navigation Binary Protocol, beside the package of its makers."""

from __future__ import annotations

from collections.abc import Iterator
from io import BytesIO
from typing import Any

import pytest
from library_support import cases_of, compare_frames, compare_recovery, peer_module

from protogen.fuzzing.samples import Values
from protogen.fuzzing.trips import Case

NAMES = {"pseudorange": "P", "carrier_phase": "L", "doppler": "D", "whole": "i", "fraction": "f"}
"""Fields that have other names there."""
LISTS = ("fwd_payload", "contents", "data")
"""Bytes that it has as lists of numbers."""
PADDED = {"name": 20, "interface_name": 16}
"""Sizes of texts that it doesn't pad itself."""


class Swift:
    """The messages of the package, and its reader of streams."""

    def __init__(self) -> None:
        self._msg: Any = peer_module("sbp.msg")
        self._framer: Any = peer_module("sbp.client.framer").Framer
        table: Any = peer_module("sbp.table")
        self._classes = {
            kind.__name__.lower().removeprefix("msg"): (number, kind)
            for number, kind in table._SBP_TABLE.items()
        }

    def _kind(self, message: str) -> tuple[int, Any]:
        number, kind = self._classes[message.replace("_", "")]
        return number, kind

    def frame(self, case: Case) -> bytes:
        number, kind = self._kind(case.message)
        sender = case.parts["sender"]
        if not case.values:
            empty: bytes = self._msg.SBP(number, sender, 0, b"").pack()
            return empty
        values = {name: as_theirs(name, value) for name, value in joined(case.values).items()}
        made: bytes = kind(sender=sender, **values).to_binary()
        return made

    def values(self, case: Case, frame: bytes) -> Values:
        _, kind = self._kind(case.message)
        packet = self._msg.SBP.unpack(frame)
        assert packet.sender == case.parts["sender"]
        read = kind(packet)
        like = as_it_reads(joined(case.values))
        found = {name: as_ours(getattr(read, name), value) for name, value in like.items()}
        return case.values if found == like else found

    def found(self, endpoint: str, data: bytes) -> Iterator[bytes]:
        """It goes on behind what it took for a frame, whatever that was."""
        assert endpoint == "device"
        stream = BytesIO(data)

        def read(size: int) -> bytes:
            piece = stream.read(size)
            if not piece:
                raise OSError  # else it would wait for more
            return piece

        for message, _ in self._framer(read, None, dispatcher=lambda packet: packet):
            yield message.pack()


def joined(values: Values) -> Values:
    """Texts with NUL behind each; it has those of a setting as one."""
    found = dict(values)
    if "filename" in found:
        found["filename"] += "\0"
    if isinstance(found.get("setting"), dict):
        more = [item["text"] for item in found.pop("more", ())]
        found["setting"] = "".join(f"{text}\0" for text in (*found["setting"].values(), *more))
    return found


def as_it_reads(values: Values) -> Values:
    """It takes all that follows for part of a file's name."""
    if "filename" not in values or "data" not in values:
        return values
    name = values["filename"] + bytes.fromhex(values["data"]).decode("latin-1")
    return {**values, "filename": name, "data": ""}


def as_theirs(name: str, value: Any) -> Any:
    match value:
        case dict():
            return {their_name(key): as_theirs(key, inner) for key, inner in value.items()}
        case list():
            return [as_theirs(name, inner) for inner in value]
        case "inf" | "-inf" | "nan":
            return float(value)
        case str() if name in LISTS:
            return list(bytes.fromhex(value))
        case str():
            return value.encode("latin-1").ljust(PADDED.get(name, 0), b"\0")
    return value


def as_ours(value: Any, like: Any) -> Any:
    """What it read, in the form of the value that was sent."""
    match like:
        case dict():
            return {key: as_ours(value[their_name(key)], inner) for key, inner in like.items()}
        case list():
            assert len(value) == len(like)
            return [as_ours(*pair) for pair in zip(value, like, strict=True)]
        case str() if isinstance(value, float):
            return str(value)  # infinite, or no number
        case str() if isinstance(value, list):
            return bytes(value).hex()
        case str():
            return value.rstrip(b"\0").decode("latin-1") + "\0" * (
                len(like) - len(like.rstrip("\0"))
            )
    return value


def their_name(name: str) -> str:
    return NAMES.get(name, name)


@pytest.fixture(scope="module")
def swift() -> Swift:
    return Swift()


def test_both_make_and_read_the_same(swift: Swift) -> None:
    compare_frames("sbp", swift, cases_of("sbp"))


def test_no_frame_is_lost_that_it_finds(swift: Swift) -> None:
    compare_recovery("sbp", "device", swift, cases_of("sbp"))
