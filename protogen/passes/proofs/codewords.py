"""Proofs about byte codes: can it be decoded, at once, and can a literal occur where it must not.

A code maps each byte that may be sent to its codeword, the bytes that stand for it on the wire.
These functions know nothing of schemas. Each gives a witness, which a problem can show, or None,
and then it is proved that there is none.
"""

from collections import deque
from collections.abc import Iterable, Iterator, Mapping, Sequence
from functools import lru_cache
from itertools import pairwise
from typing import NamedTuple

import msgspec

from protogen.copying import replace

Code = Mapping[int, bytes]

# --- decodable at all ---------------------------------------------------------------------------


class _Overhang(NamedTuple):
    """Two inputs whose outputs agree as far as the shorter one goes; `rest` is what is left."""

    longer: bytes
    shorter: bytes
    rest: bytes


def ambiguity(code: Code) -> tuple[bytes, bytes, bytes] | None:
    """Return two different inputs and the one output that they share, or None.

    None: the code is uniquely decodable. The witness is one of those with the fewest input bytes.
    This is the test of Sardinas and Patterson, a search of the overhangs that two outputs can have
    over each other: these are suffixes of codewords, so there are no more of them than the code
    has bytes in all.
    """
    for byte in sorted(code):
        if not code[byte]:
            return b"", bytes((byte,)), b""
    found = _search_overhangs(code)
    if found is None:
        return None
    output = b"".join(code[byte] for byte in found.longer)
    return found.longer, found.shorter, output


def _search_overhangs(code: Code) -> _Overhang | None:
    """Return the first overhang of nothing, where both inputs give the same output."""
    extensions = _extensions(code)
    queue = deque(_first_overhangs(code, extensions))
    seen = {overhang.rest for overhang in queue}
    while queue:
        overhang = queue.popleft()
        if not overhang.rest:
            return overhang
        for following in _following_overhangs(overhang, code, extensions):
            if following.rest not in seen:
                seen.add(following.rest)
                queue.append(following)
    return None


_Extensions = Mapping[bytes, Sequence[int]]


def _extensions(code: Code) -> _Extensions:
    """Return, for each beginning of a codeword, the bytes whose codewords begin with it."""
    found: dict[bytes, list[int]] = {}
    for byte in sorted(code):
        for length in range(len(code[byte]) + 1):
            found.setdefault(code[byte][:length], []).append(byte)
    return found


def _first_overhangs(code: Code, extensions: _Extensions) -> Iterator[_Overhang]:
    """Return the overhangs of one codeword over another that it begins with."""
    for short in sorted(code):
        for long in extensions[code[short]]:
            if long != short:
                rest = code[long][len(code[short]) :]
                yield _Overhang(bytes((long,)), bytes((short,)), rest)


def _following_overhangs(
    overhang: _Overhang, code: Code, extensions: _Extensions
) -> Iterator[_Overhang]:
    """Return the overhangs after one more byte on the shorter side."""
    longer, shorter, rest = overhang
    for byte in extensions.get(rest, ()):
        yield _Overhang(shorter + bytes((byte,)), longer, code[byte][len(rest) :])
    for byte in _beginnings(rest, code, extensions):
        yield _Overhang(longer, shorter + bytes((byte,)), rest[len(code[byte]) :])


def _beginnings(rest: bytes, code: Code, extensions: _Extensions) -> Iterator[int]:
    """Return the bytes whose whole codeword is a proper prefix of `rest`."""
    for length in range(1, len(rest)):
        for byte in extensions.get(rest[:length], ()):
            if len(code[byte]) == length:
                yield byte


# --- decodable at once --------------------------------------------------------------------------


def prefix_clash(code: Code) -> tuple[int, int] | None:
    """Return two bytes, the codeword of the first a prefix of that of the second, or None.

    Equal codewords clash as well. Without a clash a decoder knows each codeword at its last byte.
    """
    # In sorted order, whatever begins with a word follows it without a gap.
    by_codeword = sorted(code, key=lambda byte: (code[byte], byte))
    for short, long in pairwise(by_codeword):
        if code[long].startswith(code[short]):
            return short, long
    return None


# --- occurrence of a literal --------------------------------------------------------------------


class Inserted(msgspec.Struct, frozen=True):
    """A byte that is put in behind each sequence of others, none of which ends as it begins."""

    sequence: bytes
    byte: int

    def sent(self, word: bytes, seen: int) -> tuple[bytes, int]:
        """Bytes sent for a word behind `seen` bytes of the sequence, and how many are seen then."""
        found = bytearray()
        for byte in word:
            found.append(byte)
            begun = self.sequence[:seen] + bytes((byte,))
            endings = (begun[place:] for place in range(len(begun)))
            seen = len(next(filter(self.sequence.startswith, endings), b""))
            if seen == len(self.sequence):
                found.append(self.byte)
                seen = 0
        return bytes(found), seen


