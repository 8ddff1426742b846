"""The corpus of bad schemas: each file in `errors/` says which problems it has.

A line `# expect: 12:5 PG006 words` at the top of a file stands for one problem, in line 12 and
column 5, whose message holds the words. A line `# hint: words` behind it is about the same
problem's hint. A file may have these problems and no others. The place of a problem in another file
starts with its path, seen from `errors/`.
"""

from __future__ import annotations

import re
from pathlib import Path
from typing import NamedTuple

import pytest

from protogen.problems import CODES, Problem, Problems, SourceMap, render_text
from protogen.problems.catalogue.project import PROJECT_CODES
from protogen.schema.dialects.extends import merge_bases
from protogen.schema.text.document import GREATEST_SIZE, read_document

CORPUS = Path(__file__).parent / "errors"
EXPECTATION = re.compile(r"# expect: (?:(?P<file>\S+?):)?(\d+):(\d+) (PG\d{3}) (?P<words>.+)")
HINT = "# hint: "
FIRST_CODE_OF_THE_COMPILER = "PG100"


class Expected(NamedTuple):
    """One problem that a file has to have."""

    place: str
    code: str
    words: str
    hint: str = ""


def expectations(path: Path) -> list[Expected]:
    expected: list[Expected] = []
    for line in path.read_text(encoding="utf-8").splitlines():
        if line.startswith(HINT):
            expected[-1] = expected[-1]._replace(hint=line.removeprefix(HINT))
        elif line.startswith("# expect:"):
            expected.append(expectation(line, path))
        else:
            break
    return expected


def expectation(line: str, path: Path) -> Expected:
    match = EXPECTATION.fullmatch(line)
    assert match is not None, f"{path}: {line}"
    file, row, column, code, words = match.groups()
    return Expected(f"{file or path.name}:{row}:{column}", code, words)


def load_problems(path: Path, sources: SourceMap, *, only_front_end: bool) -> list[Problem]:
    """Return what is wrong with a file.

    Files whose problems concern text and dialects need not be whole schemas: for them the rest of
    the compiler is not asked.
    """
    if not only_front_end:
        from protogen.compiler import compile_file

        return list(compile_file(path, examples=True).problems)
    problems = Problems()
    document = read_document(path, problems, sources)
    if document is not None:
        merge_bases(document, problems, sources)
    return list(problems)


def place_of(problem: Problem) -> str:
    assert problem.span is not None
    path = Path(problem.span.file).resolve().relative_to(CORPUS).as_posix()
    return f"{path}:{problem.span.line}:{problem.span.column}"


def unmatched(expected: list[Expected], problems: list[Problem]) -> list[str]:
    """Return what was expected and not reported, or reported and not expected."""
    left = list(problems)
    missing = []
    for item in expected:
        match = next((problem for problem in left if fits(item, problem)), None)
        if match is None:
            missing.append(f"not reported: {item}")
        else:
            left.remove(match)
    return missing + [f"not expected: {problem}" for problem in left]


def fits(expected: Expected, problem: Problem) -> bool:
    found = (place_of(problem), problem.code)
    words = expected.words in problem.message and expected.hint in (problem.hint or "")
    return found == (expected.place, expected.code) and words


@pytest.mark.parametrize("path", sorted(CORPUS.glob("*.yaml")), ids=lambda path: path.stem)
def test_a_bad_schema_has_exactly_the_problems_that_it_states(path: Path) -> None:
    expected = expectations(path)
    assert expected, f"{path} states no problem"
    sources = SourceMap()
    only_front_end = all(item.code < FIRST_CODE_OF_THE_COMPILER for item in expected)
    problems = load_problems(path, sources, only_front_end=only_front_end)
    assert unmatched(expected, problems) == []
    for problem in problems:
        assert problem.code in render_text(problem, sources)


@pytest.mark.parametrize(
    ("data", "place", "code"),
    [
        (b"protocol: sample\nunit: \xb0C\n", "2:7", "PG002"),
        ("protocol: sample\n".encode("utf-16"), "1:1", "PG002"),
        (b"#" * (GREATEST_SIZE + 1), "1:1", "PG003"),
        (b"protocol: sample\n\0", "2:1", "PG004"),
        (b"", "1:1", "PG008"),
    ],
    ids=["latin-1", "utf-16", "too large", "nul", "empty"],
)
def test_files_that_cant_state_their_problems(
    data: bytes, place: str, code: str, tmp_path: Path
) -> None:
    path = tmp_path / "schema.yaml"
    path.write_bytes(data)
    (problem,) = load_problems(path, SourceMap(), only_front_end=True)
    assert (str(problem.span), problem.code) == (f"{path}:{place}", code)


def test_a_file_that_is_not_there(tmp_path: Path) -> None:
    (problem,) = load_problems(tmp_path / "none.yaml", SourceMap(), only_front_end=True)
    assert problem.code == "PG001"


def test_the_corpus_has_every_problem() -> None:
    stated = {item.code for path in CORPUS.glob("*.yaml") for item in expectations(path)}
    elsewhere = {"PG001", "PG002", "PG003", *(code.code for code in PROJECT_CODES)}
    assert set(CODES) - elsewhere - stated == set()
