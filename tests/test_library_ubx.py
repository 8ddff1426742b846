"""u-blox UBX, beside pyubx2."""

from __future__ import annotations

import math
import re
import struct
from collections import Counter
from collections.abc import Callable, Iterator, Sequence
from io import BytesIO
from typing import Any, NamedTuple

import pytest
from compiled import protocol_of
from library_support import (
    cases_of,
    compare_frames,
    compare_recovery,
    encoded,
    endpoint_of,
    engine_of,
    peer_module,
)

from protogen.fuzzing.samples import Values
from protogen.fuzzing.trips import Case
from protogen.library import FOLDER
from protogen.model.expressions import Operand
from protogen.model.payload_plan import (
    AnyStep,
    BytesStep,
    ChooseStep,
    FloatStep,
    IntegerStep,
    OptionalStep,
    RecordStep,
    RepeatStep,
    RestStep,
)
from protogen.model.payload_walks import without_constant
from protogen.model.types import Text

GET, SET, POLL = 0, 1, 2
NAMES = {
    "sec": "second",
    "mem": "lem",
    "valid": "validflags",
    "lambdan": "lambda",
    "reserved0": "reserved1",
}
"""Names that pyubx2 has in the place of ours, where it has not ours."""
BY_PAYLOAD = {
    *("cfg_nmea", "cfg_nmea_4", "cfg_nmea_12", "nav_aopstatus", "rxm_pmreq_short", "mga_ano"),
    *("cfg_rinv", "cfg_valdel", "cfg_valget_poll", "esf_raw", "log_string", "mga_dbd"),
    *("mon_ver", "rxm_spartn_key", "cfg_valset", "cfg_valget", "esf_meas"),
}
"""Messages that pyubx2 does not make of values, but takes as bytes: of several layouts, or with
arrays to the end of the payload."""
ITEMS = {"cfg_valset", "cfg_valget"}
"""Messages whose items it tells as attributes, called by its names for their keys."""
ONE_BLOCK = {"mon_io": "ports", "cfg_inf": "protocols"}
"""Messages of which pyubx2 has but one block, and the array that we have of them."""
WITHOUT = {
    *(("cfg_cfg", f"{what}mask") for what in ("clear", "save", "load")),
    *(("cfg_navx5", "aopcfg"), ("nav_aopstatus", "aopcfg"), ("cfg_senif", "pioconf")),
    *(("esf_raw", "data"), ("mon_spt", "drvver"), ("cfg_nmea_12", "gnsstofilter")),
}
"""Fields whose bits pyubx2 does not tell apart; in the last one it misnames one."""
LARGE = 300
"""Bytes of a frame from which on pyubx2 takes too long to make it of values."""
UNKNOWN = {
    "cfg_msg_rate": "It reads the eight bytes of the longer message.",
    "cfg_fixseed": "Its messages have a `length` of their own.",
    "sec_uniqid_v2": "Its table has it, but it reads version 1.",
}
"""Messages that pyubx2 1.4.0 does not read."""


class Leaf(NamedTuple):
    """A value of a message, with the indices of the arrays that it is in, from 1."""

    name: str
    """As pyubx2 has it, but for small and capital letters."""
    step: IntegerStep | FloatStep | BytesStep | RestStep
    indices: tuple[int, ...]
    value: Any

    @property
    def physical(self) -> float:
        return float(self.value * self.step.field.scale)


def mapped(
    steps: Sequence[AnyStep], values: Values, visit: Callable[[Leaf], Any], at: tuple[int, ...] = ()
) -> Values:
    """The values of a record, each as `visit` has it."""

    def change(step: AnyStep | RestStep, name: str, value: Any, at: tuple[int, ...]) -> Any:
        match step:
            case RecordStep():
                return value and mapped(step.steps, value, visit, at)
            case RepeatStep():
                elements = enumerate(value, 1)
                return [change(step.element, name, item, (*at, n)) for n, item in elements]
            case OptionalStep():
                return None if value is None else change(step.step, name, value, at)
            case ChooseStep():
                chosen = step.case(selected(step, values))
                assert chosen is not None
                return change(chosen, name, value, at)
            case _:
                return visit(Leaf(plain(name), without_constant(step), at, value))

    return {step.name: change(step, step.name, values[step.name], at) for step in steps}


