"""Numbers that other readers of YAML take for other numbers."""

from __future__ import annotations

import re
from collections.abc import Iterator
from typing import Any

from protogen.passes.context import Context, Loc
from protogen.passes.draft import Draft
from protogen.schema.references import form_under
from protogen.schema.syntax.forms import Form, keys_of
from protogen.schema.syntax.protocol import SCHEMA

_LEADING_ZERO = re.compile(r"[-+]?0+(?!0*[0-7]$)[0-9]+")
"""Not those of one digit below 8, which are the same number in octal."""
_BYTES = ("hex", "text")
"""Keys of a byte string, whose digits are no number."""


def check_numbers(context: Context, _: Draft) -> None:
    """Warn of decimal numbers that begin with a zero."""
    for loc, written in _leading_zeros(context.data, ()):
        if _is_text(context.data, loc):
            continue
        octal = written.lstrip("+-0") or "0"
        others, hint = "a text", f"write {int(written)}"
        if set(octal) <= set("01234567"):
            others, hint = "an octal one", f"{hint}, or 0o{octal} if it is octal"
        text = f"`{written}` is the decimal number {int(written)}, and {others} to other readers"
        context.warning("PG124", loc, text, hint)


def _leading_zeros(data: Any, loc: Loc) -> Iterator[tuple[Loc, str]]:
    """The integers that are written so, with their places."""
    if isinstance(data, dict | list):
        for key, item in data.items() if isinstance(data, dict) else enumerate(data):
            if not isinstance(item, str):
                yield from _leading_zeros(item, (*loc, key))
    elif isinstance(data, int) and _LEADING_ZERO.fullmatch(written := getattr(data, "text", "")):
        yield loc, written


def _is_text(data: Any, loc: Loc) -> bool:
    """True if what stands at a place is taken as it is written, with any zeros."""
    form = SCHEMA
    for key in loc:
        here, data = data, data[key]
        form = form_under(here, form, key) if isinstance(here, dict) else form.inside(key)
        if key in _BYTES and not form:
            return True
    return _is_text_here(form)


def _is_text_here(form: Form) -> bool:
    keys = [keys_of(model)[form.short] for model in form.models if form.short is not None]
    return form.text or any(map(_is_text_here, keys))
