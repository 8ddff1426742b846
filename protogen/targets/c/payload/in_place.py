"""Functions that write a message where it stands in its frame, field by field.

So a large array needs no struct beside the frame. They are there for large messages that have an
array of elements of one size, and all of whose fields lie at places that never change.
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from itertools import accumulate

import msgspec

from protogen.c_language.numbers import hexadecimal, integer_type, unsigned
from protogen.model.initial_payload import begins_refused, initial_bytes
from protogen.model.messages import Message
from protogen.model.payload_builder import plan_of_struct
from protogen.model.payload_plan import (
    AnyStep,
    BytesStep,
    ConstantStep,
    FloatStep,
    IntegerStep,
    PartStep,
    RecordStep,
    RepeatStep,
)
from protogen.model.types import NumberType, Text
from protogen.targets import naming
from protogen.targets.c.comments import comment
from protogen.targets.c.lines import Lines, function
from protogen.targets.c.payload.accessors import claim_accessor, is_readable, reader
from protogen.targets.c.payload.helpers import Helpers, cut, parted
from protogen.targets.c.payload.records import Records
from protogen.targets.c.payload.storing import Store
from protogen.targets.c.payload.validating import Validate
from protogen.targets.c.payload.walk import amount
from protogen.targets.c.spelling import Names
from protogen.targets.naming import inside

_LARGE = 32
"""Bytes of a payload from which on they are there; a struct of fewer takes little."""
_CALL = re.compile(r"\w\(")


def is_written_in_place(item: Message) -> bool:
    """True if there are such functions."""
    plan, size = item.plan, item.plan.sizes.fixed
    if size is None or size < _LARGE or item.sizes.fixed != size:
        return False
    if item.held or plan.packing is not None:
        return False
    has_array = any(isinstance(step, RepeatStep) and is_readable(step) for step in plan.steps)
    return has_array and all(map(_is_settable, plan.steps))


def _is_settable(step: AnyStep) -> bool:
    """True if a step lies at one place, and a value of it can be stored there."""
    if initial_bytes(step) is None:
        return False
    match step:
        case IntegerStep() | FloatStep():
            return not isinstance(step, PartStep)
        case RepeatStep():
            return is_readable(step) and step.holds_values
        case RecordStep():
            return step.holds_values and not step.type.needs
    return isinstance(step, ConstantStep | BytesStep)


class InPlace(msgspec.Struct, frozen=True):
    """What is printed for a message that can be written in its place."""

    getters: tuple[str, ...]
    """Inline functions that read what is no array."""
    setters: tuple[str, ...]
    """Inline functions that write a field, or an element of one."""
    begins: tuple[str, ...]
    """Statements that store the defaults at `at`, where all is 0."""
    unset: str
    """The name of the function that says whether a field still has to be set; empty: none has."""
    unset_function: str


def in_place(item: Message, names: Names, helpers: Helpers, records: Records) -> InPlace | None:
    """The functions of a message; None where it has none."""
    return _Writing(item, names, helpers, records).view() if is_written_in_place(item) else None


def claim_in_place(names: Names, item: Message) -> None:
    """All names of these functions."""
    for step in item.plan.steps:
        if step.holds_values:
            _claim(names, item.name, step)
    _claim_unset(names, item)


def _claim(names: Names, record: str, step: AnyStep) -> tuple[str, str]:
    """The names of the functions that read and write a field."""
    thing = inside(record, "field", step.name)
    if isinstance(step, RepeatStep):
        reader = claim_accessor(names, record, step.name)
        return reader, names.claim(thing, record, step.name, "set_at")
    reader = names.claim(thing, record, step.name, "get")
    return reader, names.claim(thing, record, step.name, "set")


def _claim_unset(names: Names, item: Message) -> str:
    return names.claim(naming.message(item.name), item.name, "unset")


class _Put(Store):
    """Stores a value at `at`, numbers without a function that the header would need."""

    def value(self, step: AnyStep, name: str) -> None:
        """Store a variable; a record is what it points to."""
        self.settled()
        if isinstance(step, RecordStep):
            self.record(plan_of_struct(step.type).steps, f"{name}->")
        else:
            self.step(step, name)

    def _number(self, type_: NumberType, value: str) -> None:
        if _CALL.search(value):
            super()._number(type_, value)
            return
        for place, byte in enumerate(parted(cut(type_), value)):
            self.lines.add(f"{self.byte(place)} = {byte};")
        self.skip(type_.size)


class _Accepts(Validate):
    """Refuses the values of a variable that an encoder refuses."""

    def value(self, step: AnyStep, name: str) -> None:
        """Check a variable; of a record, its name leads to the members."""
        if not isinstance(step, RecordStep):
            self.step(step, name)
        elif step.is_refusable:
            self.record(plan_of_struct(step.type).steps, name)


class _Writing:
    """Prints the functions of one message."""

    def __init__(self, item: Message, names: Names, helpers: Helpers, records: Records) -> None:
        self._item = item
        self._names = names
        self._helpers = helpers
        self._records = records

    def view(self) -> InPlace:
        """All of them."""
        ends = accumulate(step.sizes.greatest for step in self._item.plan.steps)
        placed = [
            (s, end - s.sizes.greatest) for s, end in zip(self._item.plan.steps, ends, strict=True)
        ]
        held = [(step, at) for step, at in placed if step.holds_values]
        unset = [step for step, _ in held if begins_refused(step)]
        return InPlace(
            getters=tuple(text for step, at in held if (text := self._getter(step, at))),
            setters=tuple(self._setter(step, at) for step, at in held),
            begins=tuple(line for step, at in placed for line in _begins(step, at)),
            unset=_claim_unset(self._names, self._item) if unset else "",
            unset_function=self._unset(unset) if unset else "",
        )

    def _names_of(self, step: AnyStep) -> tuple[str, str]:
        return _claim(self._names, self._item.name, step)

    # --- reading ----------------------------------------------------------------------------------

    def _getter(self, step: AnyStep, at: int) -> str | None:
        """The function that reads a field; arrays have one for their elements."""
        if not isinstance(step, IntegerStep | FloatStep | RecordStep):
            return None
        name, place = self._names_of(step)[0], _sum("payload", at)
        doc = f"Reads {step.name} from a payload that was received, unchecked."
        return reader(name, (), place, doc, step, self._helpers, self._records)

    def _unset(self, steps: list[AnyStep]) -> str:
        """The function that looks at fields whose default an encoder refuses."""
        lines = Lines()
        for number, step in enumerate(steps):
            name = f"value_{number}"
            if isinstance(step, RepeatStep):
                with lines.block(f"for (size_t i = 0; i < {amount(step.count.greatest)}; i++)"):
                    self._look(lines, step, step.element, name)
            else:
                self._look(lines, step, step, name)
        lines.add("return false;")
        head = f"static bool {_claim_unset(self._names, self._item)}"
        return function(head, ("const uint8_t *payload",), lines)

    def _look(self, lines: Lines, step: AnyStep, element: AnyStep, name: str) -> None:
        """Return true where a value that is read is refused."""
        read, index = self._names_of(step)[0], ", i" if isinstance(step, RepeatStep) else ""
        accepts = _Accepts(self._helpers, lines, lambda _: "true")
        if isinstance(element, RecordStep):
            lines.add(f"{self._records.spelled(element.type)} {name};")
            lines.add(f"{read}(payload{index}, &{name});")
            accepts.value(element, f"{name}.")
        else:
            lines.add(f"const {self._type(element)} {name} = {read}(payload{index});")
            accepts.value(element, name)

    # --- writing ----------------------------------------------------------------------------------

    def _setter(self, step: AnyStep, at: int) -> str:
        """The function that writes a field, or an element of one."""
        element, name, size = step, step.name, step.sizes.greatest
        arguments = ["uint8_t *payload"]
        body, place, refused = Lines(), _sum("payload", at), "the value is"
        if isinstance(step, RepeatStep):
            element, name, size = step.element, f"{name}[index]", step.element.sizes.greatest
            arguments.append("size_t index")
            place += f" + {unsigned(size)} * index" if size > 1 else " + index"
            refused = "the value or the index is"
            with body.block(f"if (index >= {amount(step.count.greatest)})"):
                body.add("return false;")
        is_record = isinstance(element, RecordStep)
        with self._helpers.public():
            accepts = _Accepts(self._helpers, body, lambda _: "false")
            accepts.value(element, "value->" if is_record else "value")
            body.add(f"uint8_t *at = {place};")
            _Put(self._helpers, body).value(element, "value")
        body.drop_unused_places()
        body.add("return true;")
        doc = (
            f"Writes {name} into a frame that was begun; false, and nothing, if {refused} refused."
        )
        head = f"static inline bool {self._names_of(step)[1]}"
        kind = self._type(element)
        given = f"{kind}{'' if kind.endswith('*') else ' '}value"
        return "\n".join([*comment([doc]), function(head, (*arguments, given), body)])

    def _type(self, step: AnyStep) -> str:
        """The type of a value, or of a pointer to it."""
        match step:
            case IntegerStep():
                return integer_type(step.type)
            case FloatStep():
                return self._helpers.float_type(step.type)
            case RecordStep():
                return f"const {self._records.spelled(step.type)} *"
            case BytesStep():
                return "const char *" if isinstance(step.type, Text) else "const uint8_t *"
        raise AssertionError(step)


def _sum(start: str, offset: int) -> str:
    return f"{start} + {unsigned(offset)}" if offset else start


def _begins(step: AnyStep, at: int) -> Iterator[str]:
    """Statements that store what is not 0 of a default."""
    if isinstance(step, RepeatStep) and step.field.default is None:
        element = initial_bytes(step.element)
        assert element is not None
        places = [(place, byte) for place, byte in enumerate(element) if byte]
        if places:
            yield f"for (size_t i = 0; i < {amount(step.count.greatest)}; i++) {{"
            for place, byte in places:
                index = f"{len(element)}U * i" if len(element) > 1 else "i"
                yield f"    at[{_sum(index, at + place)}] = {hexadecimal(byte)};"
            yield "}"
        return
    for place, byte in enumerate(initial_bytes(step) or b""):
        if byte:
            yield f"at[{at + place}] = {hexadecimal(byte)};"
