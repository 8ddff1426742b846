"""The project's schemas and the framings of `tests/framings`, each compiled once in a process."""

from __future__ import annotations

from functools import cache
from pathlib import Path
from types import ModuleType

from protogen.compiler import compile_file
from protogen.live.codec import module_of
from protogen.model.protocol import Protocol

ROOT = Path(__file__).resolve().parent.parent
DOCUMENTS = sorted((ROOT / "schemas").glob("*.yaml"))
DIALECTS = sorted((ROOT / "schemas" / "dialects").glob("*.yaml"))
FRAMINGS = sorted((ROOT / "tests" / "framings").glob("*.yaml"))
SCHEMAS = [*DOCUMENTS, *DIALECTS, *FRAMINGS]


@cache
def protocol_of(path: Path) -> Protocol:
    """The resolved protocol of a schema, which has no problems at all."""
    compilation = compile_file(path)
    assert compilation.problems == (), [str(problem) for problem in compilation.problems]
    assert compilation.protocol is not None
    return compilation.protocol


@cache
def module_at(path: Path) -> ModuleType:
    """The Python module that is generated from a schema."""
    return module_of(protocol_of(path))


def senders() -> list[tuple[Path, str]]:
    """Every endpoint that sends, of every schema."""
    return [(path, sender.name) for path in SCHEMAS for sender in protocol_of(path).senders]


def name_of(item: Path | str) -> str:
    """A short name for the parameters of a test."""
    return item.stem if isinstance(item, Path) else str(item)
