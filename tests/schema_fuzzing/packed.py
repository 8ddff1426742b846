"""Packed integers: arrays and structs whose bits follow each other."""

from __future__ import annotations

from typing import Any

from hypothesis import strategies as st

from protogen.copying import replace
from schema_fuzzing import forms
from schema_fuzzing.names import FIELDS, fresh
from schema_fuzzing.numbers import integer
from schema_fuzzing.setting import Built, Setting, Size

BIT_ORDERS = st.sampled_from(["lsb_first", "msb_first"])
_GREATEST_COUNT = 20
_BITS = {"byte": 8, "char": 8, "bool": 1}

Number = tuple[dict[str, Any], int]
"""What is written of a number, and its bits."""


def can_pack(setting: Setting) -> bool:
    """True if bits may be packed here."""
    return setting.byte_bits == 8 and setting.budget > 0


@st.composite
def _numbers(draw: st.DrawFn, setting: Setting, bits: int) -> Number:
    """A number of at most so many bits."""
    if bits < 8 or draw(forms.one_in(6)):
        kind = draw(st.sampled_from(["bool", f"uint{draw(st.integers(1, min(bits, 8)))}"]))
        data: dict[str, Any] = {"type": kind}
    else:
        data = draw(integer(replace(setting, budget=min(8, bits // 8), ordered=True))).data
        unfit = ("byte_order", "digits", "code", "chars")
        data = {key: value for key, value in data.items() if key not in unfit}
    kind = data["type"]
    return data, _BITS.get(kind) or int(kind[4:])


@st.composite
def packed_arrays(draw: st.DrawFn, setting: Setting) -> Built:
    """An array of packed integers."""
    data, count, bits = draw(_arrays(setting, 8 * setting.budget))
    size = -(-bits * count // 8)
    return Built({**data, "packed": draw(BIT_ORDERS)}, Size(size, size))


@st.composite
def _arrays(draw: st.DrawFn, setting: Setting, room: int) -> tuple[dict[str, Any], int, int]:
    data, bits = draw(_numbers(setting, min(64, room)))
    count = draw(st.integers(1, min(_GREATEST_COUNT, room // bits)))
    data = {key: value for key, value in data.items() if key not in ("const", "default")}
    is_plain = data["type"][:4] in ("uint", "sint") and not {"values", "range"} & data.keys()
    if is_plain and draw(forms.one_in(4)):
        data[draw(st.sampled_from(["const", "default"]))] = [0] * count
    return {**data, "count": count}, count, bits


@st.composite
def packed_fills(draw: st.DrawFn, setting: Setting) -> Built:
    """Packed integers of 8 bits or more that take what the payload has left."""
    data, bits = draw(_numbers(setting, min(64, 8 * setting.budget)))
    if bits < 8:
        bits = draw(st.integers(8, min(64, 8 * setting.budget)))
        data = {"type": f"{draw(st.sampled_from(['uint', 'sint']))}{bits}"}
    data = {key: value for key, value in data.items() if key not in ("const", "default")}
    most = 8 * setting.budget // bits
    if setting.room is None or not setting.exact or draw(forms.one_in(4)):
        most = draw(st.integers(0, min(_GREATEST_COUNT, most)))
        extent: Any = {"fill": True, "max": most}
    else:
        most = 8 * setting.room // bits
        extent = draw(st.sampled_from(["fill", {"fill": True}]))
    least, room = 0, min(most, 8 * setting.budget // bits) - 2
    if isinstance(extent, dict) and room > 0 and draw(st.booleans()):
        least = extent["min"] = draw(st.integers(1, room))
    size = Size(-(-least * bits // 8), -(-most * bits // 8))
    data = {**data, "count": extent, "packed": draw(BIT_ORDERS)}
    return Built(data, size, fills=True)


@st.composite
def packed_structs(draw: st.DrawFn, setting: Setting) -> Built:
    """A struct of packed integers, one at least."""
    room, bits = 8 * setting.budget, 0
    fields: dict[str, Any] = {}
    for _ in range(draw(st.integers(1, 5))):
        if bits == room:
            break
        if draw(forms.one_in(4)):
            data, count, each = draw(_arrays(setting, room - bits))
        else:
            (data, each), count = draw(_numbers(setting, min(64, room - bits))), 1
        fields[draw(fresh(FIELDS, fields))] = forms.short(data, "type")
        bits += count * each
    size = -(-bits // 8)
    data = {"fields": fields, "packed": draw(BIT_ORDERS)}
    return Built(data, Size(size, size))
