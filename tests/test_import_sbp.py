"""`protogen import sbp` over small definitions that have one of everything.

`tests/definitions/garden.yaml` is what has to come of those beside it, below the first line.
"""

from __future__ import annotations

from pathlib import Path

import pytest
from cli_support import ROOT, run

from protogen.compiler import compile_file
from protogen.importing.names import label, snake_case
from protogen.importing.units import Unit, read_unit
from protogen.layout.formatting import format_text
from protogen.live.codec import module_of

GARDEN = ROOT / "tests" / "definitions" / "sbp"
EXPECTED = ROOT / "tests" / "definitions" / "garden.yaml"


def imported(folder: Path, *options: str) -> str:
    """Import the garden to a folder; what the command prints."""
    done = run("import", "sbp", str(GARDEN), "-o", str(folder), *options)
    assert done.exit_code == 0, done.output
    return done.output.replace(f"{GARDEN}/", "").replace(f"{folder}/", "")


class TestSchema:
    def test_says_what_the_definitions_say(self, tmp_path: Path) -> None:
        imported(tmp_path)
        first, _, rest = (tmp_path / "sbp.yaml").read_text().partition("\n")
        assert first.startswith("# imported by protogen, sha256 ")
        assert rest == EXPECTED.read_text()

    def test_compiles_with_nothing_to_report(self) -> None:
        assert compile_file(EXPECTED).problems == ()

    def test_is_in_the_canonical_layout(self) -> None:
        text = EXPECTED.read_text()
        assert format_text(text) == text

    @pytest.mark.parametrize(
        ("message", "values", "frame"),
        [
            ("stop", {}, "55 02 01 42 00 00 FA 41"),
            (
                "valves",
                {"n": 2, "valves": [1, 0x0203], "note": "dry\0"},
                "55 04 01 42 00 09 02 01 00 03 02 64 72 79 00 3F DA",
            ),
            (
                "growth",
                {
                    "gardener": "Ada",
                    "quadrants": [-1, 0, 1, 2],
                    "growth": [
                        {"plant": {"bed": 1, "row_number": 2}, "height": 5, "leaves": 3},
                    ],
                },
                "55 03 01 42 00 12 41 64 61 00 00 00 00 00 FF 00 01 02 01 02 05 00 03 00 05 32",
            ),
            (
                "letter",  # A subject that NUL ends, a plant of six bytes, and a picture of one.
                {
                    "number": 7,
                    "subject": "hi",
                    "growth": {
                        "plant": {"bed": 1, "row_number": 2},
                        "height": 100,
                        "leaves": -1,
                    },
                    "rest": "AA",
                },
                "55 06 01 42 00 0B 07 68 69 00 01 02 64 00 FF FF AA D2 C4",
            ),
        ],
    )
    def test_has_the_frames_of_the_protocol(
        self, message: str, values: dict[str, object], frame: str
    ) -> None:
        protocol = compile_file(EXPECTED).protocol
        assert protocol is not None
        module = module_of(protocol)
        kinds = {kind.NAME: kind for kind in module.PROTOCOL.sender("device").messages}
        record = kinds[message].from_dict(values)
        assert module.encode(record).hex(" ").upper() == frame
        (event,) = module.Decoder().feed(bytes.fromhex(frame))
        assert event.message == record


