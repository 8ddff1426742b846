"""A schema of the library beside an implementation of its protocol that nobody here wrote."""

from __future__ import annotations

import warnings
from collections import Counter
from collections.abc import Iterable, Iterator, Sequence
from functools import cache
from importlib import import_module
from itertools import islice
from random import Random
from types import ModuleType
from typing import NamedTuple, Protocol

from compiled import module_at, protocol_of
from tooling import require_module

from protogen.fuzzing.python_engine import PythonEngine
from protogen.fuzzing.samples import Values
from protogen.fuzzing.trips import Case, cases, told_of
from protogen.library import FOLDER
from protogen.model.frame_plan import EndRule
from protogen.runtime.attributes import arguments

FRAMES = 500
"""Frames that are compared each way, at least."""
ERRORS = 0.01
"""Share of bytes that are damaged where recovery is compared."""


_ENCODED: dict[tuple[str, int], tuple[Case, bytes]] = {}
"""Frames that were made, by schema and identity of the case, which is kept for that."""


class Peer(Protocol):
    """What an independent implementation does. Values are those of JSON lines."""

    def frame(self, case: Case) -> bytes:
        """Encode a whole frame."""

    def values(self, case: Case, frame: bytes) -> Values:
        """Decode a frame of the message of a case."""

    def found(self, endpoint: str, data: bytes) -> Iterable[bytes]:
        """Yield the frames that it finds in a stream, or between two silences, in order."""


def peer_module(name: str) -> ModuleType:
    """A module of a peer, whose warnings are its own. Without it, the test is skipped."""
    require_module(name.partition(".")[0])
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        return import_module(name)


def encoded(name: str, case: Case) -> bytes:
    """The frame of a case, in the first form that it fits."""
    known = _ENCODED.get((name, id(case)))
    if known is None:
        known = _ENCODED[name, id(case)] = case, _encoded(name, case)
    return known[1]


def _encoded(name: str, case: Case) -> bytes:
    codec = module_at(FOLDER / f"{name}.yaml").PROTOCOL
    spec = codec.sender(case.sender)
    kinds = {kind.NAME: kind for kind in (*spec.messages, *spec.encode_only)}
    record = kinds[case.message].from_dict(case.values)
    frame: bytes = codec.encode(record, spec.name, **arguments(case.parts))
    return frame


@cache
def engine_of(name: str) -> PythonEngine:
    """The codec that is generated from a schema of the library."""
    return PythonEngine(module_at(FOLDER / f"{name}.yaml").PROTOCOL)


def cases_of(name: str, messages: Iterable[str] | None = None, seed: int = 1) -> list[Case]:
    """Values of some messages, or of all: boundaries and random ones, `FRAMES` at least."""
    protocol = protocol_of(FOLDER / f"{name}.yaml")
    wanted = {message.name for message in protocol.messages} if messages is None else set(messages)
    assert wanted <= {message.name for message in protocol.messages}
    count = FRAMES // len(wanted) + 1
    drawn = [case for message in sorted(wanted) for case in cases(protocol, count, seed, message)]
    assert len(drawn) >= FRAMES
    return drawn


def endpoint_of(name: str, case: Case) -> str:
    """The endpoint that sends a case, in whatever form of frame."""
    return protocol_of(FOLDER / f"{name}.yaml").sender(case.sender).endpoint


def told_before(name: str, case: Case, frame: bytes) -> dict[str, int]:
    """What a receiver of a case is told, where its frame does not say what it is."""
    return told_of(protocol_of(FOLDER / f"{name}.yaml").sender(case.sender), case, frame)


def compare_frames(name: str, peer: Peer, drawn: Iterable[Case]) -> None:
    """Each makes the frames that the other makes, and reads in them what the other put in."""
    engine = engine_of(name)
    for case in drawn:
        ours = encoded(name, case)
        theirs = peer.frame(case)
        assert ours == theirs, case
        (event,) = engine.events(case.sender, [theirs], told_before(name, case, theirs))
        assert (event.message, event.values) == (case.message, case.values)
        assert peer.values(case, ours) == case.values, case


