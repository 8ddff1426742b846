"""protogen: the generated modules, by each engine."""

from __future__ import annotations

from typing import Any

from peers.cases import FEW, Case
from peers.contender import Contender
from protogen.runtime.decoder import Engine


def fast(case: Case) -> Contender:
    """Defaults of a user who says nothing."""
    return _generated(case, "fast", "protogen")


def reference(case: Case) -> Contender:
    """The same by the reference."""
    return _generated(case, "construct", "protogen, `construct`")


def _generated(case: Case, engine: Engine, name: str) -> Contender:
    module, sender, counter = case.module, case.sender, case.counter
    decoder, decode, encode = module.Decoder, module.decode, module.encode
    more: dict[str, Any] = {} if engine == "fast" else {"engine": engine}
    frames, messages = case.frames[:FEW], case.messages[:FEW]
    counted = [*zip(messages, range(len(messages)), strict=True)]

    def is_wanted(event: Any) -> bool:
        return event.kind == "message" and isinstance(event.message, case.kind)

    def stream(data: bytes) -> list[Any]:
        cutter = decoder(sender, **more)
        return [*cutter.feed(data), *cutter.flush()]

    def decode_each() -> list[Any]:
        if more:
            return [decode(frame, sender, engine=engine) for frame in frames]
        return [decode(frame, sender) for frame in frames]

    def encode_each() -> list[bytes]:
        if more:
            parts = {counter} if counter else set()
            return [
                encode(message, engine=engine, **dict.fromkeys(parts, count))
                for message, count in counted
            ]
        if counter == "number":
            return [encode(message, number=count) for message, count in counted]
        if counter == "counter":
            return [encode(message, counter=count) for message, count in counted]
        return [encode(message) for message in messages]

    return Contender(
        name,
        rows=lambda events: [case.row(event.message) for event in events if is_wanted(event)],
        data=case.stream,
        stream=stream,
        places=lambda events: [(event.offset, event.raw) for event in events],
        decode=decode_each,
        decoded=lambda found: list(map(case.row, found)),
        encode=encode_each,
        frames=tuple(frames),
        feeder=lambda: decoder(sender, **more).feed,
    )
