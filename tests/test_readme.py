"""What the documents show is what happens: every code block in them is run.

    yaml      `# NAME.yaml` in the first line: a schema, written to a file. `# frame: ...`: what
              stands in the place of `frame` and `transparency` in the README's first schema.
    python    statements, run in order; a section shares its names. The comment behind an
              expression, or below it, is its value; `Error: message` is what it raises.
    text      what the Python in front of it prints
    c         `/* NAME.c */` in the first line: a program, built with the C of the headers that it
              includes; it exits with 0
    cpp       `// NAME.ino` in the first line: an Arduino sketch
    console   `$ command` lines, each with what it prints
    sh        `make` commands
    toml      `# NAME.toml` in the first line: a file, written when the console comes to it
    markdown  `<!-- NAME.md -->` in the first line: the same

In what is expected, `...` stands for any text, and alone on a line for any lines. Each section runs
in a folder of its own with the schemas of the repository, those of all documents, and the Python
generated from them.
"""

from __future__ import annotations

import ast
import io
import os
import re
import shutil
import subprocess
import sys
import textwrap
import tokenize
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import pairwise
from pathlib import Path

import pytest
from cli_support import PATIENCE, start
from tooling import require_tool

from protogen.compiler import compile_file
from protogen.schema.json_schema import json_schema

ROOT = Path(__file__).resolve().parent.parent
DOCUMENTS = (
    "README.md",
    "docs/language.md",
    "docs/decoder.md",
    "docs/convert.md",
    "benchmarks/README.md",
)

_FENCE = re.compile(r"^```(\w+)\n(.*?)^```$", re.MULTILINE | re.DOTALL)
_HEADING = re.compile(r"^## (.+)$", re.MULTILINE)
_EXCERPT = re.compile(r"<!-- from (\S+) -->\n(.*?)<!-- end -->", re.DOTALL)
_LINK = re.compile(r"\]\(([^)\s]+)\)")
_FILE_NAME = re.compile(r"# (\w+\.yaml)\n")
_WRITTEN = re.compile(r"(?:# |<!-- )(\w+\.(?:toml|md))(?: -->)?\n")
_FRAGMENT = re.compile(r"# frame: (.+)\n")
_MODELINE = re.compile(r"# yaml-language-server: \$schema=(\S+)\n")

# --- documents and their blocks -------------------------------------------------------------------


@dataclass(frozen=True)
class Block:
    """A fenced block."""

    language: str
    text: str


@dataclass(frozen=True)
class Section:
    """What stands below a heading of the second level, or above the first."""

    document: str
    title: str
    text: str

    @property
    def blocks(self) -> list[Block]:
        return [Block(*match.groups()) for match in _FENCE.finditer(self.text)]

    def __str__(self) -> str:
        return f"{self.document}: {self.title}"


def text_of(document: str) -> str:
    return (ROOT / document).read_text(encoding="utf-8")


def sections() -> Iterator[Section]:
    for document in DOCUMENTS:
        titles_and_texts = _HEADING.split(text_of(document))
        yield Section(document, "top", titles_and_texts[0])
        for title, text in zip(titles_and_texts[1::2], titles_and_texts[2::2], strict=True):
            yield Section(document, title, text)


def blocks(language: str) -> list[Block]:
    return [block for item in sections() for block in item.blocks if block.language == language]


def with_blocks(*languages: str) -> list[Section]:
    return [item for item in sections() if any(b.language in languages for b in item.blocks)]


def named_schemas() -> dict[str, str]:
    texts = [block.text for block in blocks("yaml")]
    named = [(match[1], text) for text in texts if (match := _FILE_NAME.match(text))]
    assert len(named) == len(dict(named)), "two blocks have the same name"
    return dict(named)


def fragments() -> dict[str, str]:
    texts = [block.text for block in blocks("yaml")]
    return {match[1]: text for text in texts if (match := _FRAGMENT.match(text))}


# --- the folder that everything runs in -----------------------------------------------------------


