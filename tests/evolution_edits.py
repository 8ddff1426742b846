"""Edits that an engineer makes when a protocol changes. Most of what they make compiles."""

from __future__ import annotations

import copy
from collections.abc import Callable, Iterator
from random import Random
from typing import Any

Data = dict[str, Any]
NUMBERS = ("uint8", "sint8", "uint16", "sint16", "uint24", "uint32", "sint32", "float32", "bool")
ALGORITHMS = ("xor-8", "sum-8", "sum-8/negated", "CRC-8/SMBUS", "CRC-16/KERMIT", "CRC-16/XMODEM")


def edited(data: Data, dice: Random) -> Data:
    """The schema with one to three edits."""
    result = copy.deepcopy(data)
    for _ in range(dice.choice([1, 1, 2, 3])):
        dice.choice(EDITS)(result, dice)
    return result


def field_maps(data: Any) -> Iterator[Data]:
    """Every mapping of fields in a schema."""
    if isinstance(data, dict):
        for key, value in data.items():
            if key == "fields" and isinstance(value, dict) and value:
                yield value
            yield from field_maps(value)
    elif isinstance(data, list):
        for item in data:
            yield from field_maps(item)


def mappings_with(data: Any, key: str) -> Iterator[Data]:
    """Every mapping that has a key."""
    if isinstance(data, dict):
        if key in data:
            yield data
        for value in data.values():
            yield from mappings_with(value, key)
    elif isinstance(data, list):
        for item in data:
            yield from mappings_with(item, key)


def _some(items: Iterator[Data], dice: Random) -> Data | None:
    found = list(items)
    return dice.choice(found) if found else None


def _field(data: Data, dice: Random) -> tuple[Data, str] | None:
    fields = _some(field_maps(data.get("messages")), dice)
    return None if fields is None else (fields, dice.choice(list(fields)))


def _reordered(mapping: Data, dice: Random) -> None:
    items = list(mapping.items())
    dice.shuffle(items)
    mapping.clear()
    mapping.update(items)


def reorder_fields(data: Data, dice: Random) -> None:
    fields = _some(field_maps(data.get("messages")), dice)
    if fields is not None:
        _reordered(fields, dice)


def delete_field(data: Data, dice: Random) -> None:
    found = _field(data, dice)
    if found is not None:
        del found[0][found[1]]


def add_field(data: Data, dice: Random) -> None:
    fields = _some(field_maps(data.get("messages")), dice)
    if fields is not None:
        items = list(fields.items())
        items.insert(dice.randrange(len(items) + 1), ("brand_new", {"type": dice.choice(NUMBERS)}))
        fields.clear()
        fields.update(items)


def rename_field(data: Data, dice: Random) -> None:
    found = _field(data, dice)
    if found is not None:
        fields, name = found
        items = [("other_name" if key == name else key, value) for key, value in fields.items()]
        fields.clear()
        fields.update(items)


def _own(fields: Data, name: str) -> Data:
    if not isinstance(fields[name], dict):
        fields[name] = {"type": fields[name]}
    own: Data = fields[name]
    return own


def change_type(data: Data, dice: Random) -> None:
    found = _field(data, dice)
    if found is not None:
        _own(*found)["type"] = dice.choice(NUMBERS)


def change_meaning(data: Data, dice: Random) -> None:
    found = _field(data, dice)
    if found is None:
        return
    own = _own(*found)
    key = dice.choice(["scale", "offset", "unit", "range", "byte_order", "default", "special"])
    own[key] = {
        "scale": dice.choice(["1/10", 2, -1]),
        "offset": dice.choice([1, -40]),
        "unit": dice.choice(["mm", "deg", "V"]),
        "range": [0, dice.choice([1, 10, 100])],
        "byte_order": dice.choice(["little", "big"]),
        "default": dice.choice([0, 1]),
        "special": {"not_there": dice.choice([0, 1, 255])},
    }[key]


def change_part(data: Data, dice: Random) -> None:
    """A number of the frame becomes a field of the payload, or the other way round."""
    found = _some(mappings_with(data.get("messages"), "part"), dice)
    if found is None:
        return
    if dice.random() < 0.5:
        del found["part"]
    else:
        found["part"] = dice.choice([*data["frame"], "kind"])


