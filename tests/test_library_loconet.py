"""LocoNet, beside pylnlib."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from typing import Any

import pytest
from compiled import protocol_of
from library_support import FRAMES, cases_of, compare_frames, compare_recovery, peer_module

from protogen.copying import replace
from protogen.fuzzing.samples import Values
from protogen.fuzzing.trips import Case
from protogen.library import FOLDER

PEER = "pylnlib"
WRITE_SLOT = 0xEF
SIZES = {"transfer": 16, "slot_data": 14, "write_slot": 14}
"""Bytes of the messages that say how many they have."""
ODD = "send_packet"
"""The message of an odd number of bytes, which it sums up wrongly."""
SPECIAL_SLOTS = (123, 124)
"""Slots of which it knows no data of their own."""


def bits(value: int, *names: str) -> dict[str, bool]:
    """Its arguments, of the lowest bit first."""
    return {name: bool(value >> bit & 1) for bit, name in enumerate(names)}


MADE: dict[str, Callable[[Any, Values], Any]] = {
    "power_on": lambda m, v: with_checksum(m.PowerOn(bytearray((0x83, 0)))),
    "power_off": lambda m, v: with_checksum(m.PowerOff(bytearray((0x82, 0)))),
    "set_speed": lambda m, v: m.SlotSpeed(slot=v["slot"], speed=v["speed"]),
    "set_direction_and_lights": lambda m, v: m.FunctionGroup1(
        slot=v["slot"], **bits(v["functions"], "f1", "f2", "f3", "f4", "f0", "dir")
    ),
    "set_sounds": lambda m, v: m.FunctionGroupSound(
        slot=v["slot"], **bits(v["functions"], "f5", "f6", "f7", "f8")
    ),
    "move_slot": lambda m, v: m.MoveSlots(src=v["slot"], dst=v["to"]),
    "read_slot": lambda m, v: m.RequestSlotData(v["slot"]),
    "read_switch": lambda m, v: m.RequestSwitchState(v["low_address"] | v["order"] << 7),
    # It puts the low half first.
    "find_slot": lambda m, v: m.RequestLocAddress(v["high_address"] | v["low_address"] << 7),
}
"""Messages that it makes of values; all others are bytes that it sums up."""


def with_checksum(message: Any) -> Any:
    message.updateChecksum()
    return message


def number(*states: bool) -> int:
    return sum(state << bit for bit, state in enumerate(states))


def functions_13(message: Any) -> Values:
    group = message.fiegroup
    names = {5: (12, 20, 28), 8: range(13, 20), 9: range(21, 28)}[group]
    first = 4 if group == 5 else 0
    states = number(*(getattr(message, f"f{name}") for name in names)) << first
    value = {"value": states}
    return {"kind": 0x20, "slot": message.slot, "group": group, "functions": value}


def switched(message: Any, name: str) -> Values:
    state = message.address >> 7 | message.engage << 4 | message.thrown << 5
    return {"low_address": message.address & 0x7F, name: state}


def slot_data(message: Any) -> Values:
    m = message
    data = {
        "status": m.status,
        "low_address": m.address & 0x7F,
        "speed": m.speed,
        "direction_and_lights": number(m.f1, m.f2, m.f3, m.f4, m.f0, m.dir),
        "track": m.trk,
        "status_2": m.ss2,
        "high_address": m.address >> 7,
        "sounds": number(m.f5, m.f6, m.f7, m.f8),
        "id_1": m.id1,
        "id_2": m.id2,
    }
    return {"slot": m.slot, "data": data}


READ: dict[str, Callable[[Any], Values]] = {
    "set_speed": lambda m: {"slot": m.slot, "speed": m.speed},
    "set_direction_and_lights": lambda m: {
        "slot": m.slot,
        "functions": number(m.f1, m.f2, m.f3, m.f4, m.f0, m.dir),
    },
    "set_sounds": lambda m: {"slot": m.slot, "functions": number(m.f5, m.f6, m.f7, m.f8)},
    "set_functions_9": lambda m: {"slot": m.slot, "functions": number(m.f9, m.f10, m.f11, m.f12)},
    "set_functions_13": functions_13,
    "order_switch": lambda m: switched(m, "order"),
    "switch_report": lambda m: switched(m, "report"),
    "sensor": lambda m: {
        "low_address": m.address >> 1 & 0x7F,
        "report": m.address >> 8 | m.level << 4 | (m.address & 1) << 5,
    },
    "answer": lambda m: {"opcode": m.opcode & 0x7F, "answer": m.ack1},
    "move_slot": lambda m: {"slot": m.src, "to": m.dst},
    "read_slot": lambda m: {"slot": m.slot, "unused": 0},
    "read_switch": lambda m: {"low_address": m.address & 0x7F, "order": m.address >> 7},
    "slot_data": slot_data,
}
"""Messages that it reads into values."""


class LocoNet:
    """Its messages, and what its interface does with bytes."""

    def __init__(self) -> None:
        self._module: Any = peer_module("pylnlib.Message")

    def frame(self, case: Case) -> bytes:
        if case.message in MADE:
            return bytes(MADE[case.message](self._module, case.values).data)
        head = [opcode(case.message)]
        if case.message in SIZES:
            head.append(SIZES[case.message])
        data = bytearray((*head, *payload(case.values), 0))
        return bytes(with_checksum(self._module.Message(data)).data)

    def values(self, case: Case, frame: bytes) -> Values:
        message = self._read(frame)
        assert message.length == len(frame)
        read = READ.get(case.message)
        return case.values if read is None else read(message)

    def _read(self, data: bytes) -> Any:
        if data[0] == WRITE_SLOT:  # it fails to read one
            return self._module.Message(data)
        return self._module.Message.from_data(data)

    def found(self, endpoint: str, data: bytes) -> Iterator[bytes]:
        """What its interface reads, from each byte that may begin a message."""
        at = 0
        while at + 2 <= len(data):
            size = self._size(data, at)
            yield data[at : at + size]
            at += size or 1

    def _size(self, data: bytes, at: int) -> int:
        if data[at] < 0x80:
            return 0
        size = int(self._module.Message.length(data[at], data[at + 1]))
        try:
            self._read(data[at : at + size])
        except (ValueError, IndexError):
            return 0
        return size


def opcode(message: str) -> int:
    messages = protocol_of(FOLDER / "loconet.yaml").messages
    return next(int(each.identity[0]) for each in messages if each.name == message)


def payload(values: Values) -> list[int]:
    content: list[int] = []
    for value in values.values():
        match value:
            case dict():
                content += payload(value)
            case list():
                content += value
            case _:
                content.append(value)
    return content


@pytest.fixture(scope="module")
def loconet() -> LocoNet:
    return LocoNet()


def as_known(case: Case) -> Case:
    """The case, with bits that it knows, and with addresses of 11 bits."""
    values = dict(case.values)
    known = {"set_sounds": 0x0F, "set_functions_9": 0x0F, "set_direction_and_lights": 0x3F}
    if case.message in known:
        values["functions"] &= known[case.message]
    if case.message == "set_functions_13":
        values["group"] = (5, 8, 9)[values["group"] % 3]
        bits = payload(values["functions"])[0]
        values["functions"] = {"value": bits & (0x70 if values["group"] == 5 else 0x7F)}
    if "order" in values:
        values["order"] &= 0x0F if case.message == "read_switch" else 0x3F
    if case.message in ("switch_report", "sensor"):
        values["report"] &= 0x3F
    if case.message == "read_slot":
        values["unused"] = 0
    if case.message == "slot_data":
        data = values["data"]
        known = {"direction_and_lights": 0x3F, "sounds": 0x0F, "high_address": 0x0F}
        masked = {name: data[name] & mask for name, mask in known.items() if name in data}
        values["data"] = data | masked
    return replace(case, values=values)


def drawn() -> list[Case]:
    cases = [*cases_of("loconet"), *cases_of("loconet", ["slot_data"], seed=2)[:100]]
    known = [as_known(case) for case in cases if is_known(case)]
    assert len(known) >= FRAMES
    return known


def is_known(case: Case) -> bool:
    """False for what it sums up wrongly, and for slots of which it knows no data of their own."""
    if case.message == "slot_data":
        return case.values["slot"] not in SPECIAL_SLOTS
    return case.message != ODD


def test_both_make_and_read_the_same_messages(loconet: LocoNet) -> None:
    compare_frames("loconet", loconet, drawn())


def test_no_message_is_lost_that_it_finds(loconet: LocoNet) -> None:
    compare_recovery("loconet", "node", loconet, drawn())
