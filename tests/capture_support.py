"""Tables of captures, compared with each other and with the events of the Python decoder."""

from __future__ import annotations

import math
from collections import ChainMap
from pathlib import Path
from typing import Any

from compiled import module_at
from expression_oracle import worked_out

from protogen.capture import Column, Tables
from protogen.capture.schema import OF_MESSAGES, Choice, Number, Record, Shape, Text
from protogen.model.expressions import Expression
from protogen.runtime.values import as_dict

Scope = ChainMap[str, Any]


def assert_same_tables(found: Tables, expected: Tables) -> None:
    """The same events, byte for byte, but for the bits of what is not a number."""
    assert list(found.messages) == list(expected.messages)
    for name, table in expected.messages.items():
        assert_same_messages(found, expected, name)
        assert len(found.messages[name]) == len(table)
    for word in ("invalid", "unknown"):
        assert getattr(found, word).dtype == getattr(expected, word).dtype
        assert getattr(found, word).tobytes() == getattr(expected, word).tobytes(), word
    assert found.payloads.tobytes() == expected.payloads.tobytes()
    for word in ("offset", "size", "sequence", "events"):
        assert getattr(found, word) == getattr(expected, word), word


def assert_same_messages(found: Tables, expected: Tables, name: str) -> None:
    one, other = found.messages[name], expected.messages[name]
    assert one.dtype == other.dtype
    assert len(one) == len(other), name
    if one.tobytes() == other.tobytes():
        return
    # Python reads a signalling NaN as a quiet one, which cases of a union show in other members.
    for number, rows in enumerate(zip(one, other, strict=True)):
        if rows[0].tobytes() != rows[1].tobytes():
            shown, wanted = (_shown(found, name, row) for row in rows)
            assert shown == wanted, f"{name}[{number}] is\n{shown}, not\n{wanted}"
            assert "'nan'" in str(wanted), f"{name}[{number}] differs in bytes without a meaning"


def _shown(tables: Tables, name: str, row: Any) -> tuple[Any, ...]:
    columns = tables.schema.messages[name].columns
    head = [row[c.name].item() for c in columns if c.role not in OF_MESSAGES]
    return (*head, fields_of(tables, name, row))


# --- rows as what `to_dict` gives -----------------------------------------------------------------


def fields_of(tables: Tables, name: str, row: Any) -> dict[str, Any]:
    """The fields of a row, as the message's `to_dict` gives them, but for constants."""
    return _record(tables.schema.messages[name].fields, row, Scope())


def _record(columns: tuple[Column, ...], row: Any, around: Scope) -> dict[str, Any]:
    scope = around.new_child(_numbers(columns, row))
    return {
        column.source: _value(column, row[column.name], 0, scope)
        if column.when is None or _said(column.when, scope)
        else None
        for column in columns
        if column.role == "field"
    }


def _numbers(columns: tuple[Column, ...], row: Any) -> dict[str, Any]:
    """The numbers of a record, and those of records in it."""
    found: dict[str, Any] = {}
    for column in columns:
        if not column.dimensions and isinstance(column.shape, Number):
            found[column.name] = row[column.name].item()
        elif not column.dimensions and isinstance(column.shape, Record):
            found[column.name] = _numbers(column.shape.columns, row[column.name])
    return found


def _value(column: Column, value: Any, depth: int, scope: Scope) -> Any:
    rest = column.dimensions[depth:]
    if isinstance(column.shape, Text) and len(rest) == 1:
        text = bytes(value).decode("latin-1")
        count = rest[0].counted_by
        return text if count is None else text.ljust(_said(count, scope), "\0")
    if not rest:
        return _plain(column.shape, value, scope)
    counted_by = rest[0].counted_by
    count = len(value) if counted_by is None else _said(counted_by, scope)
    found = [_value(column, value[place], depth + 1, scope) for place in range(count)]
    octets = type(column.type).__name__ == "Octets" or _is_octets(column)
    return bytes(found).hex() if octets and len(rest) == 1 else found


def _is_octets(column: Column) -> bool:
    type_ = column.type
    while hasattr(type_, "element"):
        type_ = type_.element
    return type_ is None or type(type_).__name__ == "Octets"


