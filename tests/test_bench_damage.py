"""What `benchmarks/bench_damage.py` compares finds the same messages, before any of it is timed."""

import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).parent.parent
sys.path.append(str(ROOT / "benchmarks"))

import bench_damage  # noqa: E402
from peers.cases import cases  # noqa: E402

CASES = (*cases(size=8192), bench_damage.sample())


@pytest.mark.parametrize("share", [0.0, 0.05, 0.5])
@pytest.mark.parametrize(
    "case", [*cases(size=8192), bench_damage.sample()], ids=lambda c: c.message
)
def test_code_by_hand_finds_the_same_messages_in_damaged_streams(case, share):
    stream = bench_damage.damaged(case, share)
    mine = case.module.Decoder(case.sender).feed(stream)
    theirs = bench_damage.BY_HAND[case.protocol].Decoder().feed(stream)
    found = bench_damage.messages(case, mine)
    assert found == bench_damage.messages(case, theirs)
    assert len(found) > len(case.frames) / 3
