"""Initialisers of messages: their defaults, and zeros where they have none."""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator, Sequence
from math import isfinite

from protogen.c_language.numbers import constant, hexadecimal, unsigned
from protogen.model.constants import raw_bytes
from protogen.model.payload_plan import (
    AnyStep,
    BytesStep,
    ChooseStep,
    FloatStep,
    IntegerStep,
    NumberStep,
    OptionalStep,
    RecordStep,
    RepeatStep,
)
from protogen.model.payload_walks import held_step
from protogen.targets.c.lines import INDENT, WIDTH

_OFF = "/* clang-format off */"
"""It takes braces inside of others for code."""
_ON = "/* clang-format on */"
_END = len(" \\")


class UnwritableError(Exception):
    """A default that C99 has no constant for on every machine."""


def initialiser(macro: str, zeros: str, steps: Sequence[AnyStep]) -> tuple[str, ...]:
    """The lines of a macro for a struct of these steps; none where it can't be written.

    Of floats of 64 bits only 0 is the same where a double has fewer bits.
    """
    try:
        values = list(_members(steps, zeros)) or ["0"]
    except UnwritableError:
        return ()
    lines, line = [f"#define {macro}"], " " * INDENT + "{"
    for index, value in enumerate(values):
        item = f" {value}{',' if index < len(values) - 1 else ' }'}"
        if len(line) + len(item) > WIDTH - _END and not line.endswith("{"):
            lines.append(line)
            line = " " * (INDENT + 1)
        line += item
    width = max(map(len, lines))
    text = (*(f"{above:<{width}} \\" for above in lines), line)
    if len(lines) == 1 and line.count("{") == 1:
        return text
    return (_OFF, *text, _ON)


def _members(steps: Sequence[AnyStep], zeros: str) -> Iterator[str]:
    """The values of a record, in the order in which its struct has them."""
    for step in steps:
        held = held_step(step)
        if isinstance(step, OptionalStep) and step.presence.member:
            yield "false"
        if isinstance(held, BytesStep | RepeatStep) and held.count.member:
            yield unsigned(len(_elements(held)))
        if step.holds_values:
            yield _value(held, zeros)


def _value(step: AnyStep, zeros: str) -> str:
    match step:
        case IntegerStep():
            default = step.field.default
            whole = int(default) if isinstance(default, int) else 0
            if step.type.role == "bool":
                return "true" if whole else "false"
            return constant(whole, step.type)
        case FloatStep():
            return _float(step)
        case RecordStep():
            return _braced(_members(step.steps, zeros))
        case BytesStep():
            return _braced(_elements(step)) if _elements(step) else zeros
        case RepeatStep():
            return _array(step, zeros)
        case ChooseStep():
            return _braced([_first(step, zeros)])
    raise AssertionError(step)


def _braced(values: Iterable[str]) -> str:
    return f"{{{', '.join(values)}}}"


def _array(step: RepeatStep, zeros: str) -> str:
    """The elements of an array: all zeros, unless they or their members have defaults."""
    if elements := _elements(step):
        return _braced(elements)
    value = _value(step.element, zeros)
    if isinstance(step.element, NumberStep):
        return zeros
    is_zero = set(re.split(r"[{}, ]+", value)) <= {*_ZEROS, zeros, ""}
    return _braced([value] * (1 if is_zero else step.count.greatest))


def _first(step: ChooseStep, zeros: str) -> str:
    """The first member of a union."""
    cases = (case.step for case in step.cases if case.step.holds_values)
    found = next(cases, None)
    return _braced(["0U", zeros]) if found is None else _value(held_step(found), zeros)


_ZEROS = {"0", "0U", "false", "0.0f"}


def _float(step: FloatStep) -> str:
    default = step.field.default
    number = float(default) if isinstance(default, int | float) else 0.0
    if not isfinite(number) or (step.type.bits == 64 and number):
        raise UnwritableError
    return "0" if step.type.bits == 64 else f"{number!r}f"


def _elements(step: BytesStep | RepeatStep) -> list[str]:
    """The elements of a default; none where there is none."""
    default = step.field.default
    if isinstance(step, RepeatStep):
        element = step.element
        if isinstance(default, tuple) and isinstance(element, IntegerStep):
            return [constant(int(value), element.type) for value in default]
        return []
    if not isinstance(default, str | bytes):
        return []
    if isinstance(default, str):
        return [_character(byte) for byte in raw_bytes(step.type, default)]
    return [hexadecimal(byte) for byte in default]


def _character(byte: int) -> str:
    """An element of an array of `char`, which may be signed."""
    if byte > 0x7F:
        return f"(char){hexadecimal(byte)}"
    return f"'{chr(byte)}'" if 0x20 <= byte < 0x7F and chr(byte) not in "'\\" else str(byte)
