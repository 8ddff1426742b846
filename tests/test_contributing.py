"""Every path that ARCHITECTURE.md and CONTRIBUTING.md name exists."""

from __future__ import annotations

import re

import pytest
from doc_pages import ROOT, text_of

PAGES = ("ARCHITECTURE.md", "CONTRIBUTING.md")
BASES = ("", "protogen", "tests")
"""Folders that a path may be relative to, beside the one that its row of a table is about."""

_CODE = re.compile(r"`([^`\s]+)`")
_PATH = re.compile(r"[\w.*{},/-]+(?:\.py|\.j2|\.md|\.c|\.yml|/)")
_BRACES = re.compile(r"(.*)\{([^}]*)\}(.*)")


def named_paths(page: str) -> list[tuple[str, str]]:
    """Paths in a page, each with the folder that its row of a table is about."""
    found = []
    for line in text_of(page).splitlines():
        folder = _CODE.search(line) if line.startswith("| ") else None
        for name in _CODE.findall(line):
            if _PATH.fullmatch(name):
                found += [(path, folder[1] if folder else "") for path in expanded(name)]
    return found


def expanded(name: str) -> list[str]:
    """Paths that a name with `{a,b}` in it stands for."""
    if not (braces := _BRACES.fullmatch(name)):
        return [name]
    before, choices, after = braces.groups()
    return [path for choice in choices.split(",") for path in expanded(before + choice + after)]


def exists(path: str, folder: str) -> bool:
    inside = f"**/{path.rstrip('/')}"
    return any(any((ROOT / base).glob(path.rstrip("/"))) for base in BASES) or (
        bool(folder) and any((ROOT / folder).glob(inside))
    )


@pytest.mark.parametrize("page", PAGES)
def test_every_path_exists(page: str) -> None:
    named = named_paths(page)
    assert named
    assert [path for path, folder in named if not exists(path, folder)] == []


def test_every_folder_of_the_package_has_a_row() -> None:
    folders = {path.parent.name for path in (ROOT / "protogen").glob("*/__init__.py")}
    rows = re.findall(r"^\| `protogen/(\w+)/`", text_of("ARCHITECTURE.md"), re.MULTILINE)
    assert folders == set(rows)


def test_a_path_that_is_gone_is_found() -> None:
    assert expanded("passes/{names,proofs}/") == ["passes/names/", "passes/proofs/"]
    assert exists("machine.py", "protogen/runtime/")
    assert not exists("no_such_module.py", "protogen/runtime/")
