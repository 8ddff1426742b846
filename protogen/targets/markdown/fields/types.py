"""Types in words."""

from __future__ import annotations

from functools import lru_cache

from protogen.model.numbers import FreeNumeral, Numeral
from protogen.model.payload_plan import (
    AnyStep,
    BytesStep,
    ChooseStep,
    ConditionalPresence,
    ConstantStep,
    Count,
    NumberStep,
    OptionalStep,
    RecordStep,
    RegionStep,
    RepeatStep,
    TrailingPresence,
)
from protogen.model.types import Between, NumberType, Octets, Text
from protogen.targets.markdown.text.words import code, hex_number, plural

_ORDERS = {"little": "LE", "big": "BE"}
_BIT_ORDERS = {
    "lsb_first": "least significant bits first",
    "msb_first": "most significant bits first",
}


def type_text(step: AnyStep, region: RegionStep | None = None) -> str:
    """Print a type with its byte order: ``uint16 LE``. It lies in a region, or in none."""
    match step:
        case NumberStep():
            return number_text(step.type)
        case BytesStep():
            return _extended(_string(step.type), step.count, "byte", region)
        case RepeatStep():
            element = type_text(step.element, region)
            return _extended(element, step.count, "element", region) + _packed(step)
        case ConstantStep():
            return type_text(step.value, region)
        case ChooseStep():
            return f"depends on {code(step.expression.text)}"
        case RecordStep():
            return "struct" + _packed(step)
        case OptionalStep():
            return f"{type_text(step.step, region)}, {_presence(step)}"
        case RegionStep():
            inner = type_text(step.step, step)
            return inner if step.step.fills else f"{inner}, in {_region(step.region)}"


def _presence(step: OptionalStep) -> str:
    match step.presence:
        case ConditionalPresence(expression=condition):
            return f"if {code(condition.text)}"
        case TrailingPresence():
            return "may be left out"


def end_of(region: RegionStep | None) -> str:
    """Print the end of what is left: that of a region, or of the payload."""
    return "the end" if region is None else f"the end of {_region(region.region)}"


def _region(region: Count) -> str:
    if region.expression is not None:
        return f"{code(region.expression.text)} bytes"
    return plural(region.known or 0, "byte")


def _packed(step: RecordStep | RepeatStep) -> str:
    return "" if step.packing is None else f" (packed, {_BIT_ORDERS[step.packing.order]})"


@lru_cache(maxsize=1024)
def number_text(kind: NumberType) -> str:
    """Print a number's type with its byte order, or with how it is written as text."""
    form = kind.text
    if isinstance(form, FreeNumeral):
        return f"{code(form.name)}, {_free_text(form)}"
    if form is not None:
        return f"{code(kind.name)} as text, {_digits_text(form)}"
    is_plain = kind.size <= 1 or kind.is_text or kind.within is not None
    return code(kind.name) if is_plain else f"{code(kind.name)} {_ORDERS[kind.byte_order]}"


def _digits_text(form: Numeral) -> str:
    """Print how many digits there are, and of what kind."""
    if form.known == "base10":
        return plural(form.size, "decimal digit")
    if form.known:
        letters = "upper" if form.known.endswith("upper") else "lower"
        return f"{plural(form.size, 'hexadecimal digit')} ({letters} case)"
    bits, first = form.base.bit_length() - 1, hex_number(form.alphabet[0], 8)
    return f"{plural(form.size, 'character')}, each {plural(bits, 'bit')} plus {code(first)}"


def _free_text(form: FreeNumeral) -> str:
    """Print how many digits there are in front of the point, and behind it, and what separates."""
    digits = _digits_of_free(form)
    empty = " or nothing" if form.empty else ""
    return f"{digits}{empty}{_behind_separator(form)}"


def _behind_separator(form: FreeNumeral) -> str:
    if form.separator is None or not form.leads:
        return ""
    return f", behind {_shown(form.separator)}"


def _digits_of_free(form: FreeNumeral) -> str:
    if form.base == 256:
        return "1 character"
    digits = f"{form.padded} to {form.front}" if form.padded < form.front else str(form.front)
    front = f"{digits} digit{'' if form.front == 1 else 's'}"
    if form.fraction:
        return f"{front}, point, {plural(form.fraction, 'digit')}"
    return front if form.base == 10 else f"{front} ({'upper' if form.upper else 'lower'} case)"


def _end(count: Count, region: RegionStep | None) -> str:
    """Print what ends bytes or elements that nothing counts."""
    if count.tail is not None:
        return "up to what follows"
    if count.between is not None:
        return _between(count.between)
    if count.until is not None:
        return f"up to {code(f'{count.until:02X}')}"
    if count.mark is not None:
        return f"up to the first whose {code(count.mark.label)} is not 0"
    return f"to {end_of(region)}"


def _between(between: Between) -> str:
    """Print where a text ends, and which characters it can't have."""
    end = "the end" if between.takes_rest else f"the next {_shown(between.separator)}"
    excluded = [it for it in range(0x20, 0x7F) if it not in between.alphabet]
    without = f", without {' '.join(map(_shown, excluded))}" if excluded else ""
    return f"up to {end}{without}"


def _shown(byte: int) -> str:
    return code(chr(byte) if 0x20 < byte < 0x7F else f"{byte:02X}")


def _string(type_: Text | Octets) -> str:
    """Name the type of a text, with its form, or of bytes."""
    name = code(type_.word)
    form = type_.form.label if isinstance(type_, Text) else ""
    return f"{name} ({code(form)})" if form else name


def _extended(element: str, count: Count, noun: str, region: RegionStep | None) -> str:
    if count.is_delimited:
        amount = plural(count.greatest, noun)
        amount = f"{count.least} to {amount}" if count.least else f"at most {amount}"
        return f"{element} {_end(count, region)}, {amount}"
    if count.expression is not None:
        return f"{element} x {code(count.expression.text)}"
    return element if noun == "byte" else f"{element} x {count.known}"
