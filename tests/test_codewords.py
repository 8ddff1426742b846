"""Proofs about byte codes: examples by hand, and brute force over small alphabets as the oracle."""

import itertools
from collections.abc import Iterator, Mapping, Sequence

import pytest
from hypothesis import given
from hypothesis import strategies as st

from protogen.passes.proofs.codewords import Inserted, Segment, ambiguity, occurs, prefix_clash

Code = Mapping[int, bytes]


def full_code(table: Mapping[int, bytes]) -> Code:
    """A substitution table together with the bytes that stand for themselves."""
    return {byte: table.get(byte, bytes((byte,))) for byte in range(256)}


RFLEX = full_code({0x1B: b"\x1b\x00", 0x7C: b"\x7c\x1b\x01"})
MATTY = full_code({0x55: b"\x56\xaa", 0x56: b"\x56\xa9"})

# --- ambiguity and prefixes ---------------------------------------------------------------------


def encoded(code: Code, data: bytes) -> bytes:
    return b"".join(code[byte] for byte in data)


def assert_is_witness(code: Code, witness: tuple[bytes, bytes, bytes]) -> None:
    first, second, output = witness
    assert first != second
    assert encoded(code, first) == encoded(code, second) == output


@pytest.mark.parametrize("code", [RFLEX, MATTY, {}, {0x41: b"B", 0x42: b"A"}, {0x00: b"\x00"}])
def test_codes_that_decode_at_once(code: Code) -> None:
    assert ambiguity(code) is None
    assert prefix_clash(code) is None


def test_two_bytes_with_one_codeword() -> None:
    code = full_code({0x41: b"B"})
    witness = ambiguity(code)
    assert witness is not None
    assert {witness[0], witness[1]} == {b"A", b"B"}
    assert witness[2] == b"B"
    assert prefix_clash(code) == (0x41, 0x42)


def test_an_escape_byte_that_is_not_escaped() -> None:
    # 55 -> 56 AA, but 56 stands for itself: so do 56 and AA one after the other.
    code = full_code({0x55: b"\x56\xaa"})
    witness = ambiguity(code)
    assert witness is not None
    assert {witness[0], witness[1]} == {b"\x55", b"\x56\xaa"}
    assert witness[2] == b"\x56\xaa"
    assert prefix_clash(code) == (0x56, 0x55)


def test_an_ambiguity_that_takes_several_codewords() -> None:
    # The classic of the test: c = 0, d = 01, e = 10, and 010 is both c e and d c.
    code = {0x63: b"0", 0x64: b"01", 0x65: b"10"}
    witness = ambiguity(code)
    assert witness is not None
    assert {witness[0], witness[1]} == {b"ce", b"dc"}
    assert witness[2] == b"010"


def test_a_codeword_that_is_made_of_several_others() -> None:
    # f = 001 is also c c g, with c = 0 and g = 1: two codewords in one overhang.
    witness = ambiguity({0x63: b"0", 0x66: b"001", 0x67: b"1"})
    assert witness is not None
    assert {witness[0], witness[1]} == {b"f", b"ccg"}


def test_a_code_that_decodes_only_from_its_end() -> None:
    # a = 0, b = 01: a 0 is a or the beginning of b, which the next byte tells.
    code = {0x61: b"0", 0x62: b"01"}
    assert ambiguity(code) is None
    assert prefix_clash(code) == (0x61, 0x62)


def test_an_empty_codeword_leaves_no_trace() -> None:
    assert ambiguity({0x41: b"", 0x42: b"B"}) == (b"", b"A", b"")
    assert ambiguity({0x41: b""}) == (b"", b"A", b"")


def test_the_literals_around_a_clash_do_not_hide_it() -> None:
    # In sorted order 7C 1B, 7C 1B 00 and 7C 1B 01 stand side by side.
    code = {0x01: b"\x7c\x1b\x01", 0x02: b"\x7c\x1b", 0x03: b"\x7c\x1b\x00", 0x04: b"\x7d"}
    assert prefix_clash(code) == (0x02, 0x03)


