"""Kaitai Struct on payloads, with code that its compiler from npm makes; the frames by hand.

It has no flags: the status byte stays an integer. The function of the npm package compiles for
reading only, so nothing is encoded.
"""

from __future__ import annotations

import subprocess
from functools import cache
from pathlib import Path
from types import ModuleType
from typing import Any

import kaitaistruct
from bench_generate import CACHE, kaitai

from peers import slotted_rn1
from peers.cases import FEW, Case, Row
from peers.contender import Contender
from peers.framing import PAYLOADS
from peers.modules import imported

HERE = Path(__file__).parent / "kaitai"
VERSION = kaitaistruct.__version__


def contender(case: Case) -> Contender:
    """Raises ImportError without the compiler."""
    kind = getattr(_module(case.message), _class_name(case.message))
    read, payloads = kind.from_bytes, PAYLOADS[case.protocol]
    take = {"gyro": _gyro, "lidar": _lidar}.get(case.message)
    frames = case.frames[:FEW]

    if take is not None:

        def stream(data: bytes) -> list[Any]:
            return [take(read(payload)) for _, payload in payloads(data)]

        def decode() -> list[Any]:
            return [take(read(payload)) for one in frames for _, payload in payloads(one)]
    else:

        def stream(data: bytes) -> list[Any]:
            return [read(payload) for _, payload in payloads(data)]

        def decode() -> list[Any]:
            return [read(payload) for one in frames for _, payload in payloads(one)]

    def row(item: Any) -> Row:
        return tuple(_plain(getattr(item, name)) for name in case.kind.__fields__)

    return Contender(
        "Kaitai Struct",
        rows=lambda found: [row(item) for item in found],
        data=case.stream,
        stream=stream,
        decode=decode,
    )


def _gyro(item: Any) -> Any:
    """Instances are worked out when they are asked for."""
    _ = item.int_x, item.int_y, item.int_z
    return item


_UNSIGNED = slotted_rn1.UNSIGNED.__getitem__


def _lidar(item: Any) -> Any:
    """Instances would need an object for each distance."""
    item.distances = [*map(_UNSIGNED, item.codes)]
    return item


def _plain(value: Any) -> Any:
    if isinstance(value, list):
        return tuple(map(_plain, value))
    if hasattr(value, "cluster"):
        return value.cluster, value.distance
    return int(getattr(value, "value", value))


def _class_name(message: str) -> str:
    return "".join(word.capitalize() for word in message.split("_"))


@cache
def _module(message: str) -> ModuleType:
    definition = HERE / f"{message}.ksy"
    folder = CACHE / "python"
    made = folder / f"{message}.py"
    if not made.exists() or made.stat().st_mtime < definition.stat().st_mtime:
        folder.mkdir(parents=True, exist_ok=True)
        command = kaitai()
        if command is None:
            raise ImportError("kaitai-struct-compiler is not installed by npm")
        subprocess.run(command(definition, folder), cwd=CACHE, check=True)
    return imported(made, f"kaitai_{message}")