def selected(step: ChooseStep, values: Values) -> int:
    """The number, or the run of bits of one, that a case is chosen by."""
    operand = step.expression
    assert isinstance(operand, Operand)
    low, high = operand.run or (0, 63)
    number: int = values[operand.name]
    return number >> low & (1 << high - low + 1) - 1


def plain(name: str) -> str:
    """A name as both have it: `iTOW` and `itow`, `tow_ms_r` and `towMsR`."""
    return name.replace("_", "").lower()


class Attributes:
    """The values of a message of pyubx2 by their names, as far as they are those of ours."""

    def __init__(self, message: Any, kind: str) -> None:
        self._all: dict[tuple[str, tuple[int, ...]], list[tuple[str, Any]]] = {}
        for name, value in vars(message).items():
            if not name.startswith("_"):
                base, *indices = re.split(r"_(?=\d\d)", name)
                at = plain(base), tuple(map(int, indices))
                self._all.setdefault(at, []).append((name, value))
        if kind == "rxm_rawx":  # The version and two reserved bytes are one number to it.
            name, value = self._all["reserved1", ()][0]
            self._all["version", ()] = [(name, value & 0xFF)]
            self._all["reserved0", ()] = [(name, value >> 8)]
        if kind == "esf_meas" and message.calibTtagValid:  # It is one more measurement to it.
            self._all["calibttag", ()] = self._all["data", (message.numMeas + 1,)]
        if kind in ONE_BLOCK:  # It has no array of them.
            self._all = {(name, (1, *at)): found for (name, at), found in self._all.items()}

    def of(self, leaf: Leaf) -> tuple[str, Any]:
        """Its name and value for a value of ours."""
        return self._found(leaf.name, leaf.indices)[-1]

    def bit(self, name: str, at: tuple[int, ...]) -> tuple[str, Any]:
        """Those for a run of bits, which may be called like a field behind it."""
        return self._found(plain(name), at)[0]

    def _found(self, name: str, at: tuple[int, ...]) -> list[tuple[str, Any]]:
        other = NAMES.get(name, name)
        return self._all.get((name, at)) or self._all.get((other, at)) or [("", None)]


