"""The document layer: YAML text -> nodes with their places."""

from __future__ import annotations

import math
from pathlib import Path

import pytest
import yaml
from hypothesis import example, given
from hypothesis import strategies as st

from protogen.problems import Problems, SourceMap, Span
from protogen.schema.text.compose import FAST_LOADER, PURE_LOADER, Loader
from protogen.schema.text.document import (
    GREATEST_SIZE,
    Document,
    decode_document,
    parse_document,
    read_document,
)
from protogen.schema.text.nodes import MappingNode, Node, ScalarNode, SequenceNode, to_data
from protogen.schema.text.scalars import SourceFloat, SourceInt, resolve

LOADERS = [
    pytest.param(PURE_LOADER, id="python"),
    pytest.param(FAST_LOADER, id="libyaml"),
]


@pytest.fixture(params=LOADERS)
def loader(request: pytest.FixtureRequest) -> Loader:
    chosen: Loader = request.param
    return chosen


def parsed(text: str, loader: Loader = FAST_LOADER) -> Document:
    problems = Problems()
    document = parse_document(text, "f", problems, loader=loader)
    assert list(problems) == []
    assert document is not None
    return document


def found(text: str, loader: Loader = FAST_LOADER) -> list[tuple[str, str]]:
    """Return place and code of each problem in a text."""
    problems = Problems()
    parse_document(text, "f", problems, loader=loader)
    return [
        (f"{problem.span.line}:{problem.span.column}", problem.code)
        for problem in problems
        if problem.span is not None
    ]


def data(text: str) -> object:
    return to_data(parsed(text).root)


def span(node: Node | None) -> tuple[int, int, int, int]:
    assert node is not None
    assert node.span.file == "f"
    return node.span.line, node.span.column, node.span.end_line, node.span.end_column


class TestScalars:
    """The core schema of YAML 1.2 (section 10.3.2), as editors read it."""

    @pytest.mark.parametrize("text", ["null", "Null", "NULL", "~", ""])
    def test_nothing(self, text: str) -> None:
        assert resolve(text) is None

    @pytest.mark.parametrize(
        ("text", "value"),
        [
            ("true", True),
            ("True", True),
            ("TRUE", True),
            ("false", False),
            ("False", False),
            ("FALSE", False),
        ],
    )
    def test_booleans(self, text: str, value: bool) -> None:
        assert resolve(text) is value

    @pytest.mark.parametrize(
        ("text", "value"),
        [
            ("0", 0),
            ("7", 7),
            ("-19", -19),
            ("+12", 12),
            ("010", 10),
            ("0o17", 15),
            ("0x1F", 31),
            ("0xff", 255),
            ("9" * 400, 10**400 - 1),
        ],
    )
    def test_integers(self, text: str, value: int) -> None:
        resolved = resolve(text)
        assert type(resolved) is int
        assert resolved == value

    @pytest.mark.parametrize(
        ("text", "value"),
        [
            ("0.5", 0.5),
            ("-.5", -0.5),
            ("5.", 5.0),
            ("12e03", 12000.0),
            ("-2E+05", -200000.0),
            ("1.10", 1.1),
            (".inf", math.inf),
            ("-.Inf", -math.inf),
            ("+.INF", math.inf),
        ],
    )
    def test_fractions(self, text: str, value: float) -> None:
        resolved = resolve(text)
        assert type(resolved) is float
        assert resolved == value

    @pytest.mark.parametrize("text", [".nan", ".NaN", ".NAN"])
    def test_not_a_number(self, text: str) -> None:
        resolved = resolve(text)
        assert isinstance(resolved, float)
        assert math.isnan(resolved)

    @pytest.mark.parametrize(
        "text",
        [
            *("on", "off", "yes", "no", "y", "n", "On", "NO", "tRUE", "nULL"),
            *("1_000", "12:30:45", "0b11", "0O17", "0X1F", "-0x1F", "+0o7", "0x", "0o8"),
            *("2001-12-14", "1/16", "..", ".", "-", "+", "1e", "e5", ".e5", "- 1", "1 ", "<<", "="),
            *("9" * 401, "٣", "1\n"),
        ],
    )
    def test_everything_else_is_text(self, text: str) -> None:
        assert resolve(text) == text

    def test_quotes_make_a_text(self) -> None:
        assert data("['1', \"true\", '', '~', x]") == ["1", "true", "", "~", "x"]

    def test_block_scalars_are_texts(self) -> None:
        assert data("- |\n  12\n- >-\n  true\n") == ["12\n", "true"]

    def test_numbers_remember_how_they_were_written(self) -> None:
        hexadecimal, version, decimal = data("[0x0A, 1.10, 010]")  # type: ignore[misc]
        assert isinstance(hexadecimal, SourceInt)
        assert (hexadecimal, hexadecimal.text) == (10, "0x0A")
        assert isinstance(version, SourceFloat)
        assert (version, version.text) == (1.1, "1.10")
        assert (decimal, decimal.text) == (10, "010")

    def test_booleans_and_nothing_stay_what_they_are(self) -> None:
        assert data("[true, false, ~, ]") == [True, False, None]
        assert [type(item) for item in data("[true, null]")] == [bool, type(None)]  # type: ignore[attr-defined]


