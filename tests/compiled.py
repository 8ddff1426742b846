"""The project's schemas and the framings of `tests/framings`, each compiled once in a process."""

from __future__ import annotations

from functools import cache
from pathlib import Path
from types import ModuleType

from protogen.compiler import compile_file
from protogen.live.codec import module_of
from protogen.model.protocol import Protocol, Sender

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


@cache
def covering() -> frozenset[Path]:
    """The documents, and a schema of each way in which frames begin, end and are stuffed.

    What is another program for the same frames, or another way to compile it, is tried on these;
    all schemas are tried in one of the variants.
    """
    found: dict[object, Path] = {}
    for path in SCHEMAS:
        protocol = protocol_of(path)
        for sender in protocol.senders:
            has_forms = len(protocol.forms(sender.endpoint)) > 1
            found.setdefault((has_forms, *_way_of(sender)), path)
    return frozenset({*DOCUMENTS, *found.values()})


def _way_of(sender: Sender) -> tuple[object, ...]:
    plan, code = sender.plan, sender.frame.transparency
    encoding = None if code is None else type(code.encoding)
    told = bool(sender.frame.told)
    return plan.start, plan.end_rule, encoding, plan.takes_whole, plan.streams, told


def senders() -> list[tuple[Path, str]]:
    """Every endpoint that sends, of every schema."""
    return [(path, sender.name) for path in SCHEMAS for sender in protocol_of(path).senders]


def name_of(item: Path | str) -> str:
    """A short name for the parameters of a test."""
    return item.stem if isinstance(item, Path) else str(item)
