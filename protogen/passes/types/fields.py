"""Fields of a payload, and how they lie in it.

Turns the fields of a message or struct into resolved types, outer before inner, in wire order.
"""

from __future__ import annotations

from collections.abc import Mapping

from protogen.copying import replace
from protogen.model.nesting import takes_rest
from protogen.model.sizes import SizeSet
from protogen.model.types import Array, Extent, Field, Fixed, Octets, Struct, Text, Type
from protogen.passes.context import Context, Loc, about
from protogen.passes.types import meaning
from protogen.passes.types.declared import Declarations, Effective, Expansion
from protogen.passes.types.extents import Written, extent_of
from protogen.passes.types.field_keys import check_keys, has_one_form
from protogen.passes.types.named_types import NamedTypes
from protogen.passes.types.setting import Setting
from protogen.passes.types.switches import SwitchBuilder
from protogen.passes.types.type_names import UNKNOWN_TYPE, float_type, integer
from protogen.passes.types.value_names import with_names
from protogen.schema.syntax.fields import FieldSyntax
from protogen.schema.syntax.fields import Fill as FillSyntax


class FieldBuilder:
    """Resolves fields; reports what is wrong with each and goes on with the next."""

    def __init__(self, context: Context, named: NamedTypes) -> None:
        self._context = context
        self._named = named
        self._declarations = Declarations(context)
        self._switches = SwitchBuilder(context, named, self)
        self._expansion = Expansion(context)

    @property
    def followed(self) -> frozenset[str]:
        """The declared types that were used so far; all where there were too many to follow."""
        is_cut = self._expansion.is_spent or self._declarations.too_deep
        return frozenset(self._context.syntax.types if is_cut else self._declarations.followed)

    def fields(
        self, syntax: Mapping[str, FieldSyntax], loc: Loc, setting: Setting
    ) -> tuple[Field, ...]:
        """The fields of one struct or message, with their positions."""
        built: dict[str, Field] = {}
        scope = setting.outer.new_child(built)
        behind = SizeSet.exactly(0)
        filler = ""
        final = list(syntax)[-1:]
        for name, item in syntax.items():
            if filler:
                self._behind(filler, (*loc, name))
            inner = setting.inside(name, behind, scope, [name] == final)
            built[name] = self.field(name, item, (*loc, name), inner)
            behind += built[name].type.sizes
            filler = filler or (name if takes_rest(built[name].type) else "")
        return tuple(built.values())

    def field(self, name: str, item: FieldSyntax, loc: Loc, setting: Setting) -> Field:
        """One field."""
        unknown = Field(name=name, type=UNKNOWN_TYPE, position=setting.position)
        if not has_one_form(self._context, item, loc) or not self._expansion.enter(loc, setting):
            return unknown
        effective = self.effective(item, loc, setting)
        if not all(has_one_form(self._context, *link) for link in effective.chain[1:]):
            return unknown
        check_keys(self._context, name, effective)
        return meaning.attach(self._context, name, self._type(effective), effective)

    def effective(self, item: FieldSyntax, loc: Loc, setting: Setting) -> Effective:
        """Effective form of a field, once declared types are followed."""
        return self._declarations.effective(item, loc, setting)

    def _behind(self, filler: str, loc: Loc) -> None:
        text = f"nothing can follow `{filler}`, which fills the payload to its end"
        hint = f"move `{filler}` to the end, or give it a count"
        self._context.error_at_key("PG111", loc, text, hint)

    # -- types --------------------------------------------------------------------------------

    def _type(self, item: Effective) -> Type:
        if item.syntax.switch is not None:
            self._expansion.vary()
            return self._switches.switch(item) or UNKNOWN_TYPE
        if item.syntax.type in ("ascii", "bytes"):
            return self._string(item)
        if item.syntax.count is not None:
            return self._array(item)
        return self._element(item, item.setting)

    def _element(self, item: Effective, setting: Setting) -> Type:
        if item.syntax.fields is not None:
            return self._struct(item, item.syntax.fields, setting)
        name, layout = item.syntax.type or "", setting.layout
        found = integer(name, layout) or float_type(name, layout)
        if found is None:
            self._context.tally.errors += 1  # Reported where names are checked.
            return UNKNOWN_TYPE
        if found.size > 1 and layout.byte_order is None:
            self._no_byte_order(item.at("type"))
        dressed = with_names(self._context, found, item)
        for named in dressed.named_types:
            self._named.register(named, item.chain[0][1])
        return dressed

    def _struct(
        self, item: Effective, fields: Mapping[str, FieldSyntax], setting: Setting
    ) -> Struct:
        known = self._expansion.known(item, setting.layout)
        if known is not None:
            return known
        begun = self._expansion.mark()
        inner = replace(setting, owner=item.owner, depth=setting.depth + 1)
        built = self.fields(fields, (*item.place, "fields"), inner)
        origin = item.origin
        struct = Struct(name=item.owner, fields=built, about=about(origin.doc, origin.source))
        if not self._expansion.is_spent:
            self._named.register(struct, item.chain[0][1])
            self._expansion.keep(item, struct, setting.layout, begun)
        return struct

    def _array(self, item: Effective) -> Array:
        written, loc = item.syntax.count, item.at("count")
        element = self._element(item, replace(item.setting, last=False))
        if takes_rest(element):
            text = "elements of an array can't fill the payload"
            self._context.error("PG111", loc, text)
        if element.sizes.least == 0 and isinstance(written, FillSyntax):
            text = "an element may be empty, so nothing says how many fill the payload"
            self._context.error("PG118", loc, text)
        least = max(1, element.sizes.least)
        return Array(element=element, extent=self._extent(written, loc, least, item.setting))

    def _string(self, item: Effective) -> Text | Octets:
        kind, size = item.syntax.type, item.syntax.size
        if size is None:
            text = f"{kind} needs a `size`: a number, an earlier field, or fill"
            self._context.error_at_key("PG110", item.chain[0][1], text)
        extent = self._extent(size, item.at("size"), 1, item.setting)
        byte_bits = item.setting.layout.byte_bits
        if kind == "ascii":
            return Text(extent=extent, byte_bits=byte_bits)
        return Octets(extent=extent, byte_bits=byte_bits)

    def _extent(self, written: Written, loc: Loc, element: int, setting: Setting) -> Extent:
        extent = extent_of(self._context, written, loc, element, setting)
        if not isinstance(extent, Fixed):
            self._expansion.vary()
        return extent

    # -- problems -----------------------------------------------------------------------------

    def _no_byte_order(self, loc: Loc) -> None:
        self._context.error(
            "PG109",
            loc,
            "nothing says in which order the bytes of this number are sent",
            "set `byte_order: little` or `big` on the protocol, the message or the field",
        )
