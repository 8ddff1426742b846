"""An example of each rule: a small schema before and after the change, in a folder of its name."""

from __future__ import annotations

from collections.abc import Iterator
from difflib import unified_diff
from pathlib import Path

import msgspec

from protogen.compiler import compile_file
from protogen.evolution.compare import Comparison
from protogen.evolution.findings import Finding, findings, gone
from protogen.model.protocol import Protocol

FOLDER = Path(__file__).parent
"""Holds `RULE/old.yaml` and `RULE/new.yaml`; without the latter, the schema is gone."""


class Example(msgspec.Struct, frozen=True):
    """A schema in two versions."""

    name: str
    before: str
    after: str | None

    def steps(self) -> Iterator[str]:
        """Lines of the schema; those that go begin with `-`, those that come with `+`."""
        after = (self.after or "").splitlines()
        lines = unified_diff(self.before.splitlines(), after, lineterm="", n=10**6)
        yield from (line for line in lines if not line.startswith(("---", "+++", "@@")))

    def findings(self) -> tuple[Comparison, list[Finding]]:
        """What the change does."""
        old = _compiled(self.name, "old", self.before)
        if self.after is None:
            return gone(old, f"{old.name}.yaml")
        return findings(old, _compiled(self.name, "new", self.after))


def example_of(rule: str) -> Example:
    """The example of a rule; each has one."""
    old, new = (FOLDER / rule / f"{version}.yaml" for version in ("old", "new"))
    after = new.read_text(encoding="utf-8") if new.exists() else None
    return Example(rule, old.read_text(encoding="utf-8"), after)


def _compiled(rule: str, version: str, text: str) -> Protocol:
    protocol = compile_file(FOLDER / rule / f"{version}.yaml", text=text).protocol
    assert protocol is not None, rule
    return protocol
