"""Whatever an editor makes of a schema, the compiler answers with problems, never a traceback."""

from __future__ import annotations

import json
import shutil
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st

from protogen.compiler import Compilation, compile_file
from protogen.problems import Problems, SourceMap, render_text
from protogen.problems.sources import split_lines
from protogen.schema.text.document import read_document
from protogen.schema.text.nodes import to_data


def parsed(path: Path) -> Any:
    document = read_document(path, Problems(), SourceMap())
    assert document is not None
    return to_data(document.root)


SCHEMAS = Path(__file__).resolve().parent.parent / "schemas"
FILES = sorted(path.relative_to(SCHEMAS).as_posix() for path in SCHEMAS.glob("**/*.yaml"))

BASES = {
    name: parsed(SCHEMAS / name)["extends"].removeprefix("../")
    for name in FILES
    if name.startswith("dialects/")
}
"""Each dialect and the schema that it extends."""

Place = tuple[Any, Any]
"""A mapping or list, and a key or index in it."""

WILD: tuple[Any, ...] = (
    None, True, False, 0, 1, -1, 7, 8, 64, 255, 256, 300, 2**32, 2**64, -(2**63), 0.5, 1e300, "",
    " ", "fill", "payload", "id", "uint8", "uint14", "sint65", "uint0", "ascii", "bytes", "bool",
    "char", "float32", "unspecified", "1/16", "1/0", "1e999999999", "1/\u0660", "a..b", "..",
    "0..7", "7..0", "-1", "size", "invert", "slip", "cobs", "€", "\n", "x" * 70,
    "uint" + "9" * 5000, 10**398, [], [0], [None], [[]], ["a", "a"], {}, {"fill": True},
    {"hex": "1B"}, {"text": None}, {"xor": 300}, {"x": {}},
)  # fmt: skip
"""Values that some key may take, or that nobody thinks of."""

WILD_NUMBERS = (0, 1, -1, 2, 7, 8, 9, 16, 64, 127, 128, 255, 256, 1000, 2**20, 2**32, 2**64)

NAMES = ("id", "from", "type", "fields", "count", "payload", "class", "Left", "", "0", 0, -1, True)


@pytest.fixture(scope="session")
def project(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A copy of the repository's schemas, in a project of their own."""
    root = tmp_path_factory.mktemp("project")
    shutil.copytree(SCHEMAS, root / "schemas")
    (root / "protogen.toml").touch()
    return root / "schemas"


@st.composite
def mutants(draw: st.DrawFn, names: list[str] = FILES) -> tuple[str, str]:
    """A schema's file name, and its text after some edits."""
    name = draw(st.sampled_from(names))
    tree = parsed(SCHEMAS / name)
    for _ in range(draw(st.integers(1, 4))):
        edit = draw(st.sampled_from(EDITS))
        edit(draw, tree)
    return name, written(tree) + "\n"


def places(tree: Any) -> list[Place]:
    """Every key and index of the tree."""
    found: list[Place] = []
    items = tree.items() if isinstance(tree, dict) else enumerate(tree)
    for key, value in items:
        found.append((tree, key))
        if isinstance(value, dict | list):
            found.extend(places(value))
    return found


def a_place(draw: st.DrawFn, tree: Any) -> Place | None:
    """One place, at any depth with the same weight: schemas are much wider below than above."""
    found = places(tree)
    return draw(st.sampled_from(found)) if found else None


def delete(draw: st.DrawFn, tree: Any) -> None:
    if (place := a_place(draw, tree)) is not None:
        del place[0][place[1]]


def replace(draw: st.DrawFn, tree: Any) -> None:
    if (place := a_place(draw, tree)) is not None:
        place[0][place[1]] = draw(st.sampled_from(WILD))


def resemble(draw: st.DrawFn, tree: Any) -> None:
    """Put in a value of the same kind, which gets past the check of shapes."""
    alike: dict[Any, list[Place]] = {}
    for owner, key in places(tree):
        if not isinstance(owner[key], dict | list):
            alike.setdefault((key, type(owner[key])), []).append((owner, key))
    if alike:
        chosen = draw(st.sampled_from(sorted(alike, key=str)))
        owner, key = draw(st.sampled_from(alike[chosen]))
        others = [there[key] for there, _ in alike[chosen]]
        numbers = WILD_NUMBERS if isinstance(owner[key], int) else ()
        owner[key] = draw(st.sampled_from([*others, *numbers]))


def swap(draw: st.DrawFn, tree: Any) -> None:
    one, other = a_place(draw, tree), a_place(draw, tree)
    if one is None or other is None:
        return
    copies = [json.loads(json.dumps(owner[key])) for owner, key in (one, other)]
    one[0][one[1]], other[0][other[1]] = copies[1], copies[0]


def duplicate(draw: st.DrawFn, tree: Any) -> None:
    if (place := a_place(draw, tree)) is None:
        return
    owner, key = place
    if isinstance(owner, list):
        owner.append(owner[key])
    else:
        owner[f"{key}_copy"] = owner[key]


def rename(draw: st.DrawFn, tree: Any) -> None:
    if (place := a_place(draw, tree)) is None or isinstance(place[0], list):
        return
    owner, key = place
    others = [*NAMES, *owner]
    owner[draw(st.sampled_from(others))] = owner.pop(key)


Edit = Callable[[st.DrawFn, Any], None]
EDITS: tuple[Edit, ...] = (delete, replace, resemble, resemble, swap, duplicate, rename)


def written(value: Any) -> str:
    """The value in flow style, an item a line. JSON would make texts of integer keys."""
    if isinstance(value, dict):
        items = (f"{written(key)}: {written(item)}" for key, item in value.items())
        return "{" + ",\n ".join(items) + "}"
    if isinstance(value, list):
        return "[" + ",\n ".join(map(written, value)) + "]"
    text = getattr(value, "text", None)
    return text if text is not None else json.dumps(value)


def check(compiled: Compilation) -> None:
    """Each problem has a place inside of a file that was read, and can be printed."""
    assert (compiled.protocol is None) == bool(compiled.errors)
    for problem in compiled.problems:
        assert problem.span is not None, problem
        text = compiled.sources.text(problem.span.file)
        assert text is not None, problem
        lines = split_lines(text)
        assert 1 <= problem.span.line <= problem.span.end_line <= len(lines), problem
        assert 1 <= problem.span.column <= len(lines[problem.span.line - 1]) + 1, problem
        assert render_text(problem, compiled.sources)


@given(mutant=mutants())
def test_edits_of_a_valid_schema_give_problems_and_no_traceback(
    project: Path, mutant: tuple[str, str]
) -> None:
    name, text = mutant
    path = (project / name).with_name("mutant.yaml")
    path.write_text(text, encoding="utf-8")
    check(compile_file(path, examples=True))


@given(mutant=mutants(sorted(BASES.values())))
def test_edits_of_a_base_give_problems_in_its_dialect(
    project: Path, mutant: tuple[str, str]
) -> None:
    base, text = mutant
    (project / base).write_text(text, encoding="utf-8")
    try:
        for dialect in (name for name, extended in BASES.items() if extended == base):
            check(compile_file(project / dialect))
    finally:
        shutil.copy(SCHEMAS / base, project / base)


@pytest.mark.parametrize("name", FILES)
def test_a_schema_that_nobody_edited_has_no_problem(name: str) -> None:
    compiled = compile_file(SCHEMAS / name)
    assert compiled.problems == ()
    assert compiled.protocol is not None
