"""Claims of findings, who is affected and how, held against what codecs do with the frames."""

from __future__ import annotations

from pathlib import Path
from types import ModuleType

import pytest
from cli_support import run

from protogen.compiler import compile_file
from protogen.evolution.findings import Finding, findings
from protogen.evolution.quantities import meaning_of
from protogen.live.codec import module_of
from protogen.model.protocol import Protocol
from protogen.model.types import Field, Integer
from protogen.runtime.errors import DecodeError

SCHEMA = """\
protocol: demo
endpoints: {host: Computer, board: Sensor board}
byte_order: little
frame:
  start:   {literal: 0xAA}
  length:  {type: uint8, counts: payload, range: [0, 40]}
  kind:    {type: uint8, id: true}
  number:  {type: uint8, counter: true}
  payload: {}
  crc:     {type: uint16, algorithm: CRC-16/KERMIT, covers: [kind, number, payload]}
transparency:
  covers: length..crc
  escape: {byte: 0xAB, of: [0xAA, 0xAB], transform: {xor: 0x20}}
types:
  mode: {type: uint8, values: {idle: 0, run: 1, stop: 2, wait: 3}}
  gate: {type: uint8, values: {shut: 0, open: 1}, closed: true}
messages:
  state:
    id: 1
    from: board
    fields:
      x: uint8
      is_on: bool
      text: {type: ascii, size: 4}
      raw: {type: bytes, size: 4}
      mode: mode
      gate: gate
      lamps: {type: uint8, flags: {hot: 0, wet: 1}}
      gear: {type: uint8, bits: {step: {bits: 0..2, values: {low: 1, high: 5}}, rest: {bits: 3..7}}}
      way: {type: uint16, unit: mm, special: {unseen: 0xFFFF}}
      speed: {type: float32, unit: m/s}
  order: {id: 2, from: host, fields: {mode: mode}}
"""


def compiled(path: Path, text: str) -> Protocol:
    path.write_text(text, encoding="utf-8")
    compilation = compile_file(path)
    assert compilation.protocol is not None, compilation.problems
    return compilation.protocol


def after(tmp_path: Path, *edits: tuple[str, str]) -> tuple[Protocol, Protocol, list[Finding]]:
    text = SCHEMA
    for before, now in edits:
        assert text.count(before) == 1, before
        text = text.replace(before, now)
    old = compiled(tmp_path / "old.yaml", SCHEMA)
    new = compiled(tmp_path / "new.yaml", text)
    return old, new, findings(old, new)[1]


def said(found: list[Finding]) -> list[tuple[str, str, str, str]]:
    return [(f.category.value, f.rule.name, f.affected, f.harm) for f in found]


class TestNames:
    def test_each_name_has_a_frame_that_holds_it(self, tmp_path: Path) -> None:
        edit = "{idle: 0, run: 1, stop: 2, wait: 3}", "{idle: 0, run: 7}"
        old, new, found = after(tmp_path, edit)
        modules = {True: module_of(old), False: module_of(new)}
        seen = {}
        for item in found:
            for witness in item.witnesses:
                sender = witness.sender
                read = modules[witness.old_sends].decode(witness.frame, sender)
                seen[item.change.text, witness.old_sends] = int(read.mode)
        assert seen == {
            ("run from 1 to 7", True): 1,
            ("run from 1 to 7", False): 7,
            ("stop, 2", True): 2,
            ("wait, 3", True): 3,
        }

    def test_a_name_that_is_gone_loses_meaning_and_misleads_nobody(self, tmp_path: Path) -> None:
        edits = [
            ("stop: 2, wait: 3", "stop: 2"),
            ("{hot: 0, wet: 1}", "{hot: 0}"),
            ("{low: 1, high: 5}", "{low: 1}"),
        ]
        for edit in edits:
            _, _, (item,) = after(tmp_path, edit)
            assert (item.affected, item.harm) == ("new receiver of old frames", "lost")

    def test_a_number_that_another_name_takes_over_misleads(self, tmp_path: Path) -> None:
        _, _, found = after(tmp_path, ("stop: 2, wait: 3", "wait: 2"))
        gone = next(item for item in found if item.rule.name == "enum-value-deleted")
        assert (gone.affected, gone.harm) == ("both", "misread")
        assert "reads mode 2 (wait) where 2 (stop) was meant" in gone.witnesses[0].words

    def test_a_run_of_bits_is_looked_at_by_its_own_values(self, tmp_path: Path) -> None:
        old, new, (item,) = after(tmp_path, ("{low: 1, high: 5}", "{low: 1, high: 6}"))
        assert (item.rule.name, item.change.place) == ("enum-value", "state.gear.step")
        modules = {True: module_of(old), False: module_of(new)}
        for witness in item.witnesses:
            gear = modules[witness.old_sends].decode(witness.frame, "board").to_dict()["gear"]
            raw = gear if isinstance(gear, int) else gear["step"]
            assert raw & 7 == (5 if witness.old_sends else 6)

    def test_a_closed_enum_that_grows_loses_frames(self, tmp_path: Path) -> None:
        old, new, (item,) = after(tmp_path, ("open: 1}", "open: 1, stuck: 2}"))
        assert said([item]) == [
            ("WIRE", "enum-closed-added", "old receiver of new frames", "rejected")
        ]
        (witness,) = item.witnesses
        assert int(module_of(new).decode(witness.frame, "board").gate) == 2
        with pytest.raises(DecodeError, match="value"):
            module_of(old).decode(witness.frame, "board")

    def test_a_closed_enum_that_renames_by_moving_still_takes_the_number(
        self, tmp_path: Path
    ) -> None:
        _, _, found = after(tmp_path, ("{shut: 0, open: 1}", "{open: 0}"))
        assert {f.rule.name for f in found} == {"enum-value", "enum-value-deleted"}


