"""Contenders of `benchmarks/bench_python.py` give the same results before any of them is timed."""

import sys
from pathlib import Path
from random import Random

import pytest
from corpus import Material, stream_of
from tooling import unavailable

ROOT = Path(__file__).parent.parent
KAITAI = ROOT / ".cache" / "bench" / "node_modules" / "kaitai-struct-compiler"
sys.path.append(str(ROOT / "benchmarks"))

import bench_python  # noqa: E402
from peers import MAKERS, by_hand, made, ours, timing  # noqa: E402
from peers.cases import cases  # noqa: E402
from peers.contender import check  # noqa: E402

CASES = cases(size=4096)
TABLES = 6
"""Streams, in bulk, live and in pieces; decoding and encoding."""
CONSTRUCT = ("with_construct.interpreted", "with_construct.compiled")


@pytest.mark.parametrize("maker", MAKERS)
@pytest.mark.parametrize("case", CASES, ids=lambda case: case.message)
def test_a_contender_reads_and_writes_what_the_reference_does(case, maker):
    if maker == "with_kaitai.contender" and not KAITAI.exists():
        unavailable("kaitai-struct-compiler is not installed; bench_python.py does it")
    try:
        contender = made(maker, case)
    except ImportError as error:
        unavailable(f"the extra `bench` is not installed: {error}")
        raise
    if contender is not None:
        check(contender, case)


@pytest.mark.parametrize("make", [by_hand.slotted, by_hand.tuples], ids=["slotted", "tuples"])
@pytest.mark.parametrize("seed", range(20))
@pytest.mark.parametrize("case", CASES, ids=lambda case: case.message)
def test_code_by_hand_finds_the_same_messages_in_noise(case, make, seed):
    marks = {"rn1": b"\x80\x84", "rflex": b"\x1b\x02\x03\x7c\x00\x01", "matty": b"\x55\x56\xaa\xa9"}
    material = Material(tuple(case.frames), marks[case.protocol])
    data = stream_of(material, Random(seed), 60).data
    mine, theirs = ours.fast(case), make(case)
    assert theirs.rows(theirs.stream(data)) == mine.rows(mine.stream(data))


def test_the_page_has_every_case_and_says_what_is_not_there(monkeypatch):
    monkeypatch.setattr(timing, "LEAST", 1)
    monkeypatch.setattr("gc.collect", lambda: 0)
    makers = ("ours.fast", "by_hand.slotted", "by_hand.numpy", *CONSTRUCT, "gone.away")
    monkeypatch.setattr(bench_python, "MAKERS", makers)
    results = bench_python.measure(1, size=1024)
    page = bench_python.page(results, 1)
    for case in CASES:
        assert page.count(f"\n| {case.title} |") == TABLES
    assert "* `gone.away`: No module named 'peers.gone'" in page
    assert page.count("| not measured |") >= len(CASES)
    readme = "before\n{}\nold\n{}\nbehind\n".format(*bench_python.MARKS)
    filled = bench_python.into_readme(readme, bench_python.summary(results))
    assert filled.startswith("before\n") and filled.endswith("\nbehind\n") and "old" not in filled
    assert bench_python.into_readme(filled, "") == bench_python.into_readme(readme, "")
