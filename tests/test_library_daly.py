"""Daly battery management systems, beside dalybms."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from struct import pack
from typing import Any

import pytest
from library_support import cases_of, compare_frames, compare_recovery, peer_module

from protogen.copying import replace
from protogen.fuzzing.samples import Values
from protogen.fuzzing.trips import Case

PEER = "dalybms"
SIZE = 13
COMMANDS: dict[str, Callable[[Any, Values], Any]] = {
    "read_totals": lambda bms, v: bms.get_soc(),
    "read_voltage_range": lambda bms, v: bms.get_cell_voltage_range(),
    "read_temperature_range": lambda bms, v: bms.get_temperature_range(),
    "read_transistors": lambda bms, v: bms.get_mosfet_status(),
    "read_status": lambda bms, v: bms.get_status(),
    "read_cell_voltages": lambda bms, v: bms._read_request("95"),
    "read_temperatures": lambda bms, v: bms._read_request("96"),
    "read_balancing": lambda bms, v: bms.get_balancing_status(),
    "read_faults": lambda bms, v: bms._read_request("98"),
    "switch_charging": lambda bms, v: bms.set_charge_mosfet(v["on"]),
    "switch_discharging": lambda bms, v: bms.set_discharge_mosfet(v["on"]),
    "set_charge": lambda bms, v: bms._read_request("21", extra=f"{0:012X}{v['charge']:04X}"),
    "restart": lambda bms, v: bms.restart(),
}
"""Its methods, or what they call where they fail by Bluetooth or without an answer."""
ANSWERS = {
    "totals": (0x90, ">HHHH"),
    "voltage_range": (0x91, ">HBHB2s"),
    "temperature_range": (0x92, ">4B4s"),
    "transistors": (0x93, ">B??BI"),
    "status": (0x94, ">BB??BHB"),
    "cell_voltages": (0x95, ">B3HB"),
    "temperatures": (0x96, ">8B"),
    "balancing": (0x97, ">6s2s"),
    "faults": (0x98, ">8B"),
    "switched": (None, ">?7s"),
    "done": (None, ">8s"),
}
"""Commands that are answered, and the data of the answer: it makes none."""
SIGNED = {
    "totals": (0x8000, ("voltage", "current", "charge")),
    "voltage_range": (0x8000, ("highest", "lowest")),
    "temperature_range": (0x80, ("highest", "lowest", "highest_sensor", "lowest_sensor")),
    "transistors": (0x80000000, ("capacity",)),
    "status": (0x80, ("cells", "sensors", "ports")),
    "cell_voltages": (0x8000, ()),
    "temperatures": (0x80, ()),
}
"""Half of the numbers that there are, for those to which it gives a sign."""


class Port:
    """A serial port, with what is there to read and what was written."""

    is_open = True

    def __init__(self, data: bytes = b"") -> None:
        self.data = data
        self.written = b""

    def write(self, data: bytes) -> int:
        self.written = bytes(data)
        return len(data)

    def read(self, size: int) -> bytes:
        piece, self.data = self.data[:size], self.data[size:]
        return piece

    def reset_input_buffer(self) -> None:
        """Nothing is left from before."""

    reset_output_buffer = reset_input_buffer


class DalyBms:
    """Its class, on a port that is none."""

    def __init__(self) -> None:
        self._class: Any = peer_module("dalybms").DalyBMS
        self._names: Any = peer_module("dalybms.error_codes").ERROR_CODES

    def _bms(self, data: bytes = b"", address: int = 4) -> tuple[Any, Port]:
        bms, port = self._class(request_retries=1, address=address), Port(data)
        bms.serial = port
        bms.status = {"cells": 48, "temperature_sensors": 14}
        bms.logger.disabled = True
        return bms, port

    def frame(self, case: Case) -> bytes:
        if case.message in ANSWERS:
            number, layout = ANSWERS[case.message]
            command = case.parts.get("command", number)
            head = bytes((0xA5, case.parts["address"], command, 8))
            content = head + pack(layout, *packed(case.values))
            return content + bytes(self._class._calc_crc(content))
        bms, port = self._bms(address=case.parts["address"] >> 4)
        bms.serial.read = lambda size: b""
        bms._read_request = bms._read  # It waits before it tries again.
        COMMANDS[case.message](bms, case.values)
        return port.written

    def values(self, case: Case, frame: bytes) -> Values:
        if case.message in COMMANDS:
            return case.values  # it reads no command
        bms, _ = self._bms()
        data = Port(frame).read(SIZE)[4:-1]
        assert bms._calc_crc(frame[:-1]) == frame[-1:]
        return case.values | READ[case.message](self, bms, data, case.values)

    def faults(self, data: bytes, values: Values) -> Values:
        """The case's values, if it names as many faults as there are bits."""
        bms, _ = self._bms()
        names = bms.get_errors(data)
        bits = [(at, bit) for at, byte in enumerate(data) for bit in range(8) if byte >> bit & 1]
        assert names == [self._names[at][bit] for at, bit in bits]
        return values

    def found(self, endpoint: str, data: bytes) -> Iterator[bytes]:
        """What it reads at each start, if the sum is the one that it works out."""
        at = data.find(0xA5)
        while at >= 0:
            frame = data[at : at + SIZE]
            if len(frame) == SIZE and self._class._calc_crc(frame[:-1]) == frame[-1:]:
                yield frame
                at += SIZE - 1
            at = data.find(0xA5, at + 1)