def small_codes() -> st.SearchStrategy[dict[int, bytes]]:
    word = st.lists(st.sampled_from(b"01"), min_size=1, max_size=4).map(bytes)
    return st.dictionaries(st.sampled_from(b"abcd"), word, max_size=4)


def shared_outputs(code: Code, longest: int) -> Iterator[tuple[bytes, bytes]]:
    """By brute force: all pairs of different inputs, up to a length, with one output."""
    inputs = [
        bytes(data)
        for size in range(longest + 1)
        for data in itertools.product(sorted(code), repeat=size)
    ]
    by_output: dict[bytes, list[bytes]] = {}
    for data in inputs:
        by_output.setdefault(encoded(code, data), []).append(data)
    for same in by_output.values():
        yield from itertools.combinations(same, 2)


@given(small_codes())
def test_ambiguity_finds_what_brute_force_finds(code: Code) -> None:
    fewest = min((len(a) + len(b) for a, b in shared_outputs(code, 5)), default=None)
    witness = ambiguity(code)
    if witness is None:
        assert fewest is None
    else:
        assert_is_witness(code, witness)
        assert fewest is None or len(witness[0]) + len(witness[1]) <= fewest


@given(small_codes())
def test_prefix_clash_finds_what_brute_force_finds(code: Code) -> None:
    clashes = {(a, b) for a, b in itertools.permutations(code, 2) if code[b].startswith(code[a])}
    found = prefix_clash(code)
    assert (found in clashes) if clashes else (found is None)


@given(small_codes())
def test_a_code_without_a_clash_is_never_ambiguous(code: Code) -> None:
    if prefix_clash(code) is None:
        assert ambiguity(code) is None


# --- occurrences --------------------------------------------------------------------------------

ANY_BYTE = frozenset(bytes((byte,)) for byte in range(256))


def words_of(code: Code) -> frozenset[bytes]:
    return frozenset(code.values())


def own(literal: bytes) -> Segment:
    return Segment(frozenset((literal,)), own=True)


def test_stuffing_keeps_a_literal_out() -> None:
    start, end = b"\x1b\x02", b"\x1b\x03"
    region = Segment(words_of(RFLEX), 5, 260)
    assert occurs(start, b"", [own(start), region], end) is None
    assert occurs(end, start, [region, own(end)], b"") is None
    # Not so without stuffing.
    bare = Segment(ANY_BYTE, 5, 260)
    frame, offset = occurs(end, start, [bare, own(end)], b"") or (b"", -1)
    assert frame[offset : offset + 2] == end
    assert 2 <= offset < len(frame) - 2


def test_a_literal_that_arises_where_two_words_meet() -> None:
    # 7C -> 7C 1B ends in 1B, and a plain 02 behind it makes the start 1B 02.
    words = words_of(full_code({0x1B: b"\x1b\x00", 0x7C: b"\x7c\x1b"}))
    frame, offset = occurs(b"\x1b\x02", b"", [Segment(words, 0, None)], b"") or (b"", -1)
    assert (frame, offset) == (b"\x7c\x1b\x02", 1)


def test_a_literal_that_arises_where_the_region_meets_what_stands_around() -> None:
    # The region ends in 0D, the end begins with 0A.
    region = Segment(frozenset((b"\x0d", b"\x20")), 1, 3)
    assert occurs(b"\x0d\x0a", b"", [region], b"\x0a") == (b"\x0d\x0a", 0)
    assert occurs(b"\x0a\x20", b"\x0a", [region], b"") == (b"\x0a\x20", 0)
    assert occurs(b"\x0a\x20", b"\x0a", [], b"\x20") == (b"\x0a\x20", 0)


def test_the_rest_of_the_frame_is_filled_in_with_short_words() -> None:
    # Two leading bytes must come first, the literal ends in them, three more must follow.
    many = Segment(frozenset((b"long", b"x")), 3, 3)
    assert occurs(b"ab", b"", [Segment(frozenset((b"ab",)), 2, 2), many], b"!") == (b"ababxxx!", 0)
    assert occurs(b"!", b"", [many], b"!") == (b"xxx!", 3)


