"""Pieces of a generated `FORMAT`, and frames as construct declarations, when first used.

The pieces are those of `constructs`, which needs construct.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from protogen.runtime.constructs import *  # noqa: F403 - its `__all__` says which
    from protogen.runtime.constructs import Struct
    from protogen.runtime.framing.sender import SenderSpec


def empty() -> Struct:
    """The format of a struct without fields."""
    from protogen.runtime import constructs

    return constructs.Struct()


def frame_formats(
    namespace: dict[str, Any], **senders: SenderSpec[Any, Any]
) -> Callable[[str], Any]:
    """The `__getattr__` of a generated module: frames as construct declarations, by their names."""
    for name in senders:
        namespace.pop(name, None)  # What a module made before it was loaded again is outdated.

    def get(name: str) -> Any:
        sender = senders.get(name)
        if sender is None:
            raise AttributeError(f"module {namespace['__name__']!r} has no attribute {name!r}")
        from protogen.runtime.framing.frame_format import FrameFormat

        namespace[name] = made = FrameFormat(sender)
        return made

    return get


if not TYPE_CHECKING:

    def __getattr__(name: str) -> Any:
        if name.startswith("__"):
            raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
        from protogen.runtime import constructs

        globals()[name] = value = getattr(constructs, name)
        return value
