"""A project's file: where it is found, what it says, and what is wrong with it."""

from __future__ import annotations

from pathlib import Path

import pytest
from cli_support import SINK, run, start
from hypothesis import given
from hypothesis import strategies as st

from protogen.problems import CODES, Problem, Problems, SourceMap
from protogen.problems.catalogue import files_of
from protogen.problems.catalogue.project import PROJECT_CODES
from protogen.project.find import find_project
from protogen.project.places import place_of
from protogen.project.read import Project, read_project
from protogen.targets import TARGETS


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A folder with two schemas, none of them where the defaults would look."""
    (tmp_path / "boards").mkdir()
    (tmp_path / "sink.yaml").write_text(SINK)
    other = SINK.replace("protocol: sink", "protocol: other")
    (tmp_path / "boards" / "other.yaml").write_text(other)
    monkeypatch.chdir(tmp_path)
    return tmp_path


def read(text: str, name: str = "protogen.toml") -> tuple[Project | None, list[Problem]]:
    Path(name).write_text(text, encoding="utf-8")
    problems = Problems()
    return read_project(Path(name), problems, SourceMap()), list(problems)


# --- finding it -----------------------------------------------------------------------------------


class TestFind:
    def test_above_the_working_directory(
        self, folder: Path, monkeypatch: pytest.MonkeyPatch
    ) -> None:
        (folder / "protogen.toml").touch()
        inner = folder / "a" / "b"
        inner.mkdir(parents=True)
        monkeypatch.chdir(inner)
        assert find_project() == Path("../../protogen.toml")

    def test_a_shared_file_only_with_the_table(self, folder: Path) -> None:
        shared = folder / "pyproject.toml"
        shared.write_text('[project]\nname = "x"\n')
        assert find_project(folder) is None
        shared.write_text("[tool.protogen]\n")
        assert find_project(folder) == Path("pyproject.toml")
        (folder / "protogen.toml").touch()
        assert find_project(folder) == Path("protogen.toml")

    def test_a_shared_file_that_is_broken_is_not_ours(self, folder: Path) -> None:
        (folder / "pyproject.toml").write_text("[tool.protogen\n")
        assert find_project(folder) is None


# --- reading it -----------------------------------------------------------------------------------

WHOLE = """\
schemas = ["sink.yaml", "boards/*.yaml"]
output = "made"
targets = ["python", "c"]
blocks = ["README.md"]

[python]
standalone = true

[c]
style = "single"
events = "messages"
only = ["gyro"]
sender = ["board"]
stubs = true

[breaking]
use = ["wire"]
except = ["field-renamed"]

