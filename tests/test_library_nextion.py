"""Nextion displays, beside nextion."""

from __future__ import annotations

import asyncio
from collections.abc import Iterator
from pathlib import Path
from random import Random
from struct import pack, unpack
from types import SimpleNamespace
from typing import Any

import pytest
from compiled import module_at, protocol_of
from library_support import FRAMES, cases_of, compare_frames, compare_recovery, peer_module

from protogen.copying import replace
from protogen.fuzzing.samples import Values
from protogen.fuzzing.trips import Case
from protogen.library import FOLDER

PEER = "nextion"
RESULTS = {
    "success": 0x01,
    "invalid_component": 0x02,
    "invalid_page": 0x03,
    "invalid_picture": 0x04,
    "invalid_font": 0x05,
    "invalid_file_operation": 0x06,
    "invalid_crc": 0x09,
    "invalid_baud": 0x11,
    "invalid_waveform": 0x12,
    "invalid_variable": 0x1A,
    "invalid_operation": 0x1B,
    "assignment_failed": 0x1C,
    "eeprom_failed": 0x1D,
    "invalid_parameters": 0x1E,
    "io_failed": 0x1F,
    "invalid_escape": 0x20,
    "name_too_long": 0x23,
    "buffer_overflow": 0x24,
}
EVENTS = {
    "sleeps": 0x86,
    "woke_up": 0x87,
    "ready": 0x88,
    "upgrade": 0x89,
    "data_received": 0xFD,
    "ready_for_data": 0xFE,
}
LAYOUTS = {
    "invalid_instruction": (0x00, ""),
    "started": (0x00, ">2x"),
    "page": (0x66, "B"),
    "text": (0x70, "text"),
    "number": (0x71, "<i"),
    "connected": (0x63, "text"),
    "touched": (0x65, "BBB"),
    "touched_at": (0x67, ">HHB"),
    "touched_asleep": (0x68, ">HHB"),
    **{name: (code, "") for name, code in (RESULTS | EVENTS).items()},
}
"""Codes, and the data behind them: it makes none."""
LOADING = ["data", "packet", "leave", "packet_refused", "block_taken", "go_on_at"]
"""What is sent while a display is loaded, or files are written."""
MARK = b"omok "


class Transport:
    """What a serial port writes."""

    written = b""

    def write(self, data: bytes) -> None:
        self.written += data


class Nextion:
    """Its protocol, and the messages and events that it found."""

    def __init__(self) -> None:
        self._client: Any = peer_module("nextion.client")
        self._protocol: Any = peer_module("nextion.protocol").NextionProtocol
        self._failed: Any = peer_module("nextion.exceptions").CommandFailed
        self._loop = asyncio.new_event_loop()

    def close(self) -> None:
        self._loop.close()

    async def _begun(self, found: list[bytes]) -> Any:
        protocol = self._protocol(found.append)
        protocol.connection_made(Transport())
        protocol.queue.put_nowait = found.append
        return protocol

    def _protocol_into(self, found: list[bytes]) -> Any:
        return self._loop.run_until_complete(self._begun(found))

    def frame(self, case: Case) -> bytes:
        if case.message == "instruction":
            protocol = self._protocol_into([])
            client = self._client.Nextion("")
            client._connection = protocol
            client._write_command_raw(case.values["text"].encode())
            return bytes(protocol.transport.written)
        code, layout = LAYOUTS[case.message]
        values = list(case.values.values())
        data = MARK * ("mark" in case.values) + values[-1].encode() if layout == "text" else b""
        if layout not in ("", "text"):
            data = pack(layout, *(values if "x" not in layout else ()))
        return bytes((code,)) + data + bytes(self._protocol.EOL)

    def values(self, case: Case, frame: bytes) -> Values:
        if case.message in ("instruction", "invalid_instruction"):
            return case.values  # it reads none
        (message,) = self._messages(frame)
        code, layout = LAYOUTS[case.message]
        assert message[0] == code
        if case.message in RESULTS:
            assert self._result("page 0", message) == code
        elif case.message in ("page", "text", "number"):
            ((name, value),) = case.values.items()
            result = self._result("sendme" if name == "page" else "get x", message)
            return {name: value if value == "" and result == code else result}
        elif case.message == "connected":
            assert message[1:].decode() == MARK.decode() + case.values["values"]
        elif layout:
            return self._event(case, message)
        return case.values

    def _messages(self, data: bytes) -> list[bytes]:
        found: list[bytes] = []
        self._protocol_into(found).data_received(data)
        return found

    def _result(self, command: str, message: bytes) -> Any:
        """What comes of a command that is answered so."""
        client = self._client.Nextion("")

        async def answer(timeout: float) -> bytes:
            return message

        client._write_command_raw = client._flush_read_buffer = lambda *given: None
        client._read_packet = answer
        try:
            result = self._loop.run_until_complete(client._command(command))
        except self._failed as error:
            return error.code
        return int(result) if result is True else result

    def _event(self, case: Case, message: bytes) -> Values:
        client, found = self._client.Nextion(""), []
        client._schedule_event_message_handler = lambda kind, data: found.append(data)
        if case.message == "started":
            client._on_ready = lambda: asyncio.sleep(0)
        self._loop.run_until_complete(self._handled(client, message))
        (event,) = found
        if event is None:
            return case.values
        if case.message == "touched":
            return dict(zip(case.values, event, strict=True))
        x, y, touch = event  # it reads the lower byte of a coordinate first
        return {"x": swapped(x), "y": swapped(y), "event": touch}

    async def _handled(self, client: Any, message: bytes) -> None:
        client._handle_event(message)

    def found(self, endpoint: str, data: bytes) -> Iterator[bytes]:
        for message in self._messages(data):
            yield message + self._protocol.EOL


