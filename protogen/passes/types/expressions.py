"""Expressions over earlier fields, with their names looked up and their bounds checked."""

from __future__ import annotations

from collections import ChainMap
from collections.abc import Callable, Mapping
from functools import partial
from typing import NamedTuple

from protogen.copying import replace
from protogen.model.expression_bounds import Interval, bounds_of, is_settled
from protogen.model.expressions import (
    GREATEST_BITS,
    Arithmetic,
    Comparison,
    Expression,
    Junction,
    Membership,
    Minus,
    Not,
    Number,
    Operand,
    every,
    folded,
    inside,
    operands,
    plain_name,
)
from protogen.model.numbers import IntegerRole
from protogen.model.types import Field, Integer, Struct, is_integer
from protogen.passes.context import Context, Loc
from protogen.passes.types.setting import Scope, Setting
from protogen.problems import hint_for
from protogen.schema.expressions import ExpressionError, parse_expression

_Names = Mapping[str, int]
"""Values by their names."""
_NO_NAMES: _Names = {}


class Worked(NamedTuple):
    """An expression whose names were found."""

    expression: Expression
    fields: Mapping[str, Field]
    """The fields, by the names that the expression has for them."""

    @property
    def bounds(self) -> Interval:
        """The bounds of the value, as far as the ranges of the fields say."""
        return bounds_of(self.expression, lambda operand: allowed_in(self.fields, operand))

    @property
    def is_ranged(self) -> bool:
        """True if the schema bounds all fields."""
        whole = (it for it in operands(self.expression) if it.run is None)
        numbers = (self.fields[operand.name] for operand in whole)
        return all(field.ranged or field.const is not None for field in numbers)


def allowed_in(fields: Mapping[str, Field], operand: Operand) -> Interval:
    """What an encoder allows a field, or what the bits of it hold."""
    if operand.run is not None:
        low, high = operand.run
        return 0, (1 << (high - low + 1)) - 1
    field = fields[operand.name]
    if isinstance(field.const, int):
        return int(field.const), int(field.const)
    assert is_integer(field.type)
    least, greatest = field.least, field.greatest
    bounds = field.type.least if least is None else int(least)
    return bounds, field.type.greatest if greatest is None else int(greatest)


def capacity_in(fields: Mapping[str, Field], operand: Operand) -> Interval:
    """What the bits of a field hold, whatever is allowed."""
    if operand.run is not None:
        return allowed_in(fields, operand)
    type_ = fields[operand.name].type
    assert is_integer(type_)
    return type_.least, type_.greatest


class Selector(NamedTuple):
    """What chooses between cases."""

    expression: Expression
    type: Integer
    """A type that has just its values, and the names of those."""
    allowed: Interval
    """The least and the greatest value that an encoder allows."""
    special: frozenset[int]
    """Values out of these bounds that an encoder allows, too."""

    @property
    def named(self) -> frozenset[int]:
        """The values that have a name."""
        enum = self.type.enum
        return frozenset(entry.value for entry in enum.values) if enum else frozenset()

    def allows(self, value: int) -> bool:
        """True if an encoder allows the value."""
        least, greatest = self.allowed
        is_closed = self.type.is_closed and value not in self.named
        return not is_closed and (least <= value <= greatest or value in self.special)


def selector_of(found: Worked) -> Selector:
    """The expression as what chooses between cases."""
    item, allowed = found.expression, found.bounds
    if not isinstance(item, Operand):
        type_ = _type_of(*bounds_of(item, partial(capacity_in, found.fields)))
        return Selector(item, type_, allowed, frozenset())
    field = found.fields[item.name]
    assert is_integer(field.type)
    if item.run is None:
        special = frozenset(entry.value for entry in field.special)
        return Selector(item, field.type, allowed, special)
    enum = next((run.enum for run in field.type.bit_fields if run.name == item.bits), None)
    low, high = item.run
    role: IntegerRole = "bool" if low == high and enum is None else "number"
    return Selector(item, Integer(bits=high - low + 1, role=role, enum=enum), allowed, frozenset())


