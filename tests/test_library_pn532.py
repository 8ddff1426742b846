"""NXP's PN532 on a serial line, beside nfcpy."""

from __future__ import annotations

import logging
from collections.abc import Callable, Iterable, Iterator
from typing import Any

import pytest
from compiled import module_at
from library_support import (
    cases_of,
    compare_frames,
    compare_recovery,
    engine_of,
    peer_module,
    told_before,
)

from protogen.copying import replace
from protogen.fuzzing.samples import Values
from protogen.fuzzing.trips import Case
from protogen.library import FOLDER

PEER = "nfcpy"
BAUD = (9600, 19200, 38400, 57600, 115200, 230400, 460800, 921600, 1288000)
ACK = bytes.fromhex("00 00 FF 00 FF 00")
MODES = ("normal", "virtual", "wired", "dual")
KBPS = (106, 212, 424)


def data(text: str | None) -> bytes:
    return bytes.fromhex(text or "")


COMMANDS: dict[str, Callable[[Any, Values], Any]] = {
    "acknowledge": lambda chip, v: chip.send_ack(),
    "diagnose": lambda chip, v: chip.diagnose(v["test"], data(v["data"])),
    "get_firmware_version": lambda chip, v: chip.get_firmware_version(),
    "get_general_status": lambda chip, v: chip.get_general_status(),
    "read_registers": lambda chip, v: chip.read_register(*v["addresses"]),
    "write_registers": lambda chip, v: chip.write_register(
        *((each["address"], each["value"]) for each in v["registers"])
    ),
    "set_baud": lambda chip, v: chip.set_serial_baudrate(BAUD[v["baud"]]),
    "set_parameters": lambda chip, v: chip.set_parameters(v["flags"]),
    "configure_sam": lambda chip, v: chip.sam_configuration(
        MODES[v["mode"] - 1], v["timeout"], bool(v["irq"][0])
    ),
    "power_down": lambda chip, v: chip.power_down(
        [name for bit, name in enumerate(chip.power_down_wakeup_src) if v["wakes"] >> bit & 1],
        bool(v["irq"][0]),
    ),
    "configure_rf": lambda chip, v: chip.rf_configuration(v["item"], flat(v["settings"])),
    "jump_for_psl": lambda chip, v: chip.in_jump_for_psl(*jump(v["jump"])),
    "exchange_data": lambda chip, v: chip.in_data_exchange(
        data(v["data"]), 1, more=bool(v["to"] & 0x40)
    ),
    "communicate_through": lambda chip, v: chip.in_communicate_thru(data(v["data"]), 1),
    "list_passive_targets": lambda chip, v: chip.in_list_passive_target(
        v["max"], v["kind"], data(v["data"])
    ),
    "set_speed": lambda chip, v: chip.in_psl(v["to_target"], v["to_initiator"]),
    "activate": lambda chip, v: chip.in_atr(data(v["nfcid3"]), data(v["general_bytes"])),
    "jump_for_dep": lambda chip, v: chip.in_jump_for_dep(*jump(v["jump"])),
    "get_data": lambda chip, v: chip.tg_get_data(1),
    "get_initiator_command": lambda chip, v: chip.tg_get_initiator_command(1),
    "get_target_status": lambda chip, v: chip.tg_get_target_status(),
    "be_target": lambda chip, v: chip.tg_init_as_target(
        v["mode"],
        flat(v["mifare"]),
        flat(v["felica"]),
        data(v["nfcid3"]),
        data(v["general_bytes"]),
        data(v["historical_bytes"]),
        1,
    ),
    "set_data": lambda chip, v: chip.tg_set_data(data(v["data"]), 1),
    "respond": lambda chip, v: chip.tg_response_to_initiator(data(v["data"])),
    "set_general_bytes": lambda chip, v: chip.tg_set_general_bytes(data(v["data"])),
    "set_more_data": lambda chip, v: chip.tg_set_meta_data(data(v["data"]), 1),
    # These it has no methods for.
    "read_pins": lambda chip, v: chip.command(0x0C, flat(v), 1),
    "write_pins": lambda chip, v: chip.command(0x0E, flat(v), 1),
    "deselect": lambda chip, v: chip.command(0x44, flat(v), 1),
    "release": lambda chip, v: chip.command(0x52, flat(v), 1),
    "select": lambda chip, v: chip.command(0x54, flat(v), 1),
    "test_rf": lambda chip, v: chip.command(0x58, flat(v), 1),
    "poll": lambda chip, v: chip.command(0x60, flat(v), 1),
}
ANSWERS = {
    "diagnosed": 0x01,
    "firmware_version": 0x03,
    "general_status": 0x05,
    "registers": 0x07,
    "registers_written": 0x09,
    "pins": 0x0D,
    "pins_written": 0x0F,
    "baud_set": 0x11,
    "parameters_set": 0x13,
    "sam_configured": 0x15,
    "powers_down": 0x17,
    "rf_configured": 0x33,
    "data_exchanged": 0x41,
    "communicated": 0x43,
    "deselected": 0x45,
    "jumped_for_psl": 0x47,
    "targets_a": 0x4B,
    "targets_a_without_ats": 0x4B,
    "targets_f": 0x4B,
    "targets_b": 0x4B,
    "targets_jewel": 0x4B,
    "passive_targets": 0x4B,
    "speed_set": 0x4F,
    "activated": 0x51,
    "released": 0x53,
    "selected": 0x55,
    "jumped_for_dep": 0x57,
    "polled": 0x61,
    "received_data": 0x87,
    "initiator_command": 0x89,
    "target_status": 0x8B,
    "is_target": 0x8D,
    "data_set": 0x8F,
    "responded": 0x91,
    "general_bytes_set": 0x93,
    "more_data_set": 0x95,
}


