"""CAN adapters of LAWICEL, beside python-can."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from typing import Any

import pytest
from compiled import protocol_of
from library_support import cases_of, compare_frames, compare_recovery, peer_module

from protogen.copying import replace
from protogen.fuzzing.samples import Values
from protogen.fuzzing.trips import Case
from protogen.library import FOLDER

PEER = "python_can"
SIZES = [*range(9), 12, 16, 20, 24, 32, 48, 64]
"""Bytes of data by the number that is sent."""
BITRATES = [10000, 20000, 50000, 100000, 125000, 250000, 500000, 750000, 1000000, 83300]
FRAMES = {
    "send": {},
    "send_extended": {"is_extended_id": True},
    "send_remote": {"is_remote_frame": True},
    "send_extended_remote": {"is_extended_id": True, "is_remote_frame": True},
    "send_fd": {"is_fd": True},
    "send_fd_extended": {"is_fd": True, "is_extended_id": True},
    "send_fd_fast": {"is_fd": True, "bitrate_switch": True},
    "send_fd_fast_extended": {"is_fd": True, "bitrate_switch": True, "is_extended_id": True},
}
"""What sets frames apart."""
COMMANDS: dict[str, Callable[[Any, Values], object]] = {
    "set_bitrate": lambda bus, v: bus.set_bitrate(BITRATES[v["bitrate"] % 10]),
    "set_data_bitrate": lambda bus, v: bus.set_bitrate(10000, v["bitrate"] * 1000000),
    "set_timing": lambda bus, v: bus.set_bitrate_reg(f"{v['btr0']:02X}{v['btr1']:02X}"),
    "open": lambda bus, v: bus.open(),
    "listen": lambda bus, v: bus.open(),
    "close": lambda bus, v: bus.close(),
    "read_version": lambda bus, v: bus.get_version(0),
    "read_serial_number": lambda bus, v: bus.get_serial_number(0),
}
"""Commands that it has methods for."""
TEXTS = {
    "poll": "P",
    "poll_all": "A",
    "read_status": "F",
    "set_automatic": "X{automatic:X}",
    "set_filter_mode": "W{mode:X}",
    "set_code": "M{code:08X}",
    "set_mask": "m{mask:08X}",
    "set_baud": "U{baud:X}",
    "set_times": "Z{times:X}",
    "set_start": "Q{start:X}",
    "sent": "z",
    "extended_sent": "Z",
    "polled": "A",
    "ok": "",
    "status": "F{flags:02X}",
    "version": "V{hardware:02d}{software:02d}",
    "serial_number": "N{number}",
}
"""Lines that it has no method for: it only ends them."""


class Port:
    """A serial port, with what is there to read, what was written, and what was read last."""

    write_timeout: float | None = None

    def __init__(self) -> None:
        self.data = b""
        self.lines: list[bytes] = []
        self.taken = b""

    @property
    def in_waiting(self) -> int:
        return len(self.data)

    def write(self, data: bytes) -> None:
        self.lines.append(data)

    def flush(self) -> None:
        """It is written at once."""

    def read(self, size: int) -> bytes:
        piece, self.data = self.data[:size], self.data[size:]
        self.taken += piece
        return piece


class PythonCan:
    """A bus of python-can on a port that is none."""

    def __init__(self) -> None:
        self._can: Any = peer_module("can")
        self._module: Any = peer_module("can.interfaces.slcan")

    def _bus(self, data: bytes = b"", listen_only: bool = False) -> tuple[Any, Port]:
        bus = self._module.slcanBus.__new__(self._module.slcanBus)  # Else it opens a real one.
        port = Port()
        bus.serialPortOrig, bus._listen_only = port, listen_only
        bus._queue, bus._buffer = self._module.SimpleQueue(), bytearray()
        bus._is_shutdown = True
        port.data = data
        return bus, port

    def frame(self, case: Case) -> bytes:
        if case.message == "error":
            return bytes(self._module.slcanBus._ERROR)
        bus, port = self._bus(listen_only=case.message == "listen")
        name = sending(case.message)
        if name in FRAMES:
            bus.send(self._can_frame(name, case.values))
            (line,) = port.lines
            times = "".join(f"{time:04X}" for time in case.values.get("time", ()))
            return line[:-1] + times.encode() + line[-1:]
        if name in COMMANDS:
            COMMANDS[name](bus, case.values)
            # It closes the bus before it sets a speed, and opens it behind.
            letter = {"set_bitrate": b"S", "set_data_bitrate": b"Y", "set_timing": b"s"}.get(name)
            return next(line for line in port.lines if letter is None or line[:1] == letter)
        bus._write(TEXTS[name].format_map(case.values))
        return port.lines[0]

    def _can_frame(self, name: str, values: Values) -> Any:
        size = SIZES[values["length"]]
        keys = {"is_extended_id": False, **FRAMES[name]}
        data = None if "remote" in name else octets(values)
        return self._can.Message(
            arbitration_id=values["identifier"], dlc=size, data=data, check=True, **keys
        )

    def values(self, case: Case, frame: bytes) -> Values:
        bus, _ = self._bus(frame)
        if case.message == "version":
            hardware, software = bus.get_version(1)
            return {"hardware": hardware, "software": software}
        if case.message == "serial_number":
            return {"number": bus.get_serial_number(1)}
        name = sending(case.message)
        if name not in FRAMES:
            return case.values  # it reads nothing of it
        message, _ = bus._recv_internal(0)
        assert message.equals(self._can_frame(name, case.values), timestamp_delta=None)
        return case.values

    def found(self, endpoint: str, data: bytes) -> Iterator[bytes]:
        """Yield the lines in which it sees frames of the bus."""
        bus, port = self._bus(data)
        while port.data:
            port.taken = b""
            bus._buffer.clear()
            try:
                message, _ = bus._recv_internal(0)
            except (ValueError, IndexError, self._can.CanError):  # It expects ASCII and digits.
                continue
            if message is not None:
                yield port.taken


def sending(message: str) -> str:
    """How the host's message is called, where the adapter has the same one."""
    return message.replace("received", "send")


def octets(values: Values) -> list[int]:
    data = values["data"]
    octets: list[int] = data["value"] if isinstance(data, dict) else data
    return octets


def valid(case: Case) -> Case:
    """The case, as python-can has it: bitrates that it knows, a number of visible characters."""
    values = dict(case.values)
    if case.message == "set_bitrate":
        values["bitrate"] %= 10
    elif case.message == "set_data_bitrate":
        values["bitrate"] = (2, 5)[values["bitrate"] % 2]
    elif case.message == "serial_number":
        values["number"] = f"{sum(values['number'].encode('latin-1')) % 10000:04d}"
    return replace(case, values=values)


def messages_from(endpoint: str) -> list[str]:
    senders = protocol_of(FOLDER / "slcan.yaml").senders
    own = (sender for sender in senders if sender.endpoint == endpoint)
    return sorted({message.name for sender in own for message in sender.messages})


@pytest.fixture(scope="module")
def python_can() -> PythonCan:
    return PythonCan()


@pytest.mark.parametrize("endpoint", ["host", "adapter"])
def test_both_make_and_read_the_same_lines(python_can: PythonCan, endpoint: str) -> None:
    drawn = cases_of("slcan", messages_from(endpoint))
    compare_frames("slcan", python_can, map(valid, drawn))


def test_no_frame_is_lost_that_it_finds(python_can: PythonCan) -> None:
    # It knows the lines that bring frames of CAN.
    drawn = map(valid, cases_of("slcan", messages_from("adapter")))
    compare_recovery("slcan", "adapter", python_can, drawn, share=0.1, begins_anew=False)