def _plain(shape: Shape, value: Any, scope: Scope) -> Any:
    match shape:
        case Record(columns=columns):
            return _record(columns, value, scope)
        case Choice():
            return _choice(shape, value, scope)
        case _:
            number = value.item()
            if isinstance(number, float) and not math.isfinite(number):
                return "nan" if math.isnan(number) else "inf" if number > 0 else "-inf"
            return number


def _said(number: int | str | Expression, scope: Scope) -> int:
    if isinstance(number, int | str):
        return number if isinstance(number, int) else int(scope[number])
    return worked_out(number, scope)


def _choice(choice: Choice, value: Any, scope: Scope) -> Any:
    chosen = _said(choice.selector, scope)
    for number, case in choice.cases:
        if number == chosen or (number is None and chosen not in choice.empty):
            return _value(case, value[case.name], 0, scope)
    if chosen in choice.empty or choice.rest is None:
        return None
    rest = value[choice.rest.name]
    return bytes(rest["bytes"][: rest["size"]]).hex()


def described(tables: Tables) -> list[tuple[Any, ...]]:
    """Every event, in order: offset, size, and what it is."""
    found: list[tuple[Any, ...]] = []
    for name, table in tables.messages.items():
        columns = tables.schema.messages[name].columns
        for row in table:
            shown = _parts(columns, row)
            found.append((*_place(row), name, shown, fields_of(tables, name, row)))
    found += [(*_place(row), "invalid", int(row["reason"])) for row in tables.invalid]
    for row in tables.unknown:
        shown = _parts(tables.schema.unknown.columns, row)
        found.append((*_place(row), "unknown", shown, tables.payload(row)))
    return sorted(found, key=lambda item: item[0])


def _parts(columns: tuple[Column, ...], row: Any) -> dict[str, Any]:
    parts = [column for column in columns if column.role == "part"]
    return {part.source: _value(part, row[part.name], 0, Scope()) for part in parts}


def _place(row: Any) -> tuple[int, int, int]:
    return int(row["sequence"]), int(row["offset"]), int(row["size"])


def expected_of(path: Path, sender: str, data: bytes) -> list[tuple[Any, ...]]:
    """The same, from the events of the Python decoder."""
    from protogen.capture import InvalidReason

    decoder = module_at(path).Decoder(sender)
    found: list[tuple[Any, ...]] = []
    for number, event in enumerate([*decoder.feed(data), *decoder.flush()]):
        place = (number, event.offset, event.size)
        match event.kind:
            case "message":
                values = _without_constants(event.message)
                found.append((*place, event.message.NAME, as_dict(event.parts), values))
            case "unknown":
                found.append((*place, "unknown", as_dict(event.parts), event.payload))
            case _:
                found.append((*place, "invalid", int(InvalidReason[event.reason.upper()])))
    return found


def _without_constants(record: Any) -> dict[str, Any]:
    return _stripped(type(record), record.to_dict())


def _stripped(cls: Any, shown: dict[str, Any]) -> dict[str, Any]:
    kept: dict[str, Any] = {}
    for name, each in cls.RULES:
        rule = getattr(each, "rule", each)
        if getattr(rule, "const", None) is not None:
            continue
        value = _stripped_value(rule, shown[name], shown)
        if value is not ...:
            kept[name] = value
    return kept


def _stripped_value(rule: Any, value: Any, shown: dict[str, Any]) -> Any:
    """The value without constants; an ellipsis where nothing is left."""
    if value is None:
        return value if _holds(rule) else ...
    match type(rule).__name__:
        case "StructRule":
            found = _stripped(rule.record, value)
            return found or ...
        case "ArrayRule":
            each = [_stripped_value(rule.element, item, shown) for item in value]
            probe = _holds(rule.element)
            return each if probe else ...
        case "SwitchRule":
            return _stripped_case(rule, value, shown)
        case _:
            return value


def _stripped_case(rule: Any, value: Any, shown: dict[str, Any]) -> Any:
    if not isinstance(value, dict):
        return value
    for case in rule.cases.values():
        if case is not None and type(case).__name__ == "StructRule":
            names = {name for name, _ in case.record.RULES}
            if names == set(value):
                found = _stripped(case.record, value)
                return found or None
    return value


def _holds(rule: Any) -> bool:
    if type(rule).__name__ == "StructRule":
        return any(
            getattr(inner, "const", None) is None and _holds(inner)
            for _, inner in rule.record.RULES
        )
    if type(rule).__name__ == "ArrayRule":
        return _holds(rule.element)
    return True