def compare_recovery(
    name: str,
    endpoint: str,
    peer: Peer,
    drawn: Iterable[Case],
    shared: bytes = b"",
    errors: float = ERRORS,
    share: float = 0.9,
    begins_anew: bool = True,
) -> None:
    """Of a stream with damaged bytes, no frame is lost that the peer finds.

    Many peers stop at the first length that is wrong. So they also begin anew where each frame was
    sent, and we have to find each that one takes there.

    `errors` is the share of bytes that are damaged: few where frames are so long that none stays.
    `share` is that of our frames that the peer finds at least: few where it knows few messages. A
    peer does not begin anew where nothing checks frames, as a damaged one may be another.
    `shared` is the delimiter that may both end a frame and begin the next one. Where a silence ends
    frames, there is one behind each.
    """
    dice = Random(name)
    drawn = [case for case in drawn if endpoint_of(name, case) == endpoint]
    dice.shuffle(drawn)
    frames = [encoded(name, case) for case in drawn]
    bursts = [
        burst._replace(data=damaged(burst.data, dice, errors)) for burst in bursts_of(name, drawn)
    ]
    sent = Counter(frames)
    ours = Counter(found(name, endpoint, bursts, shared)) & sent
    theirs = Counter(frame for burst in bursts for frame in peer.found(endpoint, burst.data)) & sent
    assert theirs <= ours, [frame.hex(" ") for frame in theirs - ours]
    assert len(frames) / 10 < ours.total() < len(frames)
    anew = Counter(found_anew(peer, endpoint, bursts) if begins_anew else ()) & sent
    assert anew <= ours, [frame.hex(" ") for frame in anew - ours]
    most = max(anew.total(), theirs.total())
    assert most >= share * ours.total(), (most, ours.total())


class Burst(NamedTuple):
    """What a receiver is told, and the bytes behind that."""

    told: dict[str, int]
    data: bytes
    frames: list[range]
    """Where each frame was put."""


def found_anew(peer: Peer, endpoint: str, bursts: Iterable[Burst]) -> Iterator[bytes]:
    """Yield the frames that a peer finds first where it begins at a frame."""
    for burst in bursts:
        for place in burst.frames:
            data = burst.data[place.start : place.stop + _BEHIND]
            for frame in islice(peer.found(endpoint, data), 1):
                if data.startswith(frame):
                    yield frame


_BEHIND = 64
"""Bytes behind a frame that a peer is given as well: some look for the next one."""


def bursts_of(name: str, drawn: Sequence[Case]) -> list[Burst]:
    """Frames one behind another, of which a receiver is told the same.

    Where only a silence ends a frame, each is alone.
    """
    alone = ends_idle(name, drawn[0])
    bursts: dict[tuple[object, ...], Burst] = {}
    for index, case in enumerate(drawn):
        frame = encoded(name, case)
        told = told_before(name, case, frame)
        key = (index if alone else None, *told.items())
        burst = bursts.setdefault(key, Burst(told, b"", []))
        data = burst.data + frame
        burst.frames.append(range(len(burst.data), len(data)))
        bursts[key] = burst._replace(data=data)
    return list(bursts.values())


def damaged(data: bytes, dice: Random, errors: float = ERRORS) -> bytes:
    """The data with another byte in the place of some, on average this share of them."""
    return bytes(byte ^ dice.randrange(1, 256) if dice.random() < errors else byte for byte in data)


def ends_idle(name: str, case: Case) -> bool:
    """True if only a silence ends the frame of a case."""
    plan = protocol_of(FOLDER / f"{name}.yaml").sender(case.sender).plan
    return plan.end_rule is EndRule.IDLE


def found(name: str, endpoint: str, bursts: Iterable[Burst], shared: bytes) -> Iterator[bytes]:
    """Yield the frames of known messages that we find, in all forms of the endpoint.

    There is a silence behind each burst.
    """
    decoder = module_at(FOLDER / f"{name}.yaml").Decoder(endpoint, engine="construct")
    for burst in bursts:
        decoder.tell(**burst.told)
        for event in (*decoder.feed(burst.data), *decoder.idle()):
            if event.kind == "message":
                yield event.raw if event.raw.startswith(shared) else shared + event.raw