class TestQuantities:
    @pytest.mark.parametrize(
        ("unit", "scale"),
        [("m", "1/1000"), ("cm", "1/10"), ("um", "1000"), ("km", "1/1000000"), ("inch", "5/127")],
    )
    def test_the_same_quantity_in_another_unit_hurts_nobody(
        self, unit: str, scale: str, tmp_path: Path
    ) -> None:
        edit = "uint16, unit: mm", f"uint16, scale: {scale}, unit: {unit}"
        _, _, found = after(tmp_path, edit)
        assert said(found) == [("SOURCE", "field-rescaled", "code", "recompile")]

    @pytest.mark.parametrize("unit", ["cm", "m", "s", "inch", "mV"])
    def test_another_unit_is_shown_by_a_number_that_is_not_zero(
        self, unit: str, tmp_path: Path
    ) -> None:
        _, _, (item,) = after(tmp_path, ("uint16, unit: mm", f"uint16, unit: {unit}"))
        assert said([item]) == [("VALUE", "field-unit", "both", "misread")]
        for witness in item.witnesses:
            assert not witness.differences[0].sent.startswith("0 ")  # type: ignore[union-attr]

    @pytest.mark.parametrize("unit", ["mm/s", "deg/s", "cd", "mol", "ms/m", "mile", "dBm"])
    def test_letters_that_are_no_prefix_stay(self, unit: str) -> None:
        field = Field(name="f", type=Integer(bits=8), position=0, unit=unit)
        known = {"mm/s": "m/s", "ms/m": "s/m"}
        assert meaning_of(field).unit == known.get(unit, unit)

    def test_special_values_have_no_quantity(self, tmp_path: Path) -> None:
        _, _, (item,) = after(tmp_path, ("unseen: 0xFFFF", "unseen: 0xFFFE"))
        assert (item.affected, item.harm) == ("both", "misread")
        old, new = item.witnesses
        assert "where 65535 (unseen) was meant" in old.words
        assert "where 65534 (unseen) was meant" in new.words


class TestOtherForms:
    @pytest.mark.parametrize(
        "edit",
        [
            ("raw: {type: bytes, size: 4}", "raw: {type: ascii, size: 4}"),
            ("raw: {type: bytes, size: 4}", "raw: {type: uint8, count: 4}"),
            ("text: {type: ascii, size: 4}", "text: {type: bytes, size: 4}"),
            ("x: uint8", "x: char"),
        ],
    )
    def test_the_same_bytes_in_another_form_hurt_code_only(
        self, edit: tuple[str, str], tmp_path: Path
    ) -> None:
        _, _, found = after(tmp_path, edit)
        assert said(found) == [("SOURCE", "field-kind", "code", "recompile")]

    def test_a_bool_refuses_what_a_number_may_be(self, tmp_path: Path) -> None:
        _, _, found = after(tmp_path, ("x: uint8", "x: bool"))
        assert said(found) == [("WIRE", "field-encoding", "new receiver of old frames", "rejected")]

    def test_a_number_that_was_a_bool(self, tmp_path: Path) -> None:
        _, _, found = after(tmp_path, ("is_on: bool", "is_on: uint8"))
        assert said(found) == [("WIRE", "field-encoding", "old receiver of new frames", "rejected")]


