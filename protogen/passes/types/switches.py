"""Cases of a switch, and the rest for a value without one."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Protocol

from protogen.copying import replace
from protogen.model.types import Case, Field, Struct, Switch, is_integer
from protogen.passes.context import Context, Loc
from protogen.passes.types.constants import named_raw_value
from protogen.passes.types.declared import Effective
from protogen.passes.types.named_types import NamedTypes
from protogen.passes.types.setting import Setting
from protogen.problems import hint_for
from protogen.schema.syntax.fields import FieldSyntax


class Fields(Protocol):
    """Resolver of the fields that cases are."""

    def field(self, name: str, item: FieldSyntax, loc: Loc, setting: Setting) -> Field:
        """One field."""

    def effective(self, item: FieldSyntax, loc: Loc, setting: Setting) -> Effective:
        """Effective form of a field, once declared types are followed."""


class SwitchBuilder:
    """Resolves switches."""

    def __init__(self, context: Context, named: NamedTypes, fields: Fields) -> None:
        self._context = context
        self._named = named
        self._fields = fields
        self._ends: dict[tuple[Loc, str], bool] = {}
        """True where a switch ended the payload, by its place and the type that it is in."""

    def switch(self, item: Effective) -> Switch | None:
        """The switch, or None where nothing can choose."""
        selector = self._selector(item)
        if selector is None or not item.syntax.cases:
            if not item.syntax.cases:
                self._context.error_at_key("PG121", item.chain[0][1], "a switch needs `cases`")
            return None
        places = item.at("cases")
        cases = [
            self._case(key, case, (*places, key), selector, item.setting)
            for key, case in item.syntax.cases.items()
        ]
        known = tuple(case for case in cases if case is not None)
        self._distinct(known, places)
        if not known:
            return None
        return Switch(
            selector=selector.name,
            cases=known,
            rest=self._rest(known, item),
            byte_bits=item.setting.layout.byte_bits,
        )

    def _selector(self, item: Effective) -> Field | None:
        name, outer = item.syntax.switch or "", item.setting.outer
        selector = outer.get(name)
        if selector is not None and is_integer(selector.type):
            return selector
        if selector is not None:
            self._context.error("PG116", item.at("switch"), f"`{name}` is not an integer")
        elif not item.setting.elsewhere:
            hint = hint_for(name, outer)
            self._context.error("PG116", item.at("switch"), f"`{name}` is no earlier field", hint)
        return None

    def _rest(self, cases: Sequence[Case], item: Effective) -> int | None:
        """Greatest number of bytes for a value without a case; None where the end is not known."""
        ends = item.setting.delimited and item.setting.last
        self._same_everywhere(ends, item)
        if not ends:
            return None
        if item.setting.room is not None:
            return item.setting.room
        return max(case.type.sizes.greatest for case in cases)

    def _same_everywhere(self, ends: bool, item: Effective) -> None:
        """A declared type is one type: its switch has a rest wherever it is used, or nowhere."""
        loc = item.at("switch")
        if item.setting.elsewhere:
            return  # Where no message uses it, nobody knows what it ends.
        if self._ends.setdefault((loc, item.setting.owner), ends) == ends:
            return
        types = self._context.syntax.types
        structs = [name for name in item.setting.stack if types[name].fields]
        around = structs[-1] if structs else item.setting.owner
        self._context.error(
            "PG107",
            loc,
            f"two different types would be called `{around}`: where it ends a payload, this "
            "switch keeps the bytes of a value without a case, and elsewhere it can't",
            "declare a type for each of the two uses",
        )

    def _case(
        self, key: object, item: FieldSyntax, loc: Loc, selector: Field, setting: Setting
    ) -> Case | None:
        assert is_integer(selector.type)
        named = named_raw_value(selector.type, key)
        if named is None:
            enum = selector.type.enum
            hint = hint_for(str(key), [entry.name for entry in enum.values] if enum else [])
            text = f"`{selector.name}` has no value {key}"
            self._context.error_at_key("PG121", loc, text, hint)
            return None
        value, name = named
        inner = replace(setting, owner=f"{setting.owner}_{name}")
        return Case(value=value, name=name, type=self._struct(item, loc, inner))

    def _struct(self, item: FieldSyntax, loc: Loc, setting: Setting) -> Struct:
        """A case that is no struct becomes one of a single field."""
        effective = self._fields.effective(item, loc, setting).syntax
        if effective.fields is None or effective.count is not None:
            inner = replace(setting, owner=f"{setting.owner}_value", position=0)
            field = self._fields.field("value", item, loc, inner)
            struct = Struct(name=setting.owner, fields=(field,))
            self._named.register(struct, loc)
            return struct
        type_ = self._fields.field("value", item, loc, setting).type
        return type_ if isinstance(type_, Struct) else Struct(name=setting.owner, fields=())

    def _distinct(self, cases: Sequence[Case], loc: Loc) -> None:
        seen: set[int] = set()
        for case in cases:
            if case.value in seen:
                self._context.error("PG121", loc, f"two cases for the value {case.value}")
            seen.add(case.value)
