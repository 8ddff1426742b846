"""The library: its schemas compile, are extended and installed."""

from __future__ import annotations

import re
from collections.abc import Iterator
from pathlib import Path
from random import Random

import pytest
from amounts import LIBRARY_SAMPLES
from cli_support import run
from compiled import ROOT, module_at, protocol_of
from tooling import require_compiler

from protogen.compiler import compile_file
from protogen.fuzzing.c_engine import CEngine
from protogen.fuzzing.python_engine import PythonEngine
from protogen.fuzzing.samples import samples_at_least
from protogen.fuzzing.trips import Case, try_engines
from protogen.library import FOLDER, library_file, library_names, page
from protogen.library.page import Proof, proof_of, render_page, with_table
from protogen.model.protocol import Protocol
from protogen.targets.c.fuzz_driver.driver import driver_of

EVERY_SCHEMA = pytest.mark.parametrize("name", library_names())
LEAST = 4
"""Samples of each message at least, if it has so many."""


@EVERY_SCHEMA
def test_a_schema_of_the_library_has_no_problems_and_says_where_its_facts_are_from(
    name: str,
) -> None:
    file = library_file(name)
    assert file is not None
    compilation = compile_file(file, examples=True)
    assert [str(problem) for problem in compilation.problems] == []
    protocol = compilation.protocol
    assert protocol is not None
    assert protocol.name == name
    assert protocol.source is not None
    assert any(message.examples for message in protocol.messages)


@EVERY_SCHEMA
def test_a_project_extends_it_from_any_folder(name: str, tmp_path: Path) -> None:
    file = tmp_path / "mine.yaml"
    result = run("init", "mine", "--from", f"library:{name}", "--output", str(file))
    assert result.exit_code == 0, result.stderr
    compilation = compile_file(file)
    assert [str(problem) for problem in compilation.problems] == []
    assert compilation.protocol is not None
    assert compilation.protocol.name == "mine"


def test_a_schema_that_is_not_there_is_a_problem_with_its_place(tmp_path: Path) -> None:
    file = tmp_path / "mine.yaml"
    file.write_text("protocol: mine\nextends: library:vsec\n")
    (problem,) = compile_file(file).problems
    assert (problem.code, problem.hint) == ("PG022", "did you mean `vesc`?")
    assert problem.span is not None
    assert problem.span.line == 2
    result = run("init", "--from", "library:vsec")
    assert result.exit_code == 2
    assert "the library has no schema `vsec`" in result.stderr
    assert "did you mean `vesc`?" in result.stderr


def test_a_base_and_a_framing_exclude_each_other() -> None:
    result = run("init", "--from", "library:vesc", "--framing", "cobs")
    assert result.exit_code == 2
    assert "--from and --framing exclude each other" in result.stderr


def test_the_folder_of_schemas_shows_the_library() -> None:
    assert (ROOT / "schemas" / "library").resolve() == FOLDER


@EVERY_SCHEMA
def test_it_is_laid_out_as_fmt_does(name: str) -> None:
    result = run("fmt", "--check", str(library_file(name)))
    assert result.exit_code == 0, result.stdout


@EVERY_SCHEMA
def test_all_engines_take_every_message_there_and_back(name: str) -> None:
    """As `protogen fuzz` does, on fewer samples where a schema has hundreds of messages.

    All boundaries go through the reference where it is compared with a peer.
    """
    path = FOLDER / f"{name}.yaml"
    protocol, module = protocol_of(path), module_at(path)
    reference = PythonEngine(module.PROTOCOL)
    compiled = CEngine(driver_of(protocol), require_compiler("cc"))
    engines = [reference, PythonEngine(module.PROTOCOL, module.encode), compiled]
    taken = set()
    for case in spread_cases(protocol):
        outcomes = try_engines(engines, protocol, case)
        assert [outcome.problem for outcome in outcomes] == [""] * 3, case
        if all(outcome.frame for outcome in outcomes):
            taken.add((case.sender, case.message))
    assert taken == {(it.name, message.name) for it in protocol.senders for message in it.messages}


def spread_cases(protocol: Protocol) -> Iterator[Case]:
    """Yield some `LIBRARY_SAMPLES`: of each message as many, from the first to the last."""
    pairs = [(sender, message) for sender in protocol.senders for message in sender.messages]
    most = max(LEAST, LIBRARY_SAMPLES // len(pairs))
    for sender, message in pairs:
        dice = Random(f"{sender.name} {message.name}")
        found = [*samples_at_least(min(10, most), message, sender.frame, dice)]
        count = min(most, len(found))
        for index in range(count):
            place = index * (len(found) - 1) // max(1, count - 1)
            yield Case(sender.name, message.name, *found[place])


@EVERY_SCHEMA
def test_it_is_compared_with_a_peer(name: str) -> None:
    test = (ROOT / "tests" / f"test_library_{name}.py").read_text("utf-8")
    package = proof_of(name).peer.partition(" ")[0]
    assert f'"{package.replace("-", "_")}' in test
    assert {"compare_frames", "compare_recovery"} <= set(re.findall(r"\w+", test))


def test_the_page_and_the_table_of_the_readme_are_current() -> None:
    page = (ROOT / "docs" / "reference" / "library.md").read_text("utf-8")
    assert page == render_page(), "run `make generate`"
    readme = (ROOT / "README.md").read_text("utf-8")
    assert readme == with_table(readme), "run `make generate`"
    assert all(f"`{name}`" in readme for name in library_names())


def test_what_is_not_said_makes_a_schema_one_that_is_said_in_part(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr(page, "library_names", lambda: ["ibus", "kiss"])
    monkeypatch.setattr(page, "proof_of", lambda _: Proof("peer 1", "All.", ["Running status."]))
    readme = page.with_table("<!-- library -->\n<!-- end of library -->")
    assert "0 of 2 are said completely:" in readme
    assert "| in part | `ibus`, `kiss` |" in readme
    assert "| peer 1 | in part |" in page.render_page()
    assert "Not said:\n\n* Running status." in page.render_page()
