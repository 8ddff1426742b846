"""construct on payloads, interpreted and compiled; the frames around them by hand.

Integers come as they are: no enums and flags, which would cost more.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import construct
from construct import (
    Array,
    Byte,
    ExprAdapter,
    Int8ub,
    Int16sl,
    Int16ub,
    Int16ul,
    Int32sb,
    Int32ub,
    Struct,
    this,
)

from peers import slotted_rn1
from peers.cases import FEW, Case
from peers.contender import Contender
from peers.framing import FRAMED, PAYLOADS


def _pair(plain: list[int], codes: dict[int, int]) -> Any:
    """Two bytes of 7 bits."""
    return ExprAdapter(Int16ul, lambda code, _: plain[code], lambda value, _: codes[value])


_SIGNED = _pair(slotted_rn1.SIGNED, slotted_rn1.SIGNED_CODES)
_UNSIGNED = _pair(slotted_rn1.UNSIGNED, slotted_rn1.UNSIGNED_CODES)

INTERPRETED, COMPILED = "construct", "construct, compiled"

STRUCTS: dict[str, Any] = {
    "gyro": Struct("status" / Byte, "int_x" / _SIGNED, "int_y" / _SIGNED, "int_z" / _SIGNED),
    "lidar": Struct("status" / Byte, "distances" / Array(360, _UNSIGNED)),
    "read_motor": Struct(
        "unknown" / Int32ub,
        "timestamp" / Int32ub,
        "axis" / Int8ub,
        "position" / Int32sb,
        "velocity" / Int32sb,
        "acceleration" / Int32sb,
        "torque" / Int32sb,
    ),
    "sonar_data": Struct(
        "unknown" / Int32ub,
        "timestamp" / Int32ub,
        "readings" / Array(this._.count, Struct("cluster" / Int8ub, "distance" / Int16ub)),
    ),
    "status": Struct(
        "status" / Byte,
        "mode" / Byte,
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
VERSION = construct.__version__


def interpreted(case: Case) -> Contender:
    """As it is declared."""
    return _contender(case, INTERPRETED, STRUCTS[case.message])


def compiled(case: Case) -> Contender:
    """By `.compile()`."""
    return _contender(case, COMPILED, STRUCTS[case.message].compile())


def parser(case: Case, layout: Any) -> Callable[[bytes], Any]:
    """Parser of a payload. Counting is faster than construct's GreedyRange."""
    parse = layout.parse
    if case.message == "sonar_data":
        return lambda payload: parse(payload, count=(len(payload) - 8) // 3)
    return parse  # type: ignore[no-any-return]


def builder(case: Case, layout: Any) -> Callable[[Any], bytes]:
    """Builder of a payload."""
    build = layout.build
    if case.message == "sonar_data":
        return lambda item: build(item, count=len(item["readings"]))  # type: ignore[no-any-return]
    return build  # type: ignore[no-any-return]


def _contender(case: Case, name: str, layout: Any) -> Contender:
    payloads, framed = PAYLOADS[case.protocol], FRAMED[case.message]
    parse, build = parser(case, layout), builder(case, layout)
    frames = case.frames[:FEW]
    items = [(parse(payload), count) for count, payload in payloads(b"".join(frames))]
    for item, _ in items:
        item.pop("_io", None)

    return Contender(
        name,
        rows=lambda found: [case.row(item) for item, _ in found],
        data=case.stream,
        stream=lambda data: [(parse(payload), count) for count, payload in payloads(data)],
        decode=lambda: [
            (parse(payload), count) for one in frames for count, payload in payloads(one)
        ],
        encode=lambda: [framed(build(item), count) for item, count in items],
        frames=tuple(frames),
    )
