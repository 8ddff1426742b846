"""Marked blocks in hand-written Markdown."""

from __future__ import annotations

import os
import re
from pathlib import Path

import pytest
from cli_support import ROOT, SINK, compiled, run, start
from hypothesis import given
from hypothesis import strategies as st

from protogen.problems import Problems, SourceMap, Span
from protogen.project.blocks import Page, fill_page, write_page
from protogen.project.contents import fill_pages
from protogen.targets.markdown.pages.sections import moved, section_names, sections

END = "<!-- /protogen -->"
_PLACE = re.compile(r"\bA \d+:\d+")


@pytest.fixture
def page(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.chdir(tmp_path)
    return Path("notes.md")


def fill(page: Path, text: str) -> tuple[str, list[str]]:
    """Fill each block with its own name in capitals; return the text, and what is reported."""
    page.write_bytes(text.encode())
    problems = Problems()

    def lookup(name: str, place: Span) -> str | None:
        return None if name == "unknown" else f"{name.upper()} {place.line}:{place.column}"

    filled = fill_page(page, lookup, problems, SourceMap())
    assert filled is not None
    assert filled.old == text.encode()
    found = [f"{item.span}: {item.code}: {item.message}" for item in problems]
    return filled.new.decode(), found


class TestFill:
    def test_between_the_marks_only(self, page: Path) -> None:
        text = f"a  \n\n<!-- protogen:a.b -->\nold\n\n{END}\nrest\t<b>"
        expected = f"a  \n\n<!-- protogen:a.b -->\n\nA.B 3:15\n\n{END}\nrest\t<b>"
        assert fill(page, text) == (expected, [])
        assert fill(page, expected) == (expected, [])

    def test_several_blocks(self, page: Path) -> None:
        text = f"<!-- protogen:a -->\n{END}\nx\n  <!--protogen: b-->\n{END}\n"
        assert fill(page, text)[0] == (
            f"<!-- protogen:a -->\n\nA 1:15\n\n{END}\nx\n  <!--protogen: b-->\n\nB 4:17\n\n{END}\n"
        )

    def test_line_ends_are_those_of_the_mark(self, page: Path) -> None:
        text = f"\ufeffx\r\n<!-- protogen:a -->\r\nold\r\n{END}"
        assert fill(page, text)[0] == (f"\ufeffx\r\n<!-- protogen:a -->\r\n\r\nA 2:15\r\n\r\n{END}")

    @pytest.mark.parametrize(
        "text",
        [
            f"```\n<!-- protogen:a -->\n{END}\n```\n",
            f"~~~~ text\n<!-- protogen:a -->\n```\n~~~\n{END}\n~~~~\n",
            f"    <!-- protogen:a -->\n    {END}\n",
            f"see `<!-- protogen:a -->` and\n`{END}`\n",
            "",
        ],
        ids=["fence", "longer fence", "indented", "in a line", "empty"],
    )
    def test_marks_in_code_are_text(self, text: str, page: Path) -> None:
        assert fill(page, text) == (text, [])

    def test_marks_without_a_counterpart(self, page: Path) -> None:
        text = (
            f"{END}\n\n<!-- protogen:a -->\nkept\n<!-- protogen:b -->\n{END}\n <!-- protogen:c -->"
        )
        new, found = fill(page, text)
        assert "kept\n" in new
        assert found == [
            "notes.md:1:1: PG035: here a block ends, but none has begun",
            "notes.md:3:1: PG035: the block `a` has no end",
            "notes.md:7:2: PG035: the block `c` has no end",
        ]

    def test_what_is_unknown_stays(self, page: Path) -> None:
        text = f"<!-- protogen:unknown -->\nold\n{END}\n"
        assert fill(page, text) == (text, [])

    @given(st.lists(st.sampled_from([*"ab`~ \n\r<", "<!-- protogen:a -->\n", f"{END}\n", "```"])))
    def test_the_rest_of_any_text_stays(self, pieces: list[str]) -> None:
        text = "".join(pieces)
        path = Path(os.environ.get("TMPDIR", "/tmp")) / f"protogen-blocks-{os.getpid()}.md"
        try:
            new, _ = fill(path, text)
            assert _PLACE.sub("A", fill(path, new)[0]) == _PLACE.sub("A", new)
            if "<!-- protogen:a -->" not in text:
                assert new == text
        finally:
            path.unlink(missing_ok=True)

    def test_a_file_that_is_no_text(self, page: Path) -> None:
        page.write_bytes(b"\xff")
        problems = Problems()
        assert fill_page(page, lambda name, place: None, problems, SourceMap()) is None
        assert [problem.code for problem in problems] == ["PG033"]


class TestWrite:
    def test_keeps_permissions_and_links(self, page: Path) -> None:
        page.write_text("old")
        page.chmod(0o640)
        link = Path("link.md")
        link.symlink_to(page)
        write_page(Page(link, b"old", b"new"))
        assert link.is_symlink()
        assert (page.read_text(), page.stat().st_mode & 0o777) == ("new", 0o640)
        assert sorted(path.name for path in Path().iterdir()) == ["link.md", "notes.md"]


# --- what they are filled with --------------------------------------------------------------------


class TestSections:
    def test_every_message_and_every_part_of_the_page(self) -> None:
        protocol = compiled(SINK)
        names = section_names(protocol, sections(protocol))
        messages = {name for name in names if "." in name}
        assert messages == {"sink.numbers", "sink.lists", "sink.choice", "sink.empty"}
        assert {"sink#link", "sink#frames", "sink#messages"} <= set(names)

    def test_they_are_the_page(self) -> None:
        page = (ROOT / "generated" / "markdown" / "rn1.md").read_text()
        from protogen.compiler import compile_file

        protocol = compile_file(ROOT / "schemas" / "rn1.yaml").protocol
        assert protocol is not None
        texts = sections(protocol)
        assert all(text in page for text in texts.values())
        assert texts["message-gyro"].startswith('### <a id="message-gyro"></a>')
        assert texts["message-gyro"].count("### <a id=") == texts["message-gyro"].count("#### ") + 1
        assert "message-gyro" not in texts["link"]
        assert '<a id="message-' not in texts["messages"]
        assert all(
            f'id="decision-{item.name}"' in texts["decisions"] for item in protocol.decisions
        )

    def test_links_lead_to_the_page(self) -> None:
        text = '<a id="a"></a>[x](#a) [y](#b) [z](https://z)'
        assert moved(text, "p.md") == '<a id="a"></a>[x](#a) [y](p.md#b) [z](https://z)'
        assert moved(text, None) == '<a id="a"></a>[x](#a) y [z](https://z)'

    @pytest.mark.parametrize(
        ("name", "words", "hint"),
        [
            ("snik.lists", "there is no protocol `snik`", "did you mean `sink`?"),
            ("sink.lsits", "no section `sink.lsits`", "did you mean `sink.lists`?"),
            ("sink#farmes", "no section `sink#farmes`", "did you mean `sink#frames`?"),
            ("sink", "no section `sink`", "there are sink#link, "),
        ],
    )
    def test_unknown_names(self, name: str, words: str, hint: str, page: Path) -> None:
        page.write_text(f"\n<!-- protogen:{name} -->\n{END}\n")
        problems = Problems()
        fill_pages([page], [compiled(SINK)], None, problems, SourceMap())
        (problem,) = problems
        assert (problem.code, str(problem.span)) == ("PG034", "notes.md:2:15")
        assert words in problem.message
        assert problem.hint is not None
        assert problem.hint.startswith(hint)


class TestGenerate:
    @pytest.fixture
    def folder(self, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
        (tmp_path / "sink.yaml").write_text(SINK)
        (tmp_path / "docs").mkdir()
        (tmp_path / "docs" / "a.md").write_text(f"A\n<!-- protogen:sink.lists -->\n{END}\n")
        (tmp_path / "README.md").write_text(f"R\n<!-- protogen:sink#messages -->\n{END}\nend\n")
        (tmp_path / "protogen.toml").write_text(
            'schemas = ["sink.yaml"]\nblocks = ["README.md", "docs/*.md"]\n'
        )
        monkeypatch.chdir(tmp_path)
        return tmp_path

    def test_fills_them_in_place(self, folder: Path) -> None:
        result = start("generate", cwd=folder)
        assert result.returncode == 0
        assert result.stdout.decode().splitlines()[-2:] == ["wrote README.md", "wrote docs/a.md"]
        readme = (folder / "README.md").read_text()
        assert readme.startswith("R\n<!-- protogen:sink#messages -->\n\n## ")
        assert readme.endswith(f"\n\n{END}\nend\n")
        assert "(generated/markdown/sink.md#message-lists)" in readme
        assert "| `points[i].x` |" in (folder / "docs" / "a.md").read_text()
        assert "wrote" not in start("generate", cwd=folder).stdout.decode()

    def test_check_and_diff_see_them(self, folder: Path) -> None:
        run("generate", "-q")
        assert "files are current" in run("generate", "--check").stdout
        changed = (folder / "README.md").read_text().replace("Messages", "Massages")
        (folder / "README.md").write_text(changed)
        checked = run("generate", "--check")
        assert (checked.exit_code, checked.stdout) == (1, "README.md: stale\n")
        diff = run("generate", "--diff")
        assert diff.exit_code == 1
        assert diff.stdout.startswith("--- a/README.md\n+++ b/README.md\n")
        assert (
            '-## <a id="messages"></a>Massages\n+## <a id="messages"></a>Messages\n' in diff.stdout
        )
        assert (folder / "README.md").read_text() == changed

    def test_a_wrong_name_stops_everything(self, folder: Path) -> None:
        (folder / "docs" / "a.md").write_text(f"<!-- protogen:sink.lsits -->\n{END}\n")
        for option in ([], ["--check"], ["--diff"]):
            result = start("generate", *option, cwd=folder)
            assert result.returncode == 1
            text = result.stderr.decode()
            assert "docs/a.md:1:15: error[PG034]: `sink` has no section `sink.lsits`" in text
            assert "did you mean `sink.lists`?" in text
        assert not (folder / "generated").exists()

    def test_only_whole_runs_fill_them(self, folder: Path) -> None:
        before = (folder / "README.md").read_text()
        run("generate", "sink.yaml", "-q")
        run("generate", "--target", "markdown", "-q")
        assert (folder / "README.md").read_text() == before

    def test_without_any_target_there_are_only_blocks(self, folder: Path) -> None:
        with (folder / "protogen.toml").open("a") as stream:
            stream.write("targets = []\n")
        assert run("generate").stdout == "wrote README.md\nwrote docs/a.md\n"
        assert not (folder / "generated").exists()
        assert "](#" not in (folder / "README.md").read_text()
