"""`protogen import mavlink` over small definitions that have one of everything.

`tests/definitions/harbour` is what has to come of those in `tests/definitions/mavlink`, below the
first line of each file.
"""

from __future__ import annotations

from contextlib import redirect_stdout
from fractions import Fraction
from io import StringIO
from pathlib import Path
from typing import Any

import pytest
import yaml
from cli_support import ROOT, run
from library_support import peer_module

from protogen.compiler import compile_file
from protogen.importing.mavlink.crc_extra import crc_extra, wire_order
from protogen.importing.mavlink.identifiers import common_prefix, identifier, short_name
from protogen.importing.mavlink.spec import read_dialect
from protogen.importing.mavlink.texts import summary_and_doc
from protogen.importing.mavlink.units import read_unit
from protogen.importing.units import Unit
from protogen.importing.xml_text import read_xml
from protogen.layout.formatting import format_text
from protogen.live.codec import module_of

Values = dict[str, Any]

DEFINITIONS = ROOT / "tests" / "definitions" / "mavlink"
EXPECTED = ROOT / "tests" / "definitions" / "harbour"
NAMES = ("tides", "moorings", "harbour")


def imported(folder: Path, *options: str, of: Path = DEFINITIONS) -> str:
    """Import definitions to a folder; what the command prints."""
    done = run("import", "mavlink", str(of), "-o", str(folder), *options)
    assert done.exit_code == 0, done.output
    return done.output.replace(f"{DEFINITIONS}/", "").replace(f"{folder}/", "")


class TestSchemas:
    def test_say_what_the_definitions_say(self, tmp_path: Path) -> None:
        imported(tmp_path)
        assert sorted(file.stem for file in tmp_path.iterdir()) == sorted(NAMES)
        for name in NAMES:
            first, _, rest = (tmp_path / f"{name}.yaml").read_text().partition("\n")
            assert first.startswith("# imported by protogen, sha256 ")
            assert rest == (EXPECTED / f"{name}.yaml").read_text()

    @pytest.mark.parametrize("name", NAMES)
    def test_compile_with_nothing_to_report(self, name: str) -> None:
        assert compile_file(EXPECTED / f"{name}.yaml").problems == ()

    @pytest.mark.parametrize("name", NAMES)
    def test_are_in_the_canonical_layout(self, name: str) -> None:
        text = (EXPECTED / f"{name}.yaml").read_text()
        assert format_text(text) == text

    def test_of_one_file_are_those_that_it_includes_too(self, tmp_path: Path) -> None:
        assert "1 file of definitions" in imported(tmp_path / "a", of=DEFINITIONS / "tides.xml")
        assert [file.name for file in (tmp_path / "a").iterdir()] == ["tides.yaml"]
        assert "3 files of definitions" in imported(tmp_path / "b", of=DEFINITIONS / "harbour.xml")
        assert len(list((tmp_path / "b").iterdir())) == 3

    def test_stay_if_somebody_changed_them(self, tmp_path: Path) -> None:
        imported(tmp_path)
        with (tmp_path / "tides.yaml").open("a") as file:
            file.write("# mine\n")
        done = run("import", "mavlink", str(DEFINITIONS), "-o", str(tmp_path))
        assert done.exit_code == 2
        assert "tides.yaml`: not made by an import, or changed since" in done.output
        imported(tmp_path, "--force")