TEXT = "  order: {id: 2, from: host, separator: SIGN, fields: {a: FORM, b: decimal}}\n"


class TestSeparators:
    """What becomes of messages whose fields are text."""

    @pytest.mark.parametrize(
        ("edit", "expected"),
        [
            (("SIGN", '";"'), {("WIRE", "field-encoding")}),
            (("SIGN", '{byte: ",", in_front: true}'), {("WIRE", "field-encoding")}),
            (("FORM", "{type: decimal, digits: {min: 3, max: 9}}"), {("NONE", "field-spelling")}),
            (("FORM", "{type: decimal, digits: {max: 4}}"), {("WIRE", "field-width")}),
            (("FORM", "{type: decimal, fraction: 2, digits: 7}"), {("WIRE", "field-encoding")}),
        ],
    )
    def test_frames_show_what_changed(
        self, edit: tuple[str, str], expected: set[tuple[str, str]], tmp_path: Path
    ) -> None:
        before = "  order: {id: 2, from: host, fields: {mode: mode}}\n"
        texts = [
            SCHEMA.replace(before, text.replace("SIGN", '","').replace("FORM", "decimal"))
            for text in (TEXT, TEXT.replace(*edit))
        ]
        old, new = (compiled(tmp_path / f"{i}.yaml", text) for i, text in enumerate(texts))
        found = findings(old, new)[1]
        seen = {(item.category.value, item.rule.name) for item in found}
        assert expected <= seen
        harmful = [item for item in found if item.category.value == "WIRE"]
        assert bool(harmful) == ("WIRE" in {category for category, _ in expected})
        assert all(item.witnesses for item in harmful)


class TestTerminators:
    """What becomes of messages with data up to a terminator."""

    @pytest.mark.parametrize(
        ("form", "rule"),
        [
            ("{type: ascii, until: {byte: 10, max: 4}}", "field-encoding"),
            ("{type: ascii, size: 4}", "field-encoding"),
            ("{type: ascii, until: {byte: 0, max: 3}}", "field-count"),
            ("{type: ascii, until: {byte: 0, min: 1, max: 4}}", "field-count"),
        ],
    )
    def test_frames_show_what_changed(self, form: str, rule: str, tmp_path: Path) -> None:
        before = "  order: {id: 2, from: host, fields: {mode: mode}}\n"
        after = "  order: {id: 2, from: host, fields: {name: FORM, x: uint16}}\n"
        old, new = (
            compiled(
                tmp_path / f"{index}.yaml", SCHEMA.replace(before, after.replace("FORM", text))
            )
            for index, text in enumerate(("{type: ascii, until: {byte: 0, max: 4}}", form))
        )
        found = [item for item in findings(old, new)[1] if item.category.value == "WIRE"]
        assert rule in {item.rule.name for item in found}
        assert all(item.witnesses for item in found)

    def test_bytes_that_end_alike_are_shown_as_text(self, tmp_path: Path) -> None:
        before = "  order: {id: 2, from: host, fields: {mode: mode}}\n"
        after = (
            "  order: {id: 2, from: host, fields: {name: {type: KIND, until: {byte: 0, max: 4}}}}\n"
        )
        old, new = (
            compiled(tmp_path / f"{kind}.yaml", SCHEMA.replace(before, after.replace("KIND", kind)))
            for kind in ("ascii", "bytes")
        )
        _, found = findings(old, new)
        assert {(item.category.value, item.rule.name) for item in found} == {
            ("SOURCE", "field-kind")
        }


