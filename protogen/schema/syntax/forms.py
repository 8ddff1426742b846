"""Forms: what may stand at a place of a schema, read from the annotations of the syntax classes."""

from __future__ import annotations

import types
from collections.abc import Iterable, Mapping
from functools import cache
from typing import Annotated, Any, Union, get_args, get_origin

import msgspec
from pydantic import BaseModel, BeforeValidator

from protogen.schema.syntax.base import ShortForm, as_written
from protogen.schema.syntax.names import Mark


class Form(msgspec.Struct):
    """The alternatives of one annotation, side by side."""

    marks: list[Mark] = msgspec.field(default_factory=list)
    models: list[type[BaseModel]] = msgspec.field(default_factory=list)
    """Classes of mappings with fixed keys."""
    text: bool = False
    """True for what is taken as it is written, such as 1.10 or 007."""
    short: str | None = None
    """Key that a bare scalar stands for."""
    names: Form | None = None
    """Keys of a mapping of names to `items`."""
    items: Form | None = None
    """Values of a mapping from names, or items of a list."""
    _refers: bool | None = None

    @property
    def refers(self) -> bool:
        """True if what stands here, or inside of it, may refer to a name. Worked out once."""
        if self._refers is None:
            inside = (form for model in models_inside(self) for form in keys_of(model).values())
            self._refers = any(map(_is_marked, (self, *inside)))
        return self._refers

    def inside(self, step: object) -> Form:
        """Form of what stands under a key or an index; empty if nothing is known of it."""
        for model in self.models:
            keys = keys_of(model)
            if step in keys:
                return keys[step]
        return self.items or _UNKNOWN

    def __bool__(self) -> bool:
        return bool(self.marks or self.models or self.names or self.items)


_UNKNOWN = Form()
"""Form of what nothing is known of."""


@cache
def keys_of(model: type[BaseModel]) -> Mapping[object, Form]:
    """Forms of the keys of a syntax class."""
    return {
        info.alias or name: _form(info.annotation, info.metadata)
        for name, info in model.model_fields.items()
    }


def _is_marked(form: Form) -> bool:
    """True if a name is told by the annotation itself, not by a class that it leads to."""
    inner = (form.names, form.items)
    return bool(form.marks) or any(_is_marked(item) for item in inner if item is not None)


def models_inside(form: Form) -> set[type[BaseModel]]:
    """All syntax classes that a form leads to."""
    found: set[type[BaseModel]] = set()
    waiting = [form]
    while waiting:
        inner = waiting.pop()
        waiting += [inner.items] if inner.items else []
        for model in set(inner.models) - found:
            found.add(model)
            waiting += keys_of(model).values()
    return found


def _form(annotation: Any, metadata: Iterable[Any] = ()) -> Form:
    form = Form()
    _add_metadata(form, metadata)
    _add(form, annotation)
    return form


def _add(form: Form, annotation: Any) -> None:
    origin, arguments = get_origin(annotation), get_args(annotation)
    if origin is Annotated:
        _add_metadata(form, arguments[1:])
        _add(form, arguments[0])
    elif origin in (Union, types.UnionType):
        for member in arguments:
            _add(form, member)
    elif origin is dict:
        form.names, form.items = map(_form, arguments)
    elif origin in (tuple, list):
        form.items = _form(arguments[0])
    elif isinstance(annotation, type) and issubclass(annotation, BaseModel):
        form.models.append(annotation)


def _add_metadata(form: Form, metadata: Iterable[Any]) -> None:
    for mark in metadata:
        if isinstance(mark, Mark):
            form.marks.append(mark)
        elif isinstance(mark, BeforeValidator) and mark.func is as_written:
            form.text = True
        elif isinstance(mark, BeforeValidator) and isinstance(mark.func, ShortForm):
            form.short = mark.func.key
