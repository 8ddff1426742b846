"""Sets of sizes, compared with plain sets of numbers."""

from __future__ import annotations

from itertools import combinations_with_replacement

import pytest
from hypothesis import given
from hypothesis import strategies as st

from protogen.model.sizes import SizeSet

SIZES = st.builds(
    lambda least, step, more: SizeSet.between(least, least + step * more, step),
    st.integers(0, 12),
    st.integers(0, 5),
    st.integers(0, 6),
)
GREATEST = 200


def plain(sizes: SizeSet) -> set[int]:
    return {size for size in range(GREATEST) if size in sizes}


def test_one_size_is_fixed() -> None:
    sizes = SizeSet.exactly(5)
    assert (sizes.fixed, sizes.step, plain(sizes)) == (5, 0, {5})


def test_between_rounds_the_greatest_size_down_to_a_step() -> None:
    assert plain(SizeSet.between(2, 9, 3)) == {2, 5, 8}
    assert SizeSet.between(2, 9, 3).greatest == 8


def test_between_is_one_size_where_there_is_no_room_for_a_step() -> None:
    assert SizeSet.between(4, 6, 3) == SizeSet.exactly(4)
    assert SizeSet.between(4, 6, 0) == SizeSet.exactly(4)


@given(SIZES)
def test_a_set_runs_from_its_least_to_its_greatest_in_steps(sizes: SizeSet) -> None:
    step = sizes.step or 1
    assert plain(sizes) == set(range(sizes.least, sizes.greatest + 1, step))
    assert (sizes.step == 0) == (sizes.fixed is not None) == (len(plain(sizes)) == 1)


@given(SIZES, SIZES)
def test_a_sum_holds_every_sum_and_has_tight_bounds(one: SizeSet, other: SizeSet) -> None:
    sums = {a + b for a in plain(one) for b in plain(other)}
    result = one + other
    assert sums <= plain(result)
    assert (result.least, result.greatest) == (min(sums), max(sums))


def test_a_sum_with_one_size_is_exact() -> None:
    assert plain(SizeSet.between(1, 7, 3) + SizeSet.exactly(10)) == {11, 14, 17}


@given(SIZES, SIZES)
def test_a_union_holds_both_sides_and_has_tight_bounds(one: SizeSet, other: SizeSet) -> None:
    both = plain(one) | plain(other)
    result = one | other
    assert both <= plain(result)
    assert (result.least, result.greatest) == (min(both), max(both))


def test_a_union_of_two_sizes_holds_just_these() -> None:
    assert plain(SizeSet.exactly(4) | SizeSet.exactly(9)) == {4, 9}
    assert plain(SizeSet.exactly(4) | SizeSet.exactly(4)) == {4}


@given(
    st.builds(
        lambda least, more: SizeSet.between(least, least + more),
        st.integers(0, 4),
        st.integers(0, 3),
    ),
    st.builds(
        lambda least, more: SizeSet.between(least, least + more),
        st.integers(0, 3),
        st.integers(0, 2),
    ),
)
def test_times_holds_every_total_of_so_many_elements(element: SizeSet, count: SizeSet) -> None:
    totals = {
        sum(chosen)
        for number in plain(count)
        for chosen in combinations_with_replacement(sorted(plain(element)), number)
    }
    result = element.times(count)
    assert totals <= plain(result)
    assert (result.least, result.greatest) == (min(totals), max(totals))


def test_times_is_exact_for_elements_of_one_size() -> None:
    # 2 to 8 numbers of 3 bytes, in pairs.
    assert plain(SizeSet.exactly(3).times(SizeSet.between(2, 8, 2))) == {6, 12, 18, 24}
    assert SizeSet.exactly(0).times(SizeSet.between(0, 9)) == SizeSet.exactly(0)


@given(SIZES, SIZES)
def test_two_sets_meet_where_they_have_a_size_in_common(one: SizeSet, other: SizeSet) -> None:
    assert one.meets(other) == bool(plain(one) & plain(other))
    assert one.meets(other) == other.meets(one)


def test_large_sets_meet_or_not_without_a_search_of_every_size() -> None:
    even, odd = SizeSet.between(0, 2**40, 2), SizeSet.between(1, 2**40 + 1, 2)
    assert SizeSet.exactly(2**39 + 1).meets(odd)
    assert not SizeSet.exactly(2**39 + 1).meets(even)


@given(SIZES, st.integers(0, 40), st.integers(0, 40))
def test_members_are_the_sizes_between_two_bounds(sizes: SizeSet, low: int, high: int) -> None:
    assert set(sizes.members(low, high)) == {x for x in plain(sizes) if low <= x <= high}


@pytest.mark.parametrize(
    ("sizes", "text"),
    [
        (SizeSet.exactly(7), "7"),
        (SizeSet.between(0, 255), "0..255"),
        (SizeSet.between(2, 254, 4), "2..254 in steps of 4"),
    ],
)
def test_prints_as_people_write_it(sizes: SizeSet, text: str) -> None:
    assert str(sizes) == text
