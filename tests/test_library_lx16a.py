"""LewanSoul and Hiwonder bus servos, beside pylx16a."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from typing import Any

import pytest
from library_support import cases_of, compare_frames, compare_recovery, endpoint_of, peer_module

from protogen.copying import replace
from protogen.fuzzing.samples import Values
from protogen.fuzzing.trips import Case

STEP = 240 / 1000
"""Degrees of one step of an angle."""

COMMANDS: dict[str, Callable[[Any, Values], Any]] = {
    "move": lambda servo, v: servo.move(v["angle"] * STEP, v["time"]),
    "read_move": lambda servo, v: servo.get_last_instant_move_hw(),
    "prepare_move": lambda servo, v: servo.move(v["angle"] * STEP, v["time"], wait=True),
    "read_prepared_move": lambda servo, v: servo.get_last_delayed_move_hw(),
    "start": lambda servo, v: servo.move_start(),
    "stop": lambda servo, v: servo.move_stop(),
    "write_id": lambda servo, v: servo.set_id(v["number"]),
    "read_id": lambda servo, v: servo.get_id(poll_hardware=True),
    "adjust_offset": lambda servo, v: servo.set_angle_offset(v["offset"] * STEP),
    "save_offset": lambda servo, v: servo.set_angle_offset(0, permanent=True),
    "read_offset": lambda servo, v: servo.get_angle_offset(poll_hardware=True),
    "write_angle_limits": lambda servo, v: servo.set_angle_limits(v["min"] * STEP, v["max"] * STEP),
    "read_angle_limits": lambda servo, v: servo.get_angle_limits(poll_hardware=True),
    "write_voltage_limits": lambda servo, v: servo.set_vin_limits(v["min"], v["max"]),
    "read_voltage_limits": lambda servo, v: servo.get_vin_limits(poll_hardware=True),
    "write_temperature_limit": lambda servo, v: servo.set_temp_limit(v["max"]),
    "read_temperature_limit": lambda servo, v: servo.get_temp_limit(poll_hardware=True),
    "read_temperature": lambda servo, v: servo.get_temp(),
    "read_voltage": lambda servo, v: servo.get_vin(),
    "read_position": lambda servo, v: servo.get_physical_angle(),
    "write_mode": lambda servo, v: (
        servo.motor_mode(v["speed"]) if v["mode"] else servo.servo_mode()
    ),
    "read_mode": lambda servo, v: servo.is_motor_mode(poll_hardware=True),
    "write_power": lambda servo, v: servo.enable_torque() if v["power"] else servo.disable_torque(),
    "read_power": lambda servo, v: servo.is_torque_enabled(poll_hardware=True),
    "write_led": lambda servo, v: servo.led_power_off() if v["led"] else servo.led_power_on(),
    "read_led": lambda servo, v: servo.is_led_power_on(poll_hardware=True),
    "write_alarms": lambda servo, v: servo.set_led_error_triggers(
        bool(v["alarms"] & 1), bool(v["alarms"] & 2), bool(v["alarms"] & 4)
    ),
    "read_alarms": lambda servo, v: servo.get_led_error_triggers(poll_hardware=True),
}
"""Each command by a method of it, whose values are degrees and states."""
ANSWERS = {
    "last_move": (2, [("angle", 2), ("time", 2)]),
    "prepared_move": (8, [("angle", 2), ("time", 2)]),
    "id": (14, [("number", 1)]),
    "saved_offset": (19, [("offset", 1)]),
    "angle_limits": (21, [("min", 2), ("max", 2)]),
    "voltage_limits": (23, [("min", 2), ("max", 2)]),
    "temperature_limit": (25, [("max", 1)]),
    "present_temperature": (26, [("temperature", 1)]),
    "present_voltage": (27, [("voltage", 2)]),
    "present_position": (28, [("angle", 2)]),
    "present_mode": (30, [("mode", 1), ("unused", 1), ("speed", 2)]),
    "present_power": (32, [("power", 1)]),
    "present_led": (34, [("led", 1)]),
    "present_alarms": (36, [("alarms", 1)]),
}
"""Commands that are answered, and the bytes of each value: it makes no answers."""


class Controller:
    """A serial port as it has one, with what is there to read and what was written."""

    def __init__(self) -> None:
        self.data = b""
        self.packets: list[bytes] = []

    def write(self, data: bytes) -> None:
        self.packets.append(data)

    def read(self, size: int) -> bytes:
        piece, self.data = self.data[:size], self.data[size:]
        return piece

    def flushInput(self) -> None:  # noqa: N802 - as pyserial calls it
        self.data = b""


class Pylx16a:
    """A servo of pylx16a with any number, of which it knows that the motor holds."""

    def __init__(self) -> None:
        self._module: Any = peer_module("pylx16a.lx16a")
        self._port = self._module.LX16A._controller = Controller()

    def _servo(self, number: int) -> Any:
        servo = self._module.LX16A.__new__(self._module.LX16A)  # Else it asks a real one.
        servo._id = number
        servo._torque_enabled, servo._motor_mode = True, False
        servo._angle_limits = 0, 1000
        servo._commanded_angle, servo._waiting_angle, servo._waiting_for_move = 0, 0, True
        return servo

    def frame(self, case: Case) -> bytes:
        number = case.parts["id"]
        self._port.packets.clear()
        if case.message in ANSWERS:
            command, fields = ANSWERS[case.message]
            content = [
                byte
                for name, size in fields
                for byte in self._module.LX16A._to_bytes(case.values[name] % 256**size)[:size]
            ]
            self._module.LX16A._send_packet([number, len(content) + 3, command, *content])
        else:
            self._port.data = b""
            try:
                COMMANDS[case.message](self._servo(number), case.values)
            except self._module.ServoTimeoutError:
                assert case.message.startswith("read_") or case.message == "stop"
        # Behind a stop it asks where the servo is.
        return self._port.packets[0 if case.message == "stop" else -1]

    def values(self, case: Case, frame: bytes) -> Values:
        if endpoint_of("lx16a", case) == "host":
            return case.values  # it reads no command
        servo = self._servo(case.parts["id"])
        self._port.data = frame
        match case.message:
            case "last_move":
                return moved(servo.get_last_instant_move_hw())
            case "prepared_move":
                return moved(servo.get_last_delayed_move_hw())
            case "angle_limits":
                low, high = servo.get_angle_limits(poll_hardware=True)
                return {"min": round(low / STEP), "max": round(high / STEP)}
            case "voltage_limits":
                return dict(zip(("min", "max"), servo.get_vin_limits(True), strict=True))
            case "present_mode":
                return self._mode(servo, case, frame)
            case _:
                (name,) = case.values
                return {name: ONE_VALUE[case.message](servo)}

    def _mode(self, servo: Any, case: Case, frame: bytes) -> Values:
        is_motor = servo.is_motor_mode(poll_hardware=True)
        if not is_motor:
            return {"mode": 0, "unused": 0, "speed": case.values["speed"]}  # it reads none
        servo._motor_mode = True
        self._port.data = frame
        return {"mode": 1, "unused": 0, "speed": servo.get_motor_speed(poll_hardware=True)}

    def found(self, endpoint: str, data: bytes) -> Iterator[bytes]:
        """What it takes for an answer at a header, whose size it is told."""
        at = 0
        while (at := data.find(b"\x55\x55", at)) >= 0:
            size = (data[at + 3 : at + 4] or b"\0")[0] + 3
            self._port.data = data[at : at + size]
            try:
                self._module.LX16A._read_packet(size - 6, 0)
            except self._module.ServoError:
                at += 1
                continue
            yield data[at : at + size]
            at += size


def moved(given: tuple[float, int]) -> Values:
    angle, time = given
    return {"angle": round(angle / STEP), "time": time}


ONE_VALUE: dict[str, Callable[[Any], int]] = {
    "id": lambda servo: int(servo.get_id(poll_hardware=True)),
    "saved_offset": lambda servo: round(servo.get_angle_offset(poll_hardware=True) / STEP),
    "temperature_limit": lambda servo: int(servo.get_temp_limit(poll_hardware=True)),
    "present_temperature": lambda servo: int(servo.get_temp()),
    "present_voltage": lambda servo: int(servo.get_vin()),
    "present_position": lambda servo: round(servo.get_physical_angle() / STEP),
    "present_power": lambda servo: int(servo.is_torque_enabled(poll_hardware=True)),
    "present_led": lambda servo: int(not servo.is_led_power_on(poll_hardware=True)),
    "present_alarms": lambda servo: sum(
        is_set << bit for bit, is_set in enumerate(servo.get_led_error_triggers(True))
    ),
}
"""Answers with a single value, as it reads them."""


@pytest.fixture(scope="module")
def pylx16a() -> Pylx16a:
    return Pylx16a()


def valid(case: Case) -> Case:
    """The case, as it may be sent: limits in order, known states, a speed only of a motor."""
    values = dict(case.values)
    if case.message in ("write_angle_limits", "write_voltage_limits"):
        values["min"], values["max"] = sorted((values["min"], values["max"]))
    for name in ("mode", "power", "led"):
        if name in values:
            values[name] %= 2
    if case.message == "write_mode" and values["mode"] == 0:
        values["speed"] = 0
    return replace(case, values=values)


def test_both_make_the_same_commands(pylx16a: Pylx16a) -> None:
    compare_frames("lx16a", pylx16a, map(valid, cases_of("lx16a", COMMANDS)))


def test_both_make_and_read_the_same_answers(pylx16a: Pylx16a) -> None:
    compare_frames("lx16a", pylx16a, map(valid, cases_of("lx16a", ANSWERS)))


@pytest.mark.parametrize("endpoint", ["host", "servo"])
def test_no_frame_is_lost_that_it_finds(pylx16a: Pylx16a, endpoint: str) -> None:
    compare_recovery("lx16a", endpoint, pylx16a, cases_of("lx16a"))
