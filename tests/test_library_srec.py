"""Motorola S-records, beside bincopy."""

from __future__ import annotations

from collections.abc import Iterator
from io import StringIO
from typing import Any

import pytest
from library_support import (
    FRAMES,
    cases_of,
    compare_frames,
    compare_recovery,
    encoded,
    engine_of,
    peer_module,
)

from protogen.fuzzing.samples import Values
from protogen.fuzzing.trips import Case

KINDS = "header data_16 data_24 data_32 reserved count_16 count_24 start_32 start_24 start_16"
TYPES = {message: str(number) for number, message in enumerate(KINDS.split())}


class Bincopy:
    """bincopy: single records, and files of a line."""

    def __init__(self) -> None:
        self._module: Any = peer_module("bincopy")

    def frame(self, case: Case) -> bytes:
        return self.line(case, "\r\n")

    def line(self, case: Case, end: str) -> bytes:
        values = case.values
        data = bytes.fromhex(values.get("data", ""))
        number = values.get("address", values.get("records"))
        record = self._module.pack_srec(TYPES[case.message], number, len(data), data)
        return bytes(record + end, "ascii")

    def values(self, case: Case, frame: bytes) -> Values:
        line = frame.decode("ascii")
        kind, number, size, data = self._module.unpack_srec(line.strip())
        assert (kind, size) == (TYPES[case.message], len(data))
        self._compare_image(line, kind, number, data)
        if "records" in case.values:
            assert size == 0
            return {"records": number}
        values = {"address": number, "data": data.hex()}
        return {name: values[name] for name in case.values}

    def _compare_image(self, line: str, kind: str, number: int, data: bytes) -> None:
        """In a file, the record means the same."""
        image = self._module.BinFile()
        image.add_srec(line)
        if kind == "0":
            assert image._header == data
        elif kind in "123":
            pieces = [(segment.address, segment.data) for segment in image.segments]
            assert pieces == [(number, data)]
        elif kind in "789":
            assert image.execution_start_address == number

    def found(self, endpoint: str, data: bytes) -> Iterator[bytes]:
        """The lines of a file that it can read, each by itself."""
        for line in StringIO(data.decode("latin-1"), newline=""):
            try:
                self._module.unpack_srec(line.strip())
            except (self._module.Error, ValueError, IndexError):
                continue
            yield line.encode("latin-1")


@pytest.fixture(scope="module")
def bincopy() -> Bincopy:
    return Bincopy()


def drawn(form: str) -> list[Case]:
    cases = [case for seed in (2, 3) for case in cases_of("srec", seed=seed)]
    cases = [case for case in cases if case.sender == f"programmer_{form}"]
    assert len(cases) >= FRAMES
    return cases


def test_both_make_and_read_the_same_records(bincopy: Bincopy) -> None:
    compare_frames("srec", bincopy, drawn("crlf"))


def test_both_make_and_read_the_same_records_with_ends_of_unix(bincopy: Bincopy) -> None:
    engine = engine_of("srec")
    for case in drawn("lf"):
        ours = engine.frame(case.sender, case.message, case.values, case.parts)
        assert ours == bincopy.line(case, "\n")
        (event,) = engine.events(case.sender, [ours])
        assert (event.message, event.values) == (case.message, case.values)
        assert bincopy.values(case, ours) == case.values


def test_no_record_is_lost_that_it_finds(bincopy: Bincopy) -> None:
    compare_recovery("srec", "programmer", bincopy, drawn("crlf"))


def test_small_letters_are_read_by_both(bincopy: Bincopy) -> None:
    engine = engine_of("srec")
    for case in drawn("lf"):
        ours = encoded("srec", case)
        small = ours[:1] + ours[1:].lower()
        (event,) = engine.events("programmer_crlf", [small])
        assert (event.message, event.values) == (case.message, case.values)
        assert bincopy.values(case, small) == case.values
