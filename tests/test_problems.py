"""Problems: collecting, ordering, the catalogue, and the three ways to print them."""

from __future__ import annotations

import json
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from protogen.problems import (
    CODES,
    Code,
    Problem,
    Problems,
    Severity,
    SourceMap,
    Span,
    did_you_mean,
    hint_for,
    render_rich,
    render_text,
    to_github,
    to_json,
)
from protogen.problems.catalogue import files_of, register
from protogen.problems.docs import main as write_catalogue
from protogen.problems.docs import render_catalogue
from protogen.problems.sources import end_of, split_lines
from protogen.schema.dialects.extends import merge_bases
from protogen.schema.text.document import Document, parse_document, read_document


def sources_with(text: str, file: str = "a.yaml") -> SourceMap:
    sources = SourceMap()
    sources.add(file, text)
    return sources


def problem_at(line: int, column: int, width: int = 1, **other: object) -> Problem:
    span = Span.at("a.yaml", line, column, width)
    return Problem("PG006", Severity.ERROR, span, "twice", **other)  # type: ignore[arg-type]


class TestProblems:
    def test_come_in_order_of_place_whatever_the_order_of_reporting(self) -> None:
        problems = Problems()
        problems.add("PG006", Span.at("b.yaml", 1, 1), "last")
        problems.add("PG006", Span.at("a.yaml", 10, 1), "fourth")
        problems.add("PG006", Span.at("a.yaml", 2, 9), "third")
        problems.add("PG006", Span.at("a.yaml", 2, 3), "second")
        problems.add("PG001", None, "first")
        order = ["first", "second", "third", "fourth", "last"]
        assert [problem.message for problem in problems] == order
        first, second, *_ = problems
        assert first < second

    def test_the_same_problem_counts_once(self) -> None:
        problems = Problems()
        for _ in range(2):
            problems.add("PG006", Span.at("a.yaml", 1, 1), "twice", notes=[(None, "so")])
        assert len(problems) == 1
        problems.add("PG006", Span.at("a.yaml", 1, 1), "twice", hint="other")
        assert len(problems) == 2

    def test_a_code_without_an_entry_in_the_catalogue_is_a_bug(self) -> None:
        with pytest.raises(KeyError, match="PG000"):
            Problems().add("PG000", None, "what?")

    def test_the_severity_is_that_of_the_catalogue(self) -> None:
        problems = Problems()
        problems.add("PG004", None, "no")
        assert [problem.severity for problem in problems.errors] == [Severity.ERROR]

    def test_warnings_are_no_errors(self) -> None:
        warning = Problem("PG006", Severity.WARNING, None, "hm")
        problems = Problems([warning])
        assert list(problems) == [warning]
        assert problems.errors == []


class TestSpan:
    def test_prints_as_editors_and_compilers_write_places(self) -> None:
        assert str(Span.at("a/b.yaml", 12, 5, 3)) == "a/b.yaml:12:5"

    def test_end_is_behind_the_last_character(self) -> None:
        assert Span.at("a", 2, 3, 4) == Span("a", 2, 3, 2, 7)

    def test_of_a_file_is_its_start(self) -> None:
        assert Span.of_file("a") == Span("a", 1, 1, 1, 1)


class TestSourceMap:
    @pytest.mark.parametrize("text", ["a\nb\nc", "a\r\nb\r\nc", "a\rb\rc"])
    def test_knows_every_line_break(self, text: str) -> None:
        sources = sources_with(text)
        assert [sources.line("a.yaml", number) for number in (1, 2, 3)] == ["a", "b", "c"]

    def test_has_no_line_outside_of_the_text_or_of_an_unknown_file(self) -> None:
        sources = sources_with("a")
        assert sources.line("a.yaml", 0) is None
        assert sources.line("a.yaml", 2) is None
        assert sources.line("b.yaml", 1) is None
        assert sources.text("b.yaml") is None

    def test_a_file_that_is_added_again_has_its_new_text(self) -> None:
        sources = sources_with("old")
        assert sources.line("a.yaml", 1) == "old"
        sources.add("a.yaml", "new")
        assert sources.line("a.yaml", 1) == "new"
        assert sources.text("a.yaml") == "new"

    @given(st.text("ab\r\n"), st.integers(0, 20))
    def test_the_end_of_a_text_is_in_its_last_line(self, text: str, column: int) -> None:
        lines = split_lines(text)
        place = end_of(text)
        assert place == (len(lines), len(lines[-1]) + 1)


