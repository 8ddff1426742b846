"""VESC, beside pyvesc."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import pytest
from library_support import (
    cases_of,
    compare_frames,
    compare_recovery,
    endpoint_of,
    engine_of,
    peer_module,
)

from protogen.fuzzing.samples import Values
from protogen.fuzzing.trips import Case

TEXT = [("text", "s")]
DATA = [("data", "s")]
FIELDS = {
    "host": {
        4: ("get_values", []),
        9: ("set_pos", [("position", "i")]),
        10: ("set_handbrake", [("current", "i")]),
        11: ("set_detect", [("mode", "B")]),
        12: ("set_servo_pos", [("position", "h")]),
        20: ("terminal_cmd", TEXT),
        29: ("reboot", []),
        30: ("alive", []),
        31: ("get_decoded_ppm", []),
    },
    "vesc": {
        4: (
            "values",
            [
                *[(name, "h") for name in ("temp_fet", "temp_motor")],
                *[(name, "i") for name in ("avg_motor_current", "avg_input_current")],
                *[("avg_id", "i"), ("avg_iq", "i"), ("duty_now", "h"), ("rpm", "i"), ("v_in", "h")],
                *[(f"{of}_hours{end}", "i") for of in ("amp", "watt") for end in ("", "_charged")],
                *[("tachometer", "i"), ("tachometer_abs", "i"), ("fault", "B")],
                *[("pid_pos", "i"), ("controller_id", "B")],
                *[(f"temp_mos{number}", "h") for number in (1, 2, 3)],
                *[("avg_vd", "i"), ("avg_vq", "i"), ("status", "B")],
            ],
        ),
        21: ("print", TEXT),
        22: ("rotor_position", [("position", "i")]),
        31: ("decoded_ppm", [("level", "i"), ("pulse", "i")]),
    },
}
"""Messages of firmware 6 by endpoint and number: pyvesc 1.0.5 has those of one before version 3."""
ITS_OWN = {
    5: ("set_duty", {"duty": "duty_cycle"}),
    6: ("set_current", {"current": "current"}),
    7: ("set_current_brake", {"current": "current_brake"}),
    8: ("set_rpm", {"rpm": "rpm"}),
}
"""Messages that are the same in pyvesc, with the names that it has for our fields."""


class Pyvesc:
    """pyvesc, with the messages of a firmware that it doesn't know yet."""

    def __init__(self) -> None:
        self._messages: Any = peer_module("pyvesc.messages.base").VESCMessage
        self._codec: Any = peer_module("pyvesc.packet.codec")
        setters = peer_module("pyvesc.messages.setters")
        known = self._messages._msg_registry
        assert known[5] is setters.SetDutyCycle
        self._registries = {"host": {number: known[number] for number in ITS_OWN}, "vesc": {}}
        self._numbers = {"host": {name: number for number, (name, _) in ITS_OWN.items()}}
        for endpoint, messages in FIELDS.items():
            self._use(endpoint)
            for number, (name, fields) in messages.items():
                self._messages(name, (), {"id": number, "fields": fields})
                self._numbers.setdefault(endpoint, {})[name] = number

    def _use(self, endpoint: str) -> dict[int, Any]:
        self._messages._msg_registry = self._registries[endpoint]
        return self._registries[endpoint]

    def _class(self, case: Case) -> tuple[Any, dict[str, str]]:
        endpoint = endpoint_of("vesc", case)
        number = self._numbers[endpoint][case.message]
        names = dict(ITS_OWN[number][1]) if endpoint == "host" and number in ITS_OWN else {}
        return self._use(endpoint)[number], names

    def frame(self, case: Case) -> bytes:
        kind, names = self._class(case)
        values = [case.values[name] for name in case.values]
        assert [names.get(name, name) for name in case.values] == kind._field_names
        message = kind(*values)
        return bytes(self._codec.frame(self._messages.pack(message)))

    def values(self, case: Case, frame: bytes) -> Values:
        _, names = self._class(case)
        payload, size = self._codec.unframe(frame)
        assert size == len(frame)
        message = self._messages.unpack(payload)
        return {name: getattr(message, names.get(name, name)) for name in case.values}

    def found(self, endpoint: str, data: bytes) -> Iterator[bytes]:
        """It looks for a frame at every start in turn."""
        while data:
            payload, size = self._codec.unframe(data)
            if payload is None and size == 0:
                data = data[1:]
                continue
            if payload is not None:
                yield bytes(self._codec.frame(payload))
            data = data[size:]


@pytest.fixture(scope="module")
def pyvesc() -> Pyvesc:
    return Pyvesc()


MESSAGES = [
    *[name for name, _ in ITS_OWN.values()],
    *[name for messages in FIELDS.values() for name, _ in messages.values()],
]


def test_both_make_and_read_the_same_frames(pyvesc: Pyvesc) -> None:
    compare_frames("vesc", pyvesc, cases_of("vesc", MESSAGES))


@pytest.mark.parametrize("endpoint", ["host", "vesc"])
def test_no_frame_is_lost_that_it_finds(pyvesc: Pyvesc, endpoint: str) -> None:
    compare_recovery("vesc", endpoint, pyvesc, cases_of("vesc"))


def test_a_packet_of_the_length_between_the_forms_is_sent_short_and_read_in_both() -> None:
    """255 bytes from the command on: those of a text of 254."""
    engine = engine_of("vesc")
    short = engine.frame("vesc_short", "print", {"text": "x" * 254}, {})
    assert short[:3] == bytes((2, 255, 21))
    long = bytes((3, 0, 255)) + short[2:]
    (event,) = engine.events("vesc_long", [long])
    assert (event.kind, event.values) == ("message", {"text": "x" * 254})
