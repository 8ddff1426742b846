"""XMODEM, beside the package of that name."""

from __future__ import annotations

import logging
from collections.abc import Iterator
from io import BytesIO
from typing import Any

import pytest
from compiled import module_at
from library_support import cases_of, compare_frames, compare_recovery, encoded, peer_module

from protogen.copying import replace
from protogen.fuzzing.samples import Values
from protogen.fuzzing.trips import Case
from protogen.library import FOLDER

MODES = {"block": "xmodem", "block_1k": "xmodem1k", "block_with_sum": "xmodem"}
ASKED = {"block": "ask_crc", "block_1k": "ask_crc", "block_with_sum": "refused"}
"""What a receiver says to get such blocks."""
SIZES = {0x01: {"ask_crc": 133, "refused": 132}, 0x02: {"ask_crc": 1029}}
"""Bytes of a block, by its start and what was asked for."""


class Line:
    """A line on which the other side has sent all that it will."""

    def __init__(self, received: bytes) -> None:
        self._received = BytesIO(received)
        self.sent = b""

    def getc(self, size: int, timeout: float = 1) -> bytes | None:
        """Take bytes; None where there are no more."""
        return self._received.read(size) or None

    def putc(self, data: bytes, timeout: float = 1) -> int:
        """Send bytes; their number."""
        self.sent += data
        return len(data)


class Xmodem:
    """Both ends of a transfer, as the package has them."""

    def __init__(self) -> None:
        self._module: Any = peer_module("xmodem")
        logging.getLogger("xmodem.XMODEM").setLevel(logging.CRITICAL)

    def send(self, file: bytes, mode: str, answers: bytes) -> tuple[bool, bytes]:
        """Whether the file was sent, and all that its sender sent."""
        line = Line(answers)
        modem = self._module.XMODEM(line.getc, line.putc, mode)
        return modem.send(BytesIO(file), retry=1, quiet=True), line.sent

    def receive(self, sent: bytes, asked: str) -> tuple[bytes | None, bytes]:
        """The file, which is None where it did not come whole; and the answers."""
        line, file = Line(sent), BytesIO()
        modem = self._module.XMODEM(line.getc, line.putc)
        crc = int(asked == "ask_crc")
        size = modem.recv(file, crc_mode=crc, retry=2, delay=0, quiet=True)
        return None if size is None else file.getvalue(), line.sent

    def frame(self, case: Case) -> bytes:
        """The first block of a file, which alone it has."""
        answers = ours(ASKED[case.message]) + ours("accepted") * 2
        done, sent = self.send(bytes.fromhex(case.values["data"]), MODES[case.message], answers)
        assert done
        return sent.removesuffix(ours("end"))

    def values(self, case: Case, frame: bytes) -> Values:
        """What is in the first block of a file, which alone it has."""
        file, _ = self.receive(frame + ours("end"), ASKED[case.message])
        return {} if file is None else {"data": file.hex()}

    def found(self, endpoint: str, data: bytes) -> Iterator[bytes]:
        """Yield the first blocks of transfers."""
        place = 0
        while place < len(data):
            block = self._first_block(data[place:])
            if block:
                yield block
            place += len(block) or 1

    def _first_block(self, data: bytes) -> bytes:
        for asked, size in SIZES.get(data[0], {}).items():
            block = data[:size]
            if self.receive(block + ours("end"), asked)[0]:
                return block
        return b""


@pytest.fixture(scope="module")
def xmodem() -> Xmodem:
    return Xmodem()


def ours(message: str) -> bytes:
    """Our frame of a message without fields."""
    module = module_at(FOLDER / "xmodem.yaml")
    kind = module.MESSAGES[message]
    frame: bytes = module.encode(kind())
    return frame


def read(endpoint: str, data: bytes) -> list[Any]:
    """What we read in what an endpoint has sent, which is messages only."""
    events = list(module_at(FOLDER / "xmodem.yaml").Decoder(endpoint).feed(data))
    assert {event.kind for event in events} == {"message"}
    return events


def transfer(message: str) -> list[Case]:
    """Blocks that follow each other: they are numbered from 1."""
    drawn = cases_of("xmodem", [message])
    return [replace(case, parts={"number": n % 256}) for n, case in enumerate(drawn, 1)]


@pytest.mark.parametrize("message", MODES)
def test_both_make_and_read_the_same_transfer(xmodem: Xmodem, message: str) -> None:
    blocks = transfer(message)
    file = b"".join(bytes.fromhex(case.values["data"]) for case in blocks)
    sent = b"".join(encoded("xmodem", case) for case in blocks) + ours("end")
    answers = ours(ASKED[message]) + ours("accepted") * (len(blocks) + 1)

    assert xmodem.send(file, MODES[message], answers) == (True, sent)
    assert xmodem.receive(sent, ASKED[message]) == (file, answers)

    *found, end = read("sender", sent)
    assert end.message.NAME == "end"
    for case, event in zip(blocks, found, strict=True):
        assert case.message == event.message.NAME
        assert event.message.data.hex() == case.values["data"]
        assert event.parts.number == case.parts["number"]
    told = [event.message.NAME for event in read("receiver", answers)]
    assert told == [ASKED[message]] + ["accepted"] * (len(blocks) + 1)


def test_either_side_gives_up_with_two_of_them(xmodem: Xmodem) -> None:
    assert xmodem.send(b"x", "xmodem", ours("given_up") * 2) == (False, b"")
    assert xmodem.receive(ours("cancel") * 2, "ask_crc")[0] is None

    sent, answers = xmodem.send(b"", "xmodem", b"")[1], xmodem.receive(b"", "ask_crc")[1]
    assert [event.message.NAME for event in read("sender", sent)] == ["cancel", "cancel"]
    found = [event.message.NAME for event in read("receiver", answers)]
    assert found == ["ask_crc", "refused", "given_up", "given_up"]


def first_blocks() -> list[Case]:
    """Blocks with the number 1, as the package takes no other where a file begins."""
    return [replace(case, parts={"number": 1}) for case in cases_of("xmodem", MODES)]


def test_both_make_and_read_the_same_first_blocks(xmodem: Xmodem) -> None:
    compare_frames("xmodem", xmodem, first_blocks())


def test_no_block_is_lost_that_it_finds(xmodem: Xmodem) -> None:
    compare_recovery("xmodem", "sender", xmodem, first_blocks())
