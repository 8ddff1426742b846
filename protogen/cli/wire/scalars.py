"""Single values as people write them, made into raw values."""

from __future__ import annotations

import json
from collections.abc import Iterable, Mapping
from fractions import Fraction
from typing import Any

from protogen.cli.exits import UsageError
from protogen.cli.wire.hexinput import HexError, parse_hex
from protogen.model.readings import decimal
from protogen.model.types import Field, Integer
from protogen.problems import did_you_mean, hint_for
from protogen.runtime.nearest import nearest_reading


def integer_value(field: Field, type: Integer, written: Any, path: str) -> int:
    """Return the raw value of an integer. Raises UsageError."""
    if isinstance(written, int):
        return int(written)
    if isinstance(written, Mapping):
        return _bits(field, type, written, path)
    if not isinstance(written, str):
        raise refusal(path, written, allowed(field, type))
    if written.lstrip().startswith("{"):
        return integer_value(field, type, from_json(written, path), path)
    number = _number(written)
    if number is not None:
        return number
    named = _named(field, type, written.strip())
    if named is not None:
        return named
    physical = _physical(field, written)
    if physical is None:
        raise UsageError(
            f"{path}: `{written}` is none of: {allowed(field, type)}", _fix(field, type, written)
        )
    return _raw(field, type, physical, written, path)


def _fix(field: Field, type: Integer, written: str) -> str | None:
    """Return how to write what was probably meant."""
    names = _names(field, type)
    if type.flags is not None and "," in written:
        flags = "|".join(_closest(name.strip(), names) for name in written.split(","))
        return f"flags are joined by `|`, in quotes for the shell: '{flags}'"
    number = _exact(written.strip())
    if number is not None and field.unit is not None:
        nearest = _nearest(field, type, number)
        return f"a value in {field.unit} has its unit behind it: {nearest}" if nearest else None
    return hint_for(written, names)


def _closest(name: str, names: Mapping[str, int]) -> str:
    return did_you_mean(name, names) or name


def _number(text: str) -> int | None:
    try:
        return int(text, 0)
    except ValueError:
        return None


def _named(field: Field, type: Integer, text: str) -> int | None:
    names = _names(field, type)
    if type.flags is not None:
        bits = [names.get(name.strip(), _number(name)) for name in text.split("|")]
        return None if None in bits else _joined(bit for bit in bits if bit is not None)
    if type.role == "char" and len(text) == 3 and text[0] == text[-1] == "'":
        return ord(text[1])
    if type.role == "char" and len(text) == 1:
        return ord(text)
    return names.get(text)


def _names(field: Field, type: Integer) -> dict[str, int]:
    """Return every name that stands for a raw value."""
    names = {item.name: item.value for item in (type.enum.values if type.enum else ())}
    names |= {item.name: item.value for item in field.special}
    if type.flags is not None:
        names |= {flag.name: 1 << flag.bit for flag in type.flags.bits}
    if type.role == "bool":
        names |= {"false": 0, "true": 1}
    return names


def _joined(bits: Iterable[int]) -> int:
    value = 0
    for bit in bits:
        value |= bit
    return value


def _bits(field: Field, type: Integer, written: Mapping[str, Any], path: str) -> int:
    """Return an integer of which single flags or runs of bits are given."""
    value = field.default if isinstance(field.default, int) else 0
    flags = {flag.name: flag.bit for flag in (type.flags.bits if type.flags else ())}
    runs = {run.name: run for run in type.bit_fields}
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
    return value


def _run(path: str, written: Any, names: Mapping[str, int], greatest: int) -> int:
    text = str(written).strip().lower() if isinstance(written, bool) else str(written).strip()
    number = names.get(text, _number(text))
    if number is not None and 0 <= number <= greatest:
        return number
    kinds = ", ".join((f"a whole number from 0 to {greatest}", *names))
    raise UsageError(f"{path}: `{text}` is none of: {kinds}", hint_for(text, names))


def _physical(field: Field, text: str) -> Fraction | None:
    """Return the number in front of the field's unit; None if it is not that."""
    if field.unit is None or not text.strip().endswith(field.unit):
        return None
    return _exact(text.strip().removesuffix(field.unit).strip())


def _exact(text: str) -> Fraction | None:
    try:
        return Fraction(text)
    except (ValueError, ZeroDivisionError):
        return None


def _raw(field: Field, type: Integer, physical: Fraction, written: str, path: str) -> int:
    raw = (physical - field.offset) / field.scale
    nearest = _nearest(field, type, physical)
    hint = f"the nearest that can be sent is {nearest}" if nearest else None
    if raw.denominator != 1:
        step = f"{decimal(field.scale)}{field.unit}"
        raise UsageError(f"{path}: `{written}` is no whole number of steps of {step}", hint)
    special = next((item.name for item in field.special if item.value == raw), None)
    if special is not None:
        # As a name it may be given; as a number it is a mistake: nobody will read that number.
        raise UsageError(f"{path}: `{written}` is sent as {raw}, which means `{special}`", hint)
    return raw.numerator


def _nearest(field: Field, type: Integer, physical: Fraction) -> str | None:
    """Return the physical value closest to this one that a receiver reads as such, if any."""
    least, greatest = _bounds(field, type)
    special = {item.value for item in field.special}
    raw = nearest_reading((physical - field.offset) / field.scale, special, least, greatest)
    return None if raw is None else f"{decimal(raw * field.scale + field.offset)}{field.unit}"


def _bounds(field: Field, type: Integer) -> tuple[int, int]:
    """Return the least and the greatest raw value that an encoder allows."""
    least = type.least if field.least is None else field.least
    greatest = type.greatest if field.greatest is None else field.greatest
    return int(least), int(greatest)


def float_value(field: Field, written: Any, path: str) -> float:
    """Return the raw value of a floating-point number. Raises UsageError."""
    if isinstance(written, int | float):
        return float(written)
    text = written.strip() if isinstance(written, str) else ""
    physical = _physical(field, text)
    if physical is not None:
        return float((physical - field.offset) / field.scale)
    try:
        return float(text)
    except ValueError:
        raise refusal(path, written, "a number") from None


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


def allowed(field: Field, type: Integer) -> str:
    """Return what may be written for an integer, in words."""
    least, greatest = _bounds(field, type)
    kinds = [f"a whole number from {least} to {greatest}"]
    if field.unit is not None:
        kinds.append(f"a number with its unit {field.unit}")
    if type.role == "char":
        kinds.append("a character")
    names = list(_names(field, type))
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


def from_json(text: str, path: str) -> Any:
    """Return what the JSON text stands for. Raises UsageError."""
    try:
        return json.loads(text)
    except (ValueError, RecursionError) as error:
        raise UsageError(f"{path}: `{text}` is not JSON: {error}") from None
