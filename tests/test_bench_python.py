"""What `benchmarks/bench_python.py` compares gives the same results, before any of it is timed."""

import sys
from collections.abc import Callable
from random import Random

import pytest
from corpus import Material, stream_of

ROOT = __file__.rsplit("/", 2)[0]
sys.path.append(f"{ROOT}/benchmarks")

from peers import by_hand, ours  # noqa: E402
from peers.cases import FEW, Case, cases  # noqa: E402
from peers.contender import Contender  # noqa: E402

CASES = cases(size=4096)
MAKERS: tuple[Callable[[Case], Contender], ...] = (
    ours.fast,
    ours.reference,
    by_hand.slotted,
    by_hand.tuples,
    by_hand.numpy,
)


@pytest.mark.parametrize("make", MAKERS, ids=lambda make: f"{make.__module__}.{make.__name__}")
@pytest.mark.parametrize("case", CASES, ids=lambda case: case.message)
def test_a_contender_reads_and_writes_what_the_reference_does(case, make):
    try:
        contender = make(case)
    except ImportError as error:
        pytest.skip(f"needs the extra `bench`: {error}")
    if contender.stream:
        found = contender.stream(contender.data)
        assert contender.rows(found) == case.rows
        if contender.places:
            assert [raw for _, raw in contender.places(found)] == case.frames
    if contender.decode:
        assert list(map(contender.row, contender.decode())) == case.rows[:FEW]
    if contender.encode:
        assert tuple(contender.encode()) == contender.frames


@pytest.mark.parametrize("make", [by_hand.slotted, by_hand.tuples], ids=["slotted", "tuples"])
@pytest.mark.parametrize("seed", range(20))
@pytest.mark.parametrize("case", CASES, ids=lambda case: case.message)
def test_code_by_hand_finds_the_same_messages_in_noise(case, make, seed):
    marks = {"rn1": b"\x80\x84", "rflex": b"\x1b\x02\x03\x7c\x00\x01", "matty": b"\x55\x56\xaa\xa9"}
    material = Material(tuple(case.frames), marks[case.protocol])
    data = stream_of(material, Random(seed), 60).data
    mine, theirs = ours.fast(case), make(case)
    assert theirs.rows(theirs.stream(data)) == mine.rows(mine.stream(data))