def _type_of(least: int, greatest: int) -> Integer:
    """The narrowest integer that holds these numbers."""
    bits = max(1, greatest.bit_length(), (-least - 1).bit_length() if least < 0 else 0)
    return Integer(bits=bits + (least < 0), signed=least < 0)


class _WrongError(Exception):
    """Something that an expression can't have."""

    def __init__(self, code: str, at: int, width: int, text: str, hint: str | None = None) -> None:
        super().__init__(text)
        self.code = code
        self.at = at
        self.width = width
        self.text = text
        self.hint = hint


def number(context: Context, written: str, loc: Loc, setting: Setting) -> Worked | None:
    """The expression of a number; None where it was reported to be none."""
    return _worked(context, written, loc, setting, _Reader(setting.outer, context).number)


def condition(context: Context, written: str, loc: Loc, setting: Setting) -> Worked | None:
    """The expression of a condition; None where it was reported to be none."""
    return _worked(context, written, loc, setting, _Reader(setting.outer, context).condition)


def inside_of(
    context: Context, written: str, loc: Loc, struct: Struct, code: str
) -> tuple[Operand, Field] | None:
    """A member of a struct, or bits of one, and the field; None where it was reported with `code`.

    What can't be told from outside of the struct, because it is not always there, is none.
    """
    reader = _Reader(ChainMap({field.name: field for field in struct.fields}))
    try:
        return reader.inside(parse_expression(written), struct)
    except ExpressionError as wrong:
        context.error_inside(code, loc, (wrong.at, 1), wrong.text, wrong.hint)
    except _WrongError as wrong:
        place = (wrong.at, wrong.width)
        context.error_inside(code, loc, place, wrong.text, wrong.hint)
    return None


def _worked(
    context: Context,
    written: str,
    loc: Loc,
    setting: Setting,
    read: Callable[[Expression], Worked],
) -> Worked | None:
    try:
        return read(parse_expression(written))
    except ExpressionError as wrong:
        context.error_inside("PG200", loc, (wrong.at, 1), wrong.text, wrong.hint)
    except _WrongError as wrong:
        # Where no message uses a type, its names may mean fields around it.
        if wrong.code != "PG116" or not setting.elsewhere:
            place = (wrong.at, wrong.width)
            context.error_inside(wrong.code, loc, place, wrong.text, wrong.hint)
    return None


