"""Transparency: ways to write it, and what it makes of each byte.

The codewords are worked out here from the definitions (RFC 1055, RFC 1662, a table, hex digits),
not taken from the compiler.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from hypothesis import strategies as st

from schema_fuzzing import forms

BYTE = st.integers(0, 255)
KINDS = (
    "none", "none", "none", "substitute", "substitute", "insertion", "insertion", "escape-invert",
    "escape-none", "escape-xor", "base16", "cobs", "slip", "slip", "hdlc", "hdlc",
)  # fmt: skip


@dataclass(frozen=True, slots=True)
class Code:
    """A transparency. `codewords` None: COBS, which does not work byte by byte.

    With `inserted`, each byte stands for itself, and the last of these behind the others.
    """

    kind: str
    data: Any
    codewords: Mapping[int, bytes] | None
    clean: tuple[int, ...]
    """Bytes that it is meant to keep out of its region."""
    inserted: bytes = b""


def plain() -> dict[int, bytes]:
    """No transparency: every byte stands for itself."""
    return {byte: bytes((byte,)) for byte in range(256)}


@st.composite
def codes(draw: st.DrawFn) -> Code | None:
    """Any transparency that can be undone, or none."""
    kind = draw(st.sampled_from(KINDS))
    match kind:
        case "none":
            return None
        case "substitute":
            return draw(_substitution())
        case "insertion":
            return draw(_insertion())
        case "escape-invert" | "escape-none" | "escape-xor":
            return draw(_escape(kind.removeprefix("escape-")))
        case "base16":
            words = {byte: f"{byte:02X}".encode() for byte in range(256)}
            return Code(kind, {"encoding": "base16-upper"}, words, tuple(b"\nbeGZ:"))
        case "cobs":
            return Code(kind, {"encoding": "cobs"}, None, (0,))
    return _preset(kind, draw(st.sampled_from([kind, kind, {"preset": kind}])))


def _preset(kind: str, data: Any) -> Code:
    if kind == "slip":
        return Code(kind, data, {**plain(), 0xC0: b"\xdb\xdc", 0xDB: b"\xdb\xdd"}, (0xC0,))
    return Code(kind, data, {**plain(), 0x7E: b"\x7d\x5e", 0x7D: b"\x7d\x5d"}, (0x7E,))


@st.composite
def _escape(draw: st.DrawFn, transform: str) -> Code:
    byte = draw(BYTE)
    others = draw(st.lists(BYTE, min_size=1, max_size=3, unique=True))
    of = sorted({byte, *others})
    mask = {"invert": 0xFF, "none": 0, "xor": 0x20}[transform]
    if transform == "xor" and draw(st.booleans()):
        mask = draw(BYTE)
    words = {member: bytes((byte, member ^ mask)) for member in of}
    data = {
        "escape": {
            "byte": draw(forms.raw_number(byte)),
            "of": [draw(forms.raw_number(member)) for member in of],
            "transform": {"xor": draw(forms.raw_number(mask))} if transform == "xor" else transform,
        }
    }
    clean = tuple(member for member in of if member != byte) or (byte,)
    return Code(f"escape-{transform}", data, {**plain(), **words}, clean)


@st.composite
def _insertion(draw: st.DrawFn) -> Code:
    """A sequence of which no end is a beginning, and a byte that does not begin it again."""
    first, *others = draw(st.lists(BYTE, min_size=2, max_size=4, unique=True))
    repeated = bytes((first,) * draw(st.integers(1, 2)))
    sequence = repeated + bytes(others[:2])
    byte = draw(st.sampled_from([sequence[-1], *others, draw(BYTE)]))
    byte = others[0] if byte == first else byte
    stuffed = sequence + bytes((byte,))
    written = stuffed.hex(" ")
    value = draw(st.sampled_from([written, written.upper(), {"hex": written}, [*stuffed]]))
    data = {"substitute": {sequence.hex(" ").upper(): value}}
    return Code("insertion", data, plain(), tuple(sequence), stuffed)


@st.composite
def _substitution(draw: st.DrawFn) -> Code:
    """Sequences that begin with listed bytes; those with the same first byte differ in the second.

    So no codeword begins another one, and every region can be decoded at once.
    """
    keys = draw(st.lists(BYTE, min_size=1, max_size=4, unique=True))
    seconds = draw(st.lists(BYTE, min_size=len(keys), max_size=len(keys), unique=True))
    shared = draw(st.booleans())
    table: dict[int, bytes] = {}
    for index, (key, second) in enumerate(zip(keys, seconds, strict=True)):
        lead = keys[0] if shared else keys[-1 - index]
        tail = draw(st.binary(max_size=2)) if draw(st.booleans()) else b""
        short = not shared and draw(forms.one_in(4))
        table[key] = bytes((lead,)) if short else bytes((lead, second)) + tail
    data = {draw(forms.raw_number(key)): draw(forms.octets(word)) for key, word in table.items()}
    leads = {word[0] for word in table.values()}
    clean = tuple(key for key in keys if key not in leads) or tuple(keys)
    return Code("substitute", {"substitute": data}, {**plain(), **table}, clean)
