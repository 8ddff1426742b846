"""Expressions: read, printed and worked out alike everywhere, with Python itself as the judge."""

from __future__ import annotations

import subprocess
from collections.abc import Iterator, Mapping
from pathlib import Path
from random import Random
from typing import Any

import numpy as np
import pytest
from expression_oracle import worked_out
from tooling import require_compiler

from protogen.c_language.expressions import FormulaPrinter
from protogen.model.expression_bounds import Interval, bounds_of, hull_of, is_settled, linear
from protogen.model.expressions import (
    Arithmetic,
    Comparison,
    Expression,
    Junction,
    Membership,
    Minus,
    Not,
    Number,
    Operand,
    Quotient,
    every,
    folded,
    named,
    names_in,
    plain_name,
    value_of,
)
from protogen.model.payload_plan import Formula, Reference
from protogen.model.types import Integer
from protogen.schema.expressions import ExpressionError, parse_expression
from protogen.targets.python.formulas import in_python

NUMBERS: Mapping[str, Integer] = {
    "a": Integer(bits=8),
    "b": Integer(bits=8, signed=True),
    "c": Integer(bits=16),
    "d": Integer(bits=20, signed=True),
    "e": Integer(bits=32),
}
"""Fields that random expressions are made of."""
FITTING = 1 << 62


# --- text ---------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("text", "printed"),
    [
        ("n", "n"),
        ("n-2", "n - 2"),
        ("0x10 * n", "16 * n"),
        ("a - (b - c)", "a - (b - c)"),
        ("(a - b) - c", "a - b - c"),
        ("a * (b + c) // 4 % 3", "a * (b + c) // 4 % 3"),
        ("-(a + 1)", "-(a + 1)"),
        ("- 3 + a", "-3 + a"),
        ("not (a == 1 or b < 2) and c in [1, 2]", "not (a == 1 or b < 2) and c in [1, 2]"),
        ("a or b and c", "a or b and c"),
        ("(a or b) and c", "(a or b) and c"),
        ("head.key.size", "head.key.size"),
        ("kind == 'A'", "kind == 65"),
        ("x not in [1]", "not x in [1]"),
        ("in", "in"),
    ],
)
def test_text_is_printed_with_the_brackets_that_it_needs(text: str, printed: str) -> None:
    found = parse_expression(text)
    assert str(found) == printed
    assert parse_expression(printed) == found


@pytest.mark.parametrize(
    ("text", "place", "said"),
    [
        ("", 0, "something is missing"),
        ("a +", 3, "something is missing"),
        ("a = 1", 2, "`=` means nothing"),
        ("a / 2", 2, "`/` means nothing"),
        ("a & 2", 2, "`&` means nothing"),
        ("(a", 2, "`)` is missing"),
        ("a)", 1, "`)` is not expected"),
        ("a b", 2, "`b` is not expected"),
        ("a in b", 5, "`[` is missing"),
        ("a in []", 6, "`]` is not expected"),
        ("a not b", 6, "`in` is missing"),
        ("a < b < c", 6, "comparisons do not follow"),
        ("Abc", 0, "`Abc` is neither"),
        ("1a", 0, "`1a` is neither"),
        ("a.", 0, "`a.` is neither"),
        ("a..b", 0, "`a..b` is neither"),
        ("1.5", 0, "`1.5` is neither"),
        ("a == 'AB'", 5, "`'` means nothing"),
        ("a == '€'", 5, "'€' is not one byte"),
        ("a +* b", 3, "`*` is not expected"),
        ("a and", 5, "something is missing"),
        ("a + in", 4, "`in` is not expected"),
        ("(" * 40 + "a" + ")" * 40, 33, "nested at most 32 deep"),
        ("not " * 40 + "a", 132, "nested at most 32 deep"),
        ("1 + " * 200 + "1", 0, "at most 400 characters"),
    ],
)
def test_what_is_no_expression_is_refused_where_it_is_none(
    text: str, place: int, said: str
) -> None:
    with pytest.raises(ExpressionError) as wrong:
        parse_expression(text)
    assert said in wrong.value.text
    assert wrong.value.at == place


def test_a_plain_name_is_told_from_anything_else() -> None:
    assert plain_name(named("n")) == "n"
    for text in ("n + 0", "head.n", "-n", "1", "(n) * 1"):
        assert plain_name(parse_expression(text)) is None
    assert plain_name(Operand(("n",), (0, 2), "size")) is None


# --- values, bounds, inversion ------------------------------------------------------------------


def test_random_expressions_have_the_value_that_python_gives_them() -> None:
    for expression, values in cases(2000):
        expected = worked_out(expression, values)
        assert int(value(expression, values)) == expected
        printed = eval(in_python(expression, lambda it: it.name), {}, dict(values))
        assert int(bool(printed) if expression.is_condition else printed) == expected
        arrays = {name: np.array([number, number], "i8") for name, number in values.items()}
        found = np.asarray(value(expression, arrays)).astype("i8")
        assert set(found.reshape(-1).tolist()) == {expected}


def value(expression: Expression, values: Mapping[str, Any]) -> Any:
    return value_of(expression, lambda operand: values[operand.name])


