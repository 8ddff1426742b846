"""`protogen import mavlink` over all that pymavlink defines, beside what mavgen makes of it."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable
from random import Random

import pytest
from library_support import damaged
from mavlink_support import (
    Mavgen,
    definitions,
    dialects,
    drawn,
    engine_of,
    imported,
    is_tested_version,
    protocol_of,
    schema_name,
)

from protogen.compiler import compile_file
from protogen.fuzzing.trips import Case, same
from protogen.layout.formatting import format_text

PARTS = 4
"""Parts of the messages of a large dialect, each of which takes some time."""


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
        assert files == dialects()
        assert len(files) >= 19
        folder, printed = imported(wire)
        assert f"{len(files)} files of definitions read\n" in printed
        # Of some, MAVLink 1 can carry no message.
        schemas = [schema_name(name) for name in files if wire == "2" or Mavgen(name, wire).kinds]
        assert sorted(file.stem for file in folder.iterdir()) == sorted(schemas)

    @pytest.mark.skipif(not dialects() or not is_tested_version(), reason="other definitions")
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
    @pytest.mark.parametrize("dialect", dialects())
    def test_compile_with_nothing_to_report(self, dialect: str, wire: str) -> None:
        file = imported(wire)[0] / f"{schema_name(dialect)}.yaml"
        if not file.exists():
            assert not Mavgen(dialect, wire).kinds
            return
        text = file.read_text()
        assert format_text(text) == text
        assert compile_file(file).problems == ()

    @pytest.mark.parametrize("wire", ["1", "2"])
    @pytest.mark.parametrize("dialect", dialects())
    def test_have_the_messages_that_mavgen_has(self, dialect: str, wire: str) -> None:
        module = Mavgen(dialect, wire).module
        expected = {number: kind.msgname for number, kind in module.mavlink_map.items()}
        if not expected:
            return
        messages = protocol_of(dialect, wire).messages
        found = {message.identity[0]: message.title for message in messages}
        assert found == expected


class TestFrames:
    @pytest.mark.parametrize("dialect", ["minimal", "standard", "icarous", "test"])
    def test_of_small_dialects_agree_with_mavgen(self, dialect: str) -> None:
        compared = compare(dialect, "2", drawn(dialect, "2"))
        assert set(compared) == {"component_unsigned", "component_signed"}

    @pytest.mark.parametrize("part", range(PARTS))
    def test_of_common_agree_with_mavgen(self, part: int) -> None:
        names = [message.name for message in protocol_of("common", "2").messages]
        assert len(names) >= 210
        wanted = set(names[part::PARTS])
        chosen = [item for item in drawn("common", "2") if item[1].message in wanted]
        compared = compare("common", "2", chosen)
        assert compared["component_unsigned"] > 750
        assert compared["component_signed"] > 750

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
