"""`protogen import mavlink` over all definitions that pymavlink has, beside what it makes of them.

They are read where they lie, in the installed package, which has them once for MAVLink 1 and once
for 2. For each there is a module that mavgen made, by others.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Iterator
from functools import cache
from pathlib import Path
from random import Random
from tempfile import TemporaryDirectory
from types import ModuleType
from typing import Any

import pytest
from cli_support import run
from library_support import damaged, peer_module
from tooling import require_module

from protogen.compiler import compile_file
from protogen.fuzzing.python_engine import PythonEngine
from protogen.fuzzing.trips import Case, cases, same
from protogen.layout.formatting import format_text
from protogen.live.codec import module_of
from protogen.model.protocol import Protocol

require_module("pymavlink")

FOLDERS = {"1": "v10", "2": "v20"}
"""Where the package has the definitions, by the version of the protocol."""
DIALECTS = (
    "ASLUAV", "AVSSUAS", "all", "ardupilotmega", "common", "csAirLink", "cubepilot", "development",
    "icarous", "loweheiser", "matrixpilot", "minimal", "paparazzi", "python_array_test", "standard",
    "storm32", "test", "uAvionix", "ualberta",
)  # fmt: skip
SCHEMAS = {"csAirLink": "cs_air_link", "uAvionix": "u_avionix"}
"""Names of schemas that are not those of their files, in lower case."""
FAR = ("csAirLink", "icarous", "test")
"""Dialects whose messages all have ids that do not fit into frames of MAVLink 1."""
KEY = bytes(range(32))
TIME = 123_456_789
LINK = 7


def definitions(wire: str) -> Path:
    """The folder of the package's definitions."""
    package = peer_module("pymavlink").__file__
    assert package is not None
    return Path(package).parent / "dialects" / FOLDERS[wire]


def schema_name(dialect: str) -> str:
    return SCHEMAS.get(dialect, dialect.lower())


@cache
def imported(wire: str) -> tuple[Path, str]:
    """The folder of the schemas of all dialects, and what the command prints."""
    folder = TemporaryDirectory()
    FOLDERS_IN_USE.append(folder)
    done = run("import", "mavlink", str(definitions(wire)), "-o", folder.name, "--wire", wire)
    assert done.exit_code == 0, done.output
    return Path(folder.name), done.output


FOLDERS_IN_USE: list[TemporaryDirectory[str]] = []
"""They go with the process."""


@cache
def protocol_of(dialect: str, wire: str) -> Protocol:
    compilation = compile_file(imported(wire)[0] / f"{schema_name(dialect)}.yaml")
    assert compilation.protocol is not None, compilation.problems
    return compilation.protocol


@cache
def engine_of(dialect: str, wire: str) -> PythonEngine:
    """The codec of a dialect that is generated from its schema."""
    return PythonEngine(module_of(protocol_of(dialect, wire)).PROTOCOL)


class Mavgen:
    """What mavgen made of a dialect."""

    def __init__(self, dialect: str, wire: str) -> None:
        self.module: ModuleType = peer_module(f"pymavlink.dialects.{FOLDERS[wire]}.{dialect}")
        self.kinds: dict[str, Any] = {
            kind.msgname: kind for kind in self.module.mavlink_map.values()
        }

    def frame(self, title: str, case: Case) -> bytes:
        """The frame of a case. Parts of a signature follow from the key."""
        link = self.link(is_signed="signature" in case.parts)
        link.seq, link.srcSystem, link.srcComponent = (
            case.parts[name] for name in ("seq", "sysid", "compid")
        )
        made: bytes = self.kinds[title](**self._theirs(title, case)).pack(link)
        return made

    def link(self, *, is_signed: bool) -> Any:
        """One that sends and receives."""
        link = self.module.MAVLink(None)
        if is_signed:
            link.signing.secret_key = KEY
            link.signing.sign_outgoing = True
            link.signing.timestamp = TIME
            link.signing.link_id = LINK
        return link

    def read(self, title: str, frame: bytes, *, is_signed: bool) -> list[str]:
        """The values that it reads in a frame."""
        link = self.link(is_signed=is_signed)
        link.signing.timestamp = 0
        (message,) = link.parse_buffer(bytearray(frame))
        assert message.get_type() == title
        assert message.get_signed() == is_signed
        return held(message)

    def values(self, title: str, case: Case) -> list[str]:
        """The values of a case as it holds them."""
        return held(self.kinds[title](**self._theirs(title, case)))

    def _theirs(self, title: str, case: Case) -> dict[str, Any]:
        """The values under its names: both have the fields in wire order."""
        kind = self.kinds[title]
        types = dict(zip(kind.fieldnames, kind.fieldtypes, strict=True))
        names = zip(kind.ordered_fieldnames, case.values.values(), strict=True)
        return {name: as_theirs(value, types[name]) for name, value in names}

    def found(self, data: bytes) -> Iterator[bytes]:
        """The frames that it finds in a stream."""
        link = self.link(is_signed=False)
        link.robust_parsing = True
        for message in link.parse_buffer(bytearray(data)) or ():
            if message.get_type() not in ("BAD_DATA",) and message.get_msgId() >= 0:
                yield bytes(message.get_msgbuf())


