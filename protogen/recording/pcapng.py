"""Recordings as pcapng, for Wireshark: each source is an interface, each record a packet.

Source: https://www.ietf.org/archive/id/draft-ietf-opsawg-pcapng-03.html. The link type is USER0
(147), for which Wireshark lets its user choose a dissector.
"""

from __future__ import annotations

import struct
from typing import BinaryIO

_SECTION = 0x0A0D0D0A
_INTERFACE = 1
_PACKET = 6
_MAGIC = 0x1A2B3C4D
_USER0 = 147
_NAME = 2
"""Option of an interface: its name."""
_RESOLUTION = 9
"""Option of an interface: its times are in units of 10 to the power of minus this."""
_COMMENT = 1


class PcapngRecorder:
    """Writes packets as they come, each whole, without a buffer if the stream has none."""

    def __init__(self, stream: BinaryIO) -> None:
        """Begin a file in a stream, which is closed with the recorder. Raises OSError."""
        self._stream = stream
        self._interfaces: dict[str, int] = {}
        # Major 1, minor 0, and a length that is not known.
        self._block(_SECTION, struct.pack("<IHHq", _MAGIC, 1, 0, -1))

    def write(self, data: bytes, t_ns: int, source: str = "") -> None:
        """Record what a source sent. Raises OSError."""
        self._packet(data, t_ns, source, b"")

    def note(self, text: str, t_ns: int) -> None:
        """Record what happened, as the comment of a packet without bytes. Raises OSError."""
        self._packet(b"", t_ns, "", _option(_COMMENT, text.encode()))

    def sync(self) -> None:
        """Do nothing: what was written is with the system."""

    def close(self) -> None:
        """End the file."""
        self._stream.close()

    def _packet(self, data: bytes, t_ns: int, source: str, options: bytes) -> None:
        size = len(data)
        time = t_ns.to_bytes(8, "big", signed=True)
        high, low = struct.unpack(">II", time)
        head = struct.pack("<IIIII", self._interface(source), high, low, size, size)
        end = options and options + _option(0, b"")
        self._block(_PACKET, head + _padded(data) + end)

    def _interface(self, source: str) -> int:
        number = self._interfaces.get(source)
        if number is None:
            number = self._interfaces[source] = len(self._interfaces)
            options = _option(_NAME, (source or "line").encode()) + _option(_RESOLUTION, b"\x09")
            head = struct.pack("<HHI", _USER0, 0, 0)
            self._block(_INTERFACE, head + options + _option(0, b""))
        return number

    def _block(self, kind: int, body: bytes) -> None:
        size = struct.pack("<I", len(body) + 12)
        self._stream.write(struct.pack("<I", kind) + size + body + size)


def _option(code: int, value: bytes) -> bytes:
    return struct.pack("<HH", code, len(value)) + _padded(value)


def _padded(data: bytes) -> bytes:
    """The bytes, filled up to a multiple of four."""
    return data + bytes(-len(data) % 4)
