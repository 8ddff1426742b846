"""Fields of messages that are numbers of the frame, for expressions of those behind them."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from hypothesis import strategies as st

from protogen.copying import replace
from schema_fuzzing import forms
from schema_fuzzing.frames import FramePlan
from schema_fuzzing.names import fresh, several
from schema_fuzzing.parts import PartPlan
from schema_fuzzing.setting import Built, Selector, Setting, Size

Data = dict[str, Any]
NAMES = (
    "stream", "import", "need", "capacity", "at", "writer", "user", "held", "cls", "context",
)  # fmt: skip
"""Names that no other field of a message has, some of which are taken in what reads payloads."""
IDENTITY = "told"
"""The name of a field that is an identity."""
_MEMBERS = ("low", "high", "dark", "ajar")
_SET_BY_OTHERS = {"const", "counter", "id", "counts", "algorithm", "repeats", "complements"}
_FEW = 12
"""Most of what may count something."""


@dataclass(frozen=True, slots=True)
class Number:
    """A number of a frame that its sender chooses."""

    bits: int
    values: tuple[range, ...]
    """What it can be."""
    is_early: bool
    """True if it stands in front of the payload."""

    def __contains__(self, value: int) -> bool:
        return any(value in run for run in self.values)


def numbers_of(frame: FramePlan) -> dict[str, Number]:
    """The numbers of a frame that a sender chooses, but for those that tell the message."""
    roles = [part.role for part in frame.parts]
    payload = roles.index("payload")
    return {
        name: Number(bits, values, index < payload)
        for index, part in enumerate(frame.parts)
        for name, bits, values in _numbers(part)
    }


def _numbers(part: PartPlan) -> Iterator[tuple[str, int, tuple[range, ...]]]:
    if part.role == "choice" and "type" not in part.data:
        values = tuple(int.from_bytes(word, "big") for word in part.words)
        yield part.name, 8 * part.size, tuple(range(value, value + 1) for value in values)
    for name, item in part.data.get("bits", {}).items():
        if not isinstance(item, dict):
            yield name, *_all_of(_width(item))
        elif _SET_BY_OTHERS.isdisjoint(item):
            bits = _width(item["bits"])
            ends = item.get("range", (0, (1 << bits) - 1))
            least, greatest = (ord(end) if isinstance(end, str) else end for end in ends)
            yield name, bits, (range(least, greatest + 1),)
    if part.role == "value" and part.type is not None and part.type.type != "ascii":
        least, greatest = part.bounds
        yield part.name, part.type.bits, (range(least, greatest + 1),)


def _all_of(bits: int) -> tuple[int, tuple[range, ...]]:
    return bits, (range(1 << bits),)


def _width(run: str | int) -> int:
    low, _, high = str(run).partition("..")
    return int(high or low) - int(low) + 1


def _common(frames: Sequence[FramePlan]) -> dict[str, Number]:
    """The numbers that all frames have, and what each of them can be in all."""
    first, *others = map(numbers_of, frames)
    found: dict[str, Number] = {}
    for name, number in first.items():
        alike = [other[name] for other in others if name in other]
        if len(alike) < len(others) or any(other.bits != number.bits for other in alike):
            continue
        values = number.values
        for other in alike:
            values = tuple(
                range(max(one.start, two.start), min(one.stop, two.stop))
                for one in values
                for two in other.values
            )
        values = tuple(run for run in values if run)
        is_early = number.is_early and all(other.is_early for other in alike)
        if values:
            found[name] = Number(number.bits, values, is_early)
    return found


@st.composite
def part_fields(
    draw: st.DrawFn, frames: Sequence[FramePlan], setting: Setting
) -> tuple[Data, Setting]:
    """Up to three fields that are numbers of all frames, and the setting of those behind them."""
    common = {
        name: number
        for name, number in _common(frames).items()
        if setting.delimited or number.is_early
    }
    if not common or not draw(st.booleans()):
        return {}, setting
    found: Data = {}
    for part in draw(several(tuple(common), 1, min(3, len(common)))):
        name = draw(fresh(NAMES, found))
        built = draw(_field(part, common[part]))
        found[name] = built.data
        setting = _behind(setting, name, built)
    return found, setting


@st.composite
def with_identity(
    draw: st.DrawFn,
    message: Data,
    frames: Sequence[FramePlan],
    scheme: Sequence[PartPlan],
    varies: Sequence[bool],
) -> Data:
    """The message, sometimes with a field that is an identity of which it has several."""
    fields = message.get("fields", {})
    chosen = [
        part
        for part, has_several in zip(scheme, varies, strict=True)
        if has_several and part.type is not None and part.type.type != "ascii"
    ]
    is_plain = isinstance(fields, dict) and "separator" not in message
    is_in_time = all(frame.delimited for frame in frames)
    if not (chosen and is_plain and is_in_time) or not draw(st.booleans()):
        return message
    part = draw(st.sampled_from(chosen))
    assert part.type is not None
    held = {"part": part.identity or part.name, "type": f"uint{part.type.bits}"}
    return {**message, "fields": {IDENTITY: held, **fields}}


def _behind(setting: Setting, name: str, built: Built) -> Setting:
    operands = {f"{name}{rest}": bounds for rest, bounds in built.operands.items()}
    setting = replace(setting, operands={**setting.operands, **operands})
    if built.counts is not None:
        setting = replace(setting, counters={**setting.counters, name: built.counts})
    if built.keys:
        chooser = Selector(name, built.keys)
        setting = replace(setting, selectors=(*setting.selectors, chooser))
    return setting


@st.composite
def _field(draw: st.DrawFn, part: str, number: Number) -> Built:
    """A field that is a part of the frame; there is a value that both can have."""
    kinds = [f"uint{number.bits}", *{1: ["bool"], 8: ["byte"]}.get(number.bits, [])]
    data: Data = {"part": part, "type": draw(st.sampled_from(kinds))}
    every = (1 << number.bits) - 1
    nothing = Size(0, 0)
    operands = {"": Size(0, every)}
    if data["type"] == "bool":
        return Built(data, nothing, None, (0, 1) if _holds(number, 0, 1) else (), operands=operands)
    few = draw(st.lists(_values(number), min_size=1, max_size=3, unique=True))
    dress = draw(st.sampled_from(["none", "none", "values", "closed", "flags", "bits", "range"]))
    keys: tuple[Any, ...] = tuple(few)
    counts = Size(0, every)
    if dress in ("values", "closed"):
        data["values"] = dict(zip(_MEMBERS, few, strict=False))
        data["closed"] = dress == "closed"
        keys = tuple(data["values"])
    elif dress in ("flags", "bits"):
        data[dress], inner = draw(_named_bits(dress, number.bits))
        operands.update(inner)
    elif dress == "range":
        small = [value for value in range(min(every, _FEW) + 1) if value in number]
        ends = draw(st.lists(st.sampled_from(small), min_size=1, max_size=2)) if small else few
        data["range"] = [min(ends), max(ends)]
        keys = tuple(value for value in few if min(ends) <= value <= max(ends))
        counts = Size(min(ends), max(ends))
    if dress == "none" and draw(forms.one_in(4)):
        data.update(scale=draw(st.sampled_from(["1/16", 2])), unit=draw(forms.a_unit))
    data.update(draw(forms.about()))
    may_count = dress in ("none", "values", "range")
    return Built(data, nothing, counts if may_count else None, keys, operands=operands)


def _holds(number: Number, *values: int) -> bool:
    return all(value in number for value in values)


def _values(number: Number) -> st.SearchStrategy[int]:
    return st.sampled_from(number.values).flatmap(
        lambda run: st.sampled_from([run[0], run[-1]]) | st.integers(run[0], run[-1])
    )


@st.composite
def _named_bits(draw: st.DrawFn, dress: str, bits: int) -> tuple[Data, Mapping[str, Size]]:
    """Names of some bits, and what they hold."""
    places = draw(st.lists(st.integers(0, bits - 1), min_size=1, max_size=3, unique=True))
    if dress == "flags":
        named: Data = dict(zip(_MEMBERS, sorted(places), strict=False))
        return named, {f".{name}": Size(0, 1) for name in named}
    low, high = min(places), min(max(places), min(places) + 4)
    named = {"low": f"{low}..{high}"}
    return named, {".low": Size(0, (1 << (high - low + 1)) - 1)}
