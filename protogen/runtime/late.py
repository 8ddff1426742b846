"""What is imported, or made, when it is first needed.

Frames and values that are plainly in order need neither construct nor the machine that cuts frames
byte by byte, and importing them takes longer than all the rest. The names of this module are those
of the reference; with the first use of one, the module that it comes from is imported.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from typing import TYPE_CHECKING, Any, TypeVar, cast

__all__ = [
    "AfterEnd",
    "Anywhere",
    "ArrayRule",
    "Candidate",
    "CounterPart",
    "Cut",
    "Failure",
    "Layout",
    "PayloadError",
    "encode_frame",
    "encode_line",
    "frame_formats",
    "importer",
    "lazily",
    "outermost",
    "payload_of",
    "prefix_size",
    "read_frame",
    "record_from_json",
    "record_from_wire",
    "record_to_json",
    "record_to_wire",
    "record_violations",
    "split_parts",
    "starts_of",
    "whole",
]

AnyT = TypeVar("AnyT")


def importer(namespace: dict[str, Any], names: Mapping[str, Iterable[str]]) -> Callable[[str], Any]:
    """The `__getattr__` of a module that imports names when they are asked for.

    `names` are those of each module that is imported from, which may be a neighbour as in
    `.frame`. What was asked for once is kept in `namespace`.
    """
    homes = {name: home for home, found in names.items() for name in found}

    def get(name: str) -> Any:
        home = homes.get(name)
        if home is None:
            raise AttributeError(f"module {namespace['__name__']!r} has no attribute {name!r}")
        from importlib import import_module

        value = getattr(import_module(home, namespace["__package__"]), name)
        namespace[name] = value
        return value

    return get


class _Lazily:
    """An attribute of a class that is made when it is first read, and then stands in the class."""

    def __init__(self, make: Callable[[], Any]) -> None:
        self._make = make

    def __set_name__(self, owner: type[Any], name: str) -> None:
        # Slots make a class anew: the last one is the one that stays.
        self._owner = owner
        self._name = name

    def __get__(self, instance: object | None, owner: type[Any]) -> Any:
        value = self._make()
        setattr(self._owner, self._name, value)
        return value


def lazily(make: Callable[[], AnyT]) -> AnyT:
    """For the body of a class: an attribute that `make` gives when it is first read."""
    return cast(AnyT, _Lazily(make))


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
        from protogen.runtime.frame_format import FrameFormat

        namespace[name] = made = FrameFormat(sender)
        return made

    return get


if TYPE_CHECKING:
    from protogen.runtime.assembly import encode_frame
    from protogen.runtime.constructs import PayloadError, prefix_size, whole
    from protogen.runtime.frame import AfterEnd, Anywhere, CounterPart
    from protogen.runtime.layout import Layout
    from protogen.runtime.lines import encode_line, split_parts
    from protogen.runtime.machine import Candidate, Cut, Failure
    from protogen.runtime.reading import payload_of, read_frame
    from protogen.runtime.records import (
        ArrayRule,
        outermost,
        record_from_json,
        record_from_wire,
        record_to_json,
        record_to_wire,
        record_violations,
    )
    from protogen.runtime.sender import SenderSpec
    from protogen.runtime.starts import starts_of
else:
    __getattr__ = importer(
        globals(),
        {
            ".assembly": ("encode_frame",),
            ".constructs": ("PayloadError", "prefix_size", "whole"),
            ".frame": ("AfterEnd", "Anywhere", "CounterPart"),
            ".layout": ("Layout",),
            ".lines": ("encode_line", "split_parts"),
            ".machine": ("Candidate", "Cut", "Failure"),
            ".reading": ("payload_of", "read_frame"),
            ".records": (
                "ArrayRule",
                "outermost",
                "record_from_json",
                "record_from_wire",
                "record_to_json",
                "record_to_wire",
                "record_violations",
            ),
            ".starts": ("starts_of",),
        },
    )
