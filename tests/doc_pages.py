"""Pages of the documentation, taken apart into their blocks."""

from __future__ import annotations

import re
from dataclasses import dataclass
from functools import cache
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
GENERATED = "docs/problems.md"
"""Made from the catalogue, whose examples have tests of their own."""
PAGES = (
    "README.md",
    *sorted(
        str(path.relative_to(ROOT))
        for path in (ROOT / "docs").rglob("*.md")
        if path != ROOT / GENERATED
    ),
    "CONTRIBUTING.md",
    "ARCHITECTURE.md",
    "benchmarks/README.md",
)
FILES = ("toml", "markdown", "xml")
"""Languages of blocks that are written to a file of their own."""

_FENCE = re.compile(r"^```(\w+)\n(.*?)^```$", re.MULTILINE | re.DOTALL)
_EXCERPT = re.compile(r"<!-- from (\S+) -->\n(.*?)<!-- end -->", re.DOTALL)
_LINK = re.compile(r"\]\(([^)\s]+)\)")
_SCHEMA = re.compile(r"# (\w+\.yaml)\n")
_DEFINITIONS = re.compile(r"# (definitions/\w+\.yaml)\n")
_FRAGMENT = re.compile(r"# frame: (.+)\n")
_MODELINE = re.compile(r"# yaml-language-server: \$schema=(\S+)\n")
_WORKFLOW = re.compile(r"# (?:\.github/workflows/\w+\.yaml|\.pre-commit-config\.yaml|hooks: .*)\n")
_NAMED = re.compile(r"(?:# |// |/\* |<!-- )(\w+\.(?:toml|md|xml|c|cpp|ino|mjs|ts))(?: \*/| -->)?\n")


@dataclass(frozen=True)
class Block:
    """A fenced block."""

    language: str
    text: str

    @property
    def file(self) -> str:
        """Name of the file that the first line gives."""
        named = _NAMED.match(self.text)
        assert named, f"the first line names no file:\n{self.text}"
        return named[1]


@dataclass(frozen=True)
class Page:
    """A document in Markdown."""

    path: str

    @property
    def text(self) -> str:
        return text_of(self.path)

    @property
    def blocks(self) -> list[Block]:
        return [Block(*match.groups()) for match in _FENCE.finditer(self.text)]

    @property
    def languages(self) -> set[str]:
        return {block.language for block in self.blocks}

    @property
    def fences(self) -> int:
        """Number of lines that open or close a block."""
        return len(re.findall(r"^\s*```", self.text, re.MULTILINE))

    @property
    def excerpts(self) -> list[tuple[str, str]]:
        """Pieces of generated files, each with the path of its file."""
        return _EXCERPT.findall(self.text)

    @property
    def links(self) -> list[str]:
        return _LINK.findall(_FENCE.sub("", self.text))

    @property
    def commands(self) -> str:
        """The commands on the page, with what they print."""
        return "".join(block.text for block in self.blocks if block.language == "console")

    @property
    def generates(self) -> bool:
        """True if a command on the page generates code."""
        return "$ protogen generate" in self.commands

    def compiles(self, source: Block) -> bool:
        """True if a command on the page compiles a source."""
        return f" {source.file} " in self.commands

    def needs(self, program: str) -> bool:
        """True if a block calls a program by its name."""
        return any(re.search(rf"\b{program} -", block.text) for block in self.blocks)

    def __str__(self) -> str:
        return self.path


@cache
def text_of(path: str) -> str:
    return (ROOT / path).read_text(encoding="utf-8")


@cache
def pages() -> tuple[Page, ...]:
    return tuple(map(Page, PAGES))


def blocks(language: str) -> list[Block]:
    return [block for page in pages() for block in page.blocks if block.language == language]


def named_schemas() -> dict[str, str]:
    """Schemas that pages show whole, by the name of their file."""
    found: dict[str, str] = {}
    for block in blocks("yaml"):
        if match := _SCHEMA.match(block.text):
            assert found.setdefault(match[1], block.text) == block.text, f"two {match[1]}"
    return found


def definitions() -> dict[str, str]:
    """Definitions that pages import, by the path of their file."""
    texts = [block.text for block in blocks("yaml")]
    return {match[1]: text for text in texts if (match := _DEFINITIONS.match(text))}


def fragments() -> dict[str, str]:
    """Frames that can stand in the place of the one in `rover.yaml`."""
    texts = [block.text for block in blocks("yaml")]
    return {match[1]: text for text in texts if (match := _FRAGMENT.match(text))}


def modelines() -> list[str]:
    """JSON Schemas that blocks name for an editor."""
    return [match[1] for block in blocks("yaml") if (match := _MODELINE.match(block.text))]


def says_what_it_is(block: Block) -> bool:
    """True if the first line of a block of YAML tells what the block is."""
    patterns = (_SCHEMA, _DEFINITIONS, _FRAGMENT, _MODELINE, _WORKFLOW)
    return any(pattern.match(block.text) for pattern in patterns)


def agrees(expected: str, actual: str) -> bool:
    """True if a text is the expected one, in which `...` may stand for anything."""
    lines = [line.rstrip() for line in expected.strip("\n").split("\n")]
    patterns = [
        r"(?:.*\n)*?" if line.strip() == "..." else _line_pattern(line) + r"\n" for line in lines
    ]
    stripped = "".join(f"{line.rstrip()}\n" for line in actual.strip("\n").split("\n"))
    return re.fullmatch("".join(patterns), stripped) is not None


def _line_pattern(line: str) -> str:
    return ".*".join(map(re.escape, line.split("...")))