class TestFrames:
    """Bytes worked out by hand, with checksums by pymavlink, which sums CRC_EXTRA in the end."""

    @pytest.mark.parametrize(
        ("schema", "message", "values", "parts", "frame"),
        [
            (
                "tides",
                "alive",  # CRC_EXTRA 86: the larger field comes first; the version is 3.
                {"time_sent": 0x01020304, "tide": 1, "mavlink_version": 3},
                {"seq": 5},
                "FD 06 00 00 05 01 01 00 00 00 04 03 02 01 01 03 E7 81",
            ),
            (
                "harbour",
                "mooring",  # CRC_EXTRA 115
                {"rope": "loose"},
                {},
                "FD 01 00 00 00 01 01 05 00 00 01 D4 40",
            ),
            (
                "harbour",
                "tide_message",  # CRC_EXTRA 57: of the command, both bytes are zeros.
                {"tide": "spring", "command": 0},
                {"seq": 255, "sysid": 7, "compid": 200},
                "FD 02 00 00 FF 07 C8 06 00 00 2C 01 AA 29",
            ),
            (
                "moorings",
                "mooring",  # Signed, and of the zeros of the payload, one stays.
                {"rope": 0},
                {"link_id": 3, "timestamp": 0x0102, "signature": 0xA1A2A3A4A5A6},
                "FD 01 01 00 00 01 01 05 00 00 00 2B 75 03 02 01 00 00 00 00 A1 A2 A3 A4 A5 A6",
            ),
        ],
    )
    def test_are_those_of_the_protocol(
        self, schema: str, message: str, values: Values, parts: Values, frame: str
    ) -> None:
        protocol = compile_file(EXPECTED / f"{schema}.yaml").protocol
        assert protocol is not None
        module = module_of(protocol)
        codec = module.PROTOCOL
        sender = "component_signed" if "signature" in parts else "component_unsigned"
        kinds = {kind.NAME: kind for kind in codec.sender(sender).messages}
        record = kinds[message].from_dict(values)
        made = codec.encode(record, sender, **({"seq": 0} | parts))
        assert made.hex(" ").upper() == frame
        (event,) = module.Decoder("component").feed(bytes.fromhex(frame))
        assert event.message == record

    def test_of_version_1_have_neither_flags_nor_large_ids(self, tmp_path: Path) -> None:
        imported(tmp_path, "--wire", "1", of=DEFINITIONS / "tides.xml")
        done = run(
            *("encode", str(tmp_path / "tides.yaml"), "alive"),
            *("time_sent=0x01020304", "tide=rising", "@seq=5"),
        )
        assert done.output == "FE 06 05 01 01 00 04 03 02 01 01 03 CD DC\n"

    @pytest.mark.parametrize("name", NAMES)
    def test_have_the_order_and_the_crc_extra_of_mavgen(self, name: str) -> None:
        mavparse = peer_module("pymavlink.generator.mavparse")
        file = DEFINITIONS / f"{name}.xml"
        with redirect_stdout(StringIO()):
            theirs = {item.name: item for item in mavparse.MAVXML(str(file), "2.0").message}
        ours = read_dialect(read_xml(file), str(file)).messages
        assert [message.name for message in ours] == list(theirs)
        for message in ours:
            their = theirs[message.name]
            names = [field.name for field in wire_order(message)]
            assert names == [field.name for field in their.ordered_fields]
            assert crc_extra(message) == their.crc_extra


class TestVersion1:
    def test_has_neither_large_ids_nor_extensions(self, tmp_path: Path) -> None:
        text = DEFINITIONS / "tides.xml"
        lines = imported(tmp_path, "--wire", "1", of=text).splitlines()
        reason = "the id 66000 does not fit in the byte that MAVLink 1 has for it"
        assert f"left out: LEVEL (tides.xml:54:5): {reason}" in lines
        schema = tmp_path / "tides.yaml"
        assert compile_file(schema).problems == ()
        assert "magic: {literal: 0xFE," in schema.read_text()

    def test_leaves_out_extensions(self, tmp_path: Path) -> None:
        small = tmp_path / "small.xml"
        small.write_text((DEFINITIONS / "tides.xml").read_text().replace("66000", "66"))
        imported(tmp_path, "--wire", "1", of=small)
        text = (tmp_path / "small.yaml").read_text()
        assert compile_file(tmp_path / "small.yaml").problems == ()
        assert "open: yes" in text
        assert "lock_tide" not in text
        assert (
            "MAVLink 2 has besides: lockTide, all_water, water_sign, tide_part, raw."
            in " ".join(text.split())
        )

    def test_has_no_schema_of_a_file_without_messages(self, tmp_path: Path) -> None:
        (tmp_path / "far.xml").write_text(
            '<mavlink><messages><message id="300" name="A"/></messages></mavlink>'
        )
        (tmp_path / "near.xml").write_text(
            "<mavlink><include>far.xml</include><messages>"
            '<message id="3" name="B"/></messages></mavlink>'
        )
        lines = imported(tmp_path / "out", "--wire", "1", of=tmp_path / "near.xml")
        assert "far.xml:1:1): it has no message for MAVLink 1\n" in lines
        assert [file.name for file in (tmp_path / "out").iterdir()] == ["near.yaml"]
        assert compile_file(tmp_path / "out" / "near.yaml").problems == ()


