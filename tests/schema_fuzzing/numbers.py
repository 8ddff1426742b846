"""Fields that are one number: integers of all widths, byte, char, bool, floats; with all keys."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from hypothesis import strategies as st

from protogen.copying import replace
from schema_fuzzing import forms
from schema_fuzzing.names import SPECIAL, VALUES, several
from schema_fuzzing.setting import ELSE, Built, Named, Setting, Size

ORDERS = st.sampled_from(["little", "big"])
SCALES = st.sampled_from(["1/16", "0.01", 2, "-1/3", 0.5, "1.5e-3", 1])
OFFSETS = st.sampled_from([-40, "0.5", "1/3", 0, 273.15])
FLOATS = st.sampled_from([0.0, -0.0, 1.5, -2.25, 65504, 0.1, 3])


@dataclass(frozen=True, slots=True)
class Kind:
    """A built-in integer type."""

    type: str
    bits: int
    signed: bool
    size: int
    role: str = "number"
    most: int | None = None
    """The greatest number that its digits hold, where that is less than its bits do."""

    @property
    def least(self) -> int:
        return -(1 << (self.bits - 1)) if self.signed else 0

    @property
    def greatest(self) -> int:
        held = (1 << (self.bits - 1 if self.signed else self.bits)) - 1
        return held if self.most is None else min(held, self.most)

    def value(self) -> st.SearchStrategy[int]:
        """Raw values, the ends more often than others."""
        ends = sorted({self.least, self.greatest, 0, min(1, self.greatest)})
        return st.sampled_from(ends) | st.integers(self.least, self.greatest)


@st.composite
def kinds(draw: st.DrawFn, setting: Setting, *, unsigned: bool = False) -> Kind:
    """An integer type that fits the budget."""
    byte_bits = setting.byte_bits
    roles = ["uint", "uint", "char"] + ([] if unsigned else ["sint", "sint"])
    if setting.whole_bytes or byte_bits == 8:
        roles.append("byte")
    role = draw(st.sampled_from(roles))
    if role == "byte":
        return Kind("byte", 8, False, 1, "byte")
    if role == "char":
        return Kind("char", byte_bits, False, 1, "char")
    widest = min(64, setting.budget * byte_bits)
    common = [bits for bits in (7, 8, 14, 16, 32, 64) if bits <= widest]
    bits = draw(st.integers(1, widest) | st.sampled_from(common or [1]))
    return Kind(f"{role}{bits}", bits, role == "sint", setting.bytes_of(bits))


@st.composite
def number(draw: st.DrawFn, setting: Setting) -> Built:
    """Any number; the budget must hold at least one byte."""
    if draw(forms.one_in(10)):
        return _with_about(draw, draw(_bool()))
    if setting.budget >= setting.bytes_of(64) and draw(forms.one_in(8)):
        return _with_about(draw, draw(_float(setting)))
    return _with_about(draw, draw(integer(setting)))


def _with_about(draw: st.DrawFn, built: Built) -> Built:
    data = {**built.data, **draw(forms.about())}
    if draw(forms.one_in(10)):
        data["unknown"] = True
    written = forms.short(data, "type")
    return Built(written, built.size, built.counts, built.keys, operands=built.operands)


@st.composite
def integer(draw: st.DrawFn, setting: Setting) -> Built:
    """An integer of any width, with whatever may be said about it."""
    kind = draw(kinds(setting))
    data: dict[str, Any] = {"type": kind.type}
    if setting.byte_bits == 8 and kind.role == "number" and draw(forms.one_in(6)):
        kind = _written(draw, setting, kind, data)
    if "digits" not in data and "code" not in data:
        data.update(_order(draw, setting, kind.size))
    dress = draw(st.sampled_from(["none", "none", "values", "flags", "bits"]))
    if dress == "values":
        data.update(draw(_enum(kind)))
    elif dress != "none" and not kind.signed:
        data[dress] = draw(_flags(kind) if dress == "flags" else _bits(kind))
    least, greatest = _bounds(draw, data, kind)
    _physical(draw, data)
    _constants(draw, data, kind, least, greatest)
    free = "const" not in data and not data.get("closed") and dress not in ("flags", "bits")
    counts = Size(least, greatest) if free and not kind.signed else None
    keys = draw(_keys(data, kind, least, greatest)) if "const" not in data else ()
    size = Size(kind.size, kind.size)
    return Built(data, size, counts, keys, operands=_operands(data, kind))


def _operands(data: dict[str, Any], kind: Kind) -> dict[str, Size]:
    """What an expression may be worked out of: the number, and bits of it that have a name."""
    if "const" in data:
        return {}
    names = tuple(data.get("values", ()))
    alone = data.get("closed") and len(names) == 1  # Which it always is.
    found: dict[str, Size] = {"": Named(kind.least, kind.greatest, () if alone else names)}
    found.update({f".{name}": Size(0, 1) for name in data.get("flags", {})})
    for name, entry in data.get("bits", {}).items():
        written = entry["bits"] if isinstance(entry, dict) else entry
        if isinstance(written, list):
            continue  # Nothing can be worked out of several runs.
        low, _, high = str(written).partition("..")
        widest = (1 << (int(high or low) - int(low) + 1)) - 1
        known = tuple(entry.get("values", ())) if isinstance(entry, dict) else ()
        found[f".{name}"] = Named(0, widest, known)
    return found


@st.composite
def counter(draw: st.DrawFn, setting: Setting, greatest: int) -> Built:
    """An unsigned integer that says at most `greatest`."""
    kind = draw(kinds(setting, unsigned=True))
    high = min(greatest, kind.greatest)
    low = draw(st.integers(0, high))
    data: dict[str, Any] = {"type": kind.type, **_order(draw, setting, kind.size)}
    data["range"] = [low, high]
    size = Size(kind.size, kind.size)
    return Built(data, size, Size(low, high), operands={"": Size(kind.least, kind.greatest)})


def _written(draw: st.DrawFn, setting: Setting, kind: Kind, data: dict[str, Any]) -> Kind:
    """The integer written as text, where its digits fit the budget."""
    form = draw(st.sampled_from(["base10", "base16-upper", "base16-lower", "code"]))
    base = 10 if form == "base10" else 16
    if form == "code":
        bits, add = draw(st.integers(1, 7)), draw(forms.raw_number(draw(st.integers(0, 0x80))))
        data["code"] = {"bits": bits, "add": add}
        base = 1 << bits
    needed = next(count for count in range(1, 65) if base**count > (1 << kind.bits) - 1)
    fewest = needed if kind.signed else 1
    widest = max(count for count in range(1, 65) if base**count <= 1 << 64)
    greatest = min(setting.budget, needed + 1, widest)
    if fewest > greatest or (kind.signed and form == "base10"):
        data.pop("code", None)
        return kind
    size = draw(st.integers(fewest, greatest))
    if form != "code":
        data["digits"] = form
    if size != needed or draw(st.booleans()):
        data["chars"] = size
    most = None if kind.signed else base**size - 1
    return replace(kind, size=size, most=most)


def _order(draw: st.DrawFn, setting: Setting, size: int) -> dict[str, str]:
    """A byte order, where there must be one, and sometimes where there may be."""
    needed = size > 1 and not setting.ordered
    return {"byte_order": draw(ORDERS)} if needed or draw(forms.one_in(10)) else {}


@st.composite
def _bool(draw: st.DrawFn) -> Built:
    data: dict[str, Any] = {"type": "bool"}
    key = draw(st.sampled_from(["", "", "const", "default"]))
    if key:
        data[key] = draw(st.sampled_from([True, False, 0, 1]))
    keys = () if key == "const" else (0, 1)
    operands = {} if key == "const" else {"": Size(0, 1)}
    return Built(data, Size(1, 1), None, keys, operands=operands)


@st.composite
def _float(draw: st.DrawFn, setting: Setting) -> Built:
    bits = draw(st.sampled_from([32, 64]))
    size = setting.bytes_of(bits)
    data: dict[str, Any] = {"type": f"float{bits}", **_order(draw, setting, size)}
    key = draw(st.sampled_from(["", "", "const", "default", "range"]))
    if key == "range":
        data[key] = draw(st.sampled_from([[-1, 1], ["-0.5", "1/3"], [0, 1000000]]))
    elif key:
        data[key] = draw(FLOATS)
    if draw(forms.one_in(5)):
        data["unit"] = draw(forms.a_unit)
    return Built(data, Size(size, size))


# --- names for values and bits ------------------------------------------------------------------


def _named(draw: st.DrawFn, key: str, value: Any) -> Any:
    """The short form, or a mapping with a text."""
    if not draw(forms.one_in(4)):
        return value
    return {key: value, **draw(forms.some_about())}


@st.composite
def _enum(draw: st.DrawFn, kind: Kind) -> dict[str, Any]:
    names = draw(several(VALUES, 1, 4))
    raw = draw(st.lists(kind.value(), min_size=1, max_size=len(names), unique=True))
    character = kind.role == "char"
    values = {
        name: _named(draw, "value", draw(forms.raw_number(value, character=character)))
        for name, value in zip(names, raw, strict=False)
    }
    found: dict[str, Any] = {"values": values}
    if draw(st.booleans()):
        found["closed"] = draw(st.booleans())
    return found


@st.composite
def _flags(draw: st.DrawFn, kind: Kind) -> dict[str, Any]:
    names = draw(several(VALUES, 1, 5))
    bits = st.integers(0, kind.bits - 1)
    chosen = draw(st.lists(bits, min_size=1, max_size=len(names), unique=True))
    return {name: _named(draw, "bit", bit) for name, bit in zip(names, chosen, strict=False)}


@st.composite
def _bits(draw: st.DrawFn, kind: Kind) -> dict[str, Any]:
    found: dict[str, Any] = {}
    low = 0
    for name in draw(several(VALUES, 1, 3)):
        low += draw(st.integers(0, 2))
        if low >= kind.bits:
            break
        high = draw(st.integers(low, min(low + 5, kind.bits - 1)))
        found[name] = draw(_one_run(low, high))
        low = high + 1
    return found or {draw(st.sampled_from(VALUES)): 0}


@st.composite
def _one_run(draw: st.DrawFn, low: int, high: int) -> Any:
    written = f"{low}..{high}" if high > low or draw(st.booleans()) else low
    if not draw(forms.one_in(3)):
        return written
    widest = (1 << (high - low + 1)) - 1
    raw = draw(st.lists(st.integers(0, widest), min_size=1, max_size=3, unique=True))
    names = draw(several(VALUES, len(raw), len(raw)))
    runs: Any = written
    if high - low >= 2 and raw[0] & 1:  # Two runs, without the bit that is next to the lowest one.
        runs = [low, f"{low + 2}..{high}"]
        raw = list(dict.fromkeys(value & ~2 for value in raw))
    values = {
        name: _named(draw, "value", draw(forms.raw_number(value)))
        for name, value in zip(names, raw, strict=False)
    }
    return {"bits": runs, "values": values, **draw(forms.about())}


def _keys(data: dict[str, Any], kind: Kind, least: int, greatest: int) -> st.SearchStrategy[Any]:
    """Spellings of some values of the integer as keys of cases; each value at most once.

    The last one may be the key of all other values, where there are some.
    """
    named = {name: _raw_of(entry) for name, entry in data.get("values", {}).items()}
    written: dict[int, Any] = {value: name for name, value in named.items()}
    if not data.get("closed"):
        for value in (least, greatest, min(greatest, least + 1)):
            written.setdefault(value, value)
    usable = [
        chr(value) if kind.role == "char" and key == value and value > 0x39 else key
        for value, key in sorted(written.items())
        if least <= value <= greatest
    ]
    if not usable:
        return st.just(())
    allowed = len(usable) if data.get("closed") else greatest - least + 1
    few = st.lists(st.sampled_from(usable), min_size=1, max_size=3, unique=True)
    others = forms.one_in(3) if ELSE not in named else st.just(False)
    return st.tuples(few, others).map(
        lambda drawn: (*drawn[0], *([ELSE] if drawn[1] and len(drawn[0]) < allowed else ()))
    )


def unnamed_values(data: Any) -> list[int]:
    """Some values of a declared enum that have no name."""
    if isinstance(data, str) or "values" not in data:
        return []
    named = {_raw_of(entry) for entry in data["values"].values()}
    width = {"byte": 8, "char": 7}.get(data["type"]) or int(data["type"][4:])
    greatest = min(100, (1 << (width - (data["type"][0] == "s"))) - 1)
    return [value for value in range(greatest + 1) if value not in named]


def _raw_of(entry: Any) -> int:
    """The raw value of an enum's entry, as it was written."""
    value = entry["value"] if isinstance(entry, dict) else entry
    return ord(value) if isinstance(value, str) else value


