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
    for loc, written in _leading_zeros(context.data, SCHEMA, ()):
        octal = written.lstrip("+-0") or "0"
        others, hint = "a text", f"write {int(written)}"
        if set(octal) <= set("01234567"):
            others, hint = "an octal one", f"{hint}, or 0o{octal} if it is octal"
        text = f"`{written}` is the decimal number {int(written)}, and {others} to other readers"
        context.warning("PG124", loc, text, hint)


def _leading_zeros(data: Any, form: Form, loc: Loc) -> Iterator[tuple[Loc, str]]:
    """The numbers that are written so, with their places; a text may have any zeros."""
    if isinstance(data, dict):
        for key, item in data.items():
            inner = form_under(data, form, key)
            if inner or key not in _BYTES:
                yield from _leading_zeros(item, inner, (*loc, key))
    elif isinstance(data, list):
        for index, item in enumerate(data):
            yield from _leading_zeros(item, form.inside(index), (*loc, index))
    elif isinstance(data, int) and not _is_text(form):
        written = getattr(data, "text", "")
        if _LEADING_ZERO.fullmatch(written):
            yield loc, written


def _is_text(form: Form) -> bool:
    """True if a bare scalar is taken as it is written."""
    keys = [keys_of(model)[form.short] for model in form.models if form.short is not None]
    return form.text or any(map(_is_text, keys))