class Rate(int):
    """A speed that can be formatted twice: its upload does so, and fails with any other."""

    def __getitem__(self, name: str) -> int:
        return self


class Upload:
    """Its function that loads a display, on a line that keeps what it writes.

    It reads an answer of one byte and knows no other.
    """

    def __init__(self, monkeypatch: pytest.MonkeyPatch) -> None:
        self._client: Any = peer_module("nextion.client")
        self._protocol: Any = peer_module("nextion.protocol").BasicProtocol
        self._answers: list[bytes] = []
        self.blocks: list[bytes] = []
        monkeypatch.setattr(self._client.asyncio, "sleep", self._nothing)
        monkeypatch.setattr(
            self._client.serial_asyncio, "create_serial_connection", self._connected
        )

    async def _nothing(self, *given: Any, **named: Any) -> None:
        return None

    async def _connected(self, *given: Any, **named: Any) -> tuple[None, Any]:
        return None, SimpleNamespace(write=self._write)

    def _write(self, data: bytes, eol: bool) -> None:
        assert not eol
        self.blocks.append(data)

    async def _answer(self, timeout: float) -> bytes:
        return self._answers.pop(0)

    def load(self, data: bytes, path: Path, answers: list[bytes]) -> None:
        """Load a file into a display that answers so."""
        path.write_bytes(data)
        self._answers, self.blocks = list(answers), []
        asyncio.run(self._load(path))
        assert not self._answers

    async def _load(self, path: Path) -> None:
        client = self._client.Nextion("", Rate(115200))
        client._connection = SimpleNamespace(close=self._nothing)
        client.set = self._nothing
        client._write_command_raw = lambda command: None
        client._read_packet = self._answer
        await client.upload_firmware(path.open("rb"))


def swapped(value: int) -> int:
    return int(unpack("<H", pack(">H", value))[0])


def is_ascii(case: Case) -> bool:
    """False where a text has characters that it does not read."""
    return all(str(value).isascii() for value in case.values.values())


def shortened(case: Case) -> Case:
    return replace(case, values={"text": case.values["text"][:64]})


@pytest.fixture(scope="module")
def nextion() -> Iterator[Nextion]:
    peer = Nextion()
    yield peer
    peer.close()


@pytest.fixture(scope="module")
def drawn() -> list[Case]:
    return list(filter(is_ascii, cases_of("nextion", LAYOUTS)))


def test_the_messages_are_those_of_the_schema() -> None:
    messages = {message.name for message in protocol_of(FOLDER / "nextion.yaml").messages}
    assert messages == {"instruction", *LAYOUTS, *LOADING}