# --- bounds, meaning, constants -----------------------------------------------------------------


def _bounds(draw: st.DrawFn, data: dict[str, Any], kind: Kind) -> tuple[int, int]:
    """The bounds of the value; a range that holds at least one value of a closed enum."""
    if data.get("closed") or not draw(forms.one_in(3)):
        return kind.least, kind.greatest
    least, greatest = sorted((draw(kind.value()), draw(kind.value())))
    data["range"] = [least, greatest]
    return least, greatest


def _physical(draw: st.DrawFn, data: dict[str, Any]) -> None:
    for key, values in (("scale", SCALES), ("offset", OFFSETS)):
        if draw(forms.one_in(6)):
            data[key] = draw(values)
    if draw(forms.one_in(4)):
        data["unit"] = draw(forms.a_unit)


def _constants(
    draw: st.DrawFn, data: dict[str, Any], kind: Kind, least: int, greatest: int
) -> None:
    if draw(forms.one_in(6)):
        names = draw(several(SPECIAL, 1, 2))
        raw = draw(st.lists(kind.value(), min_size=1, max_size=len(names), unique=True))
        character = kind.role == "char"
        data["special"] = {
            name: _named(draw, "value", draw(forms.raw_number(value, character=character)))
            for name, value in zip(names, raw, strict=False)
        }
    key = draw(st.sampled_from(["", "", "", "const", "default"]))
    if key:
        data[key] = draw(_constant(data, kind, least, greatest))


@st.composite
def _constant(draw: st.DrawFn, data: dict[str, Any], kind: Kind, least: int, greatest: int) -> Any:
    """A value in range; of an enum often by name, of a closed one always one that has a name."""
    named = {name: _raw_of(entry) for name, entry in data.get("values", {}).items()}
    fitting = [name for name, value in named.items() if least <= value <= greatest]
    if data.get("closed") or (draw(st.booleans()) and fitting):
        return draw(st.sampled_from(fitting))
    value = draw(st.integers(least, greatest))
    return draw(forms.raw_number(value, character=True)) if kind.role == "char" else value