def totals(peer: DalyBms, bms: Any, data: bytes, values: Values) -> Values:
    found = bms.get_soc(data)
    return {
        "voltage": round(found["total_voltage"] * 10),
        "current": round(found["current"] * 10) + 30000,
        "charge": round(found["soc_percent"] * 10),
    }


def voltage_range(peer: DalyBms, bms: Any, data: bytes, values: Values) -> Values:
    found = bms.get_cell_voltage_range(data)
    return {
        "highest": round(found["highest_voltage"] * 1000),
        "highest_cell": found["highest_cell"] & 0xFF,
        "lowest": round(found["lowest_voltage"] * 1000),
        "lowest_cell": found["lowest_cell"] & 0xFF,
    }


def temperature_range(peer: DalyBms, bms: Any, data: bytes, values: Values) -> Values:
    found = bms.get_temperature_range(data)
    return {
        "highest": found["highest_temperature"] + 40,
        "highest_sensor": found["highest_sensor"],
        "lowest": found["lowest_temperature"] + 40,
        "lowest_sensor": found["lowest_sensor"],
    }


def transistors(peer: DalyBms, bms: Any, data: bytes, values: Values) -> Values:
    found = bms.get_mosfet_status(data)
    modes = {0: "stationary", 1: "charging"}
    assert found["mode"] == modes.get(values["state"], "discharging")
    return {
        "charging": int(found["charging_mosfet"]),
        "discharging": int(found["discharging_mosfet"]),
        "capacity": round(found["capacity_ah"] * 1000),
    }


def status(peer: DalyBms, bms: Any, data: bytes, values: Values) -> Values:
    found = bms.get_status(data)
    return {
        "cells": found["cells"],
        "sensors": found["temperature_sensors"],
        "charger": int(found["charger_running"]),
        "load": int(found["load_running"]),
        "ports": sum(is_on << bit for bit, is_on in enumerate(found["states"].values())),
        "cycles": found["cycles"] & 0xFFFF,
    }


def cell_voltages(peer: DalyBms, bms: Any, data: bytes, values: Values) -> Values:
    # It expects all frames, in order.
    frames = [bytes((number, *data[1:])) for number in range(1, 17)]
    found = list(bms.get_cell_voltages(frames).values())[3 * values["number"] - 3 :][:3]
    return {"voltages": [round(voltage * 1000) for voltage in found]}


def temperatures(peer: DalyBms, bms: Any, data: bytes, values: Values) -> Values:
    frames = [bytes((number, *data[1:])) for number in range(1, 3)]
    found = list(bms.get_temperatures(frames).values())[7 * values["number"] - 7 :][:7]
    return {"temperatures": [temperature + 40 for temperature in found]}


READ: dict[str, Callable[[DalyBms, Any, bytes, Values], Values]] = {
    "totals": totals,
    "voltage_range": voltage_range,
    "temperature_range": temperature_range,
    "transistors": transistors,
    "status": status,
    "cell_voltages": cell_voltages,
    "temperatures": temperatures,
    "balancing": lambda peer, bms, data, values: {},  # it begins at the wrong end
    "faults": lambda peer, bms, data, values: peer.faults(data, values),
    "switched": lambda peer, bms, data, values: {},
    "done": lambda peer, bms, data, values: {},
}
"""The values that it names."""


def packed(values: Values) -> Iterator[Any]:
    """The values as struct takes them."""
    for name, value in values.items():
        if name == "cells" and isinstance(value, list):
            bits = sum(is_on << bit for bit, is_on in enumerate(value))
            yield bits.to_bytes(6, "little")
        elif isinstance(value, list):
            yield from value
        else:
            yield bytes.fromhex(value) if isinstance(value, str) else value


def as_read(case: Case) -> Case:
    """The case, as it sends or reads it: without a sign, and faults that have names."""
    values, parts = dict(case.values), dict(case.parts)
    half, names = SIGNED.get(case.message, (1, ()))
    values |= {name: values[name] % half for name in names}
    if case.message in COMMANDS:
        parts["address"] = parts["address"] % 9 + 1 << 4
    match case.message:
        case "set_charge":
            values |= dict.fromkeys(("year", "month", "day", "hour", "minute", "second"), 0)
        case "cell_voltages":
            voltages = [voltage % half for voltage in values["voltages"]]
            values |= {"number": values["number"] % 16 + 1, "voltages": voltages}
        case "temperatures":
            found = [temperature % half for temperature in values["temperatures"]]
            values |= {"number": values["number"] % 2 + 1, "temperatures": found}
        case "faults":
            values |= {"difference": values["difference"] % 16, "code": 0}
    return replace(case, values=values, parts=parts)


@pytest.fixture(scope="module")
def dalybms() -> DalyBms:
    return DalyBms()


def test_both_make_the_same_commands(dalybms: DalyBms) -> None:
    compare_frames("daly", dalybms, map(as_read, cases_of("daly", COMMANDS)))


def test_it_reads_the_answers_that_we_make(dalybms: DalyBms) -> None:
    compare_frames("daly", dalybms, map(as_read, cases_of("daly", ANSWERS)))


def test_no_frame_is_lost_that_it_finds(dalybms: DalyBms) -> None:
    compare_recovery("daly", "bms", dalybms, cases_of("daly", ANSWERS))
