"""Records, which are structs and the fields of messages, and rules for values that hold others."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from typing import Any

from protogen.runtime.attributes import ATTRIBUTES, attribute
from protogen.runtime.errors import EncodeError
from protogen.runtime.payload.formula import Formula, number_of
from protogen.runtime.payload.rules import Rule, Scope, SeveralRule, Violation
from protogen.runtime.payload.string_rules import OctetsRule

FieldRules = tuple[tuple[str, Rule], ...]
"""Name and rule of each field, in wire order."""


class StructRule(Rule):
    """Fields one after another: an instance of the class `record`, which has a rule for each."""

    def __init__(self, record: type[Any]) -> None:
        self.record = record

    def to_wire(self, value: Any, scope: Scope, strict: bool) -> dict[str, Any]:
        """The fields' values. Raises EncodeError with the field's path."""
        if not isinstance(value, self.record):
            raise EncodeError("", f"must be a {self.record.__name__}, not {value!r}")
        inner = scope.new_child()
        for name, rule in self.record.RULES:
            field = getattr(value, ATTRIBUTES.get(name, name))
            try:
                inner[name] = rule.chosen(inner).to_wire(field, inner, strict)
            except EncodeError as error:
                raise error.inside(name) from None
        return dict(inner.maps[0])

    def from_wire(self, raw: Mapping[str, Any], scope: Scope) -> Any:
        """The record of what FORMAT parsed."""
        inner = scope.new_child()
        values = {}
        for name, rule in self.record.RULES:
            values[ATTRIBUTES.get(name, name)] = rule.chosen(inner).from_wire(raw[name], inner)
            inner[name] = raw[name]
        return self.record(**values)

    def violations(self, value: Any, scope: Scope) -> list[Violation]:
        """Those of all fields, up to the first value that does not even fit the wire."""
        inner = scope.new_child()
        found: list[Violation] = []
        for name, rule in self.record.RULES:
            field = getattr(value, ATTRIBUTES.get(name, name))
            try:
                chosen = rule.chosen(inner)
                raw = chosen.to_wire(field, inner, strict=False)
            except EncodeError as error:
                return [*found, Violation(error.path, error.problem).inside(name)]
            found += [violation.inside(name) for violation in chosen.violations(field, inner)]
            inner[name] = raw
        return found

    def to_json(self, value: Any, scope: Scope) -> dict[str, Any]:
        """A mapping of the fields."""
        inner = scope.new_child()
        shown = {}
        for name, rule in self.record.RULES:
            field = getattr(value, ATTRIBUTES.get(name, name))
            shown[name] = inner[name] = rule.chosen(inner).to_json(field, inner)
        return shown

    def from_json(self, data: Any, scope: Scope) -> Any:
        """The record of a mapping of the fields; one with a default may be left out.

        Raises EncodeError with the field's path where one is missing, unknown or of another kind.
        """
        if not isinstance(data, Mapping):
            raise EncodeError("", f"must be a mapping of fields, not {data!r}")
        self._check_names(data)
        inner = scope.new_child()
        values = {}
        # Of a list, this is a mark: one is made for each record. No field counts or selects by it.
        defaults = self.record.__init__.__kwdefaults__ or {}
        for name, rule in self.record.RULES:
            own = ATTRIBUTES.get(name, name)
            if name in data:
                try:
                    value = rule.chosen(inner).from_json(data[name], inner)
                except EncodeError as error:
                    raise error.inside(name) from None
                values[own] = value
                inner[name] = _seen(value)
            elif own in defaults:
                inner[name] = defaults[own]
            else:
                raise EncodeError(name, "the value is missing")
        return self.record(**values)

    def _check_names(self, data: Mapping[str, Any]) -> None:
        names = [name for name, _ in self.record.RULES]
        for name in data:
            if name not in names:
                has = ", ".join(names) or "none"
                raise EncodeError(str(name), f"there is no such field; there are: {has}")


class _Members(Mapping[str, Any]):
    """The fields of a record, for formulas that ask for one of them."""

    def __init__(self, record: Any) -> None:
        self._record = record

    def __getitem__(self, name: str) -> Any:
        return _seen(getattr(self._record, attribute(name)))

    def __iter__(self) -> Iterator[str]:
        return (name for name, _ in self._record.RULES)

    def __len__(self) -> int:
        return len(self._record.RULES)


def _seen(value: Any) -> Any:
    """A value as formulas behind it see it."""
    return _Members(value) if hasattr(value, "RULES") else value


class ArrayRule(SeveralRule[Sequence[Any]]):
    """Values of one kind: `count` of them, or as many as earlier fields say.

    With a `mark`, which is a member of each or a formula over its members, that is not 0 in the
    last of them, and in no other.
    """

    def __init__(
        self,
        element: Rule,
        count: int | str | Formula | None = None,
        greatest: int | None = None,
        const: Sequence[Any] | None = None,
        least: int = 0,
        mark: str | Formula | None = None,
    ) -> None:
        super().__init__(count, greatest, const, least)
        self.element = element
        self.mark = mark

    def to_wire(self, value: Any, scope: Scope, strict: bool) -> list[Any]:
        """The elements."""
        if not isinstance(value, Sequence) or isinstance(value, str | bytes):
            raise EncodeError("", f"must be a list, not {value!r}")
        self._check_count(len(value), scope, "elements")
        if self.const is not None and list(value) != list(self.const):
            raise EncodeError("", f"must be {list(self.const)}")
        found = list(_each(self.element.to_wire, value, scope, strict))
        if self.mark is not None:
            _check_marks(self.mark, found)
        return found

    def from_wire(self, raw: Any, scope: Scope) -> list[Any]:
        """The elements."""
        from_wire = self.element.from_wire
        return [from_wire(element, scope) for element in raw]

    def violations(self, value: Any, scope: Scope) -> list[Violation]:
        """Those of the elements."""
        return [
            violation.inside(f"[{index}]")
            for index, element in enumerate(value)
            for violation in self.element.violations(element, scope)
        ]

    def to_json(self, value: Any, scope: Scope) -> list[Any]:
        """A list."""
        return [self.element.to_json(element, scope) for element in value]

    def from_json(self, data: Any, scope: Scope) -> list[Any]:
        """The elements of a list."""
        if not isinstance(data, list | tuple):
            raise EncodeError("", f"must be a list, not {data!r}")
        return list(_each(self.element.from_json, data, scope))


def _check_marks(mark: str | Formula, elements: Sequence[Mapping[str, Any]]) -> None:
    """Refuse elements of which another one than the last says that it is the last."""
    last = len(elements) - 1
    for index, element in enumerate(elements):
        says = number_of(mark, element.__getitem__) != 0
        if says and index < last:
            problem = f"must be 0, as other elements follow: this is {index + 1} of {last + 1}"
        elif not says and index == last:
            problem = "must not be 0, as this is the last element"
        else:
            continue
        raise EncodeError(str(mark), problem).inside(f"[{index}]")


def _each(convert: Any, elements: Sequence[Any], *context: Any) -> Iterator[Any]:
    """Convert each element; an error tells which one it was."""
    for index, element in enumerate(elements):
        try:
            yield convert(element, *context)
        except EncodeError as error:
            raise error.inside(f"[{index}]") from None


class NothingRule(Rule):
    """A case without bytes: its value is None."""

    def to_wire(self, value: Any, scope: Scope, strict: bool) -> None:
        """Nothing."""
        if value is not None:
            problem = f"must be None, as a struct without fields is, not {value!r}"
            raise EncodeError("", problem)

    def from_json(self, data: Any, scope: Scope) -> None:
        """Nothing."""
        if data is not None:
            problem = f"must be null, as a struct without fields is, not {data!r}"
            raise EncodeError("", problem)


_NOTHING = NothingRule()


class WhenRule(Rule):
    """A rule for a value that is there only where a condition on earlier fields holds.

    Else the value is None.
    """

    def __init__(self, condition: str | Formula, rule: Rule) -> None:
        self.condition = condition
        self.rule = rule

    def chosen(self, scope: Scope) -> Rule:
        """The rule for a value that is there, or for none."""
        if number_of(self.condition, scope.__getitem__):
            return _There(self.rule.chosen(scope), self.condition)
        return _Absent(self.condition)


class _There(Rule):
    """A value that has to be there; a constant needs not be given."""

    def __init__(self, rule: Rule, condition: str | Formula) -> None:
        self._rule = rule
        self._condition = condition

    def to_wire(self, value: Any, scope: Scope, strict: bool) -> Any:
        """The value that FORMAT builds."""
        constant = getattr(self._rule, "const", None)
        if value is None and constant is None and not isinstance(self._rule, NothingRule):
            raise EncodeError("", f"is missing, as {self._condition} holds")
        given = constant if value is None else value
        return self._rule.to_wire(given, scope, strict)

    def from_wire(self, raw: Any, scope: Scope) -> Any:
        """The attribute's value."""
        return self._rule.from_wire(raw, scope)

    def violations(self, value: Any, scope: Scope) -> list[Violation]:
        """Those of the value."""
        return [] if value is None else self._rule.violations(value, scope)

    def to_json(self, value: Any, scope: Scope) -> Any:
        """The value as JSON shows it."""
        return None if value is None else self._rule.to_json(value, scope)

    def from_json(self, data: Any, scope: Scope) -> Any:
        """The value of what JSON shows."""
        return None if data is None else self._rule.from_json(data, scope)


