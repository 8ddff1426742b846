"""Expressions over the integers in front: counts, selectors and conditions."""

from __future__ import annotations

from collections.abc import Mapping

from hypothesis import strategies as st

from schema_fuzzing.setting import Named, Selector, Setting, Size

_WIDEST = 1 << 40
"""Greater numbers are left alone: what is worked out of them could have more than 62 bits."""
_FEW = 4
"""Most values of what chooses between a case for each."""


def usable(setting: Setting) -> dict[str, Size]:
    """The numbers in front that anything may be worked out of; each has several values."""
    return {
        name: size
        for name, size in setting.operands.items()
        if -_WIDEST < size.least < size.greatest < _WIDEST
    }


# --- conditions ---------------------------------------------------------------------------------


@st.composite
def conditions(draw: st.DrawFn, numbers: Mapping[str, Size], depth: int = 2) -> str:
    """A condition, of which no part always or never holds."""
    name = draw(st.sampled_from(sorted(numbers)))
    kind = draw(st.sampled_from(["plain", "compared", "compared", "in", "not", "joined"]))
    if kind == "plain":
        return name
    if kind == "not":
        return f"not {name}"
    if kind == "joined" and depth:
        word = draw(st.sampled_from(["and", "or"]))
        left = draw(conditions(numbers, depth - 1))
        right = draw(conditions(numbers, depth - 1))
        return f"({left}) {word} ({right})" if draw(st.booleans()) else f"({left}) {word} {name}"
    if kind == "in":
        return draw(_listed(name, numbers[name]))
    return draw(_compared(name, numbers[name], numbers))


@st.composite
def _listed(draw: st.DrawFn, name: str, size: Size) -> str:
    values = st.integers(size.least, size.greatest)
    few = draw(st.lists(values, min_size=1, max_size=3, unique=True))
    word = draw(st.sampled_from(["in", "not in"]))
    texts = [draw(_number(value)) for value in few]
    if isinstance(size, Named) and size.names and word == "in" and draw(st.booleans()):
        texts.append(draw(st.sampled_from(size.names)))
    return f"{name} {word} [{', '.join(dict.fromkeys(texts))}]"


def _number(value: int) -> st.SearchStrategy[str]:
    """A number as it may be written: as a character, too."""
    if value < 0:
        return st.just(str(value))
    character = [f"'{chr(value)}'"] if 0x30 <= value <= 0x7A and value != 0x5C else []
    return st.sampled_from([str(value), str(value), f"0x{value:X}", *character])


@st.composite
def _compared(draw: st.DrawFn, name: str, size: Size, numbers: Mapping[str, Size]) -> str:
    """A comparison with a number that it may come to, or of what is worked out of it."""
    if isinstance(size, Named) and size.names and draw(st.booleans()):
        return f"{name} {draw(st.sampled_from(['==', '!=']))} {draw(st.sampled_from(size.names))}"
    kind = draw(st.sampled_from(["number", "number", "remainder", "sum", "product"]))
    if kind == "remainder" and size.greatest - size.least > 2:
        return f"{name} % 3 {draw(st.sampled_from(['==', '!=', '<']))} 1"
    if kind == "sum":
        other = draw(st.sampled_from(sorted(numbers)))
        whole = size + numbers[other]
        return f"{name} + {other} > {draw(st.integers(whole.least, whole.greatest - 1))}"
    if kind == "product" and size.least >= 0 and size.greatest < 1 << 20:
        return f"{name} * 3 - 1 >= {draw(st.integers(size.least, size.greatest - 1)) * 3}"
    operator = draw(st.sampled_from(["==", "!=", "<", "<=", ">", ">="]))
    low = size.least + (operator in ("<", ">="))
    high = size.greatest - (operator in (">", "<="))
    return f"{name} {operator} {draw(_number(draw(st.integers(low, high))))}"


# --- numbers ------------------------------------------------------------------------------------


@st.composite
def counts(draw: st.DrawFn, counters: Mapping[str, Size], most: int) -> tuple[str, Size] | None:
    """A number of elements of at most `most`, and its bounds."""
    if not counters:
        return None
    name = draw(st.sampled_from(sorted(counters)))
    least, greatest = counters[name].least, counters[name].greatest
    part = draw(st.integers(1, 3))
    choices = {
        f"{name} * {part}": Size(least * part, greatest * part),
        f"{name} + {part}": Size(least + part, greatest + part),
        f"{greatest} - {name}": Size(0, greatest - least),
        f"({name} + 1) // 2": Size((least + 1) // 2, (greatest + 1) // 2),
        f"{name} // {part + 1}": Size(least // (part + 1), greatest // (part + 1)),
    }
    if least >= part:
        choices[f"{name} - {part}"] = Size(least - part, greatest - part)
    if greatest - least > part:
        choices[f"{name} % {part + 1}"] = Size(0, part)
    fitting = {text: bounds for text, bounds in choices.items() if 0 <= bounds.greatest <= most}
    if not fitting:
        return None
    text = draw(st.sampled_from(sorted(fitting)))
    return text, fitting[text]


@st.composite
def selectors(draw: st.DrawFn, setting: Setting) -> Selector | None:
    """What chooses between a case for each of its values."""
    numbers = usable(setting)
    if not numbers:
        return None
    name = draw(st.sampled_from(sorted(numbers)))
    size = numbers[name]
    if size.greatest - size.least < _FEW and draw(st.booleans()):
        return Selector(f"{name} + 0", tuple(range(size.least, size.greatest + 1)))
    many = draw(st.integers(2, 3))
    if size.greatest - size.least < many:
        return None
    return Selector(f"{name} % {many}", tuple(range(many)))
