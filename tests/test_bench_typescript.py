"""Contenders of `benchmarks/bench_typescript.py` agree before any of them is timed."""

from __future__ import annotations

import sys
from pathlib import Path
from random import Random

import pytest
from corpus import Material, stream_of
from tooling import require_tool
from typescript_engine import require_npm

ROOT = Path(__file__).parent.parent
sys.path.append(str(ROOT / "benchmarks"))

import bench_typescript as bench  # noqa: E402
from peers.typescript_cases import Mix, mixes  # noqa: E402

MIXES = mixes(size=4096)
MARKS = {"rn1": b"\x80\x84\xff", "rflex": b"\x1b\x02\x03\x7c\x00\x01", "matty": b"\x55\x56\xaa\xa9"}
SEEDS = range(20)


@pytest.fixture(scope="module")
def hand(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The code by hand, which the compiler finds nothing wrong in."""
    require_tool("node")
    require_npm("tsc")
    return bench.built(tmp_path_factory.mktemp("hand"))


@pytest.mark.parametrize("mix", MIXES, ids=lambda mix: mix.protocol)
def test_code_by_hand_reads_and_writes_what_the_reference_does_also_in_noise(
    mix: Mix, hand: Path
) -> None:
    """The script compares what is in order by itself, and answers what stands in noise."""
    material = Material(tuple(mix.frames[:80]), MARKS[mix.protocol])
    noise = [stream_of(material, Random(seed), 60).data.hex() for seed in SEEDS]
    found = bench.run("measure.mjs", bench.request(mix, hand, noise=noise))
    assert found[bench.HAND] == found[bench.OURS]
    assert all(map(len, found[bench.OURS]))


def test_the_page_says_what_is_missed() -> None:
    times = {
        what: {"protogen": [26.0], "by hand": [hand]} for what, hand in (("64", 20), ("encode", 13))
    }
    results = bench.Results(mixes={"rn1": bench.Measured(1, 10, times)})
    table = bench.mixes_table(results).split("\n")
    assert table[2].endswith("| 26 | 20 | 2.6 | 2.0 | 1.30 x | reached |")
    assert table[3].endswith("| 26 | 13 | 2.6 | 1.3 | 2.00 x | **missed** |")
