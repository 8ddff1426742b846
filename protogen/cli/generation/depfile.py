"""A rule of make, for build systems: the generated files depend on what was read for them."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from pathlib import Path
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from protogen.cli.generation.jobs import Job
    from protogen.compiler import Compilation


def write_depfile(path: Path, jobs: Sequence[Job], compilations: Sequence[Compilation]) -> None:
    """Write the rule: the generated files depend on the schemas and those they extend."""
    made = [str(job.folder / file.path) for job in jobs for file in job.files]
    read = dict.fromkeys(file for item in compilations for file in item.sources.files)
    path.parent.mkdir(parents=True, exist_ok=True)
    rule = f"{_joined(made)}: {_joined(read)}\n"
    path.write_text(rule, encoding="utf-8", newline="\n")


def _joined(paths: Iterable[str]) -> str:
    """Paths in a rule: `$` stands twice, and a backslash in front of a blank or `#`."""
    doubled = (path.replace("$", "$$") for path in paths)
    escaped = (path.replace(" ", "\\ ").replace("#", "\\#") for path in doubled)
    return " \\\n  ".join(escaped)
