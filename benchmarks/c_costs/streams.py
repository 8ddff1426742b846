"""Messages that contenders find in clean and noisy streams."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from random import Random

import corpus

from c_costs.protocols import Protocol
from c_costs.toolchains import HOST, run
from c_costs.workshop import Subject, Workshop, frames_of

SILENCE = b"\xaa" * 300
"""What ends a stream, so that a receiver gives up what it still waits for."""
PIECES = (1 << 20, 1, 17, 1000)
"""Sizes in which streams are fed; the first of them is the whole stream."""


def same_messages(programs: Mapping[str, Path], protocol: Protocol, seeds: int) -> None:
    """Nobody has to be fast with other messages than the expert's, of a clean or a noisy stream."""
    frames = [
        frame
        for which in range(len(protocol.messages))
        for frame in frames_of(programs["expert"], which, 8)
    ]
    material = corpus.Material(tuple(frames), protocol.marks)
    for seed in range(seeds):
        dice = Random(f"{protocol.name} {seed} same")
        clean = b"".join(dice.choice(frames) for _ in range(100))
        noisy = corpus.stream_of(material, dice, 100).data + SILENCE
        for data in (clean, noisy):
            expected = run([str(programs["expert"]), "messages", "0"], data)
            for kind, program in programs.items():
                for piece in PIECES:
                    found = run([str(program), "messages", str(piece)], data)
                    if found != expected:
                        raise SystemExit(f"{kind} {protocol.name} {seed} {piece}: other messages")


@dataclass
class Recovery:
    undamaged: int = 0
    found: int = 0

    @property
    def share(self) -> str:
        """Never rounded up to all."""
        if self.found == self.undamaged:
            return "100 %"
        return f"{int(self.found / self.undamaged * 10_000) / 100:.2f} %"


def recovery(program: Path, subject: Subject, seeds: int) -> Recovery:
    """Count the undamaged frames behind whose last byte a message was delivered."""
    frames: list[bytes] = []
    for which in range(len(subject.protocol.messages)):
        frames += _recovered_frames(program, subject, which)
    material = corpus.Material(tuple(frames), subject.protocol.marks + b"\xfd\xfe")
    figures = Recovery()
    for seed in range(seeds):
        stream = corpus.stream_of(material, Random(f"{subject.protocol.name} {seed}"), 100)
        said = run([str(program), "stream"], stream.data + SILENCE)
        ends = {int(line.split()[0]) for line in said.splitlines()}
        figures.undamaged += len(stream.frames)
        figures.found += sum(at + len(frame) in ends for at, frame in stream.frames)
    return figures


def _recovered_frames(program: Path, subject: Subject, which: int) -> list[bytes]:
    """Frames of a message; MAVLink's lidar goes out in four, which are no message by themselves."""
    if subject.kind == "mavlink" and subject.protocol.messages[which] == "lidar":
        return []
    return frames_of(program, which, 40)


def same_bytes(workshop: Workshop, subjects: dict[str, Subject]) -> None:
    """The expert's frames have to be protogen's, or nothing is worth comparing."""
    made = []
    for kind in ("messages", "all", "expert"):
        host = workshop.build(HOST, "host", subjects[kind])
        count = len(subjects[kind].protocol.messages)
        made.append([frames_of(host, which, 8) for which in range(count)])
    if made[0] != made[1] or made[0] != made[2]:
        raise SystemExit(f"other bytes in {subjects['expert'].protocol.name}")
