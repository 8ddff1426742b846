"""Measurements that pyrplidar does not know, laid out by hand as the SDK's headers have them."""

from __future__ import annotations

import struct
from collections.abc import Iterator
from functools import reduce
from operator import xor
from zlib import crc32

from protogen.fuzzing.samples import Values
from protogen.fuzzing.trips import Case

HIGH_QUALITY = "high_quality_group"
ULTRA_DENSE = "ultra_dense_capsule"
GROUP = struct.Struct("<BQ")
NODE = struct.Struct("<HIBB")
CAPSULE = struct.Struct("<BBIHH")
CABIN = struct.Struct("<HHB")
SIZES = {HIGH_QUALITY: 9 + 96 * 8 + 4, ULTRA_DENSE: 10 + 32 * 5}


class Sdk:
    """Reads and writes the two kinds of measurements."""

    def frame(self, case: Case) -> bytes:
        values = case.values
        if case.message == HIGH_QUALITY:
            nodes = (
                NODE.pack(node["angle"], node["distance"], node["quality"], node["flags"])
                for node in values["measurements"]
            )
            head = GROUP.pack(0xA5, values["timestamp"])
            return with_crc(b"".join([head, *nodes]))
        cabins = (
            CABIN.pack(
                cabin["echo_1"] << 2 | cabin["scale_1"],
                cabin["echo_2"] << 2 | cabin["scale_2"],
                cabin["echo_2_high"] << 4 | cabin["echo_1_high"],
            )
            for cabin in values["cabins"]
        )
        direction = values["direction"]["first"] << 15 | values["direction"]["angle"]
        head = CAPSULE.pack(0, 0, values["timestamp"], values["status"], direction)
        return with_sum(b"".join([head, *cabins]))

    def values(self, case: Case, frame: bytes) -> Values:
        if case.message == HIGH_QUALITY:
            names = ("angle", "distance", "quality", "flags")
            nodes = [dict(zip(names, node, strict=True)) for node in NODE.iter_unpack(frame[9:-4])]
            return {"timestamp": GROUP.unpack_from(frame)[1], "measurements": nodes}
        _, _, timestamp, status, direction = CAPSULE.unpack_from(frame)
        return {
            "timestamp": timestamp,
            "status": status,
            "direction": {"angle": direction & 0x7FFF, "first": direction >> 15},
            "cabins": [_cabin(*cabin) for cabin in CABIN.iter_unpack(frame[10:])],
        }

    def found(self, endpoint: str, data: bytes) -> Iterator[bytes]:
        """It gives a wrong frame up one byte behind its start."""
        kind, finish = (
            (HIGH_QUALITY, with_crc) if endpoint == "high_quality" else (ULTRA_DENSE, with_sum)
        )
        size = SIZES[kind]
        at = 0
        while at + size <= len(data):
            frame = data[at : at + size]
            right = finish(frame[:-4] if kind == HIGH_QUALITY else frame) == frame
            if right and (kind == ULTRA_DENSE or frame[0] == 0xA5):
                yield frame
                at += size
            else:
                at += 1


def with_crc(data: bytes) -> bytes:
    """With the CRC over the data and three zeros, which make 780 bytes of 777."""
    return data + crc32(data + bytes(3)).to_bytes(4, "little")


def with_sum(data: bytes) -> bytes:
    """With the halves of the sum in the low bits of the first two bytes."""
    check = reduce(xor, data[2:])
    return bytes((0xA0 | check & 15, 0x50 | check >> 4)) + data[2:]


def _cabin(first: int, second: int, high: int) -> Values:
    return {
        "scale_1": first & 3,
        "echo_1": first >> 2,
        "scale_2": second & 3,
        "echo_2": second >> 2,
        "echo_1_high": high & 15,
        "echo_2_high": high >> 4,
    }
