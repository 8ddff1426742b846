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
        # Python would look through all that is new; these two make it old without a look.
        gc.freeze()
        gc.unfreeze()
        gc.enable()
