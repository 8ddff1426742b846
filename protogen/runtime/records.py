"""Records, which are structs and the fields of messages, and rules for values that hold others."""

from __future__ import annotations

from collections import ChainMap
from collections.abc import Iterator, Mapping, Sequence
from typing import Any

from protogen.runtime.errors import EncodeError
from protogen.runtime.rules import OctetsRule, Rule, Scope, Violation

FieldRules = tuple[tuple[str, Rule], ...]
"""Name and rule of each field, in wire order."""

OUTERMOST: Scope = ChainMap()
"""The scope around a message's own fields, which is empty."""


def record_to_wire(record: Any, strict: bool, scope: Scope = OUTERMOST) -> dict[str, Any]:
    """What FORMAT builds for the fields of `record`. Raises EncodeError with the field's path."""
    inner = scope.new_child()
    for name, rule in record.RULES:
        try:
            inner[name] = rule.to_wire(getattr(record, name), inner, strict)
        except EncodeError as error:
            raise error.inside(name) from None
    return dict(inner.maps[0])


def record_from_wire(cls: Any, raw: Mapping[str, Any], scope: Scope = OUTERMOST) -> Any:
    """The record of what FORMAT parsed."""
    inner = scope.new_child()
    values = {}
    for name, rule in cls.RULES:
        values[name] = rule.from_wire(raw[name], inner)
        inner[name] = raw[name]
    return cls(**values)


def record_violations(record: Any, scope: Scope = OUTERMOST) -> list[Violation]:
    """The violations of all fields, up to the first value that does not even fit the wire."""
    inner = scope.new_child()
    found: list[Violation] = []
    for name, rule in record.RULES:
        value = getattr(record, name)
        try:
            raw = rule.to_wire(value, inner, strict=False)
        except EncodeError as error:
            unfit = error.inside(name)
            return [*found, Violation(unfit.path, unfit.problem)]
        found += [violation.inside(name) for violation in rule.violations(value, inner)]
        inner[name] = raw
    return found


def record_to_json(record: Any, scope: Scope = OUTERMOST) -> dict[str, Any]:
    """The fields as JSON shows them: raw numbers, bytes as hexadecimal text."""
    inner = scope.new_child()
    shown = {}
    for name, rule in record.RULES:
        shown[name] = inner[name] = rule.to_json(getattr(record, name), inner)
    return shown


def record_from_json(cls: Any, data: Any, scope: Scope = OUTERMOST) -> Any:
    """The record of what JSON shows; a field with a default may be left out.

    Raises EncodeError with the field's path where a field is missing, unknown or of another kind.
    """
    if not isinstance(data, Mapping):
        raise EncodeError("", f"must be a mapping of fields, not {data!r}")
    _check_names(cls, data)
    inner = scope.new_child()
    values = {}
    # Of a list, this is a mark: one is made for each record. No field counts or selects by it.
    defaults = cls.__init__.__kwdefaults__ or {}
    for name, rule in cls.RULES:
        if name in data:
            values[name] = inner[name] = _field_from_json(name, rule, data[name], inner)
        elif name in defaults:
            inner[name] = defaults[name]
        else:
            raise EncodeError(name, "the value is missing")
    return cls(**values)


def _field_from_json(name: str, rule: Rule, data: Any, scope: Scope) -> Any:
    try:
        return rule.from_json(data, scope)
    except EncodeError as error:
        raise error.inside(name) from None


def _check_names(cls: Any, data: Mapping[str, Any]) -> None:
    names = [name for name, _ in cls.RULES]
    for name in data:
        if name not in names:
            has = ", ".join(names) or "none"
            raise EncodeError(str(name), f"there is no such field; there are: {has}")


class StructRule(Rule):
    """Fields one after another: an instance of the dataclass `record`."""

    __slots__ = ("record",)

    record: type[Any]

    def __init__(self, record: type[Any]) -> None:
        self._set(record)

    def to_wire(self, value: Any, scope: Scope, strict: bool) -> dict[str, Any]:
        """The struct's values."""
        if not isinstance(value, self.record):
            raise EncodeError("", f"must be a {self.record.__name__}, not {value!r}")
        return record_to_wire(value, strict, scope)

    def from_wire(self, raw: Any, scope: Scope) -> Any:
        """The struct."""
        return record_from_wire(self.record, raw, scope)

    def violations(self, value: Any, scope: Scope) -> list[Violation]:
        """Those of the struct's fields."""
        return record_violations(value, scope)

    def to_json(self, value: Any, scope: Scope) -> dict[str, Any]:
        """A mapping of the fields."""
        return record_to_json(value, scope)

    def from_json(self, data: Any, scope: Scope) -> Any:
        """The struct of a mapping of the fields."""
        return record_from_json(self.record, data, scope)


