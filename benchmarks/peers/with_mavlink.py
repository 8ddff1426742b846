"""pymavlink with dialects of the same messages, in MAVLink's own frames."""

from __future__ import annotations

from contextlib import redirect_stdout
from functools import cache
from io import StringIO
from pathlib import Path
from types import ModuleType
from typing import Any

import pymavlink
from bench_generate import CACHE
from pymavlink.generator import mavgen, mavparse

from peers.cases import FEW, Case, Row
from peers.contender import Contender
from peers.modules import imported

DIALECTS = Path(__file__).parent.parent / "c" / "mavlink"
_DIALECT = {"rn1": "rn1", "rflex": "atrv", "matty": "matty"}
VERSION = pymavlink.__version__
_QUARTERS = 4


def contender(case: Case) -> Contender:
    """A turn of the lidar does not fit a message: it goes out in four quarters."""
    module = _module(_DIALECT[case.protocol])
    sender = module.MAVLink(None, srcSystem=1, srcComponent=1)
    parts = _QUARTERS if case.message == "lidar" else 1
    items = [message for row in case.rows for message in _messages(module, case.message, row)]
    frames = [bytes(message.pack(sender)) for message in items]
    few, few_items = frames[: FEW * parts], items[: FEW * parts]

    def stream(data: bytes) -> list[Any]:
        parser = module.MAVLink(None)
        parser.robust_parsing = True
        return parser.parse_buffer(data) or []

    def decode() -> list[Any]:
        parser = module.MAVLink(None)
        return [parser.decode(bytearray(frame)) for frame in few]

    def encode() -> list[bytes]:
        return [bytes(message.pack(sender)) for message in few_items]

    def rows(found: list[Any]) -> list[Row]:
        found = [item for item in found if item.get_type() != "BAD_DATA"]
        return [_row(case, found[at : at + parts]) for at in range(0, len(found), parts)]

    return Contender(
        "pymavlink",
        rows=rows,
        data=b"".join(frames),
        stream=stream,
        decode=decode,
        encode=encode,
    )


def _messages(module: ModuleType, name: str, row: Row) -> list[Any]:
    if name == "gyro":
        return [module.MAVLink_gyro_message(*row)]
    if name == "read_motor":
        return [module.MAVLink_read_motor_message(*row)]
    if name == "status":
        return [module.MAVLink_robot_status_message(*row)]
    if name == "lidar":
        step = len(row[1]) // _QUARTERS
        parts = [row[1][at : at + step] for at in range(0, len(row[1]), step)]
        kind = module.MAVLink_lidar_quarter_message
        return [kind(place, row[0], list(part)) for place, part in enumerate(parts)]
    clusters, distances = zip(*row[2], strict=True)
    readings = len(clusters), list(clusters), list(distances)
    return [module.MAVLink_sonar_data_message(row[0], row[1], *readings)]


def _row(case: Case, items: list[Any]) -> Row:
    first = items[0]
    if case.message == "lidar":
        return first.status, tuple(distance for item in items for distance in item.distances)
    if case.message == "sonar_data":
        readings = zip(first.clusters[: first.count], first.distances, strict=False)
        return first.unknown, first.timestamp, tuple(readings)
    return case.row(first)


@cache
def _module(dialect: str) -> ModuleType:
    definition = DIALECTS / f"{dialect}.xml"
    made = CACHE / "python" / f"mavlink_{dialect}.py"
    if not made.exists() or made.stat().st_mtime < definition.stat().st_mtime:
        made.parent.mkdir(parents=True, exist_ok=True)
        options = mavgen.Opts(str(made), mavparse.PROTOCOL_2_0, "Python3")
        with redirect_stdout(StringIO()):
            mavgen.mavgen(options, [str(definition)])
    return imported(made, f"mavlink_{dialect}")
