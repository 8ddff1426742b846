"""The commands and options that pages name exist."""

from __future__ import annotations

import re
import shlex
from functools import cache

import pytest
from cli_support import run
from doc_pages import pages, text_of

REFERENCE = "docs/reference/cli.md"


def commands() -> list[str]:
    """Commands in the texts and tables of all pages, without those of blocks."""
    found = [re.findall(r"`(protogen [a-z][^`]*)`", page.text) for page in pages()]
    return sorted({line for lines in found for line in lines})


@cache
def help_of(command: str) -> str:
    shown = run(command, "--help")
    assert shown.exit_code == 0, shown.output
    return shown.output


@pytest.mark.parametrize("line", commands())
def test_exists_with_its_options(line: str) -> None:
    _, command, *arguments = shlex.split(line)
    for option in (word for word in arguments if word.startswith("--")):
        assert re.search(rf"{option}\b", help_of(command)), option
    assert help_of(command)


def test_the_reference_lists_every_command() -> None:
    listed = re.findall(r"^\| `protogen ([\w-]+)` \|", text_of(REFERENCE), re.MULTILINE)
    offered = re.findall(
        r"^ *│? +([\w-]+)  +[A-Z]", run("--help").output.split("Commands")[1], re.M
    )
    assert sorted(listed) == sorted(offered)
