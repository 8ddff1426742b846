"""Tests ask whether a tool works, not whether it is there."""

from __future__ import annotations

from pathlib import Path

import pytest
import tooling
from fuzz.harness import require_fuzzer

Skipped = pytest.skip.Exception
Failed = pytest.fail.Exception


@pytest.fixture(autouse=True)
def alone(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """No program but those of a test, and no variable that makes what is missing a failure."""
    monkeypatch.setenv("PATH", str(tmp_path))
    monkeypatch.delenv(tooling.STRICT, raising=False)


def install(folder: Path, name: str, script: str) -> Path:
    program = folder / name
    program.write_text(f"#!/bin/sh\n{script}\n")
    program.chmod(0o755)
    return program


def test_a_missing_program_skips(tmp_path: Path) -> None:
    with pytest.raises(Skipped, match="clang is not installed"):
        tooling.require_tool("clang")


def test_a_missing_program_fails_where_none_may_be_missing(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv(tooling.STRICT, "1")
    with pytest.raises(Failed, match="clang is not installed"):
        tooling.require_tool("clang")


def test_a_compiler_without_headers_skips(tmp_path: Path) -> None:
    install(tmp_path, "avr-gcc", "echo 'no <stdint.h>'; exit 1")
    with pytest.raises(Skipped, match=r"does not work: no <stdint\.h>"):
        tooling.require_tool("avr-gcc")


def test_a_compiler_without_the_runtime_of_its_sanitizers_skips(tmp_path: Path) -> None:
    broken = 'case "$*" in *-fsanitize*) echo no runtime; exit 1;; esac'
    makes = """printf '#!/bin/sh\\n' > "$3"; /bin/chmod +x "$3\""""
    install(tmp_path, "clang", f"{broken}\n{makes}")
    assert tooling.require_tool("clang") == str(tmp_path / "clang")
    with pytest.raises(Skipped, match="no runtime"):
        tooling.require_compiler("clang", "-fsanitize=address,undefined")
    with pytest.raises(Skipped, match="no runtime"):
        require_fuzzer()


def test_a_program_that_does_not_start_skips(tmp_path: Path) -> None:
    install(tmp_path, "frama-c", "echo no share folder; exit 2")
    with pytest.raises(Skipped, match="no share folder"):
        tooling.require_tool("frama-c")