class ArrayRule(Rule):
    """Values of one kind: `count` of them, or as many as the field `count` says.

    None: to the end of the payload, at most `greatest`.
    """

    __slots__ = ("const", "count", "element", "greatest")

    element: Rule
    count: int | str | None
    greatest: int | None
    const: Sequence[Any] | None

    def __init__(
        self,
        element: Rule,
        count: int | str | None = None,
        greatest: int | None = None,
        const: Sequence[Any] | None = None,
    ) -> None:
        self._set(element, count, greatest, const)

    def to_wire(self, value: Any, scope: Scope, strict: bool) -> list[Any]:
        """The elements."""
        if not isinstance(value, Sequence) or isinstance(value, str | bytes):
            raise EncodeError("", f"must be a list, not {value!r}")
        self._check_count(len(value), scope)
        if self.const is not None and list(value) != list(self.const):
            raise EncodeError("", f"must be {list(self.const)}")
        return list(_each(self.element.to_wire, value, scope, strict))

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

    def _check_count(self, count: int, scope: Scope) -> None:
        exactly = scope[self.count] if isinstance(self.count, str) else self.count
        if exactly is not None and count != exactly:
            says = f", as {self.count} says" if isinstance(self.count, str) else ""
            raise EncodeError("", f"needs exactly {exactly} elements{says}, not {count}")
        if self.greatest is not None and count > self.greatest:
            raise EncodeError("", f"has {count} elements, at most {self.greatest} are allowed")


def _each(convert: Any, elements: Sequence[Any], *context: Any) -> Iterator[Any]:
    """Convert each element; an error tells which one it was."""
    for index, element in enumerate(elements):
        try:
            yield convert(element, *context)
        except EncodeError as error:
            raise error.inside(f"[{index}]") from None


class NothingRule(Rule):
    """A case without bytes: its value is None."""

    __slots__ = ()

    def to_wire(self, value: Any, scope: Scope, strict: bool) -> None:
        """Nothing."""
        if value is not None:
            raise EncodeError("", f"must be None, not {value!r}")

    def from_json(self, data: Any, scope: Scope) -> None:
        """Nothing."""
        if data is not None:
            raise EncodeError("", f"must be null, not {data!r}")


NOTHING = NothingRule()


class SwitchRule(Rule):
    """One of several rules, chosen by the raw value of the field `selector`.

    A case of None has no bytes. A value without a case is `rest`, or can't be sent without one.
    """

    __slots__ = ("_chosen", "cases", "rest", "selector")

    selector: str
    cases: Mapping[int, Rule | None]
    rest: OctetsRule | None
    _chosen: Mapping[int, Rule]

    def __init__(
        self, selector: str, cases: Mapping[int, Rule | None], rest: OctetsRule | None = None
    ) -> None:
        self._set(selector, cases, rest)
        chosen = {value: rule or NOTHING for value, rule in cases.items()}
        object.__setattr__(self, "_chosen", chosen)

    def case(self, scope: Scope) -> Rule:
        """The rule that the selector chooses. Raises EncodeError if there is none."""
        rule = self._chosen.get(scope[self.selector], self.rest)
        if rule is None:
            known = ", ".join(str(int(value)) for value in self.cases)
            value = int(scope[self.selector])
            raise EncodeError("", f"there is no case for {self.selector} = {value}, only {known}")
        return rule

    def to_wire(self, value: Any, scope: Scope, strict: bool) -> Any:
        """The value of the case."""
        return self.case(scope).to_wire(value, scope, strict)

    def from_wire(self, raw: Any, scope: Scope) -> Any:
        """The value of the case."""
        return self.case(scope).from_wire(raw, scope)

    def violations(self, value: Any, scope: Scope) -> list[Violation]:
        """Those of the case."""
        return self.case(scope).violations(value, scope)

    def to_json(self, value: Any, scope: Scope) -> Any:
        """The case's value."""
        return self.case(scope).to_json(value, scope)

    def from_json(self, data: Any, scope: Scope) -> Any:
        """The case's value."""
        return self.case(scope).from_json(data, scope)
