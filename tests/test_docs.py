"""Pages show what happens: every code block in them is run (see `doc_runner`)."""

from __future__ import annotations

import re
import shutil
import sys
from itertools import pairwise
from pathlib import Path

import pytest
from cli_support import start
from doc_pages import (
    FILES,
    ROOT,
    Block,
    Page,
    blocks,
    definitions,
    fragments,
    modelines,
    named_schemas,
    pages,
    says_what_it_is,
    text_of,
)
from doc_runner import Runner
from tooling import require_module

from protogen.cli import _MODULES
from protogen.compiler import compile_file
from protogen.targets import TARGETS

LANGUAGES = {
    "yaml",
    "python",
    "text",
    "console",
    "sh",
    "c",
    "cpp",
    "javascript",
    "typescript",
    *FILES,
}
RUN = LANGUAGES - {"yaml", "sh"}
FAULTY = {"wrong.yaml", "rover_seen.yaml", "sensor_guess.yaml"}
"""Schemas that show what a problem looks like."""


@pytest.fixture(scope="module")
def prepared(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder with the schemas of the project and of all pages, and some generated code."""
    folder = tmp_path_factory.mktemp("documents")
    # Else the library, to which a link leads, would be compiled, and copied for each page.
    without = shutil.ignore_patterns("library")
    shutil.copytree(ROOT / "schemas", folder / "schemas", ignore=without)
    for name, text in {**named_schemas(), **definitions()}.items():
        (folder / name).parent.mkdir(exist_ok=True)
        (folder / name).write_text(text, encoding="utf-8")
    program = folder / "bin" / "protogen"
    program.parent.mkdir()
    program.write_text(f'#!/bin/sh\nexec "{sys.executable}" -m protogen "$@"\n')
    program.chmod(0o755)
    schemas = ("schemas", "rover.yaml", "rover_hello.yaml", "sensor.yaml")
    targets = [word for target in TARGETS for word in ("--target", target)]
    made = start("generate", *schemas, "--quiet", *targets, cwd=folder)
    assert made.returncode == 0, made.stderr.decode()
    return folder


@pytest.mark.parametrize("page", [page for page in pages() if page.languages & RUN], ids=str)
def test_page_does_what_it_shows(page: Page, prepared: Path, tmp_path: Path) -> None:
    workspace = shutil.copytree(prepared, tmp_path / "workspace")
    if page.generates:
        shutil.rmtree(workspace / "generated")
    with Runner(workspace) as runner:
        runner.run(page)


class TestSchemas:
    @pytest.mark.parametrize("name", sorted(named_schemas()))
    def test_compiles(self, name: str, prepared: Path) -> None:
        compilation = compile_file(prepared / name, examples=True)
        assert bool(compilation.problems) == (name in FAULTY), compilation.problems

    @pytest.mark.parametrize("name", sorted(fragments()))
    def test_frame_compiles_in_the_place_of_the_first_one(self, name: str, tmp_path: Path) -> None:
        first = named_schemas()["rover.yaml"]
        begin, end = first.index("frame:"), first.index("messages:")
        schema = tmp_path / "rover.yaml"
        schema.write_text(f"{first[:begin]}{fragments()[name]}\n{first[end:]}")
        compilation = compile_file(schema, examples=True)
        assert compilation.problems == ()

    def test_every_block_says_what_it_is(self) -> None:
        for block in blocks("yaml"):
            assert says_what_it_is(block), block.text

    def test_modelines_name_a_file(self) -> None:
        assert modelines()
        assert all((ROOT / name).is_file() for name in modelines())


class TestMake:
    def test_targets_exist(self) -> None:
        targets = set(re.findall(r"^([\w-]+):", text_of("Makefile"), re.MULTILINE))
        lines = "".join(block.text for block in blocks("sh")).splitlines()
        assert {"make generate", "make test"} <= {line.split("  ")[0] for line in lines}
        known = {"make": targets, "protogen": set(_MODULES)}  # Commands that only Ctrl-C ends.
        for line in lines:
            program, target = line.split()[:2]
            assert target in known[program] if program in known else program == "python"
            assert program != "python" or (ROOT / target).is_file()


class TestPages:
    @pytest.mark.parametrize("page", pages(), ids=str)
    def test_no_block_escapes_these_tests(self, page: Page) -> None:
        assert page.languages <= LANGUAGES
        assert page.fences == 2 * len(page.blocks)
        for former, block in pairwise([Block("", ""), *page.blocks]):
            speaks = former.language in ("python", "javascript")
            assert block.language != "text" or speaks, block.text

    @pytest.mark.parametrize("page", [page for page in pages() if page.excerpts], ids=str)
    def test_excerpts_stand_in_generated_files(self, page: Page, prepared: Path) -> None:
        for name, excerpt in page.excerpts:
            assert excerpt in (prepared / name).read_text(encoding="utf-8")

    @pytest.mark.parametrize("page", pages(), ids=str)
    def test_links_lead_to_files(self, page: Page) -> None:
        paths = [link.split("#")[0] for link in page.links if not link.startswith(("https:", "#"))]
        places = [(ROOT / page.path).parent / path for path in paths]
        missing = [str(place) for place in places if not (place.exists() or _in_site(place))]
        assert missing == []

    def test_names_the_distribution_the_command_and_the_licence(self) -> None:
        project = text_of("pyproject.toml")
        readme = text_of("README.md")
        assert 'name = "protogen-serial"' in project
        assert "`protogen-serial`" in readme
        assert 'license = "Apache-2.0"' in project
        assert "Apache-2.0" in readme

    def test_the_readme_is_short(self) -> None:
        assert len(text_of("README.md").splitlines()) <= 250


def _in_site(place: Path) -> bool:
    """True for a page of a protocol, which `make docs` puts into the site."""
    is_copied = place.parent.resolve() == ROOT / "docs" / "pages"
    return is_copied and (ROOT / "generated" / "html" / place.name).exists()


class TestSite:
    def test_builds_with_no_link_that_leads_nowhere(self, tmp_path: Path) -> None:
        require_module("zensical")
        for name in ("mkdocs.yml", "docs"):
            copy = shutil.copytree if (ROOT / name).is_dir() else shutil.copy
            copy(ROOT / name, tmp_path / name)
        with Runner(tmp_path) as runner:
            runner.succeed(sys.executable, "-m", "zensical", "build", "--strict")
        assert (tmp_path / ".cache" / "site" / "index.html").is_file()

    def test_has_every_page_in_its_table_of_contents(self) -> None:
        listed = set(re.findall(r"[\w/-]+\.md", text_of("mkdocs.yml")))
        found = {str(path.relative_to(ROOT / "docs")) for path in (ROOT / "docs").rglob("*.md")}
        assert listed == found

    def test_links_to_every_page_of_our_protocols(self) -> None:
        """`make docs` puts these beside the site's own, which has no such links otherwise."""
        linked = set(re.findall(r"\(\.\./pages/([\w.]+)\)", text_of("docs/reference/pages.md")))
        assert linked == {path.name for path in (ROOT / "generated" / "html").iterdir()}
        assert "cp -R generated/html $(CACHE)/site/pages" in text_of("Makefile")