class TestPlaces:
    TEXT = (
        "protocol: rn1  # the name\n"  # line 1
        "frame:\n"
        "  start: {literal: 0xFF, 'id': true}\n"
        "list:\n"
        "- a\n"  # line 5
        "-  - b\n"
        "   - {}\n"
        "doc: |\n"
        "  two lines\n"
        "  of text\n"  # line 10
        "\n"
        "empty:\n"
        'quoted: "a\n'
        '  b"\n'
        "shared: &anchor  [1, 2]\n"  # line 15
        "again: *anchor\n"
    )

    @pytest.mark.parametrize(
        ("path", "place"),
        [
            ((), (1, 1, 16, 15)),
            (("protocol",), (1, 11, 1, 14)),
            (("frame",), (3, 3, 3, 37)),
            (("frame", "start"), (3, 10, 3, 37)),
            (("frame", "start", "literal"), (3, 20, 3, 24)),
            (("frame", "start", "id"), (3, 32, 3, 36)),
            (("list",), (5, 1, 7, 8)),
            (("list", 0), (5, 3, 5, 4)),
            (("list", 1), (6, 4, 7, 8)),
            (("list", 1, 1), (7, 6, 7, 8)),
            (("doc",), (8, 6, 10, 10)),
            (("empty",), (12, 6, 12, 6)),
            (("quoted",), (13, 9, 14, 5)),
            (("shared",), (15, 18, 15, 24)),
            (("again",), (15, 18, 15, 24)),
        ],
    )
    def test_of_values(
        self, path: tuple[str | int, ...], place: tuple[int, ...], loader: Loader
    ) -> None:
        assert span(parsed(self.TEXT, loader).root.at(path)) == place

    def test_of_keys(self, loader: Loader) -> None:
        start = parsed(self.TEXT, loader).root.at(("frame", "start"))
        assert isinstance(start, MappingNode)
        item = start.item("id")
        assert item is not None
        assert span(item[0]) == (3, 26, 3, 30)

    @pytest.mark.parametrize("newline", ["\n", "\r\n", "\r"])
    def test_do_not_depend_on_the_kind_of_line_break(self, newline: str, loader: Loader) -> None:
        text = "a: 1\nb:\n  - é: 2\n".replace("\n", newline)
        root = parsed(text, loader).root
        assert span(root.at(("b", 0, "é"))) == (3, 8, 3, 9)

    def test_count_characters_not_bytes(self, loader: Loader) -> None:
        assert span(parsed("é😀: x", loader).root.at(("é😀",))) == (1, 5, 1, 6)

    def test_do_not_count_a_byte_order_mark(self, loader: Loader) -> None:
        document = parsed("\ufeffa: 1", loader)
        assert document.source_text == "a: 1"
        assert span(document.root.at(("a",))) == (1, 4, 1, 5)

    def test_are_behind_anchors(self, loader: Loader) -> None:
        root = parsed("a: &x # why\n  b: &y 1\nc: &z\n", loader).root
        assert span(root.at(("a",))) == (2, 3, 2, 10)
        assert span(root.at(("a", "b"))) == (2, 9, 2, 10)
        assert span(root.at(("c",))) == (3, 2, 3, 2)

    def test_of_what_an_alias_repeats_are_where_it_is_written(self) -> None:
        root = parsed("a: &x {b: 1}\nc: *x\n").root
        assert root.at(("c",)) is root.at(("a",))


