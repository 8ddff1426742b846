"""Numbers in as many digits as they need, and fields of such numbers with separators."""

from __future__ import annotations

from dataclasses import dataclass
from functools import reduce
from operator import or_
from typing import Any

from hypothesis import strategies as st

from protogen.copying import replace
from schema_fuzzing import forms
from schema_fuzzing.names import FIELDS, fresh
from schema_fuzzing.setting import ELSE, NOTHING, Built, Size

_SEPARATORS = (",", ";", " ", "|", 0x09, 0xFF)
_CHARACTERS = {"left": "L", "right": "R", "comma": ",", "bar": "|", "high": 0xFF, "low": 1}
_GREATEST_COUNT = 3
_GREATEST_TEXT = 6


@st.composite
def written_numbers(draw: st.DrawFn, budget: int, *, may_be_empty: bool = False) -> Built:
    """A number of at most so many characters, and at least one."""
    base = draw(st.sampled_from([10, 16]))
    data: dict[str, Any] = {"type": "decimal" if base == 10 else "hexadecimal"}
    fraction = draw(st.integers(0, min(4, max(0, budget - 2)))) if base == 10 else 0
    point = fraction + 1 if fraction else 0
    is_signed = base == 10 and budget > point + 1 and draw(st.booleans())
    front = draw(st.integers(1, min(18 - fraction, budget - is_signed - point, 15)))
    data["digits"] = {"max": front}
    if draw(st.booleans()):
        data["digits"]["min"] = draw(st.integers(1, front))
    if fraction:
        data["fraction"] = fraction
    if base == 16 and draw(st.booleans()):
        data["case"] = draw(st.sampled_from(["upper", "lower"]))
    greatest = base ** (front + fraction) - 1
    least = -greatest if is_signed else 0
    ends = st.integers(least, greatest) | st.sampled_from([least, 0, greatest])
    if base == 10 and not is_signed:
        data["range"] = [0, draw(ends)]
    elif is_signed and draw(forms.one_in(3)):
        data["range"] = [-1, draw(st.integers(0, greatest))]
    if data.get("range") == [0, greatest]:  # Which needs as many digits.
        data["digits"] = draw(st.sampled_from([data["digits"], data["digits"].get("min", 1)]))
    if draw(forms.one_in(4)):
        data["unit"] = draw(forms.a_unit)
    if draw(forms.one_in(6)):
        data["special"] = {"nothing": draw(ends)}
    is_empty = may_be_empty and draw(st.booleans())
    if is_empty:
        data["empty"] = "absent"
    return Built(data, Size(not is_empty, is_signed + front + point), fills=True)


@st.composite
def separated(draw: st.DrawFn, budget: int) -> tuple[Any, Built]:
    """A separator, and the fields of a message that it stands between."""
    byte, in_front = draw(st.sampled_from(_SEPARATORS)), draw(st.booleans())
    scope = _Scope(draw, ord(byte) if isinstance(byte, str) else byte, budget, leads=in_front)
    for left in reversed(range(draw(st.integers(1, 5)))):
        scope.add(last=left == 0)
    if draw(forms.one_in(3)):
        scope.leave_out(draw(st.integers(1, 2)), first=in_front)
    written: Any = {"byte": byte, "in_front": True} if in_front else byte
    if not in_front and draw(forms.one_in(3)):
        written = {"byte": byte}
    return written, scope.built()


