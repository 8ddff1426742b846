"""AX.25 with control fields of 16 bits in KISS, beside pyham-ax25 in pyham-kiss.

pyham-ax25 knows control fields of 8 bits. The second byte is put behind the first one here, and
taken out again, by the figures of the document.
"""

from __future__ import annotations

from random import Random

import pytest
from library_support import cases_of, compare_frames, compare_recovery, engine_of
from test_library_ax25 import SUPERVISORY, UNNUMBERED, PyhamAx25, as_heard
from test_library_kiss import FEND

from protogen.copying import replace
from protogen.fuzzing.samples import Values
from protogen.fuzzing.trips import Case

PEER = "pyham_ax25"


def is_long(control: int) -> bool:
    """True if a second byte follows: of all frames but unnumbered ones."""
    return control & 3 != 3


class PyhamAx25Long(PyhamAx25):
    """Packets of pyham-ax25 with a second byte of control."""

    def _packet(self, values: Values) -> bytes:
        control, place = values["control"], 7 * len(values["path"])
        short = control & (0x0F if control & 1 else 0x00) if is_long(control) else control
        packet = super()._packet({**values, "control": short})
        field = bytes([control, values["number"]] if is_long(control) else [control])
        return packet[:place] + field + packet[place + 1 :]

    def _values(self, packet: bytes) -> Values:
        place = 7
        while not packet[place - 1] & 1:
            place += 7
        control, number = packet[place], None
        if is_long(control):
            number = packet[place + 1]
            short = control & (0x0F if control & 1 else 0x00)
            packet = packet[:place] + bytes([short]) + packet[place + 2 :]
        values = super()._values(packet)
        return {**values, "control": control, "number": number}


@pytest.fixture(scope="module")
def pyham_ax25() -> PyhamAx25Long:
    return PyhamAx25Long()


def drawn() -> list[Case]:
    """Packets that it can make, but not from port 12: see the decision of `kiss`."""
    dice = Random("ax25_128")
    cases = [case for case in cases_of("ax25_128", ["data"]) if case.parts["port"] != 12]
    return [replace(case, values=_as_heard(case.values, dice)) for case in cases]


def _as_heard(values: Values, dice: Random) -> Values:
    heard = as_heard(values, dice)
    control = heard["control"]
    if control & 3 == 1:
        control &= 0x0F
    number = None
    if is_long(control):
        number = dice.randrange(256) if values["number"] is None else values["number"]
    return {**heard, "control": control, "number": number}


def test_both_make_and_read_the_same_packets(pyham_ax25: PyhamAx25Long) -> None:
    cases = drawn()
    kinds = {case.values["control"] & ~0x10 for case in cases}
    assert kinds >= {*UNNUMBERED, *SUPERVISORY}
    sent = {case.values["control"] >> 1 for case in cases if not case.values["control"] & 1}
    assert max(sent) > 120
    assert {case.values["number"] for case in cases} >= {None, 0x00, 0xFF}
    compare_frames("ax25_128", pyham_ax25, cases)


@pytest.mark.parametrize("endpoint", ["host", "tnc"])
def test_no_packet_is_lost_that_it_finds(pyham_ax25: PyhamAx25Long, endpoint: str) -> None:
    compare_recovery("ax25_128", endpoint, pyham_ax25, drawn(), shared=FEND)


def test_a_supervisory_frame_without_its_number_is_no_packet() -> None:
    path = "82 84 86 88 8A 8C 60 82 84 86 88 8A 8C 61"
    frames = [bytes.fromhex(f"C0 00 {path} {rest} C0") for rest in ("01 9B", "01", "7F")]
    kinds = [next(iter(engine_of("ax25_128").events("tnc", [frame], {}))).kind for frame in frames]
    assert kinds == ["message", "invalid", "message"]
