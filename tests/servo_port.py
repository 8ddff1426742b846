"""A port of bus servos, as Dynamixel's SDK and Feetech's, which is made of it, have one."""

from __future__ import annotations


class Port:
    """A port of the SDK, with what is there to read and what was written."""

    is_using = False

    def __init__(self, data: bytes = b"") -> None:
        self.data = data
        self.written = b""

    def readPort(self, length: int) -> bytes:  # noqa: N802 - as the SDK calls it
        length = max(length, 0)
        piece, self.data = self.data[:length], self.data[length:]
        return piece

    def writePort(self, packet: list[int]) -> int:  # noqa: N802 - as the SDK calls it
        self.written = bytes(packet)
        return len(packet)

    def clearPort(self) -> None:  # noqa: N802 - as the SDK calls it
        pass

    def setPacketTimeout(self, length: int) -> None:  # noqa: N802 - as the SDK calls it
        pass

    def isPacketTimeout(self) -> bool:  # noqa: N802 - as the SDK calls it
        return not self.data