class Pyubx2:
    """pyubx2: each value is given to it and taken from it by its own name for it."""

    def __init__(self) -> None:
        self._package: Any = peer_module("pyubx2")
        table = peer_module("pyubx2.ubxtypes_set").UBX_PAYLOADS_SET["MGA-BDS-ALM"]
        table["toa"] = (table["toa"][0], 4096)  # It has 1/4096: see the decision.
        protocol = protocol_of(FOLDER / "ubx.yaml")
        self._messages = {message.name: message for message in protocol.messages}
        self._last: tuple[bytes, Any] = b"", None

    def _mode(self, case: Case) -> int:
        if endpoint_of("ubx", case) == "receiver":
            return GET
        return POLL if case.message.endswith("_poll") else SET

    def _parsed(self, case: Case, frame: bytes) -> Any:
        if self._last[0] != frame:
            mode = self._mode(case)
            parsed = self._package.UBXReader.parse(frame, msgmode=mode, parsebitfield=2)
            self._last = frame, parsed
        return self._last[1]

    def frame(self, case: Case) -> bytes:
        ours = encoded("ubx", case)
        parsed = self._parsed(case, ours)
        kind = parsed.msg_cls, parsed.msg_id, self._mode(case)
        if case.message in BY_PAYLOAD or len(ours) > LARGE:
            given: dict[str, Any] = {"payload": ours[6:-2]}
        else:
            given = self._given(case, Attributes(parsed, case.message))
        # Of this one, a run of bits counts.
        bits = case.message == "esf_meas"
        message = self._package.UBXMessage(*kind, parsebitfield=bits, **given)
        return bytes(message.serialize())

    def _given(self, case: Case, attributes: Attributes) -> dict[str, Any]:
        """Its values by its names."""
        given: dict[str, Any] = {}

        def give(leaf: Leaf) -> None:
            name, theirs = attributes.of(leaf)
            if not name and leaf.name.endswith("hp"):
                base, _ = attributes.bit(leaf.name[:-2], leaf.indices)
                given[f"_HP{base}"] = inside(leaf)
            elif name:
                given[name] = as_theirs(leaf, theirs)

        mapped(self._messages[case.message].plan.steps, case.values, give)
        if case.message == "rxm_rawx":
            given["reserved1"] = case.values["version"] | case.values["reserved0"] << 8
        return given

    def items_frame(self, items: list[tuple[str, object]]) -> bytes:
        """The frame that it makes of configuration items by their names, for the RAM."""
        return bytes(self._package.UBXMessage.config_set(1, 0, items).serialize())

    def values(self, case: Case, frame: bytes) -> Values:
        parsed = self._parsed(case, frame)
        attributes = Attributes(parsed, case.message)
        steps = self._messages[case.message].plan.steps
        high: dict[str, float] = {}

        def note(leaf: Leaf) -> None:
            if leaf.name.endswith("hp") and not attributes.of(leaf)[0]:
                high[leaf.name[:-2]] = leaf.physical

        def read(leaf: Leaf) -> Any:
            if case.message in ITEMS and leaf.indices:
                return self._of_item(case, leaf, parsed)
            if leaf.name.endswith("hp") and leaf.name[:-2] in high:
                return leaf.value
            name, theirs = attributes.of(leaf)
            if not name and leaf.value == "":
                return leaf.value  # It has no fields where the payload is empty.
            self._compare_bits(case, leaf, attributes)
            return as_ours(leaf, theirs, high.get(leaf.name, 0))

        mapped(steps, case.values, note)
        return mapped(steps, case.values, read)

    def _of_item(self, case: Case, leaf: Leaf, parsed: Any) -> Any:
        """A key or a value of a configuration item; of items with the same key, it has the last."""
        items = {item["key"]: item["value"]["value"] for item in case.values["items"]}
        key = case.values["items"][leaf.indices[0] - 1]["key"]
        name, kind = self._package.cfgkey2name(key)
        theirs = getattr(parsed, name)
        value = int.from_bytes(self._package.val2bytes(theirs, kind), "little")
        return leaf.value if leaf.name == "key" or value == items[key] else theirs

    def _compare_bits(self, case: Case, leaf: Leaf, attributes: Attributes) -> None:
        if isinstance(leaf.step, IntegerStep):
            type = leaf.step.type
            flags = type.flags.bits if type.flags is not None else ()
            runs = [(flag.name, leaf.value >> flag.bit & 1) for flag in flags]
            runs += [(run.name, (leaf.value & run.mask) >> run.low) for run in type.bit_fields]
            for run, value in runs:
                name, theirs = attributes.bit(run, leaf.indices)
                if (case.message, leaf.name) not in WITHOUT:
                    assert name, (case.message, leaf.name, run)
                    assert theirs == value, (case.message, leaf.name, run)

    def found(self, endpoint: str, data: bytes) -> Iterator[bytes]:
        """The frames that its reader yields."""
        mode = GET if endpoint == "receiver" else self._package.SETPOLL
        reader = self._package.UBXReader(
            BytesIO(data), protfilter=self._package.UBX_PROTOCOL, quitonerror=0, msgmode=mode
        )
        for raw, _ in reader:
            yield raw


def inside(leaf: Leaf) -> float:
    """A physical value that it truncates to the raw one: it divides floats and takes `int`."""
    return float((abs(leaf.value) + 0.25) * leaf.step.field.scale) * (-1 if leaf.value < 0 else 1)


def as_theirs(leaf: Leaf, like: Any) -> Any:
    """A value of ours, as pyubx2 has that one."""
    if isinstance(leaf.step, IntegerStep):
        if isinstance(like, bytes):
            size = leaf.step.sizes.greatest
            return leaf.value.to_bytes(size, "little", signed=leaf.value < 0)
        is_raw = leaf.step.field.scale == 1 or like == leaf.value
        return leaf.value if is_raw else inside(leaf)
    if isinstance(leaf.step, FloatStep):
        return float(leaf.value)
    if isinstance(leaf.step.type, Text):
        text = leaf.value.encode("latin-1").ljust(leaf.step.sizes.least, b"\0")
        return text if isinstance(like, bytes) else leaf.value
    data = bytes.fromhex(leaf.value)
    if isinstance(like, int):
        return int.from_bytes(data, "little")
    return list(data) if isinstance(like, list) else data