def held(message: Any) -> list[str]:
    """The values that one of its messages holds, in wire order; NaN is like another one."""
    values: list[str] = []
    for name in message.ordered_fieldnames:
        raw = getattr(message, f"_{name}_raw", None)
        value = getattr(message, name) if raw is None else raw.rstrip(b"\0")
        values.append(repr(value))
    return values


def as_theirs(value: Any, kind: str) -> Any:
    """A value of JSON lines as it has it."""
    if isinstance(value, list):
        return [as_theirs(item, kind) for item in value]
    if kind in ("float", "double"):
        return float(value)
    if kind == "char":
        return bytes([value]) if isinstance(value, int) else value.encode("latin-1")
    return value


def drawn(dialect: str, wire: str, count: int = 10) -> Iterator[tuple[str, Case]]:
    """Values of all messages, boundaries and random ones, with their names in the definitions."""
    protocol = protocol_of(dialect, wire)
    titles = {message.name: message.title for message in protocol.messages}
    for case in cases(protocol, count, seed=1):
        yield titles[case.message], sent_by_mavgen(case)


def sent_by_mavgen(case: Case) -> Case:
    """A case with what its encoder does not let its caller choose."""
    fixed = {"compat_flags": 0, "link_id": LINK, "timestamp": TIME}
    parts = {name: fixed.get(name, value) for name, value in case.parts.items()}
    return Case(case.sender, case.message, case.values, parts)


def compare(dialect: str, wire: str, chosen: Iterable[tuple[str, Case]]) -> Counter[str]:
    """Each makes the frames that the other makes, and reads in them what the other put in."""
    engine, mavgen = engine_of(dialect, wire), Mavgen(dialect, wire)
    compared: Counter[str] = Counter()
    for title, case in chosen:
        theirs = mavgen.frame(title, case)
        is_signed = "signature" in case.parts
        parts = dict(case.parts)
        if is_signed:
            parts["signature"] = int.from_bytes(theirs[-6:], "big")
        ours = engine.frame(case.sender, case.message, case.values, parts)
        assert ours.hex() == theirs.hex(), case
        (event,) = engine.events(case.sender, [theirs])
        assert (event.kind, event.message) == ("message", case.message)
        assert same(event.values, case.values), case
        assert event.parts is not None and event.parts.items() >= parts.items()
        assert mavgen.read(title, ours, is_signed=is_signed) == mavgen.values(title, case), case
        compared[case.sender] += 1
    return compared


