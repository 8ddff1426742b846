"""Declarations that the types of fields lead to."""

from __future__ import annotations

from typing import NamedTuple

import msgspec

from protogen.copying import replace
from protogen.model.types import Struct
from protogen.passes.context import Context, Loc
from protogen.passes.types.setting import Setting
from protogen.passes.types.type_names import Layout
from protogen.schema.syntax.fields import FieldSyntax

GREATEST_DEPTH = 64
"""So deep may structs and declared types be nested."""

VALUE_NAMES = ("values", "flags", "bits")
"""Keys that name the values or bits of an integer; a field has one of them."""

_NAMING_KEYS = ("fields", *VALUE_NAMES)
"""Keys that make a named type. It is called after the declaration that has them."""

_LAYOUT_KEYS = (*_NAMING_KEYS, "switch", "cases", "packed")


class Effective(msgspec.Struct, frozen=True):
    """A field's syntax once declared types are followed."""

    syntax: FieldSyntax
    """The declaration, with the keys of its uses on top."""
    setting: Setting
    chain: tuple[tuple[FieldSyntax, Loc], ...]
    """Syntax of the field, then of the declarations that it leads to."""
    declared: str | None = None
    """The declared type that the named type is called after."""

    @property
    def owner(self) -> str:
        """Name of the enum, flags or struct of this field."""
        return self.declared or self.setting.owner

    @property
    def origin(self) -> FieldSyntax:
        """Place of the named type, where its text for readers stands."""
        return self.chain[self._naming()][0]

    @property
    def place(self) -> Loc:
        """The place of the origin."""
        return self.chain[self._naming()][1]

    def at(self, key: str) -> Loc:
        """The place of a key: where it was written, else where it could have been."""
        places = [loc for syntax, loc in self.chain if key in syntax.model_fields_set]
        here = self.chain[0][1] if not places else places[-1 if key == "type" else 0]
        return (*here, key)

    def followed(self, name: str, declaration: FieldSyntax) -> Effective:
        """This use on top of the declaration of `name`."""
        over = {key: getattr(self.syntax, key) for key in self.syntax.model_fields_set - {"type"}}
        names = any(getattr(declaration, key) is not None for key in _NAMING_KEYS)
        return Effective(
            syntax=declaration.model_copy(update=over),
            setting=replace(
                self.setting,
                stack=(*self.setting.stack, name),
                depth=self.setting.depth + 1,
            ),
            chain=(*self.chain, (declaration, ("types", name))),
            declared=name if names else self.declared,
        )

    def ordered(self) -> Effective:
        """The same, with the byte order in force that the field states."""
        order = self.syntax.byte_order
        if order is None:
            return self
        layout = replace(self.setting.layout, byte_order=order)
        return replace(self, setting=replace(self.setting, layout=layout))

    def _naming(self) -> int:
        """Link of the chain that names the type; the field itself where none does."""
        places = [loc for _, loc in self.chain]
        return 0 if self.declared is None else places.index(("types", self.declared))


class Declarations:
    """Follows the types of fields to what is written under `types`."""

    def __init__(self, context: Context) -> None:
        self._context = context
        self._types = context.syntax.types
        self.followed: set[str] = set()
        """The declared types that were asked for."""
        self.too_deep: set[Loc] = set()
        """The fields whose types were not followed, because they are nested too deep."""

    def effective(self, item: FieldSyntax, loc: Loc, setting: Setting) -> Effective:
        """Effective form of a field; a plain byte where its types lead nowhere."""
        result = Effective(item, setting, ((item, loc),))
        while (name := result.syntax.type) is not None and name in self._types:
            if self._is_endless(name, result.setting, loc):
                return Effective(FieldSyntax(type="byte"), setting, ((item, loc),))
            self._stated_twice(name, result)
            self.followed.add(name)
            result = result.followed(name, self._types[name])
        return result.ordered()

    def _is_endless(self, name: str, setting: Setting, loc: Loc) -> bool:
        path = (*setting.stack, name)
        if name in setting.stack:
            text = f"the types go in a circle: {' -> '.join(path)}"
            self._context.error("PG119", (*loc, "type"), text)
            return True
        if setting.depth < GREATEST_DEPTH:
            return False
        if loc not in self.too_deep:
            text = f"the types from `{path[0]}` on are nested more than {GREATEST_DEPTH} deep"
            self._context.error("PG122", (*loc, "type"), text)
            self.too_deep.add(loc)
        return True

    def _stated_twice(self, name: str, use: Effective) -> None:
        for key in _LAYOUT_KEYS:
            stated = getattr(use.syntax, key), getattr(self._types[name], key)
            if None not in stated:
                text = f"the type `{name}` states its `{key}` already"
                hint = "declare another type, or write the field out"
                self._context.error_at_key("PG110", use.at(key), text, hint)


GREATEST_NUMBER = 50_000
"""So many fields may come of the declared types."""


class Mark(NamedTuple):
    """Counts when a struct was begun."""

    fields: int
    varying: int


class Expansion:
    """Counts fields that come of declared types, and keeps structs that are alike everywhere."""

    def __init__(self, context: Context) -> None:
        self._context = context
        self._fields = 0
        self._varying = 0
        self._fixed: dict[tuple[str, Layout], tuple[Struct, int]] = {}
        self.is_spent = False
        """True if there were too many fields; what was built since is not whole."""

    def enter(self, loc: Loc, setting: Setting) -> bool:
        """Count a field; False where there are too many, which is said once."""
        if not setting.stack or self.is_spent:
            return not setting.stack
        self._fields += 1
        if self._fields > GREATEST_NUMBER:
            self.is_spent = True
            text = f"with this, more than {GREATEST_NUMBER} fields come of declared types"
            self._context.error_at_key("PG122", loc, text)
        return not self.is_spent

    def vary(self) -> None:
        """Note something whose bounds depend on where it stands."""
        self._varying += 1

    def mark(self) -> Mark:
        """Counts so far."""
        return Mark(self._fields, self._varying)

    def keep(self, item: Effective, struct: Struct, layout: Layout, begun: Mark) -> None:
        """Keep a declared struct, unless something in it depends on where it stands."""
        if item.declared is not None and self._varying == begun.varying:
            self._fixed[(item.declared, layout)] = (struct, self._fields - begun.fields)

    def known(self, item: Effective, layout: Layout) -> Struct | None:
        """A declared struct that was kept; its fields count again."""
        if item.declared is None or (item.declared, layout) not in self._fixed:
            return None
        struct, count = self._fixed[(item.declared, layout)]
        self._fields += count
        return struct