def as_ours(leaf: Leaf, theirs: Any, more: float) -> Any:
    """A value of pyubx2, as we have it; ours if that is what it says."""
    if isinstance(leaf.step, FloatStep):
        return leaf.value if repr(float(leaf.value)) == repr(theirs) else theirs
    if isinstance(leaf.step, IntegerStep):
        if isinstance(theirs, bytes):
            return int.from_bytes(theirs, "little", signed=leaf.step.type.signed)
        # It rounds to twelve digits behind the point.
        agrees = math.isclose(theirs, leaf.physical + more, rel_tol=1e-11, abs_tol=2e-12)
        return leaf.value if agrees else theirs
    if isinstance(leaf.step.type, Text):
        return theirs.rstrip(b"\0").decode("latin-1") if isinstance(theirs, bytes) else theirs
    if isinstance(theirs, int):
        return theirs.to_bytes(len(leaf.value) // 2, "little").hex()
    return bytes(theirs).hex()


def is_known(case: Case) -> bool:
    """True if pyubx2 has the layout of a case."""
    values, name = case.values, case.message
    version = {"nav_relposned_v0": "0", "nav_relposned": "1"}.get(name, str(values.get("version")))
    kind = {"rxm_rlm_short": "1", "rxm_rlm_long": "2"}.get(name, str(values.get("type")))
    if version != str(values.get("version")) or kind != str(values.get("type")):
        return False
    if name in ("cfg_nmea_4", "cfg_nmea_12"):
        return endpoint_of("ubx", case) == "receiver"  # It has only the newest to be sent.
    if name == "cfg_cfg":  # To it, the mask of devices is always there.
        return values["device_mask"] is not None
    if name in ONE_BLOCK:
        return len(values[ONE_BLOCK[name]]) == 1
    if name in ITEMS:  # It takes the highest bit of a key, which is reserved, for one of the size.
        return all(item["key"] < 1 << 31 for item in values["items"])
    if name == "mga_ack_data0":
        return bool(values["type"] in (0, 1))
    if name != "mga_ano" and any(isinstance(values.get(it), str) for it in ("data", "content")):
        return False  # Bytes of a type or version that nobody knows.
    return name not in UNKNOWN


@pytest.fixture(scope="module")
def pyubx2() -> Pyubx2:
    return Pyubx2()


@pytest.fixture(scope="module")
def drawn() -> list[Case]:
    """Two large frames of a message at most, and all small ones."""
    cases: list[Case] = []
    large: Counter[str] = Counter()
    for case in filter(is_known, cases_of("ubx")):
        large[case.message] += is_large(case)
        if not is_large(case) or large[case.message] <= 2:
            cases.append(case)
    assert len(cases) >= 1000
    return cases


def is_large(case: Case) -> bool:
    return len(encoded("ubx", case)) > LARGE


def test_both_make_and_read_the_same_frames(pyubx2: Pyubx2, drawn: list[Case]) -> None:
    """All messages but those that it does not know."""
    messages = {message.name for message in protocol_of(FOLDER / "ubx.yaml").messages}
    assert {case.message for case in drawn} == messages - UNKNOWN.keys()
    compare_frames("ubx", pyubx2, drawn)


@pytest.mark.parametrize("endpoint", ["host", "receiver"])
def test_no_frame_is_lost_that_it_finds(pyubx2: Pyubx2, drawn: list[Case], endpoint: str) -> None:
    small = [case for case in drawn if not is_large(case)]
    compare_recovery("ubx", endpoint, pyubx2, small[::2])


def test_items_of_all_sizes_are_made_by_their_names(pyubx2: Pyubx2) -> None:
    items = {
        "CFG_RATE_MEAS": (0x30210001, "two_bytes", 250),
        "CFG_SIGNAL_GPS_ENA": (0x1031001F, "bit", 1),
        "CFG_NAVSPG_DYNMODEL": (0x20110021, "byte", 4),
        "CFG_UART1_BAUDRATE": (0x40520001, "four_bytes", 115200),
        "CFG_NAVSPG_USRDAT_MAJA": (0x50110062, "eight_bytes", 6378137.0),
    }
    given = [(name, value) for name, (_, _, value) in items.items()]
    frame = pyubx2.items_frame(given)
    (event,) = engine_of("ubx").events("host", [frame])
    assert event.message == "cfg_valset"
    found = event.values["items"]
    assert [item["key"] for item in found] == [key for key, _, _ in items.values()]
    values = [item["value"]["value"] for item in found]
    assert values == [250, 1, 4, 115200, *struct.unpack("<Q", struct.pack("<d", 6378137.0))]
