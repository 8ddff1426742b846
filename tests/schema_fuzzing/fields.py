"""Fields of payloads: numbers, texts, bytes, structs, arrays, switches."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any

from hypothesis import strategies as st

from protogen.copying import replace
from schema_fuzzing import expressions, forms
from schema_fuzzing.names import FIELDS, fresh
from schema_fuzzing.numbers import ORDERS, counter, integer, number
from schema_fuzzing.packed import can_pack, packed_arrays, packed_fills, packed_structs
from schema_fuzzing.separated import written_numbers
from schema_fuzzing.setting import ELSE, NOTHING, Built, Declared, Selector, Setting, Size

GREATEST_DEPTH = 2
_USUAL_BYTES = 12
"""Most fixed sizes and counts stay below this, so that payloads stay small."""

_FOR_OTHERS = 2
"""Bytes that are kept for the fields behind."""

Fields = dict[str, Any]
Item = Callable[[st.DrawFn, Setting, Fields], Built]


@st.composite
def structs(draw: st.DrawFn, setting: Setting, *, greatest: int = 4) -> Built:
    """The fields of a struct or message; `data` is the mapping of names to fields."""
    scope = _Scope(draw, setting)
    for left in reversed(range(draw(st.integers(0, greatest)))):
        if not scope.add(last=left == 0):
            break
    return scope.built()


class _Scope:
    """Fields one after another."""

    def __init__(self, draw: st.DrawFn, setting: Setting) -> None:
        self._draw = draw
        self._setting = setting
        self._fields: Fields = {}
        self._size = NOTHING
        self._last = False
        self._fills = False
        self._operands: dict[str, Size] = {}

    def built(self) -> Built:
        return Built(self._fields, self._size, fills=self._fills, operands=self._operands)

    def add(self, *, last: bool) -> bool:
        """Add a field, with those that count or choose it; False: nothing can follow."""
        if self._setting.budget < 1:
            return False
        # Whether a field is the last is known before it is drawn: what follows keeps its room.
        self._last = last or self._setting.budget < _FOR_OTHERS + 3
        here = self._here()
        kind = self._draw(st.sampled_from(_kinds(here)))
        if kind == "counted":
            self._add_counted(here)
        elif kind == "switch":
            self._add_switch(here)
        elif kind == "region":
            self._add_region(here)
        elif kind == "fill in front":
            self._add_fill_in_front(here)
            return False
        elif kind == "optional":
            self._add_optional(here, here.budget)
            return False
        else:
            self._put(self._draw(_ITEMS[kind](here)))
        return not self._last

    def _here(self) -> Setting:
        """The setting of what comes next."""
        kept = 0 if self._last else _FOR_OTHERS
        setting = self._setting
        return replace(setting, last=setting.last and self._last, budget=setting.budget - kept)

    def _put(self, built: Built, *, always: bool = False) -> str:
        """Add a field that was drawn, and note what it can count or choose."""
        built = built if always else self._sometimes(built)
        name = self._draw(fresh(FIELDS, self._fields))
        data = built.data
        if self._draw(forms.one_in(30)):
            data = {**({"type": data} if isinstance(data, str) else data)}
            data["renamed_from"] = f"former_{name}"
        self._fields[name] = data
        self._size += built.size
        self._fills = built.fills
        behind = _hiding(self._setting.behind(built.size), name)
        found = {f"{name}{rest}": bounds for rest, bounds in built.operands.items()}
        self._operands.update({f".{path}": bounds for path, bounds in found.items()})
        behind = replace(behind, operands={**behind.operands, **found})
        if built.counts is not None:
            behind = replace(behind, counters={**behind.counters, name: built.counts})
        if built.keys:
            chooser = Selector(name, built.keys)
            behind = replace(behind, selectors=(*behind.selectors, chooser))
        self._setting = behind
        return name

    def _sometimes(self, built: Built) -> Built:
        """The field, which is there only on some condition now and then."""
        numbers = expressions.usable(self._setting)
        if not numbers or built.size.greatest == 0 or not self._draw(forms.one_in(6)):
            return built
        data = {"type": built.data} if isinstance(built.data, str) else dict(built.data)
        data.pop("default", None)
        data["when"] = self._draw(expressions.conditions(numbers))
        return Built(data, built.size | NOTHING, fills=built.fills)

    # -- arrays and texts that an earlier field counts ---------------------------------------

    def _add_counted(self, here: Setting) -> None:
        widest = self._draw(st.sampled_from([1, 1, 2, 4])) if here.budget > 8 else 1
        left = here.budget - widest
        if left < 1:
            self._put(self._draw(number(here)))
            return
        inner = replace(here, last=False, budget=left)
        element = self._draw(_STRING if self._draw(forms.one_in(3)) else _elements(inner))
        most = min(_USUAL_BYTES, left // max(1, element.size.greatest))
        if most < 1:
            self._put(self._draw(number(here)))
            return
        fitting = [n for n, bounds in here.counters.items() if bounds.greatest <= most]
        if self._draw(st.booleans()) and fitting:
            name = self._draw(st.sampled_from(sorted(fitting)))
        elif here.last and here.exact and here.room is not None and element.size.fixed:
            self._add_counted_by_room(element)
            return
        else:
            name = self._put(self._draw(counter(replace(here, budget=widest), most)))
            if name not in self._setting.counters:
                return  # It is not always there.
        count, bounds = name, self._setting.counters[name]
        if self._draw(st.booleans()):
            told = self._draw(expressions.counts(self._countable(), most))
            count, bounds = told or (count, bounds)
        self._put(self._draw(_extended(element, count, bounds)))

    def _countable(self) -> dict[str, Size]:
        """What a number of elements may be worked out of: counters, and few bits."""
        bits = {
            name: size
            for name, size in self._setting.operands.items()
            if "." in name and size.least >= 0 and size.greatest <= _USUAL_BYTES
        }
        wide = self._setting.operands.keys() - expressions.usable(self._setting).keys()
        counters = {n: size for n, size in self._setting.counters.items() if n not in wide}
        return {**bits, **counters}

    def _add_counted_by_room(self, element: Built) -> None:
        """A count that may say more than there is room for; what is there bounds the array."""
        bits = self._setting.byte_bits
        name = self._put(Built({"type": f"uint{bits}"}, NOTHING + Size(1, 1)))
        if "when" in self._fields[name]:
            return
        room = self._setting.room or 0
        most = min((1 << bits) - 1, room // max(1, element.size.least))
        self._put(self._draw(_extended(element, name, Size(0, most))))

    # -- what fills, and is not the last -----------------------------------------------------

    def _add_fill_in_front(self, here: Setting) -> None:
        """An array of all that is left but for the fields behind, which have one size each."""
        element = self._draw(_elements(replace(here, last=False, budget=here.budget - 2)))
        size = element.size
        if not size.fixed or size.least == 0 or element.data.get("type") in ("ascii", "bytes"):
            element = Built({"type": f"uint{2 * here.byte_bits}", "byte_order": "big"}, Size(2, 2))
            size = element.size
        left = here.budget - size.least
        tail = [self._draw(number(replace(here, last=False, budget=min(left, 8))))]
        left -= tail[0].size.greatest
        if left > 0 and self._draw(st.booleans()):
            tail.append(self._draw(number(replace(here, last=False, budget=left))))
        behind = sum((built.size for built in tail), NOTHING)
        most = (here.budget - behind.greatest) // size.least
        most = self._draw(st.integers(1, min(_USUAL_BYTES, most)))
        extent = {"fill": True, "max": most}
        built = self._draw(_extended(element, extent, Size(0, most)))
        self._put(built, always=True)
        # Nothing would tell as many optional bytes from one more element.
        is_optional = behind.greatest < size.least and self._draw(st.booleans())
        for field in tail:
            if is_optional:
                data = {**_without_constants(field.data), "optional": True}
                self._put(Built(data, field.size | NOTHING), always=True)
            else:
                self._put(field, always=True)
        self._fills = True

    def _add_optional(self, here: Setting, budget: int) -> None:
        """Fields at the end that may be left out."""
        for _ in range(self._draw(st.integers(1, 3))):
            built = self._draw(optional(replace(here, budget=min(budget, 4))))
            self._put(built, always=True)
            budget -= built.size.greatest
            if budget < 1 or built.fills:
                break
        self._fills = True

    # -- regions -----------------------------------------------------------------------------

    def _add_region(self, here: Setting) -> None:
        """Something in a region of so many bytes."""
        kind = self._draw(st.sampled_from(["closed", "struct", "switch", "array"]))
        if kind == "closed":
            self._add_closed_region(here)
            return
        # What tells the size is there first: it may hide a name of a struct around.
        told = self._put(Built({"type": "uint7"}, Size(1, 1)), always=True)
        here = self._here()
        inner = replace(
            here.inside(last=False),
            budget=min(here.budget - 1, _USUAL_BYTES),
            last=True,
            delimited=True,
            room=None,
            exact=False,
        )
        if kind == "switch" and inner.selectors:
            built = self._draw(_switch(inner, self._draw(st.sampled_from(inner.selectors))))
        elif kind == "array" and inner.budget > 4:
            built = self._draw(_varying(inner))
        else:
            built = self._draw(structs(inner, greatest=3))
            built = replace(built, data={"fields": built.data})
        if built.size.greatest:
            self._put(self._in_region(built, told))

    def _in_region(self, built: Built, told: str) -> Built:
        """Something in a region whose size an earlier number tells, or is worked out of that."""
        size, more = built.size, self._draw(st.sampled_from([0, 0, 1, 3]))
        bounds = [size.least + more, size.greatest + more]
        self._fields[told] = {"type": "uint7", "range": bounds}
        return Built({**built.data, "size": f"{told} - {more}" if more else told}, size)

    def _add_closed_region(self, here: Setting) -> None:
        """A struct in a region of so many bytes, told by a number that tells nothing else."""
        inner = replace(here.inside(last=False), budget=min(here.budget - 2, _USUAL_BYTES))
        built = self._draw(structs(inner, greatest=3))
        fields = dict(built.data)
        # Behind what is last in a region, a switch would take bytes of other values.
        fills = self._draw(st.booleans())
        fill = {"type": "bytes", "size": {"fill": True, "max": 1}}
        fields[self._draw(fresh(FIELDS, fields))] = fill if fills else "uint1"
        size = built.size + Size(1 - fills, 1)
        told: int | str = size.greatest
        if not size.fixed or self._draw(st.booleans()):
            bits = self._setting.byte_bits
            told = self._put(Built({"type": f"uint{bits}"}, Size(1, 1)))
            if "when" in self._fields[told]:
                return
        self._put(Built({"fields": fields, "size": told}, size))

    # -- switches ----------------------------------------------------------------------------

    def _add_switch(self, here: Setting) -> None:
        if not here.selectors or self._draw(st.booleans()):
            self._put(self._draw(_selector(replace(here, budget=max(1, min(2, here.budget - 1))))))
        if not self._setting.selectors:
            return  # What was to choose is not always there.
        chosen = self._draw(st.sampled_from(self._setting.selectors))
        if self._draw(forms.one_in(3)):
            chosen = self._draw(expressions.selectors(self._setting)) or chosen
        here = self._here()
        # What no case takes could be more than is left where something in front varies.
        closed = here.may_fill and here.room is not None and not here.exact
        if here.budget < 1 + closed:
            return
        if closed:
            here = replace(here, last=False, budget=here.budget - 1)
        self._put(self._draw(_switch(here, chosen)))
        if closed:
            self._put(Built("uint1", Size(1, 1)))


def _hiding(setting: Setting, name: str) -> Setting:
    """The setting behind a field of this name, which hides one of the structs around."""
    counters = {other: bounds for other, bounds in setting.counters.items() if other != name}
    selectors = tuple(item for item in setting.selectors if item.name != name)
    operands = {
        path: bounds for path, bounds in setting.operands.items() if path.partition(".")[0] != name
    }
    return replace(setting, counters=counters, selectors=selectors, operands=operands)


def _kinds(setting: Setting) -> list[str]:
    """Kinds of fields that may be drawn here."""
    kinds = ["number"] * 6 + ["string", "string", "array", "array", "counted", "counted", "switch"]
    if setting.depth < GREATEST_DEPTH and setting.budget > 4:
        kinds += ["last element", "last element"]
    if setting.depth < GREATEST_DEPTH:
        kinds += ["struct", "struct", "region"] if setting.budget > 2 else ["struct", "struct"]
    if setting.budget > 1:
        kinds += ["until"] * (6 if setting.may_fill and setting.exact and setting.room else 2)
    if can_pack(setting):
        kinds += ["packed array", "packed struct"]
    if setting.may_fill:
        kinds += ["fill"] * 8
        kinds += ["packed fill"] * 4 if can_pack(setting) else []
        if setting.budget > 4:
            kinds += ["fill in front"] * 2 + ["optional"] * 2
        if setting.byte_bits == 8:
            kinds += ["written"] * 3
    if any(_fits(declared, setting) for declared in setting.types):
        kinds += ["declared"] * 3
    return kinds


def _fits(declared: Declared, setting: Setting) -> bool:
    """True if there is room; a type that holds a switch means another thing where it may fill."""
    if declared.chooses and setting.may_fill:
        return False
    return declared.built.size.greatest <= setting.budget


# --- elements -----------------------------------------------------------------------------------


@st.composite
def _elements(draw: st.DrawFn, setting: Setting) -> Built:
    """Something that there can be several of, as a mapping that `count` can be added to."""
    if setting.depth < GREATEST_DEPTH and draw(forms.one_in(4)):
        inner = replace(setting.inside(last=False), budget=min(setting.budget, _USUAL_BYTES))
        built = draw(structs(inner, greatest=3))
        return replace(built, data={"fields": built.data}, counts=None, keys=(), operands={})
    if can_pack(setting) and draw(forms.one_in(8)):
        return draw(packed_structs(replace(setting, budget=min(setting.budget, _USUAL_BYTES))))
    fitting = [declared for declared in setting.types if _fits(declared, setting)]
    if draw(forms.one_in(4)) and fitting:
        used = draw(_use(setting, draw(st.sampled_from(fitting))))
        return replace(used, operands={})
    if draw(forms.one_in(6)):
        return draw(_STRING)
    built = draw(number(setting))
    data = _without_constants(built.data)
    return replace(built, data=data, counts=None, keys=(), operands={})


@st.composite
def _varying(draw: st.DrawFn, setting: Setting) -> Built:
    """Structs of different sizes, as many as a region holds."""
    inner = setting.inside(last=False)
    inner = replace(inner, last=False, budget=min(setting.budget - 3, setting.budget // 2))
    built = draw(structs(inner, greatest=2))
    fields = {**built.data, "varying": {"type": "bytes", "until": {"byte": 0, "max": 2}}}
    each = built.size + Size(1, 3)
    most = setting.budget // each.greatest
    count = draw(st.sampled_from(["fill", {"fill": True, "max": most}]))
    return Built({"fields": fields, "count": count}, Size(0, each.greatest * most))


@st.composite
def optional(draw: st.DrawFn, setting: Setting) -> Built:
    """A field at the end of a message that may be left out, with a byte at least."""
    if draw(forms.one_in(5)):
        most = min(4, setting.budget)
        fills = draw(st.booleans()) and most > 1
        extent = {"fill": True, "min": 1, "max": most} if fills else most
        data = {"type": draw(st.sampled_from(["bytes", "ascii"])), "size": extent}
        built = Built(data, Size(1, most), fills=isinstance(extent, dict))
    elif setting.budget > 2 and draw(forms.one_in(3)):
        data = {name: draw(number(replace(setting, budget=1))).data for name in ("one", "other")}
        built = Built({"fields": data}, Size(2, 2))
    else:
        number_ = draw(number(setting))
        built = replace(number_, data=_without_constants(number_.data))
    return Built({**built.data, "optional": True}, built.size | NOTHING, fills=built.fills)


_STRING = st.sampled_from(["bytes", "ascii"]).map(lambda kind: Built({"type": kind}, Size(1, 1)))
"""A text or bytes, whose elements are bytes."""


def _without_constants(data: Any) -> dict[str, Any]:
    """A number as the element of an array, whose constants would be lists."""
    full = {"type": data} if isinstance(data, str) else dict(data)
    full.pop("const", None)
    full.pop("default", None)
    return full


@st.composite
def _use(draw: st.DrawFn, setting: Setting, declared: Declared) -> Built:
    """A use of a declared type."""
    data: dict[str, Any] = {"type": declared.name}
    if not declared.is_struct:
        data.update(draw(forms.about()))
    return replace(declared.built, data=data)


@st.composite
def _extended(draw: st.DrawFn, element: Built, count: Any, bounds: Size) -> Built:
    """So many of an element, or a text or bytes of this size."""
    is_string = element.data.get("type") in ("ascii", "bytes")
    # The number may be one of bytes, in which one element must have room at least.
    is_told = element.size.fixed and 0 < element.size.least <= bounds.greatest
    if not is_string and is_told and draw(forms.one_in(4)):
        return draw(_sized(element, count, bounds))
    data = {**element.data, "size" if is_string else "count": count}
    return Built(data, element.size * bounds)


@st.composite
def _sized(draw: st.DrawFn, element: Built, count: Any, bounds: Size) -> Built:
    """So many of an element, told by their bytes."""
    each, size = element.size.least, count
    if isinstance(count, int):
        size = count * each
    elif isinstance(count, dict):
        size = {key: it if key == "fill" else it * each for key, it in count.items()}
    elif count != "fill" and (bounds.least or not count.isidentifier() or draw(st.booleans())):
        size = f"({count}) * {each}"
    elif count != "fill":
        bounds = Size(0, bounds.greatest // each)
    is_struct = "fields" in element.data or element.data["type"] not in _NUMBERS
    data = {**element.data, "size": size}
    if is_struct or draw(st.booleans()):
        data["count"] = "fill"
    return Built(data, element.size * bounds)


_NUMBERS = {
    *(f"{sign}int{bits}" for sign in "us" for bits in range(1, 65)),
    *("byte", "char", "bool", "float32", "float64"),
}


# --- items --------------------------------------------------------------------------------------


_PADDED: list[dict[str, Any]] = [{"padding": " "}, {"padding": 0x5A}]
_CODED: list[dict[str, Any]] = [
    {"code": {"bits": 7, "shift": 1}, "padding": 0x20},
    {"code": {"bits": 7, "shift": 1, "add": 1}},
    {"code": {"bits": 7, "add": 0x80}, "padding": 0x5F},
    {"code": {"bits": 7}},
]
_PLAIN: list[tuple[str, dict[str, Any]]] = [("bytes", {}), ("ascii", {})]
_STRINGS = {
    bits: [*_PLAIN * 2, *(("ascii", form) for form in padded)]
    for bits, padded in ((7, _PADDED), (8, _PADDED + _CODED))
}
"""Types of strings of a fixed size, with the form of a text, by the bits of a byte."""


@st.composite
def _string(draw: st.DrawFn, setting: Setting) -> Built:
    """A text or bytes of a fixed size, sometimes with a constant."""
    size = draw(st.integers(0, min(_USUAL_BYTES, setting.budget)))
    kind, form = draw(st.sampled_from(_STRINGS[setting.byte_bits]))
    data: dict[str, Any] = {"type": kind, "size": size, **form, **draw(forms.about())}
    key = draw(st.sampled_from(["", "", "", "const", "default"]))
    padding = forms.character(form["padding"]) if "padding" in form else ""
    if key and kind == "ascii":
        data[key] = draw(st.text("aZ09 _-\"'\\{}", max_size=size)).rstrip(padding)
    elif key:
        highest = (1 << setting.byte_bits) - 1
        content = st.lists(st.integers(0, highest), min_size=size, max_size=size)
        data[key] = {"hex": bytes(draw(content)).hex()}
    return Built(data, Size(size, size))


@st.composite
def _until(draw: st.DrawFn, setting: Setting) -> Built:
    """A text or bytes in front of a terminator."""
    kind = draw(st.sampled_from(["ascii", "bytes"]))
    highest = (1 << setting.byte_bits) - 1
    end = draw(st.sampled_from([0, 0, 0x0A, 0x3B, highest]) | st.integers(0, highest))
    data: dict[str, Any] = {"type": kind, **draw(forms.about())}
    if setting.may_fill and setting.exact and (setting.room or 0) > 2 and draw(st.booleans()):
        least, most = 0, (setting.room or 0) - 1
        byte = draw(forms.raw_number(end))
        data["until"] = draw(st.sampled_from([byte, {"byte": byte}]))
    else:
        most = draw(st.integers(1, min(_USUAL_BYTES, setting.budget - 1)))
        least = draw(st.integers(0, most - 1)) if draw(forms.one_in(3)) else 0
        byte = draw(forms.raw_number(end))
        data["until"] = {"byte": byte, "max": most, **({"min": least} if least else {})}
    if draw(forms.one_in(5)):
        byte = next(byte for byte in b"aB" if byte != end)
        content = bytes([byte]) * draw(st.integers(least, min(most, least + 4)))
        data["default"] = content.decode() if kind == "ascii" else {"hex": content.hex()}
    return Built(data, Size(least + 1, most + 1))


@st.composite
def _up_to_last(draw: st.DrawFn, setting: Setting) -> Built:
    """Structs up to the one that says that it is the last."""
    inner = replace(setting.inside(last=False), budget=min(setting.budget // 2 - 1, _USUAL_BYTES))
    built = draw(structs(inner, greatest=2))
    name, mark, field = draw(st.sampled_from(_MARKS))
    first = {name: field} if draw(st.booleans()) else {}  # No field is called so.
    fields = {**first, **built.data, name: field}
    each = built.size + Size(1, 1)
    most = min(_USUAL_BYTES, setting.budget // each.greatest)
    until: dict[str, Any] = {"element": mark}
    is_bounded_by_room = setting.may_fill and setting.exact and setting.room is not None
    least = 1
    if is_bounded_by_room and each.fixed and draw(st.booleans()):
        most = (setting.room or 0) // each.least
    else:
        until["max"] = most = draw(st.integers(2, most))
        if most > 2 and draw(forms.one_in(3)):
            until["min"] = least = draw(st.integers(1, most - 1))
    data = {"fields": fields, "until": until, **draw(forms.about())}
    return Built(data, each * Size(least, most))


_MARKS: tuple[tuple[str, str, Any], ...] = (
    ("is_last", "is_last", "bool"),
    ("is_last", "is_last", "uint7"),
    ("last_flags", "last_flags.ends", {"type": "uint7", "flags": {"ends": 4, "x": 0}}),
    ("last_bits", "last_bits.ends", {"type": "uint7", "bits": {"x": "1..3", "ends": "4..5"}}),
    ("last_head", "last_head.ends", {"fields": {"ends": "bool"}}),
)
"""Names of fields of one byte, of what says in them which element is the last, and the fields."""


@st.composite
def _fixed_array(draw: st.DrawFn, setting: Setting) -> Built:
    inner = replace(setting, last=False)
    element = draw(_elements(inner))
    most = setting.budget // max(1, element.size.greatest)
    count = draw(st.integers(0, min(_USUAL_BYTES, most)))
    built = draw(_extended(element, count, Size(count, count)))
    plain = element.data.get("type", "")[:4] in ("uint", "sint") and "values" not in element.data
    if plain and "range" not in element.data and draw(forms.one_in(4)):
        key = draw(st.sampled_from(["const", "default"]))
        built = replace(built, data={**built.data, key: [0] * count})
    return built


@st.composite
def _struct(draw: st.DrawFn, setting: Setting) -> Built:
    order = {"byte_order": draw(ORDERS)} if draw(forms.one_in(4)) else {}
    inner = setting.inside(last=True)
    built = draw(structs(replace(inner, ordered=inner.ordered or bool(order))))
    data: dict[str, Any] = {"fields": built.data, **order, **draw(forms.about())}
    return replace(built, data=data, counts=None, keys=())


@st.composite
def _declared(draw: st.DrawFn, setting: Setting) -> Built:
    fitting = [declared for declared in setting.types if _fits(declared, setting)]
    return draw(_use(setting, draw(st.sampled_from(fitting))))


@st.composite
def _fill(draw: st.DrawFn, setting: Setting) -> Built:
    """Something that takes what the payload has left."""
    element = draw(_elements(replace(setting, last=False)))
    if element.size.least == 0:
        element = Built({"type": "bytes"}, Size(1, 1))
    each = element.size.greatest
    if (
        setting.room is None
        or not setting.exact
        or element.size.least != each
        or draw(forms.one_in(4))
    ):
        most = draw(st.integers(0, min(_USUAL_BYTES, setting.budget // each)))
        extent: Any = {"fill": True, "max": most}
    else:
        most = setting.room // each
        extent = draw(st.sampled_from(["fill", {"fill": True}]))
    least, room = 0, min(most, setting.budget // each) - 2
    if isinstance(extent, dict) and room > 0 and draw(st.booleans()):
        least = extent["min"] = draw(st.integers(1, room))
    built = draw(_extended(element, extent, Size(least, most)))
    return replace(built, fills=True)


@st.composite
def _written(draw: st.DrawFn, setting: Setting) -> Built:
    """A number in as many digits as it needs, where it fits the budget."""
    if setting.budget < 1:
        return draw(number(setting))
    built = draw(written_numbers(setting.budget))
    return replace(built, data=forms.short({**built.data, **draw(forms.about())}, "type"))


# --- switches -----------------------------------------------------------------------------------


@st.composite
def _selector(draw: st.DrawFn, setting: Setting) -> Built:
    """An integer that can choose: one without a constant."""
    built = draw(integer(setting))
    if built.keys:
        return built
    return Built({"type": "uint4", "values": {"one": 1, "two": 2}}, Size(1, 1), None, ("one", 2))


@st.composite
def _switch(draw: st.DrawFn, setting: Setting, selector: Selector) -> Built:
    cases: dict[Any, Any] = {}
    size: Size | None = None
    keeps_rest = setting.may_fill and ELSE not in selector.keys
    fills = keeps_rest
    for key in selector.keys:
        inner = replace(setting, depth=setting.depth + 1)
        built = draw(_case(inner))
        cases[key] = built.data
        size = built.size if size is None else size | built.size
        fills = fills or built.fills
    assert size is not None
    if keeps_rest:
        rest = size.greatest if setting.room is None else setting.room
        size |= Size(0, rest)
    data = {"switch": selector.name, "cases": cases, **draw(forms.about())}
    return Built(data, size, fills=fills)


@st.composite
def _case(draw: st.DrawFn, setting: Setting) -> Built:
    """Case of the switch for one value: fields, none at all, or one plain field."""
    shape = draw(st.sampled_from(["fields", "none", "plain", "declared", "any", "any"]))
    fitting = [item for item in setting.types if _fits(item, setting)]
    if shape == "declared" and fitting:
        return draw(_use(setting, draw(st.sampled_from(fitting))))
    if shape == "plain" and setting.budget >= 1:
        built = draw(number(setting))
        return Built(built.data, built.size)
    if shape == "any" and setting.budget >= 1:
        kinds = [kind for kind in _kinds(setting) if kind in _ITEMS]
        built = draw(_ITEMS[draw(st.sampled_from(kinds))](setting))
        data = built.data if isinstance(built.data, str) else dict(built.data)
        return Built(data, built.size, fills=built.fills)
    if shape == "fields" and setting.depth <= GREATEST_DEPTH:
        built = draw(structs(setting, greatest=3))
        return replace(built, data={"fields": built.data})
    return Built({"fields": {}}, NOTHING)


_ITEMS: Mapping[str, Callable[[Setting], st.SearchStrategy[Built]]] = {
    "number": number,
    "string": _string,
    "until": _until,
    "last element": _up_to_last,
    "array": _fixed_array,
    "struct": _struct,
    "declared": _declared,
    "packed array": packed_arrays,
    "packed fill": packed_fills,
    "packed struct": packed_structs,
    "fill": _fill,
    "written": _written,
}
