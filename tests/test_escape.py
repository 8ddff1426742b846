"""Text from a schema stays where a target puts it, and still reads as what was written."""

from __future__ import annotations

import ast
import io
import subprocess
import tokenize

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from markdown_it import MarkdownIt
from markdown_it.token import Token

from protogen.targets.escape import (
    c_comment,
    html_comment,
    markdown,
    one_line,
    paragraphs,
    python_comment,
    python_docstring,
    visible,
)

MARKUP = st.sampled_from(
    [
        *"\\`*_[](){}<>#+-=.!|~$&:\"'@^1a \t\n\r\u2028\x00\x1b\u202e\ud800",
        *("&lt;", "&#60;", "```", "1. ", "http://a.b", "<b>", "[a](b)", "![a](b)", "| a |"),
        *(" #", "---", "    ", "\n\n", "<!--"),
    ]
)
QUOTES = st.sampled_from(['"', "\\", "a", "\n", " ", "#", '"""', "\r", "\x0c", "\u2028", "\x85"])
COMMENTS = st.sampled_from([*"*/?\\ \na->!<", "*/", "/*", "//", "??/", "-->", "--!>", "<!--"])


def texts(marks: st.SearchStrategy[str]) -> st.SearchStrategy[str]:
    """Any text, and texts of little but marks."""
    return st.one_of(st.text(), st.lists(marks, max_size=8).map("".join))


TEXT = texts(MARKUP)
THOROUGH = settings(max_examples=500, deadline=None)
GFM = MarkdownIt("commonmark").enable(["table", "strikethrough"])


def inline(tokens: list[Token]) -> list[Token]:
    return [child for token in tokens for child in token.children or []]


def plain(tokens: list[Token]) -> str:
    """Text that was written, from inline tokens; fails on anything but text and names as code."""
    assert {token.type for token in tokens} <= {"text", "code_inline"}, tokens
    return "".join(
        token.content if token.type == "text" else f"`{token.content}`" for token in tokens
    )


@THOROUGH
@given(TEXT)
def test_markdown_paragraph_reads_as_the_text(text):
    tokens = GFM.parse(f"before\n\n{markdown(text)}\n\nafter\n")
    blocks = [token.type for token in tokens if token.level == 0]
    count = 3 if one_line(text) else 2
    assert blocks == ["paragraph_open", "paragraph_close"] * count
    assert plain(inline(tokens)) == f"before{one_line(text)}after"


@THOROUGH
@given(TEXT, TEXT)
def test_markdown_stays_in_its_table_cell(left, right):
    page = f"| a | b |\n| --- | --- |\n| {markdown(left)} | {markdown(right)} |\n"
    tokens = GFM.parse(page)
    assert [token.type for token in tokens if token.level == 0] == ["table_open", "table_close"]
    cells = [token for token in tokens if token.type == "inline"]
    assert [plain(cell.children or []) for cell in cells] == [
        "a",
        "b",
        one_line(left),
        one_line(right),
    ]


@THOROUGH
@given(TEXT.filter(str.strip))
def test_markdown_heading_and_list_item_read_as_the_text(text):
    for mark, block in (("### ", "heading"), ("- ", "bullet_list")):
        tokens = GFM.parse(f"{mark}{markdown(text)}\n")
        top = [token.type for token in tokens if token.level == 0]
        assert top == [f"{block}_open", f"{block}_close"]
        assert plain(inline(tokens)) == one_line(text)


def test_markdown_leaves_names_and_plain_prose_alone():
    text = "int_x, 0.01 V - as of 2.4 (see a_b); 5 + 3 = 8: yes!"
    assert markdown(text) == text


def test_markdown_prints_names_between_backticks_as_code():
    assert markdown("see `int_x`") == "see `int_x`"
    assert markdown("`a b` ``c`` `d") == r"\`a b\` \`\`c\`\` \`d"


def test_markdown_keeps_dollars_from_becoming_mathematics():
    assert markdown("$GPGGA, not $GPRMC") == r"\$GPGGA, not \$GPRMC"


@THOROUGH
@given(texts(QUOTES))
def test_python_comment_is_one_comment(text):
    code = f"# {python_comment(text)}\nx = 1\n"
    tokens = [token.type for token in tokenize.generate_tokens(io.StringIO(code).readline)]
    assert tokens[:3] == [tokenize.COMMENT, tokenize.NL, tokenize.NAME]
    assert len(code.splitlines()) == 2


@THOROUGH
@given(texts(QUOTES))
def test_python_docstring_reads_back_as_the_visible_text(text):
    inside = python_docstring(text)
    shown = "\n".join(visible(line.expandtabs().rstrip()) for line in text.splitlines())
    for before, after in (("", ""), ("", "\n"), ("First.\n\n", "\n")):
        code = f'"""{before}{inside}{after}"""'
        assert ast.literal_eval(code) == f"{before}{shown}{after}"


def test_python_docstring_keeps_lines():
    assert python_docstring('a\r\n\tb "c"') == 'a\n        b "c\\"'


@THOROUGH
@given(texts(COMMENTS))
def test_html_comment_stays_closed(text):
    page = f"<!-- {html_comment(text)} -->\n"
    inside = page.removeprefix("<!--").removesuffix("-->\n")
    assert "--" not in inside
    assert not inside.startswith((">", "->"))
    assert len(page.splitlines()) == 1


def without_comments(code: str) -> str:
    """C after phases 1 to 3 of translation, as the standard has them."""
    code = code.replace("??/", "\\").replace("\\\n", "")
    kept, rest = "", code
    while "/*" in rest:
        before, rest = rest.split("/*", 1)
        kept += before
        inside, closed, rest = rest.partition("*/")
        assert closed
        assert "/*" not in inside
    return kept + rest


@THOROUGH
@given(texts(COMMENTS), st.integers(1, 10))
def test_c_comment_ends_where_it_should_however_it_is_wrapped(text, width):
    line = c_comment(text)
    wrapped = "\n".join(line[place : place + width] for place in range(0, len(line), width))
    starred = wrapped.replace("\n", "\n * ")
    assert without_comments(f"/* {line} */int x;") == "int x;"
    assert without_comments(f"/* {starred} */int x;") == "int x;"
    assert "\\" not in line
    assert "??" not in line
    assert len(line.splitlines()) <= 1


@settings(max_examples=5, deadline=None)
@given(st.lists(texts(COMMENTS), min_size=50, max_size=50))
def test_c_comments_give_no_warning_from_a_compiler(texts):
    lines = "".join(f"/* {c_comment(text)} */\n// {c_comment(text)}\n" for text in texts)
    done = subprocess.run(
        [
            "cc",
            "-std=c99",
            "-Wall",
            "-Wcomment",
            "-Wtrigraphs",
            "-Werror",
            "-fsyntax-only",
            "-xc",
            "-",
        ],
        input=f"{lines}int only_this;\n".encode(),
        capture_output=True,
        check=False,
    )
    assert done.returncode == 0, done.stderr.decode(errors="replace")


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("", ()),
        (" \n \n", ()),
        ("one\ntwo", ("one two",)),
        ("one\n\n  two\r\n \t\r\nthree\n", ("one", "two", "three")),
    ],
)
def test_paragraphs_are_parted_by_blank_lines(text, expected):
    assert paragraphs(text) == expected


def test_what_cannot_be_seen_is_shown():
    assert one_line("a\x00b\u202ec\u00a0d\ufeff") == "a\\x00b\\u202ec d\\ufeff"
    assert visible("\ud800") == "\\ud800"
    assert visible("µ 漢") == "µ 漢"