class TestTextsAndTails:
    """What becomes of messages with texts between separators, and with fields behind a list."""

    def pair(self, folder: Path, *forms: str) -> list[Protocol]:
        before = "  order: {id: 2, from: host, fields: {mode: mode}}\n"
        after = '  order: {id: 2, from: host, separator: ",", fields: {FORM}}\n'
        return [
            compiled(folder / f"{index}.yaml", SCHEMA.replace(before, after.replace("FORM", form)))
            for index, form in enumerate(forms)
        ]

    @pytest.mark.parametrize(
        ("form", "rule"),
        [
            ("{max: 4}, without: [' ', a]", "field-encoding"),
            ("{max: 3}, without: [a]", "field-count"),
            ("{min: 1, max: 4}, without: [a]", "field-count"),
        ],
    )
    def test_frames_show_what_changed(self, form: str, rule: str, tmp_path: Path) -> None:
        texts = [f"name: {{type: ascii, size: {it}}}" for it in ("{max: 4}, without: [a]", form)]
        old, new = self.pair(tmp_path, *texts)
        found = [item for item in findings(old, new)[1] if item.category.value == "WIRE"]
        assert {item.rule.name for item in found} == {rule}
        assert all(item.witnesses for item in found)

    def test_what_stands_behind_a_list_is_no_change_of_the_list(self, tmp_path: Path) -> None:
        number = "type: decimal, digits: {max: 2}"
        base = f"n: {{{number}}}, list: {{{number}, count: {{fill: true, max: 3}}}}"
        old, new = self.pair(tmp_path, base, f"{base}, end: {{type: decimal, range: [0, 9]}}")
        found = [item for item in findings(old, new)[1] if item.category.value == "WIRE"]
        assert {item.rule.name for item in found} == {"field-added"}


class TestLastElements:
    """What becomes of messages with lists whose last element says so."""

    BEFORE = "  order: {id: 2, from: host, fields: {mode: mode}}\n"
    FIELDS = "fields: {a: uint8, flags: {type: uint8, flags: {end: 0, last: 7}}}"

    def pair(self, folder: Path, *forms: str) -> list[Protocol]:
        after = "  order: {id: 2, from: host, fields: {list: {FORM}, x: uint16}}\n"
        return [
            compiled(
                folder / f"{index}.yaml", SCHEMA.replace(self.BEFORE, after.replace("FORM", form))
            )
            for index, form in enumerate(forms)
        ]

    @pytest.mark.parametrize(
        ("form", "rule"),
        [
            (f"until: {{element: flags.end, max: 4}}, {FIELDS}", "field-encoding"),
            (f"count: 3, {FIELDS}", "field-encoding"),
            (f"until: {{element: flags.last, max: 3}}, {FIELDS}", "field-count"),
            (f"until: {{element: flags.last, min: 2, max: 4}}, {FIELDS}", "field-count"),
        ],
    )
    def test_frames_show_what_changed(self, form: str, rule: str, tmp_path: Path) -> None:
        base = f"until: {{element: flags.last, max: 4}}, {self.FIELDS}"
        old, new = self.pair(tmp_path, base, form)
        found = [item for item in findings(old, new)[1] if item.category.value == "WIRE"]
        assert rule in {item.rule.name for item in found}
        assert all(item.witnesses for item in found)

    def test_another_name_of_what_says_so_changes_no_byte(self, tmp_path: Path) -> None:
        old, new = self.pair(
            tmp_path,
            f"until: {{element: flags.last, max: 4}}, {self.FIELDS}",
            "until: {element: bits.done, max: 4}, fields: {a: uint8, bits: "
            "{type: uint8, flags: {end: 0, done: 7}, renamed_from: flags}}",
        )
        assert {item.category.value for item in findings(old, new)[1]} == {"SOURCE"}


