"""Ways to write the same thing."""

from __future__ import annotations

from collections.abc import Sequence
from functools import cache
from typing import Any

from hypothesis import strategies as st

TEXTS = (
    "Plain words.",
    "Quotes \"\"\" and ''' and a backslash \\",
    "*/ // ?? <!-- --> |pipe| `code` </script>",
    "{{ braces }} {% percent %} ${dollar} %s {0}",
    "Zeile mit Umlaut: ä, Grad: °, 漢字, 🙂",
    "first line\nsecond line\n\n    indented",
    "ends with a backslash \\",
    "# no comment: a text, - really",
    "\\N{DASH} \\x41 \\u0041 \\",
    "true",
    "0x10",
)
UNITS = ("mm", "mm/s", "deg", "V", "degC", "ms", "m/s^2", "%", "1/min", "µs")
RATES: tuple[Any, ...] = ("0.0001 Hz", 0.0001, "1/9000", "9000 s", "9999999.5 ms")
"""So seldom that any line has room."""

a_text = st.sampled_from(TEXTS)
a_unit = st.sampled_from(UNITS)


# Most draws ask this; to make a strategy and to check it costs more than to draw from it.
@cache
def one_in(many: int) -> st.SearchStrategy[bool]:
    """True once in so many draws; the simplest is False."""
    return st.sampled_from((False,) * (many - 1) + (True,))


_SOURCES: tuple[Any, ...] = (
    "61-65",
    63,
    {"lines": "7", "note": "a note"},
    {"document": "Manual", "revision": 1.10, "section": "4.2", "license": "MIT"},
    {"url": "https://example.org/manual?page=7#top"},
)


@st.composite
def some_about(draw: st.DrawFn) -> dict[str, Any]:
    """Texts that people read, one at least."""
    found: dict[str, Any] = {"doc": draw(a_text)}
    if draw(st.booleans()):
        found["source"] = draw(st.sampled_from(_SOURCES))
    return found


@st.composite
def a_source(draw: st.DrawFn) -> dict[str, Any]:
    """Where it is written down, sometimes."""
    return {"source": draw(st.sampled_from(_SOURCES))} if draw(one_in(4)) else {}


@st.composite
def about(draw: st.DrawFn) -> dict[str, Any]:
    """Texts that people read, mostly none."""
    return draw(some_about()) if draw(one_in(6)) else {}


def octets(data: bytes) -> st.SearchStrategy[Any]:
    """The written forms of a byte string."""
    forms: list[Any] = [{"hex": data.hex(" ").upper()}, {"hex": data.hex()}, list(data)]
    if len(data) == 1:
        forms.append(data[0])
    forms.append({"text": data.decode("latin-1")})
    return st.sampled_from(forms)


def bytes_of_octets(written: Any) -> bytes:
    """The byte string of one of its written forms."""
    if isinstance(written, dict):
        text = written.get("hex")
        return bytes.fromhex(text) if text is not None else str(written["text"]).encode("latin-1")
    return bytes([written] if isinstance(written, int) else written)


def raw_number(value: int, *, character: bool = False) -> st.SearchStrategy[Any]:
    """A raw value as a number, or as the character that has this code."""
    if not (character or 0x30 <= value <= 0x7A) or not 0 <= value < 256:
        return st.just(value)
    return st.sampled_from([value, chr(value)])


def character(value: int | str) -> str:
    """The character of a byte, however it is written."""
    return value if isinstance(value, str) else chr(value)


def run(names: Sequence[str], every: Sequence[str]) -> st.SearchStrategy[Any]:
    """A set of parts, in wire order, as a list or, where nothing is left out, as `first..last`."""
    forms: list[Any] = [list(names)]
    if len(names) == 1:
        forms.append(names[0])
    first, last = every.index(names[0]), every.index(names[-1])
    if list(every[first : last + 1]) == list(names):
        forms.append(f"{names[0]}..{names[-1]}")
    return st.sampled_from(forms)


def short(full: dict[str, Any], key: str) -> Any:
    """The short form, where there is nothing but `key`."""
    return full[key] if set(full) == {key} else full