class TestSummary:
    def test_names_what_is_not_as_it_is_defined(self, tmp_path: Path) -> None:
        assert imported(tmp_path).splitlines() == [
            "wrote tides.yaml: 2 messages, 6 types",
            "wrote moorings.yaml: 1 message, 2 types",
            "wrote harbour.yaml: 2 messages, 4 types",
            "changed: COMMAND.COMMAND_LEAVE (moorings.xml:6:7): "
            "it has no value, and is 21 behind those of other files",
            "left out: TIDE.TIDE_SPRING (tides.xml:16:7): 300 does not fit in the uint8 of `tide`",
            "changed: WATER_FLAGS.WATER_IS_CLEAR (tides.xml:20:7): "
            "0 is no flag, it is no bit; the doc of the type has it",
            "left out: WATER_FLAGS.WATER_IS_DEEP (tides.xml:23:7): "
            "1099511627776 does not fit in the uint16 of `water_flags_uint16`",
            "changed: WATER_FLAGS.WATER_IS_HOME (tides.xml:24:7): "
            "5 is no flag, it has several bits; the doc of the type has it",
            "left out: LEVEL.water_sign (tides.xml:71:7): "
            "the names of WATER_FLAGS, as a bitmask has no sign",
            "left out: LEVEL.tide_part (tides.xml:72:7): "
            "its values up to 3, which a schema can't say of it",
            "left out: LEVEL.tide_part (tides.xml:72:7): the names of TIDE, as it is no integer",
            "left out: FLOOD (tides.xml:75:5): it has 256 bytes, and a payload has 255 at most",
            "3 files of definitions read",
            f"next: protogen check {tmp_path}",
        ]

    def test_is_short_if_asked_for(self, tmp_path: Path) -> None:
        lines = imported(tmp_path, "--quiet").splitlines()
        assert len(lines) == 9
        assert {line.partition(":")[0] for line in lines} == {"left out", "changed"}


class TestNumbersWithoutAValue:
    """Entries of an enum without a value, in a file and in one that includes it."""

    @pytest.mark.parametrize(
        ("inner", "outer", "expected"),
        [
            ("", ("", ""), "a: 1, b: 2"),
            ("", ("5", ""), "a: 5, b: 6"),
            ("3", ("", ""), "c: 3, a: 1, b: 2"),  # These lie in front of it: nothing to do.
            ("2", ("", ""), "c: 2, a: 3, b: 4"),
            ("7", ("2", ""), "c: 7, a: 2, b: 3"),
            ("7", ("", "9"), "c: 7, a: 8, b: 9"),
        ],
    )
    def test_are_those_of_mavgen(
        self, inner: str, outer: tuple[str, str], expected: str, tmp_path: Path
    ) -> None:
        def entry(name: str, value: str) -> str:
            return f'<entry name="{name}"' + (f' value="{value}"' if value else "") + "/>"

        def write(name: str, head: str, entries: str, number: int) -> None:
            enum = f'<enums><enum name="E">{entries}</enum></enums>' if entries else ""
            message = f'<messages><message id="{number}" name="M{number}"/></messages>'
            (tmp_path / f"{name}.xml").write_text(f"<mavlink>{head}{enum}{message}</mavlink>")

        write("in", "", entry("C", inner) if inner else "", 1)
        entries = entry("A", outer[0]) + entry("B", outer[1])
        write("out", "<include>in.xml</include>", entries, 2)
        imported(tmp_path, "--quiet", of=tmp_path / "out.xml")
        values: dict[str, int] = {}
        for name in ("in", "out"):
            assert compile_file(tmp_path / f"{name}.yaml").problems == ()
            schema = yaml.load((tmp_path / f"{name}.yaml").read_text(), yaml.CSafeLoader)
            values |= schema.get("types", {}).get("e", {}).get("values", {})
        assert ", ".join(f"{name}: {value}" for name, value in values.items()) == expected


