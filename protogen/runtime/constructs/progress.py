"""Sizes of what is still coming in, read step by step."""

from __future__ import annotations

import io
from collections.abc import Callable, Mapping
from typing import Any, BinaryIO

from construct import Construct  # type: ignore[import-untyped,unused-ignore]

from protogen.runtime.constructs.pieces import PayloadError

_KEY = "_progress"
"""The parameter of a parse that keeps its progress; no field is called so."""


class _Progress:
    """The elements that arrays have so far, by the arrays' paths, and where the next one begins."""

    def __init__(self) -> None:
        self._kept: dict[str, tuple[list[Any], int]] = {}

    def resume(self, stream: BinaryIO, path: str) -> list[Any]:
        """The elements that were kept; the stream goes on behind them."""
        if path not in self._kept:
            return []
        elements, offset = self._kept.pop(path)
        stream.seek(offset)
        return elements

    def keep(self, path: str, elements: list[Any], offset: int) -> None:
        """Keep the elements in front of one that has not come in as a whole."""
        self._kept[path] = elements, offset


def read_elements(
    element: Construct,
    stream: BinaryIO,
    context: Any,
    path: str,
    goes_on: Callable[[list[Any]], bool],
) -> list[Any]:
    """The elements of an array, which has another one wherever `goes_on` holds.

    Where bytes are missing, the next attempt of a `Measurer` goes on with the elements so far.
    """
    progress: _Progress | None = context._params.get(_KEY)
    elements = [] if progress is None else progress.resume(stream, path)
    offset = stream.tell()
    try:
        while goes_on(elements):
            offset = stream.tell()
            place = f"{path} -> [{len(elements)}]"
            elements.append(element._parsereport(stream, context, place))
    except PayloadError as error:
        if progress is not None and error.missing:
            progress.keep(path, elements, offset)
        raise
    return elements


class Measurer:
    """The size of what begins as a format says, and whose bytes come in by and by.

    Each attempt goes on in the arrays where the one before ended. So the time is in proportion to
    the bytes. Of no use after its verdict.
    """

    def __init__(self, format: Construct, held: Mapping[str, int]) -> None:
        """`held` has the numbers of the frame among the format's fields."""
        self._format = format
        self._held = held
        self._stream = io.BytesIO()
        self._progress = _Progress()
        self.taken = 0
        """Bytes that came in."""

    def take(self, data: bytes) -> int:
        """The number of bytes, of all that came in, that the format takes.

        Raises PayloadError; its `missing` is greater than 0 where it is a good start but too short.
        """
        self._stream.seek(self.taken)
        self.taken += self._stream.write(data)
        self._stream.seek(0)
        self._format.parse_stream(self._stream, **{**self._held, _KEY: self._progress})
        return self._stream.tell()