def flat(value: Any) -> bytes:
    """The bytes of values, each of which is a byte or a few."""
    if isinstance(value, dict):
        return b"".join(map(flat, value.values()))
    if isinstance(value, list):
        return b"".join(map(flat, value))
    return bytes((value,)) if isinstance(value, int) else data(value)


def jump(values: Values) -> tuple[Any, ...]:
    """The arguments of its methods that activate a phone."""
    passive = data(values["uid"]) + data(values["polling"])
    numbers = data(values["nfcid3"]), data(values["general_bytes"])
    return bool(values["active"]), KBPS[values["rate"]], passive, *numbers


def code_of(frame: bytes) -> int:
    return frame[9 if frame[3:5] == b"\xff\xff" else 6]


class Line:
    """A line on which each command is acknowledged, and answered by zeros."""

    def __init__(self) -> None:
        self.written: list[bytes] = []
        self.answers: list[bytes] = []

    def write(self, frame: bytes) -> None:
        self.written.append(bytes(frame))
        if len(frame) > len(ACK):
            self.answers = [ACK, answered(0xD5, code_of(frame) + 1, bytes(20))]

    def read(self, timeout: int) -> bytearray:
        return bytearray(self.answers.pop(0))


def answered(sender: int, code: int, content: bytes) -> bytes:
    """The frame of an answer, which it does not make."""
    content = bytes((sender, code)) + content
    size = len(content)
    head = bytes((size,)) if size < 256 else b"\xff\xff" + size.to_bytes(2, "big")
    check = -sum(head[-2:] if size > 255 else head) % 256
    return b"\0\0\xff" + head + bytes((check,)) + content + bytes((-sum(content) % 256, 0))


class Tty:
    """A serial port as its transport has one."""

    timeout = 0.0

    def __init__(self, data: bytes) -> None:
        self._data = data

    def read(self, size: int) -> bytes:
        piece, self._data = self._data[:size], self._data[size:]
        return piece


class Nfcpy:
    """Its chipset."""

    def __init__(self) -> None:
        self._module: Any = peer_module("nfc.clf.pn532")
        self._transport: Any = peer_module("nfc.clf.transport")
        self._line = Line()
        self._chip = self._module.Chipset(self._line, logging.getLogger(__name__))

    def frame(self, case: Case) -> bytes:
        if case.message in ANSWERS:
            return answered(0xD5, ANSWERS[case.message], flat(case.values))
        if case.message == "syntax_error":
            return bytes.fromhex("00 00 FF 01 FF 7F 81 00")
        self._line.written = []
        COMMANDS[case.message](self._chip, case.values)
        return self._line.written[0]

    def values(self, case: Case, frame: bytes) -> Values:
        """The case's values, if it reads just these."""
        if case.message == "syntax_error":
            with pytest.raises(self._module.Chipset.Error) as refused:
                self._content(frame, 0)
            assert refused.value.errno == 0x7F
        elif case.message in ANSWERS:
            content = self._content(frame, ANSWERS[case.message] - 1)
            assert content == flat(case.values)
        return case.values  # it reads no command

    def _content(self, frame: bytes, code: int) -> bytes:
        """What it reads in a frame that answers a command."""
        self._line.answers = [self._read(frame)]
        return bytes(self._chip.command(code, None, 1))

    def _read(self, data: bytes) -> bytes:
        """The frame that its transport takes from a port."""
        tty = self._transport.TTY.__new__(self._transport.TTY)
        tty.tty = Tty(data)
        return bytes(tty.read(1))

    def found(self, endpoint: str, data: bytes) -> Iterator[bytes]:
        """What it takes for an answer, or an acknowledgement, at each start."""
        chip, at = self._module.Chipset, data.find(self._module.Chipset.SOF)
        while at >= 0:
            try:
                frame = self._read(data[at : at + 275])
                if frame != chip.ACK:
                    self._content(frame, code_of(frame) - 1)
            except (OSError, IndexError, chip.Error):
                at = data.find(chip.SOF, at + 1)
                continue
            yield frame
            at = data.find(chip.SOF, at + len(frame))


@pytest.fixture(scope="module")
def nfcpy() -> Nfcpy:
    return Nfcpy()


