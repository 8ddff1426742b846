"""Declared types: numbers with names for their values, and structs."""

from __future__ import annotations

from typing import Any

from hypothesis import strategies as st

from protogen.copying import replace
from schema_fuzzing import forms
from schema_fuzzing.fields import structs
from schema_fuzzing.names import TYPES, several
from schema_fuzzing.numbers import ORDERS, integer
from schema_fuzzing.packed import can_pack, packed_structs
from schema_fuzzing.setting import Built, Declared, Setting

_GREATEST_TYPE = 10


@st.composite
def declared_types(draw: st.DrawFn, byte_bits: int, *, whole_bytes: bool) -> tuple[Declared, ...]:
    """Types that mean the same wherever they are used: what needs a byte order states it."""
    setting = Setting(
        byte_bits=byte_bits,
        ordered=False,
        whole_bytes=whole_bytes,
        budget=_GREATEST_TYPE,
        room=None,
        delimited=False,
        last=False,
        depth=1,
    )
    found: tuple[Declared, ...] = ()
    for name in draw(several(TYPES, 0, 3)):
        here = replace(setting, types=found)
        declare = _struct if draw(st.booleans()) else _number
        found = (*found, declare(draw, name, here))
    return found


def _number(draw: st.DrawFn, name: str, setting: Setting) -> Declared:
    built = draw(integer(setting))
    data = {key: value for key, value in built.data.items() if key not in ("const", "default")}
    written = forms.short(data, "type") if draw(st.booleans()) else data
    return Declared(name, Built(written, built.size), is_struct=False, chooses=False)


def _struct(draw: st.DrawFn, name: str, setting: Setting) -> Declared:
    if can_pack(setting) and draw(forms.one_in(6)):
        return Declared(name, draw(packed_structs(setting)), is_struct=True, chooses=False)
    order = {"byte_order": draw(ORDERS)} if draw(st.booleans()) else {}
    built = draw(structs(replace(setting, ordered=bool(order))))
    choosing = {declared.name for declared in setting.types if declared.chooses}
    data = {"fields": built.data, **order}
    return Declared(
        name, replace(built, data=data), is_struct=True, chooses=_chooses(data, choosing)
    )


def _chooses(data: Any, choosing: set[str]) -> bool:
    """True if a switch stands in the fields, or a use of a type that holds one."""
    if isinstance(data, str):
        return data in choosing
    if not isinstance(data, dict):
        return False
    if "switch" in data or data.get("type") in choosing:
        return True
    inner = [*data.get("fields", {}).values()] if isinstance(data.get("fields"), dict) else []
    return any(_chooses(item, choosing) for item in inner)
