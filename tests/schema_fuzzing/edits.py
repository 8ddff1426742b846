"""Random edits of schemas: what people get wrong, and worse."""

from __future__ import annotations

import copy
from collections.abc import Callable, Iterator
from typing import Any

from hypothesis import strategies as st

Container = dict[Any, Any] | list[Any]
Place = tuple[Container, Any]
"""A mapping or list, and a key or index in it."""

JUNK: tuple[Any, ...] = (
    None, True, False, 0, -1, 1, 7, 64, 255, 256, 300, 2**31, 2**64, -(2**63), 10**30, 10**390,
    0.5, -0.0, 1e308, float("nan"), float("inf"), "", " ", "x", "A", "é", "漢", "\x00", "\n",
    "fill", "payload", "self", "class", "__init__", "Not A Name", "a" * 5000, "uint0", "uint8",
    "uint65", "lsb_first", "decimal", "hexadecimal", "base10",
    "uint999999999999", "sint16", "float32", "bool", "byte", "char", "ascii", "bytes", "little",
    "big", "on", "..", "a..b", "payload..payload", "0..3", "5..2", "6..99", "1/0", "1/3", "-1/7",
    "0x10", "1e999", "cobs", "slip", "hdlc", "base16-upper", "xor-8", "CRC-99/NONE", "unspecified",
    [], [[]], [None], [1, 2], [2, 1], [300], [-1], ["payload"], ["a", "b"], [True], [1.5, "x"], {},
    {"hex": "0"}, {"hex": "ZZ"}, {"hex": "0A 0B"}, {"text": "漢"}, {"text": "ab"}, {"fill": True},
    {"fill": False}, {"fill": True, "max": -1}, {"type": "uint8"}, {"type": "uint8", "count": "x"},
    {"byte": 0, "max": 2}, {"element": "x", "max": 2}, {"element": "x.last"},
    {"fields": {}}, {"fields": {"x": "uint8"}}, {"xor": 999}, {"width": 0, "poly": 1},
    {"width": 8, "poly": 999}, {1: 2}, {True: 1}, {"a": {"b": {"c": [1, {"d": None}]}}},
    {"literal": {"hex": ""}}, {"type": "uint8", "id": True}, {"type": "uint8", "counts": "payload"},
    {"type": "uint8", "algorithm": "xor-8", "covers": []}, {"value": 1}, {"bit": 70},
    {"bits": "3..1"}, {"title": 1}, {"escape": {"byte": 300, "of": [300], "transform": "none"}},
)  # fmt: skip

NEW_KEYS: tuple[Any, ...] = (
    "type", "fields", "count", "size", "values", "closed", "flags", "bits", "const", "default",
    "packed", "range", "scale", "offset", "unit", "special", "switch", "cases", "byte_order",
    "unknown", "digits", "code", "chars", "fraction", "case", "empty", "separator", "until",
    "in_front", "byte", "element", "id",
    "from", "min_size", "max_size", "literal", "unprotected", "counts", "counter", "algorithm",
    "covers", "over", "when", "escape", "substitute", "encoding", "preset", "lenient", "examples",
    "overloads", "exchanges", "decisions", "reserved", "link", "types", "transparency", "payload",
    "extends", "version", "content_covers", "remove", "rename", "replace", "after", "x", "class",
    "X", "", 5, True,
)  # fmt: skip


@st.composite
def edited(draw: st.DrawFn, data: dict[str, Any]) -> dict[str, Any]:
    """The data with one to three edits."""
    result = copy.deepcopy(data)
    for _ in range(draw(st.integers(1, 3))):
        places = list(_places(result))
        if places:
            draw(st.sampled_from(_EDITS))(draw, places)
    return result


def _places(container: Container) -> Iterator[Place]:
    keys = list(container) if isinstance(container, dict) else list(range(len(container)))
    for key in keys:
        yield container, key
        if isinstance(container[key], dict | list):
            yield from _places(container[key])


def _pick(draw: st.DrawFn, places: list[Place]) -> Place:
    return draw(st.sampled_from(places))


def _delete(draw: st.DrawFn, places: list[Place]) -> None:
    container, key = _pick(draw, places)
    del container[key]


