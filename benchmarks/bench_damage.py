"""Time that damaged streams take, beside code by hand.

    python benchmarks/bench_damage.py [--rounds N]     # writes benchmarks/damage.md

Of each stream some frames have one byte changed, lost or added. The code by hand cuts the same
streams, and has to find the same messages in them.
"""

from __future__ import annotations

import argparse
import platform
import sys
from collections.abc import Callable
from functools import partial
from pathlib import Path
from random import Random
from statistics import median
from typing import Any

HERE = Path(__file__).resolve().parent
sys.path[:0] = [str(HERE), str(HERE.parent)]

from peers import slotted_imu, slotted_matty, slotted_rflex, slotted_rn1  # noqa: E402
from peers.cases import Case, Row, cases  # noqa: E402
from peers.timing import measure, ratio  # noqa: E402

import protogen  # noqa: E402
from protogen.version import VERSION  # noqa: E402

OUT = HERE / "damage.md"
SHARES = (0.0, 0.01, 0.05)
"""Shares of the frames that are damaged."""
BY_HAND = {
    "rn1": slotted_rn1,
    "rflex": slotted_rflex,
    "matty": slotted_matty,
    "imu": slotted_imu,
}

MADE_BY_HAND: dict[str, type[Any]] = {
    "gyro": slotted_rn1.Gyro,
    "lidar": slotted_rn1.Lidar,
    "read_motor": slotted_rflex.Motor,
    "sonar_data": slotted_rflex.Sonar,
    "status": slotted_matty.Status,
    "sample": slotted_imu.Sample,
}
"""Classes by hand of the messages."""

PAGE = """# What damage costs

<!-- Written by benchmarks/bench_damage.py, do not edit. -->

Made by `python benchmarks/bench_damage.py --rounds {rounds}`.

protogen {version} on Python {python}, {system}.

ns of CPU time for each frame of a stream of about 66 kB that is given as a whole, and in brackets
protogen's time as a multiple of what an expert's code by hand (`hand, slotted` of
[python.md](python.md)) takes for the same stream; medians of {rounds} rounds. Of the frames, so
many have one byte changed, lost or added. Before the times are taken, both have to find the same
messages. The last stream has frames of sync bytes, length and CRC, in which the sync bytes may
occur ([imu.yaml](peers/imu.yaml)).

| stream | {heads} |
| --- | {lines} |
{rows}
"""


def sample() -> Case:
    """The case of a frame of sync bytes, length and CRC."""
    module = protogen.module_of(protogen.load(HERE / "peers" / "imu.yaml"))
    return Case("imu sample", "imu", "sample", module, "board", module.Sample, _sample)


def _sample(dice: Random) -> Row:
    bits = dice.getrandbits
    vectors = (tuple(bits(16) - (1 << 15) for _ in range(3)) for _ in range(2))
    return bits(32), dice.randrange(1, 3), *vectors


def damaged(case: Case, share: float) -> bytes:
    """The case's stream, with some of its frames damaged."""
    dice = Random(f"{case.title} {share}")
    return b"".join(_hit(frame, dice) if dice.random() < share else frame for frame in case.frames)


def _hit(frame: bytes, dice: Random) -> bytes:
    data = bytearray(frame)
    place = dice.randrange(len(data))
    match dice.randrange(3):
        case 0:
            data[place] ^= 1 << dice.randrange(8)
        case 1:
            del data[place]
        case _:
            data.insert(place, dice.randrange(256))
    return bytes(data)


def _cut(make: Callable[[], Any], stream: bytes) -> list[Any]:
    events: list[Any] = make().feed(stream)
    return events


def messages(case: Case, events: list[Any]) -> list[int]:
    """Places where events have a message of the case; the code by hand knows few others."""
    kinds = case.kind, MADE_BY_HAND[case.message]
    return [event.offset for event in events if isinstance(getattr(event, "message", None), kinds)]


def row(case: Case, rounds: int) -> str:
    """The line of a case."""
    cells = []
    for share in SHARES:
        stream = damaged(case, share)
        runs = {
            "protogen": partial(_cut, partial(case.module.Decoder, case.sender), stream),
            "hand": partial(_cut, BY_HAND[case.protocol].Decoder, stream),
        }
        found = {name: messages(case, run()) for name, run in runs.items()}
        if found["protogen"] != found["hand"]:
            raise SystemExit(f"{case.title}: other messages than by hand")
        times = measure(runs, rounds)
        each = median(times["protogen"]) / len(case.frames)
        cells.append(f"{each:,.0f} ({ratio(times['protogen'], times['hand']):.2f} x)")
    return f"| {case.title} | {' | '.join(cells)} |"


def main() -> None:
    """Measure, and write the page."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--rounds", type=int, default=7)
    rounds = parser.parse_args().rounds
    rows = [row(case, rounds) for case in (*cases(), sample())]
    page = PAGE.format(
        rounds=rounds,
        version=VERSION,
        python=platform.python_version(),
        system=f"{platform.system()} {platform.machine()}",
        heads=" | ".join(f"{share:.0%} damaged" if share else "whole" for share in SHARES),
        lines=" | ".join("---:" for _ in SHARES),
        rows="\n".join(rows),
    )
    OUT.write_text(page, encoding="utf-8")
    print(page)


if __name__ == "__main__":
    main()
