"""Swift Navigation Binary Protocol, beside the package of its makers."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator, Sequence
from io import BytesIO
from typing import Any

import pytest
from compiled import protocol_of
from library_support import cases_of, compare_frames, compare_recovery, encoded, peer_module

from protogen.fuzzing.samples import Values
from protogen.fuzzing.trips import Case
from protogen.library import FOLDER
from protogen.model.payload_plan import (
    AnyStep,
    BytesStep,
    ChooseStep,
    FloatStep,
    RecordStep,
    RepeatStep,
    RestStep,
)
from protogen.model.types import Text

NAMES = {
    "pseudorange": "p",
    "pseudorangestd": "pstd",
    "carrierphase": "l",
    "doppler": "d",
    "whole": "i",
    "fraction": "f",
    "inphase": "i",
    "quadrature": "q",
}
"""Fields that have other names there."""
LARGE = 150
"""Bytes of a frame from which on it takes long."""


class Swift:
    """The messages of the package, and its reader of streams."""

    def __init__(self) -> None:
        self._msg: Any = peer_module("sbp.msg")
        self._framer: Any = peer_module("sbp.client.framer").Framer
        table: Any = peer_module("sbp.table")
        self.classes = {
            kind.__name__.lower().removeprefix("msg"): (number, kind)
            for number, kind in table._SBP_TABLE.items()
        }
        messages = protocol_of(FOLDER / "sbp.yaml").messages
        self._steps = {message.name: message.plan.steps for message in messages}

    def _kind(self, message: str) -> tuple[int, Any]:
        number, kind = self.classes[plain(message)]
        return number, kind

    def frame(self, case: Case) -> bytes:
        number, kind = self._kind(case.message)
        sender = case.parts["sender"]
        if not case.values:
            empty: bytes = self._msg.SBP(number, sender, 0, b"").pack()
            return empty
        values = record_there(self._steps[case.message], case.values, kind._parser)
        made: bytes = kind(sender=sender, **values).to_binary()
        return made

    def values(self, case: Case, frame: bytes) -> Values:
        _, kind = self._kind(case.message)
        packet = self._msg.SBP.unpack(frame)
        assert packet.sender == case.parts["sender"]
        if not case.values:
            return {}
        read = vars_of(kind(packet))
        if case.message == "fileio_write_req":  # It takes all that follows for part of the name.
            name, _, data = read["filename"].partition(b"\0")
            read |= {"filename": name + b"\0", "data": list(data)}
        return record_here(self._steps[case.message], read, kind._parser, case.values)

    def found(self, endpoint: str, data: bytes) -> Iterator[bytes]:
        """It goes on behind what it took for a frame, whatever that was."""
        assert endpoint == "device"
        stream = BytesIO(data)

        def read(size: int) -> bytes:
            piece = stream.read(size)
            if not piece:
                raise OSError  # else it would wait for more
            return piece

        for message, _ in self._framer(read, None, dispatcher=lambda packet: packet):
            yield message.pack()


def vars_of(message: Any) -> dict[str, Any]:
    return {name: getattr(message, name) for name in type(message).__slots__}


def plain(name: str) -> str:
    """A name as both have it: `sat_id` and `satId`."""
    return name.replace("_", "").lower()


def fields_of(parser: Any) -> dict[str, Any]:
    """The fields of a struct of its, or of the elements of an array, by plain name."""
    while hasattr(parser, "subcon"):
        parser = parser.subcon
    return {plain(field.name): field for field in parser.subcons}


def field_of(parser: Any, name: str) -> Any:
    """Its field for one of ours."""
    fields = fields_of(parser)
    return fields.get(plain(name)) or fields[NAMES[plain(name)]]


def record_there(steps: Sequence[AnyStep], values: Values, parser: Any) -> Values:
    """Values of a record, by its names and as it has them."""
    found = {}
    for step in steps:
        if is_setting(step, values):  # It has all texts of a setting as one.
            texts = [
                *values["setting"].values(),
                *(item["text"] for item in values.get("more", ())),
            ]
            found["setting"] = "".join(f"{text}\0" for text in texts).encode("latin-1")
        elif step.name != "more":
            field = field_of(parser, step.name)
            found[field.name] = there(step, values[step.name], field)
    return found


def record_here(steps: Sequence[AnyStep], theirs: Any, parser: Any, like: Values) -> Values:
    """Values of a record that it read, by our names and in the form of what was sent."""
    found: Values = {}
    for step in steps:
        if is_setting(step, like):
            texts = theirs["setting"].decode("latin-1").split("\0")[:-1]
            names = list(like["setting"])
            found["setting"] = dict(zip(names, texts, strict=False))
            if "more" in like:
                found["more"] = [{"text": text} for text in texts[len(names) :]]
        elif step.name != "more":
            field = field_of(parser, step.name)
            found[step.name] = here(step, theirs[field.name], field, like[step.name])
    return found


def is_setting(step: AnyStep, values: Values) -> bool:
    return step.name == "setting" and isinstance(values["setting"], dict)


def there(step: AnyStep | RestStep, value: Any, field: Any) -> Any:
    """A value of ours, as it has that one."""
    match step:
        case RecordStep(name="stec_coeff"):  # Numbers of several units, which it has as a list.
            return list(value.values())
        case RecordStep():
            return record_there(step.steps, value, field)
        case RepeatStep():
            return [there(step.element, item, field) for item in value]
        case ChooseStep():
            return value["value"]
        case FloatStep():
            return float(value)
        case BytesStep(type=Text()):
            end = b"\0" if step.count.until == 0 else b""
            return value.encode("latin-1").ljust(step.count.known or 0, b"\0") + end
        case BytesStep() | RestStep():
            return list(bytes.fromhex(value))
    return value


def here(step: AnyStep | RestStep, value: Any, field: Any, like: Any) -> Any:
    """What it read, in the form of the value that was sent."""
    match step:
        case RecordStep(name="stec_coeff"):
            return dict(zip(like, value, strict=True))
        case RecordStep():
            return record_here(step.steps, value, field, like)
        case RepeatStep():
            assert len(value) == len(like)
            pairs = zip(value, like, strict=True)
            return [here(step.element, item, field, sent) for item, sent in pairs]
        case ChooseStep():
            return {"value": value}
        case FloatStep() if isinstance(like, str):
            return str(value)  # infinite, or no number
        case BytesStep(type=Text()):
            return text_here(step, value)
        case BytesStep() | RestStep():
            return bytes(value).hex()
    return value


def text_here(step: BytesStep, data: bytes) -> str:
    """A text without what ends it or fills it up."""
    if step.count.until is not None:
        data = data.removesuffix(b"\0")
    elif step.count.known:
        data = data.rstrip(b"\0")
    return data.decode("latin-1")


@pytest.fixture(scope="module")
def swift() -> Swift:
    return Swift()


@pytest.fixture(scope="module")
def drawn() -> list[Case]:
    """Two large frames of a message at most, and all small ones."""
    cases: list[Case] = []
    large: Counter[str] = Counter()
    for case in cases_of("sbp"):
        large[case.message] += is_large(case)
        if not is_large(case) or large[case.message] <= 2:
            cases.append(case)
    assert len(cases) >= 1000
    return cases


def is_large(case: Case) -> bool:
    return len(encoded("sbp", case)) > LARGE


def test_it_has_the_same_messages(swift: Swift) -> None:
    messages = protocol_of(FOLDER / "sbp.yaml").messages
    assert {plain(message.name) for message in messages} == swift.classes.keys()


def test_both_make_and_read_the_same(swift: Swift, drawn: list[Case]) -> None:
    assert {plain(case.message) for case in drawn} == swift.classes.keys()
    compare_frames("sbp", swift, drawn)


def test_no_frame_is_lost_that_it_finds(swift: Swift, drawn: list[Case]) -> None:
    small = [case for case in drawn if not is_large(case)]
    compare_recovery("sbp", "device", swift, small[::2])
