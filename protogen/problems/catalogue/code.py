"""Entry of the catalogue for one problem code."""

from __future__ import annotations

import re

import msgspec

from protogen.problems.severity import Severity

_FILE_HEADER = re.compile(r"^# file: (\S+)\n", re.MULTILINE)


class Code(msgspec.Struct, frozen=True):
    """A kind of problem: its stable code, its short name, and how to fix it.

    ``explanation`` is Markdown. The examples are YAML; one that needs several files starts each
    with a line ``# file: NAME``. ``compiles`` is false where an example only describes a file
    that can't be printed, such as one that is too large.
    """

    code: str
    name: str
    title: str
    explanation: str
    bad_example: str
    fixed_example: str
    severity: Severity = Severity.ERROR
    compiles: bool = True


def files_of(example: str) -> dict[str, str]:
    """Split an example into its files by name; the first is the one to compile."""
    head, *named = _FILE_HEADER.split(example)
    if not named:
        return {"schema.yaml": head}
    return dict(zip(named[::2], named[1::2], strict=True))