class _Reader:
    """Looks up the names of one expression; raises _WrongError."""

    def __init__(self, scope: Scope, context: Context | None = None) -> None:
        self._scope = scope
        self._context = context
        self._fields: dict[str, Field] = {}

    def number(self, parsed: Expression) -> Worked:
        """The expression of a number."""
        found = self._read(parsed, _NO_NAMES)
        self._is_number(found)
        return self._within(found)

    def condition(self, parsed: Expression) -> Worked:
        """The expression of a condition, or of a number that is one."""
        found = self._read(parsed, _NO_NAMES)
        if isinstance(found, Number):
            text = f"`{parsed.text}` {'always' if found.value else 'never'} holds"
            raise _WrongError("PG205", *_place(parsed), text)
        return self._within(found)

    def inside(self, parsed: Expression, struct: Struct) -> tuple[Operand, Field]:
        """A member, or bits of one, and the field that has them."""
        if not isinstance(parsed, Operand):
            text = f"`{parsed.text}` is no name of a field of `{struct.name}`"
            raise _WrongError("", *_place(parsed), text, "an expression can't stand here")
        if parsed.path[0] not in self._scope:
            text = f"`{struct.name}` has no field `{parsed.path[0]}`"
            raise _WrongError("", *_place(parsed), text, hint_for(parsed.path[0], [*self._scope]))
        found = self._found(parsed)
        return found, self._member(found)

    def _within(self, found: Expression) -> Worked:
        """Check that every machine can hold the numbers on the way."""
        most = 1 << GREATEST_BITS
        if plain_name(found) is None:
            for item in every(found):
                inner = [bounds_of(it, self._capacity) for it in inside(item)]
                whole = bounds_of(item, self._capacity)
                if _farthest(whole) >= most > max(map(_farthest, inner), default=0):
                    text = f"`{item.text}` can have more than {GREATEST_BITS} bits"
                    raise _WrongError("PG203", *_place(item), text)
                self._is_open(item)
        return Worked(found, self._fields)

    def _capacity(self, operand: Operand) -> Interval:
        return capacity_in(self._fields, operand)

    def _is_open(self, item: Expression) -> None:
        """Check that it is a question whether a comparison holds."""
        settled = is_settled(item, self._capacity)
        if settled is None:
            return
        text = f"`{item.text}` {'always' if settled else 'never'} holds"
        if isinstance(item, Membership):
            low, high = bounds_of(item.operand, self._capacity)
            text = f"`{item.operand.text}` is from {low} to {high}, and never has all these values"
        raise _WrongError("PG205", *_place(item), text)

    # --- the tree ---------------------------------------------------------------------------------

    def _read(self, item: Expression, names: _Names) -> Expression:
        """The expression with names looked up; `names` stand for values here."""
        match item:
            case Operand():
                return self._named(item, names)
            case Minus():
                return replace(item, operand=self._number(item.operand))
            case Arithmetic():
                return self._arithmetic(item)
            case Comparison():
                left = self._number(item.left, self._names_beside(item.right))
                right = self._number(item.right, self._names_beside(item.left))
                return replace(item, left=left, right=right)
            case Membership():
                return self._membership(item)
            case Junction():
                left, right = self._read(item.left, _NO_NAMES), self._read(item.right, _NO_NAMES)
                return replace(item, left=left, right=right)
            case Not():
                return replace(item, operand=self._read(item.operand, _NO_NAMES))
        return item

    def _number(self, item: Expression, names: _Names = _NO_NAMES) -> Expression:
        found = self._read(item, names)
        self._is_number(found)
        return found

    def _is_number(self, item: Expression) -> None:
        if item.is_condition:
            text = f"`{item.text}` is true or false, and a number is due here"
            raise _WrongError("PG202", *_place(item), text)

    def _arithmetic(self, item: Arithmetic) -> Expression:
        left, right = self._number(item.left), self._number(item.right)
        if item.operator in ("//", "%"):
            right = folded(right, self._constant)
            if not isinstance(right, Number) or right.value < 1:
                text = f"`{item.operator}` divides by a number above 0 that never changes"
                raise _WrongError("PG204", item.at, len(item.operator), text)
        return replace(item, left=left, right=right)

    def _constant(self, operand: Operand) -> int | None:
        return self._fields[operand.name].constant_number

    def _membership(self, item: Membership) -> Expression:
        operand = self._number(item.operand)
        names = self._names_beside(item.operand)
        values = tuple(folded(self._number(it, names), self._constant) for it in item.values)
        for value, written in zip(values, item.values, strict=True):
            if not isinstance(value, Number):
                text = f"`{written.text}` is no number that never changes"
                raise _WrongError("PG202", *_place(written), text, "compare them by `==`")
        named = tuple(
            replace(value, name=written.name if isinstance(written, Number) else written.text)
            for value, written in zip(values, item.values, strict=True)
            if isinstance(value, Number)
        )
        return replace(item, operand=operand, values=named)

    # --- names ------------------------------------------------------------------------------------

    def _named(self, item: Operand, names: _Names) -> Expression:
        first, *rest = item.path
        if not rest and first in names:
            if first in self._scope:
                text = f"`{first}` is a field, and a value of what it is compared with"
                raise _WrongError("PG201", *_place(item), text, "write the number of the value")
            return Number(names[first], name=first, at=item.at)
        found = self._found(item, names)
        self._fields.setdefault(found.name, self._member(found))
        return found

    def _member(self, operand: Operand) -> Field:
        field = self._scope[operand.path[0]]
        for name in operand.path[1:]:
            assert isinstance(field.type, Struct)
            field = next(it for it in field.type.fields if it.name == name)
        return field

    def _found(self, item: Operand, names: _Names = _NO_NAMES) -> Operand:
        """The field, member or bits of a name."""
        field = self._scope.get(item.path[0])
        if field is None:
            known = [*self._scope, *names]
            text = f"no earlier field is called `{item.path[0]}`"
            hint = self._part_hint(item.path[0]) or hint_for(item.path[0], known)
            raise _WrongError("PG116", *_place(item), text, hint)
        self._is_there(item, field)
        for depth, name in enumerate(item.path[1:], start=1):
            members = field.type.fields if isinstance(field.type, Struct) else ()
            inner = next((it for it in members if it.name == name), None)
            if inner is None:
                return self._bits(item, field, depth)
            field = inner
            self._is_there(item, field)
        if not is_integer(field.type):
            text = f"`{item.name}` is no integer"
            raise _WrongError("PG201", *_place(item), text, _what_is_asked(field))
        return Operand(item.path, at=item.at)

    def _part_hint(self, name: str) -> str | None:
        """What to do where a part of the frame is meant."""
        frames = () if self._context is None else self._context.frames.values()
        parts = [part for frame in frames for part in frame.parts.items()]
        if not any(name in (part, *(written.bits or ())) for part, written in parts):
            return None
        field = f"`{name}: {{part: {name}, type: uint8}}`, with the bits that it has"
        return f"a part of the frame has that name: make it a field of the message, {field}"

    def _is_there(self, item: Operand, field: Field) -> None:
        if field.may_be_absent:
            text = f"`{field.name}` is not always there, so nothing can be worked out of it"
            key = "optional" if field.optional else "when"
            hint = f"put both into a struct that has the `{key}`"
            raise _WrongError("PG201", *_place(item), text, hint)

    def _bits(self, item: Operand, field: Field, depth: int) -> Operand:
        """The bits of a field that the last of the names stands for."""
        runs = _runs(field)
        name = ".".join(item.path[depth:])
        if isinstance(field.type, Integer) and any(
            run.gaps and run.name == name for run in field.type.bit_fields
        ):
            text = f"`{name}` is several runs of bits, of which nothing can be worked out"
            advice = "compare the whole number, or name each run"
            raise _WrongError("PG296", *_place(item), text, advice)
        if name not in runs:
            text = f"`{'.'.join(item.path[:depth])}` has nothing called `{name}`"
            hint = hint_for(name, [*runs, *_members(field)])
            raise _WrongError("PG201", *_place(item), text, hint)
        return Operand(item.path[:depth], runs[name], name, at=item.at)

    def _names_beside(self, other: Expression) -> _Names:
        """The names of values that something may be compared with."""
        if not isinstance(other, Operand) or other.path[0] not in self._scope:
            return _NO_NAMES
        try:
            found = self._found(other)
        except _WrongError:
            return _NO_NAMES  # Reported where it is read.
        return _value_names(self._member(found), found)


