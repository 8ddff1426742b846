"""References of a schema: every name that stands for something that is declared elsewhere.

The syntax classes mark which keys hold names, and of what kind. One walk over them and the data
of a schema finds all references, each with the mappings that may declare it.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import msgspec

from protogen.model.expressions import Comparison, Expression, Membership, Operand, every, operands
from protogen.schema.expressions import ExpressionError, parse_expression
from protogen.schema.scopes import Place, Scopes, declares
from protogen.schema.syntax.forms import Form
from protogen.schema.syntax.names import (
    BySender,
    FieldPath,
    FieldValues,
    Formula,
    Kind,
    Mark,
    Matched,
    Member,
    NumberPath,
    Ref,
)
from protogen.schema.syntax.protocol import SCHEMA, is_by_sender
from protogen.schema.text.scalars import Scalar

_ANYWHERE: Place = ("messages",)
"""A place that is about all frames."""

_NAMINGS = ("values", "flags", "bits")
"""Keys under which a field names its values or bits."""


class Spot(msgspec.Struct, frozen=True):
    """Scalar of a schema: a value, or the key of an item."""

    place: Place
    at_key: bool = False


class Reference(msgspec.Struct, frozen=True):
    """A name in the text of a scalar, and the mappings that may declare it, nearest first."""

    kind: Kind
    spot: Spot
    name: Scalar
    scopes: tuple[Place, ...]
    start: int = 0
    """Offset of the name in the text of the scalar."""
    missing: str | None = None
    """Code of the problem that it is where nothing has the name."""

    def declarations(self, data: Any) -> list[Place]:
        """Places of what it names: one, or a part for each sender that has one."""
        found = [scope for scope in self.scopes if declares(data, scope, self.name)]
        nearest = found if self.kind is Kind.PART else found[:1]
        return [(*scope, self.name) for scope in nearest]


def references(data: Any) -> Iterator[Reference]:
    """Yield all references of a schema, which need not be valid, in the order of its text."""
    return _Walk(data).inside(data, SCHEMA, ())


def form_under(data: Any, form: Form, key: Scalar) -> Form:
    """Form of what stands under a key: stated for each sender, or once for all of them."""
    inner = form.inside(key)
    if inner.items is None or not any(isinstance(mark, BySender) for mark in inner.marks):
        return inner
    return inner if is_by_sender(data, str(key)) else inner.items


class _Walk:
    """One walk over the data of a schema, along the syntax classes."""

    def __init__(self, data: Any) -> None:
        self._data = data
        self._scopes = Scopes(data)

    def inside(self, value: Any, form: Form, place: Place) -> Iterator[Reference]:
        """Yield the references in a value of this form."""
        for mark in form.marks:
            yield from self._marked(mark, value, place)
        if isinstance(value, dict):
            yield from self._mapping(value, form, place)
        elif isinstance(value, list):
            for index, item in enumerate(value):
                yield from self.inside(item, form.items or Form(), (*place, index))
        elif form.short is not None:
            yield from self.inside(value, form.inside(form.short), place)
        elif form.items is not None and form.names is None:
            yield from self.inside(value, form.items, place)

    def _mapping(self, mapping: dict[Scalar, Any], form: Form, place: Place) -> Iterator[Reference]:
        marks = form.names.marks if form.names else ()
        for key, value in mapping.items():
            for mark in marks:
                yield from self._named(mark, key, Spot((*place, key), at_key=True))
            inner = form_under(self._data, form, key)
            if inner.refers:
                yield from self.inside(value, inner, (*place, key))

    def _marked(self, mark: Mark, value: Any, place: Place) -> Iterator[Reference]:
        if isinstance(mark, FieldValues):
            fields = (*place[:2], "fields")
            yield from self._values_of_fields(value, (fields,), place)
        elif not isinstance(value, dict | list):
            yield from self._named(mark, value, Spot(place))

    def _named(self, mark: Mark, written: Scalar, spot: Spot) -> Iterator[Reference]:
        """Yield what a scalar names, by its mark."""
        match mark:
            case Ref(Kind.PART):
                scopes = self._scopes.of_parts(spot.place)
                start = 0
                for name in written.split("..") if isinstance(written, str) else ():
                    yield Reference(Kind.PART, spot, name, scopes, start)
                    start += len(name) + len("..")
            case Ref(kind, of, missing):
                scopes = self._scopes.of(kind, of, spot.place)
                yield Reference(kind, spot, written, scopes, missing=missing)
            case Formula() if isinstance(written, str):
                yield from self._in_formula(str(written), spot)
            case Matched(of):
                scopes = self._scopes.of_matched(of, spot.place)
                yield Reference(Kind.PART, spot, written, scopes)
            case Member() if isinstance(written, str):
                yield from self._in_element(written, spot)
            case NumberPath() if "." not in str(written):
                yield Reference(Kind.PART, spot, written, self._scopes.of_parts(_ANYWHERE))
            case NumberPath() | FieldPath():
                yield from _field_path(str(written), spot)

    def _in_formula(self, written: str, spot: Spot) -> Iterator[Reference]:
        """Yield what an expression names: fields, members, bits, and values they are compared to.

        What can't be read names nothing; the passes say why.
        """
        try:
            parsed = parse_expression(written)
        except ExpressionError:
            return
        values = dict(_compared(parsed))
        for operand in operands(parsed):
            scopes = self._scopes.of(Kind.FIELD, None, spot.place)
            first = Reference(Kind.FIELD, spot, operand.path[0], scopes, operand.at)
            if operand.at in values and not first.declarations(self._data):
                scopes = self._scopes.values_of(values[operand.at], spot.place)
                yield Reference(Kind.VALUE, spot, operand.name, scopes, operand.at)
                continue
            yield first
            at = operand.at
            for depth, name in enumerate(operand.path[1:], start=1):
                at += len(operand.path[depth - 1]) + 1
                scopes = self._scopes.inside_path(operand.path[:depth], spot.place)
                yield Reference(Kind.FIELD, spot, name, scopes, at)

    def _in_element(self, written: str, spot: Spot) -> Iterator[Reference]:
        """Yield the members, and bits, that a name inside of an element goes by."""
        names = written.split(".")
        for depth, name in enumerate(names):
            scopes = self._scopes.inside_element(names[:depth], spot.place)
            yield Reference(Kind.FIELD, spot, name, scopes, len(".".join([*names[:depth], ""])))

    def _values_of_fields(
        self, values: Any, scopes: tuple[Place, ...], place: Place
    ) -> Iterator[Reference]:
        """Yield what the values of a struct name: fields, and the names of their values."""
        for key, value in values.items() if isinstance(values, dict) else ():
            inner = (*place, key)
            named = Reference(Kind.FIELD, Spot(inner, at_key=True), key, scopes)
            yield named
            for field in named.declarations(self._data):
                yield from self._values_of_field(value, field, inner)

    def _values_of_field(self, value: Any, field: Place, place: Place) -> Iterator[Reference]:
        if isinstance(value, list):
            for index, item in enumerate(value):
                yield from self._values_of_field(item, field, (*place, index))
            return
        namings = self._scopes.inside_field(field, *_NAMINGS)
        if not isinstance(value, dict):
            yield Reference(Kind.VALUE, Spot(place), value, namings)
        elif structs := self._scopes.inside_field(field, "fields"):
            yield from self._values_of_fields(value, structs, place)
        else:
            yield from self._values_of_fields(value, namings, place)


def _compared(parsed: Expression) -> Iterator[tuple[int, tuple[str, ...]]]:
    """Yield the places of names that may stand for values, with the field that would have those."""
    for item in every(parsed):
        pairs: list[tuple[Expression, Expression]] = []
        if isinstance(item, Comparison):
            pairs = [(item.left, item.right), (item.right, item.left)]
        elif isinstance(item, Membership):
            pairs = [(value, item.operand) for value in item.values]
        for one, other in pairs:
            if isinstance(one, Operand) and isinstance(other, Operand):
                yield one.at, other.path


def _field_path(path: str, spot: Spot) -> Iterator[Reference]:
    """Yield the message and the field that a dotted path names; without a dot, the type."""
    message, dot, rest = path.partition(".")
    if not dot:
        yield Reference(Kind.TYPE, spot, path, (("types",),))
        return
    yield Reference(Kind.MESSAGE, spot, message, (("messages",),))
    fields = ("messages", message, "fields")
    name = rest.partition(".")[0]
    yield Reference(Kind.FIELD, spot, name, (fields,), len(message) + 1)
