"""Steps that print values as CDR: in little-endian order, at multiples of their sizes.

In C, `origin` is where the message begins, whose places are counted from there.
`templates/cdr.c` has what the steps call.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction

from protogen.native.print_steps import (
    Condition,
    Count,
    Place,
    Source,
    Step,
    Worked,
    block,
    count_text,
    either_lines,
    fallible,
    indented,
    is_one_of,
    octal_character,
    scaled_float_text,
    scaled_integer_text,
    switch_lines,
)


@dataclass(frozen=True, slots=True)
class Alignment:
    """What is known of a place in a message: what is left where it is divided by a number."""

    modulus: int = 8
    remainder: int = 0

    def after(self, size: int) -> Alignment:
        """What is known behind so many bytes."""
        return Alignment(self.modulus, (self.remainder + size) % self.modulus)

    def padding(self, size: int) -> int | None:
        """Bytes up to a multiple of a size; None: that depends."""
        return -self.remainder % size if self.modulus >= size else None

    def aligned(self, size: int) -> Alignment:
        """What is known at the next multiple of a size."""
        padding = self.padding(size)
        return Alignment(size) if padding is None else self.after(padding)

    def joined(self, other: Alignment) -> Alignment:
        """What is known where either may be."""
        modulus = min(self.modulus, other.modulus)
        while (self.remainder - other.remainder) % modulus:
            modulus //= 2
        return Alignment(modulus, self.remainder % modulus)


def header(data: bytes) -> list[Step]:
    """Print what stands in front of a message, which begins behind it."""
    return [fixed(data), Step(["const uint8_t *const origin = out;"], 0)]


def fixed(data: bytes) -> Step:
    """Print bytes that are always the same."""
    text = "".join(map(octal_character, data))
    return Step([f'PUT("{text}");'] if data else [], len(data))


def pad(size: int) -> Step:
    """Print zeros up to a multiple of a size."""
    return Step([f"out = put_padding(out, origin, {size}U);"], size - 1)


# --- numbers --------------------------------------------------------------------------------------


def number(place: Place, size: int) -> Step:
    """Print a number as it is, but of NaNs the one that says no more than that."""
    if place.code == "?":
        return Step([f"*out++ = {place.value} != 0;"], 1)
    if place.is_float:
        return Step([f"out = put_f{size}(out, {place.value});"], size)
    return Step([f"COPY(out, {place.pointer}, {size});", f"out += {size};"], size)


def time() -> Step:
    """Print the time of the row."""
    return Step(["out = put_le8(out, (uint64_t)rows->times[rows->next]);"], 8)


def physical(place: Place, scale: Fraction, offset: Fraction, special: Iterable[int]) -> Step:
    """Print the physical value of a raw one, a float of 64 bits; NaN where it has none.

    Raises UnprintableError.
    """
    if place.is_float:
        value = scaled_float_text(place, scale, offset)
    else:
        value = scaled_integer_text(place, scale, offset)
    test = is_one_of(place, special)
    found = f"({test}) ? NOT_A_NUMBER : {value}" if test else value
    return Step([f"out = put_f8(out, {found});"], 8)


def plain_physical(place: Place, size: int, special: Iterable[int]) -> Step:
    """Print a float that is a physical value itself; NaN where it has none."""
    return Step(
        [f"out = put_f{size}(out, ({is_one_of(place, special)}) ? NOT_A_NUMBER : {place.value});"],
        size,
    )


def count(count: Count) -> Step:
    """Print a number of elements."""
    return Step([f"out = put_le4(out, (uint32_t){count_text(count)});"], 4)


# --- bytes ----------------------------------------------------------------------------------------


def octets(place: Place, count: Count) -> Step:
    """Print bytes that lie in the row."""
    return fallible(f"put_octets(out, end, {place.pointer}, (uint64_t){count_text(count)})")


def octets_of(source: Source, start: Place, size: Place) -> Step:
    """Print bytes that lie elsewhere."""
    return fallible(f"put_octets(out, end, {source.value.format(start.value)}, {size.value})")


def numbers(place: Place, size: int, count: Count) -> Step:
    """Print integers that lie one behind the other in the row."""
    return fallible(f"put_run(out, end, {place.pointer}, (uint64_t){count_text(count)}, {size}U)")


def string(place: Place, room: int, count: Count | None) -> Step:
    """Print text that lies in the row, padded with NUL up to `room`.

    `count`: its characters; None: up to the last one that is not NUL.
    """
    stored = f"text_size({place.pointer}, {room})"
    size = stored if count is None else f"(int64_t){count_text(count)}"
    return fallible(f"put_string(out, end, {place.pointer}, {stored}, {size})")


# --- what counts and chooses ----------------------------------------------------------------------


def either(condition: str, body: Iterable[Step], other: Iterable[Step]) -> Step:
    """Take steps where a condition of C holds, and others where it does not."""
    [(first, second), size] = _sized([body, other])
    return Step([*either_lines(condition, first, second)], size)


def timed(body: Iterable[Step], other: Iterable[Step]) -> Step:
    """Take steps where the time of the row is known, and others where it is not."""
    return either(Condition.TIMED.value, body, other)


def where(holds: Count, body: Iterable[Step], other: Iterable[Step]) -> Step:
    """Take steps where a number is not 0, and others where it is."""
    return either(f"{count_text(holds)} != 0", body, other)


def choose(
    place: Place | Worked, cases: Mapping[int, Iterable[Step]], rest: Iterable[Step]
) -> Step:
    """Take the steps of the case whose value a number has, else those of `rest`."""
    [(*bodies, last), size] = _sized([*cases.values(), rest])
    return Step([*switch_lines(place, zip(cases, bodies, strict=True), last)], size)


def repeat(first: Place, stride: int, count: Count, body: Iterable[Step]) -> Step:
    """Print each element of a list."""
    depth = first.depth + 1
    at, left = f"at_{depth}", f"left_{depth}"
    [(lines,), size] = _sized([body])
    return Step(
        [
            "{",
            f"    const uint8_t *{at} = {first.pointer};",
            f"    int64_t {left} = (int64_t){count_text(count)};",
            *([] if size is None else [f"    NEED((uint64_t){left} * {size}U);"]),
            f"    for (; {left} > 0; {left}--, {at} += {stride}) {{",
            *indented(indented(lines)),
            "    }",
            "}",
        ]
    )


def _sized(bodies: Iterable[Iterable[Step]]) -> tuple[list[Sequence[str]], int | None]:
    """C of each of several bodies, and the most bytes that one prints.

    If that is not known, the bodies test themselves whether there is room.
    """
    each = [list(body) for body in bodies]
    sizes = [step.size for body in each for step in body]
    if None in sizes:
        return [[*block(body)] for body in each], None
    most = max(sum(step.size or 0 for step in body) for body in each)
    return [[line for step in body for line in step.lines] for body in each], most
