"""The lower bounds of the dependencies are true: the oldest versions allowed do the work."""

from __future__ import annotations

import os
import subprocess
import sys
import tomllib
import venv
from pathlib import Path

import pytest
from tooling import unavailable

from protogen.api import load

ROOT = Path(__file__).parent.parent


def oldest() -> list[str]:
    """Each dependency at its lower bound."""
    project = tomllib.loads((ROOT / "pyproject.toml").read_text("utf-8"))["project"]
    return [requirement.replace(">=", "==") for requirement in project["dependencies"]]


@pytest.fixture(scope="module")
def python(tmp_path_factory):
    """An environment with only the oldest dependencies."""
    folder = tmp_path_factory.mktemp("oldest")
    venv.create(folder, with_pip=True)
    python = folder / "bin" / "python"
    installed = subprocess.run(
        [python, "-m", "pip", "install", "--quiet", *oldest()],
        capture_output=True,
        text=True,
        check=False,
    )
    if installed.returncode:
        unavailable(f"the oldest packages can't be installed here: {installed.stderr}")
    return python


def run(python: Path, *arguments: str) -> subprocess.CompletedProcess[str]:
    return subprocess.run(
        [python, "-m", "protogen", *arguments],
        cwd=ROOT,
        env={**os.environ, "PYTHONPATH": str(ROOT)},
        capture_output=True,
        text=True,
        check=False,
    )


def test_every_dependency_has_a_lower_bound():
    assert all("==" in requirement for requirement in oldest())


@pytest.mark.parametrize(
    "arguments",
    [
        ("check", "schemas", "--quiet"),
        ("generate", "--check"),
        ("schema-json", "--check"),
        ("decode", "schemas/matty.yaml", "--sender", "pc", "--hex", "55 02 01 53 AA"),
        ("encode", "schemas/rn1.yaml", "move_manual", "speed=1", "arc=-1"),
        ("explain", "schemas/rn1.yaml", "--sender", "host", "--hex", "80 01 7F FF"),
        ("fuzz", "schemas/uherobot.yaml", "--examples", "5"),
    ],
    ids=lambda arguments: arguments[0],
)
def test_the_oldest_versions_do_the_work(python, arguments):
    result = run(python, *arguments)
    assert result.returncode == 0, result.stdout + result.stderr


def test_the_newest_versions_do_the_work():
    assert load(ROOT / "schemas" / "rn1.yaml").name == "rn1"
    assert sys.version_info >= (3, 11)