class TestCases:
    def test_each_case_has_a_frame_that_selects_it(self, tmp_path: Path) -> None:
        old = "  order: {id: 2, from: host, fields: {mode: mode}}\n"
        fields = SWITCH_FIELDS.replace("CASES", "{1: uint16, 2: uint16, 3: uint32}")
        base = compiled(tmp_path / "base.yaml", SCHEMA.replace(old, fields))
        less = fields.replace("{1: uint16, 2: uint16, 3: uint32}", "{1: uint16}")
        new = compiled(tmp_path / "less.yaml", SCHEMA.replace(old, less))
        module = module_of(base)
        seen = {}
        for item in findings(base, new)[1]:
            for witness in item.witnesses:
                if witness.old_sends and item.rule.name == "field-cases":
                    seen[item.change.text] = int(module.decode(witness.frame, "host").kind)
        assert seen == {"no case 2 any more": 2, "no case 3 any more": 3}

    @pytest.mark.parametrize(
        ("before", "after", "text", "frames"),
        [
            (
                "{1: uint16, else: uint32}",
                "{1: uint16, 2: uint8, else: uint32}",
                "a case 2 instead of `else`",
                {(True, 2), (False, 2)},
            ),
            (
                "{1: uint16, 2: uint8, else: uint32}",
                "{1: uint16, else: uint32}",
                "no case 2 any more, but `else`",
                {(True, 2), (False, 2)},
            ),
        ],
    )
    def test_what_moves_out_of_the_case_of_others_or_into_it_has_other_bytes(
        self, before: str, after: str, text: str, frames: set[tuple[bool, int]], tmp_path: Path
    ) -> None:
        modules, found = self.changed(before, after, tmp_path)
        assert said(found) == [("WIRE", "field-cases", "both", "rejected")]
        (item,) = found
        assert item.change.text == text
        kinds = {
            (one.old_sends, int(modules[one.old_sends].decode(one.frame, "host").kind))
            for one in item.witnesses
        }
        assert kinds == frames

    @pytest.mark.parametrize(
        ("before", "after", "text"),
        [
            ("{1: uint16}", "{1: uint16, else: uint32}", "values without a case have `else`"),
            (
                "{1: uint16, else: uint32}",
                "{1: uint16}",
                "no case `else` any more: values without a case are taken",
            ),
        ],
    )
    def test_others_that_have_a_case_now_are_read_otherwise(
        self, before: str, after: str, text: str, tmp_path: Path
    ) -> None:
        modules, found = self.changed(before, after, tmp_path)
        assert {(item.rule.name, item.change.text) for item in found} == {("field-cases", text)}
        for item in found:
            for one in item.witnesses:
                assert modules[one.old_sends].decode(one.frame, "host").kind != 1
            assert item.witnesses

    @pytest.mark.parametrize(
        ("before", "after", "expected"),
        [
            (
                "{1: uint16, else: uint32}",
                "{1: uint16, 2: uint32, else: uint32}",
                ("SOURCE", "field-kind"),
            ),
            ("{1: uint16, else: uint32}", "{1: uint16, else: sint32}", ("WIRE", "field-sign")),
            ("{else: uint32, 1: uint16}", "{1: uint16, else: uint32}", None),
        ],
    )
    def test_types_of_the_case_of_others_are_compared(
        self, before: str, after: str, expected: tuple[str, str] | None, tmp_path: Path
    ) -> None:
        _, found = self.changed(before, after, tmp_path)
        kinds = [(item.category.value, item.rule.name) for item in found]
        assert kinds == ([] if expected is None else [expected])

    @staticmethod
    def changed(
        before: str, after: str, tmp_path: Path
    ) -> tuple[dict[bool, ModuleType], list[Finding]]:
        order = "  order: {id: 2, from: host, fields: {mode: mode}}\n"
        old, new = (
            compiled(
                tmp_path / f"{number}.yaml",
                SCHEMA.replace(order, SWITCH_FIELDS.replace("CASES", cases)),
            )
            for number, cases in enumerate((before, after))
        )
        return {True: module_of(old), False: module_of(new)}, findings(old, new)[1]


SWITCH_FIELDS = """\
  order:
    id: 2
    from: host
    fields:
      kind: uint8
      value: {switch: kind, cases: CASES}
"""


