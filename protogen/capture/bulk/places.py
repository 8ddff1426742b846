"""Places in bytes, found all at once. Places are numbers in ascending order."""

from __future__ import annotations

from typing import TYPE_CHECKING

from protogen.capture.arrays import numpy

if TYPE_CHECKING:
    from protogen.capture.tables import Rows


def literal_places(octets: Rows, literal: bytes) -> Rows:
    """Where the literal stands."""
    found: Rows = numpy().flatnonzero(octets == literal[0])
    return found if len(literal) == 1 else found[stands(octets, found, literal)]


def stands(octets: Rows, places: Rows, literal: bytes) -> Rows:
    """At which of the places the literal stands, as a mask."""
    fits = (places >= 0) & (places <= len(octets) - len(literal))
    at = numpy().where(fits, places, 0)
    for index, byte in enumerate(literal):
        fits &= octets.take(at + index, mode="clip") == byte
    return fits


def set_places(octets: Rows, least: int, greatest: int) -> Rows:
    """Where bytes from `least` to `greatest` stand."""
    # What lies below wraps around.
    found: Rows = numpy().flatnonzero(octets - numpy().uint8(least) <= greatest - least)
    return found


def next_from(places: Rows, bounds: Rows, none: int) -> Rows:
    """The first place that is not in front of each bound; `none` where there is none."""
    if not len(places):
        return numpy().full(len(bounds), none)  # type: ignore[no-any-return]
    index = numpy().searchsorted(places, bounds)
    found: Rows = numpy().where(index < len(places), places.take(index, mode="clip"), none)
    return found


def overlaps_itself(literal: bytes) -> bool:
    """Whether two places of the literal may have bytes in common."""
    return any(literal.endswith(literal[:size]) for size in range(1, len(literal)))


def windows(octets: Rows, places: Rows, size: int) -> Rows:
    """So many bytes from each place on: a row for each."""
    if not size or not len(places):
        return numpy().zeros((len(places), size), "u1")  # type: ignore[no-any-return]
    every = numpy().ndarray((len(octets) - size + 1,), f"V{size}", octets, strides=(1,))
    found: Rows = every[places].view("u1").reshape(len(places), size)
    return found