def drop_meaning(data: Data, dice: Random) -> None:
    keys = ["scale", "offset", "unit", "range", "byte_order", "default", "special", "const"]
    key = dice.choice(keys)
    found = _some(mappings_with([data.get("messages"), data.get("types")], key), dice)
    if found is not None:
        del found[key]


def change_values(data: Data, dice: Random) -> None:
    found = _some(mappings_with([data.get("messages"), data.get("types")], "values"), dice)
    if found is None or not isinstance(found["values"], dict) or not found["values"]:
        return
    values = found["values"]
    name = dice.choice(list(values))
    match dice.randrange(4):
        case 0:
            del values[name]
        case 1:
            values["renamed_value"] = values.pop(name)
        case 2:
            values["new_value"] = dice.randrange(4)
        case _:
            other = dice.choice(list(values))
            values[name], values[other] = values[other], values[name]


def change_closed(data: Data, dice: Random) -> None:
    found = _some(mappings_with([data.get("messages"), data.get("types")], "values"), dice)
    if found is not None:
        found["closed"] = not found.get("closed", False)


def change_flags(data: Data, dice: Random) -> None:
    found = _some(mappings_with([data.get("messages"), data.get("types")], "flags"), dice)
    if found is None or not isinstance(found["flags"], dict) or not found["flags"]:
        return
    name = dice.choice(list(found["flags"]))
    if dice.random() < 0.3:
        del found["flags"][name]
    else:
        found["flags"][name] = dice.randrange(8)


def change_count(data: Data, dice: Random) -> None:
    key = dice.choice(["count", "size"])
    found = _some(mappings_with([data.get("messages"), data.get("types")], key), dice)
    if found is not None and isinstance(found[key], int):
        found[key] = max(1, found[key] + dice.choice([-1, 1, 2]))


def change_identity(data: Data, dice: Random) -> None:
    found = _some(mappings_with(data.get("messages"), "id"), dice)
    if found is None:
        return
    if isinstance(found["id"], int):
        found["id"] += dice.choice([-1, 1, 2])
    elif isinstance(found["id"], dict):
        name = dice.choice(list(found["id"]))
        if isinstance(found["id"][name], int):
            found["id"][name] += dice.choice([-1, 1, 2])


def exchange_identities(data: Data, dice: Random) -> None:
    messages = [item for item in data["messages"].values() if "id" in item]
    if len(messages) > 1:
        one, other = dice.sample(messages, 2)
        one["id"], other["id"] = other["id"], one["id"]


def delete_message(data: Data, dice: Random) -> None:
    if len(data["messages"]) > 1:
        del data["messages"][dice.choice(list(data["messages"]))]


def rename_message(data: Data, dice: Random) -> None:
    name = dice.choice(list(data["messages"]))
    items = [
        ("other_one" if key == name else key, value) for key, value in data["messages"].items()
    ]
    data["messages"] = dict(items)


def _frames(data: Data) -> Any:
    return data.get("frame", data.get("forms"))


def change_literal(data: Data, dice: Random) -> None:
    found = _some(mappings_with(_frames(data), "literal"), dice)
    if found is not None:
        found["literal"] = [dice.randrange(256)]


def change_checksum(data: Data, dice: Random) -> None:
    found = _some(mappings_with(_frames(data), "algorithm"), dice)
    if found is None:
        return
    if dice.random() < 0.5:
        found["algorithm"] = dice.choice(ALGORITHMS)
        found["type"] = "uint16" if "16" in str(found["algorithm"]) else "uint8"
    else:
        found["covers"] = "payload"


def change_order(data: Data, dice: Random) -> None:
    data["byte_order"] = "big" if data.get("byte_order") == "little" else "little"


EDITS: tuple[Callable[[Data, Random], None], ...] = (
    reorder_fields,
    delete_field,
    add_field,
    rename_field,
    change_type,
    change_type,
    change_meaning,
    change_meaning,
    drop_meaning,
    change_part,
    change_values,
    change_values,
    change_closed,
    change_flags,
    change_count,
    change_identity,
    exchange_identities,
    delete_message,
    rename_message,
    change_literal,
    change_checksum,
    change_order,
)