def test_a_value_is_within_its_bounds_and_these_within_the_hull() -> None:
    for expression, values in cases(2000):
        least, greatest = bounds_of(expression, bounds)
        assert least <= worked_out(expression, values) <= greatest, str(expression)
        low, high = hull_of(expression, bounds)
        assert low <= least
        assert high >= greatest


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("a + b", (-128, 255 + 127)),
        ("a - b", (-127, 255 + 128)),
        ("a * b", (-128 * 255, 255 * 127)),
        ("-b", (-127, 128)),
        ("b // 3", (-43, 42)),
        ("b % 3", (0, 2)),
        ("(a + 256) // 256", (1, 1)),
        ("(a + 512) % 1024", (512, 767)),
        ("(b + 1) % 300", (0, 299)),
        ("a == 3", (0, 1)),
    ],
)
def test_bounds_are_exact(text: str, expected: Interval) -> None:
    assert bounds_of(parse_expression(text), bounds) == expected


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("n", ("n", 1, 0)),
        ("n - 2", ("n", 1, -2)),
        ("2 - n", ("n", -1, 2)),
        ("3 * (n + 1) - n", ("n", 2, 3)),
        ("-n * 2", ("n", -2, 0)),
        ("n * n", None),
        ("n - n", None),
        ("n // 2", None),
        ("n + m", None),
        ("4", None),
        ("n > 2", None),
        ("head.n + 1", ("head.n", 1, 1)),
    ],
)
def test_a_line_over_one_field_is_found(text: str, expected: tuple[str, int, int] | None) -> None:
    found = linear(parse_expression(text))
    assert (found and found[:3]) == expected


class TestQuotient:
    """Elements of 3 bytes each, in n - 1 bytes."""

    COUNT = Quotient(parse_expression("n - 1"), 3)

    @pytest.mark.parametrize(("n", "due"), [(7, 2), (6, -1), (1, 0), (0, -1), (-2, -1)])
    def test_a_part_of_an_element_is_no_number(self, n: int, due: int) -> None:
        assert value_of(self.COUNT, lambda _: n) == due

    def test_numbers_of_columns_are_worked_out_alike(self) -> None:
        found = value_of(self.COUNT, lambda _: np.array([7, 6, 1, 0], "i8"))
        assert found.tolist() == [2, -1, 0, -1]

    def test_its_bounds_hold_that_too(self) -> None:
        assert bounds_of(self.COUNT, lambda _: (4, 10)) == (-1, 3)

    def test_the_number_of_bytes_follows_from_that_of_elements(self) -> None:
        line = linear(self.COUNT)
        assert line is not None
        assert line.inverse(2) == 7
        assert line.within(0, 2) == (1, 7)

    def test_it_is_shown_as_people_write_it(self) -> None:
        assert (str(self.COUNT), self.COUNT.text) == ("((n - 1) / 3)", "(n - 1) / 3")


@pytest.mark.parametrize("factor", [-5, -1, 1, 3])
def test_a_line_is_inverted(factor: int) -> None:
    line = linear(parse_expression(f"n * {factor} + 7"))
    assert line is not None
    for number in range(-20, 20):
        assert line.inverse(number * factor + 7) == number
    least, greatest = line.within(-10, 30)
    inside = [number for number in range(-99, 99) if -10 <= number * factor + 7 <= 30]
    assert (least, greatest) == (inside[0], inside[-1])


def test_what_never_changes_is_folded() -> None:
    known = {"n": 6}
    text = {
        "n * 2": "12",
        "m + n * 2": "m + 12",
        "n > 3 and m": "1 and m",
        "m in [1, 2]": "m in [1, 2]",
    }
    for written, expected in text.items():
        found = folded(parse_expression(written), lambda operand: known.get(operand.name))
        assert str(found) == expected


# --- C ------------------------------------------------------------------------------------------

_PROGRAM = """\
#include <stdint.h>
#include <stdio.h>

struct values {
    uint8_t a;
    int8_t b;
    uint16_t c;
    int32_t d;
    uint32_t e;
};

%s
static const struct values given[] = {%s};

int main(void) {
%s
    return 0;
}
"""


@pytest.mark.parametrize("seed", range(4))
def test_c_has_the_same_values_and_nothing_overflows(seed: int, tmp_path: Path) -> None:
    random = Random(f"C {seed}")
    expressions = list(drawn(random, 150))
    given = [values_of(random) for _ in range(20)]
    functions, calls = [], []
    for index, expression in enumerate(expressions):
        functions.append(function(expression, f"formula_{index}"))
        calls.append(f"""    for (int i = 0; i < {len(given)}; i++) {{
        printf("%lld\\n", (long long)formula_{index}(&given[i]));
    }}""")
    rows = ", ".join("{" + ", ".join(map(_long, each.values())) + "}" for each in given)
    source = tmp_path / "formulas.c"
    source.write_text(_PROGRAM % ("\n".join(functions), rows, "\n".join(calls)), encoding="utf-8")
    checks = ("-fsanitize=undefined", "-fno-sanitize-recover=all")
    compiler = require_compiler("gcc", *checks)
    subprocess.run([compiler, *_FLAGS, *checks, source, "-o", tmp_path / "run"], check=True)
    run = subprocess.run([tmp_path / "run"], check=True, capture_output=True, text=True)
    found = iter(map(int, run.stdout.split()))
    for expression in expressions:
        for values in given:
            assert next(found) == worked_out(expression, values), (str(expression), values)