@pytest.fixture(scope="module")
def prepared(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("documents")
    shutil.copytree(ROOT / "schemas", folder / "schemas")
    for name, text in named_schemas().items():
        (folder / name).write_text(text, encoding="utf-8")
    program = folder / "bin" / "protogen"
    program.parent.mkdir()
    program.write_text(f'#!/bin/sh\nexec "{sys.executable}" -m protogen "$@"\n')
    program.chmod(0o755)
    made = start("generate", "schemas", "rover.yaml", "rover_hello.yaml", "--quiet", cwd=folder)
    assert made.returncode == 0, made.stderr.decode()
    return folder


@pytest.fixture
def workspace(prepared: Path, tmp_path: Path) -> Path:
    return shutil.copytree(prepared, tmp_path / "workspace")


def run(command: Sequence[str], workspace: Path) -> subprocess.CompletedProcess[str]:
    path = f"{workspace / 'bin'}{os.pathsep}{os.environ['PATH']}"
    return subprocess.run(
        command,
        cwd=workspace,
        env={**os.environ, "PATH": path, "PYTHONPATH": str(ROOT), "NO_COLOR": "1"},
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        text=True,
        timeout=PATIENCE,
        check=False,
    )


def agrees(expected: str, actual: str) -> bool:
    """Whether a text is the expected one, in which `...` may stand for anything."""
    lines = [line.rstrip() for line in expected.strip("\n").split("\n")]
    patterns = [
        r"(?:.*\n)*?" if line.strip() == "..." else _line_pattern(line) + r"\n" for line in lines
    ]
    stripped = "".join(f"{line.rstrip()}\n" for line in actual.strip("\n").split("\n"))
    return re.fullmatch("".join(patterns), stripped) is not None


def _line_pattern(line: str) -> str:
    return ".*".join(map(re.escape, line.split("...")))


# --- schemas --------------------------------------------------------------------------------------

FILES = ("toml", "markdown")
"""Languages of blocks that are files of their own."""
FAULTY = {"wrong.yaml", "rover_seen.yaml"}
"""Schemas that show what a problem looks like."""


class TestSchemas:
    @pytest.mark.parametrize("name", sorted(named_schemas()))
    def test_compiles(self, name: str, prepared: Path) -> None:
        compilation = compile_file(prepared / name, examples=True)
        assert bool(compilation.problems) == (name in FAULTY), compilation.problems

    @pytest.mark.parametrize("name", sorted(fragments()))
    def test_frame_compiles_in_the_place_of_the_first_one(self, name: str, tmp_path: Path) -> None:
        first = named_schemas()["rover.yaml"]
        start, end = first.index("frame:"), first.index("messages:")
        schema = tmp_path / "rover.yaml"
        schema.write_text(f"{first[:start]}{fragments()[name]}\n{first[end:]}")
        compilation = compile_file(schema, examples=True)
        assert compilation.problems == ()

    def test_every_block_says_what_it_is(self) -> None:
        patterns = (_FILE_NAME, _FRAGMENT, _MODELINE)
        for block in blocks("yaml"):
            assert any(pattern.match(block.text) for pattern in patterns), block.text

    def test_modelines_name_a_file(self) -> None:
        named = [match[1] for block in blocks("yaml") if (match := _MODELINE.match(block.text))]
        assert named
        assert all((ROOT / name).is_file() for name in named)


# --- Python ---------------------------------------------------------------------------------------

PRELUDE = '''
import re, sys, types

class _Unplugged(BaseException):
    """Ends the loop that reads the stand-in for a serial port."""

class _Serial:
    """Gives a frame, bytes that are none, and the frame of an unknown message."""
    _pieces = [
        "09 82 01 FC 1C", "E8 FF B8 EE 00",  # a frame in two portions
        "17 00",
        "",  # a silence
        "04 7F", "70 8B 00",
    ]

    def __init__(self, name, baud, timeout):
        self._left = list(self._pieces)

    def __enter__(self):
        return self

    def __exit__(self, *error):
        pass

    @property
    def in_waiting(self):
        return 0

    def read(self, size):
        assert size == 1
        if not self._left:
            raise _Unplugged
        return bytes.fromhex(self._left.pop(0))

sys.modules["serial"] = types.SimpleNamespace(Serial=_Serial)

def _expect(expression, expected, source):
    try:
        value = repr(expression())
    except Exception as error:
        value = f"{type(error).__name__}: {error}"
    pattern = ".*".join(map(re.escape, expected.split("...")))
    assert re.fullmatch(pattern, value), f"{source}\\n  is {value}\\n not {expected}"
'''
MARK = "--- end of a block ---"


class TestPython:
    @pytest.mark.parametrize("section", with_blocks("python"), ids=str)
    def test_does_what_it_says(self, section: Section, workspace: Path) -> None:
        python = [block for block in section.blocks if block.language == "python"]
        script = [PRELUDE, *(_checked(block.text) for block in python)]
        done = run([sys.executable, "-c", f"\nprint({MARK!r})\n".join(script)], workspace)
        assert done.returncode == 0, done.stdout
        printed = dict(zip(python, done.stdout.split(f"{MARK}\n")[1:], strict=True))
        for block, following in pairwise(section.blocks):
            if following.language == "text" and block in printed:
                assert agrees(following.text, printed[block]), printed[block]

    def test_text_follows_python_only(self) -> None:
        for section in sections():
            pairs = pairwise([Block("", ""), *section.blocks])
            assert all(a.language == "python" for a, b in pairs if b.language == "text")


def _checked(text: str) -> str:
    """Return the code with a check in the place of each expression that has a comment."""
    comments = {
        token.start[0]: (
            token.string.removeprefix("#").strip(),
            not token.line[: token.start[1]].strip(),
        )
        for token in tokenize.generate_tokens(io.StringIO(text).readline)
        if token.type == tokenize.COMMENT
    }
    return "\n".join(_statement(item, text, comments) for item in ast.parse(text).body)


def _statement(item: ast.stmt, text: str, comments: dict[int, tuple[str, bool]]) -> str:
    source = ast.get_source_segment(text, item) or ""
    if "serial.Serial(" in source:
        return f"try:\n{textwrap.indent(source, '    ')}\nexcept _Unplugged:\n    pass"
    expected = _value(item.end_lineno or 0, comments)
    if not isinstance(item, ast.Expr) or not expected:
        return source
    return f"_expect(lambda: ({source}), {expected!r}, {source!r})"


def _value(line: int, comments: dict[int, tuple[str, bool]]) -> str:
    """Return the comment that ends in a line, or those that stand alone below it."""
    if line in comments:
        return comments[line][0]
    found = []
    while (line := line + 1) in comments and comments[line][1]:
        found.append(comments[line][0])
    return " ".join(found)


# --- C --------------------------------------------------------------------------------------------

ARDUINO = """\
// Stands in for the core: the port is standard input and output, the pins are silent.
#pragma once
#include <cstddef>
#include <cstdint>
#include <cstdio>
#define HIGH 1
#define LOW 0
#define OUTPUT 1
#define LED_BUILTIN 13
static inline void pinMode(int, int) {}
static inline void digitalWrite(int, int) {}
struct Port {
    int next = -1;
    void begin(long) {}
    int available() { return next >= 0 || (next = std::getchar()) >= 0; }
    int read() { int byte = next; next = -1; return byte; }
    void write(uint8_t byte) { std::putchar(byte); }
};
static Port Serial;
"""


class TestC:
    @pytest.mark.parametrize("section", with_blocks("c"), ids=str)
    def test_runs(self, section: Section, workspace: Path) -> None:
        compiler = require_tool("cc")
        for block in section.blocks:
            if block.language == "c":
                name = re.match(r"/\* (\w+\.c) \*/", block.text)[1]  # type: ignore[index]
                (workspace / name).write_text(block.text)
                flags = ["-std=c99", "-Wall", "-Wextra", "-Werror", "-Igenerated/c"]
                used = re.findall(r'#include "(\w+)\.h"', block.text)
                sources = [name, *(f"generated/c/{header}.c" for header in used)]
                done = run([compiler, *flags, *sources, "-o", "program"], workspace)
                assert done.returncode == 0, done.stdout
                assert run(["./program"], workspace).returncode == 0

    def test_the_sketch_acknowledges_each_command(self, workspace: Path) -> None:
        sketch = next(block for block in blocks("cpp") if block.text.startswith("// blink.ino"))
        main = "int main() { setup(); loop(); return 0; }"
        (workspace / "Arduino.h").write_text(ARDUINO)
        (workspace / "sketch.cpp").write_text(f'#include "Arduino.h"\n{sketch.text}\n{main}\n')
        made = run(
            ["sh", "-c", "protogen generate blink.yaml --target c --events messages -q"], workspace
        )
        assert made.returncode == 0, made.stdout
        cc, cpp = require_tool("cc"), require_tool("g++")
        run([cc, "-std=c99", "-Os", "-c", "generated/c/blink.c", "-o", "blink.o"], workspace)
        flags = ["-std=c++11", "-Wall", "-Wextra", "-Werror", "-Igenerated/c"]
        built = run([cpp, *flags, "sketch.cpp", "blink.o", "-o", "sketch"], workspace)
        assert built.returncode == 0, built.stdout
        # Noise, then `led` on with counter 7 and off with 8; the sums by hand:
        # 03 + 07 + 01 + 01 = 0C -> F4, 03 + 08 + 01 + 00 = 0C -> F4.
        line = bytes.fromhex("AA 55 03 07 01 01 F4 55 03 08 01 00 F4")
        answer = subprocess.run(
            ["./sketch"],
            cwd=workspace,
            input=line,
            stdout=subprocess.PIPE,
            timeout=PATIENCE,
            check=True,
        ).stdout
        # Two acks: 03 + 07 + 02 + 01 = 0D -> F3, 03 + 08 + 02 + 00 = 0D -> F3.
        assert answer == bytes.fromhex("55 03 07 02 01 F3 55 03 08 02 00 F3")


# --- the command line -----------------------------------------------------------------------------


class TestConsole:
    @pytest.mark.parametrize("section", with_blocks("console"), ids=str)
    def test_prints_what_it_shows(self, section: Section, workspace: Path) -> None:
        shutil.rmtree(workspace / "generated")
        for block in section.blocks:
            if block.language in FILES:
                name = _WRITTEN.match(block.text)[1]  # type: ignore[index]
                (workspace / name).write_text(block.text, encoding="utf-8")
            if block.language == "console":
                for command, expected in _commands(block.text):
                    done = run(["sh", "-c", command], workspace)
                    assert agrees(expected, done.stdout), f"$ {command}\n{done.stdout}"


def _commands(text: str) -> list[tuple[str, str]]:
    _, *pieces = re.split(r"^\$ ", text, flags=re.MULTILINE)
    return [(command, output) for command, _, output in (piece.partition("\n") for piece in pieces)]


class TestMake:
    def test_targets_exist(self) -> None:
        targets = set(re.findall(r"^(\w+):", text_of("Makefile"), re.MULTILINE))
        lines = "".join(block.text for block in blocks("sh")).splitlines()
        assert {"make generate", "make test"} <= {line.split("  ")[0] for line in lines}
        for line in lines:
            program, target = line.split()[:2]
            assert program in ("make", "python")
            assert target in targets if program == "make" else (ROOT / target).is_file()


# --- the rest of a document -----------------------------------------------------------------------


class TestDocuments:
    def test_no_block_escapes_these_tests(self) -> None:
        languages = {block.language for section in sections() for block in section.blocks}
        assert languages <= {"yaml", "python", "text", "console", "sh", "c", "cpp", *FILES}
        for document in DOCUMENTS:
            fences = re.findall(r"^\s*```", text_of(document), re.MULTILINE)
            assert len(fences) == 2 * len(_FENCE.findall(text_of(document)))

    def test_excerpts_stand_in_generated_files(self, prepared: Path) -> None:
        excerpts = [found for name in DOCUMENTS for found in _EXCERPT.findall(text_of(name))]
        assert excerpts
        for name, excerpt in excerpts:
            assert excerpt in (prepared / name).read_text(encoding="utf-8")

    @pytest.mark.parametrize("document", DOCUMENTS)
    def test_links_lead_to_files(self, document: str) -> None:
        links = _LINK.findall(_FENCE.sub("", text_of(document)))
        paths = [link.split("#")[0] for link in links if not link.startswith(("https:", "#"))]
        missing = [path for path in paths if not ((ROOT / document).parent / path).exists()]
        assert missing == []

    def test_names_the_distribution_the_command_and_the_licence(self) -> None:
        project = text_of("pyproject.toml")
        readme = text_of("README.md")
        assert 'name = "protogen-serial"' in project
        assert "`protogen-serial`" in readme
        assert 'license = "Apache-2.0"' in project
        assert "Apache-2.0" in readme


# --- the reference of the language ----------------------------------------------------------------


def described() -> dict[str, dict[str, tuple[str, bool]]]:
    """Return, of each mapping of the language, its keys with description and whether needed."""
    definitions = {
        name: schema
        for name, schema in json_schema()["definitions"].items()
        if "properties" in schema and not name.startswith("Dialect")
    }
    return {
        schema["title"]: {
            key: (value["description"], key in schema.get("required", ()))
            for key, value in schema["properties"].items()
        }
        for schema in definitions.values()
    }


def expected_table(keys: dict[str, tuple[str, bool]]) -> str:
    rows = [f"| `{key}`{'*' if needed else ''} | {text} |" for key, (text, needed) in keys.items()]
    return "\n".join(["| Key | Meaning |", "| --- | --- |", *rows])


class TestLanguageReference:
    @pytest.mark.parametrize("name", sorted(described()))
    def test_has_every_key_with_its_description(self, name: str) -> None:
        table = expected_table(described()[name])
        assert table in text_of("docs/language.md"), f"docs/language.md lacks:\n\n{table}"

    def test_has_no_other_keys(self) -> None:
        language = text_of("docs/language.md")
        for name in described():
            language = language.replace(expected_table(described()[name]), "")
        assert "| Key | Meaning |" not in language
