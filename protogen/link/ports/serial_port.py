"""Serial ports, and those of other machines over TCP and RFC 2217.

serialx opens them. It is maintained, typed, and asynchronous on every system; pyserial's last
release is of 2020, and its asynchronous part never came to Windows.
"""

from __future__ import annotations

import asyncio
import errno
import time
from importlib import import_module
from typing import TYPE_CHECKING, Any

from protogen.link.ports.address import Address, PortKind
from protogen.link.ports.port import MOST_READ, Arrival, Port, PortError, PortLostError
from protogen.link.ports.settings import LineSettings

if TYPE_CHECKING:
    import serialx

_PATIENCE = 10.0
"""Seconds in which a machine has to answer."""
_CAUSES = {
    errno.ENOENT: ("there is no such port", "is it plugged in? `ls /dev/serial/by-id` lists ports"),
    errno.EACCES: ("you may not open it", "join its group, often `dialout`, and log in again"),
    errno.EBUSY: ("another program has it open", "close that one first"),
    errno.EAGAIN: ("another program has it open", "close that one first"),
    errno.ENOTTY: ("it is no serial port", "give a device, or a recording"),
    errno.ECONNREFUSED: ("nobody listens there", "is the server running?"),
}


class SerialPort(Port):
    """A port that serialx has opened."""

    def __init__(self, name: str, opened: serialx.AsyncSerial) -> None:
        super().__init__(name)
        self._opened = opened

    async def read(self) -> Arrival:
        """Wait for bytes. Raises PortLostError where the port is gone: it never just ends."""
        serialx = _serialx()
        try:
            data = await self._opened.read(MOST_READ)
        except (OSError, serialx.SerialException) as error:
            raise PortLostError(f"{self.name} is gone: {_reason(error)}") from None
        if not data:
            raise PortLostError(f"{self.name} is gone: the other end has closed it")
        return Arrival(data, time.time_ns())

    async def gather(self, seconds: float) -> None:
        """Let bytes gather where the system keeps them, which wakes nobody."""
        if not self._opened.is_open:
            return
        transport = self._opened.transport
        transport.pause_reading()
        try:
            await asyncio.sleep(seconds)
        finally:
            if self._opened.is_open:
                transport.resume_reading()

    async def write(self, data: bytes) -> None:
        """Send bytes. Raises PortLostError."""
        serialx = _serialx()
        try:
            await self._opened.write(data)
        except (OSError, serialx.SerialException) as error:
            raise PortLostError(f"{self.name} is gone: {_reason(error)}") from None

    async def close(self) -> None:
        """Give the port back."""
        serialx = _serialx()
        try:
            await self._opened.close()
        except (OSError, serialx.SerialException):
            return  # It is gone, and can't be given back.


async def open_serial_port(address: Address, settings: LineSettings) -> SerialPort:
    """Open a serial port, or a machine that has one. Raises PortError with cause and fix."""
    serialx = _serialx()
    opened = serialx.async_serial_for_url(address.text, **_keywords(address, settings))
    try:
        await opened.open()
    except TimeoutError:
        raise PortError(f"{address.text}: no answer in {_PATIENCE:g} s") from None
    except (OSError, serialx.SerialException, ValueError) as error:
        cause, hint = _CAUSES.get(_number(error), (_reason(error), None))
        raise PortError(f"{address.text}: {cause}", hint) from None
    return SerialPort(address.text, opened)


def _keywords(address: Address, settings: LineSettings) -> dict[str, Any]:
    """The settings as serialx has them. Pins that nobody asked for stay as they are."""
    serialx = _serialx()
    states = serialx.PinState
    pins = {True: states.HIGH, False: states.LOW, None: states.UNDEFINED}
    keywords: dict[str, Any] = {
        "baudrate": settings.baud,
        "byte_size": settings.data_bits,
        "parity": serialx.Parity[settings.parity.upper()],
        "stopbits": serialx.StopBits(settings.stop_bits),
        "dtr_on_open": pins[settings.dtr],
        "rts_on_open": pins[settings.rts],
        "dtr_on_close": states.UNDEFINED,
        "rts_on_close": states.UNDEFINED,
    }
    if address.kind is not PortKind.SERIAL:
        keywords["connect_timeout"] = _PATIENCE
    return keywords


def _serialx() -> Any:
    try:
        return import_module("serialx")
    except ModuleNotFoundError:
        problem = "a serial port needs the package serialx, which is not installed"
        raise PortError(problem, "pip install 'protogen-serial[serial]'") from None


def _number(error: BaseException) -> int:
    """The system's number of an error, which may be wrapped into one without a number."""
    found: BaseException | None = error
    while found is not None:
        if isinstance(found, OSError) and found.errno is not None:
            return found.errno
        found = found.__cause__ or found.__context__
    return 0


def _reason(error: BaseException) -> str:
    reason = error.strerror if isinstance(error, OSError) else None
    return reason or str(error) or type(error).__name__