def _members(field: Field) -> list[str]:
    return [it.name for it in field.type.fields] if isinstance(field.type, Struct) else []


def _farthest(bounds: Interval) -> int:
    return max(map(abs, bounds))


def _what_is_asked(field: Field) -> str | None:
    names = _members(field)
    return f"name one of its fields, such as `{field.name}.{names[0]}`" if names else None


def _runs(field: Field) -> dict[str, Interval]:
    """The bits of a field that have a name."""
    if not isinstance(field.type, Integer):
        return {}
    runs = {run.name: (run.low, run.high) for run in field.type.bit_fields if not run.gaps}
    flags = field.type.flags.bits if field.type.flags else ()
    return {**runs, **{flag.name: (flag.bit, flag.bit) for flag in flags}}


def _value_names(field: Field, operand: Operand) -> dict[str, int]:
    """The names of the values that a field, or a run of its bits, can have."""
    type_ = field.type
    assert is_integer(type_)
    if operand.run is not None:
        enums = [run.enum for run in type_.bit_fields if run.name == operand.bits]
        return {it.name: it.value for enum in enums if enum for it in enum.values}
    if type_.role == "bool":
        return {"false": 0, "true": 1}
    named = (*(type_.enum.values if type_.enum else ()), *field.special)
    return {it.name: it.value for it in named}


def _place(item: Expression) -> tuple[int, int]:
    """Where the part of an expression begins in its text, and how wide it is there."""
    firsts = [it for it in every(item) if isinstance(it, Operand | Number)]
    first = min(firsts, key=lambda it: it.at)
    start = min(first.at, item.at)
    width = len(first.label if isinstance(first, Operand) else first.text)
    return (start, width) if isinstance(item, Operand | Number) else (start, 1)