_FLAGS = ("-std=c99", "-Wall", "-Wextra", "-Wconversion", "-Wsign-conversion")
_MACHINES = {"avr-gcc": ["-mmcu=atmega328p"], "arm-none-eabi-gcc": ["-mcpu=cortex-m0", "-c"]}


@pytest.mark.parametrize("compiler", ["avr-gcc", "arm-none-eabi-gcc", "clang"])
def test_c_has_no_warnings(compiler: str, tmp_path: Path) -> None:
    random = Random(compiler)
    functions = [function(it, f"formula_{i}") for i, it in enumerate(drawn(random, 300))]
    source = tmp_path / "formulas.c"
    source.write_text(_PROGRAM.partition("static const")[0] % "\n".join(functions))
    machine = _MACHINES.get(compiler, [])
    path = require_compiler(compiler, *machine)
    quiet = ("-Wno-unused-function", "-c", "-o", tmp_path / "object")
    command = [path, *machine, *_FLAGS, *quiet, source]
    run = subprocess.run(command, capture_output=True, text=True, check=False)
    assert run.stderr == ""


def function(expression: Expression, name: str) -> str:
    references = {it: Reference(it, 0, NUMBERS[it]) for it in names_in(expression)}
    printer = FormulaPrinter(Formula(expression, references), lambda operand: f"v->{operand.name}")
    text = printer.condition(expression) if expression.is_condition else printer.text(expression)
    body = f"(void)v;\n    return (int64_t)({text});"
    return f"static int64_t {name}(const struct values *v) {{\n    {body}\n}}\n"


def _long(value: int) -> str:
    return f"{value}LL" if abs(value) > 0x7FFF else str(value)


# --- random expressions -------------------------------------------------------------------------


def bounds(operand: Operand) -> Interval:
    if operand.run is not None:
        return 0, (1 << (operand.run[1] - operand.run[0] + 1)) - 1
    return NUMBERS[operand.name].least, NUMBERS[operand.name].greatest


def cases(count: int) -> Iterator[tuple[Expression, dict[str, int]]]:
    random = Random("cases")
    for expression in drawn(random, count):
        yield expression, values_of(random)


def drawn(random: Random, count: int) -> Iterator[Expression]:
    """Expressions whose numbers on the way have at most 62 bits."""
    while count:
        found = condition(random, 3) if random.random() < 0.4 else number(random, 4)
        found = folded(found, lambda operand: None)  # As plans have them.
        low, high = hull_of(found, bounds)
        settled = any(is_settled(item, bounds) is not None for item in every(found))
        if low > -FITTING and high < FITTING and names_in(found) and not settled:
            count -= 1
            yield found


def values_of(random: Random) -> dict[str, int]:
    found: dict[str, Any] = {}
    for name, type_ in NUMBERS.items():
        ends = [type_.least, type_.greatest, 0, 1, 2, 3, 12]
        either = random.choice([*ends, random.randint(type_.least, type_.greatest)])
        found[name] = either
    return found


def number(random: Random, depth: int) -> Expression:
    kind = random.random()
    if depth == 0 or kind < 0.2:
        return leaf(random)
    if kind < 0.3:
        return Minus(number(random, depth - 1))
    if kind < 0.5:
        divisor = Number(random.choice([1, 2, 3, 7, 12, 256, 1000, 70000]))
        return Arithmetic(random.choice(["//", "%"]), number(random, depth - 1), divisor)
    left, right = number(random, depth - 1), number(random, depth - 1)
    return Arithmetic(random.choice(["+", "-", "*"]), left, right)


def leaf(random: Random) -> Expression:
    if random.random() < 0.3:
        return Number(random.choice([-70000, -3, -1, 0, 1, 2, 5, 255, 256, 32768, 65536, 100000]))
    name = random.choice(list(NUMBERS))
    type_ = NUMBERS[name]
    if type_.signed or random.random() < 0.6:
        return Operand((name,))
    low = random.randrange(type_.bits)
    return Operand((name,), (low, random.randrange(low, type_.bits)), "bits")


def condition(random: Random, depth: int) -> Expression:
    kind = random.random()
    if depth == 0 or kind < 0.4:
        operator = random.choice(["==", "!=", "<", "<=", ">", ">="])
        return Comparison(operator, number(random, 2), number(random, 2))
    if kind < 0.5:
        values = tuple(Number(random.randint(-3, 9)) for _ in range(random.randint(1, 3)))
        return Membership(number(random, 1), values)
    if kind < 0.6:
        return Not(either(random, depth))
    return Junction(random.choice(["and", "or"]), either(random, depth), either(random, depth))


def either(random: Random, depth: int) -> Expression:
    """What may be joined: a condition, or a number, which holds unless it is 0."""
    return leaf(random) if random.random() < 0.2 else condition(random, depth - 1)