class TestFind:
    TEXT = (
        "messages:\n"
        "  gyro:\n"
        "    id: 1\n"
        "    fields:\n"
        "      x: {type: sint14, count: 3}\n"
        "      y: [a, b]\n"
        "      literal: {literal: 5}\n"
    )

    @pytest.mark.parametrize(
        ("loc", "place"),
        [
            ((), "1:1"),
            (("messages", "gyro", "id"), "3:9"),
            (("messages", "gyro", "fields", "y", 1), "6:14"),
            # A key that is missing: the mapping that lacks it.
            (("messages", "gyro", "from"), "3:5"),
            # The labels of tagged unions are not in the document.
            (("messages", "gyro", "fields", "mapping", "x", "extent", "count", "number"), "5:32"),
            (("function-before", "messages", "dict", "gyro", "id", "int"), "3:9"),
            # An index beyond the list.
            (("messages", "gyro", "fields", "y", 7), "6:10"),
            # A label that happens to be a key as well.
            (("messages", "gyro", "fields", "literal", "literal", "literal"), "7:26"),
        ],
    )
    def test_of_values(self, loc: tuple[str | int, ...], place: str) -> None:
        assert str(parsed(self.TEXT).find(loc)) == f"f:{place}"

    @pytest.mark.parametrize(
        ("loc", "place"),
        [
            (("messages", "gyro", "id"), "3:5"),
            (("messages", "gyro", "fields", "mapping", "x", "count"), "5:25"),
            (("messages", "gyro", "fields", "y", 1), "6:14"),
            ((), "1:1"),
        ],
    )
    def test_of_keys(self, loc: tuple[str | int, ...], place: str) -> None:
        assert str(parsed(self.TEXT).find(loc, key=True)) == f"f:{place}"

    def test_a_location_that_ends_in_key_means_the_key(self) -> None:
        assert str(parsed(self.TEXT).find(("messages", "gyro", "[key]"))) == "f:2:3"

    def test_the_reading_that_explains_more_wins(self) -> None:
        # The first `literal` is a label; taken for the key, the rest would lead nowhere.
        document = parsed("part: {literal: 5, range: {literal: 6}}")
        assert str(document.find(("part", "literal", "range", "literal"))) == "f:1:37"

    def test_names_that_repeat_at_each_depth_are_followed_once(self) -> None:
        # In 30 mappings within each other, 60 components can be skipped in 2**30 ways.
        document = parsed("{fields: {a: " * 30 + "5" + "}}" * 30)
        names = ("fields", "a") * 30
        assert str(document.find(names)) == f"f:1:{30 * len('{fields: {a: ') + 1}"
        labelled = ("label", *names[:-1], "label")
        assert str(document.find(labelled)) == f"f:1:{30 * len('{fields: {a: ') - len('{a: ') + 1}"

    def test_nodes_lead_only_to_what_they_have(self) -> None:
        root = parsed(self.TEXT).root
        assert root.at(("messages", "sonar")) is None
        assert root.at(("messages", "gyro", "id", "x", "y")) is None
        assert root.at(("messages", "gyro", "fields", "y", "a")) is None
        assert root.at(("messages", "gyro", "fields", "y", -1)) is None
        leaf, sequence = (
            root.at(("messages", "gyro", *rest)) for rest in (["id"], ["fields", "y"])
        )
        assert isinstance(leaf, ScalarNode)
        assert leaf.at(()) is leaf
        assert isinstance(sequence, SequenceNode)
        assert sequence.at((0,)) is sequence.items[0]


