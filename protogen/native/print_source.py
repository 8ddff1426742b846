"""C that prints rows: a function for each table, of steps."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from fractions import Fraction
from importlib.resources import files
from math import lcm
from textwrap import indent

from protogen.native.print_steps import (
    IN_LINES,
    Bool,
    Bounded,
    Characters,
    Choose,
    Count,
    Float,
    Hex,
    HexOf,
    Int,
    Literal,
    Name,
    Others,
    Physical,
    Place,
    Quoted,
    Repeat,
    Source,
    Step,
    Steps,
    Time,
    Unbounded,
    When,
    max_size,
)

_EXACT = 1 << 53
"""Whole numbers up to here are floats without loss."""
_LONG = 1 << 63


class UnprintableError(Exception):
    """A step has no C, because its numbers are too great."""


def source_of(tables: Sequence[Steps], quoted: Iterable[int]) -> str:
    """The source of a library that prints the rows of tables.

    `quoted`: the ASCII characters for which a value of CSV needs quotes. Raises UnprintableError.
    """
    helpers = files("protogen.native").joinpath("templates", "printer.c").read_text("utf-8")
    tests = " || ".join(f"character == {code}" for code in quoted)
    lines = [
        f"#define NEEDS_QUOTES(character) ({tests or 0})",
        helpers,
        *(line for number, steps in enumerate(tables) for line in _function(number, steps)),
        "static uint8_t *put_row(" + _PARAMETERS + ") {",
        "    switch (rows->table) {",
    ]
    for number in range(len(tables)):
        lines += [f"    case {number}:", f"        return put_{number}(job, rows, out, end);"]
    lines += ["    default:", "        return NULL;", "    }", "}"]
    return "\n".join([*lines, ""])


_PARAMETERS = "const struct job *job, const struct rows *rows, uint8_t *out, const uint8_t *end"


def _function(number: int, steps: Steps) -> Iterator[str]:
    yield f"static __attribute__((noinline)) uint8_t *put_{number}({_PARAMETERS}) {{"
    yield "    const uint8_t *const at_0 = rows->rows + (size_t)rows->next * rows->stride;"
    yield "    int is_odd = 0;"
    yield "    (void)job;"
    yield "    (void)is_odd;"
    yield from _indented(_block(steps, 0))
    yield "    return out;"
    yield "}"


def _indented(lines: Iterable[str]) -> Iterator[str]:
    return (indent(line, "    ") for line in lines)


def _block(steps: Steps, depth: int) -> Iterator[str]:
    """Steps, with a test for room in front of each run of those whose size is known."""
    bounded: list[Bounded] = []
    for step in _joined(steps):
        if isinstance(step, Bounded):
            bounded.append(step)
            continue
        yield from _run(bounded)
        bounded = []
        yield from _lines(step, depth)
    yield from _run(bounded)


def _run(steps: Sequence[Bounded]) -> Iterator[str]:
    size = sum(map(max_size, steps))
    if size:
        yield f"NEED({size});"
    for step in steps:
        yield from _bounded_lines(step)


def _joined(steps: Steps) -> Iterator[Step]:
    """Steps with one text where several follow each other, and none that is empty."""
    text = ""
    for step in steps:
        if isinstance(step, Literal):
            text += step.text
            continue
        if text:
            yield Literal(text)
            text = ""
        yield step
    if text:
        yield Literal(text)


def _bounded_lines(step: Bounded) -> Iterator[str]:
    match step:
        case Literal(text=text):
            yield f"PUT({_string(text)});"
        case Int(place=place, from_start=True):
            yield f"out = put_natural(out, {_value(place)} + job->start);"
        case Int(place=place):
            yield f"out = {_put_integer(place)}(out, {_value(place)});"
        case Bool(place=place):
            yield from _either(_value(place), ['PUT("true");'], ['PUT("false");'])
        case Float(place=place, others=others):
            if others == IN_LINES:
                yield f"is_odd |= is_odd_{place.code}({_pointer(place)});"
            yield f"OR_FAIL({_put_float(_value(place), others)});"
        case Physical():
            yield from _physical(step)
        case Name(place=place, texts=texts):
            named = [(value, [f"PUT({_string(text)});"]) for value, text in texts.items()]
            yield from _switch(place, named, [])
        case Time():
            yield "out = put_integer(out, rows->times[rows->next]);"


def _lines(step: Unbounded, depth: int) -> Iterator[str]:
    match step:
        case Characters():
            yield f"OR_FAIL({_put_characters(step)});"
        case Hex(place=place, count=count):
            yield f"OR_FAIL(put_hex(out, end, {_pointer(place)}, (uint64_t){_count(count)}));"
        case HexOf(source=source, start=start, size=size):
            base = " - job->base" if source is Source.LINE else ""
            first = f"{source.value} + ({_value(start)}{base})"
            yield f"OR_FAIL(put_hex(out, end, {first}, {_value(size)}));"
        case Repeat():
            yield from _repeat(step, depth)
        case Choose(place=place, cases=cases, rest=rest):
            blocks = [(value, list(_block(body, depth))) for value, body in cases]
            yield from _switch(place, blocks, list(_block(rest, depth)))
        case When(condition=condition, body=body):
            yield from _either(condition.value, _block(body, depth))
        case Quoted(body=body):
            yield "{"
            yield "    uint8_t *const mark = out;"
            yield from _indented(_block(body, depth))
            yield "    OR_FAIL(put_quotes(mark, out, end));"
            yield "}"


def _either(condition: str, body: Iterable[str], other: Iterable[str] = ()) -> Iterator[str]:
    yield f"if ({condition}) {{"
    yield from _indented(body)
    if other:
        yield "} else {"
        yield from _indented(other)
    yield "}"


def _switch(
    place: Place, cases: Sequence[tuple[int, Sequence[str]]], rest: Sequence[str]
) -> Iterator[str]:
    yield f"switch ({_value(place)}) {{"
    for value, lines in cases:
        yield f"case {_constant(value, place)}:"
        yield from _indented([*lines, "break;"])
    yield "default:"
    yield from _indented([*rest, "break;"])
    yield "}"


def _repeat(step: Repeat, depth: int) -> Iterator[str]:
    inner = depth + 1
    yield "{"
    yield f"    const uint8_t *at_{inner} = {_pointer(step.first)};"
    yield f"    int64_t left_{inner} = (int64_t){_count(step.count)};"
    yield f"    for (; left_{inner} > 0; left_{inner}--, at_{inner} += {step.stride}) {{"
    yield from _indented(_indented(_block(step.body, inner)))
    yield f"        if (left_{inner} > 1) {{"
    yield f"            NEED({len(', ')});"
    yield '            PUT(", ");'
    yield "        }"
    yield "    }"
    yield "}"


# --- numbers --------------------------------------------------------------------------------------


def _pointer(place: Place) -> str:
    return f"at_{place.depth} + {place.offset}" if place.offset else f"at_{place.depth}"


def _value(place: Place) -> str:
    """The number: an `int64_t` or, of what has no sign, a `uint64_t`; a double of a float."""
    code = "u1" if place.code == "?" else place.code
    return f"{code}_at({_pointer(place)})"


def _count(count: Count) -> str:
    return _value(count) if isinstance(count, Place) else str(count)


def _is_signed(place: Place) -> bool:
    return place.code.startswith("i")


def _put_integer(place: Place) -> str:
    return "put_integer" if _is_signed(place) else "put_natural"


def _put_float(value: str, others: Others) -> str:
    return f"put_double(job, out, {value}, {', '.join(map(_string, others))})"


def _put_characters(step: Characters) -> str:
    first = _pointer(step.place)
    stored = f"text_size({first}, {step.room})"
    count = stored if step.count is None else f"(int64_t){_count(step.count)}"
    return f"{step.spelling.value}(out, end, {first}, {stored}, {count})"


def _constant(value: int, place: Place) -> str:
    return _signed(value) if _is_signed(place) else f"UINT64_C({value})"


def _signed(value: int) -> str:
    # C has no negative constants: the least number has no positive counterpart.
    return f"(-INT64_C({-value - 1}) - 1)" if value < 0 else f"INT64_C({value})"


def _physical(step: Physical) -> Iterator[str]:
    place = step.place
    is_float = place.code.startswith("f")
    if step.scale == 1 and step.offset == 0:
        plain = Float(place, step.others) if is_float else Int(place)
        found = list(_bounded_lines(plain))
    else:
        value = _physical_float(step) if is_float else _physical_integer(step)
        found = [f"OR_FAIL({_put_float(value, step.others)});"]
    if not step.special:
        yield from found
        return
    equal = (
        f"{_value(place)} == {float(it).hex() if is_float else _constant(it, place)}"
        for it in step.special
    )
    yield from _either(" || ".join(equal), [f"PUT({_string(step.missing)});"], found)


def _physical_float(step: Physical) -> str:
    scale, offset = float(step.scale).hex(), float(step.offset).hex()
    return f"scaled_float({_value(step.place)}, {scale}, {offset})"


def _physical_integer(step: Physical) -> str:
    """The quotient of two integers, rounded once."""
    over = lcm(step.scale.denominator, step.offset.denominator)
    times, plus = int(step.scale * over), int(step.offset * over)
    value = _value(step.place)
    if _greatest(step.place) * abs(times) + abs(plus) < _EXACT and over < _EXACT:
        return f"(double)((int64_t){value} * {_signed(times)} + {_signed(plus)}) / {over}.0"
    if max(abs(times), abs(plus), over) >= _LONG:
        raise UnprintableError(Fraction(times, over))
    return f"scaled_integer({value}, {_signed(times)}, {_signed(plus)}, UINT64_C({over}))"


def _greatest(place: Place) -> int:
    """The greatest magnitude of a type."""
    return 1 << 8 * int(place.code[1:] or 1)


# --- texts ----------------------------------------------------------------------------------------


def _string(text: str) -> str:
    """A string of C."""
    return '"' + "".join(map(_character, text.encode())) + '"'


def _character(byte: int) -> str:
    # Question marks could make trigraphs.
    is_plain = 0x20 <= byte < 0x7F and chr(byte) not in '"\\?'
    return chr(byte) if is_plain else f"\\{byte:03o}"