def test_its_own_place_does_not_count_but_overlapping_it_does() -> None:
    # aa a: the second occurrence begins inside the own one.
    assert occurs(b"aa", b"", [own(b"aa")], b"b") is None
    assert occurs(b"aa", b"", [own(b"aa")], b"a") == (b"aaa", 1)
    assert occurs(b"aa", b"a", [own(b"aa")], b"") == (b"aaa", 0)
    # In another word of an own segment it counts: only the whole word is its own place.
    assert occurs(b"a", b"", [Segment(frozenset((b"a", b"ba")), own=True)], b"") == (b"ba", 1)
    # Without the mark it counts as any other.
    assert occurs(b"aa", b"", [Segment(frozenset((b"aa",)))], b"b") == (b"aab", 0)


def test_counts_do_not_cost_time() -> None:
    # A frame of 2000 to a million words; the literal needs two of them side by side.
    region = Segment(frozenset((b"a", b"b")), 2_000, 1_000_000)
    frame, offset = occurs(b"ab", b"", [region], b"") or (b"", -1)
    assert len(frame) == 2_000
    assert frame[offset : offset + 2] == b"ab"
    assert occurs(b"ac", b"", [region, region], b"b") is None
    frame, offset = occurs(b"a!", b"", [region], b"!") or (b"", -1)
    assert (len(frame), offset) == (2_001, 1_999)


def test_bounds_are_exact() -> None:
    def letters(least: int, greatest: int | None) -> Segment:
        return Segment(frozenset((b"a",)), least, greatest)

    literal = b"xaaay"
    assert occurs(literal, b"x", [letters(0, 2)], b"y") is None
    assert occurs(literal, b"x", [letters(4, 9)], b"y") is None
    assert occurs(literal, b"x", [letters(1_000, None)], b"y") is None
    assert occurs(literal, b"x", [letters(3, 3)], b"y") == (literal, 0)
    assert occurs(literal, b"x", [letters(0, None)], b"y") == (literal, 0)


def test_where_no_word_is_possible_nothing_occurs() -> None:
    nothing = Segment(frozenset(), 1, 1)
    assert occurs(b"a", b"a", [nothing], b"") is None
    assert occurs(b"a", b"", [Segment(frozenset(), 0, 5)], b"a") == (b"a", 0)


def test_an_empty_literal_is_refused() -> None:
    with pytest.raises(ValueError, match="empty literal"):
        occurs(b"", b"", [], b"")


DYNAMIXEL = Inserted(b"\xff\xff\xfd", 0xFD)
HEADER = b"\xff\xff\xfd\x00"


def stuffed(words: frozenset[bytes], least: int = 1, greatest: int | None = 1) -> Segment:
    return Segment(words, least, greatest, inserts=DYNAMIXEL)


def test_a_byte_that_is_put_in_keeps_a_literal_out() -> None:
    region = [stuffed(ANY_BYTE), stuffed(ANY_BYTE, 0, None)]
    assert occurs(HEADER, b"", [own(HEADER), *region], b"") is None
    assert occurs(HEADER, b"", [own(HEADER), *region], b"\x00") is None
    # FF FF may be the region's end; so may FF FF FD, but FD FD 00 is no end of the literal.
    frame, offset = occurs(HEADER, b"", [own(HEADER), *region], b"\xfd\x00") or (b"", -1)
    assert frame[offset:] == HEADER
    # In front of the region, nothing is put in.
    found = occurs(HEADER, b"\xff\xff", region, b"")
    assert found is not None
    assert found[0].startswith(HEADER)


def test_a_sequence_of_the_words_of_several_segments() -> None:
    both = [stuffed(frozenset((b"\xff",)), 2, 2), stuffed(frozenset((b"\xfd",)))]
    assert occurs(b"\xfd\xfd", b"", both, b"") == (b"\xff\xff\xfd\xfd", 2)
    # Behind many words, what is put in still follows from the last ones.
    many = [stuffed(frozenset((b"\xff",)), 1000, 1000), stuffed(frozenset((b"\xfd",)))]
    assert occurs(b"\xfd\x00", b"", many, b"\x00") == (b"\xff" * 1000 + b"\xfd\xfd\x00", 1001)
    assert occurs(HEADER, b"", many, b"\x00") is None


