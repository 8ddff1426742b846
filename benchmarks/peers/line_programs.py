"""Programs that take messages of a serial port, each in a process of its own.

    python line_programs.py NAME PORT COUNT

Prints `ready`, takes so many messages with the time of each, and prints what it measured as JSON.
"""

from __future__ import annotations

import asyncio
import json
import sys
import threading
import time
from array import array
from collections.abc import Callable
from pathlib import Path
from typing import Any

ROOT = Path(__file__).resolve().parent.parent.parent
sys.path[:0] = [str(ROOT), str(ROOT / "benchmarks")]

_IDLE = 3.0
"""Seconds of silence in which the time of the processor is measured, too."""
_BAUD = 1_000_000


class Taker:
    """Takes the time of each message; of the first and the last, that of the processor as well."""

    def __init__(self, count: int) -> None:
        self._count = count
        self.times = array("q")
        self.has_all = False
        self._begun = self._ended = 0.0

    def take(self, message: object) -> bool:
        """Take a message; True if it was the last one."""
        times = self.times
        times.append(time.perf_counter_ns())
        if len(times) == 1:
            self._begun = time.process_time()
        if len(times) == self._count:
            self._ended = time.process_time()
            self.has_all = True
        return self.has_all

    def report(self) -> None:
        """Be idle for a while, and print what was measured."""
        before = time.process_time()
        time.sleep(_IDLE)
        idle = (time.process_time() - before) / _IDLE
        lasted = (self.times[-1] - self.times[0]) / 1e9
        busy = (self._ended - self._begun) / lasted
        print(json.dumps({"busy": busy, "idle": idle, "times": list(self.times)}), flush=True)


Program = Callable[[str, Taker], None]
"""Opens a port, says that it is ready, and takes messages."""


def ready() -> None:
    """Say that bytes may come."""
    print("ready", flush=True)


def _linked(module: Any, endpoint: str | None, *names: str) -> Program:
    """Protogen's link: messages as an asynchronous stream."""

    async def take(port: str, taker: Taker) -> None:
        kinds = [getattr(module, name) for name in names]
        async with _connected(module, port, endpoint) as link:
            stream = link.messages(*kinds, limit=1_000_000)
            ready()
            async for message in stream:
                if taker.take(message):
                    break
            await asyncio.to_thread(taker.report)

    return lambda port, taker: asyncio.run(take(port, taker))


def _blocking(module: Any, endpoint: str | None, *names: str) -> Program:
    """The same without async."""

    def take(port: str, taker: Taker) -> None:
        kinds = [getattr(module, name) for name in names]
        with _connected(module, port, endpoint) as link:
            stream = link.messages(*kinds, limit=1_000_000)
            ready()
            for message in stream:
                if taker.take(message):
                    break
            taker.report()

    return take


def _connected(module: Any, port: str, endpoint: str | None) -> Any:
    from protogen.link import connect

    return connect(module, port, endpoint, baud=_BAUD)


def _rn1_link(port: str, taker: Taker) -> None:
    from generated.python import rn1

    _linked(rn1, "host", "Gyro")(port, taker)


def _rn1_blocking(port: str, taker: Taker) -> None:
    from generated.python import rn1

    _blocking(rn1, "host", "Gyro")(port, taker)


def _rn1_by_hand(port: str, taker: Taker) -> None:
    """pyserial, and a loop that waits for a byte and takes what is there with it."""
    import serial

    from peers import slotted_rn1

    decoder = slotted_rn1.Decoder()
    with serial.Serial(port, _BAUD) as opened:
        ready()
        while not taker.has_all:
            for event in decoder.feed(opened.read(max(1, opened.in_waiting))):
                if isinstance(getattr(event, "message", None), slotted_rn1.Gyro):
                    taker.take(event.message)
        _report_beside(taker, lambda: opened.read(1))


def _library(name: str) -> Any:
    import protogen

    return protogen.module_of(protogen.load(f"library:{name}"))


def _mavlink_link(port: str, taker: Taker) -> None:
    _linked(_library("mavlink2"), None, "Attitude", "Heartbeat")(port, taker)


def _mavlink_blocking(port: str, taker: Taker) -> None:
    _blocking(_library("mavlink2"), None, "Attitude", "Heartbeat")(port, taker)


def _pymavlink(port: str, taker: Taker) -> None:
    """`recv_match`, as its examples have it."""
    from pymavlink import mavutil

    opened = mavutil.mavlink_connection(port, baud=_BAUD, dialect="common")
    ready()
    while not taker.has_all:
        message = opened.recv_match(blocking=True)
        if message.get_type() in ("ATTITUDE", "HEARTBEAT"):
            taker.take(message)
    _report_beside(taker, lambda: opened.recv_match(blocking=True))


def _sbp_link(port: str, taker: Taker) -> None:
    _linked(_library("sbp"), None, "ImuRaw", "GpsTime")(port, taker)


def _sbp_blocking(port: str, taker: Taker) -> None:
    _blocking(_library("sbp"), None, "ImuRaw", "GpsTime")(port, taker)


def _libsbp(port: str, taker: Taker) -> None:
    """Driver, framer and handler, which calls back in its thread."""
    import warnings

    from sbp.client import Framer, Handler
    from sbp.client.drivers.pyserial_driver import PySerialDriver
    from sbp.imu import SBP_MSG_IMU_RAW
    from sbp.navigation import SBP_MSG_GPS_TIME

    warnings.filterwarnings("ignore", category=DeprecationWarning)
    done = threading.Event()

    def take(message: Any, **metadata: Any) -> None:
        if taker.take(message):
            done.set()

    driver = PySerialDriver(port, _BAUD)
    handler = Handler(Framer(driver.read, driver.write))
    handler.add_callback(take, [SBP_MSG_IMU_RAW, SBP_MSG_GPS_TIME])
    handler.start()
    ready()
    done.wait()
    taker.report()


def _report_beside(taker: Taker, wait: Callable[[], object]) -> None:
    """Report while another thread waits for bytes, as the program does on a silent line."""
    threading.Thread(target=wait, daemon=True).start()
    taker.report()
    sys.stdout.flush()


PROGRAMS: dict[str, Program] = {
    "rn1, protogen": _rn1_link,
    "rn1, protogen without async": _rn1_blocking,
    "rn1, pyserial and a loop by hand": _rn1_by_hand,
    "MAVLink 2, protogen": _mavlink_link,
    "MAVLink 2, protogen without async": _mavlink_blocking,
    "MAVLink 2, pymavlink": _pymavlink,
    "SBP, protogen": _sbp_link,
    "SBP, protogen without async": _sbp_blocking,
    "SBP, libsbp": _libsbp,
}


def main() -> None:
    name, port, count = sys.argv[1:]
    PROGRAMS[name](port, Taker(int(count)))


if __name__ == "__main__":
    main()
    # Threads that wait for bytes never end.
    sys.stdout.flush()
    import os

    os._exit(0)