class TestProblems:
    def test_every_duplicate_key_is_reported(self, loader: Loader) -> None:
        text = "a: 1\nb: {c: 1, 'c': 2, c: 3}\na: 2\n0x10: x\n16: y\n"
        expected = [("2:11", "PG006"), ("2:19", "PG006"), ("3:1", "PG006"), ("5:1", "PG006")]
        assert found(text, loader) == expected

    def test_the_first_of_two_equal_keys_counts(self) -> None:
        problems = Problems()
        document = parse_document("a: 1\na: 2\n", "f", problems)
        assert document is not None
        assert to_data(document.root) == {"a": 1}

    def test_every_line_with_a_tab_is_reported(self, loader: Loader) -> None:
        text = 'a:\n\tb: 1\n  c:\t2\t3\nd: "x\ty"\n'
        assert found(text, loader) == [("2:1", "PG005"), ("3:5", "PG005"), ("4:6", "PG005")]

    def test_tabs_are_fine_in_comments(self, loader: Loader) -> None:
        assert found("a: 1 # x\ty\n#\tb\n# \t\n", loader) == []

    def test_tabs_are_fine_as_escapes(self, loader: Loader) -> None:
        assert to_data(parsed('a: "\\t"', loader).root) == {"a": "\t"}

    def test_what_stands_before_the_first_tab_is_reported_too(self, loader: Loader) -> None:
        text = "a: 1\na: 2\nb:\n\tc: [\n"
        assert found(text, loader) == [("2:1", "PG006"), ("4:1", "PG005")]

    @pytest.mark.parametrize(
        ("text", "place"),
        [
            ("a: b: c\n", "1:5"),
            ("a: [1, 2\nb: 3\n", "2:2"),
            ("a: 1\n  b: 2\n", "2:4"),
            ("a: *nowhere\n", "1:4"),
            ("a: @x\n", "1:4"),
            ('a: "\\q"\n', "1:5"),
        ],
    )
    def test_syntax(self, text: str, place: str) -> None:
        assert found(text) == [(place, "PG004")]

    @pytest.mark.parametrize(
        "text",
        [
            "a: b: c",
            "a: [1",
            "a: {1",
            "- a\nb: 1",
            '"',
            "a: 1\n b: 2",
            "a: *b",
            '"\\q"',
            "%X\n",
            "`",
        ],
    )
    def test_both_parsers_reject(self, text: str, loader: Loader) -> None:
        assert [code for _, code in found(text, loader)] == ["PG004"]

    @pytest.mark.parametrize("escape", [r"\ud800", r"\U00110000", r"\UFFFFFFFF"])
    def test_escapes_of_no_character(self, escape: str, loader: Loader) -> None:
        assert [code for _, code in found(f'a: "{escape}"', loader)] == ["PG004"]

    @pytest.mark.parametrize("character", ["\x00", "\x1b", "\x85", "\u2028", "\ufeff", "\ud800"])
    def test_characters_that_do_not_belong_into_a_text(
        self, character: str, loader: Loader
    ) -> None:
        text = f"a: 1\nb: x{character}{character}\nc: {character}\n"
        assert found(text, loader) == [("2:5", "PG004"), ("3:4", "PG004")]

    @pytest.mark.parametrize("text", ["", "\n\n", "# nothing\n", "---\n", "\ufeff", "---\n...\n"])
    def test_an_empty_file(self, text: str, loader: Loader) -> None:
        assert found(text, loader) == [("1:1", "PG008")]

    def test_an_empty_text_in_quotes_is_a_document(self) -> None:
        assert data("''") == ""

    def test_a_second_document(self, loader: Loader) -> None:
        assert found("a: 1\n---\nb: 2\n---\nc: 3\n", loader) == [("2:1", "PG008")]

    def test_the_marks_of_one_document_are_fine(self, loader: Loader) -> None:
        assert found("%YAML 1.1\n---\na: 1\n...\n", loader) == []

    @pytest.mark.parametrize(
        ("text", "place", "message"),
        [
            ("[a]: 1", "1:1", "a list can't be a key"),
            ("x: {{a: 1}: 1}", "1:5", "a mapping can't be a key"),
            ("? a: b\n: c\n", "1:3", "a mapping can't be a key"),
            ("a: 1\nnull: 1", "2:1", "`null` means nothing"),
            ("~: 1", "1:1", "`~` means nothing"),
            ("1.5: 1", "1:1", "`1.5` means a fraction"),
            ("{a: 1, ? }", "1:6", "a key is missing"),
        ],
    )
    def test_keys(self, text: str, place: str, message: str, loader: Loader) -> None:
        problems = Problems()
        parse_document(text, "f", problems, loader=loader)
        (problem,) = problems
        assert (str(problem.span), problem.code) == (f"f:{place}", "PG009")
        assert message in problem.message

    def test_names_integers_and_booleans_are_keys(self) -> None:
        assert data("{on: 1, 0x1B: 2, true: 3, 'null': 4}") == {"on": 1, 27: 2, True: 3, "null": 4}

    def test_the_merge_key(self, loader: Loader) -> None:
        assert found("a: &a {b: 1}\nc: {<<: *a, '<<': 1}\n", loader) == [("2:5", "PG012")]

    def test_every_tag_is_reported(self, loader: Loader) -> None:
        text = "a: !!str 1\nb: &x !foo {c: 1}\nd: ! e\nf: !!python/object:os.system [x]\n"
        expected = [("1:4", "PG011"), ("2:7", "PG011"), ("3:4", "PG011"), ("4:4", "PG011")]
        assert found(text, loader) == expected


