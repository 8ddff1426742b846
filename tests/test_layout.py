"""The canonical layout: what it is, and that it changes nothing else."""

from __future__ import annotations

import re
from pathlib import Path
from textwrap import dedent

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from schema_fuzzing import Schema, schemas
from schema_fuzzing.text import to_styled_yaml

from protogen.layout import reading
from protogen.layout.formatting import format_text
from protogen.layout.meaning import same_meaning
from protogen.layout.printer import WIDTH
from protogen.problems import Problems
from protogen.schema.text.compose import FAST_LOADER, PURE_LOADER, Loader
from protogen.schema.text.document import parse_document
from protogen.schema.text.nodes import to_data

ROOT = Path(__file__).resolve().parent.parent
FILES = sorted(
    path
    for folder in ("schemas", "tests/framings", "tests/c_schemas", "benchmarks")
    for path in (ROOT / folder).rglob("*.yaml")
)
STYLES = st.integers(0, 2**32)
_REMARK = re.compile(r"# (?:a remark: .*|why|x: y)$", re.MULTILINE)


def laid_out(text: str) -> str:
    """The text in its layout, which is then not changed again."""
    once = format_text(dedent(text))
    assert format_text(once) == once
    return once


def data_of(text: str) -> object:
    problems = Problems()
    document = parse_document(text, "a.yaml", problems)
    assert document is not None, list(problems)
    return to_data(document.root)


class TestEverySchema:
    @pytest.mark.parametrize("path", FILES, ids=lambda path: path.stem)
    def test_keeps_its_meaning_and_its_comments(self, path: Path) -> None:
        text = path.read_text(encoding="utf-8")
        after = laid_out(text)
        assert same_meaning(path, text, after)
        assert sorted(comments(after)) == sorted(comments(text))

    @settings(max_examples=60)
    @given(schemas(), STYLES)
    def test_keeps_the_meaning_in_any_style(
        self, tmp_path_factory: pytest.TempPathFactory, schema: Schema, style: int
    ) -> None:
        path = tmp_path_factory.getbasetemp() / "drawn.yaml"
        text = to_styled_yaml(schema.data, style)
        after = laid_out(text)
        assert data_of(after) == schema.data
        assert same_meaning(path, text, after)
        assert sorted(_REMARK.findall(after)) == sorted(_REMARK.findall(text))


def comments(text: str) -> list[str]:
    """The comments of a text in which no value holds ` #`."""
    return [found.strip() for found in re.findall(r"(?<!\S)# .*$", text, re.MULTILINE)]


class TestKeys:
    def test_stand_in_the_documented_order(self) -> None:
        text = laid_out("""\
            title: T
            messages:
              b:
                fields:
                  x: {unit: mm, type: uint8}
                  a: uint8
                from: pc
                id: 1
            protocol: p
            """)
        assert text == dedent("""\
            protocol: p
            title: T
            messages:
              b:
                id: 1
                from: pc
                fields:
                  x: {type: uint8, unit: mm}
                  a: uint8
            """)

    def test_names_keep_their_places_also_where_they_look_like_keys(self) -> None:
        text = "frame:\n  type: {type: uint8}\n  literal: {literal: 0}\n  payload: {}\n"
        assert laid_out(text) == text

    def test_a_frame_for_each_sender_is_known(self) -> None:
        text = "frame:\n  pc:\n    crc: {covers: payload, algorithm: xor-8, type: uint8}\n"
        assert "crc: {type: uint8, algorithm: xor-8, covers: payload}" in laid_out(text)

    def test_directives_of_a_dialect_stand_first(self) -> None:
        text = "protocol: p\nextends: b.yaml\nmessages:\n  m: {id: 1, after: k}\n"
        assert "m: {after: k, id: 1}" in laid_out(text)

    def test_an_alias_stays_behind_its_anchor(self) -> None:
        text = "messages:\n  m:\n    source: &s 1\n    id: 1\n    doc: *s\n"
        assert laid_out(text) == text


class TestComments:
    def test_move_with_what_they_belong_to(self) -> None:
        text = laid_out("""\
            # yaml-language-server: $schema=x.json
            # About the file.
            title: T  # beside the title

            # above the protocol
            protocol: p
            """)
        assert text == dedent("""\
            # yaml-language-server: $schema=x.json
            # About the file.

            # above the protocol
            protocol: p
            title: T  # beside the title
            """)

    def test_inside_brackets_open_them(self) -> None:
        text = laid_out("""\
            values: {  # all of them
              a: 1,    # the first
              # in front of b
              b: 2 }   # the last
            """)
        for remark in ("# all of them", "# the first", "# in front of b", "# the last"):
            assert remark in text
        assert "  # in front of b\n  b: 2" in text
        assert "  a: 1,".rstrip(",") in text

    def test_at_the_foot_stay_at_their_depth(self) -> None:
        text = "a:\n  b:\n    c: 1\n    # of c\n  # of b\n# of a\nd: 1\n# the end\n"
        assert laid_out(text) == text

    def test_between_a_dash_and_its_first_key_go_in_front(self) -> None:
        text = laid_out("steps:\n- # one\n  # two\n  message: m  # three\n  doc: D\n# four\n")
        assert text == "steps:\n  # one\n  # two\n  - message: m  # three\n    doc: D\n# four\n"

    def test_between_a_key_and_its_value(self) -> None:
        text = laid_out("a:\n  # first\n  b: 1\nc:\n  # second\n  word\nd: >-  # third\n  x\n")
        assert text == "a:\n  # first\n  b: 1\n# second\nc: word\nd: >-  # third\n  x\n"

    def test_a_hash_in_a_text_is_none(self) -> None:
        text = 'a: "x # y"\nb: x#y\nc: |\n  # no comment\nd: \'"#\'\n'
        assert laid_out(text) == text

    def test_keep_their_column_where_they_can(self) -> None:
        text = "a: 1        # one\nlonger: 2   # two\nc: 3 # three\n"
        assert laid_out(text) == text.replace("3 #", "3  #")