SMALL_INSERTS = st.sampled_from([Inserted(b"ab", ord("b")), Inserted(b"aab", ord("b"))])


@given(
    SMALL_INSERTS,
    st.lists(st.sampled_from(b"ab"), min_size=1, max_size=5).map(bytes),
    st.sampled_from([b"", b"a", b"b", b"ab"]),
    st.sampled_from([b"", b"a", b"b", b"ab"]),
)
def test_what_is_put_in_agrees_with_brute_force(
    inserts: Inserted, literal: bytes, before: bytes, after: bytes
) -> None:
    words = frozenset((b"a", b"b"))
    chain = [Segment(words, 1, 1, inserts=inserts), Segment(words, 0, None, inserts=inserts)]
    sent = {
        before + bytes(data).replace(inserts.sequence, inserts.sequence + b"b") + after
        for size in range(1, 9)
        for data in itertools.product(b"ab", repeat=size)
    }
    witness = occurs(literal, before, chain, after)
    if witness is None:
        assert not any(literal in frame for frame in sent)
    else:
        frame, offset = witness
        assert frame.startswith(literal, offset)
        assert frame in sent or len(frame) > 8


SMALL_WORD = st.lists(st.sampled_from(b"ab"), max_size=2).map(bytes)
LITERAL = st.lists(st.sampled_from(b"ab"), min_size=1, max_size=4).map(bytes)


@st.composite
def segments(draw: st.DrawFn, literal: bytes, most: int) -> Segment:
    least = draw(st.integers(0, most))
    greatest = draw(st.one_of(st.none(), st.integers(least, most)))
    words = draw(st.sets(st.one_of(SMALL_WORD, st.just(literal)), max_size=2))
    return Segment(frozenset(words), least, greatest, own=draw(st.booleans()))


# A byte string and the offsets at which an own word stands.
Placed = tuple[bytes, frozenset[int]]


def all_frames(literal: bytes, chain: Sequence[Segment], most: int) -> Iterator[Placed]:
    """By brute force: every byte string of the segments, with up to `most` words of each."""
    if not chain:
        yield b"", frozenset()
        return
    segment, *others = chain
    rests = set(all_frames(literal, others, most))
    greatest = most if segment.greatest is None else segment.greatest
    for count in range(segment.least, greatest + 1):
        for words in itertools.product(segment.words, repeat=count):
            ends = list(itertools.accumulate(map(len, words), initial=0))
            owned = {at for at, word in zip(ends, words, strict=False) if word == literal}
            for rest, placed in rests:
                behind = {ends[-1] + offset for offset in placed}
                yield b"".join(words) + rest, frozenset((owned if segment.own else set()) | behind)


def foreign_offsets(literal: bytes, frame: Placed) -> set[int]:
    text, owned = frame
    return {at for at in range(len(text)) if text.startswith(literal, at)} - owned


def assert_agrees(
    literal: bytes, before: bytes, chain: Sequence[Segment], after: bytes, most: int
) -> None:
    around = [Segment(frozenset((before,))), *chain, Segment(frozenset((after,)))]
    possible: dict[bytes, set[int]] = {}
    for frame in all_frames(literal, around, most):
        possible.setdefault(frame[0], set()).update(foreign_offsets(literal, frame))
    witness = occurs(literal, before, chain, after)
    if witness is None:
        assert not any(possible.values())
    else:
        assert witness[1] in possible[witness[0]]


@given(st.data(), LITERAL, SMALL_WORD, SMALL_WORD)
def test_occurrences_in_one_segment_agree_with_brute_force(
    data: st.DataObject, literal: bytes, before: bytes, after: bytes
) -> None:
    chain = [data.draw(segments(literal, 6))]
    assert_agrees(literal, before, chain, after, 7)


@given(st.data(), LITERAL, SMALL_WORD, SMALL_WORD)
def test_occurrences_in_several_segments_agree_with_brute_force(
    data: st.DataObject, literal: bytes, before: bytes, after: bytes
) -> None:
    chain = data.draw(st.lists(segments(literal, 2), max_size=3))
    assert_agrees(literal, before, chain, after, len(literal) + 1 if len(chain) < 3 else 4)
