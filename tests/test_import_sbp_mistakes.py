"""Mistakes in definitions of SBP: each is told with its place, and nothing is written."""

from __future__ import annotations

from pathlib import Path

import pytest
from cli_support import run

HEAD = "package: x.one\ndefinitions:\n"
FIELD = HEAD + "  - MSG_A:\n      id: 1\n      fields:\n        - n: {type: u8}\n"
MISTAKES = {
    "no_yaml": ("package: [\n", "one.yaml:1:11: error[PG004]"),
    "a_tab": ("package:\tone\n\tx: 1\n", "error[PG005]"),
    "an_empty_file": ("", "the file is empty"),
    "another_file": ("protocol: x\n", "definitions` holds definitions of SBP"),
    "a_list": ("- 1\n", "definitions` holds definitions of SBP"),
    "no_package_name": (
        "package: {a: 1}\ndefinitions: []\n",
        "one.yaml:1:10: here stands a text",
    ),
    "definitions_as_text": ("package: a\ndefinitions: all\n", ":2:14: here stands a name"),
    "fields_as_text": (HEAD + "  - MSG_A: {id: 1, fields: [x]}\n", "here stands a name"),
    "an_id_as_text": (HEAD + "  - MSG_A: {id: first}\n", ":3:17: this is no whole number"),
    "no_type": (HEAD + "  - MSG_A: {id: 1, fields: [x: {desc: X}]}\n", "the field `x` has no type"),
    "an_unknown_type": (FIELD + "        - x: {type: u24}\n", ":7:21: there is no type `u24`"),
    "a_slip_in_a_type": (
        FIELD + "        - x: {type: Heigth}\n  - Height: {fields: [mm: {type: u8}]}\n",
        "did you mean `Height`?",
    ),
    "an_unknown_fill": (FIELD + "        - x: {type: array, fill: A}\n", "there is no type `A`"),
    "no_fill": (FIELD + "        - x: {type: array}\n", "the array `x` has no `fill`"),
    "a_size_of_zero": (FIELD + "        - x: {type: string, size: 0}\n", "is 1 or more"),
    "a_size_as_text": (FIELD + "        - x: {type: string, size: n}\n", "no whole number"),
    "an_unknown_counter": (
        FIELD + "        - x: {type: array, fill: u8, size_fn: m}\n",
        "there is no field `m` that counts `x`",
    ),
    "a_counter_that_is_no_integer": (
        FIELD.replace("u8", "float") + "        - x: {type: array, fill: u8, size_fn: n}\n",
        "`n` counts, and is no integer",
    ),
    "a_definition_twice": (
        HEAD + "  - MSG_A: {id: 1}\n  - MSG_A: {id: 2}\n",
        ":4:5: there is a definition `MSG_A` already",
    ),
    "a_field_twice": (FIELD + "        - n: {type: u16}\n", "there is a field `n` already"),
    "a_struct_in_itself": (
        HEAD + "  - A: {fields: [b: {type: B}]}\n  - B: {fields: [a: {type: A}]}\n",
        "is inside of itself",
    ),
    "no_bits": (
        HEAD + "  - MSG_A: {id: 1, fields: [x: {type: u8, fields: [high: {desc: H}]}]}\n",
        "`high` are no bits",
    ),
    "bits_from_high_to_low": (
        HEAD + "  - MSG_A: {id: 1, fields: [x: {type: u8, fields: [7-4: {desc: H}]}]}\n",
        "`7-4` are no bits",
    ),
    "a_value_as_text": (
        HEAD + "  - MSG_A: {id: 1, fields: [x: {type: u8, fields: [0-7: {values: [a: B]}]}]}\n",
        "this is no whole number",
    ),
    "a_missing_include": ("package: a\ninclude: [two.yaml]\n", "there is no file `two.yaml`"),
    "an_include_of_itself": (
        "package: a\ninclude: [one.yaml]\n",
        ":2:11: this include closes a circle: one.yaml -> one.yaml",
    ),
    "an_include_as_text": ("package: a\ninclude: one.yaml\n", "here stands a list"),
    "no_message": ("package: a\ndefinitions: [A: {fields: []}]\n", "defines no message"),
}


def refused(tmp_path: Path, path: Path) -> str:
    """Import what can't be imported; what the command says."""
    output = tmp_path / "out"
    done = run("import", "sbp", str(path), "-o", str(output), COLUMNS="300")
    assert done.exit_code == 2, done.output
    assert not output.exists()
    return done.output


@pytest.mark.parametrize("name", MISTAKES)
def test_a_mistake_is_told_with_its_place(name: str, tmp_path: Path) -> None:
    text, expected = MISTAKES[name]
    folder = tmp_path / "definitions"
    folder.mkdir()
    (folder / "one.yaml").write_text(text)
    assert expected in refused(tmp_path, folder)


def test_a_circle_of_includes_is_shown(tmp_path: Path) -> None:
    for name, other in (("a", "b"), ("b", "c"), ("c", "a")):
        (tmp_path / f"{name}.yaml").write_text(f"package: {name}\ninclude: [{other}.yaml]\n")
    assert "a.yaml -> b.yaml -> c.yaml -> a.yaml" in refused(tmp_path, tmp_path)


def test_a_type_of_a_file_that_is_not_included_is_found(tmp_path: Path) -> None:
    (tmp_path / "a.yaml").write_text(HEAD + "  - MSG_A: {id: 1, fields: [x: {type: B}]}\n")
    (tmp_path / "b.yaml").write_text(HEAD + "  - B: {fields: [y: {type: u8}]}\n")
    assert "b.yaml defines it, and is not included" in refused(tmp_path, tmp_path)


def test_a_folder_without_definitions_is_told(tmp_path: Path) -> None:
    (tmp_path / "empty").mkdir()
    assert "holds no .yaml file" in refused(tmp_path, tmp_path / "empty")
    assert "there is no file or folder" in refused(tmp_path, tmp_path / "missing")


def test_a_folder_that_can_not_be_made_is_told(tmp_path: Path) -> None:
    (tmp_path / "file").write_text("")
    (tmp_path / "one.yaml").write_text(FIELD)
    done = run("import", "sbp", str(tmp_path / "one.yaml"), "-o", str(tmp_path / "file"))
    assert done.exit_code == 2
    assert "error:" in done.output


def test_a_file_that_is_named_or_included_has_to_hold_definitions(tmp_path: Path) -> None:
    (tmp_path / "other.yaml").write_text("protocol: x\n")
    (tmp_path / "one.yaml").write_text("package: a\ninclude: [other.yaml]\n")
    for path in (tmp_path / "other.yaml", tmp_path / "one.yaml", tmp_path):
        assert "other.yaml:1:1: these are no definitions of SBP" in refused(tmp_path, path)


def test_a_format_that_there_is_not_is_told() -> None:
    done = run("import", "dbc", "x")
    assert done.exit_code == 2
    assert "No such command 'dbc'" in done.output