class TestSummary:
    def test_names_what_is_not_as_it_is_defined(self, tmp_path: Path) -> None:
        assert imported(tmp_path).splitlines() == [
            "wrote sbp.yaml: 7 messages, 3 types",
            "left out: Envelope (basics.yaml:10:5): "
            "basics.yaml is only for readers (render_source: false)",
            "changed: MSG_LETTER.words (watering.yaml:122:11): "
            "no size tells where it ends, and it is not the last field; bytes from here on",
            "left out: MSG_TANK_AGAIN (watering.yaml:128:5): MSG_TANK has the id 0x0101, too",
            "left out: MSG_ALL_PLANTS (watering.yaml:130:5): "
            "it has 256 bytes, and a payload has 255 at most",
            "left out: MSG_FAR (watering.yaml:137:5): the id 65536 does not fit in two bytes",
            "changed: MSG_ORDER.urgency (watering.yaml:146:17): "
            "bits 0 to 1 can't hold 5, so the values are those of the whole integer",
            "changed: MSG_ORDER.before (watering.yaml:154:17): "
            "bits 0 to 3 can't hold 16, so the values are those of the whole integer",
            "left out: MSG_ORDER.before (watering.yaml:158:17): "
            "bits 2 to 5, as others lie there too",
            "left out: MSG_ORDER.before (watering.yaml:160:17): bit 8 of an integer of 8",
            "3 files of definitions read",
            f"next: protogen check {tmp_path}",
        ]

    def test_is_short_if_asked_for(self, tmp_path: Path) -> None:
        lines = imported(tmp_path, "--quiet").splitlines()
        assert len(lines) == 9
        assert {line.partition(":")[0] for line in lines} == {"left out", "changed"}


class TestPackages:
    def test_have_a_schema_each_if_asked_for(self, tmp_path: Path) -> None:
        assert "wrote watering.yaml: 7 messages, 2 types\n" in imported(tmp_path, "--split")
        assert [file.name for file in tmp_path.iterdir()] == ["watering.yaml"]
        compilation = compile_file(tmp_path / "watering.yaml")
        assert compilation.problems == ()
        text = (tmp_path / "watering.yaml").read_text()
        assert "doc: |-\n  Water for the plants.\n\n  All messages about it.\n" in text
        assert "unused:" not in text

    def test_come_with_those_that_they_include(self, tmp_path: Path) -> None:
        whole = imported(tmp_path / "whole")
        done = run("import", "sbp", str(GARDEN / "watering.yaml"), "-o", str(tmp_path / "one"))
        assert done.exit_code == 0
        assert "3 files" in whole and "3 files" in done.output
        one, other = ((tmp_path / name / "sbp.yaml").read_text() for name in ("whole", "one"))
        assert one == other

    def test_are_told_from_other_files_of_the_folder(self, tmp_path: Path) -> None:
        (tmp_path / "sub").mkdir()
        (tmp_path / "sub" / "one.yaml").write_text("package: a\ndefinitions: [MSG_A: {id: 1}]\n")
        (tmp_path / "other.yaml").write_text("package: a\ntests: []\n")
        done = run("import", "sbp", str(tmp_path), "-o", str(tmp_path / "out"))
        assert done.exit_code == 0
        assert "1 file of definitions read, 1 other file passed over\n" in done.output


class TestFiles:
    def test_are_left_as_they_are_where_nothing_is_new(self, tmp_path: Path) -> None:
        imported(tmp_path)
        before = (tmp_path / "sbp.yaml").stat().st_mtime_ns
        assert "is there already: sbp.yaml: 7 messages" in imported(tmp_path)
        assert (tmp_path / "sbp.yaml").stat().st_mtime_ns == before

    def test_are_written_anew_where_nobody_changed_them(self, tmp_path: Path) -> None:
        definitions = tmp_path / "one.yaml"
        definitions.write_text("package: one\ndefinitions:\n  - MSG_A: {id: 1}\n")
        assert run("import", "sbp", str(definitions), "-o", str(tmp_path / "out")).exit_code == 0
        definitions.write_text("package: one\ndefinitions:\n  - MSG_B: {id: 1}\n")
        assert run("import", "sbp", str(definitions), "-o", str(tmp_path / "out")).exit_code == 0
        assert "title: MSG_B" in (tmp_path / "out" / "sbp.yaml").read_text()

    @pytest.mark.parametrize("text", ["protocol: mine\n", None])
    def test_of_somebody_else_stay(self, tmp_path: Path, text: str | None) -> None:
        file = tmp_path / "sbp.yaml"
        if text is None:
            imported(tmp_path)
            text = file.read_text().replace("Tank of rain water", "Barrel")
        file.write_text(text)
        done = run("import", "sbp", str(GARDEN), "-o", str(tmp_path))
        assert done.exit_code == 2
        assert "not made by an import, or changed since" in done.output
        assert "--force" in done.output
        assert file.read_text() == text
        imported(tmp_path, "--force")
        assert file.read_text().endswith(EXPECTED.read_text())

    def test_that_git_checks_out_with_other_line_ends_are_not_changed(self, tmp_path: Path) -> None:
        imported(tmp_path)
        file = tmp_path / "sbp.yaml"
        file.write_bytes(file.read_bytes().replace(b"\n", b"\r\n"))
        assert "is there already" in imported(tmp_path)

    def test_of_one_schema_in_the_way_keep_all_from_being_written(self, tmp_path: Path) -> None:
        source, out = tmp_path / "definitions", tmp_path / "out"
        source.mkdir()
        out.mkdir()
        for name in ("a", "b"):
            text = f"package: x.{name}\ndefinitions:\n  - MSG_{name}: {{id: {ord(name)}}}\n"
            (source / f"{name}.yaml").write_text(text)
        (out / "b.yaml").write_text("mine\n")
        done = run("import", "sbp", str(source), "-o", str(out), "--split")
        assert done.exit_code == 2
        assert [file.name for file in out.iterdir()] == ["b.yaml"]


