"""References of a schema: every name that stands for something that is declared elsewhere.

The syntax classes mark which keys hold names, and of what kind. One walk over them and the tree
finds all references, each with the mappings that may declare it.
"""

from __future__ import annotations

from collections.abc import Iterator

import msgspec

from protogen.schema.scopes import Place, Scopes
from protogen.schema.syntax.forms import Form
from protogen.schema.syntax.names import BySender, FieldPath, FieldValues, Kind, Mark, Ref
from protogen.schema.syntax.protocol import SCHEMA
from protogen.schema.text.edit import items_of, keys_of
from protogen.schema.text.nodes import MappingNode, Node, ScalarNode, SequenceNode
from protogen.schema.text.scalars import Scalar

_NAMINGS = ("values", "flags", "bits")
"""Keys under which a field names its values or bits."""


class Spot(msgspec.Struct, frozen=True):
    """Scalar of a tree: a value, or the key of an item."""

    place: Place
    at_key: bool = False


class Reference(msgspec.Struct, frozen=True):
    """A name in the text of a scalar, and the mappings that may declare it, nearest first."""

    kind: Kind
    spot: Spot
    node: ScalarNode
    start: int
    """Offset of the name in the text of the scalar."""
    name: Scalar
    scopes: tuple[Place, ...]

    def declarations(self, root: Node) -> list[Place]:
        """Places of what it names: one, or a part for each sender that has one."""
        found = [scope for scope in self.scopes if self.name in keys_of(root.at(scope))]
        nearest = found if self.kind is Kind.PART else found[:1]
        return [(*scope, self.name) for scope in nearest]


def references(root: Node) -> Iterator[Reference]:
    """Yield all references of a schema, which need not be valid, in the order of its text."""
    return _Walk(root).inside(root, SCHEMA, ())


def form_under(root: Node, form: Form, key: Scalar) -> Form:
    """Form of what stands under a key: stated for each sender, or once for all of them."""
    inner = form.inside(key)
    if not any(isinstance(mark, BySender) for mark in inner.marks) or inner.items is None:
        return inner
    return inner if is_by_sender(root, key) else inner.items


def is_by_sender(root: Node, key: Scalar) -> bool:
    """True if what stands under ``key`` is keyed by endpoint."""
    senders = keys_of(root.child(key))
    return bool(senders) and senders <= keys_of(root.child("endpoints"))


class _Walk:
    """One walk over a tree, along the syntax classes."""

    def __init__(self, root: Node) -> None:
        self._root = root
        self._scopes = Scopes(root, is_by_sender(root, "frame"))

    def inside(self, node: Node, form: Form, place: Place) -> Iterator[Reference]:
        """Yield the references in a node of this form."""
        if not form:
            return
        for mark in form.marks:
            yield from self._marked(mark, node, place)
        match node:
            case MappingNode():
                yield from self._mapping(node, form, place)
            case SequenceNode():
                for index, item in enumerate(node.items):
                    yield from self.inside(item, form.items or Form(), (*place, index))
            case ScalarNode():
                if form.short is not None:
                    yield from self.inside(node, form.inside(form.short), place)
                elif form.items is not None and form.names is None:
                    yield from self.inside(node, form.items, place)

    def _mapping(self, node: MappingNode, form: Form, place: Place) -> Iterator[Reference]:
        for key, value in node.items:
            at = (*place, key.value)
            for mark in form.names.marks if form.names else ():
                yield from self._named(mark, key, Spot(at, at_key=True))
            yield from self.inside(value, form_under(self._root, form, key.value), at)

    def _marked(self, mark: Mark, node: Node, place: Place) -> Iterator[Reference]:
        if isinstance(mark, FieldValues):
            fields = (*place[:2], "fields")
            yield from self._values_of_fields(node, (fields,), place)
        elif isinstance(node, ScalarNode):
            yield from self._named(mark, node, Spot(place))

    def _named(self, mark: Mark, node: ScalarNode, spot: Spot) -> Iterator[Reference]:
        """Yield what a scalar names, by its mark."""
        match mark:
            case Ref(Kind.PART):
                scopes = self._scopes.of_parts(spot.place)
                start = 0
                for name in node.text.split("..") if isinstance(node.value, str) else ():
                    yield Reference(Kind.PART, spot, node, start, name, scopes)
                    start += len(name) + len("..")
            case Ref(kind, of):
                scopes = self._scopes.of(kind, of, spot.place)
                yield Reference(kind, spot, node, 0, node.value, scopes)
            case FieldPath():
                yield from _field_path(node, spot)

    def _values_of_fields(
        self, node: Node, scopes: tuple[Place, ...], place: Place
    ) -> Iterator[Reference]:
        """Yield what the values of a struct name: fields, and the names of their values."""
        for key, value in items_of(node):
            at = (*place, key.value)
            named = Reference(Kind.FIELD, Spot(at, at_key=True), key, 0, key.value, scopes)
            yield named
            for field in named.declarations(self._root):
                yield from self._values_of_field(value, field, at)

    def _values_of_field(self, node: Node, field: Place, place: Place) -> Iterator[Reference]:
        if isinstance(node, SequenceNode):
            for index, item in enumerate(node.items):
                yield from self._values_of_field(item, field, (*place, index))
            return
        namings = self._scopes.inside_field(field, *_NAMINGS)
        if isinstance(node, ScalarNode):
            yield Reference(Kind.VALUE, Spot(place), node, 0, node.value, namings)
        elif structs := self._scopes.inside_field(field, "fields"):
            yield from self._values_of_fields(node, structs, place)
        else:
            yield from self._values_of_fields(node, namings, place)


def _field_path(node: ScalarNode, spot: Spot) -> Iterator[Reference]:
    """Yield the message and the field that a dotted path names; without a dot, the type."""
    message, dot, rest = str(node.value).partition(".")
    if not dot:
        yield Reference(Kind.TYPE, spot, node, 0, node.value, (("types",),))
        return
    yield Reference(Kind.MESSAGE, spot, node, 0, message, (("messages",),))
    fields = ("messages", message, "fields")
    name = rest.partition(".")[0]
    yield Reference(Kind.FIELD, spot, node, len(message) + 1, name, (fields,))