def test_both_make_the_same_instructions(nextion: Nextion) -> None:
    drawn = list(filter(is_ascii, cases_of("nextion", ["instruction"])))
    assert len(drawn) >= FRAMES
    few = {id(case) for case in drawn[::20]}  # Long ones are slow.
    short = [case if id(case) in few else shortened(case) for case in drawn]
    compare_frames("nextion", nextion, short)


def test_it_reads_the_messages_that_we_make(nextion: Nextion, drawn: list[Case]) -> None:
    compare_frames("nextion", nextion, drawn)


def test_blocks_of_files_and_their_answers_are_the_same(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    """Each block that it writes is a frame of ours, and it takes each answer that we make."""
    module, upload, dice = module_at(FOLDER / "nextion.yaml"), Upload(monkeypatch), Random(1)
    taken = module.encode(module.BlockTaken())
    assert [item.message.NAME for item in module.Decoder("upload").feed(taken * 2)] == [
        "block_taken",
        "block_taken",
    ]
    blocks = 0
    for size in [*(4096 * count + 1 for count in range(2)), *dice.choices(range(1, 64), k=FRAMES)]:
        file = dice.randbytes(size)
        upload.load(file, tmp_path / "file.tft", [taken] * (1 + -(-size // 4096)))
        receiver = module.Decoder("data")
        receiver.tell(announced=[len(block) for block in upload.blocks])
        read = b""
        for event, block in zip(receiver.feed(b"".join(upload.blocks)), upload.blocks, strict=True):
            assert module.encode(event.message) == block
            read += event.message.data
            blocks += 1
        assert read == file
    assert blocks >= FRAMES


def test_another_answer_than_the_one_byte_ends_its_loading(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    module, upload = module_at(FOLDER / "nextion.yaml"), Upload(monkeypatch)
    newer = module.encode(module.GoOnAt(offset=0x110000))
    assert newer == bytes.fromhex("08 00 00 11 00")
    (event,) = module.Decoder("upload").feed(newer)
    assert event.message.offset == 0x110000
    with pytest.raises(OSError, match="0800001100"):
        upload.load(b"tft", tmp_path / "file.tft", [b"\x05", newer])


def modbus(data: bytes) -> int:
    """CRC-16/MODBUS, bit by bit: 0xA001 reflected, from FFFF."""
    found = 0xFFFF
    for byte in data:
        found ^= byte
        for _ in range(8):
            found = found >> 1 ^ (0xA001 if found & 1 else 0)
    return found


def test_packets_of_files_are_those_that_programs_lay_out() -> None:
    """It writes no files. The header is that of programs which do; the checksum is worked out."""
    module, dice = module_at(FOLDER / "nextion.yaml"), Random(2)
    assert modbus(b"123456789") == 0x4B37
    for number in (0, 1, 255, 256, 0xFFFE):
        data = dice.randbytes(dice.randrange(1, 64))
        head = bytes.fromhex("3A A1 BB 44 7F FF FE")
        plain = head + pack("<BHH", 0, number, len(data)) + data
        summed = head + pack("<BHH", 1, number, len(data) + 2) + data + pack("<H", modbus(data))
        packet = module.Packet(data=data)
        assert module.encode(packet, sender="file", number=number) == plain
        assert module.encode(packet, sender="checked_file", number=number) == summed
        assert module.decode(summed, "checked_file") == packet
    leave = head + bytes.fromhex("00 FF FF 00 00")
    assert module.encode(module.Leave()) == leave
    assert [item.message.NAME for item in module.Decoder("file").feed(plain + leave)] == [
        "packet",
        "leave",
    ]


def test_bytes_of_a_file_are_as_many_as_were_asked_for() -> None:
    decoder = module_at(FOLDER / "nextion.yaml").Decoder("content")
    decoder.tell(announced=[4, 2])
    assert [item.raw for item in decoder.feed(b"abcdef")] == [b"abcd", b"ef"]


def test_no_frame_is_lost_that_it_finds(nextion: Nextion, drawn: list[Case]) -> None:
    compare_recovery("nextion", "display", nextion, drawn, begins_anew=False)