class TestText:
    def test_shows_place_line_caret_hint_and_notes(self) -> None:
        problem = problem_at(
            2,
            14,
            4,
            hint="did you mean `x`?",
            notes=((Span.at("a.yaml", 1, 1, 4), "first here"), (None, "so it is")),
        )
        assert render_text(problem, sources_with("link: {}\nname: {baud: baud}\n")) == (
            "a.yaml:2:14: error[PG006]: twice\n"
            "    2 | name: {baud: baud}\n"
            "      |              ^~~~\n"
            "  hint: did you mean `x`?\n"
            "  note: a.yaml:1:1: first here\n"
            "    1 | link: {}\n"
            "      | ^~~~\n"
            "  note: so it is"
        )

    def test_without_a_place_there_is_only_the_message(self) -> None:
        problem = Problem("PG001", Severity.WARNING, None, "no file")
        assert render_text(problem, SourceMap()) == "warning[PG001]: no file"

    def test_without_the_source_there_is_no_excerpt(self) -> None:
        assert render_text(problem_at(3, 1), SourceMap()) == "a.yaml:3:1: error[PG006]: twice"

    def test_a_span_of_several_lines_is_underlined_to_the_end_of_the_first(self) -> None:
        span = Span("a.yaml", 1, 4, 2, 2)
        problem = Problem("PG006", Severity.ERROR, span, "twice")
        assert render_text(problem, sources_with("ab cde\nfg")).endswith("\n      |    ^~~")

    def test_an_empty_span_has_a_caret(self) -> None:
        assert render_text(problem_at(1, 3, 0), sources_with("a:")).endswith("\n      |   ^")

    def test_wide_and_combining_characters_do_not_shift_the_caret(self) -> None:
        # Two columns for each of the ideographs, none for the combining accent.
        text = render_text(problem_at(1, 5, 2), sources_with("漢字e\u0301xy"))
        assert text.endswith("\n      |      ^~")

    def test_a_tab_takes_one_column_in_the_excerpt(self) -> None:
        text = render_text(problem_at(1, 2), sources_with("\tx"))
        assert text.endswith("    1 |  x\n      |  ^")

    def test_a_long_line_is_cut_around_the_place(self) -> None:
        line = "a" * 1000 + "BAD" + "z" * 1000
        text = render_text(problem_at(1, 1001, 3), sources_with(line))
        _, excerpt, caret = text.split("\n")
        assert len(excerpt) < 200
        assert excerpt.startswith("    1 | …aaa")
        assert excerpt.endswith("zzz…")
        assert excerpt[caret.index("^") : caret.rindex("~") + 1] == "BAD"

    def test_control_characters_do_not_reach_the_terminal(self) -> None:
        span = Span.at("\x1b]0;file\x07.yaml", 1, 1)
        problem = Problem("PG006", Severity.ERROR, span, "\x1b[31m\n", "\x9b")
        sources = sources_with("\x1b[2J\x07", span.file)
        text = render_text(problem, sources)
        assert all(character.isprintable() or character == "\n" for character in text)
        assert r"error[PG006]: \x1b[31m\n" in text

    def test_rich_shows_the_same_characters(self) -> None:
        problem = problem_at(1, 1, 4, hint="[bold]so[/bold]")
        sources = sources_with("[red]")
        rich = render_rich(problem, sources)
        assert rich.plain == render_text(problem, sources)
        assert any("red" in str(span.style) for span in rich.spans)


