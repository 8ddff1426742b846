"""Steps that print a row as text: each is the C that does so.

In C, `out` is where the text goes on, `end` where the room for it ends, and `at_N` the record
inside of N lists that is printed; `at_0` is the row. `templates/printer.c` has what they call.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from enum import Enum
from fractions import Fraction
from itertools import groupby
from math import lcm
from typing import ClassVar, NamedTuple

_MAX_INTEGER = 20
"""Characters of an integer of 64 bits with its sign."""
_MAX_FLOAT = 40
"""Characters of a float."""
_ENVELOPE = 31
"""Bytes in front of a message of MCAP."""
_EXACT = 1 << 53
"""Whole numbers up to here are floats without loss."""
_LONG = 1 << 63


class UnprintableError(Exception):
    """A step has no C, because its numbers are too great."""


@dataclass(frozen=True, slots=True)
class Place:
    """Location of a number, or of the first byte of something, in a row."""

    depth: int
    """Lists around the record that it is a member of; 0: that is the row."""
    code: str
    """Its type, as NumPy calls it."""
    offset: int
    """Bytes from the start of the record."""

    @property
    def pointer(self) -> str:
        """C that points there."""
        return f"at_{self.depth} + {self.offset}" if self.offset else f"at_{self.depth}"

    @property
    def value(self) -> str:
        """C of the number: `int64_t` or, without a sign, `uint64_t`; of a float, a double."""
        return f"{'u1' if self.code == '?' else self.code}_at({self.pointer})"

    @property
    def is_signed(self) -> bool:
        """True if it is an integer that may be negative."""
        return self.code.startswith("i")

    @property
    def is_float(self) -> bool:
        """True if it is a float."""
        return self.code.startswith("f")


@dataclass(frozen=True, slots=True)
class Worked:
    """An integer that is worked out of some in a row."""

    value: str
    """C of the number, an `int64_t`."""
    is_signed: ClassVar[bool] = True
    is_float: ClassVar[bool] = False


Count = Place | Worked | int


class Others(NamedTuple):
    """Texts for the floats that are no finite numbers."""

    nan: str
    infinity: str
    minus_infinity: str


IN_LINES = Others('"nan"', '"inf"', '"-inf"')
"""Texts of JSON lines, which are strict JSON."""
IN_JSON = Others("NaN", "Infinity", "-Infinity")
"""Texts of `json.dumps`."""
IN_CELLS = Others("nan", "inf", "-inf")
"""Texts of `str`."""


class Spelling(Enum):
    """Spellings of characters."""

    JSON = "put_json"
    JSON_ASCII = "put_json_ascii"
    PLAIN = "put_plain"


class Source(Enum):
    """Bytes that lie outside of rows, behind the offset of the first one in C."""

    LINE = "job->line + ({} - job->base)"
    """The bytes of the capture."""
    PAYLOADS = "rows->payloads + ({})"
    """The payloads of unknown frames."""


class Condition(Enum):
    """Facts about a row that are not in it."""

    DIFFERS = "is_odd || (rows->differs != NULL && rows->differs[rows->next])"
    """An encoder makes other bytes of what is printed."""
    TIMED = "rows->times != NULL && rows->timed[rows->next]"
    """The time of the row is known."""


@dataclass(frozen=True, slots=True)
class Step:
    """C that prints something."""

    lines: Sequence[str]
    size: int | None = None
    """The most characters that it prints; None: it looks itself whether there is room."""
    text: str | None = None
    """The text, if it is always the same."""


Steps = Sequence[Step]


def block(steps: Iterable[Step]) -> Iterator[str]:
    """C of steps, with a test for room in front of each run of those whose size is known."""
    for _, run in groupby(_joined(steps), lambda step: step.size is None):
        each = list(run)
        size = sum(step.size or 0 for step in each)
        if size:
            yield f"NEED({size});"
        for step in each:
            yield from step.lines


def _joined(steps: Iterable[Step]) -> Iterator[Step]:
    """Steps with one text where several follow each other, and none that is empty."""
    for is_text, run in groupby(steps, lambda step: step.text is not None):
        if not is_text:
            yield from run
        elif text := "".join(step.text or "" for step in run):
            yield literal(text)


def indented(lines: Iterable[str]) -> Iterator[str]:
    """Lines inside of a block."""
    return (f"    {line}" for line in lines)


# --- texts ----------------------------------------------------------------------------------------


def literal(text: str) -> Step:
    """Print a fixed text."""
    return Step([_put(text)], len(text.encode()), text)


def named(place: Place, texts: Mapping[int, str]) -> Step:
    """Print the text of a number; nothing for a number that has none."""
    cases = [(value, [_put(text)]) for value, text in texts.items()]
    size = max((len(text.encode()) for text in texts.values()), default=0)
    return Step([*switch_lines(place, cases, [])], size)


def characters(place: Place, room: int, count: Count | None, spelling: Spelling) -> Step:
    """Print text that lies in the row, padded with NUL up to `room`.

    `count`: its characters; None: up to the last one that is not NUL.
    """
    stored = f"text_size({place.pointer}, {room})"
    size = stored if count is None else f"(int64_t){count_text(count)}"
    return fallible(f"{spelling.value}(out, end, {place.pointer}, {stored}, {size})")


def hex_digits(place: Place, count: Count) -> Step:
    """Print two digits for each of some bytes that lie in the row."""
    return fallible(f"put_hex(out, end, {place.pointer}, (uint64_t){count_text(count)})")


def hex_of(source: Source, start: Place, size: Place) -> Step:
    """Print two digits for each of some bytes that lie elsewhere."""
    return fallible(f"put_hex(out, end, {source.value.format(start.value)}, {size.value})")


def quoted(body: Iterable[Step]) -> Step:
    """Print one value of CSV, in quotes where it needs them."""
    return Step(
        [
            "{",
            "    uint8_t *const mark = out;",
            *indented(block(body)),
            "    OR_FAIL(put_quotes(mark, out, end));",
            "}",
        ]
    )


def _put(text: str) -> str:
    return f"PUT({_string(text)});"


def _string(text: str) -> str:
    """A string of C."""
    return '"' + "".join(map(octal_character, text.encode())) + '"'


def octal_character(byte: int) -> str:
    """A character of a string of C."""
    # Question marks could make trigraphs.
    is_plain = 0x20 <= byte < 0x7F and chr(byte) not in '"\\?'
    return chr(byte) if is_plain else f"\\{byte:03o}"


def fallible(put: str, size: int | None = None) -> Step:
    """Call what prints something unless there is no room."""
    return Step([f"OR_FAIL({put});"], size)


# --- what counts and chooses ----------------------------------------------------------------------


def repeat(first: Place, stride: int, count: Count, body: Iterable[Step]) -> Step:
    """Print each element of a list, with commas between the elements."""
    depth = first.depth + 1
    at, left = f"at_{depth}", f"left_{depth}"
    return Step(
        [
            "{",
            f"    const uint8_t *{at} = {first.pointer};",
            f"    int64_t {left} = (int64_t){count_text(count)};",
            f"    for (; {left} > 0; {left}--, {at} += {stride}) {{",
            *indented(indented(block(body))),
            f"        if ({left} > 1) {{",
            f"            NEED({len(', ')});",
            '            PUT(", ");',
            "        }",
            "    }",
            "}",
        ]
    )


def choose(
    place: Place | Worked, cases: Mapping[int, Iterable[Step]], rest: Iterable[Step]
) -> Step:
    """Take the steps of the case whose value a number has, else those of `rest`."""
    blocks = [(value, list(block(body))) for value, body in cases.items()]
    return Step([*switch_lines(place, blocks, block(rest))])


def where(holds: Place | Worked, body: Iterable[Step], other: Iterable[Step]) -> Step:
    """Take steps where a number is not 0, and others where it is."""
    return Step([*either_lines(f"{count_text(holds)} != 0", block(body), [*block(other)])])


def when(condition: Condition, body: Iterable[Step]) -> Step:
    """Take steps where a condition holds."""
    return Step([*either_lines(condition.value, block(body))])


def either_lines(condition: str, body: Iterable[str], other: Iterable[str] = ()) -> Iterator[str]:
    """C of a choice of two."""
    yield f"if ({condition}) {{"
    yield from indented(body)
    if other:
        yield "} else {"
        yield from indented(other)
    yield "}"


def switch_lines(
    place: Place | Worked, cases: Iterable[tuple[int, Sequence[str]]], rest: Iterable[str]
) -> Iterator[str]:
    """C of a choice by a number."""
    yield f"switch ({place.value}) {{"
    for value, lines in cases:
        yield f"case {constant_text(value, place)}:"
        yield from indented([*lines, "break;"])
    yield "default:"
    yield from indented([*rest, "break;"])
    yield "}"


def count_text(count: Count) -> str:
    """C of a number that counts."""
    if isinstance(count, int):
        return str(count)
    return count.value if isinstance(count, Place) else f"({count.value})"


def unless(place: Place, special: Iterable[int], body: Iterable[Step]) -> Step:
    """Take steps unless a number is one of these."""
    return Step([*either_lines(f"!({is_one_of(place, special)})", block(body))])


def is_one_of(place: Place, special: Iterable[int]) -> str:
    """C that tells whether a number is one of these; empty where there are none."""
    return " || ".join(f"{place.value} == {constant_text(it, place)}" for it in sorted(special))


def finite(place: Place, scaled: tuple[Fraction, Fraction] | None, body: Iterable[Step]) -> Step:
    """Take steps where a float, or what it is by scale and offset, is a finite number."""
    value = place.value if scaled is None else scaled_float_text(place, *scaled)
    return Step([*either_lines(f"{value} - {value} == 0.0", block(body))])


def without_comma() -> Step:
    """Take back the `, ` behind the last member."""
    return Step(["if (out[-1] == ' ') {", "    out -= 2;", "}"], 0)


def enveloped(channel: int, size: Place, body: Iterable[Step]) -> Step:
    """Print a record of MCAP that holds a message of that channel, from a frame of such a size."""
    return Step(
        [
            f"NEED({_ENVELOPE});",
            "{",
            "    uint8_t *const envelope = out;",
            f"    out += {_ENVELOPE};",
            *indented(block(body)),
            f"    put_envelope(job, rows, envelope, out, {channel}U, {size.value});",
            "}",
        ]
    )


# --- numbers --------------------------------------------------------------------------------------


TIME = Step(["out = put_integer(out, rows->times[rows->next]);"], _MAX_INTEGER)
"""Prints the time of the row."""


def number(place: Place, others: Others) -> Step:
    """Print a number of any type: a float as the shortest decimal that is read as the same one."""
    if place.code == "?":
        lines = either_lines(place.value, [_put("true")], [_put("false")])
        return Step([*lines], len("false"))
    if not place.is_float:
        put = "put_integer" if place.is_signed else "put_natural"
        return Step([f"out = {put}(out, {place.value});"], _MAX_INTEGER)
    odd = [f"is_odd |= is_odd_{place.code}({place.pointer});"] if others == IN_LINES else []
    return Step([*odd, *_put_float(place.value, others).lines], _MAX_FLOAT)


def physical(
    place: Place,
    scale: Fraction,
    offset: Fraction,
    special: Iterable[int],
    missing: str,
    others: Others,
) -> Step:
    """Print the physical value of a raw one, raw x scale + offset, rounded once.

    Raw values that are `special` have none: `missing` is printed. Raises UnprintableError.
    """
    if scale == 1 and offset == 0:
        found = number(place, others).lines
    else:
        scaled = scaled_float_text if place.is_float else scaled_integer_text
        found = _put_float(scaled(place, scale, offset), others).lines
    equal = is_one_of(place, special)
    return Step([*either_lines(equal, [_put(missing)], found)] if equal else found, _MAX_FLOAT)


def _put_float(value: str, others: Others) -> Step:
    return fallible(f"put_double(job, out, {value}, {', '.join(map(_string, others))})")


def scaled_float_text(place: Place, scale: Fraction, offset: Fraction) -> str:
    """C of a float x scale + offset, both rounded."""
    return f"scaled_float({place.value}, {float(scale).hex()}, {float(offset).hex()})"


def scaled_integer_text(place: Place, scale: Fraction, offset: Fraction) -> str:
    """C of an integer x scale + offset, rounded once. Raises UnprintableError."""
    over = lcm(scale.denominator, offset.denominator)
    times, plus = int(scale * over), int(offset * over)
    greatest = 1 << 8 * int(place.code[1:] or 1)
    if greatest * abs(times) + abs(plus) < _EXACT and over < _EXACT:
        sum = f"(int64_t){place.value} * {_signed(times)} + {_signed(plus)}"
        return f"(double)({sum}) / {over}.0"
    if max(abs(times), abs(plus), over) >= _LONG:
        raise UnprintableError(Fraction(times, over))
    return f"scaled_integer({place.value}, {_signed(times)}, {_signed(plus)}, UINT64_C({over}))"


def constant_text(value: int, place: Place | Worked) -> str:
    """C of a constant of the same type as a number."""
    if place.is_float:
        return float(value).hex()
    return _signed(value) if place.is_signed else f"UINT64_C({value})"


def _signed(value: int) -> str:
    # C has no negative constants: the least number has no positive counterpart.
    return f"(-INT64_C({-value - 1}) - 1)" if value < 0 else f"INT64_C({value})"
