"""NMEA 0183, beside pynmeagps."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from datetime import date, time
from decimal import Decimal
from functools import reduce
from io import BytesIO
from operator import xor
from pathlib import Path
from types import ModuleType
from typing import Any

import pytest
from compiled import module_at, protocol_of
from library_support import cases_of, compare_frames, compare_recovery, peer_module

from protogen.copying import replace
from protogen.fuzzing.samples import Values
from protogen.fuzzing.trips import Case
from protogen.library import FOLDER

TALKERS = ("GP", "GN", "GA", "GL", "GB")
OLD = ("gga", "gll", "gsa", "gsv", "rmc", "vtg", "zda")
MAKERS = {
    "ublox_position": ("UBX", ["00"]), "ublox_satellites": ("UBX", ["03"]),
    "ublox_time": ("UBX", ["04"]), "mediatek_answer": ("MTK001", []),
    "mediatek_system": ("MTK010", []), "mediatek_text": ("MTK011", []),
    "garmin_error": ("GRME", []), "garmin_datum": ("GRMM", []),
    "garmin_velocity": ("GRMV", []), "garmin_altitude": ("GRMZ", []),
}  # fmt: skip
"""What pynmeagps calls a sentence of a maker, and the fields that it takes for part of the name."""
OWN = {
    "MTK001": {"command": "IN", "result": "IN"}, "MTK010": {"event": "IN"},
    "MTK011": {"text": "ST"},
}  # fmt: skip
"""Sentences that it does not know, as a user of it says what they have."""
METRIC = (6, 3)
FRACTIONS = {
    "hdop": (2, 2), "pdop": (2, 2), "vdop": (2, 2), "tdop": (2, 2), "gga.altitude": (5, 3),
    "altitude": METRIC, "gga.separation": (3, 3), "separation": METRIC, "age": (4, 1),
    "ublox_position.age": METRIC, "course": (3, 3), "variation": (3, 3),
    "magnetic_course": (3, 3), "heading": (3, 3), "deviation": (3, 3), "gbs.deviation": METRIC,
    "ublox_position.speed": METRIC, "speed": (4, 3), "speed_in_knots": (4, 3),
    "residuals": (3, 2), "probability": (3, 3), "time_of_week": (6, 2),
    "garmin_velocity.north": METRIC, "garmin_velocity.east": METRIC,
} | dict.fromkeys(
    (
        "range_rms", "major", "minor", "orientation", "latitude_error", "longitude_error",
        "altitude_error", "bias", "latitude_offset", "longitude_offset", "altitude_offset", "rate",
        "water_total", "water", "total", "since_reset", "horizontal_accuracy", "vertical_accuracy",
        "vertical_speed", "clock_drift", "horizontal", "vertical", "whole", "up",
    ),
    METRIC,
)  # fmt: skip
"""Digits in front of the point at most, and behind it: of a field, or of all that are called so."""
INTEGERS = {
    "gga.quality": (1, 1), "gga.satellites": (2, 2), "gga.station": (4, 4), "gsa.fix": (1, 1),
    "gsa.satellites": (2, 3), "gsv.sentences": (1, 1), "gsv.number": (1, 1), "gsv.in_view": (2, 2),
    "gsv.satellites.number": (2, 3), "gsv.satellites.elevation": (2, 2),
    "gsv.satellites.azimuth": (3, 3), "gsv.satellites.signal": (2, 2), "zda.day": (2, 2),
    "zda.month": (2, 2), "zda.year": (4, 4), "zda.zone_hours": (2, 2), "zda.zone_minutes": (2, 2),
    "gns.satellites": (2, 2), "gns.station": (4, 4), "grs.mode": (1, 1), "gbs.satellite": (2, 3),
    "txt.sentences": (2, 2), "txt.number": (2, 2), "txt.kind": (2, 2),
    "ublox_position.satellites": (1, 2), "ublox_position.reserved": (1, 1),
    "ublox_position.dead_reckoning": (1, 1), "ublox_satellites.count": (2, 2),
    "ublox_satellites.satellites.number": (2, 3), "ublox_satellites.satellites.azimuth": (3, 3),
    "ublox_satellites.satellites.elevation": (2, 2),
    "ublox_satellites.satellites.signal": (2, 2), "ublox_satellites.satellites.lock": (3, 3),
    "ublox_time.week": (1, 4), "ublox_time.clock_bias": (1, 9), "ublox_time.granularity": (1, 4),
    "mediatek_answer.command": (3, 3), "mediatek_answer.result": (1, 1),
    "mediatek_system.event": (3, 3), "garmin_altitude.altitude": (1, 6),
    "garmin_altitude.kind": (1, 1),
}  # fmt: skip
"""Digits at least and at most."""
HEXADECIMAL = ("system", "signal")
NOT_READ = "ublox_time.reserved"
"""A field at the end of which pynmeagps knows nothing."""
TIME, DATE, LATITUDE, LONGITUDE = 10**9, 10**6, 10**12, 10**13
"""What stands for no text: the least number that has too many digits."""


ZEROS = {"time": "0", "latitude": "000", "longitude": "000"}
"""The digits behind those that pynmeagps writes; the values that are compared have no others."""


class Receiver:
    """What pynmeagps knows of sentences."""

    def __init__(self) -> None:
        self._module: Any = peer_module("pynmeagps")

    def frame(self, case: Case) -> bytes:
        talker, name, texts = called(case)
        refilled(case, lambda path, value: texts.append(self._text(path, value)))
        module = self._module
        own = {"userdefined": OWN, "payload": texts}
        frame: bytes = module.NMEAMessage(talker, name, module.GET, **own).serialize()
        return frame

    def _text(self, path: str, value: Any) -> str:
        """The text of a value: positions, times and dates are written by pynmeagps."""
        name = path.rpartition(".")[2]
        if isinstance(value, str):
            return value
        if path in INTEGERS:
            least, most = INTEGERS[path]
            return "" if value == 10**most else f"{'-' * (value < 0)}{abs(value):0{least}}"
        if name in HEXADECIMAL:
            return f"{value:X}" if value <= 0xF else ""
        found = fraction_of(path)
        if found is not None:
            front, behind = found
            is_there = value != 10 ** (front + behind)
            return f"{value / 10**behind:.{behind}f}" if is_there else ""
        kinds = {"time": "TM", "date": "DT", "latitude": "LA", "longitude": "LN"}
        if name in kinds:
            typed = typed_of(name, value)
            text: str = self._module.NMEAMessage.val2str(typed, kinds[name])
            return text + (ZEROS.get(name, "") if text else "")
        return chr(value) if value else ""

    def values(self, case: Case, frame: bytes) -> Values:
        parsed = self._module.NMEAReader.parse(frame, userdefined=OWN)
        talker, name, before = called(case)
        assert (parsed.talker, parsed.msgID) == (talker, name)
        read = (value for name, value in vars(parsed).items() if not name.startswith("_"))
        assert [next(read) for _ in before] == before

        def value_of(path: str, own: Any) -> Any:
            if path == NOT_READ:
                return own
            return next(read) if isinstance(own, str) else raw_of(path, next(read))

        found = refilled(case, value_of)
        assert next(read, None) is None
        return found

    def found(self, endpoint: str, data: bytes) -> Iterator[bytes]:
        assert endpoint == "receiver"
        for raw, parsed in self._module.NMEAReader(BytesIO(data), quitonerror=0, userdefined=OWN):
            if parsed is not None:
                yield raw


def called(case: Case) -> tuple[str, str, list[str]]:
    """The talker and the name of a sentence, and the fields in front of its own."""
    if case.message not in MAKERS:
        return str(case.parts["talker"]), case.message.upper(), []
    name, before = MAKERS[case.message]
    return "P", name, [*before]


def fraction_of(path: str) -> tuple[int, int] | None:
    """The digits of a number with a point; None for other values."""
    return FRACTIONS.get(path, FRACTIONS.get(path.rpartition(".")[2]))


def typed_of(name: str, value: int) -> Any:
    """A time, a date, or degrees; nothing where there is no text."""
    match name:
        case "time" if value != TIME:
            hours, minutes, seconds = value // 10**7, value // 10**5 % 100, value % 10**5
            return time(hours, minutes, seconds // 1000, seconds % 1000 * 1000)
        case "date" if value != DATE:
            year = value % 100
            return date((2000 if year < 69 else 1900) + year, value // 100 % 100, value // 10**4)
        case "latitude" | "longitude" if value not in (LATITUDE, LONGITUDE):
            return value // 10**10 + value % 10**10 / 10**8 / 60
    return ""


def raw_of(path: str, value: Any) -> int:
    """The raw number of what pynmeagps reads."""
    name = path.rpartition(".")[2]
    if path in INTEGERS:
        return int(10 ** INTEGERS[path][1]) if value == "" else int(value)
    if name in HEXADECIMAL:
        return int(value or "10", 16)
    found = fraction_of(path)
    if found is not None:
        front, behind = found
        return 10 ** (front + behind) if value == "" else round(Decimal(str(value)) * 10**behind)
    match name:
        case "time":
            return TIME if value == "" else int(value.strftime("%H%M%S%f")[:8]) * 10
        case "date":
            return DATE if value == "" else int(value.strftime("%d%m%y"))
        case "latitude" | "longitude":
            if value == "":
                return LATITUDE if name == "latitude" else LONGITUDE
            units: int = round(abs(value) * 60 * 10**5)
            return (units // (60 * 10**5) * 10**7 + units % (60 * 10**5)) * 1000
    return ord(value) if value else 0


def refilled(case: Case, value_of: Callable[[str, Any], Any]) -> Values:
    """The values with others in their places, by the path of each; those left out stay so."""
    made: Values = _refilled(case.message, case.values, value_of)
    return made


def _refilled(path: str, value: Any, value_of: Callable[[str, Any], Any]) -> Any:
    if isinstance(value, dict):
        return {name: _refilled(f"{path}.{name}", it, value_of) for name, it in value.items()}
    if isinstance(value, list):
        return [_refilled(path, item, value_of) for item in value]
    return None if value is None else value_of(path, value)


def known(case: Case) -> Case:
    """The case with a talker of satellites, and times, dates and minutes that there are."""
    place = sum(map(ord, str(case.values))) % len(TALKERS)
    parts = {} if case.message in MAKERS else {"talker": TALKERS[place]}
    return replace(case, parts=parts, values=refilled(case, _that_is))


def _that_is(path: str, value: Any) -> Any:
    match path.rpartition(".")[2]:
        case "details":
            return None  # It is told of the two numbers alone.
        case "text":
            return value.replace(",", ";")  # It reads the text up to the first comma.
        case "time" if value != TIME:
            minutes, seconds = value // 10**5 % 60, value % 60000 // 10 * 10
            return value // 10**7 * 10**7 + minutes * 10**5 + seconds
        case "date" if value != DATE:
            day, month = value // 10**4 % 28 + 1, value // 100 % 12 + 1
            return day * 10**4 + month * 100 + value % 100
        case "latitude" | "longitude" if value not in (LATITUDE, LONGITUDE):
            return value // 10**10 * 10**10 + value % (60 * 10**8) // 1000 * 1000
    return value


@pytest.fixture(scope="module")
def receiver() -> Receiver:
    return Receiver()


@pytest.fixture(scope="module")
def sentences() -> list[Case]:
    """More than 500 of those that were there first, and as many of the others."""
    names = {message.name for message in protocol_of(FOLDER / "nmea.yaml").messages}
    others = sorted(names - set(OLD))
    return [known(case) for case in (*cases_of("nmea", OLD), *cases_of("nmea", others))]


def test_both_have_the_same_sentences(receiver: Receiver, sentences: list[Case]) -> None:
    compare_frames("nmea", receiver, sentences)


def test_no_sentence_is_lost_that_it_finds(receiver: Receiver, sentences: list[Case]) -> None:
    compare_recovery("nmea", "receiver", receiver, sentences)


GLL = "GPGLL,4916.45,N,12311.12,W,225444.00,A,M"
"""Between dollar and star; 7E is the exclusive or of its characters."""


def checked(body: str) -> bytes:
    """A whole sentence."""
    return f"${body}*{reduce(xor, body.encode()):02X}\r\n".encode()


def dialect(folder: Path, frame: str) -> ModuleType:
    """A schema whose sentences of the standard have another frame."""
    file = folder / "mine.yaml"
    forms = f"forms: {{standard: {{frame: {frame}}}}}"
    file.write_text(f"protocol: mine\nextends: library:nmea\n{forms}\n")
    return module_at(file)


def kinds(decoder: Any, text: str) -> list[str]:
    return [event.kind for event in (*decoder.feed(text.encode()), *decoder.flush())]


def test_small_letters_are_those_of_a_dialect(tmp_path: Path) -> None:
    frames = [f"${GLL}*7E\r\n", f"${GLL}*7e\r\n"]
    assert checked(GLL).decode() == frames[0]
    plain = module_at(FOLDER / "nmea.yaml").Decoder("receiver")
    small = dialect(tmp_path, "{sum: {digits: base16-lower}}").Decoder("receiver")
    assert [kinds(plain, frame) for frame in frames] == [["message"], ["invalid"]]
    assert [kinds(small, frame) for frame in frames] == [["invalid"], ["message"]]


def test_a_sentence_without_a_checksum_is_one_of_a_dialect(tmp_path: Path) -> None:
    plain = module_at(FOLDER / "nmea.yaml").Decoder("receiver")
    bare = dialect(tmp_path, "{remove: [star, sum]}").Decoder("receiver")
    assert kinds(plain, f"${GLL}\r\n") == ["invalid"]
    assert kinds(bare, f"${GLL}\r\n") == ["message"]


def test_the_number_of_fields_tells_the_satellites_from_the_signal() -> None:
    decoder = module_at(FOLDER / "nmea.yaml").Decoder("receiver")
    found = []
    for count in range(5):
        for behind in ("", ",", ",1"):
            (event,) = decoder.feed(checked("GPGSV,1,1,01" + ",07,10,200,43" * count + behind))
            found.append((len(event.message.satellites), event.message.signal))
    assert found == [(count, signal) for count in range(5) for signal in (None, 0x10, 1)]


def test_sentences_of_makers_are_never_those_of_the_standard() -> None:
    decoder = module_at(FOLDER / "nmea.yaml").Decoder("receiver")
    found = []
    for body in ("PGRME,15.0,M,45.0,M,25.0,M", "PGRMQ,1", "PUBX,99,1", "PASHR,1", "GPXYZ,1"):
        (event,) = decoder.feed(checked(body))
        found.append((event.kind, event.form))
    assert found == [
        ("message", "garmin"), ("unknown", "garmin"), ("unknown", "ublox"),
        ("unknown", "standard"), ("unknown", "standard"),
    ]  # fmt: skip
