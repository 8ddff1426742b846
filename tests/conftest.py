"""Things that all tests share: the profiles of Hypothesis, the root of the project, tools."""

from __future__ import annotations

import gc
import os
import signal
from collections.abc import Callable, Generator, Iterator
from pathlib import Path

import pytest
import selection
import tooling
from hypothesis import HealthCheck, settings

from protogen.cli import collecting
from protogen.native.compiler import Compiler

# Deadlines measure the machine rather than the code; the CPU is shared with other workers. Whoever
# waits for `make test` gets the few examples of the default, and CI tries more.
settings.register_profile(
    "default", max_examples=15, deadline=None, suppress_health_check=[HealthCheck.too_slow]
)
settings.register_profile(
    "ci", settings.get_profile("default"), max_examples=30, derandomize=True, print_blob=True
)
settings.register_profile("thorough", settings.get_profile("default"), max_examples=5000)
settings.load_profile(os.environ.get("HYPOTHESIS_PROFILE", "default"))

SLOW = (
    "test_c_proof.py",
    "test_c_contracts.py",
    "test_c_bounded.py",
    "test_c_bounded_forms.py",
    "test_schema_fuzzing.py",
    "test_evolution_random.py",
    "test_lower_bounds.py",
    "test_c_schemas.py",
    "test_c_machines.py",
    "test_link_requests.py",
    "test_c_fuzz.py",
    "test_docs.py",
    "test_convert_fleet.py",
    "test_c_lint.py",
    "test_native.py",
    "test_native_parts.py",
    "test_c_decoder.py",
    "test_c_feed.py",
    "test_c_codecs.py",
)
"""The files that take longest. Those of single long tests are first: left for last, a worker would
end long after the others."""


@pytest.hookimpl(tryfirst=True)
def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    """Mark what `make test` leaves out, and begin with what takes long.

    Workers that have nothing left take over what stands last in another's list. Where those are
    short tests, all workers end together.
    """
    selection.mark(items)
    ranks = {name: rank for rank, name in enumerate(SLOW)}
    items.sort(key=lambda item: ranks.get(item.path.name, len(SLOW)))


# Jobs in a shell's background ignore Ctrl-C, and so would the processes that tests interrupt.
signal.signal(signal.SIGINT, signal.default_int_handler)


@pytest.hookimpl(wrapper=True)
def pytest_collection() -> Generator[None, object, object]:
    """Look for no garbage while tests are collected, nor among what that makes.

    It makes hardly any, and millions of objects that stay.
    """
    gc.disable()
    try:
        return (yield)
    finally:
        gc.freeze()
        gc.enable()


@pytest.fixture(scope="session")
def project_root() -> Path:
    """Return the folder that holds `pyproject.toml`."""
    return Path(__file__).resolve().parent.parent


@pytest.fixture(scope="session", autouse=True)
def cache_of_all(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Path]:
    """The folder of caches that all tests share, whichever worker runs them; the user's is left.

    A native decoder takes seconds to compile, and many tests need the same ones. What pip has
    fetched stays where it is.
    """
    folder = tmp_path_factory.getbasetemp()
    if "PYTEST_XDIST_WORKER" in os.environ:
        folder = folder.parent
    users = os.environ.get("XDG_CACHE_HOME") or Path.home() / ".cache"
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("XDG_CACHE_HOME", str(folder / "cache"))
        if "PIP_CACHE_DIR" not in os.environ:
            patch.setenv("PIP_CACHE_DIR", str(Path(users, "pip")))
        if os.environ.get("PYTHONDONTWRITEBYTECODE"):
            # A third of the time that hundreds of commands take would be to compile their modules.
            patch.delenv("PYTHONDONTWRITEBYTECODE")
            patch.setenv("PYTHONPYCACHEPREFIX", str(folder / "cache" / "bytecode"))
        yield folder / "cache"


@pytest.fixture(scope="module", autouse=True)
def settled_objects() -> None:
    """What is there before a file's tests is not looked through for garbage again.

    Compiled schemas stay, with which a full collection of garbage takes seconds.
    """
    gc.collect()
    gc.freeze()


@pytest.fixture(scope="session", autouse=True)
def settled_objects_stay() -> Iterator[None]:
    """Commands that run in this process leave them: to look through them all takes seconds."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(collecting, "_age", lambda: None)
        yield


@pytest.fixture(scope="session", autouse=True)
def quick_libraries() -> Iterator[None]:
    """Libraries for columns and rows are compiled with less optimisation, in half the time.

    Commands that run in a process of their own have them as users do, and so has
    `compiled_as_for_users`.
    """
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(Compiler, "build", _build_quickly)
        yield


_build = Compiler.build


def _build_quickly(compiler: Compiler, source: Path, library: Path) -> None:
    _build(Compiler(compiler.command, (*compiler.flags, "-O0")), source, library)


@pytest.fixture
def compiled_as_for_users(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    """Libraries are compiled anew, with the optimisation that users have."""
    monkeypatch.setattr(Compiler, "build", _build)
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path))


@pytest.fixture(scope="session")
def require_tool() -> Callable[[str], str]:
    """Return the function that finds a program, or skips the test (see `tooling`)."""
    return tooling.require_tool


@pytest.fixture(autouse=settings().derandomize)
def fixed_draws(monkeypatch: pytest.MonkeyPatch) -> None:
    """A seed always draws the same, whatever modules a worker has imported before.

    Hypothesis also draws constants that it finds in the sources of imported modules. Tests that
    count what was drawn ask for this, and all have it where a red run must be one to repeat.
    """
    from hypothesis.internal.conjecture import providers

    if hasattr(providers, "_get_local_constants") and hasattr(providers, "CONSTANTS_CACHE"):
        nothing = providers.Constants()
        monkeypatch.setattr(providers, "_get_local_constants", lambda: nothing)
        monkeypatch.setattr(providers, "CONSTANTS_CACHE", {})