class TestLines:
    def test_too_long_between_brackets_becomes_a_block(self) -> None:
        doc = "word " * 16 + "word"
        text = laid_out(f"types: {{a: {{type: uint8, doc: {doc}}}}}\n")
        assert text == f"types:\n  a:\n    type: uint8\n    doc: {doc}\n"

    def test_too_long_text_is_folded(self) -> None:
        text = laid_out("doc: " + "word " * 40 + "end\n")
        assert text.startswith("doc: >-\n  word word")
        assert max(map(len, text.splitlines())) <= WIDTH

    def test_too_long_list_is_filled(self) -> None:
        text = laid_out("default: [" + ", ".join(map(str, range(100))) + "]\n")
        assert text.startswith("default:\n  [0, 1,")
        assert max(map(len, text.splitlines())) <= WIDTH

    def test_a_block_stays_a_block(self) -> None:
        text = "a:\n  b: 1\n"
        assert laid_out(text) == text

    def test_blank_lines_are_single(self) -> None:
        assert laid_out("\n\na: 1\n\n\n\nb:\n\n  c: 1\n\n") == "a: 1\n\nb:\n  c: 1\n"

    def test_columns_stay_lined_up_and_stray_spaces_go(self) -> None:
        table = "a:     {b: 1}\nlonger: x\n"
        assert laid_out(table.replace("longer: ", "longer:    ").replace("a:     ", "a:         "))
        assert laid_out("frame:\n  a:    {literal: 1}\n  bcd:  {literal: 2}\n") == (
            "frame:\n  a:   {literal: 1}\n  bcd: {literal: 2}\n"
        )
        assert laid_out("frame:\n  a:   {literal: 1}\n  bcd:  {literal: 2}\n") == (
            "frame:\n  a: {literal: 1}\n  bcd: {literal: 2}\n"
        )

    def test_line_breaks_stay_of_their_kind(self) -> None:
        assert format_text("\ufeffa:   1\r\nb: 2\r\n") == "a: 1\r\nb: 2\r\n"


class TestScalars:
    @pytest.mark.parametrize(
        ("written", "laid"),
        [
            ("0x1F", "0x1F"),
            ("010", "010"),
            ("'%'", '"%"'),
            ('"on"', '"on"'),
            ("'a\"b'", "'a\"b'"),
            (r'"\r\n\x41"', r'"\r\n\x41"'),
            ('"a\n  b"', '"a b"'),
            ("a\n  b", "a b"),
            ("a\n\n  b", r'"a\nb"'),
            ("|+\n  a\n", r'"a\n\n"'),
            ("|2\n   a\n", r'" a\n"'),
            ("|\n      a\n       b\n", "|\n  a\n   b"),
            (">-\n  a\n  b\n", ">-\n  a\n  b"),
            ("&x [1,2]", "&x [1, 2]"),
            ("{a: , b}", "{a: null, b: null}"),
            ("", ""),
            ('"\\U0001F600 \\u00A0"', '"\\U0001F600 \\u00A0"'),
        ],
    )
    def test_are_written(self, written: str, laid: str) -> None:
        text = format_text(f"key: {written}\n")
        assert text == f"key: {laid}\n".replace(": \n", ":\n")
        assert format_text(text) == text
        assert data_of(text) == data_of(f"key: {written}\n")

    def test_sequences_and_nested_lists(self) -> None:
        text = laid_out("a:\n-  - 1\n   - {b: 1}\n-\n    c: 1\n    d: 2\n- &e\n  f: 1\n- *e\n")
        assert text == ("a:\n  - - 1\n    - {b: 1}\n  - c: 1\n    d: 2\n  - &e\n    f: 1\n  - *e\n")


ODD = [
    "# a\n---\n# b\nprotocol: x\n...\n# end\n",
    "%YAML 1.2\n---\na: 1\n",
    "--- # c\na: 1\n",
    "? a\n: b\n? c # r\n: # s\n  d: 1\n",
    "&k a: 1\nb: *k\n*k : 2\n",
    "{a: 1, # x\n b: [1, # y\n 2]} # z\n",
    "a:\n  - # x\n    # y\n    b: {c: 1, # z\n     d: 2} # w\n    e: 1\n",
    "a: [] # x\nb: {} # y\nc: {\n  # only\n}\nd: [\n# o\n]\n",
    "a:\n- 1\n# x\n- 2\n# y\nb: 1\n",
    "a: &x # c\n  b: 1\nc: *x # d\n",
    'a: "x\\\n   y"\n',
    "a:\n    # 1\n  # 2\n    b: 1\n      # 3\n",
]


@pytest.mark.parametrize("loader", [FAST_LOADER, PURE_LOADER], ids=["fast", "pure"])
@pytest.mark.parametrize("text", ODD)
def test_odd_texts_keep_data_and_comments_with_both_parsers(
    text: str, loader: Loader, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(reading, "FAST_LOADER", loader)
    after = laid_out(text)
    assert data_of(after) == data_of(text)
    assert sorted(comments(after)) == sorted(comments(text))
