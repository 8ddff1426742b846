"""Renders the catalogue of problems as a Markdown page."""

from __future__ import annotations

import sys
from collections.abc import Iterable, Sequence
from pathlib import Path

from protogen.problems.catalogue import CODES, Code

_HEAD = """\
# Problems

<!-- Generated from protogen/problems/catalogue, do not edit. -->

Every problem that protogen reports, by its code. Codes are stable. A problem is printed with its
file, line and column, the source line, and a hint where there is one; `--format json` and
`--format github` print the same for programs.

| Code | Severity | Problem |
| --- | --- | --- |
"""


def render_catalogue(codes: Iterable[Code] = CODES.values()) -> str:
    """Return the Markdown page that explains each of ``codes``."""
    listed = tuple(codes)
    rows = "".join(map(_row, listed))
    return _HEAD + rows + "".join(map(_section, listed))


def _row(code: Code) -> str:
    title = code.title.replace("|", "\\|")
    return f"| [{code.code}](#{code.code.lower()}) | {code.severity.value} | {title} |\n"


def _section(code: Code) -> str:
    language = "yaml" if code.compiles else "text"
    return (
        f'\n## <a id="{code.code.lower()}"></a>{code.code}: {code.title}\n\n'
        f"`{code.name}`, {code.severity.value}. {code.explanation.strip()}\n\n"
        f"{_fenced(code.bad_example, language)}\n"
        f"Fixed:\n\n"
        f"{_fenced(code.fixed_example, language)}"
    )


def _fenced(example: str, language: str) -> str:
    fence = "```"
    while fence in example:
        fence += "`"
    return f"{fence}{language}\n{example.rstrip()}\n{fence}\n"


def main(arguments: Sequence[str]) -> None:
    """Write the page to the file that is given as the only argument."""
    page = Path(*arguments)
    page.parent.mkdir(parents=True, exist_ok=True)
    page.write_text(render_catalogue(), encoding="utf-8", newline="\n")


if __name__ == "__main__":
    main(sys.argv[1:])
