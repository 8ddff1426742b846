"""Garbage collection while schemas are compiled."""

from __future__ import annotations

import gc
from collections.abc import Iterator
from contextlib import contextmanager


@contextmanager
def without_garbage_collection() -> Iterator[None]:
    """The model only grows and holds no cycles: looking for garbage would find none."""
    gc.disable()
    try:
        yield
    finally:
        _age()
        gc.enable()


def _age() -> None:
    """Make all that is new old, without the look that Python would take at it."""
    gc.freeze()
    gc.unfreeze()
