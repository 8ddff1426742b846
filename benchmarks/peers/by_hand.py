"""The contenders by hand: slotted objects with events, tuples, NumPy."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from peers import slotted_matty, slotted_rflex, slotted_rn1, tuned
from peers.cases import FEW, Case, Row
from peers.contender import Contender

SLOTTED, TUPLES, NUMPY = "hand, slotted", "hand, tuples", "hand, NumPy"

_DECODERS: dict[str, Any] = {
    "rn1": slotted_rn1,
    "rflex": slotted_rflex,
    "matty": slotted_matty,
}
_ENCODERS: dict[str, Callable[..., bytes]] = {
    "gyro": slotted_rn1.encode_gyro,
    "lidar": slotted_rn1.encode_lidar,
    "read_motor": slotted_rflex.encode_motor,
    "sonar_data": slotted_rflex.encode_sonar,
    "status": slotted_matty.encode_status,
}


def slotted(case: Case) -> Contender:
    """Objects and events as ours: what the fast engine is measured by."""
    module = _DECODERS[case.protocol]
    decode, encode = module.decode, _ENCODERS[case.message]
    frames = case.frames[:FEW]
    items = [decode(frame) for frame in frames]
    kind = type(items[0])
    counted = [*zip(items, range(len(items)), strict=True)]

    def is_wanted(event: Any) -> bool:
        return isinstance(getattr(event, "message", None), kind)

    def stream(data: bytes) -> list[Any]:
        return module.Decoder().feed(data)  # type: ignore[no-any-return]

    def encode_each() -> list[bytes]:
        if case.counter is None:
            return [encode(item) for item in items]
        return [encode(item, count) for item, count in counted]

    return Contender(
        SLOTTED,
        rows=lambda events: [case.row(event.message) for event in events if is_wanted(event)],
        data=case.stream,
        stream=stream,
        places=lambda events: [(event.offset, event.raw) for event in events],
        decode=lambda: [decode(frame) for frame in frames],
        decoded=lambda found: list(map(case.row, found)),
        encode=encode_each,
        frames=tuple(frames),
        feeder=lambda: module.Decoder().feed,
    )


def tuples(case: Case) -> Contender:
    """Tuples alone."""
    return Contender(
        TUPLES,
        rows=lambda found: [_tupled(case, values) for values in found],
        data=case.stream,
        stream=tuned.STREAMS[case.message],
    )


def _tupled(case: Case, values: tuple[Any, ...]) -> Row:
    if case.message == "lidar":
        return values[0], values[1:]
    if case.message == "sonar_data":
        return (*values[:2], tuple(values[2]))
    return values


def numpy(case: Case) -> Contender:
    """Structured arrays. Raises ImportError without NumPy."""
    from peers import bulk

    def rows(array: Any) -> list[Row]:
        columns = [array[name].tolist() for name in case.kind.__fields__]
        return [tuple(map(_frozen, row)) for row in zip(*columns, strict=True)]

    return Contender(NUMPY, rows=rows, data=case.stream, stream=bulk.STREAMS[case.message])


def _frozen(value: Any) -> Any:
    return tuple(value) if isinstance(value, list) else value
