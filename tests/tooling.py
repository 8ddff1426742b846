"""Programs that some tests need and that not every machine has."""

from __future__ import annotations

import importlib.util
import os
import shutil

import pytest

STRICT = "PROTOGEN_REQUIRE_TOOLS"
"""Set this environment variable to make a missing tool fail a test instead of skipping it."""


def require_tool(name: str) -> str:
    """Return the path of a program on the PATH; without it, skip the test or fail."""
    found = shutil.which(name)
    if found is None:
        unavailable(f"the program {name} is not installed")
        raise AssertionError
    return found


def require_module(name: str) -> None:
    """Skip the test, or fail, unless the Python module can be imported."""
    if importlib.util.find_spec(name) is None:
        unavailable(f"the Python module {name} is not installed")


def unavailable(reason: str) -> None:
    """Skip the test, or fail where no tool may be missing."""
    if os.environ.get(STRICT):
        pytest.fail(f"{reason}, and {STRICT} is set")
    pytest.skip(reason)