class TestFrames:
    def test_a_length_that_nobody_sends_is_no_harm(self, tmp_path: Path) -> None:
        _, _, found = after(tmp_path, ("range: [0, 40]", "range: [0, 60]"))
        ranges = [f for f in found if f.change.part == "length"]
        assert {f.rule.name for f in ranges} == {"frame-part-range"}
        assert all("no message is so long" in f.change.text for f in ranges)

    def test_receivers_refuse_a_length_beyond_theirs(self, tmp_path: Path) -> None:
        edits = ("range: [0, 40]", "range: [0, 60]"), ("raw: {type: bytes, size: 4}", LONG)
        old, _, found = after(tmp_path, *edits)
        item = next(f for f in found if f.rule.name == "frame-length-range")
        assert said([item]) == [
            ("WIRE", "frame-length-range", "old receiver of new frames", "rejected")
        ]
        (witness,) = item.witnesses
        with pytest.raises(DecodeError, match="length"):
            module_of(old).decode(witness.frame, "board")

    def test_receivers_take_any_value_of_another_part(self, tmp_path: Path) -> None:
        edit = "counter: true}", "counter: true, range: [0, 9]}"
        old, new, found = after(tmp_path, edit)
        rules = {f.rule.name for f in found if f.change.part is not None}
        assert rules == {"frame-part-range"}
        module = module_of(old)
        frame = module.encode(module.Order(mode=module.Mode.RUN), number=77)
        assert module_of(new).decode(frame, "host").mode == 1

    def test_what_looks_the_same_by_construction_is_let_pass(self, tmp_path: Path) -> None:
        """A counter that is no counter any more looks the same on the wire."""
        _, _, found = after(tmp_path, ("counter: true", "default: 0"))
        assert {f.rule.name for f in found} == {"frame-part-role"}
        assert {f.category.value for f in found} == {"SOURCE"}
        done = run("breaking", str(tmp_path / "old.yaml"), str(tmp_path / "new.yaml"))
        assert done.exit_code == 0, done.output

    def test_a_change_of_all_is_not_shown_by_one_of_a_message(self, tmp_path: Path) -> None:
        """Both messages changed; the frames still show what the checksum does."""
        edits = (
            ("algorithm: CRC-16/KERMIT", "algorithm: CRC-16/XMODEM"),
            ("{idle: 0, run: 1, stop: 2, wait: 3}", "{idle: 1, run: 0, stop: 2, wait: 3}"),
        )
        _, _, found = after(tmp_path, *edits)
        for item in found:
            if item.rule.name == "frame-checksum-algorithm":
                assert (item.affected, item.harm) == ("both", "rejected")
                assert {witness.received.why for witness in item.witnesses} == {"checksum"}


LONG = "raw: {type: bytes, size: 35}"


def test_the_words_of_a_stuffing_say_what_changed(tmp_path: Path) -> None:
    _, _, found = after(tmp_path, ("xor: 0x20", "xor: 0x40"))
    texts = {item.change.text for item in found}
    assert texts == {
        "from escape AB of AA AB, xor 20 over length..crc "
        "to escape AB of AA AB, xor 40 over length..crc"
    }


class TestSizes:
    """What becomes of messages with arrays and regions of so many bytes."""

    @pytest.mark.parametrize(
        ("before", "after", "rule"),
        [
            ("{type: uint16, size: n}", "{type: uint16, count: n}", "field-count"),
            ("{type: uint16, size: n}", "{type: uint16, size: n - 2}", "field-count"),
            ("{size: n, fields: PAIR}", "{fields: PAIR}", "field-encoding"),
            ("{size: n, fields: PAIR}", "{size: n - 1, fields: PAIR}", "field-count"),
        ],
    )
    def test_frames_show_what_changed(
        self, before: str, after: str, rule: str, tmp_path: Path
    ) -> None:
        old, new = (with_field(tmp_path / f"{i}.yaml", it) for i, it in enumerate((before, after)))
        found = [item for item in findings(old, new)[1] if item.category.value == "WIRE"]
        assert rule in {item.rule.name for item in found}
        assert all(item.witnesses for item in found)

    def test_a_size_that_never_changes_is_a_count(self, tmp_path: Path) -> None:
        old = with_field(tmp_path / "old.yaml", "{type: uint16, count: 2}")
        new = with_field(tmp_path / "new.yaml", "{type: uint16, size: 4}")
        assert findings(old, new)[1] == []


def with_field(path: Path, field: str) -> Protocol:
    written = field.replace("PAIR", "{a: uint8, b: {type: bytes, size: {fill: true, max: 3}}}")
    before = "  order: {id: 2, from: host, fields: {mode: mode}}\n"
    after = "  order: {id: 2, from: host, fields: {n: {type: uint8, range: [1, 4]}, x: FORM}}\n"
    return compiled(path, SCHEMA.replace(before, after.replace("FORM", written)))
