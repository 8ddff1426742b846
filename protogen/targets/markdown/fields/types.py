"""Types in words."""

from __future__ import annotations

from functools import lru_cache

from protogen.model.payload_plan import (
    AnyStep,
    BytesStep,
    ChooseStep,
    ConstantStep,
    Count,
    NumberStep,
    RecordStep,
    RepeatStep,
)
from protogen.model.types import NumberType, Text
from protogen.targets.markdown.text.words import code, plural

_ORDERS = {"little": "LE", "big": "BE"}
_BIT_ORDERS = {
    "lsb_first": "least significant bits first",
    "msb_first": "most significant bits first",
}


def type_text(step: AnyStep) -> str:
    """Print a type with its byte order: ``uint16 LE``."""
    match step:
        case NumberStep():
            return number_text(step.type)
        case BytesStep():
            name = "ascii" if isinstance(step.type, Text) else "bytes"
            return _extended(code(name), step.count, "byte")
        case RepeatStep():
            return _extended(type_text(step.element), step.count, "element") + _packed(step)
        case ConstantStep():
            return type_text(step.value)
        case ChooseStep():
            return f"depends on {code(step.selector_name)}"
        case RecordStep():
            return "struct" + _packed(step)


def _packed(step: RecordStep | RepeatStep) -> str:
    return "" if step.packing is None else f" (packed, {_BIT_ORDERS[step.packing.order]})"


@lru_cache(maxsize=1024)
def number_text(kind: NumberType) -> str:
    """Print a number's type with its byte order."""
    return f"{code(kind.name)} {_ORDERS[kind.byte_order]}" if kind.size > 1 else code(kind.name)


def _extended(element: str, count: Count, noun: str) -> str:
    if count.fills:
        return f"{element} to the end, at most {plural(count.greatest, noun)}"
    if count.field:
        return f"{element} x {code(count.field)}"
    return element if noun == "byte" else f"{element} x {count.known}"
