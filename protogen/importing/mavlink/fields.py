"""Fields of a message -> fields of a schema, in wire order."""

from __future__ import annotations

import re
from collections.abc import Iterable, Sequence
from fractions import Fraction
from typing import Any

from protogen.importing.mavlink.enums import INTEGERS, Enums, can_name
from protogen.importing.mavlink.identifiers import identifier
from protogen.importing.mavlink.spec import FieldSpec, Message
from protogen.importing.mavlink.units import read_unit
from protogen.importing.names import unique
from protogen.importing.remarks import Kind, Remark
from protogen.importing.schema_text import Number, joined, paragraphs

_TYPES = {**INTEGERS, "float": "float32", "double": "float64", "char": "char"}
_CONSTANT = re.compile(r"(U?)INT(8|16|32|64)_(MIN|MAX)")
_INTEGER = re.compile(r"[-+]?(?:0[xX][0-9a-fA-F]+|\d+)")
_NAN = re.compile(r"\[?nan(:?)\]?", re.IGNORECASE)
_ARRAY = re.compile(r"\[([^\[\]:,]+)(:?)\]")
_LARGEST_TEXT = 24
"""Characters of a number that is read exactly."""


def fields_of(
    message: Message,
    fields: Iterable[FieldSpec],
    version: int,
    enums: Enums,
    remarks: list[Remark],
) -> dict[str, Any]:
    """Return the fields that a frame of a message has; remarks tell what they do not say."""
    data: dict[str, Any] = {}
    for spec in fields:
        name = unique(identifier(spec.name), data)
        data[name] = _Field(message, spec, version, enums, remarks).data()
    return data