@dataclass
class _Scope:
    """Fields one after another."""

    draw: st.DrawFn
    byte: int
    budget: int
    leads: bool
    depth: int = 0

    def __post_init__(self) -> None:
        self._fields: dict[str, Any] = {}
        self._size = NOTHING
        self._least: dict[str, int] = {}
        """The fewest bytes of each field."""
        self._element_fields = 0
        """Fields of an element of the array in front, where that ends where these begin."""

    def built(self) -> Built:
        return Built(self._fields, self._size)

    def leave_out(self, most: int, *, first: bool) -> None:
        """Have some fields at the end left out, where each is a number behind a separator."""
        if self._element_fields:
            most = min(most, self._element_fields - 1)
        known = list(self._fields)
        for name in reversed(known[0 if first else 1 :][-most:] if most else []):
            written = self._fields[name]
            data = {"type": written} if isinstance(written, str) else written
            if "count" in data or "fields" in data or "switch" in data:
                return
            self._fields[name] = {**data, "optional": True}
            self._size = Size(self._size.least - self._least[name], self._size.greatest)

    def add(self, *, last: bool) -> None:
        """Add a field, with what counts it, if there is room."""
        if self.budget < 2:
            return
        kinds = ["number"] * 3 + ["character"] * 2 + ["text"] * 2
        if last and not self.depth:
            kinds.append("rest")
        if self.leads and not self._element_fields:
            kinds += ["tail"] * 2 * (not last and not self.depth and self.budget > 4)
            kinds += ["array", "struct", "switch"] * (self.depth < 2)
            kinds += ["fill"] * (last and not self.depth)
        kind = self.draw(st.sampled_from(kinds))
        if kind == "array":
            self._array()
        elif kind == "struct":
            self._put(self._struct(self.budget))
        elif kind == "rest" and not self._element_fields:
            self._put(self._text(self.budget, only=kind))
        elif kind == "switch":
            self._switch()
        elif kind == "tail":
            self._in_front_of_tail()
        elif kind == "fill":
            element = self._element(self.budget)
            most = self.draw(st.integers(1, self.budget // element.size.greatest))
            self._put(_extended(element, {"fill": True, "max": most}, Size(0, most)))
        else:
            only = "text" if kind == "rest" else kind
            self._put(self._text(self.budget, only=only))

    def _in_front_of_tail(self) -> None:
        """An array to the end, behind which fields stand all the same."""
        budget = self.budget - 2  # What stands behind has room.
        fields = self.draw(st.integers(1, max(1, min(3, budget // 2))))
        texts = [self._text(budget // fields) for _ in range(fields)]
        size = sum((text.size for text in texts), NOTHING)
        names = ("one", "two", "three")
        inner = {name: it.data for name, it in zip(names, texts, strict=False)}
        element = replace(texts[0], data={"fields": inner}, size=size)
        if fields == 1 and texts[0].data["type"] != "ascii":
            element = texts[0]
        most = self.draw(st.integers(1, budget // size.greatest))
        self._put(_extended(element, {"fill": True, "max": most}, Size(0, most)))
        self._element_fields = fields

    def _put(self, built: Built) -> str:
        name: str = self.draw(fresh(FIELDS, self._fields))
        self._fields[name] = forms.short(built.data, "type")
        self._size += built.size
        self._least[name] = built.size.least
        self.budget -= built.size.greatest
        self.leads = True
        return name

    def _text(self, budget: int, only: str = "") -> Built:
        """A number or a character, with the separator in front."""
        kind = only or self.draw(st.sampled_from(["number", "character", "text"]))
        if kind in ("text", "rest"):
            found = self._characters(budget, fills=kind == "rest")
        else:
            found = self._character() if kind == "character" else self._number(budget)
        return replace(found, size=found.size + Size(self.leads, self.leads), fills=False)

    def _number(self, budget: int) -> Built:
        return self.draw(written_numbers(budget - self.leads, may_be_empty=True))

    def _characters(self, budget: int, *, fills: bool) -> Built:
        """A text of some characters, or of all that is left, separators included."""
        most = self.draw(st.integers(1, min(_GREATEST_TEXT, budget - self.leads)))
        least = self.draw(st.integers(0, most - fills))
        size = {**({"fill": True} if fills else {}), "min": least, "max": most}
        without = self.draw(st.lists(st.sampled_from("$*aZ~ "), unique=True))
        without = [self.draw(st.sampled_from([each, ord(each)])) for each in without]
        return Built({"type": "ascii", "size": size, "without": without}, Size(least, most))

    def _character(self) -> Built:
        known = [
            name
            for name, value in _CHARACTERS.items()
            if (ord(value) if isinstance(value, str) else value) != self.byte
        ]
        names = self.draw(st.lists(st.sampled_from(known), min_size=1, unique=True))
        values = {name: _CHARACTERS[name] for name in names}
        data = {"type": "char", "values": values, "closed": True}
        is_empty = self.draw(st.booleans())
        if is_empty:
            data["empty"] = "absent"
        return Built(data, Size(not is_empty, 1))

    def _struct(self, budget: int) -> Built:
        inner = _Scope(self.draw, self.byte, budget, self.leads, self.depth + 1)
        for _ in range(self.draw(st.integers(1, 3))):
            inner.add(last=False)
        built = inner.built()
        return replace(built, data={"fields": built.data})

    def _switch(self) -> None:
        """One of several, for each value of a number in front; the others have a case, too."""
        if self.budget < 5:
            return
        values = range(self.draw(st.integers(1, 3)))
        chosen = {"type": "decimal", "range": [0, 4], "digits": {"max": 1}}
        name = self._put(Built(chosen, Size(2, 2)))
        built = {key: self._element(self.budget) for key in (*values, ELSE)}
        size = reduce(or_, (case.size for case in built.values()))
        cases = {key: case.data for key, case in built.items()}
        self._put(Built({"switch": name, "cases": cases}, size))

    def _element(self, budget: int) -> Built:
        return self._struct(budget) if self.draw(st.booleans()) else self._text(budget)

    def _array(self) -> None:
        count: Any = self.draw(st.integers(1, _GREATEST_COUNT))
        size = Size(count, count)
        if self.draw(st.booleans()) and self.budget > 4:
            bounds = sorted(self.draw(st.lists(st.integers(0, 3), min_size=2, max_size=2)))
            most = max(1, bounds[1])
            count = self._put(Built({"type": "decimal", "range": [bounds[0], most]}, Size(2, 2)))
            size = Size(bounds[0], most)
            if self.draw(st.booleans()):
                count, size = f"{count} + 1", Size(bounds[0] + 1, most + 1)
        budget = self.budget // max(1, size.greatest)
        if budget >= 2:
            self._put(_extended(self._element(budget), count, size))


def _extended(element: Built, count: Any, size: Size) -> Built:
    if element.data.get("type") == "ascii":  # There is no array of texts, but one of structs.
        element = replace(element, data={"fields": {"text": element.data}})
    return Built({**element.data, "count": count}, element.size * size)