class TestDefinitions:
    @pytest.mark.parametrize("wire", ["1", "2"])
    def test_all_files_are_read(self, wire: str) -> None:
        files = sorted(file.stem for file in definitions(wire).glob("*.xml"))
        assert files == sorted(DIALECTS)
        folder, printed = imported(wire)
        assert "19 files of definitions read\n" in printed
        missing = FAR if wire == "1" else ()
        schemas = [schema_name(name) for name in DIALECTS if name not in missing]
        assert sorted(file.stem for file in folder.iterdir()) == sorted(schemas)

    def test_what_is_not_in_the_schema_as_it_is_defined_is_named(self) -> None:
        lines = [
            line for line in imported("2")[1].splitlines() if line[:7] in ("left ou", "changed")
        ]
        capability = "left out: GIMBAL_DEVICE_CAP_FLAGS.GIMBAL_DEVICE_CAP_FLAGS_CAN_POINT_LOCATION"
        assert [line.partition(" (")[0] for line in lines] == [
            f"{capability}_LOCAL",
            f"{capability}_GLOBAL",
            "changed: CAMERA_TRACKING_STATUS_FLAGS.CAMERA_TRACKING_STATUS_FLAGS_IDLE",
        ]

    def test_version_1_has_no_messages_with_large_ids(self) -> None:
        lines = [line for line in imported("1")[1].splitlines() if line[:7] == "left ou"]
        reasons = ("MAVLink 1 has for it", "it has no message for MAVLink 1")
        assert all(line.endswith(reasons) for line in lines)

    @pytest.mark.parametrize("wire", ["1", "2"])
    @pytest.mark.parametrize("dialect", DIALECTS)
    def test_compile_with_nothing_to_report(self, dialect: str, wire: str) -> None:
        if wire == "1" and dialect in FAR:
            return
        file = imported(wire)[0] / f"{schema_name(dialect)}.yaml"
        text = file.read_text()
        assert format_text(text) == text
        assert compile_file(file).problems == ()

    @pytest.mark.parametrize("wire", ["1", "2"])
    @pytest.mark.parametrize("dialect", DIALECTS)
    def test_have_the_messages_that_mavgen_has(self, dialect: str, wire: str) -> None:
        module = Mavgen(dialect, wire).module
        expected = {number: kind.msgname for number, kind in module.mavlink_map.items()}
        if wire == "1" and dialect in FAR:
            assert expected == {}
            return
        messages = protocol_of(dialect, wire).messages
        found = {message.identity[0]: message.title for message in messages}
        assert found == expected


class TestFrames:
    @pytest.mark.parametrize("dialect", ["minimal", "standard", "icarous", "test"])
    def test_of_small_dialects_agree_with_mavgen(self, dialect: str) -> None:
        compared = compare(dialect, "2", drawn(dialect, "2"))
        assert set(compared) == {"component_unsigned", "component_signed"}

    def test_of_common_agree_with_mavgen(self) -> None:
        compared = compare("common", "2", drawn("common", "2"))
        assert len(protocol_of("common", "2").messages) == 210
        assert compared["component_unsigned"] > 3500
        assert compared["component_signed"] > 3500

    @pytest.mark.parametrize("dialect", ["all"])
    def test_of_large_dialects_agree_with_mavgen(self, dialect: str) -> None:
        compare(dialect, "2", drawn(dialect, "2", 1))

    def test_of_common_in_version_1_agree_with_mavgen(self) -> None:
        compared = compare("common", "1", drawn("common", "1"))
        assert compared["component"] > 1500

    def test_without_any_zero_left_out_are_read(self) -> None:
        """Receivers take payloads of senders that leave no zeros out."""
        engine, mavgen = engine_of("minimal", "2"), Mavgen("minimal", "2")
        payload = bytes(9)
        head = bytes([9, 0, 0, 5, 1, 1, 0, 0, 0])
        crc = mavgen.module.x25crc(head + payload + bytes([50])).crc
        frame = b"\xfd" + head + payload + crc.to_bytes(2, "little")
        (event,) = engine.events("component_unsigned", [frame])
        assert (event.kind, event.message) == ("message", "heartbeat")
        assert mavgen.read("HEARTBEAT", frame, is_signed=False) == ["0"] * 6

    def test_are_found_where_bytes_are_damaged(self) -> None:
        engine, mavgen = engine_of("common", "2"), Mavgen("common", "2")
        dice = Random(1)
        chosen = [case for _, case in drawn("common", "2", 1) if "signature" not in case.parts]
        frames = [
            engine.frame(case.sender, case.message, case.values, case.parts)
            for case in dice.sample(chosen, 1000)
        ]
        data = damaged(b"".join(frames), dice)
        sent = Counter(frames)
        ours: Counter[bytes] = Counter()
        at = 0
        for event in engine.events("component_unsigned", [data]):
            ours[data[at : at + event.size]] += event.kind == "message"
            at += event.size
        theirs = Counter(mavgen.found(data)) & sent
        assert theirs <= (ours & sent)
        assert 100 < theirs.total() <= (ours & sent).total() < 1000
