"""NMEA 0183, beside pynmeagps."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from datetime import date, time
from io import BytesIO
from typing import Any

import pytest
from library_support import cases_of, compare_frames, compare_recovery, peer_module

from protogen.copying import replace
from protogen.fuzzing.samples import Values
from protogen.fuzzing.trips import Case

TALKERS = ("GP", "GN", "GA", "GL", "GB")
FRACTIONS = {
    "hdop": (2, 2), "pdop": (2, 2), "vdop": (2, 2), "altitude": (5, 3), "separation": (3, 3),
    "age": (4, 1), "course": (3, 3), "variation": (3, 3), "magnetic_course": (3, 3),
    "speed": (4, 3), "speed_in_knots": (4, 3),
}  # fmt: skip
"""Digits in front of the point at most, and behind it."""
INTEGERS = {
    "gga.quality": (1, 1), "gga.satellites": (2, 2), "gga.station": (4, 4), "gsa.fix": (1, 1),
    "gsa.satellites": (2, 3), "gsv.sentences": (1, 1), "gsv.number": (1, 1), "gsv.in_view": (2, 2),
    "gsv.satellites.number": (2, 3), "gsv.satellites.elevation": (2, 2),
    "gsv.satellites.azimuth": (3, 3), "gsv.satellites.signal": (2, 2), "zda.day": (2, 2),
    "zda.month": (2, 2), "zda.year": (4, 4), "zda.zone_hours": (2, 2), "zda.zone_minutes": (2, 2),
}  # fmt: skip
"""Digits at least and at most."""
TIME, DATE, LATITUDE, LONGITUDE = 10**8, 10**6, 10**9, 10**10
"""What stands for no text: the least number that has too many digits."""


class Receiver:
    """What pynmeagps knows of sentences."""

    def __init__(self) -> None:
        self._module: Any = peer_module("pynmeagps")

    def frame(self, case: Case) -> bytes:
        texts: list[str] = []
        refilled(case, lambda path, value: texts.append(self._text(path, value)))
        talker, name = case.parts["talker"], case.message.upper()
        made = self._module.NMEAMessage(talker, name, self._module.GET, payload=texts)
        frame: bytes = made.serialize()
        return frame

    def _text(self, path: str, value: int) -> str:
        """The text of a value: positions, times and dates are written by pynmeagps."""
        name = path.rpartition(".")[2]
        if name == "system":
            return f"{value:X}" if value <= 0xF else ""
        if name in FRACTIONS:
            front, behind = FRACTIONS[name]
            is_there = value != 10 ** (front + behind)
            return f"{value / 10**behind:.{behind}f}" if is_there else ""
        if path in INTEGERS:
            least, most = INTEGERS[path]
            return "" if value == 10**most else f"{'-' * (value < 0)}{abs(value):0{least}}"
        kinds = {"time": "TM", "date": "DT", "latitude": "LA", "longitude": "LN"}
        if name in kinds:
            typed = typed_of(name, value)
            text: str = self._module.NMEAMessage.val2str(typed, kinds[name])
            return text
        return chr(value) if value else ""

    def values(self, case: Case, frame: bytes) -> Values:
        parsed = self._module.NMEAReader.parse(frame)
        assert (parsed.talker, parsed.msgID) == (case.parts["talker"], case.message.upper())
        read = (value for name, value in vars(parsed).items() if not name.startswith("_"))
        found = refilled(case, lambda path, _: raw_of(path, next(read)))
        assert next(read, None) is None
        return found

    def found(self, endpoint: str, data: bytes) -> Iterator[bytes]:
        assert endpoint == "receiver"
        for raw, parsed in self._module.NMEAReader(BytesIO(data), quitonerror=0):
            if parsed is not None:
                yield raw


def typed_of(name: str, value: int) -> Any:
    """A time, a date, or degrees; nothing where there is no text."""
    match name:
        case "time" if value != TIME:
            hours, minutes, seconds = value // 10**6, value // 10**4 % 100, value % 10**4
            return time(hours, minutes, seconds // 100, seconds % 100 * 10**4)
        case "date" if value != DATE:
            year = value % 100
            return date((2000 if year < 69 else 1900) + year, value // 100 % 100, value // 10**4)
        case "latitude" | "longitude" if value not in (LATITUDE, LONGITUDE):
            return value // 10**7 + value % 10**7 / 10**5 / 60
    return ""


def raw_of(path: str, value: Any) -> int:
    """The raw number of what pynmeagps reads."""
    name = path.rpartition(".")[2]
    if name == "system":
        return int(value or "10", 16)
    if name in FRACTIONS:
        front, behind = FRACTIONS[name]
        return int(10 ** (front + behind)) if value == "" else round(value * 10**behind)
    if path in INTEGERS:
        return int(10 ** INTEGERS[path][1]) if value == "" else int(value)
    match name:
        case "time":
            return TIME if value == "" else int(value.strftime("%H%M%S%f")[:8])
        case "date":
            return DATE if value == "" else int(value.strftime("%d%m%y"))
        case "latitude" | "longitude":
            if value == "":
                return LATITUDE if name == "latitude" else LONGITUDE
            units: int = round(abs(value) * 60 * 10**5)
            return units // (60 * 10**5) * 10**7 + units % (60 * 10**5)
    return ord(value) if value else 0


def refilled(case: Case, value_of: Callable[[str, int], Any]) -> Values:
    """The values with others in their places, by the path of each; those left out stay so."""
    made: Values = {}
    for name, value in case.values.items():
        path = f"{case.message}.{name}"
        if isinstance(value, list):
            made[name] = [
                {inner: value_of(f"{path}.{inner}", it) for inner, it in item.items()}
                if isinstance(item, dict)
                else value_of(path, item)
                for item in value
            ]
        else:
            made[name] = None if value is None else value_of(path, value)
    return made


def known(case: Case) -> Case:
    """The case with a talker of satellites, and times, dates and minutes that there are."""
    place = sum(map(ord, str(case.values))) % len(TALKERS)
    return replace(case, parts={"talker": TALKERS[place]}, values=refilled(case, _that_is))


def _that_is(path: str, value: int) -> int:
    match path.rpartition(".")[2]:
        case "time" if value != TIME:
            return value // 10**6 * 10**6 + value // 10**4 % 60 * 10**4 + value % 6000
        case "date" if value != DATE:
            day, month = value // 10**4 % 28 + 1, value // 100 % 12 + 1
            return day * 10**4 + month * 100 + value % 100
        case "latitude" | "longitude" if value not in (LATITUDE, LONGITUDE):
            return value // 10**7 * 10**7 + value % (60 * 10**5)
    return value


@pytest.fixture(scope="module")
def receiver() -> Receiver:
    return Receiver()


def test_both_have_the_same_sentences(receiver: Receiver) -> None:
    compare_frames("nmea", receiver, map(known, cases_of("nmea")))


def test_no_sentence_is_lost_that_it_finds(receiver: Receiver) -> None:
    compare_recovery("nmea", "receiver", receiver, list(map(known, cases_of("nmea"))))
