"""scapy on payloads; the frames around them by hand. Fields are asked for, as a user would."""

from __future__ import annotations

from typing import Any

import scapy
from scapy.config import conf
from scapy.fields import (
    ByteEnumField,
    ByteField,
    FieldListField,
    FlagsField,
    IntField,
    LEShortField,
    LESignedShortField,
    PacketListField,
    ShortField,
    SignedIntField,
)
from scapy.packet import Packet

from peers import slotted_rn1
from peers.cases import FEW, Case, Row
from peers.contender import Contender
from peers.framing import FRAMED, PAYLOADS

VERSION = scapy.VERSION
conf.debug_dissector = True
conf.max_list_count = 1000


class _SignedPair(LEShortField):  # type: ignore[misc]
    """Two bytes of 7 bits."""

    def m2i(self, pkt: Any, x: int) -> int:
        return slotted_rn1.SIGNED[x]

    def i2m(self, pkt: Any, x: int) -> int:
        return slotted_rn1.SIGNED_CODES[x]


class _Pair(LEShortField):  # type: ignore[misc]
    def m2i(self, pkt: Any, x: int) -> int:
        return slotted_rn1.UNSIGNED[x]

    def i2m(self, pkt: Any, x: int) -> int:
        return slotted_rn1.UNSIGNED_CODES[x]

    def getfield(self, pkt: Any, s: bytes) -> tuple[bytes, int]:
        return s[2:], slotted_rn1.UNSIGNED[s[0] | s[1] << 8]

    def addfield(self, pkt: Any, s: bytes, val: int) -> bytes:
        return s + slotted_rn1.UNSIGNED_CODES[val].to_bytes(2, "little")


class _Whole(Packet):  # type: ignore[misc]
    def extract_padding(self, s: bytes) -> tuple[bytes, bytes]:
        return b"", s


class Gyro(_Whole):
    fields_desc = (
        ByteEnumField("status", 1, {1: "ok"}),
        _SignedPair("int_x", 0),
        _SignedPair("int_y", 0),
        _SignedPair("int_z", 0),
    )


class Lidar(_Whole):
    fields_desc = (
        FlagsField("status", 0, 8, ["initialized", "speed_in_spec"]),
        FieldListField("distances", [], _Pair("", 0), count_from=lambda _: 360),
    )


class Motor(_Whole):
    fields_desc = (
        IntField("unknown", 0),
        IntField("timestamp", 0),
        ByteEnumField("axis", 0, {0: "linear", 1: "angular"}),
        SignedIntField("position", 0),
        SignedIntField("velocity", 0),
        SignedIntField("acceleration", 0),
        SignedIntField("torque", 0),
    )


class Reading(_Whole):
    fields_desc = (ByteField("cluster", 0), ShortField("distance", 0))


class Sonar(_Whole):
    fields_desc = (
        IntField("unknown", 2),
        IntField("timestamp", 0),
        PacketListField("readings", [], Reading),
    )


class Status(_Whole):
    fields_desc = (
        FlagsField(
            "status", 0, 8, ["stop", "low", "front", "back", "encoder", "power", "x", "run"]
        ),
        ByteEnumField("mode", 0, {0: "idle", 1: "remote", 2: "autonomous"}),
        LEShortField("voltage", 0),
        LEShortField("current", 0),
        LESignedShortField("speed", 0),
        LESignedShortField("angle", 0),
        LEShortField("encoder0", 0),
        LEShortField("encoder1", 0),
        LEShortField("encoder2", 0),
        LEShortField("encoder3", 0),
    )


_KINDS: dict[str, type[Any]] = {
    "gyro": Gyro,
    "lidar": Lidar,
    "read_motor": Motor,
    "sonar_data": Sonar,
    "status": Status,
}


def contender(case: Case) -> Contender:
    kind = _KINDS[case.message]
    payloads, framed = PAYLOADS[case.protocol], FRAMED[case.message]
    frames = case.frames[:FEW]
    items = [_made(kind, case, row) for row in case.rows[:FEW]]
    counted = [*zip(items, range(len(items)), strict=True)]

    def fresh() -> None:
        """A packet that was built keeps its bytes; a changed one is built again."""
        for item in items:
            item.clear_cache()

    def encode() -> list[bytes]:
        fresh()
        return [framed(bytes(item), count) for item, count in counted]

    def row(item: Any) -> Row:
        return tuple(_plain(getattr(item, name)) for name in case.kind.__fields__)

    return Contender(
        "scapy",
        rows=lambda found: [row(item) for item in found],
        data=case.stream,
        stream=lambda data: [kind(payload) for _, payload in payloads(data)],
        decode=lambda: [kind(payload) for one in frames for _, payload in payloads(one)],
        encode=encode,
        frames=tuple(frames),
    )


def _made(kind: type[Any], case: Case, row: Row) -> Any:
    fields = dict(zip(case.kind.__fields__, row, strict=True))
    if case.message == "sonar_data":
        fields["readings"] = [Reading(cluster=one, distance=two) for one, two in row[2]]
    if case.message == "lidar":
        fields["distances"] = list(row[1])
    return kind(**fields)


def _plain(value: Any) -> Any:
    if isinstance(value, list):
        return tuple(map(_plain, value))
    if isinstance(value, Reading):
        return value.cluster, value.distance
    return int(value)