class Segment(msgspec.Struct, frozen=True):
    """A stretch of a frame: `least` to `greatest` words, each any of `words`.

    `greatest` None is no limit. `own` marks the place where a literal is meant to stand: an
    occurrence that is exactly one word of an own segment does not count. In segments side by side
    with `inserts`, a byte is put in behind sequences, wherever one word ends and another begins.
    """

    words: frozenset[bytes]
    least: int = 1
    greatest: int | None = 1
    own: bool = False
    inserts: Inserted | None = None


def occurs(
    literal: bytes, before: bytes, segments: Sequence[Segment], after: bytes
) -> tuple[bytes, int] | None:
    """Find `literal` in what `before`, words of the segments in order, and `after` can make.

    The witness is a whole such byte string and the offset of an occurrence in it that does not
    count as own; it is a short one, but not always the shortest. None: it never occurs.

    Exact for every `least` and `greatest`, though no more words of a segment are searched than the
    literal has bytes, m: an occurrence touches at most m words that are not empty, and any more
    words can be put before or behind it. What is put in behind a sequence of n bytes follows from
    the n - 1 bytes in front of it, which may be as many words more. So the time does not depend on
    how many words a segment may have, only on m and n, the number of segments, and the sizes of
    their sets of words.

    Raises ValueError for an empty literal, which would occur everywhere.
    """
    if not literal:
        raise ValueError("an empty literal occurs everywhere")
    chain = _chain(before, segments, after)
    if any(segment.least and not segment.words for segment in chain):
        return None  # Where no word is possible, there is no byte string at all.
    hit = _Search(literal, chain).first_hit()
    return None if hit is None else _witness(literal, chain, hit)


def _chain(before: bytes, segments: Iterable[Segment], after: bytes) -> list[Segment]:
    """Return the segments with the fixed bytes around them, none of them with an empty word."""
    fixed_before, fixed_after = Segment(frozenset((before,))), Segment(frozenset((after,)))
    return [_without_empty_word(segment) for segment in (fixed_before, *segments, fixed_after)]


def _without_empty_word(segment: Segment) -> Segment:
    """Return the same byte strings without the empty word: it only makes fewer words do."""
    if b"" not in segment.words:
        return segment
    return replace(segment, words=segment.words - {b""}, least=0)


class _State(NamedTuple):
    """Behind `taken` words of a segment; the last `matched` bytes begin the literal.

    Of a sequence that a byte is put in behind, `seen` bytes are there.
    """

    segment: int
    taken: int
    matched: int
    seen: int


class _Step(NamedTuple):
    """A word that is taken, or none where a segment is left, and the state behind it.

    `hit`: an occurrence ends behind so many bytes of the word.
    """

    state: _State
    word: bytes = b""
    hit: int | None = None


class _Taking(NamedTuple):
    """Effect of a word on a literal that is matched in part; `hit` as in a step."""

    word: bytes
    matched: int
    hit: int | None
    seen: int


class _Hit(NamedTuple):
    """An occurrence behind the words in `trail`, each with its segment's number.

    It ends behind `end` bytes of the last of these words, as it is sent.
    """

    trail: list[tuple[int, bytes]]
    end: int


class _Search:
    """A breadth-first search for a literal along a chain of segments."""

    def __init__(self, literal: bytes, chain: Sequence[Segment]) -> None:
        self._literal = literal
        self._chain = chain
        inserted = [segment.inserts for segment in chain if segment.inserts is not None]
        behind = max((len(item.sequence) - 1 for item in inserted), default=0)
        self._enough = len(literal) + behind  # More words than this change nothing, see `occurs`.
        self._origins: dict[_State, tuple[_State, bytes]] = {}

    def first_hit(self) -> _Hit | None:
        """Return the occurrence that is reached with the fewest steps."""
        queue = deque([_State(0, 0, 0, 0)])
        while queue:
            state = queue.popleft()
            for step in self._steps(state):
                if step.hit is not None:
                    return _Hit([*self._trail(state), (state.segment, step.word)], step.hit)
                if step.state not in self._origins:
                    self._origins[step.state] = (state, step.word)
                    queue.append(step.state)
        return None

    def _steps(self, state: _State) -> Iterator[_Step]:
        number, taken, matched, seen = state
        segment, enough = self._chain[number], self._enough
        if taken >= min(segment.least, enough) and number + 1 < len(self._chain):
            kept = seen if self._chain[number + 1].inserts == segment.inserts else 0
            yield _Step(_State(number + 1, 0, matched, kept))
        if taken < enough and (segment.greatest is None or taken < segment.greatest):
            for taking in _takings(self._literal, segment, seen)[matched]:
                following = _State(number, taken + 1, taking.matched, taking.seen)
                yield _Step(following, taking.word, taking.hit)

    def _trail(self, state: _State) -> list[tuple[int, bytes]]:
        """Return the words that led to a state, each with its segment's number."""
        trail = []
        while state in self._origins:
            origin, word = self._origins[state]
            if word:
                trail.append((state.segment, word))
            state = origin
        return trail[::-1]