def as_sent(case: Case) -> Case:
    """The case, as it sends it: to target 1, with values that it knows."""
    values = dict(case.values)
    match case.message:
        case "set_baud":
            values["baud"] = min(values["baud"], 8)
        case "configure_sam":
            values |= {"mode": values["mode"] % 4 + 1, "irq": [values["timeout"] % 2]}
        case "power_down":
            values["irq"] = [values["wakes"] % 2]
        case "exchange_data":
            values["to"] = values["to"] & 0x40 | 1
        case "list_passive_targets":
            values |= {"max": 1, "kind": values["kind"] % 5}
        case "set_speed":
            values["target"] = 1
        case "activate":
            values |= {"target": 1, "next": values["next"] & 3}
            values["general_bytes"] = filled(values["general_bytes"])
        case "be_target":
            values["mode"] &= 7
        case "jump_for_dep" | "jump_for_psl":
            known = values["jump"]
            known = known | {"active": known["active"] % 2, "rate": min(known["rate"], 2)}
            known |= {"next": known["next"] & 7, "general_bytes": filled(known["general_bytes"])}
            values["jump"] = known
    return replace(case, values=values)


def filled(general_bytes: str | None) -> str | None:
    """Some general bytes, where they are said to be there."""
    return "00" if general_bytes == "" else general_bytes


def is_read(case: Case) -> bool:
    """False for 255 bytes, whose length it takes for the start of a longer frame."""
    return len(flat(case.values)) != 253


def drawn(messages: Iterable[str], *, bare: bool = False) -> Iterator[Case]:
    """Cases in frames with zeros at both ends, or in those without."""
    drawn = map(as_sent, cases_of("pn532", messages))
    return (case for case in drawn if ("bare" in case.sender) is bare)


def test_both_make_the_same_commands(nfcpy: Nfcpy) -> None:
    compare_frames("pn532", nfcpy, drawn(COMMANDS))


def test_it_reads_the_answers_that_we_make(nfcpy: Nfcpy) -> None:
    compare_frames("pn532", nfcpy, filter(is_read, drawn([*ANSWERS, "syntax_error"])))


@pytest.mark.parametrize("messages", [COMMANDS, ANSWERS], ids=["commands", "answers"])
def test_frames_without_zeros_are_those_between_zeros(nfcpy: Nfcpy, messages: Any) -> None:
    engine = engine_of("pn532")
    for case in drawn(messages, bare=True):
        ours = engine.frame(case.sender, case.message, case.values, case.parts)
        assert b"\0" + ours + b"\0" == nfcpy.frame(case)
        (event,) = engine.events(case.sender, [ours], told_before("pn532", case, ours))
        assert (event.message, event.values) == (case.message, case.values)


def test_no_frame_is_lost_that_it_finds(nfcpy: Nfcpy) -> None:
    compare_recovery("pn532", "chip", nfcpy, drawn([*ANSWERS, "acknowledge"]))


def test_a_command_tells_of_what_kind_targets_are() -> None:
    """Without one, an answer has bytes; the kind and the parameters of the chip tell the rest."""
    module = module_at(FOLDER / "pn532.yaml")
    decoder = module.Decoder()
    card = bytes.fromhex("00 00 FF 0C F4 D5 4B 01 01 00 04 08 04 90 1F 2A A4 51 00")
    jewel = bytes.fromhex("00 00 FF 0A F6 D5 4B 01 01 00 0C 01 02 03 04 C8 00")

    def names(data: bytes) -> list[str]:
        return [event.message.NAME for event in decoder.feed(data)]

    assert names(card) == ["passive_targets"]
    for kind, answer, name in ((0, card, "targets_a"), (4, jewel, "targets_jewel")):
        asked = module.encode(module.ListPassiveTargets(max=1, kind=kind, data=b""))
        assert names(asked + answer) == ["list_passive_targets", name]
    asked = module.encode(module.ListPassiveTargets(max=1, kind=0, data=b""))
    no_rats = module.encode(module.SetParameters(flags=4))
    assert names(no_rats + asked + card)[2:] == ["targets_a_without_ats"]


@pytest.mark.parametrize("engine", ["fast", "construct"])
def test_zeros_at_both_ends_may_be_left_out(engine: str) -> None:
    """With them, without, and with more of them, one behind another."""
    module = module_at(FOLDER / "pn532.yaml")
    acknowledge, again = bytes.fromhex("00 00 FF 00 FF 00"), bytes.fromhex("00 00 FF FF 00 00")
    version = bytes.fromhex("00 00 FF 06 FA D5 03 32 01 06 07 E8 00")
    long = module.encode(module.DataExchanged(status=0, data=bytes(range(255))))
    error = bytes.fromhex("00 00 FF 01 FF 7F 81 00")

    def found(frames: list[bytes]) -> list[bytes]:
        decoder = module.Decoder("chip", engine)
        events = [*decoder.feed(b"".join(frames)), *decoder.flush()]
        return [event.raw for event in events if event.kind == "message"]

    whole = [acknowledge, version, again, long, error]
    bare = [frame[1:-1] for frame in whole]
    for frames in (whole, bare, [*whole, *bare], [*bare, *whole]):
        assert found(frames) == frames
    assert found([b"\0" + frame + b"\0" for frame in whole]) == whole
