"""The pieces that a generated `FORMAT` is made of, imported when the first of them is used.

They are those of `constructs`, which needs construct.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from protogen.runtime.constructs import *  # noqa: F403 - its `__all__` says which
    from protogen.runtime.constructs import Struct


def empty() -> Struct:
    """The format of a struct without fields."""
    from protogen.runtime import constructs

    return constructs.Struct()


if not TYPE_CHECKING:

    def __getattr__(name: str) -> Any:
        if name.startswith("__"):
            raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
        from protogen.runtime import constructs

        globals()[name] = value = getattr(constructs, name)
        return value
