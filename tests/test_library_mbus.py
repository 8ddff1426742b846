"""Wired M-Bus, beside pyMeterBus."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import pytest
from library_support import cases_of, compare_frames, compare_recovery, peer_module

from protogen.copying import replace
from protogen.fuzzing.samples import Values
from protogen.fuzzing.trips import Case

PEER = "pymeterbus"
SHORT = {"reset": 0x40, "request_alarm": 0x5A, "request_data": 0x5B}
COMMANDS = {
    "reset_application": 0x50,
    "send": 0x51,
    "send_high_first": 0x55,
    "select": 0x52,
    "select_high_first": 0x56,
    "synchronize": 0x54,
    "set_baud": None,
    "read_ram": 0xB1,
    "write_ram": 0xB2,
    "calibrate": 0xB3,
    "read_eeprom": 0xB4,
    "test_software": 0xB6,
}
ANSWERS = {
    "error": 0x70,
    "alarm": 0x71,
    "data": 0x72,
    "data_high_first": 0x76,
    "data_without_header": 0x78,
    "counters": 0x73,
    "counters_high_first": 0x77,
}
"""The byte that tells what data are."""
READ = ("data", "data_high_first", "data_without_header")
"""What it reads."""
MANUFACTURER_SPECIFIC = 0x0F
"""The byte behind which there are no records that it could not read."""
SIZES = {
    "number": 4,
    "manufacturer": 2,
    "signature": 2,
    "counter_1": 4,
    "counter_2": 4,
}
"""Bytes of numbers; all others have one."""


class MeterBus:
    """Its telegrams."""

    def __init__(self) -> None:
        self._module: Any = peer_module("meterbus")
        self._errors: Any = peer_module("meterbus.exceptions")

    def frame(self, case: Case) -> bytes:
        module = self._module
        if case.message == "ack":
            return bytes(module.TelegramACK())
        control = self._control(case)
        if case.message in SHORT:
            telegram = module.TelegramShort()
        else:
            content = payload(case)
            telegram = module.TelegramLong() if content else module.TelegramControl()
            telegram.body.bodyHeader.ci_field.parts = [information(case)]
            telegram.body.bodyPayload.set_payload(list(content))
        telegram.header.cField.parts = [control]
        telegram.header.aField.parts = [case.parts["address"]]
        return bytes(telegram)

    def _control(self, case: Case) -> int:
        module = self._module
        if case.message in ANSWERS:
            flags = case.parts["alarm"] * module.CONTROL_MASK_ACD
            flags |= case.parts["full"] * module.CONTROL_MASK_DFC
            return int(module.CONTROL_MASK_RSP_UD | flags)
        flags = case.parts["count"] * module.CONTROL_MASK_FCB
        function = SHORT.get(case.message, module.CONTROL_MASK_SND_UD)
        return int(function | module.CONTROL_MASK_DIR_M2S | flags)

    def values(self, case: Case, frame: bytes) -> Values:
        if case.message in SHORT:
            telegram = self._module.TelegramShort.parse(frame)
        elif case.message == "ack":
            assert self._module.TelegramACK.parse(frame)
            return {}
        elif len(frame) == 9:
            telegram = self._module.TelegramControl.parse(frame)
            assert telegram.body.bodyHeader.ci_field.parts == [information(case)]
        elif case.message in READ:
            telegram = self._module.TelegramLong.parse(frame)
        else:
            return case.values  # it reads no other data
        assert telegram.header.cField.parts == [self._control(case)]
        assert telegram.header.aField.parts == [case.parts["address"]]
        return read_data(case, telegram.body) if case.message in READ else case.values

    def found(self, endpoint: str, data: bytes) -> Iterator[bytes]:
        """What it takes for a telegram at the start of one."""
        at = 0
        while at < len(data):
            size = self._size(data[at:])
            yield data[at : at + size]
            at += size or 1

    def _size(self, data: bytes) -> int:
        module = self._module
        size = {0xE5: 1, 0x10: 5, 0x68: (data[1:2] or b"\0")[0] + 6}.get(data[0], 0)
        kinds = [module.TelegramACK, module.TelegramShort, module.TelegramControl]
        for kind in (*kinds, module.TelegramLong):
            try:
                kind.parse(data[:size])
            except (self._errors.MBusError, IndexError, ValueError):
                continue
            return size
        return 0


def information(case: Case) -> int:
    given = (COMMANDS | ANSWERS)[case.message]
    return int(case.parts["information"] if given is None else given)


def payload(case: Case) -> bytes:
    """The bytes behind the one that tells what they are, by the names of their numbers."""
    order: Any = "big" if case.message.endswith("high_first") else "little"
    content = b""
    for name, value in case.values.items():
        if isinstance(value, str):
            content += bytes.fromhex(value)
        elif isinstance(value, list):
            content += bytes(value)
        else:
            content += value.to_bytes(SIZES.get(name, 1), order)
    return content


def read_data(case: Case, body: Any) -> Values:
    records = {"records": bytes(body.bodyPayload.body.parts).hex()}
    if case.message == "data_without_header":
        return records
    header = body.bodyHeader
    return {
        "number": little(header.id_nr_field),
        "manufacturer": little(header.manufacturer_field),
        "version": little(header.version_field),
        "medium": little(header.measure_medium_field),
        "access": little(header.acc_nr_field),
        "status": little(header.status_field),
        "signature": little(header.sig_field),
        **records,
    }


def little(field: Any) -> int:
    """The number of a field, which has its low byte first in each mode."""
    return int.from_bytes(bytes(field.parts), "little")


@pytest.fixture(scope="module")
def meterbus() -> MeterBus:
    return MeterBus()


def as_read(case: Case) -> Case:
    """The case, with records that it does not take apart."""
    if case.message not in READ:
        return case
    records = bytearray.fromhex(case.values["records"])
    records[:1] = bytes((MANUFACTURER_SPECIFIC,))
    return replace(case, values=case.values | {"records": records.hex()})


def drawn(messages: Any) -> list[Case]:
    return [as_read(case) for case in cases_of("mbus", messages)]


def test_both_make_the_same_frames_of_a_master(meterbus: MeterBus) -> None:
    compare_frames("mbus", meterbus, drawn([*SHORT, *COMMANDS]))


def test_both_make_and_read_the_same_frames_of_a_slave(meterbus: MeterBus) -> None:
    compare_frames("mbus", meterbus, drawn(["ack", *ANSWERS]))


@pytest.mark.parametrize("endpoint", ["master", "slave"])
def test_no_frame_is_lost_that_it_finds(meterbus: MeterBus, endpoint: str) -> None:
    messages = [*SHORT, *COMMANDS] if endpoint == "master" else ["ack", *ANSWERS]
    # It refuses some control fields that we take.
    compare_recovery("mbus", endpoint, meterbus, drawn(messages), share=0.45)