class TestUnits:
    @pytest.mark.parametrize(
        ("text", "unit", "scale"),
        [
            ("ms", "ms", None),
            ("2 cm", "cm", "2"),
            ("0.005 m", "m", "0.005"),
            ("1 mm", "mm", None),
            ("1e-6 m/s^2", "m/s^2", "0.000001"),
            ("cycles / 256", "cycles", "1/256"),
            ("V / 1000", "V", "0.001"),
            ("deg * 2", "deg", "2"),
            ("m * 0.02", "m", "0.02"),
            ("s * 2^-35", "s", "1/34359738368"),
            ("s / (2 ^ 20)", "s", "1/1048576"),
            ("(s / s) / (2 ^ 31)", "s/s", "1/2147483648"),
            ("1 / 8192 semi-circle / s", "semi-circle/s", "1/8192"),
            ("2^-31", None, "1/2147483648"),
            ("0.01", None, "0.01"),
            ("microdegrees", "deg", "0.000001"),
            ("deci-seconds", "s", "0.1"),
            ("degrees C / 100", "degC", "0.01"),
            ('0.00002 "', '"', "0.00002"),
            ("N/A", None, None),
            ("m^(1/2)", "m^(1/2)", None),
            ("s/(semi-circle)^2", "s/(semi-circle)^2", None),
            ("encoded degrees", "encoded degrees", None),
            ("chips*10", "chips*10", None),  # Multiplied already, or still to be multiplied?
            ("Hz / 0", "Hz/0", None),
            ("0 m", "0 m", None),
            ("2^9999 m", "2^9999 m", None),
        ],
    )
    def test_are_told_from_scales_where_that_is_clear(
        self, text: str, unit: str | None, scale: str | None
    ) -> None:
        assert read_unit(text) == Unit(unit, scale)

    def test_keep_what_stands_behind_them_for_people(self) -> None:
        assert read_unit("4 mm (add 2 m for the height)") == Unit(
            "mm", "4", "(add 2 m for the height)"
        )


class TestNames:
    @pytest.mark.parametrize(
        ("name", "snake"),
        [
            ("POS_LLH", "pos_llh"),
            ("GnssSignal", "gnss_signal"),
            ("STECSatElement", "stec_sat_element"),
            ("satId", "sat_id"),
            ("P", "p"),
            ("2nd_try", "n_2nd_try"),
            ("__", "unnamed"),
            ("X" * 80, "x" * 64),
        ],
    )
    def test_of_identifiers(self, name: str, snake: str) -> None:
        assert snake_case(name) == snake

    @pytest.mark.parametrize(
        ("text", "name"),
        [
            ("GPS L1CA", "gps_l1ca"),
            ("+/- 2g", "n_2g"),
            ("Rejected; value unparsable or out-of-range", "rejected_value_unparsable_or_out_of"),
            ("°", "unnamed"),
        ],
    )
    def test_of_descriptions(self, text: str, name: str) -> None:
        assert label(text) == name