class TestNames:
    @pytest.mark.parametrize(
        ("name", "expected"),
        [
            ("GPS_2D", "gps_2d"),
            ("rollRate", "roll_rate"),
            ("Vcc", "vcc"),
            ("time_usec", "time_usec"),
            ("2nd", "n_2nd"),
        ],
    )
    def test_are_in_lower_snake_case(self, name: str, expected: str) -> None:
        assert identifier(name) == expected

    @pytest.mark.parametrize(
        ("enum", "entries", "expected"),
        [
            ("GEAR", ["GEAR_UP", "GEAR_DOWN"], "GEAR_"),
            ("GEAR", ["GEAR_UP_FAST", "GEAR_UP_SLOW"], "GEAR_"),
            ("GEAR_STATE", ["GEAR_UP", "GEAR_DOWN"], "GEAR_"),
            ("GEAR", ["UP", "DOWN"], ""),
            ("GEAR", ["WHEEL_UP", "WHEEL_UP_SLOW"], "WHEEL_"),
            ("GEAR_STATE", ["GEAR_UP"], "GEAR_"),
            ("GEAR", ["GEAR"], ""),
            ("GEAR", [], "GEAR_"),
        ],
    )
    def test_of_entries_have_a_beginning_in_common(
        self, enum: str, entries: list[str], expected: str
    ) -> None:
        assert common_prefix(enum, entries) == expected

    @pytest.mark.parametrize(
        ("entry", "expected"),
        [
            ("FIX_TYPE_NONE", "none"),
            ("FIX_TYPE_3D", "type_3d"),
            ("OTHER", "other"),
        ],
    )
    def test_of_entries_lack_it(self, entry: str, expected: str) -> None:
        assert short_name(entry, "FIX_TYPE_") == expected


class TestTexts:
    @pytest.mark.parametrize(
        ("text", "summary", "doc"),
        [
            ("", "", ""),
            ("State of the lamp", "State of the lamp", ""),
            ("State of the lamp. It blinks.", "State of the lamp.", "It blinks."),
            ("A lamp (e.g. Red). It blinks.", "A lamp (e.g. Red).", "It blinks."),
            ("It costs 3.50 each. Twice.", "It costs 3.50 each.", "Twice."),
            ("Mast of J. Smith", "Mast of J. Smith", ""),
            ("x " * 80, "", ("x " * 80).strip()),
        ],
    )
    def test_have_a_first_sentence(self, text: str, summary: str, doc: str) -> None:
        assert summary_and_doc(text) == (summary, doc)


class TestUnits:
    @pytest.mark.parametrize(
        ("text", "multiplier", "unit", "scale"),
        [
            ("m", "1", "m", None),
            ("mV", "1", "mV", None),
            ("degE7", "1", "deg", "1/10000000"),
            ("cdeg/s", "1", "deg/s", "0.01"),
            ("d%", "1", "%", "0.1"),
            ("m/s*5", "1", "m/s", "0.2"),
            ("deg/2", "1", "deg", "2"),
            ("m/s/s", "1", "m/s^2", None),
            ("deg", "360/255", "deg", "24/17"),
            ("", "1E-2", None, "0.01"),
            ("cm", "10", "cm", "10"),
            ("parsec", "1", "parsec", None),
        ],
    )
    def test_are_scale_and_unit(
        self, text: str, multiplier: str, unit: str | None, scale: str | None
    ) -> None:
        assert read_unit(text, Fraction(multiplier)) == Unit(unit, scale)
