"""The lower bounds of the dependencies are true: the oldest versions allowed do the work."""

from __future__ import annotations

import os
import subprocess
import sys
import tomllib
import venv
from pathlib import Path

import pytest
from test_ci import IDS, prepared
from tooling import unavailable

from protogen.api import load

ROOT = Path(__file__).parent.parent


PROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text("utf-8"))["project"]
DEV = PROJECT["optional-dependencies"]["dev"]
TOOLS = ("pytest>", "hypothesis>")
EXTRAS = ("capture", "parquet", "mcap", "dask")
"""Those that `protogen convert` needs."""
LIVE = ("serial", "monitor", "foxglove")
"""Those that commands on a line need."""


def oldest(*extras: str) -> list[str]:
    """Each dependency at its lower bound, and those of these extras."""
    optional = [
        requirement
        for extra in extras
        for requirement in PROJECT["optional-dependencies"][extra]
        if not requirement.startswith("protogen-serial[")  # they are among these extras
    ]
    return [item.replace(">=", "==") for item in [*PROJECT["dependencies"], *optional]]


@pytest.fixture(scope="module")
def python(tmp_path_factory):
    """An environment with only the oldest dependencies."""
    return environment(tmp_path_factory.mktemp("oldest"), oldest())


@pytest.fixture(scope="module")
def converting(tmp_path_factory):
    """An environment with the oldest dependencies of the extras, too, and what tests need."""
    requirements = [*oldest(*EXTRAS), *(item for item in DEV if item.startswith(TOOLS))]
    return environment(tmp_path_factory.mktemp("converting"), requirements)


def environment(folder: Path, requirements: list[str]) -> Path:
    """The Python of a new environment with these packages.

    They are put there by our own pip, and only compiled where they are imported: to install pip,
    and to compile all that the packages bring along, takes longer than all else.
    """
    venv.create(folder, with_pip=False)
    python = folder / "bin" / "python"
    pip = [sys.executable, "-m", "pip", "--python", str(python), "--disable-pip-version-check"]
    installed = subprocess.run(
        [*pip, "install", "--quiet", "--no-compile", *requirements],
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
    assert all("==" in requirement for requirement in oldest(*EXTRAS, *LIVE))


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


def test_the_oldest_pre_commit_runs_the_hooks(tmp_path):
    (bound,) = [item for item in DEV if "pre-commit" in item]
    python = environment(tmp_path / "oldest", [bound.replace(">=", "==")])
    scratch = prepared(tmp_path / "work", str(python))
    done = scratch.pre_commit("run", "--all-files")
    assert done.returncode == 0, done.stdout + done.stderr
    assert done.stdout.count("Passed") == len(IDS)
    scratch.schema.write_text(scratch.schema.read_text().replace("scale: 1/100", "scale: 1/10"))
    assert scratch.pre_commit("run", "protogen-generate-check").returncode == 1


def test_the_oldest_versions_of_the_extras_do_the_work(converting, tmp_path):
    (tmp_path / "run.bin").write_bytes(bytes.fromhex("55 02 01 41 BC") * 3)
    arguments = ["convert", "schemas/matty.yaml", "--sender", "esp", str(tmp_path / "run.bin")]
    formats = ["csv", "arrow", "mcap", "mcap-ros2", "parquet", "parquet --dask --workers 1"]
    for number, to in enumerate(formats):
        output = str(tmp_path / str(number))
        result = run(converting, *arguments, "-o", output, "--to", *to.split())
        assert result.returncode == 0, result.stdout + result.stderr
        assert any(name == "ack" for name, *_ in map(str.split, result.stdout.splitlines()[1:]))


def test_the_oldest_dask_goes_on_where_a_worker_is_killed(converting):
    name = "test_a_worker_that_is_killed_loses_and_doubles_nothing"
    options = ["-o", "addopts=", "-p", "no:cacheprovider"]
    result = subprocess.run(
        [converting, "-m", "pytest", *options, f"tests/test_convert_fleet.py::{name}"],
        cwd=ROOT,
        env={**os.environ, "PYTHONPATH": str(ROOT)},
        capture_output=True,
        text=True,
        timeout=500,  # It waited for ever with those that are too old.
        check=False,
    )
    assert result.returncode == 0, result.stdout + result.stderr
    assert "1 passed" in result.stdout


def test_the_newest_versions_do_the_work():
    assert load(ROOT / "schemas" / "rn1.yaml").name == "rn1"
    assert sys.version_info >= (3, 11)


def test_the_oldest_versions_of_the_extras_of_a_line_do_the_work(tmp_path):
    """The tests that need no more than these: ports, the full screen, a server."""
    tools = [item for item in DEV if item.startswith(("pytest>", "pytest-timeout>"))]
    clients = [item.replace(">=", "==") for item in DEV if item.startswith("websockets")]
    # textual needs a newer rich than we do, and says so itself.
    needed = [item for item in oldest(*LIVE) if not item.startswith("rich=")]
    python = environment(tmp_path / "oldest", [*needed, *tools, *clients])
    result = subprocess.run(
        [
            *(python, "-m", "pytest", "-o", "addopts=", "-p", "no:cacheprovider", "--noconftest"),
            *("tests/test_link_ports.py", "tests/test_monitor.py", "-k", "not terminal"),
        ],
        cwd=ROOT,
        env={**os.environ, "PYTHONPATH": f"{ROOT}:{ROOT / 'tests'}"},
        capture_output=True,
        text=True,
        check=False,
    )
    assert result.returncode == 0, result.stdout + result.stderr
