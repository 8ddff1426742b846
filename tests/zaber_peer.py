"""The commands and replies of zaber-serial, with which the binary protocol of Zaber is compared."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

from library_support import peer_module

from protogen.fuzzing.samples import Values
from protogen.fuzzing.trips import Case

SIZE = 6
COMMANDS = {
    "reset": 0,
    "home": 1,
    "renumber": 2,
    "renumbered": 2,
    "read_register": 5,
    "register": 5,
    "select_register": 6,
    "write_register": 7,
    "limit_reached": 9,
    "moved_by_hand": 11,
    "slips": 12,
    "displaced": 13,
    "store_position": 16,
    "return_stored_position": 17,
    "stored_position": 17,
    "move_to_stored_position": 18,
    "move_absolute": 20,
    "move_relative": 21,
    "move_at_speed": 22,
    "stop": 23,
    "select_axis": 25,
    "set_axis_device": 26,
    "set_axis_inversion": 27,
    "set_axis_profile": 28,
    "set_axis_scale": 29,
    "load_event": 30,
    "return_event": 31,
    "set_calibration": 33,
    "restore_settings": 36,
    "set_resolution": 37,
    "set_running_current": 38,
    "set_hold_current": 39,
    "set_mode": 40,
    "set_home_speed": 41,
    "set_target_speed": 42,
    "set_acceleration": 43,
    "set_maximum": 44,
    "set_position": 45,
    "set_maximum_relative_move": 46,
    "set_home_offset": 47,
    "set_alias": 48,
    "set_lock": 49,
    "device_type": 50,
    "firmware_version": 51,
    "voltage": 52,
    "return_setting": 53,
    "status": 54,
    "echo": 55,
    "firmware_build": 56,
    "position": 60,
    "serial_number": 63,
    "park": 65,
    "set_peripheral": 66,
    "move_to_index": 78,
    "set_index_distance": 79,
    "set_cycle_distance": 80,
    "set_filter_holder": 81,
    "set_answers_disabled": 101,
    "set_identifiers": 102,
    "set_home_status": 103,
    "set_home_sensor": 104,
    "set_auto_home_disabled": 105,
    "set_minimum": 106,
    "set_knob_disabled": 107,
    "set_knob_direction": 108,
    "set_knob_mode": 109,
    "set_knob_step": 110,
    "set_knob_scale": 111,
    "set_knob_profile": 112,
    "set_acceleration_only": 113,
    "set_deceleration_only": 114,
    "set_tracking": 115,
    "set_manual_tracking_disabled": 116,
    "set_tracking_period": 117,
    "set_closed_loop_mode": 118,
    "set_slip_tracking_period": 119,
    "set_stall_timeout": 120,
    "set_direction": 121,
    "set_baud": 122,
    "set_protocol": 123,
    "convert_to_ascii": 124,
    "error": 255,
}
"""The number of each command and answer that has one only."""


class ZaberSerial:
    """The commands and replies of zaber-serial."""

    def __init__(self, with_identifiers: bool) -> None:
        self._module: Any = peer_module("zaber.serial")
        self._with_identifiers = with_identifiers

    def frame(self, case: Case) -> bytes:
        ((_, value),) = case.values.items()
        parts = case.parts
        command = self._module.BinaryCommand(
            parts["device"],
            self._number(case),
            signed(value, 32),
            parts.get("identifier"),
        )
        return bytes(command.encode())

    def values(self, case: Case, frame: bytes) -> Values:
        reply = self._module.BinaryReply(frame, self._with_identifiers)
        assert reply.device_number == case.parts["device"]
        assert reply.command_number == self._number(case)
        assert reply.message_id == case.parts.get("identifier")
        ((name, value),) = case.values.items()
        assert reply.data == signed(value, 24 if self._with_identifiers else 32)
        return {name: value}

    def _number(self, case: Case) -> int:
        number: int = case.parts["command"] if "command" in case.parts else COMMANDS[case.message]
        return number

    def found(self, endpoint: str, data: bytes) -> Iterator[bytes]:
        """Each six bytes, which it reads whatever they are."""
        for at in range(0, len(data) - SIZE + 1, SIZE):
            frame = data[at : at + SIZE]
            self._module.BinaryReply(frame, self._with_identifiers)
            yield frame


def signed(value: int, bits: int) -> int:
    """The number that it has for one without a sign."""
    return value - (1 << bits) if value >> (bits - 1) == 1 else value
