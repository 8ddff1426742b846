"""Times on this machine."""

from __future__ import annotations

from dataclasses import dataclass, field
from pathlib import Path

from c_costs.protocols import Protocol
from c_costs.toolchains import run


@dataclass
class Speed:
    """Of one message on this machine, in ns for one frame: one number for each round."""

    bytes: float = 0
    push: list[float] = field(default_factory=list)
    feed: list[float] = field(default_factory=list)
    encode: list[float] = field(default_factory=list)


BYTES_OF_A_ROUND = 20_000_000


def speeds(
    programs: dict[str, Path], protocol: Protocol, which: int, rounds: int
) -> dict[str, Speed]:
    """Time every kind in turn, so that a busy machine slows down all of them alike."""
    found = {kind: Speed() for kind in programs}
    for _ in range(rounds):
        for kind, program in programs.items():
            # A lidar turn is 90 times as long as a gyro's frame.
            count = 8 if protocol.messages[which] == "lidar" else protocol.timed
            words = ["time", str(which), str(count), str(BYTES_OF_A_ROUND)]
            bytes_, push, feed, encode = map(float, run([str(program), *words]).split())
            speed = found[kind]
            speed.bytes = bytes_
            speed.push.append(push)
            speed.feed.append(feed)
            speed.encode.append(encode)
    return found
