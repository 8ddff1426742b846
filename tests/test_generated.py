"""The checked-in output is what the compiler prints, and the schemas hold."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import pytest

from protogen.compiler import compile_file
from protogen.targets import TARGETS

ROOT = Path(__file__).parent.parent
SCHEMAS = sorted((ROOT / "schemas").rglob("*.yaml"))


def protogen(*arguments: str) -> subprocess.CompletedProcess[str]:
    return subprocess.run(
        [sys.executable, "-m", "protogen", *arguments],
        cwd=ROOT,
        capture_output=True,
        text=True,
        check=False,
    )


def test_generated_files_are_current():
    targets = [word for target in TARGETS for word in ("--target", target)]
    result = protogen("generate", "--check", *targets)
    assert result.returncode == 0, result.stdout + result.stderr


def test_the_schemas_are_clean():
    result = protogen("check", "schemas", "--quiet")
    assert result.returncode == 0, result.stdout + result.stderr


def test_the_schemas_are_in_the_canonical_layout():
    result = protogen("fmt", "schemas", "--check")
    assert result.returncode == 0, result.stdout + result.stderr


@pytest.mark.parametrize("path", SCHEMAS, ids=lambda path: path.stem)
def test_examples_hold_and_nothing_is_reported(path):
    compilation = compile_file(path, examples=True)
    assert compilation.problems == ()
    assert compilation.protocol is not None


@pytest.mark.parametrize("path", SCHEMAS, ids=lambda path: path.stem)
def test_messages_and_fields_say_where_they_are_written(path):
    protocol = compile_file(path).protocol
    for message in protocol.messages:
        assert message.about.source is not None, message.name
        for field in message.fields:
            if not message.unspecified:
                assert field.about.source is not None, f"{message.name}.{field.name}"


def test_errors_are_names_of_the_module() -> None:
    from generated.python import rn1

    with pytest.raises(rn1.DecodeError, match="noise"):
        rn1.decode(b"\x00", sender="host")
    assert issubclass(rn1.EncodeError, ValueError)
