"""Types of fields and parts, and their enums: what reads raw values."""

from __future__ import annotations

from typing import Any

from protogen.model.meanings import BitField, Enum
from protogen.model.numbers import FreeNumeral, Numeral
from protogen.model.types import Float, Integer, Text
from protogen.targets.html.plans.plain import Json, lean, number
from protogen.targets.typescript.numbers import is_bigint


class TypeTable:
    """Types and enums; one that several fields have is written once."""

    def __init__(self) -> None:
        self.types: list[Json] = []
        self.enums: dict[str, Json] = {}
        self._places: dict[str, int] = {}

    def place(self, type_: Any) -> int:
        """The place of a type among those of the page."""
        found = self._json(type_)
        key = repr(found)
        if key not in self._places:
            self._places[key] = len(self.types)
            self.types.append(found)
        return self._places[key]

    def _json(self, type_: Any) -> Json:
        own: Json = {"label": type_.label}
        if isinstance(type_, Text):
            padded = type_.padded
            own["kind"] = "text"
            if padded is not None:
                form = (padded.padding, padded.bits, padded.shift, padded.add)
                own |= {"size": padded.size, "form": list(form)}
            return own
        if isinstance(type_, Float):
            return own | _bytes_of(type_) | {"kind": "float"}
        if not isinstance(type_, Integer):
            return own | {"kind": "octets"}
        own |= _bytes_of(type_) | {"kind": "integer", "name": type_.name, "signed": type_.signed}
        own |= {"role": "" if type_.role == "number" else type_.role, "isBig": is_bigint(type_)}
        own["text"] = self._text(type_)
        own["low"] = None if type_.within is None else type_.within.low
        if type_.is_text:
            own["isText"] = True
        if type_.enum is not None:
            own["enum"] = self._enum(type_.enum)
        if type_.flags is not None:
            own["flags"] = {item.name: item.bit for item in type_.flags.bits}
        own["runs"] = [self._run(item) for item in type_.bit_fields]
        return lean(own)

    def _text(self, type_: Integer) -> Json | None:
        form = type_.text
        if isinstance(form, Numeral):
            return {"alphabet": form.alphabet.decode("latin-1")}
        if not isinstance(form, FreeNumeral):
            return None
        return lean(
            {
                "base": form.base,
                "fraction": form.fraction,
                "separator": form.separator,
                "leads": form.leads,
                "empty": form.empty,
                "absent": number(form.absent),
                "greatest": number(form.greatest),
                "longest": form.longest(signed=type_.signed),
            }
        )

    def _run(self, item: BitField) -> Json:
        own = {"name": item.name, "low": item.low, "mask": number(item.mask)}
        return lean({**own, "enum": None if item.enum is None else self._enum(item.enum)})

    def _enum(self, enum: Enum) -> str:
        if enum.name not in self.enums:
            values = {item.name: number(item.value) for item in enum.values}
            self.enums[enum.name] = lean({"values": values, "closed": enum.closed})
        return enum.name


def _bytes_of(type_: Integer | Float) -> Json:
    return lean(
        {
            "bits": type_.bits,
            "size": type_.size,
            "isBigEndian": type_.byte_order == "big",
            "sevenBit": type_.byte_bits == 7,
        }
    )
