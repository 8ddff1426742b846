"""Compiles schemas for tests of the passes, from a text or from the repository."""

from __future__ import annotations

import tempfile
from collections.abc import Sequence
from pathlib import Path

from protogen.compiler import Compilation, compile_file
from protogen.model.framing import Framing, MessageFraming
from protogen.model.protocol import Protocol

SCHEMAS = Path(__file__).resolve().parent.parent / "schemas"

HEAD = """\
protocol: demo
endpoints: {host: Host, robot: Robot}
byte_order: little
"""


def compile_text(text: str, *, examples: bool = False) -> Compilation:
    """Compile a schema that stands in no file."""
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "schema.yaml"
        path.write_text(text, encoding="utf-8")
        return compile_file(path, examples=examples)


def protocol_of(text: str) -> Protocol:
    """The protocol of a schema without problems."""
    compiled = compile_text(text)
    assert compiled.problems == ()
    assert compiled.protocol is not None
    return compiled.protocol


def written(path: Path, text: str) -> Protocol:
    """The protocol of a schema that is put into a file, where tools find it."""
    path.write_text(text, encoding="utf-8")
    found = compile_file(path)
    assert found.protocol is not None, [item.message for item in found.problems]
    return found.protocol


def repository_protocol(name: str) -> Protocol:
    """The protocol of one of the repository's schemas."""
    compiled = compile_file(SCHEMAS / f"{name}.yaml")
    assert compiled.protocol is not None, compiled.problems
    return compiled.protocol


def framing_of(text: str) -> Framing:
    """The framing of the only sender of a schema."""
    (sender,) = protocol_of(text).senders
    return sender.framing


def message_framing(framing: Framing, name: str) -> MessageFraming:
    """The sizes and the rate of one message."""
    return next(item for item in framing.messages if item.message == name)


def codes_of(compiled: Compilation) -> Sequence[str]:
    """The codes of all problems, in order of place."""
    return [problem.code for problem in compiled.problems]