def _takings(literal: bytes, segment: Segment, seen: int) -> tuple[list[_Taking], ...]:
    """Return, for each matched length, a short word for each outcome of taking a word."""
    return _cached_takings(literal, segment.words, segment.own, segment.inserts, seen)


# Calls for the frames of one schema share their literals and most of their sets of words.
@lru_cache(maxsize=256)
def _cached_takings(
    literal: bytes, words: frozenset[bytes], own: bool, inserts: Inserted | None, seen: int
) -> tuple[list[_Taking], ...]:
    automaton = _automaton(literal)
    ordered = sorted(words, key=_by_length)
    sent = {word: (word, 0) if inserts is None else inserts.sent(word, seen) for word in ordered}

    def outcomes(matched: int) -> list[_Taking]:
        found: dict[tuple[int, bool, int], _Taking] = {}
        for word, (wire, behind) in sent.items():
            is_own = own and word == literal
            reached, hit = _matched(wire, matched, automaton, is_own)
            found.setdefault((reached, hit is None, behind), _Taking(word, reached, hit, behind))
        return list(found.values())

    return tuple(map(outcomes, range(len(literal) + 1)))


def _matched(
    word: bytes, matched: int, automaton: Sequence[Sequence[int]], own: bool
) -> tuple[int, int | None]:
    """Read a word up to the first occurrence that ends in it; `own`: not the word itself."""
    whole = len(automaton) - 1
    for length, byte in enumerate(word, 1):
        matched = automaton[matched][byte]
        if matched == whole and not (own and length == len(word)):
            return matched, length
    return matched, None


def _automaton(literal: bytes) -> list[list[int]]:
    """Return the matched length behind each matched length and byte (Knuth, Morris, Pratt)."""
    rows = [[0] * 256]
    rows[0][literal[0]] = 1
    border = 0
    for matched, byte in enumerate(literal[1:], 1):
        rows.append(rows[border].copy())
        rows[matched][byte] = matched + 1
        border = rows[border][byte]
    rows.append(rows[border].copy())
    return rows


def _by_length(word: bytes) -> tuple[int, bytes]:
    return len(word), word


def _witness(literal: bytes, chain: Sequence[Segment], hit: _Hit) -> tuple[bytes, int]:
    """Return a whole byte string around an occurrence, and the occurrence's offset in it."""
    last = hit.trail[-1][0]
    words = _words_by_segment(len(chain), hit.trail)
    padding = [_padding(segment, len(taken)) for segment, taken in zip(chain, words, strict=True)]
    # The words that are still missing stand where they don't touch the occurrence.
    *before, touched = words[last]
    head = [(number, padding[number] + b"".join(words[number])) for number in range(last)]
    head.append((last, b"".join(before)))
    tail = list(enumerate(padding))[last:]
    sent = _sent(chain, [*head, (last, touched), *tail])
    end = sum(map(len, sent[: len(head)])) + hit.end
    return b"".join(sent), end - len(literal)


def _sent(chain: Sequence[Segment], words: Iterable[tuple[int, bytes]]) -> list[bytes]:
    """Return what is sent of words, each with its segment's number."""
    found, inserts, seen = [], None, 0
    for number, word in words:
        seen = seen if chain[number].inserts == inserts else 0
        inserts = chain[number].inserts
        wire, seen = (word, 0) if inserts is None else inserts.sent(word, seen)
        found.append(wire)
    return found


def _words_by_segment(segments: int, trail: Iterable[tuple[int, bytes]]) -> list[list[bytes]]:
    words: list[list[bytes]] = [[] for _ in range(segments)]
    for number, word in trail:
        words[number].append(word)
    return words


def _padding(segment: Segment, taken: int) -> bytes:
    """Return the words that a segment needs behind those taken; short ones.

    They have nothing of a sequence that a byte is put in behind, if there are such words.
    """
    sequence = frozenset(segment.inserts.sequence if segment.inserts else ())
    words = sorted(segment.words, key=_by_length)
    shortest = next(filter(sequence.isdisjoint, words), words[0] if words else b"")
    return shortest * max(0, segment.least - taken)
