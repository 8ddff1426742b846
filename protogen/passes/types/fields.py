"""Fields of a payload, and how they lie in it.

Turns the fields of a message or struct into resolved types, outer before inner, in wire order.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from fractions import Fraction

from protogen.copying import replace
from protogen.model.expressions import Expression
from protogen.model.nesting import fills, takes_rest
from protogen.model.sizes import SizeSet
from protogen.model.types import (
    Array,
    Case,
    Counted,
    Extent,
    Field,
    Fixed,
    NumberType,
    Octets,
    Struct,
    Switch,
    Text,
    Type,
    bits_of,
    is_integer,
)
from protogen.passes.context import Context, Loc, about
from protogen.passes.types import meaning
from protogen.passes.types.constants import named_raw_value
from protogen.passes.types.declared import Declarations, Effective, Expansion
from protogen.passes.types.expressions import Selector, condition, number, selector_of
from protogen.passes.types.extents import Written, extent_of
from protogen.passes.types.field_keys import check_keys, has_one_form
from protogen.passes.types.last_elements import is_marked_array, marked_extent
from protogen.passes.types.named_types import NamedTypes
from protogen.passes.types.optional_fields import check_tail, is_optional
from protogen.passes.types.other_cases import ELSE, check_else, hint_at_else, is_else
from protogen.passes.types.packing import (
    bytes_of_element,
    check_packing,
    order_of_elements,
    order_of_fields,
    packed_elements,
    packed_fields,
)
from protogen.passes.types.part_fields import BITS, check_part_field
from protogen.passes.types.separators import character, check_separated, text_between, with_absent
from protogen.passes.types.setting import Setting
from protogen.passes.types.sized_arrays import (
    has_region,
    in_elements,
    in_region,
    is_sized_array,
    region_of,
)
from protogen.passes.types.tails import can_be_followed, in_front_of_tail
from protogen.passes.types.terminators import until_of
from protogen.passes.types.text_forms import text_form
from protogen.passes.types.text_numbers import says_text, text_number, with_text
from protogen.passes.types.type_names import UNKNOWN_TYPE, float_type, integer
from protogen.passes.types.value_names import with_names
from protogen.problems import hint_for
from protogen.schema.syntax.fields import FieldSyntax, Until, UntilElement
from protogen.schema.syntax.fields import Fill as FillSyntax


class FieldBuilder:
    """Resolves fields; reports what is wrong with each and goes on with the next."""

    def __init__(self, context: Context, named: NamedTypes) -> None:
        self._context = context
        self._named = named
        self._declarations = Declarations(context)
        self._expansion = Expansion(context)
        self._ends: dict[tuple[Loc, str], bool] = {}
        """True where a switch ended the payload, by its place and the type that it is in."""

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
        behind, bits = SizeSet.exactly(0), 0
        filler = omitted = ""
        final = list(syntax)[-1:]
        for name, item in syntax.items():
            if filler and not can_be_followed(built[filler]):
                self._behind(filler, (*loc, name))
            first = all(field.part for field in built.values())
            inner = setting.inside(name, behind, scope, first=first, last=[name] == final)
            built[name] = self.field(name, item, (*loc, name), inner)
            check_tail(self._context, omitted, built[name], (*loc, name))
            if omitted:
                built[name] = replace(built[name], behind=omitted)
            behind += built[name].sizes_in_front
            if setting.layout.packed is not None:
                built[name] = replace(built[name], bit=bits)
                bits += bits_of(built[name].type)
            filler = filler or (name if fills(built[name]) else "")
            omitted = name if built[name].optional else ""
        if filler and can_be_followed(built[filler]):
            built[filler] = in_front_of_tail(
                self._context, tuple(built.values()), filler, loc, setting
            )
        return tuple(built.values())

    def field(self, name: str, item: FieldSyntax, loc: Loc, setting: Setting) -> Field:
        """One field."""
        unknown = Field(name=name, type=UNKNOWN_TYPE, position=setting.position)
        if not has_one_form(self._context, item, loc) or not self._expansion.enter(loc, setting):
            return unknown
        effective = self._effective(item, loc, setting)
        if not all(has_one_form(self._context, *link) for link in effective.chain[1:]):
            return unknown
        if effective.syntax.part is not None:
            return self._part_field(name, effective, unknown)
        check_keys(self._context, name, effective)
        if not check_packing(self._context, name, effective):
            return unknown
        if not check_separated(self._context, name, effective):
            return unknown
        type_, region = self._in_region(effective)
        found = meaning.attach(self._context, name, type_, effective)
        optional = is_optional(self._context, name, effective)
        return replace(found, when=self._when(effective), region=region, optional=optional)

    def _part_field(self, name: str, item: Effective, unknown: Field) -> Field:
        """A field that is a part of the frame, a number without bytes."""
        if not check_part_field(self._context, name, item, item.setting.outer.maps[0].values()):
            return unknown
        item = replace(item, setting=replace(item.setting, layout=BITS, position=None))
        found = meaning.attach(self._context, name, self._element(item, item.setting), item)
        return replace(found, part=item.syntax.part or "")

    def _effective(self, item: FieldSyntax, loc: Loc, setting: Setting) -> Effective:
        return self._declarations.effective(item, loc, setting)

    def _behind(self, filler: str, loc: Loc) -> None:
        text = f"nothing can follow `{filler}`, which fills the payload to its end"
        hint = f"move `{filler}` to the end, or give it a count"
        self._context.error_at_key("PG111", loc, text, hint)

    def _when(self, item: Effective) -> Expression | None:
        """The condition on which a field is there."""
        if item.syntax.when is None:
            return None
        self._expansion.vary()
        found = condition(self._context, item.syntax.when, item.at("when"), item.setting)
        return None if found is None else found.expression

    def _in_region(self, item: Effective) -> tuple[Type, Fixed | Counted | None]:
        """The type of a field, and the region that it has to fill, where there is one."""
        if not has_region(item.syntax):
            return self._type(item), None
        before = self._context.tally.errors
        extent = self._extent(item.syntax.size, item.at("size"), 1, item.setting)
        is_told = self._context.tally.errors == before
        inner = replace(item, setting=in_region(item.setting, extent)) if is_told else item
        type_ = self._type(inner)
        return region_of(self._context, type_, extent, item) if is_told else (type_, None)

    # -- types --------------------------------------------------------------------------------

    def _type(self, item: Effective) -> Type:
        if item.syntax.switch is not None:
            self._expansion.vary()
            return self._switch(item) or UNKNOWN_TYPE
        if item.syntax.type in ("ascii", "bytes"):
            return self._string(item)
        if item.syntax.count is not None or is_sized_array(item.syntax):
            return self._array(item)
        if is_marked_array(item.syntax) and item.syntax.fields is not None:
            return self._array(item)
        return self._element(item, item.setting)

    def _element(self, item: Effective, setting: Setting) -> Type:
        if item.syntax.fields is not None:
            return self._struct(item, item.syntax.fields, setting)
        name, layout = item.syntax.type or "", setting.layout
        found: NumberType | None = text_number(self._context, item)
        found = found or character(self._context, item)
        if found is None:
            found = integer(name, layout) or float_type(name, layout)
            if found is None:
                self._context.tally.errors += 1  # Reported where names are checked.
                return UNKNOWN_TYPE
            found = with_text(self._context, found, item)
        if found.size > 1 and layout.byte_order is None and not says_text(item):
            self._no_byte_order(item.at("type"))
        named = with_absent(self._context, with_names(self._context, found, item), item)
        return self._registered(named, item)

    def _registered(self, type_: NumberType, item: Effective) -> NumberType:
        """The number, with the names under which its values are registered."""
        if not is_integer(type_) or not type_.named_types:
            return type_
        loc, register = item.chain[0][1], self._named.register
        own = (type_.enum or type_.flags) is not None and item.declared is not None
        enum = type_.enum and register(type_.enum, loc, declared=own)
        flags = type_.flags and register(type_.flags, loc, declared=own)
        runs = tuple(
            replace(run, enum=run.enum and register(run.enum, loc, declared=False))
            for run in type_.bit_fields
        )
        return replace(type_, enum=enum, flags=flags, bit_fields=runs)

    def _struct(
        self, item: Effective, fields: Mapping[str, FieldSyntax], setting: Setting
    ) -> Struct:
        setting = packed_fields(item, setting)
        known = self._expansion.known(item, setting.layout)
        if known is not None:
            return known
        begun = self._expansion.mark()
        inner = replace(setting, owner=item.owner, depth=setting.depth + 1)
        built = self.fields(fields, (*item.place, "fields"), inner)
        origin = item.origin
        struct = Struct(
            name=item.owner,
            fields=built,
            about=about(origin.doc, origin.source),
            packed=order_of_fields(self._context, built, item),
        )
        if not self._expansion.is_spent:
            struct = self._named.register(
                struct, item.chain[0][1], declared=item.declared is not None
            )
            self._expansion.keep(item, struct, setting.layout, begun)
        return struct

    def _array(self, item: Effective) -> Array:
        key = "size" if is_sized_array(item.syntax) else "count"
        key = key if item.syntax.count is not None or not is_marked_array(item.syntax) else "until"
        written, loc = getattr(item.syntax, key), item.at(key)
        setting = packed_elements(self._context, item, replace(item.setting, last=False))
        element = self._element(item, setting)
        if takes_rest(element):
            text = "elements of an array can't fill the payload"
            self._context.error("PG111", loc, text)
        order = order_of_elements(self._context, element, item, setting)
        if element.sizes.least == 0 and isinstance(written, FillSyntax) and order is None:
            text = "an element may be empty, so nothing says how many fill the payload"
            self._context.error("PG118", loc, text)
        return Array(
            element=element,
            extent=self._number_of(element, written, loc, item),
            packed=order,
        )

    def _number_of(self, element: Type, written: Written, loc: Loc, item: Effective) -> Extent:
        """The number of elements of an array; where its bytes are told, that of those."""
        until = item.syntax.until
        if isinstance(until, UntilElement) and item.syntax.count is None:
            self._expansion.vary()
            return marked_extent(self._context, until, item.at("until"), element, item.setting)
        if not is_sized_array(item.syntax):
            least = bytes_of_element(self._context, element, item)
            return self._extent(written, loc, least, item.setting)
        extent, size = self._extent(written, loc, 1, item.setting), element.sizes.fixed
        if not size and takes_rest(element):
            return Fixed(count=0)  # Which was reported.
        if not size:
            text = "elements have to be of one size that is not 0, so that bytes tell their number"
            self._context.error("PG240", loc, text, "count the elements: `count`")
            return Fixed(count=0)
        stated = item.syntax.count
        within = None
        if stated is not None:
            inner = in_region(item.setting, extent)
            within = self._extent(stated, item.at("count"), size, inner)
        return in_elements(self._context, extent, size, item, within)

    def _string(self, item: Effective) -> Text | Octets:
        byte_bits = item.setting.layout.byte_bits
        if item.setting.layout.separator is not None:
            self._expansion.vary()
            between = text_between(self._context, item)
            return Text(extent=between, form=text_form(self._context, item, between))
        extent = self._length(item)
        if item.syntax.type == "ascii":
            form = text_form(self._context, item, extent)
            return Text(extent=extent, byte_bits=byte_bits, form=form)
        return Octets(extent=extent, byte_bits=byte_bits)

    def _length(self, item: Effective) -> Extent:
        """The number of bytes of a text, or of bytes."""
        syntax = item.syntax
        if isinstance(syntax.until, Until) and syntax.size is None:
            self._expansion.vary()
            return until_of(self._context, syntax.until, item.at("until"), item.setting)
        if syntax.size is None and syntax.until is None:
            text = f"{syntax.type} needs a `size`: a number, an earlier field, or fill"
            hint = "or a terminator that ends it: `until: 0`"
            self._context.error_at_key("PG110", item.chain[0][1], text, hint)
        return self._extent(syntax.size, item.at("size"), 1, item.setting)

    def _extent(
        self, written: Written, loc: Loc, element: Fraction | int, setting: Setting
    ) -> Extent:
        extent = extent_of(self._context, written, loc, element, setting)
        if not isinstance(extent, Fixed):
            self._expansion.vary()
        return extent

    # -- switches -----------------------------------------------------------------------------

    def _switch(self, item: Effective) -> Switch | None:
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
        found = [case for case in cases if case is not None]
        known = tuple(sorted(found, key=lambda case: case.value is None))
        self._distinct(known, places)
        if not known:
            return None
        check_else(self._context, known, selector, item.syntax.cases, places)
        return Switch(
            selector=selector.expression,
            cases=known,
            rest=self._rest(known, item),
            byte_bits=item.setting.layout.byte_bits,
        )

    def _selector(self, item: Effective) -> Selector | None:
        written, place = item.syntax.switch or "", item.at("switch")
        found = number(self._context, written, place, item.setting)
        return None if found is None else selector_of(found)

    def _rest(self, cases: Sequence[Case], item: Effective) -> int | None:
        """Greatest number of bytes for a value without a case; None where the end is not known.

        No value is without one beside `else`. Bytes that nobody knows could hold a separator, or
        begin without one.
        """
        if cases[-1].value is None:
            return None
        separated = item.setting.layout.separator is not None
        ends = item.setting.delimited and item.setting.last and not separated
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
        self, key: object, item: FieldSyntax, loc: Loc, selector: Selector, setting: Setting
    ) -> Case | None:
        named = (None, ELSE) if is_else(key) else named_raw_value(selector.type, key)
        if named is None:
            enum = selector.type.enum
            names = [entry.name for entry in enum.values] if enum else []
            hint = hint_for(str(key), names) or hint_at_else(key)
            text = f"`{selector.expression.text}` has no value {key}"
            self._context.error_at_key("PG121", loc, text, hint)
            return None
        value, name = named
        inner = replace(setting, owner=f"{setting.owner}_{name}")
        return Case(value=value, name=name, type=self._case_struct(item, loc, inner))

    def _case_struct(self, item: FieldSyntax, loc: Loc, setting: Setting) -> Struct:
        """A case that is no struct, or not always one, becomes one of a single field."""
        effective = self._effective(item, loc, setting).syntax
        others = (effective.count, effective.when, effective.size, effective.until)
        is_bare = all(other is None for other in others)
        if effective.fields is None or not is_bare:
            inner = replace(setting, owner=f"{setting.owner}_value", position=0)
            field = self.field("value", item, loc, inner)
            struct = Struct(name=setting.owner, fields=(field,))
            return self._named.register(struct, loc, declared=False)
        type_ = self.field("value", item, loc, setting).type
        return type_ if isinstance(type_, Struct) else Struct(name=setting.owner, fields=())

    def _distinct(self, cases: Sequence[Case], loc: Loc) -> None:
        seen: set[int | None] = set()
        for case in cases:
            if case.value in seen:
                self._context.error("PG121", loc, f"two cases for the value {case.value}")
            seen.add(case.value)

    # -- problems -----------------------------------------------------------------------------

    def _no_byte_order(self, loc: Loc) -> None:
        self._context.error(
            "PG109",
            loc,
            "nothing says in which order the bytes of this number are sent",
            "set `byte_order: little` or `big` on the protocol, the message or the field",
        )
