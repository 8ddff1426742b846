"""Septentrio's blocks, beside pysbf2."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from io import BytesIO
from itertools import accumulate
from math import isfinite
from typing import Any

import pytest
from compiled import protocol_of
from library_support import cases_of, compare_frames, compare_recovery, peer_module

from protogen.copying import replace
from protogen.fuzzing.samples import Values
from protogen.fuzzing.trips import Case
from protogen.library import FOLDER
from protogen.model.numbers import Integer
from protogen.model.types import Array, Field, Struct

PEER = "pysbf2"
BLOCKS = {
    "meas_epoch": "MeasEpoch",
    "meas_extra": "MeasExtra",
    "end_of_meas": "EndOfMeas",
    "gps_raw_ca": "GPSRawCA",
    "gps_nav": "GPSNav",
    "gps_alm": "GPSAlm",
    "gps_ion": "GPSIon",
    "gps_utc": "GPSUtc",
    "pvt_cartesian": "PVTCartesian",
    "pvt_geodetic": "PVTGeodetic",
    "pos_cov_cartesian": "PosCovCartesian",
    "pos_cov_geodetic": "PosCovGeodetic",
    "vel_cov_cartesian": "VelCovCartesian",
    "vel_cov_geodetic": "VelCovGeodetic",
    "dop": "DOP",
    "pos_local": "PosLocal",
    "base_vector_cart": "BaseVectorCart",
    "base_vector_geod": "BaseVectorGeod",
    "end_of_pvt": "EndOfPVT",
    "att_euler": "AttEuler",
    "att_cov_euler": "AttCovEuler",
    "end_of_att": "EndOfAtt",
    "receiver_time": "ReceiverTime",
    "xpps_offset": "xPPSOffset",
    "ext_event": "ExtEvent",
    "channel_status": "ChannelStatus",
    "receiver_status": "ReceiverStatus",
    "sat_visibility": "SatVisibility",
    "input_link": "InputLink",
    "quality_ind": "QualityInd",
    "disk_status": "DiskStatus",
    "rf_status": "RFStatus",
    "receiver_setup": "ReceiverSetup",
    "rx_message": "RxMessage",
    "comment": "Comment",
    "commands": "Commands",
    "base_station": "BaseStation",
    "encapsulated_output": "EncapsulatedOutput",
}
TEXTS = {"Comment", "Message"}
"""Texts of which it has each character."""
FILLER = "010203"
"""What it fills blocks up with."""
COUNTS = ("count", "others", "antennas")
MOST = 4
"""Sub-blocks of one kind that are compared."""
LONGEST = 64
"""Characters of a text whose size is said."""


class PySbf2:
    """Its messages, with numbers as they are in the block."""

    def __init__(self) -> None:
        self._message: Any = peer_module("pysbf2.sbfmessage").SBFMessage
        self._reader: Any = peer_module("pysbf2.sbfreader").SBFReader
        self._helpers: Any = peer_module("pysbf2.sbfhelpers")
        self._blocks: dict[str, Any] = peer_module("pysbf2.sbftypes_blocks").SBF_BLOCKS
        self._blocks["ReceiverSetup"] = dict(mended(self._blocks["ReceiverSetup"]))

    def frame(self, case: Case) -> bytes:
        name = BLOCKS[case.message]
        ours = leaves(case.values)
        values = dict(self._paired(self._blocks[name], ours, {}, ""))
        assert next(ours, None) is None
        message = self._message(name, parsebitfield=0, scaling=False, **values)
        number, length = message.serialize()[4:6], message.serialize()[6:8]
        head = bytes((number[0], number[1] | case.parts["revision"] << 5)) + length
        return (
            b"$@" + bytes(self._helpers.crc2bytes(head + message.payload)) + head + message.payload
        )

    def values(self, case: Case, frame: bytes) -> Values:
        name = BLOCKS[case.message]
        message = self._reader.parse(frame, parsebitfield=0, scaling=False)
        assert message.identity == name
        for key, value in self._paired(self._blocks[name], leaves(case.values), {}, ""):
            assert same(getattr(message, key), value), key
        return case.values

    def _paired(
        self, block: dict[str, Any], ours: Iterator[Any], known: Values, index: str
    ) -> Iterator[tuple[str, Any]]:
        """Yield its names, and our values as it has them, in the order of the block."""
        for key, kind in block.items():
            if key.endswith("_grp"):
                yield from self._group(*kind, ours, known, index)
            elif key != "_Padding":
                name = key.removesuffix("_bit") + index
                known[name] = next(ours)
                layout = kind[0] if isinstance(kind, tuple) else kind
                yield name, as_its(known[name], layout, ours)

    def _group(
        self,
        count: str,
        block: dict[str, Any],
        ours: Iterator[Any],
        known: Values,
        index: str,
    ) -> Iterator[tuple[str, Any]]:
        (first, *_) = block
        if first in TEXTS or first == "Payload":
            data = next(ours)
            content = data.encode("latin-1") if first in TEXTS else bytes.fromhex(data)
            content = content.ljust(known[count], b"\0")
            for place, byte in enumerate(content, 1):
                value = bytes((byte,)) if first in TEXTS else byte
                yield f"{first}{index}_{place:02d}", value
            return
        name, _, depth = count.partition("+")
        for place in range(1, known[name + (index if depth else "")] + 1):
            yield from self._paired(block, ours, known, f"{index}_{place:02d}")

    def found(self, endpoint: str, data: bytes) -> Iterator[bytes]:
        """What it reads in a stream, of which it logs nothing."""
        for raw, _ in self._reader(BytesIO(data), quitonerror=0, protfilter=2, scaling=False):
            yield raw


def mended(setup: dict[str, Any]) -> Iterator[tuple[str, Any]]:
    """Yield its fields of ReceiverSetup, with the one that it leaves out."""
    for name, kind in setup.items():
        if name == "RxName":
            yield "RxSerialNumber", kind
        if name not in ("RxSerialNumber", "Reserved1"):
            yield name, kind


def leaves(values: Any) -> Iterator[Any]:
    """Yield the numbers, texts and bytes in order, without padding."""
    if isinstance(values, list):
        for value in values:
            yield from leaves(value)
    elif isinstance(values, dict):
        for name, value in values.items():
            if name != "padding":
                yield from leaves(value)
    else:
        yield values


def as_its(value: Any, layout: str, ours: Iterator[Any]) -> Any:
    """A value of ours as it has one of the layout, which may be of several."""
    kind, size = layout[0], int(layout[1:])
    if layout == "X040":  # ten words
        return b"".join(
            word.to_bytes(4, "little") for word in (value, *(next(ours) for _ in "123456789"))
        )
    if kind == "F":
        return float(value)
    if kind == "V":
        return bytes.fromhex(value)
    if kind == "C":
        return value.encode("latin-1").ljust(size, b"\0")
    if isinstance(value, str):
        data = bytes.fromhex(value)
        return int.from_bytes(data, "little")
    return value.to_bytes(size, "little") if kind == "X" else value


def same(its: Any, ours: Any) -> bool:
    return bool(its == ours) or (
        isinstance(ours, float) and not isfinite(ours) and str(its) == str(ours)
    )


def as_made(case: Case) -> Case:
    """The case, with padding as it writes it, and little that repeats, as it is slow."""
    values = filled(shortened(case.values))
    if "padding" in values:
        values["padding"] = FILLER[: 2 * padding_of(values)]
    return replace(case, values=values)


def shortened(values: Any) -> Any:
    if isinstance(values, list):
        return [shortened(value) for value in values]
    if not isinstance(values, dict):
        return values
    cut = {name: shortened(value) for name, value in values.items()}
    for name, value in values.items():
        if isinstance(value, list) and len(value) > MOST and isinstance(value[0], dict):
            cut[name] = cut[name][:MOST]
            cut |= {key: MOST for key in COUNTS if values.get(key) == len(value)}
    if values.get("size", 0) > LONGEST and {"text", "data"} & set(values):
        digits = 2 if "data" in values else 1
        cut |= {key: cut[key][: LONGEST * digits] for key in ("text", "data") if key in cut}
        cut["size"] = LONGEST
    return cut


def padding_of(values: Values) -> int:
    """Bytes that are missing to a multiple of 4."""
    match values:
        case {"size_1": size_1, "size_2": size_2, "count": count}:
            (blocks,) = (value for value in values.values() if isinstance(value, list))
            others = sum(block.get("others", block.get("antennas")) for block in blocks)
            return int(-(count * size_1 + others * size_2) % 4)
        case {"size": size, "count": count}:
            return int(-count * size % 4)
        case {"indicators": indicators}:
            return -2 * len(indicators) % 4
        case {"size": size}:
            return int(-size % 4)
    return len(values["padding"]) // 2


def filled(values: Any) -> Any:
    """The values with zeros for padding."""
    if isinstance(values, list):
        return [filled(value) for value in values]
    if not isinstance(values, dict):
        return values
    padded = {name: filled(value) for name, value in values.items()}
    if "padding" in padded:
        padded["padding"] = "0" * len(padded["padding"])
    return padded


@pytest.fixture(scope="module")
def pysbf2() -> PySbf2:
    return PySbf2()


def test_the_blocks_are_those_of_the_schema() -> None:
    assert {message.name for message in protocol_of(FOLDER / "sbf.yaml").messages} == set(BLOCKS)


@pytest.fixture(scope="module")
def drawn() -> list[Case]:
    return list(map(as_made, cases_of("sbf")))


def test_each_bit_is_where_it_has_it(pysbf2: PySbf2) -> None:
    for message in protocol_of(FOLDER / "sbf.yaml").messages:
        if message.name != "receiver_time":  # of which it names no bits
            theirs = pysbf2._blocks[BLOCKS[message.name]]
            assert list(bits_of(message.fields)) == list(its_bits(theirs)), message.name


def bits_of(fields: Iterable[Field]) -> Iterator[list[tuple[int, int]]]:
    """Yield the lowest and the highest bit of each run that has a name, of each number."""
    for field in fields:
        kind = field.type.element if isinstance(field.type, Array) else field.type
        if isinstance(kind, Struct):
            yield from bits_of(kind.fields)
        elif isinstance(kind, Integer) and (kind.bit_fields or kind.flags):
            flags = [(each.bit, each.bit) for each in kind.flags.bits] if kind.flags else []
            yield sorted([*flags, *((each.low, each.high) for each in kind.bit_fields)])


def its_bits(block: dict[str, Any]) -> Iterator[list[tuple[int, int]]]:
    for name, kind in block.items():
        if name.endswith("_grp"):
            yield from its_bits(kind[1])
        elif name.endswith("_bit"):
            kinds = [each[0] if isinstance(each, tuple) else each for each in kind[1].values()]
            sizes = [int(each[1:]) for each in kinds]
            runs = zip(kind[1], accumulate(sizes), sizes, strict=True)
            named = (run for run in runs if not run[0].lower().startswith("reserved"))
            yield [(end - size, end - 1) for _, end, size in named]


def test_both_make_and_read_the_same_blocks(pysbf2: PySbf2, drawn: list[Case]) -> None:
    compare_frames("sbf", pysbf2, drawn)


def test_no_frame_is_lost_that_it_finds(pysbf2: PySbf2, drawn: list[Case]) -> None:
    compare_recovery("sbf", "receiver", pysbf2, drawn)
