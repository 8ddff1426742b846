"""Intel HEX, beside intelhex."""

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

from protogen.copying import replace
from protogen.fuzzing.samples import Values
from protogen.fuzzing.trips import Case

ENDS = {"programmer_crlf": "\r\n", "programmer_lf": "\n"}


class IntelHex:
    """intelhex: records by its functions for them, and files of a line or two."""

    def __init__(self) -> None:
        self._module: Any = peer_module("intelhex")

    def frame(self, case: Case) -> bytes:
        return self.line(case, "\r\n")

    def line(self, case: Case, end: str) -> bytes:
        record, values = self._module.Record, case.values
        match case.message:
            case "data":
                text = record.data(case.parts["offset"], list(bytes.fromhex(values["data"])))
            case "end_of_file":
                text = record.eof()
            case "extended_segment_address":
                text = record.extended_segment_address(values["base"])
            case "start_segment_address":
                text = record.start_segment_address(values["cs"], values["ip"])
            case "extended_linear_address":
                text = record.extended_linear_address(values["base"])
            case "start_linear_address":
                text = record.start_linear_address(values["eip"])
        return bytes(text + end, "ascii")

    def values(self, case: Case, frame: bytes) -> Values:
        line = frame.decode("ascii")
        match case.message:
            case "data":
                memory = self._loaded(line)
                start, data = memory.minaddr(), bytes(memory.tobinarray())
                assert (start, memory.maxaddr()) == (case.parts["offset"], start + len(data) - 1)
                return {"data": data.hex()}
            case "end_of_file":  # What follows it is not read.
                assert len(self._loaded(line + line.replace("01FF", "xx"))) == 0
                return {}
            case "extended_segment_address":
                return {"base": self._address_behind(line) // 16}
            case "extended_linear_address":
                return {"base": self._address_behind(line) // 65536}
            case _:
                start_address = self._loaded(line).start_addr
                return {name.lower(): value for name, value in start_address.items()}

    def _address_behind(self, line: str) -> int:
        """Where a byte without an offset comes to lie."""
        byte = self._module.Record.data(0, [1])
        return int(self._loaded(line + byte).minaddr())

    def _loaded(self, text: str) -> Any:
        return self._module.IntelHex(StringIO(text))

    def found(self, endpoint: str, data: bytes) -> Iterator[bytes]:
        """The lines of a file that it can read, each by itself."""
        for line in StringIO(data.decode("latin-1"), newline=""):
            try:
                self._loaded(line)
            except self._module.IntelHexError:
                continue
            yield line.encode("latin-1")


@pytest.fixture(scope="module")
def intelhex() -> IntelHex:
    return IntelHex()


def drawn(sender: str) -> list[Case]:
    """Cases without an offset where there are no data, as intelhex refuses one."""
    cases = [case for case in cases_of("intel_hex", seed=2) if case.sender == sender]
    cases += [case for case in cases_of("intel_hex", seed=3) if case.sender == sender]
    assert len(cases) >= FRAMES
    return [
        case if case.message == "data" else replace(case, parts={"offset": 0}) for case in cases
    ]


def test_both_make_and_read_the_same_records(intelhex: IntelHex) -> None:
    compare_frames("intel_hex", intelhex, drawn("programmer_crlf"))


def test_both_make_and_read_the_same_records_with_ends_of_unix(intelhex: IntelHex) -> None:
    engine = engine_of("intel_hex")
    for case in drawn("programmer_lf"):
        ours = engine.frame(case.sender, case.message, case.values, case.parts)
        assert ours == intelhex.line(case, ENDS[case.sender])
        (event,) = engine.events(case.sender, [ours])
        assert (event.message, event.values) == (case.message, case.values)
        assert intelhex.values(case, ours) == case.values


def test_no_record_is_lost_that_it_finds(intelhex: IntelHex) -> None:
    compare_recovery("intel_hex", "programmer", intelhex, drawn("programmer_crlf"))


def test_small_letters_are_read_by_both(intelhex: IntelHex) -> None:
    engine = engine_of("intel_hex")
    for case in drawn("programmer_lf"):
        small = encoded("intel_hex", case).lower()
        (event,) = engine.events("programmer_crlf", [small])
        assert (event.message, event.values) == (case.message, case.values)
        assert intelhex.values(case, small) == case.values
