"""A fixture of pytest that makes simulated devices, which end with the test."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import ExitStack
from typing import TYPE_CHECKING, Any

import pytest

if TYPE_CHECKING:
    from protogen.link.device import SimulatedDevice


@pytest.fixture
def simulated_device() -> Iterator[Callable[..., SimulatedDevice]]:
    """Make a device: `simulated_device("rover.yaml", "board", rates={"state": 50}).port`."""
    from protogen.link.device import SimulatedDevice

    with ExitStack() as stack:

        def made(*args: Any, **settings: Any) -> SimulatedDevice:
            return stack.enter_context(SimulatedDevice(*args, **settings))

        yield made