ANYTHING = st.text(max_size=40)
SPANS = st.none() | st.builds(
    lambda line, column, lines, width: Span("f", line, column, line + lines, column + width),
    st.integers(1, 5),
    st.integers(1, 50),
    st.integers(0, 2),
    st.integers(0, 50),
)
PROBLEMS = st.builds(
    Problem,
    st.sampled_from(sorted(CODES)),
    st.sampled_from(Severity),
    SPANS,
    ANYTHING,
    st.none() | ANYTHING,
    st.lists(st.tuples(SPANS, ANYTHING), max_size=2).map(tuple),
)


class TestForPrograms:
    def test_json_has_every_place_and_the_notes(self) -> None:
        note = (Span.at("b.yaml", 1, 2), "here")
        problem = problem_at(3, 4, 5, hint="mend it", notes=(note,))
        assert to_json([problem]) == [
            {
                "code": "PG006",
                "severity": "error",
                "file": "a.yaml",
                "line": 3,
                "column": 4,
                "end_line": 3,
                "end_column": 9,
                "message": "twice",
                "hint": "mend it",
                "notes": [
                    {
                        "file": "b.yaml",
                        "line": 1,
                        "column": 2,
                        "end_line": 1,
                        "end_column": 3,
                        "message": "here",
                    }
                ],
            }
        ]

    def test_github_shows_the_problem_at_its_line(self) -> None:
        expected = "::error file=a.yaml,line=3,col=4,title=PG006::twice%0Amend it"
        assert to_github(problem_at(3, 4, hint="mend it")) == expected

    def test_github_gets_percent_colon_and_comma_escaped(self) -> None:
        span = Span.at("a:b,c%.yaml", 1, 1)
        problem = Problem("PG006", Severity.NOTE, span, "100 %: a, b\r\n")
        assert to_github(problem) == (
            "::notice file=a%3Ab%2Cc%25.yaml,line=1,col=1,title=PG006::100 %25: a, b\\r\\n"
        )

    def test_github_needs_no_place(self) -> None:
        problem = Problem("PG001", Severity.WARNING, None, "no file")
        assert to_github(problem) == "::warning title=PG001::no file"

    @given(PROBLEMS, st.text(max_size=300))
    def test_every_problem_can_be_printed_in_every_format(
        self, problem: Problem, text: str
    ) -> None:
        sources = sources_with(text, "f")
        plain = render_text(problem, sources)
        plain.encode("utf-8")
        assert render_rich(problem, sources).plain == plain
        json.dumps(to_json([problem])).encode("ascii")
        assert "\n" not in to_github(problem)


class TestDidYouMean:
    NAMES = ("sint14", "uint7", "uint14", "float32", "bool", "crc_16", "payload")

    @pytest.mark.parametrize(
        ("word", "meant"),
        [
            ("sint41", "sint14"),  # neighbours swapped
            ("unit7", "uint7"),
            ("flot32", "float32"),  # a letter left out
            ("paylooad", "payload"),  # one too many
            ("paylaod", "payload"),
            ("Bool", "bool"),
            ("CRC-16", "crc_16"),
            ("crc16", "crc_16"),
            ("double", None),
            ("x", None),
            ("", None),
        ],
    )
    def test_finds_what_is_close_and_nothing_else(self, word: str, meant: str | None) -> None:
        assert did_you_mean(word, self.NAMES) == meant

    def test_the_closest_wins_and_the_first_of_equals(self) -> None:
        assert did_you_mean("gyros", ["gyro_xy", "gyro"]) == "gyro"
        assert did_you_mean("part_c", ["part_a", "part_b"]) == "part_a"

    def test_short_words_are_close_only_if_equal_but_for_case(self) -> None:
        assert did_you_mean("Id", ["at", "id"]) == "id"
        assert did_you_mean("it", ["at", "id"]) is None

    def test_makes_a_hint(self) -> None:
        assert hint_for("unit7", self.NAMES) == "did you mean `uint7`?"
        assert hint_for("double", self.NAMES) is None

    @given(st.text(max_size=12), st.lists(st.text(max_size=12), max_size=5))
    def test_a_suggestion_is_one_of_the_candidates(self, word: str, names: list[str]) -> None:
        assert did_you_mean(word, names) in {None, *names}

    @given(st.text(min_size=3, max_size=12), st.data())
    def test_one_slip_is_always_close(self, word: str, data: st.DataObject) -> None:
        if len(word.casefold().replace("-", "").replace("_", "").replace(" ", "")) < 4:
            return
        gap = data.draw(st.integers(0, len(word)))
        assert did_you_mean(word[:gap] + "q" + word[gap:], [word]) == word