class TestBounds:
    def test_depth(self, loader: Loader) -> None:
        assert found("[" * 64 + "]" * 64, loader) == []
        assert found("[" * 65 + "]" * 65, loader) == [("1:65", "PG010")]

    def test_depth_of_mappings_in_lists(self, loader: Loader) -> None:
        assert found("- " * 32 + "{a: " * 32 + "1" + "}" * 32, loader) == []
        assert found("- " * 32 + "{a: " * 33 + "1" + "}" * 33, loader) == [("1:193", "PG010")]

    def test_depth_with_aliases_written_out(self, loader: Loader) -> None:
        lines = ["- &a0 [x]"] + [f"- &a{level} [*a{level - 1}]" for level in range(1, 64)]
        assert found("\n".join(lines[:63]), loader) == []
        assert found("\n".join(lines), loader) == [("64:9", "PG010")]

    def test_a_hundred_thousand_brackets_end_at_once(self, loader: Loader) -> None:
        ((place, code),) = found("[" * 100_000, loader)
        # A libyaml that reads ahead says so at a bound of its own.
        assert (place, code) in [("1:65", "PG010"), ("1:1001", "PG010")]

    def test_an_alias_inside_of_what_it_repeats(self, loader: Loader) -> None:
        assert found("a: &a\n  b: [1, *a]\n", loader) == [("2:10", "PG007")]

    def test_an_alias_bomb(self, loader: Loader) -> None:
        lines = ["a0: &a0 [" + "x, " * 10 + "]"]
        lines += [f"a{n}: &a{n} [" + f"*a{n - 1}, " * 10 + "]" for n in range(1, 9)]
        ((place, code),) = found("\n".join(lines), loader)
        # a0 holds 11 values, a1 10 x 11 + 1 = 111, a2 1111, a3 11111, a4 111111 and a5 would
        # be 1111111; the bound of 1000000 is passed within a5.
        assert (place.split(":")[0], code) == ("6", "PG007")

    def test_as_many_values_as_allowed(self) -> None:
        # The lists are values, too: 1 + 999 * (1 + 1000).
        full = "[&a [" + "1," * 998 + "]," + "*a," * 1000
        assert found(full + "]") == []
        assert found(full + "1]") == [(f"1:{len(full) + 1}", "PG007")]

    def test_an_anchor_can_be_given_again(self, loader: Loader) -> None:
        assert to_data(parsed("[&a 1, *a, &a 2, *a]", loader).root) == [1, 1, 2, 2]


