"""Single values as people write them, made into raw values."""

from __future__ import annotations

import json
import math
from collections.abc import Mapping
from fractions import Fraction
from functools import reduce
from operator import or_
from typing import Any

from protogen.cli.exits import UsageError
from protogen.convert.inputs.hex_digits import HexError, parse_hex
from protogen.model.payload_plan import IntegerStep
from protogen.model.reading.readings import decimal
from protogen.model.types import Field
from protogen.problems import did_you_mean, hint_for
from protogen.runtime.payload.nearest import nearest_reading
from protogen.schema.text.scalars import exact_number


def integer_value(step: IntegerStep, written: Any, path: str) -> int:
    """Return the raw value of an integer. Raises UsageError."""
    if isinstance(written, bool):
        written = str(written).lower()
    if isinstance(written, int):
        return int(written)
    if isinstance(written, Mapping) and (step.type.flags or step.type.bit_fields):
        return _bits(step, written, path)
    if not isinstance(written, str):
        raise refusal(path, written, allowed(step))
    if written.lstrip().startswith("{") and not (step.type.role == "char" and len(written) == 1):
        return integer_value(step, from_json(written, path), path)
    number = _number(written)
    if number is not None:
        return number
    named = _named(step, written.strip())
    if named is not None:
        return named
    physical = _physical(step.field, written)
    if physical is None:
        raise UsageError(f"{path}: `{written}` is none of: {allowed(step)}", _fix(step, written))
    return _raw(step, physical, written, path)


def _fix(step: IntegerStep, written: str) -> str | None:
    """Return how to write what was probably meant."""
    names = _names(step)
    if step.type.flags is not None and "," in written:
        flags = "|".join(_closest(name.strip(), names) for name in written.split(","))
        return f"flags are joined by `|`, in quotes for the shell: '{flags}'"
    number = exact_number(written.strip())
    if number is not None and step.field.unit is not None:
        nearest = _nearest(step, number)
        return (
            f"a value in {step.field.unit} has its unit behind it: {nearest}" if nearest else None
        )
    return hint_for(written, names)


def _closest(name: str, names: Mapping[str, int]) -> str:
    return did_you_mean(name, names) or name


def _number(text: str) -> int | None:
    try:
        return int(text, 0)
    except ValueError:
        return None


def _named(step: IntegerStep, text: str) -> int | None:
    names = _names(step)
    if step.type.flags is not None:
        bits = [names.get(name.strip(), _number(name)) for name in text.split("|")]
        return None if None in bits else reduce(or_, filter(None, bits), 0)
    if step.type.role == "char" and len(text) == 3 and text[0] == text[-1] == "'":
        return ord(text[1])
    if step.type.role == "char" and len(text) == 1:
        return ord(text)
    return names.get(text)


def _names(step: IntegerStep) -> dict[str, int]:
    """Return every name that stands for a raw value."""
    names = {item.name: item.value for item in (step.type.enum.values if step.type.enum else ())}
    names |= {item.name: item.value for item in step.field.special}
    if step.type.flags is not None:
        names |= {flag.name: 1 << flag.bit for flag in step.type.flags.bits}
    if step.type.role == "bool":
        names |= {"false": 0, "true": 1}
    return names


def _bits(step: IntegerStep, written: Mapping[str, Any], path: str) -> int:
    """Return an integer of which single flags or runs of bits are given."""
    value = step.field.default if isinstance(step.field.default, int) else 0
    flags = {flag.name: flag.bit for flag in (step.type.flags.bits if step.type.flags else ())}
    runs = {run.name: run for run in step.type.bit_fields}
    given: dict[str, tuple[int, int]] = {}
    for name, item in written.items():
        if name in flags:
            low, mask, names = flags[name], 1 << flags[name], {"false": 0, "true": 1}
        elif name in runs:
            run = runs[name]
            low, mask = run.low, run.mask
            names = {item.name: item.value for item in (run.enum.values if run.enum else ())}
        else:
            hint = hint_for(name, (*flags, *runs))
            raise UsageError(f"{path} has no bits called `{name}`", hint)
        value = value & ~mask | _run(f"{path}.{name}", item, names, mask >> low) << low
        given |= {name: (mask, value & mask)}
    for name, (mask, due) in given.items():
        if value & mask != due:
            raise UsageError(f"{path}.{name} shares bits with others, which say something else")
    return value