class _Field:
    def __init__(
        self,
        message: Message,
        spec: FieldSpec,
        version: int,
        enums: Enums,
        remarks: list[Remark],
    ) -> None:
        self._name = f"{message.name}.{spec.name}"
        self._spec = spec
        self._version = version
        self._enums = enums
        self._remarks = remarks
        self._docs = [paragraphs(spec.text)]

    def data(self) -> Any:
        """Return what a schema says of the field; a bare type if that is all."""
        if self._spec.type == "char":
            data = self._characters()
        else:
            data = self._type()
            data |= self._unit() | self._range()
            data |= self._default(data.get("range", ())) | self._special()
        if self._get("instance") == "true":
            self._docs.append("Tells several of the same kind apart.")
        doc = joined(self._docs)
        data |= {"doc": doc} if doc else {}
        return data["type"] if set(data) == {"type"} else data

    def _get(self, attribute: str) -> str:
        return self._spec.attributes.get(attribute, "").strip()

    def _remark(self, reason: str, kind: Kind = Kind.LEFT_OUT) -> None:
        self._remarks.append(Remark(kind, self._name, reason, self._spec.span))

    @property
    def _is_integer(self) -> bool:
        return self._spec.type in INTEGERS

    # --- type ---------------------------------------------------------------------------------

    def _characters(self) -> dict[str, Any]:
        if self._get("enum"):
            self._remark(f"the names of {self._get('enum')}, as it is no integer")
        if self._spec.count is None:
            return {"type": "char"}
        return {"type": "ascii", "size": self._spec.count}

    def _type(self) -> dict[str, Any]:
        spec, enum = self._spec, self._get("enum")
        data: dict[str, Any] = {"type": _TYPES[spec.type]}
        if enum:
            types = self._enums.by_name[enum]
            kind = self._enums.type_of(enum, spec.type) if can_name(types, spec.type) else None
            if kind is not None:
                data["type"] = kind
            else:
                what = "a bitmask has no sign" if self._is_integer else "it is no integer"
                self._remark(f"the names of {enum}, as {what}")
        return data if spec.count is None else data | {"count": spec.count}

    # --- numbers ------------------------------------------------------------------------------

    def _unit(self) -> dict[str, Any]:
        written = self._get("multiplier")
        multiplier = _fraction(written) if written else Fraction(1)
        if not multiplier:
            self._remark(f"the multiplier `{written}`, which is no number but 0")
            multiplier = Fraction(1)
        return read_unit(self._get("units"), multiplier).keys

    def _default(self, bounds: Sequence[Any]) -> dict[str, Any]:
        """Return the default; `bounds` are those of the range, if it has one."""
        if self._spec.is_version:
            return {"default": self._version}
        written = self._get("default")
        if not written:
            return {}
        number, count = self._number(written), self._spec.count
        reason = ""
        if number is None:
            reason = f", which is no {self._spec.type}"
        elif bounds and not _value(bounds[0]) <= _value(number) <= _value(bounds[1]):
            reason = ", which is out of its range"
        elif count is not None and not self._is_integer:
            reason = ", as an array of no integers has none"
        if reason:
            self._remark(f"the default `{written}`{reason}")
            return {}
        return {"default": number if count is None else [number] * count}

    def _range(self) -> dict[str, Any]:
        low, high = self._get("minValue"), self._get("maxValue")
        if not low and not high:
            return {}
        bounds = _bounds(INTEGERS[self._spec.type]) if self._is_integer else (None, None)
        least = self._number(low) if low else bounds[0]
        greatest = self._number(high) if high else bounds[1]
        is_said = least is not None and greatest is not None and not self._spec.is_version
        if not is_said or _value(least) > _value(greatest):
            said = " ".join(filter(None, (f"from {low}" * bool(low), f"up to {high}" * bool(high))))
            self._remark(f"its values {said}, which a schema can't say of it")
            return {}
        return {"range": [least, greatest]}

    def _special(self) -> dict[str, Any]:
        """Return the value without a reading; what is none goes to the docs."""
        written = self._get("invalid")
        found = _NAN.fullmatch(written)
        if not written or found is not None:
            if found is not None and "nan" not in self._docs[0].lower():
                first = "the first one" if found[1] else "it"
                self._docs.append(f"No value where {first} is NaN.")
            return {}
        array = _ARRAY.fullmatch(written)
        text = array[1].strip() if array else written
        number = self._number(text)
        if number is None:
            if text not in self._values():
                self._remark(f"the invalid value `{written}`, which is no {self._spec.type}")
            return {}
        if array is not None and (array[2] or not _value(number)):
            which = "the first one is" if array[2] else "all are"
            self._docs.append(f"No values where {which} {text}.")
            return {}
        if _value(number) in self._values().values():
            return {}
        return {"special": {"invalid": number}}

    def _values(self) -> dict[str, int]:
        types = self._enums.by_name.get(self._get("enum"))
        if types is None:
            return {}
        return {name: item.number for name, item in types.entries.items()}

    def _number(self, text: str) -> Any:
        """Return a number of the field's type as a schema writes it, or None if it is none."""
        constant = _CONSTANT.fullmatch(text)
        if constant is not None:
            bounds = _bounds(f"{'u' if constant[1] else 's'}int{constant[2]}")
            text = str(bounds[0 if constant[3] == "MIN" else 1])
        if _INTEGER.fullmatch(text):
            integer = int(text, 16 if "x" in text.lower() else 10)
            if not self._is_integer:
                return integer
            least, greatest = _bounds(INTEGERS[self._spec.type])
            return integer if least <= integer <= greatest else None
        number = _fraction(text)
        if number is None or self._is_integer:
            return None
        return int(number) if number.denominator == 1 else Number(text)


def _value(number: Any) -> Fraction:
    """Return the value of a number as a schema writes it."""
    return Fraction(number.text if isinstance(number, Number) else number)


def _fraction(text: str) -> Fraction | None:
    """Return a number such as `1E-2` or `360/255`, or None."""
    exponent = re.search(r"[eE][-+]?(\d+)$", text)
    if len(text) > _LARGEST_TEXT or (exponent is not None and len(exponent[1]) > 2):
        return None
    try:
        return Fraction(text)
    except (ValueError, ZeroDivisionError):
        return None


def _bounds(kind: str) -> tuple[int, int]:
    bits = int(kind.removeprefix("sint").removeprefix("uint"))
    return (-(1 << bits - 1), (1 << bits - 1) - 1) if kind[0] == "s" else (0, (1 << bits) - 1)
