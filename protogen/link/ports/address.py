"""What a port is, as its address says.

/dev/ttyUSB0, COM3          a serial port
socket://host:port          bytes over TCP
rfc2217://host:port         a serial port of another machine, with its settings
pty:                        a pseudo-terminal that is made; its name is told
listen://host:port          waits for one to connect by TCP, then for the next
-                           standard input
run.pgrec, any other file   a recording, at its own pace
"""

from __future__ import annotations

import re
import stat
from enum import StrEnum
from pathlib import Path
from urllib.parse import urlsplit

import msgspec

from protogen.link.ports.port import PortError

_HINT = "give a device, socket://HOST:PORT, rfc2217://HOST:PORT, pty:, a recording, or -"


class PortKind(StrEnum):
    """What stands behind an address."""

    SERIAL = "serial port"
    SOCKET = "TCP"
    RFC2217 = "RFC 2217"
    PSEUDO_TERMINAL = "pseudo-terminal"
    LISTENING = "TCP, listening"
    STANDARD_INPUT = "standard input"
    RECORDING = "recording"


_LOST_SLASHES = re.compile("(?i)(?!com)[a-z][a-z0-9]+:[^/]*")
"""`udp:9`: serialx would take it for a scheme."""
_SCHEMES = {
    "socket": PortKind.SOCKET,
    "rfc2217": PortKind.RFC2217,
    "listen": PortKind.LISTENING,
}


class Address(msgspec.Struct, frozen=True):
    """An address, as it was written, and what it is of."""

    text: str
    kind: PortKind
    host: str = ""
    number: int = 0
    """Port number of TCP."""


def parse_address(text: str) -> Address:
    """Tell what an address is of. Raises PortError with a hint where it is of nothing."""
    if text == "-":
        return Address(text, PortKind.STANDARD_INPUT)
    if text == "pty:":
        return Address(text, PortKind.PSEUDO_TERMINAL)
    if "://" in text:
        return _network(text)
    if not text or _LOST_SLASHES.fullmatch(text):
        raise PortError(f"`{text}` is no port" if text else "no port is named", _HINT)
    return Address(text, PortKind.RECORDING if _is_file(text) else PortKind.SERIAL)


def _network(text: str) -> Address:
    scheme, _, _ = text.partition("://")
    kind = _SCHEMES.get(scheme)
    if kind is None:
        raise PortError(f"no port begins with `{scheme}://`", _HINT)
    try:
        parts = urlsplit(text)
        host, number = parts.hostname or "", parts.port
    except ValueError as error:
        raise PortError(f"`{text}` has no port number: {error}", _HINT) from None
    if number is None or (not host and kind is not PortKind.LISTENING):
        problem = f"`{text}` lacks {'a port number' if number is None else 'a host'}"
        raise PortError(problem, f"write it as {scheme}://HOST:PORT")
    return Address(text, kind, host or "127.0.0.1", number)


def _is_file(text: str) -> bool:
    try:
        return stat.S_ISREG(Path(text).stat().st_mode)
    except (OSError, ValueError):
        return False