class TestFiles:
    def read(self, path: Path) -> tuple[Document | None, list[tuple[str, str]], SourceMap]:
        problems, sources = Problems(), SourceMap()
        document = read_document(path, problems, sources)
        return document, [(str(p.span), f"{p.code} {p.message}") for p in problems], sources

    def write(self, folder: Path, data: bytes) -> Path:
        path = folder / "schema.yaml"
        path.write_bytes(data)
        return path

    def test_a_file_is_read_and_its_text_kept(self, tmp_path: Path) -> None:
        path = self.write(tmp_path, "\ufeffunit: °C\n".encode())
        document, problems, sources = self.read(path)
        assert problems == []
        assert document is not None
        assert to_data(document.root) == {"unit": "°C"}
        assert document.file == str(path)
        assert sources.line(str(path), 1) == "unit: °C"

    def test_no_file(self, tmp_path: Path) -> None:
        document, problems, _ = self.read(tmp_path / "none.yaml")
        assert document is None
        message = "PG001 the file can't be read: No such file or directory"
        assert problems == [(f"{tmp_path}/none.yaml:1:1", message)]

    def test_a_folder(self, tmp_path: Path) -> None:
        _, ((_, message),), _ = self.read(tmp_path)
        assert message == "PG001 the file can't be read: Is a directory"

    def test_a_name_that_no_file_can_have(self) -> None:
        _, ((_, message),), _ = self.read(Path("a\0b"))
        assert message == "PG001 the file can't be read: embedded null byte"

    def test_other_encodings(self, tmp_path: Path) -> None:
        path = self.write(tmp_path, b"a: 1\nunit: \xb0C\n")
        document, ((place, message),), sources = self.read(path)
        assert document is None
        assert (place, message) == (f"{path}:2:7", "PG002 the byte 0xB0 is not UTF-8")
        assert sources.line(str(path), 2) == "unit: \ufffdC"

    def test_the_place_of_a_bad_byte_counts_characters(self, tmp_path: Path) -> None:
        _, ((place, _),), _ = self.read(self.write(tmp_path, "\ufeffé: ".encode() + b"\xff"))
        assert place.endswith(":1:4")

    @pytest.mark.parametrize("encoding", ["utf-16", "utf-16-le"])
    def test_utf_16(self, encoding: str) -> None:
        problems = Problems()
        decode_document("a: é".encode(encoding), "f", problems, SourceMap())
        assert {problem.code for problem in problems} <= {"PG002", "PG004"}
        assert len(problems) == 1

    def test_utf_16_with_its_mark_is_named(self) -> None:
        problems = Problems()
        decode_document("a: 1".encode("utf-16"), "f", problems, SourceMap())
        (problem,) = problems
        assert problem.hint == "this looks like UTF-16; save the file as UTF-8"

    def test_eight_mebibytes_and_not_a_byte_more(self, tmp_path: Path) -> None:
        comment = b"#" * (GREATEST_SIZE - 4) + b"\na: "
        document, problems, _ = self.read(self.write(tmp_path, comment))
        assert problems == []
        assert document is not None
        document, problems, _ = self.read(self.write(tmp_path, comment + b"1"))
        assert document is None
        assert problems == [(f"{tmp_path}/schema.yaml:1:1", "PG003 the file is larger than 8 MiB")]


PIECES = st.sampled_from(
    [
        *("a", "b", "1", "0x1B", "-", "- ", "? ", ": ", ":", "\n", "\n  ", "\n    ", " ", "  "),
        *("{", "}", "[", "]", ",", ", ", '"', "'", "#", " # c", "&a ", "*a", "!t ", "!!str ", "|"),
        *(">", "|-\n  ", "---\n", "\n---\n", "...\n", "%", "@", "`", "null", "~", "<<", "é", "\t"),
        *("\r\n", "\r", "\x00", "\ufeff", "\u2028", "\\", '"\\u', '"\\ud800"', "\nk: v", "\n- x"),
    ]
)
TEXTS = st.text(max_size=60) | st.lists(PIECES, max_size=16).map("".join)