class _Absent(NothingRule):
    """A value that is not there."""

    def __init__(self, condition: str | Formula) -> None:
        self._condition = condition

    def to_wire(self, value: Any, scope: Scope, strict: bool) -> None:
        """Nothing."""
        if value is not None:
            raise EncodeError("", f"must be None, as {self._condition} does not hold")

    def to_json(self, value: Any, scope: Scope) -> None:
        """Nothing."""

    def from_json(self, data: Any, scope: Scope) -> None:
        """Nothing."""
        if data is not None:
            raise EncodeError("", f"must be null, as {self._condition} does not hold")


class OptionalRule(Rule):
    """A rule for a value that may be left out: then it is None, and so is all behind it.

    `behind` is the field in front that may be left out as well.
    """

    def __init__(self, rule: Rule, behind: str | None = None) -> None:
        self.rule = rule
        self.behind = behind

    def to_wire(self, value: Any, scope: Scope, strict: bool) -> Any:
        """The value that FORMAT builds; None where it is left out."""
        if value is None:
            return None
        if self.behind is not None and scope[self.behind] is None:
            raise EncodeError("", f"must be None, as {self.behind} in front of it is left out")
        return self.rule.chosen(scope).to_wire(value, scope, strict)

    def from_wire(self, raw: Any, scope: Scope) -> Any:
        """The attribute's value."""
        return None if raw is None else self.rule.chosen(scope).from_wire(raw, scope)

    def violations(self, value: Any, scope: Scope) -> list[Violation]:
        """Those of the value."""
        return [] if value is None else self.rule.chosen(scope).violations(value, scope)

    def to_json(self, value: Any, scope: Scope) -> Any:
        """The value as JSON shows it."""
        return None if value is None else self.rule.chosen(scope).to_json(value, scope)

    def from_json(self, data: Any, scope: Scope) -> Any:
        """The value of what JSON shows."""
        return None if data is None else self.rule.chosen(scope).from_json(data, scope)


class SwitchRule(Rule):
    """One of several rules, chosen by the raw values of earlier fields.

    A case of None has no bytes. The case under None is that of all other values; without it, a
    value without a case is `rest`, or can't be sent.
    """

    def __init__(
        self,
        selector: str | Formula,
        cases: Mapping[int | None, Rule | None],
        rest: OctetsRule | None = None,
    ) -> None:
        self.selector = selector
        self.cases = cases
        self.rest = rest

    def chosen(self, scope: Scope) -> Rule:
        """The rule that the selector chooses. Raises EncodeError if there is none."""
        value = number_of(self.selector, scope.__getitem__)
        key = value if value in self.cases else None
        if key in self.cases:
            return (self.cases[key] or _NOTHING).chosen(scope)
        if self.rest is None:
            known = ", ".join(str(int(case)) for case in self.cases if case is not None)
            raise EncodeError("", f"there is no case for {self.selector} = {value}, only {known}")
        return self.rest
