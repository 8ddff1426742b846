"""The catalogue of problems: each example shows its problem, and each fix fixes it."""

from __future__ import annotations

from pathlib import Path

import pytest

from protogen.compiler import compile_file
from protogen.problems import CODES, Code
from protogen.problems.catalogue import files_of
from protogen.problems.docs import render_catalogue

SCHEMA_CODES = [code for code in CODES.values() if code.code >= "PG100"]
GREATEST_PARAGRAPH = 600


def reported(example: str, folder: Path) -> set[str]:
    """The codes that a run reports for an example, with its examples verified."""
    folder.mkdir()
    files = files_of(example)
    for name, text in files.items():
        (folder / name).write_text(text, encoding="utf-8")
    compiled = compile_file(folder / next(iter(files)), examples=True)
    return {problem.code for problem in compiled.problems}


@pytest.mark.parametrize("code", SCHEMA_CODES, ids=lambda code: code.code)
def test_a_bad_example_has_this_problem_alone_and_its_mend_has_none(
    code: Code, tmp_path: Path
) -> None:
    assert reported(code.bad_example, tmp_path / "bad") == {code.code}
    assert reported(code.fixed_example, tmp_path / "mended") == set()


@pytest.mark.parametrize("code", SCHEMA_CODES, ids=lambda code: code.code)
def test_an_entry_is_short_and_complete(code: Code) -> None:
    assert code.title[0].isupper() or code.title[0] == "`"
    assert not code.title.endswith(".")
    assert code.explanation.endswith(".\n")
    assert len(code.explanation) <= GREATEST_PARAGRAPH
    assert code.bad_example != code.fixed_example


def test_names_are_words_with_dashes() -> None:
    for code in CODES.values():
        assert code.name.replace("-", "").isalnum()
        assert code.name == code.name.lower()


def test_the_page_is_current(project_root: Path) -> None:
    page = (project_root / "docs" / "problems.md").read_text(encoding="utf-8")
    assert page == render_catalogue(), "run `make generate`"
