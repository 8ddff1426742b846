"""libsbp with messages of the same fields, in its own frames.

The classes are what its generator makes. A turn of the lidar has more bytes than its frames.
"""

from __future__ import annotations

import io
import warnings
from importlib.metadata import version
from typing import Any

from construct import GreedyRange, Int8ub, Int16sl, Int16ul, Int32sl, Int32ul, Struct
from sbp.client.framer import Framer
from sbp.msg import SBP
from sbp.utils import containerize, exclude_fields

from peers.cases import FEW, Case, Row
from peers.contender import Contender

VERSION = version("sbp")

_PARSERS: dict[str, Any] = {
    "gyro": Struct("status" / Int8ub, "int_x" / Int16sl, "int_y" / Int16sl, "int_z" / Int16sl),
    "read_motor": Struct(
        "unknown" / Int32ul,
        "timestamp" / Int32ul,
        "axis" / Int8ub,
        "position" / Int32sl,
        "velocity" / Int32sl,
        "acceleration" / Int32sl,
        "torque" / Int32sl,
    ),
    "sonar_data": Struct(
        "unknown" / Int32ul,
        "timestamp" / Int32ul,
        "readings" / GreedyRange(Struct("cluster" / Int8ub, "distance" / Int16ul)),
    ),
    "status": Struct(
        "status" / Int8ub,
        "mode" / Int8ub,
        "voltage" / Int16ul,
        "current" / Int16ul,
        "speed" / Int16sl,
        "angle" / Int16sl,
        "encoder0" / Int16ul,
        "encoder1" / Int16ul,
        "encoder2" / Int16ul,
        "encoder3" / Int16ul,
    ),
}
_NUMBER = 0x4242


def _kind(message: str) -> type[Any]:
    parser = _PARSERS[message]
    names = [each.name for each in parser.subcons]

    class Message(SBP):  # type: ignore[misc]
        _parser = parser
        __slots__ = names

        def __init__(self, sbp: Any = None, **kwargs: Any) -> None:
            if sbp:
                super().__init__(sbp.msg_type, sbp.sender, sbp.length, sbp.payload, sbp.crc)
                self.from_binary(sbp.payload)
            else:
                super().__init__()
                self.msg_type = _NUMBER
                self.sender = 0x42
                for name in self.__class__.__slots__:
                    setattr(self, name, kwargs.pop(name))

        def from_binary(self, data: bytes) -> None:
            found = self._parser.parse(data)
            for name in self.__class__.__slots__:
                setattr(self, name, getattr(found, name))

        def to_binary(self) -> bytes:
            self.payload = self._parser.build(containerize(exclude_fields(self)))
            return bytes(self.pack())

    return Message


def contender(case: Case) -> Contender | None:
    """None for the lidar."""
    if case.message not in _PARSERS:
        return None
    kind = _kind(case.message)
    table = {_NUMBER: kind}
    items = [kind(**_fields(case, row)) for row in case.rows]
    frames = [item.to_binary() for item in items]
    few, few_items = frames[:FEW], items[:FEW]
    warnings.filterwarnings("ignore", category=DeprecationWarning)

    def dispatch(message: Any) -> Any:
        return table[message.msg_type](message)

    def stream(data: bytes) -> list[Any]:
        read = io.BytesIO(data).read

        def taken(size: int) -> bytes:
            found = read(size)
            if not found:
                raise OSError("the end")
            return found

        framer = Framer(taken, None, dispatcher=dispatch, skip_metadata=True)
        return [message for message, _ in framer]

    return Contender(
        "libsbp",
        rows=lambda found: list(map(case.row, found)),
        data=b"".join(frames),
        stream=stream,
        decode=lambda: [dispatch(SBP.unpack(frame)) for frame in few],
        encode=lambda: [item.to_binary() for item in few_items],
        frames=tuple(few),
    )


def _fields(case: Case, row: Row) -> dict[str, Any]:
    fields = dict(zip(case.kind.__fields__, row, strict=True))
    if case.message == "sonar_data":
        fields["readings"] = [{"cluster": one, "distance": two} for one, two in row[2]]
    return fields
