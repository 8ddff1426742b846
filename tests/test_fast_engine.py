"""The fast engine of generated Python against the reference: the same events, messages and bytes.

The reference cuts byte by byte and parses with construct. Wherever the fast engine decides at all
it has to decide alike; and on what is in order it has to decide, or it would not be fast.
"""

from __future__ import annotations

from functools import cache
from pathlib import Path
from random import Random
from typing import Any

import pytest
from compiled import module_at, name_of, senders
from corpus import material_of, portions, single_bytes, stream_of
from hypothesis import settings

EVERY_SENDER = pytest.mark.parametrize(("path", "sender"), senders(), ids=name_of)
SEEDS = range(max(6, settings().max_examples // 10))


def events_of(path: Path, sender: str, engine: str, portions: Any) -> list[Any]:
    decoder = module_at(path).Decoder(sender, engine)
    events = [event for portion in portions for event in decoder.feed(portion)]
    return [*events, *decoder.flush()]


def shown(events: list[Any]) -> list[tuple[Any, ...]]:
    """All there is to events, in a form in which what is not a number equals itself."""
    return [
        (event.kind, event.offset, event.raw, event.sender, repr(event), event.as_json())
        for event in events
    ]


@cache
def material(path: Path, sender: str) -> Any:
    return material_of(path, sender)


@EVERY_SENDER
class TestEvents:
    @pytest.mark.parametrize("seed", SEEDS)
    def test_of_a_noisy_stream(self, path: Path, sender: str, seed: int) -> None:
        random = Random(seed)
        data = stream_of(material(path, sender), random, 40).data
        due = shown(events_of(path, sender, "construct", [data]))
        assert shown(events_of(path, sender, "fast", [data])) == due
        assert shown(events_of(path, sender, "fast", portions(data, random))) == due

    def test_as_early_as_by_the_reference(self, path: Path, sender: str) -> None:
        """Each portion gives the same events, so nothing is held back that is certain."""
        random = Random(99)
        data = stream_of(material(path, sender), random, 25).data
        for pieces in (list(single_bytes(data)), list(portions(data, random))):
            fast = module_at(path).Decoder(sender)
            reference = module_at(path).Decoder(sender, "construct")
            for piece in pieces:
                assert shown(fast.feed(piece)) == shown(reference.feed(piece))
                assert fast.pending == reference.pending
            assert shown(fast.flush()) == shown(reference.flush())