[breaking.ignore]
message-removed = ["sink.lists"]
"""


class TestRead:
    def test_every_key(self, folder: Path) -> None:
        project, problems = read(WHOLE)
        assert problems == []
        assert project is not None
        settings = project.settings
        assert settings.schemas == ("sink.yaml", "boards/*.yaml")
        assert (settings.output, settings.targets) == ("made", ("python", "c"))
        assert (settings.blocks, settings.python.standalone) == (("README.md",), True)
        assert (settings.c.style, settings.c.events) == ("single", "messages")
        assert (settings.c.only, settings.c.sender, settings.c.stubs) == (
            ("gyro",),
            ("board",),
            True,
        )
        assert (settings.breaking.use, settings.breaking.except_) == (("wire",), ("field-renamed",))
        assert settings.breaking.ignore == {"message-removed": ("sink.lists",)}

    def test_an_empty_file_stands_for_the_defaults(self, folder: Path) -> None:
        project, _ = read("")
        assert project is not None
        assert project.settings.schemas == ("schemas",)
        assert (project.settings.output, project.settings.targets) == ("generated", None)

    @pytest.mark.parametrize(
        ("text", "place", "code", "words", "hint"),
        [
            ("a = [\n", "2:1", "PG030", "no TOML", None),
            ('\nschmas = ["a"]\n', "2:1", "PG031", "`schmas`", "did you mean `schemas`?"),
            ("zzz = 1\n", "1:1", "PG031", "`zzz`", "keys are schemas, output"),
            ("[c]\nstlye = 1\n", "2:1", "PG031", "`stlye`", "did you mean `style`?"),
            (
                "c = {stubs = true, stlye = 1}\n",
                "1:20",
                "PG031",
                "`stlye`",
                "did you mean `style`?",
            ),
            ("c.stlye = 1\n", "1:1", "PG031", "`stlye`", "did you mean `style`?"),
            ("[breaking]\nexcpet = []\n", "2:1", "PG031", "`excpet`", "did you mean `except`?"),
            ("[pyhton]\na = 1\n", "1:2", "PG031", "`pyhton`", "did you mean `python`?"),
            ('schemas = "a"\n', "1:11", "PG032", "`schemas`: this is a list of texts", None),
            ("schemas = []\n", "1:1", "PG032", "`schemas`: there is nothing in it", None),
            ("schemas = [\n  1,\n]\n", "1:1", "PG032", "`schemas`: this is a text", None),
            ("output = 1\n", "1:1", "PG032", "`output`: this is a text", None),
            ("python = 1\n", "1:1", "PG032", "`python`: this is a table", None),
            (
                '[python]\nstandalone = "yes"\n',
                "2:14",
                "PG032",
                "`python.standalone`: this is true or false",
                None,
            ),
            (
                '[c]\n  style = "singel"\n',
                "2:11",
                "PG032",
                "`c.style`: this is split or single",
                "did you mean `single`?",
            ),
            (
                'targets = [\n  "c",\n  "pyton",\n]\n',
                "3:3",
                "PG032",
                "no target `pyton`",
                "did you mean `python`?",
            ),
            ("[breaking]\nignore = {a = 1}\n", "2:11", "PG032", "`breaking.ignore.a`", None),
        ],
    )
    def test_what_is_wrong_has_a_place(
        self, text: str, place: str, code: str, words: str, hint: str | None, folder: Path
    ) -> None:
        project, (problem,) = read(text)
        assert project is None
        assert (str(problem.span), problem.code) == (f"protogen.toml:{place}", code)
        assert words in problem.message
        assert (problem.hint or "").startswith(hint or "")

    def test_in_the_shared_file(self, folder: Path) -> None:
        text = '[project]\nschmas = 1\n[tool.protogen]\nschmas = ["a"]\n[tool.protogen.c]\nx = 1\n'
        _, problems = read(text, "pyproject.toml")
        assert [str(problem.span) for problem in problems] == [
            "pyproject.toml:4:1",
            "pyproject.toml:6:1",
        ]

    def test_bytes_that_are_no_text(self, folder: Path) -> None:
        Path("protogen.toml").write_bytes(b"\xff")
        problems = Problems()
        assert read_project(Path("protogen.toml"), problems, SourceMap()) is None
        assert [problem.code for problem in problems] == ["PG030"]

    @given(st.text(), st.lists(st.text()))
    def test_a_place_is_found_in_any_text(self, text: str, loc: list[str]) -> None:
        assert place_of(text, "x", loc, "value").file == "x"


# --- the command line over it ---------------------------------------------------------------------


class TestGenerate:
    def test_a_bare_run_does_everything(self, folder: Path) -> None:
        (folder / "protogen.toml").write_text(
            'schemas = ["sink.yaml", "boards/*.yaml"]\noutput = "made"\n'
        )
        result = start("generate", cwd=folder)
        assert result.returncode == 0, result.stderr
        for target, suffix in (("python", "py"), ("c", "h"), ("markdown", "md")):
            assert (folder / "made" / target / f"sink.{suffix}").is_file()
            assert (folder / "made" / target / f"other.{suffix}").is_file()

    def test_paths_are_relative_to_the_file(self, folder: Path) -> None:
        (folder / "protogen.toml").write_text('schemas = ["sink.yaml"]\ntargets = ["python"]\n')
        result = start("generate", cwd=folder / "boards")
        assert result.stdout.decode() == (
            "wrote ../generated/python/__init__.py\n"
            "wrote ../generated/python/_sink_codec.py\n"
            "wrote ../generated/python/sink.py\n"
        )
        assert start("generate", "--check", cwd=folder).stdout == b"3 files are current\n"

    def test_the_shared_file(self, folder: Path) -> None:
        (folder / "pyproject.toml").write_text(
            '[tool.protogen]\nschemas = ["sink.yaml"]\noutput = "made"\n'
        )
        assert start("generate", "-q", cwd=folder).returncode == 0
        assert (folder / "made" / "c" / "sink.c").is_file()

    def test_options_of_targets(self, folder: Path) -> None:
        (folder / "protogen.toml").write_text(
            'schemas = ["sink.yaml"]\n[python]\nstandalone = true\n'
            '[c]\nstyle = "single"\nonly = ["lists"]\n'
        )
        assert run("generate", "-q").exit_code == 0
        assert (folder / "generated" / "python" / "sink" / "__init__.py").is_file()
        header = (folder / "generated" / "c" / "sink.h").read_text()
        assert "sink_lists" in header
        assert "sink_choice" not in header
        assert not (folder / "generated" / "c" / "sink.c").exists()

    def test_the_command_line_goes_over_it(self, folder: Path) -> None:
        (folder / "protogen.toml").write_text(
            'schemas = ["sink.yaml"]\noutput = "made"\ntargets = ["c", "python"]\n'
            "[python]\nstandalone = true\n[c]\nstubs = true\n"
        )
        options = ["--target", "python", "--no-standalone", "-o", "other"]
        assert run("generate", *options, "-q").exit_code == 0
        assert (folder / "other" / "python" / "sink.py").is_file()
        assert not (folder / "other" / "c").exists()
        assert run("generate", "--no-c-stubs", "-q").exit_code == 0
        assert not (folder / "made" / "c" / "sink_stubs.c").exists()
        assert run("generate", "-q").exit_code == 0
        assert (folder / "made" / "c" / "sink_stubs.c").is_file()

    def test_a_schema_that_is_named_leaves_the_files_of_the_others(self, folder: Path) -> None:
        (folder / "protogen.toml").write_text('schemas = ["sink.yaml", "boards"]\n')
        run("generate", "-q")
        assert "removed" not in run("generate", "sink.yaml").output
        assert "removed" not in run("generate", "boards").output
        assert (folder / "generated" / "python" / "sink.py").is_file()

    def test_it_may_be_left_alone(self, folder: Path) -> None:
        (folder / "protogen.toml").write_text("nonsense\n")
        assert run("generate", "sink.yaml", "--no-project", "-q").exit_code == 0
        assert not (folder / ".protogen_cache").exists()

    def test_nothing_to_generate_from(self, folder: Path) -> None:
        result = start("generate", cwd=folder)
        assert (result.returncode, result.stdout) == (2, b"")
        text = result.stderr.decode()
        assert "no schema is named" in text
        assert "write a protogen.toml" in text

    def test_problems_are_shown_and_nothing_is_written(self, folder: Path) -> None:
        (folder / "protogen.toml").write_text('schmas = ["sink.yaml"]\n')
        result = start("generate", cwd=folder)
        assert result.returncode == 2
        assert result.stderr.decode() == (
            "protogen.toml:1:1: error[PG031]: `schmas` is no key here\n"
            '    1 | schmas = ["sink.yaml"]\n'
            "      | ^~~~~~\n"
            "  hint: did you mean `schemas`?\n"
        )
        assert not (folder / "generated").exists()

    @pytest.mark.parametrize("key", ["schemas", "blocks"])
    @pytest.mark.parametrize("path", ["none.yaml", "none/*.yaml"])
    def test_a_path_that_leads_nowhere(self, key: str, path: str, folder: Path) -> None:
        settings = {"schemas": '"sink.yaml"', key: f'"{path}"'}
        lines = [f"{name} = [{value}]\n" for name, value in settings.items()]
        (folder / "protogen.toml").write_text("".join(lines))
        result = run("generate")
        assert result.exit_code == 2
        assert f"error[PG033]: there is nothing at `{path}`" in result.stderr

    def test_globs_pass_hidden_files_over(self, folder: Path) -> None:
        (folder / "boards" / ".hidden.yaml").write_text("nonsense")
        (folder / "protogen.toml").write_text('schemas = ["**/*.yaml"]\ntargets = ["python"]\n')
        assert run("generate", "-q").exit_code == 0
        made = {path.name for path in (folder / "generated" / "python").iterdir()}
        codecs = {"_sink_codec.py", "_other_codec.py"}
        assert made == {"__init__.py", "sink.py", "other.py"} | codecs


# --- the catalogue --------------------------------------------------------------------------------

ROVER = "protocol: rover\n" + SINK.split("\n", 1)[1].replace("  numbers:", "  drive:", 1)


class TestCatalogue:
    @pytest.mark.parametrize("code", PROJECT_CODES, ids=lambda code: code.code)
    def test_examples_show_the_problem_and_the_mend(self, code: str, folder: Path) -> None:
        (folder / "rover.yaml").write_text(ROVER)
        (folder / "readme.md").touch()
        entry = CODES[code.code]  # type: ignore[attr-defined]
        for example, expected in ((entry.bad_example, True), (entry.fixed_example, False)):
            (text,) = files_of(example).values()
            is_page = text.startswith("<!--")
            settings = 'schemas = ["rover.yaml"]\nblocks = ["readme.md"]\n' if is_page else text
            if "schemas" not in settings and "schmas" not in settings:
                settings = f'schemas = ["rover.yaml"]\n{settings}'
            (folder / "protogen.toml").write_text(settings)
            (folder / "readme.md").write_text(text if is_page else "")
            result = run("generate", "-q")
            assert (f"error[{entry.code}]" in result.stderr) == expected, result.stderr
            assert (result.exit_code != 0) == expected, result.stderr

    def test_all_targets_may_be_named(self, folder: Path) -> None:
        names = ", ".join(f'"{name}"' for name in TARGETS)
        assert read(f"targets = [{names}]\n")[1] == []