def _replace(draw: st.DrawFn, places: list[Place]) -> None:
    container, key = _pick(draw, places)
    container[key] = copy.deepcopy(draw(st.sampled_from(JUNK)))


def _nudge(draw: st.DrawFn, places: list[Place]) -> None:
    """Change a number a little, or a text by a letter; else replace it."""
    container, key = _pick(draw, places)
    value = container[key]
    if isinstance(value, int) and not isinstance(value, bool):
        container[key] = value + draw(st.sampled_from([-1, 1, 256, -256]))
    elif isinstance(value, str) and value:
        place = draw(st.integers(0, len(value) - 1))
        container[key] = (
            value[:place] + draw(st.sampled_from(["", "x", "_", "9"])) + value[place + 1 :]
        )
    else:
        container[key] = copy.deepcopy(draw(st.sampled_from(JUNK)))


def _exchange(draw: st.DrawFn, places: list[Place]) -> None:
    """A value becomes another one of its kind, from elsewhere in the schema."""
    container, key = _pick(draw, places)
    kind = type(container[key])
    others = [other[index] for other, index in places if type(other[index]) is kind]
    container[key] = copy.deepcopy(draw(st.sampled_from(others)))


def _reorder(draw: st.DrawFn, places: list[Place]) -> None:
    """The keys of a mapping, or the items of a list, in another order."""
    container, _ = _pick(draw, places)
    if isinstance(container, list):
        container[:] = draw(st.permutations(container))
        return
    items = draw(st.permutations(list(container.items())))
    container.clear()
    container.update(items)


def _swap(draw: st.DrawFn, places: list[Place]) -> None:
    """Two values change places, unless one would come to lie inside of itself."""
    first, second = _pick(draw, places), _pick(draw, places)
    one, other = (copy.deepcopy(container[key]) for container, key in (first, second))
    first[0][first[1]], second[0][second[1]] = other, one


def _rename(draw: st.DrawFn, places: list[Place]) -> None:
    """A key gets another's name, or a word of the language; the order stays."""
    container, key = _pick(draw, places)
    if not isinstance(container, dict):
        return
    others = [other for _, other in places if isinstance(other, str)]
    names = st.sampled_from(NEW_KEYS)
    name = draw(names | st.sampled_from(others) if others else names)
    items = [(name if item == key else item, value) for item, value in container.items()]
    container.clear()
    container.update(items)


def _insert(draw: st.DrawFn, places: list[Place]) -> None:
    container, _ = _pick(draw, places)
    value = copy.deepcopy(draw(st.sampled_from(JUNK)))
    if isinstance(container, dict):
        container[draw(st.sampled_from(NEW_KEYS))] = value
    else:
        container.append(value)


def _repeat(draw: st.DrawFn, places: list[Place]) -> None:
    """Something stands a second time, in another place."""
    container, key = _pick(draw, places)
    value = copy.deepcopy(container[key])
    target, _ = _pick(draw, places)
    if isinstance(target, list):
        target.append(value)
    else:
        target[f"{key}_again"] = value


_EDITS: tuple[Callable[[st.DrawFn, list[Place]], None], ...] = (
    _delete, _replace, _nudge, _nudge, _exchange, _exchange, _exchange, _reorder, _swap, _rename,
    _insert, _repeat,
)  # fmt: skip


# --- text ---------------------------------------------------------------------------------------

_SCRAPS = (
    "\t", ": ", "- ", "{", "}", "[", "]", '"', "'", "#", "&a ", "*a", "!!str ", "|", ">", "%", "@",
    "\x00", "\x85", "\ufeff", "?", "---\n", "...\n", "\n", "  ", ",", "0x", "<<: ", "~", "é", "\r",
)  # fmt: skip


@st.composite
def mangled(draw: st.DrawFn, text: str) -> str:
    """The text with one to three slips of the keyboard."""
    for _ in range(draw(st.integers(1, 3))):
        low = draw(st.integers(0, len(text)))
        high = min(len(text), low + draw(st.integers(0, 12)))
        scrap = draw(st.sampled_from(("", *_SCRAPS)) | st.just(text[low:high] * 2))
        text = text[:low] + scrap + text[high:]
    return text
