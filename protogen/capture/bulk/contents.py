"""What is in frames: all parts before stuffing, but not the end, nor literals in front."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any

from protogen.capture.arrays import numpy
from protogen.capture.bulk.cutting import Span
from protogen.capture.bulk.places import stands
from protogen.model.frame import Base16
from protogen.runtime.transparency import Transparency, TransparencyError
from protogen.targets.python.fast.frames import FastFrame

if TYPE_CHECKING:
    from protogen.capture.tables import Rows

_NO_DIGIT = 0xFF


@dataclass(frozen=True, slots=True)
class Contents:
    """Frames, and where their contents lie in `octets`: first bytes and sizes."""

    frames: Span
    octets: Rows
    at: Rows
    size: Rows

    def only(self, mask: Rows) -> Contents:
        """Those that the mask tells."""
        if mask.all():
            return self
        return Contents(self.frames.only(mask), self.octets, self.at[mask], self.size[mask])


def contents_of(
    frame: FastFrame, transparency: Transparency | None, octets: Rows, frames: Span
) -> Contents:
    """The contents of those frames whose stuffing is an encoder's.

    `transparency` is that of the frame, as the runtime has it.
    """
    first, last = frames.at + frame.skipped, frames.end - len(frame.end)
    if frame.shares:
        # The delimiter in front may be the end of the frame before.
        first = frames.at + frame.skipped * stands(octets, frames.at, frame.start_bytes)
    kept = last - first >= (frame.before - frame.skipped) + frame.behind
    frames, first, last = frames.only(kept), first[kept], last[kept]
    if transparency is None:
        return Contents(frames, octets, first, last - first)
    if frame.replacements is not None:
        return _replaced(frame, octets, frames, first, last)
    alone = frame.before == frame.skipped and not frame.behind
    encoding = frame.sender.frame.transparency
    if alone and encoding is not None and isinstance(encoding.encoding, Base16):
        return _digits(octets, frames, first, last)
    return _one_by_one(frame, replace(transparency, lenient=False), octets, frames, first, last)  # type: ignore[type-var]


# --- bytes that stand for others ------------------------------------------------------------------


def _replaced(frame: FastFrame, octets: Rows, frames: Span, first: Rows, last: Rows) -> Contents:
    """Codes become the bytes that they stand for.

    Every byte that an encoder replaces, or that begins what it writes, has to be in a code, and no
    two codes may overlap: then an encoder makes the same of what they stand for.
    """
    np = numpy()
    assert frame.replacements is not None
    stuffed = first + (frame.before - frame.skipped), last - frame.behind
    inside = _Inside(*stuffed)
    special = np.zeros(256, "?")
    for byte, code in frame.replacements:
        special[[byte[0], code[0]]] = True
    places = np.flatnonzero(special.take(octets))
    places = places[inside.hold(places, 1)]
    if not len(places):
        return Contents(frames, octets, first, last - first)
    plain = octets.copy()
    taken = np.zeros(len(octets), "u1")
    dropped = [places[:0]]
    for byte, code in frame.replacements:
        begun = places[stands(octets, places, code)]
        begun = begun[inside.hold(begun, len(code))]
        plain[begun] = byte[0]
        for index in range(len(code)):
            taken[begun + index] += 1
        dropped += [begun + index for index in range(1, len(code))]
    gone = np.sort(np.concatenate(dropped))
    wrong = np.concatenate([places[taken[places] != 1], gone[taken[gone] != 1]])
    keep = np.ones(len(octets), "?")
    keep[gone] = False
    bounds = first - np.searchsorted(gone, first), last - np.searchsorted(gone, last)
    found = Contents(frames, plain[keep], bounds[0], bounds[1] - bounds[0])
    return found.only(~inside.having(wrong)) if len(wrong) else found


class _Inside:
    """Regions of bytes in ascending order, none in another."""

    def __init__(self, first: Rows, last: Rows) -> None:
        self._first, self._last = first, last

    def _region(self, places: Rows) -> Rows:
        found: Rows = numpy().searchsorted(self._first, places, side="right") - 1
        return found

    def hold(self, places: Rows, size: int) -> Rows:
        """Which of the places have so many bytes in one region."""
        region = self._region(places)
        if not len(self._last):
            return region >= 0
        return (region >= 0) & (places + size <= self._last[region])

    def having(self, places: Rows) -> Rows:
        """In which regions any of these places, which all are in one, lies."""
        found = numpy().zeros(len(self._first), "?")
        found[self._region(places)] = True
        return found  # type: ignore[no-any-return]


# --- hexadecimal digits ---------------------------------------------------------------------------


def _digits(octets: Rows, frames: Span, first: Rows, last: Rows) -> Contents:
    """Two upper-case digits a byte."""
    np = numpy()
    even = (last - first) % 2 == 0
    frames, first, size = frames.only(even), first[even], (last - first)[even] // 2
    values = np.full(256, _NO_DIGIT, "u1")
    values[np.frombuffer(b"0123456789ABCDEF", "u1")] = np.arange(16)
    at = np.cumsum(size) - size
    places = np.repeat(first - 2 * at, size) + 2 * np.arange(int(size.sum()))
    high, low = values[octets[places]], values[octets[places + 1]]
    plain = high << 4 | low & 0xF
    wrong = np.flatnonzero((high == _NO_DIGIT) | (low == _NO_DIGIT))
    found = Contents(frames, plain, at, size)
    if not len(wrong):
        return found
    mask = np.ones(len(at), "?")
    mask[np.searchsorted(at, wrong, side="right") - 1] = False
    return found.only(mask)


# --- anything else --------------------------------------------------------------------------------


def _one_by_one(
    frame: FastFrame, strict: Transparency, octets: Rows, frames: Span, first: Rows, last: Rows
) -> Contents:
    """Frame by frame, as the decoder does it."""
    data, before = octets.tobytes(), frame.before - frame.skipped
    pieces: list[bytes] = []
    kept = []
    for low, high in zip(first.tolist(), last.tolist(), strict=True):
        try:
            region = strict.decode(data[low + before : high - frame.behind])
        except TransparencyError:
            kept.append(False)
            continue
        kept.append(True)
        pieces.append(data[low : low + before] + region + data[high - frame.behind : high])
    np: Any = numpy()
    size = np.array([len(piece) for piece in pieces], "i8")
    plain = np.frombuffer(b"".join(pieces), "u1")
    return Contents(frames.only(np.array(kept, "?")), plain, np.cumsum(size) - size, size)