def front_end_codes(example: str, root: Path) -> set[str]:
    """Return the codes that the document layer and `extends` report for an example."""

    (root / "protogen.toml").touch()
    files = files_of(example)
    for name, text in files.items():
        (root / name).write_text(text, encoding="utf-8")
    problems, sources = Problems(), SourceMap()
    document = read_document(root / next(iter(files)), problems, sources)
    if isinstance(document, Document):
        merge_bases(document, problems, sources)
    return {problem.code for problem in problems}


FRONT_END_CODES = [code for code in CODES.values() if code.code < "PG100"]


class TestCatalogue:
    @pytest.mark.parametrize(
        "code", [code for code in FRONT_END_CODES if code.compiles], ids=lambda code: code.code
    )
    def test_examples_show_the_problem_and_the_mend(self, code: Code, tmp_path: Path) -> None:
        assert front_end_codes(code.bad_example, tmp_path) == {code.code}
        assert front_end_codes(code.fixed_example, tmp_path) == set()

    def test_codes_have_the_documented_form(self) -> None:
        assert all(code.code == key for key, code in CODES.items())
        assert all(len(key) == 5 and key[:2] == "PG" and key[2:].isdigit() for key in CODES)
        assert list(CODES) == sorted(CODES)

    def test_a_code_or_a_name_can_be_registered_once(self) -> None:
        code = Code("PG900", "name", "Title", "Why.", "a: 1\n", "a: 2\n")
        with pytest.raises(ValueError, match="PG900"):
            register([code, Code("PG900", "other", "Title", "Why.", "", "")])
        with pytest.raises(ValueError, match="PG901"):
            register([code, Code("PG901", "name", "Title", "Why.", "", "")])

    def test_the_page_explains_every_code_with_both_examples(self) -> None:
        page = render_catalogue()
        for code in CODES.values():
            assert f"{code.code}: {code.title}" in page
            assert code.explanation.strip() in page
            assert code.bad_example.rstrip() in page
            assert code.fixed_example.rstrip() in page

    def test_the_page_fences_examples_that_hold_fences(self) -> None:
        code = Code("PG900", "name", "a | b", "Why.", "doc: ```x\n", "a: 2\n")
        page = render_catalogue([code])
        assert "````yaml\ndoc: ```x\n````\n" in page
        assert "| [PG900](#pg900) | error | a \\| b |\n" in page

    def test_the_page_is_written_as_utf_8(self, tmp_path: Path) -> None:

        page = tmp_path / "docs" / "problems.md"
        write_catalogue([str(page)])
        assert page.read_bytes().decode("utf-8") == render_catalogue()

    def test_the_checked_in_page_is_current(self, project_root: Path) -> None:
        page = project_root / "docs" / "problems.md"
        assert page.read_text(encoding="utf-8") == render_catalogue(), "run `make generate`"


def test_a_problem_of_a_text_is_printed_with_its_line() -> None:
    problems = Problems()
    text = "link: {baud: 1, baud: 2}\n"
    parse_document(text, "a.yaml", problems)
    (problem,) = problems
    assert render_text(problem, sources_with(text)) == (
        "a.yaml:1:17: error[PG006]: the key `baud` stands twice\n"
        "    1 | link: {baud: 1, baud: 2}\n"
        "      |                 ^~~~\n"
        "  note: a.yaml:1:8: it stands here first\n"
        "    1 | link: {baud: 1, baud: 2}\n"
        "      |        ^~~~"
    )
