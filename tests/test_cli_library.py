"""Schemas of the library, by name on the command line and in Python."""

from __future__ import annotations

from pathlib import Path

import pytest
from cli_support import run

import protogen
from protogen.library import library_file
from protogen.schema.files import NoSchemaError

# Of VESC's short frames: 2, the length, GET_VALUES, its CRC-16/XMODEM, 3.
VALUES_ASKED = "02 01 04 40 84 03"


@pytest.mark.parametrize(
    ("arguments", "shown"),
    [
        (["check"], "no problems"),
        (["check", "--quiet"], ""),
        (["decode", "--hex", VALUES_ASKED], "get_values"),
        (["explain", "--hex", VALUES_ASKED], "get_values"),
        (["encode", "get_values", "--sender", "host"], VALUES_ASKED),
        (["diff", "library:vesc"], "no change"),
        (["breaking", "library:vesc"], ""),
    ],
    ids=str,
)
def test_a_command_takes_a_schema_of_the_library(arguments: list[str], shown: str) -> None:
    command, *others = arguments
    result = run(command, "library:vesc", *others)
    assert result.exit_code == 0, result.output
    assert shown in result.stdout


def test_it_is_generated_under_its_own_name(tmp_path: Path) -> None:
    result = run("generate", "library:vesc", "--target", "markdown", "-o", str(tmp_path))
    assert result.exit_code == 0
    assert "from vesc.yaml" in (tmp_path / "markdown" / "vesc.md").read_text(encoding="utf-8")


@pytest.mark.parametrize(
    "command", ["check", "decode", "explain", "encode", "fuzz", "size", "lock"]
)
def test_a_name_that_the_library_lacks_is_told_with_a_close_one(command: str) -> None:
    result = run(command, "library:vesk")
    assert result.exit_code == 2
    assert "the library has no schema `vesk`" in result.output
    assert "did you mean `vesc`?" in result.output


def test_what_writes_schemas_leaves_the_library_alone() -> None:
    file = library_file("vesc")
    assert file is not None
    before = file.read_bytes()
    assert run("fmt", "library:vesc").exit_code == 2
    assert file.read_bytes() == before


def test_python_takes_one_likewise() -> None:
    assert protogen.load("library:vesc").name == "vesc"
    with pytest.raises(NoSchemaError, match="no schema `vesk`"):
        protogen.load("library:vesk")
