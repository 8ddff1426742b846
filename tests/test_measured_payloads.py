"""Payloads that tell their own size, in bounded frames: all engines find the same too long.

How far ahead a reader looks is its own matter: C wants all elements of an array at once, Python one
after the other. When a frame is given up must not depend on that.
"""

from __future__ import annotations

from functools import cache
from random import Random

import pytest
import typescript_engine
from c_engine import Process, check_events
from compiled import ROOT, module_at, protocol_of
from test_c_decoder import Step

from protogen.targets.c.options import COptions

PATH = ROOT / "tests" / "c_schemas" / "measured.yaml"
STARTS = {"stuffed": bytes.fromhex("7E 7E E1"), "open": b"\xa5"}
KINDS = range(1, 9)
"""The seven identities, and one that is unknown."""
BYTES = (0, 0, 1, 1, 2, 3, 4, 5, 6, 7, 9, 12, 14, 17, 20, 0x7D, 0x7E, 0xA5, 0xE1, 0xFF)
"""Lengths and counts that just fit or just do not, and bytes of starts and stuffing."""

of_senders = pytest.mark.parametrize("sender", STARTS)


@cache
def process() -> Process:
    return Process(protocol_of(PATH), COptions())


def drawn(sender: str, seed: int) -> list[Step]:
    """What looks like frames, with lengths that are right or wrong, in portions."""
    dice = Random(f"{sender} {seed}")
    start = STARTS[sender]
    data = b"".join(
        start[: dice.choice((1, len(start), len(start)))]
        + bytes([dice.choice(KINDS)])
        + bytes(dice.choices(BYTES, k=dice.choice((0, 1, 2, 5, 9, 18, 22, 26))))
        for _ in range(8)
    )
    return [*portioned(data, dice), ("flush",)]


def portioned(data: bytes, dice: Random) -> list[Step]:
    """The bytes in portions, of one byte as often as not."""
    steps: list[Step] = []
    while data:
        size = dice.choice((1, 1, 2, 5, 30))
        steps.append(("feed", data[:size]))
        data = data[size:]
    return steps


@of_senders
def test_c_and_python_give_up_at_the_same_byte(sender: str) -> None:
    for seed in range(100):
        check_events(process(), module_at(PATH), sender, drawn(sender, seed))


@of_senders
def test_typescript_and_python_give_up_at_the_same_byte(sender: str) -> None:
    built = typescript_engine.module_at(PATH)
    for seed in range(100):
        steps = [step[1] if step[0] == "feed" else None for step in drawn(sender, seed)]
        found = typescript_engine.events(built, sender, steps)
        due = typescript_engine.python_events(module_at(PATH), sender, steps)
        difference = typescript_engine.first_difference(found, due)
        if difference:
            pytest.fail(difference, pytrace=False)


@of_senders
@pytest.mark.parametrize("engine", ["fast", "construct"])
def test_a_payload_that_does_not_fit_is_of_the_wrong_size_when_its_frame_is_full(
    sender: str, engine: str
) -> None:
    decoder = module_at(PATH).Decoder(sender, engine)
    room = {"stuffed": 24, "open": 20}[sender]
    data = STARTS[sender] + b"\x01\xff"  # A text of 255 characters.
    data += bytes(room - len(data) - (sender == "open"))  # The sum has its place as well.
    assert decoder.feed(data[:-1]) == []
    event = decoder.feed(data[-1:])[0]
    assert (event.kind, event.reason, event.offset) == ("invalid", "size", 0)


@of_senders
def test_a_start_that_begins_in_a_payload_too_long_for_its_frame_cuts_it_off(sender: str) -> None:
    start = STARTS[sender]
    empty = b"\x01\x00" + (b"\x01" if sender == "open" else b"")
    steps: list[Step] = [("feed", start + b"\x01" + start + empty), ("flush",)]
    check_events(process(), module_at(PATH), sender, steps)
    events = [*module_at(PATH).Decoder(sender).feed(steps[0][1])]
    if sender == "stuffed":  # 7E does not stand in a payload, so it is no length.
        assert [(event.kind, event.offset) for event in events] == [("invalid", 0), ("message", 4)]
        assert events[0].reason == "truncated"