def _run(path: str, written: Any, names: Mapping[str, int], greatest: int) -> int:
    text = str(written).strip().lower() if isinstance(written, bool) else str(written).strip()
    number = names.get(text, _number(text))
    if number is not None and 0 <= number <= greatest and not number & ~greatest:
        return number
    kinds = ", ".join((f"a whole number from 0 to {greatest}", *names))
    raise UsageError(f"{path}: `{text}` is none of: {kinds}", hint_for(text, names))


def _physical(field: Field, text: str) -> Fraction | None:
    """Return the number in front of the field's unit; None if it is not that."""
    if field.unit is None or not text.strip().endswith(field.unit):
        return None
    return exact_number(text.strip().removesuffix(field.unit).strip())


def _raw(step: IntegerStep, physical: Fraction, written: str, path: str) -> int:
    field = step.field
    raw = (physical - field.offset) / field.scale
    nearest = _nearest(step, physical)
    hint = f"the nearest that can be sent is {nearest}" if nearest else None
    if raw.denominator != 1:
        size = f"{decimal(field.scale)}{field.unit}"
        raise UsageError(f"{path}: `{written}` is no whole number of steps of {size}", hint)
    special = next((item.name for item in field.special if item.value == raw), None)
    if special is not None:
        # As a name it may be given; as a number it is a mistake: nobody will read that number.
        raise UsageError(f"{path}: `{written}` is sent as {raw}, which means `{special}`", hint)
    return raw.numerator


def _nearest(step: IntegerStep, physical: Fraction) -> str | None:
    """Return the physical value closest to this one that a receiver reads as such, if any."""
    field = step.field
    special = {item.value for item in field.special}
    raw = nearest_reading((physical - field.offset) / field.scale, special, *step.bounds)
    return None if raw is None else f"{decimal(raw * field.scale + field.offset)}{field.unit}"


def float_value(field: Field, written: Any, path: str) -> float:
    """Return the raw value of a floating-point number. Raises UsageError."""
    is_number = isinstance(written, int | float) and not isinstance(written, bool)
    text = written.strip() if isinstance(written, str) else ""
    physical = _physical(field, text)
    try:
        if physical is not None:
            return float((physical - field.offset) / field.scale)
        value = float(written if is_number else text)
    except OverflowError:
        raise UsageError(f"{path}: `{written}` is too large for 64 bits") from None
    except ValueError:
        raise refusal(path, written, "a number") from None
    if math.isinf(value) and any(map(str.isdigit, text)):
        raise UsageError(f"{path}: `{written}` is too large for 64 bits, and no infinity")
    return value


def octets_value(written: Any, path: str) -> bytes:
    """Return bytes. Raises UsageError."""
    if isinstance(written, str) and written.startswith("text:"):
        return _latin(written.removeprefix("text:"), path)
    if isinstance(written, str):
        try:
            return parse_hex(written.removeprefix("hex:"))
        except HexError as error:
            hint = "bytes are written hex:1B02 or text:abc"
            raise UsageError(f"{path}: `{written}`: {error}", hint) from None
    raise refusal(path, written, "bytes: hex:1B02 or text:abc")


def _latin(text: str, path: str) -> bytes:
    try:
        return text.encode("latin-1")
    except UnicodeEncodeError as error:
        raise UsageError(f"{path}: `{text[error.start]}` is not one byte") from None


def allowed(step: IntegerStep) -> str:
    """Return what may be written for an integer, in words."""
    least, greatest = step.bounds
    kinds = [f"a whole number from {least} to {greatest}"]
    if step.field.unit is not None:
        kinds.append(f"a number with its unit {step.field.unit}")
    if step.type.role == "char":
        kinds.append("a character")
    names = list(_names(step))
    return ", ".join((*kinds, *names))


def refusal(path: str, written: Any, kinds: str) -> UsageError:
    """Return the error that says what may stand in the place of ``written``."""
    return UsageError(f"{path}: {json.dumps(written, default=str)} is none of: {kinds}")


def text_value(written: Any, path: str) -> str:
    """Return a text; one in double quotes has the escapes of JSON. Raises UsageError."""
    if not isinstance(written, str):
        raise refusal(path, written, "a text")
    if len(written) > 1 and written[0] == written[-1] == '"':
        return str(from_json(written, path))
    return written


def finite(digits: str) -> float:
    """Return a floating-point number of JSON. Raises ValueError where it would be infinite."""
    number = float(digits)
    if math.isinf(number):
        raise ValueError(f"{digits} is too large for 64 bits")
    return number


def from_json(text: str, path: str) -> Any:
    """Return what the JSON text stands for. Raises UsageError."""
    try:
        return json.loads(text, parse_float=finite)
    except (ValueError, RecursionError) as error:
        raise UsageError(f"{path}: `{text}` is not JSON: {error}") from None