WORDS = st.text("abcxyz_", min_size=1, max_size=6)
SCALARS = st.one_of(
    st.none(),
    st.booleans(),
    st.integers(-(10**9), 10**9),
    st.floats(allow_nan=False),
    WORDS,
    st.text(max_size=12),
    st.sampled_from(
        ["on", "no", "010", "1_0", "12:30", "true", "null", "a: b", " x ", "x #y", "'"]
    ),
)
TREES = st.recursive(
    SCALARS,
    lambda inner: (
        st.lists(inner, max_size=4)
        | st.dictionaries(WORDS | st.integers(0, 255), inner, max_size=4)
    ),
    max_leaves=20,
)


class TestProperties:
    @given(TEXTS)
    @example("a: &a [*a]")
    @example('"\\UFFFFFFFF"')
    def test_any_text_gives_a_document_or_problems(self, text: str) -> None:
        for loader in (PURE_LOADER, FAST_LOADER):
            problems = Problems()
            document = parse_document(text, "f", problems, loader=loader)
            assert document is not None or problems.errors
            if document is not None:
                to_data(document.root)

    @given(TEXTS)
    def test_both_parsers_give_the_same_trees(self, text: str) -> None:
        fast, pure = Problems(), Problems()
        first = parse_document(text, "f", fast, loader=FAST_LOADER)
        second = parse_document(text, "f", pure, loader=PURE_LOADER)
        # They word syntax errors differently, accept different corners of YAML, and read a tag
        # that no schema may have in different ways.
        codes = {problem.code for problem in (*fast, *pure)}
        if codes.isdisjoint({"PG004", "PG011"}):
            assert first == second
            assert list(fast) == list(pure)

    @given(TREES, st.sampled_from([True, False, None]), st.booleans(), st.booleans())
    def test_what_another_program_writes_is_read(
        self, tree: object, flow: bool | None, unicode: bool, pure: bool
    ) -> None:
        # The reference emitter speaks YAML 1.1: all texts in quotes mean the same in both.
        text = yaml.dump(
            tree,
            Dumper=QuotingDumper,
            default_flow_style=flow,
            allow_unicode=unicode,
            sort_keys=False,
        )
        document = parsed(text, PURE_LOADER if pure else FAST_LOADER)
        assert to_data(document.root) == tree

    @given(TREES)
    def test_every_span_covers_what_was_written(self, tree: object) -> None:
        text = yaml.dump(tree, Dumper=QuotingDumper, sort_keys=False, width=10_000)
        lines = text.split("\n")

        def check(node: Node) -> None:
            if isinstance(node, ScalarNode):
                check_scalar(node, lines)
            elif isinstance(node, SequenceNode):
                for item in node.items:
                    assert inside(item.span, node.span)
                    check(item)
            else:
                for key, value in node.items:
                    assert inside(key.span, node.span)
                    assert inside(value.span, node.span)
                    check(key)
                    check(value)

        check(parsed(text).root)


class QuotingDumper(yaml.SafeDumper):
    """Writes texts in double quotes, and nothing as an alias."""

    def ignore_aliases(self, data: object) -> bool:
        return True


def _quoted(dumper: yaml.SafeDumper, text: str) -> yaml.ScalarNode:
    return dumper.represent_scalar("tag:yaml.org,2002:str", text, style='"')


def _number(dumper: yaml.SafeDumper, number: float) -> yaml.ScalarNode:
    text = {math.inf: ".inf", -math.inf: "-.inf"}.get(number, repr(number))
    if "." not in text:
        text = text.replace("e", ".0e")  # YAML 1.1 takes no exponent without a point
    return dumper.represent_scalar("tag:yaml.org,2002:float", text)


QuotingDumper.add_representer(str, _quoted)
QuotingDumper.add_representer(float, _number)


def inside(inner: Span, outer: Span) -> bool:
    start = (outer.line, outer.column) <= (inner.line, inner.column)
    return start and (inner.end_line, inner.end_column) <= (outer.end_line, outer.end_column)


def check_scalar(node: ScalarNode, lines: list[str]) -> None:
    place = node.span
    if node.plain and place.line == place.end_line:
        assert lines[place.line - 1][place.column - 1 : place.end_column - 1] == node.text
    elif not node.plain:
        assert lines[place.line - 1][place.column - 1] == '"'
        assert lines[place.end_line - 1][place.end_column - 2] == '"'
