"""Functions that write a message where it stands in its frame, field by field.

So a large array needs no struct beside the frame. `written_places` says which messages have them.
"""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence

from protogen.c_language.numbers import integer_type, unsigned
from protogen.model.initial_payload import begins_refused
from protogen.model.messages import Message
from protogen.model.names import free_name
from protogen.model.payload_builder import plan_of_struct
from protogen.model.payload_plan import (
    AnyStep,
    BytesStep,
    FloatStep,
    IntegerStep,
    NumberStep,
    RecordStep,
    RepeatStep,
)
from protogen.model.types import NumberType, Text
from protogen.targets import naming
from protogen.targets.c.comments import comment
from protogen.targets.c.lines import Lines, function, mentions
from protogen.targets.c.payload.accessors import claim_accessor, is_readable, pointing, reader
from protogen.targets.c.payload.first_amounts import FirstAmounts, StoreAt, offset_by
from protogen.targets.c.payload.given_amounts import GivenAmount, given_amount
from protogen.targets.c.payload.helpers import Helpers
from protogen.targets.c.payload.in_place_view import Getter, InPlace, Segment, Setter
from protogen.targets.c.payload.number_bytes import cut, parted
from protogen.targets.c.payload.records import Records
from protogen.targets.c.payload.storing import Store, raw_of
from protogen.targets.c.payload.validating import Validate
from protogen.targets.c.payload.walk import amount, times
from protogen.targets.c.payload.written_places import Amount, Place, Places, written_places
from protogen.targets.c.spelling import Names
from protogen.targets.naming import inside

_CALL = re.compile(r"\w\(")
_TAKEN = frozenset({"frame", "payload", "size", "to", "wire", "written", "i", "at", "NULL"})
"""Names that a parameter may not have."""
_TAKEN_FIRST = frozenset(
    {"index", "value", "out", "raw", "extended", "bits", "most", "needed", "ahead", "capacity"}
)
"""Names that a variable may not have either, for a number that is given first."""


def in_place(
    item: Message, names: Names, helpers: Helpers, records: Records, parts: Sequence[str]
) -> InPlace | None:
    """The functions of a message; None where it has none. `parts` are those of its frames."""
    places = written_places(item)
    return None if places is None else _Writing(item, places, names, helpers, records, parts).view()


def claim_in_place(names: Names, item: Message) -> None:
    """All names of these functions."""
    places = written_places(item)
    for place in () if places is None else places.places:
        if place.step.holds_values:
            _claim(names, item.name, place)
    for number in () if places is None else places.first:
        _claim_amount(names, item.name, number)
    _claim_unset(names, item)


def _claim(names: Names, record: str, place: Place) -> tuple[str, str]:
    """The names of the functions that read and write a field."""
    step = place.step
    thing = inside(record, "field", step.name)
    if place.moves:
        reader = names.claim(thing, record, step.name, "written")
    elif isinstance(step, RepeatStep):
        reader = claim_accessor(names, record, step.name)
    else:
        reader = names.claim(thing, record, step.name, "get")
    word = "set_at" if isinstance(step, RepeatStep) or place.varies else "set"
    return reader, names.claim(thing, record, step.name, word)


def _claim_amount(names: Names, record: str, amount: Amount) -> str:
    """The name of the function that reads a number that is given first."""
    words = amount.name.split(".")
    return names.claim(inside(record, "field", *words), record, *words, "get")


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

    def number(self, step: NumberStep, place: str) -> None:
        """A number; a bool that is no member is not cast, as MISRA wants it."""
        if step.type.role == "bool" and step.type.size == 1 and "->" not in place:
            self._byte(f"{place} ? 1U : 0U")
        else:
            super().number(step, place)

    def _number(self, type_: NumberType, value: str) -> None:
        if _CALL.search(value):
            super()._number(type_, value)
            return
        for place, byte in enumerate(parted(cut(type_), raw_of(type_, value))):
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

    def __init__(
        self,
        item: Message,
        places: Places,
        names: Names,
        helpers: Helpers,
        records: Records,
        parts: Sequence[str],
    ) -> None:
        self._item = item
        self._places = places
        self._names = names
        self._helpers = helpers
        self._records = records
        taken = {*_TAKEN, *parts, *(f"{part}_part" for part in parts)}
        taken |= _TAKEN_FIRST if places.first else set()
        self._amounts: dict[str, GivenAmount] = {}
        for it in places.amounts:
            member = "_".join(map(names.member, it.name.split(".")))
            name = free_name(f"{member}_field" if member in taken else member, taken)
            taken.add(name)
            fills = next((p.step.count for p in places.places if p.amount == it.name), None)
            read = _claim_amount(names, item.name, it) if it.place else ""
            self._amounts[it.name] = given_amount(it, name, fills, read)
        self._first = FirstAmounts(places, self._amounts, helpers)

    def view(self) -> InPlace:
        """All of them."""
        places = self._places
        counting = {it.name for it in places.amounts}
        placed = places.places
        held = [it for it in placed if it.step.holds_values]
        settable = [it for it in held if it.step.name not in counting]
        given = [it.step for it in places.first if it.step is not None]
        unset = [it for it in settable if begins_refused(it.step, given)]
        segments = () if places.first else tuple(self._segments())
        return InPlace(
            reading=tuple(text for it in held if not it.moves for text in self._reading(it)),
            getters=tuple(getter for it in held if (getter := self._getter(it))),
            setters=tuple(map(self._setter, settable)),
            begins=tuple(line for it in placed for line in self._first.begun(it)),
            unset=_claim_unset(self._names, self._item) if unset else "",
            unset_function=self._unset(unset) if unset else "",
            written=tuple(self._written(it) for it in unset if it.moves),
            room=places.size,
            amounts=self._last,
            size=" + ".join(it.size for it in segments),
            stores=tuple(line for it in places.last for line in self._stored(it)),
            segments=segments,
            first=tuple(self._amounts[it.name] for it in places.first),
            sizing=self._first.sizing,
            measuring=self._first.measuring(),
        )

    @property
    def _last(self) -> tuple[GivenAmount, ...]:
        """The numbers that are given at the end."""
        return tuple(self._amounts[it.name] for it in self._places.last)

    def _names_of(self, place: Place) -> tuple[str, str]:
        return _claim(self._names, self._item.name, place)

    # --- numbers of elements ----------------------------------------------------------------------

    def _stored(self, item: Amount) -> Sequence[str]:
        """Statements that store a number in the field that says it."""
        if item.step is None:
            return ()
        lines = Lines()
        store = StoreAt(self._helpers, lines, "written", item.at)
        store.step(item.step, self._amounts[item.name].name)
        return lines.lines

    def _segments(self) -> Iterator[Segment]:
        start, fixed = 0, 0
        for place in self._places.places:
            if not place.amount:
                fixed += place.size
                continue
            given = self._amounts[place.amount]
            one = f"(size_t){given.name}"
            size = one if place.width == 1 else str(times(given.number, place.width))
            yield Segment(start, f"{unsigned(fixed)} + {size}" if fixed else size)
            start, fixed = place.at + place.size, 0
        if fixed or not self._amounts:
            yield Segment(start, unsigned(fixed))

    # --- reading ----------------------------------------------------------------------------------

    def _getter(self, place: Place) -> Getter | None:
        """The function that reads a field, or an element in bounds that are always the same."""
        step, name = place.step, self._names_of(place)[0]
        if place.moves or isinstance(step, BytesStep):
            return None
        if not isinstance(step, RepeatStep):
            return Getter(step.name, name, step, "")
        if place.varies and self._places.first:
            return None
        return Getter(step.name, name, step.element, amount(place.most))

    def _reading(self, place: Place) -> Iterator[str]:
        """The functions that read a field, an element of it, or a number in it."""
        step, name = place.step, place.step.name
        if isinstance(step, IntegerStep | FloatStep | RecordStep):
            yield from self._reader(place, self._names_of(place)[0], name, step)
        elif isinstance(step, RepeatStep) and not is_readable(step):
            yield from self._reader(place, self._names_of(place)[0], f"{name}[index]", step.element)
        for it in self._first.members_of(place):
            assert it.step is not None
            read = _claim_amount(self._names, self._item.name, it)
            yield from self._reader(place, read, it.name, it.step, it.at)

    def _reader(
        self, place: Place, name: str, what: str, step: AnyStep, offset: int = 0
    ) -> Iterator[str]:
        body = Lines()
        with self._helpers.public():
            at = self._first.address(place, "payload", self._first.reading(body), offset)
        is_element = isinstance(place.step, RepeatStep)
        at = _element(at, place) if is_element else at
        doc = f"Reads {what} from a payload that was received, unchecked."
        arguments = ("size_t index",) * is_element
        at_place = pointing(at, body)
        text = reader(name, arguments, at_place, doc, step, self._helpers, self._records)
        if text:
            yield text

    def _written(self, place: Place) -> str:
        """The function that reads what was written, and will move when the frame is ended."""
        step, at = place.step, offset_by("payload", place.at)
        element, doc = step, f"Reads {step.name} from a frame that was begun."
        arguments: tuple[str, ...] = ()
        if isinstance(step, RepeatStep):
            element, arguments = step.element, ("size_t index",)
            at, doc = _element(at, place), f"Reads {step.name}[index] from a frame that was begun."
        name = self._names_of(place)[0]
        body = pointing(at)
        return reader(name, arguments, body, doc, element, self._helpers, self._records) or ""

    def _unset(self, places: Sequence[Place]) -> str:
        """The function that looks at fields whose default an encoder refuses."""
        lines = Lines()
        reading = self._first.reading(lines)
        names = {it.name for it in self._amounts.values()}
        for number, place in enumerate(places):
            step, name = place.step, free_name(f"value_{number}", names)
            if isinstance(step, RepeatStep):
                given = self._amounts.get(place.amount)
                [count] = (
                    self._first.most(place, lines, reading) if given is None else [given.number]
                )
                with lines.block(f"for (size_t i = 0; i < {count}; i++)"):
                    self._look(lines, place, step.element, name)
            else:
                self._look(lines, place, step, name)
        lines.add("return false;")
        head = f"static bool {_claim_unset(self._names, self._item)}"
        text, amounts = "\n".join(lines.lines), self._last
        lines.put_first(*(f"(void){it.name};" for it in amounts if not mentions(text, it.name)))
        arguments = ("const uint8_t *payload", *(f"{it.type} {it.name}" for it in amounts))
        return function(head, arguments, lines)

    def _look(self, lines: Lines, place: Place, element: AnyStep, name: str) -> None:
        """Return true where a value that is read is refused."""
        read, index = self._names_of(place)[0], ", i" if isinstance(place.step, RepeatStep) else ""
        accepts = _Accepts(self._helpers, lines, lambda _: "true")
        if isinstance(element, RecordStep):
            lines.add(f"{self._records.spelled(element.type)} {name};")
            lines.add(f"{read}(payload{index}, &{name});")
            accepts.value(element, f"{name}.")
        else:
            lines.add(f"const {self._type(element)} {name} = {read}(payload{index});")
            accepts.value(element, name)

    # --- writing ----------------------------------------------------------------------------------

    def _setter(self, place: Place) -> Setter:
        """The function that writes a field, or an element of one."""
        step = place.step
        if isinstance(step, BytesStep) and place.varies:
            return self._piece_setter(step, place)
        element, name = step, step.name
        arguments = ["uint8_t *payload"]
        body, refused = Lines(), "the value is"
        reading = self._first.reading(body)
        if isinstance(step, RepeatStep):
            element, name = step.element, f"{name}[index]"
            arguments.append("size_t index")
            refused = "the value or the index is"
            with self._helpers.public():
                most = self._first.most(place, body, reading)
            with body.block(f"if ({' || '.join(f'index >= {it}' for it in most)})"):
                body.add("return false;")
        is_record = isinstance(element, RecordStep)
        with self._helpers.public():
            accepts = _Accepts(self._helpers, body, lambda _: "false")
            accepts.value(element, "value->" if is_record else "value")
            for it in self._first.members_of(place):
                self._keep(it, body)
            at = self._first.address(place, "payload", reading)
            at = _element(at, place) if isinstance(step, RepeatStep) else at
            body.add(f"uint8_t *at = {at};")
            _Put(self._helpers, body).value(element, "value")
        body.drop_unused_places()
        body.add("return true;")
        doc = (
            f"Writes {name} into a frame that was begun; false, and nothing, if {refused} refused."
        )
        if isinstance(element, BytesStep):
            doc += _size_of(element)
        for it in self._first.members_of(place):
            doc += f" {it.name} has to be what the frame was begun with."
        return self._inline(place, doc, element, arguments, body)

    def _keep(self, item: Amount, body: Lines) -> None:
        """Refuse a struct that has another number than the payload."""
        members = map(self._names.member, item.name.split(".")[1:])
        read = self._amounts[item.name].read
        with body.block(f"if (value->{'.'.join(members)} != {read}(payload))"):
            body.add("return false;")

    def _piece_setter(self, step: BytesStep, place: Place) -> Setter:
        """The function that writes bytes, or characters, from one on."""
        body = Lines()
        with self._helpers.public():
            reading = self._first.reading(body)
            most = self._first.most(place, body, reading)
        unfit = (f"index > {it} || size > {it} - index" for it in most)
        with body.block(f"if ({' || '.join(unfit)})"):
            body.add("return false;")
        with self._helpers.public():
            accepts = _Accepts(self._helpers, body, lambda _: "false")
            accepts.bytes(step, "value", "size")
            copy = self._helpers.copy()
            at = self._first.address(place, "payload", reading)
        at = _element(at, place)
        if place.ahead:
            body.add(f"uint8_t *at = {at};")
            at = "at"
        body.add(f"{copy}({at}, value, size);")
        body.add("return true;")
        what = "characters" if isinstance(step.type, Text) else "bytes"
        doc = (
            f"Writes {what} from {step.name}[index] on into a frame that was begun; false, and "
            "nothing, if they or their places are refused."
        )
        return self._inline(place, doc, step, ["uint8_t *payload", "size_t index"], body)

    def _inline(
        self, place: Place, doc: str, value: AnyStep, arguments: list[str], body: Lines
    ) -> Setter:
        name, kind = self._names_of(place)[1], self._type(value)
        pieces = isinstance(value, BytesStep) and place.varies
        if isinstance(value, BytesStep) and not pieces:
            given = [f"{kind.removesuffix('*')}value[{value.count.greatest}]"]
        else:
            given = [f"{kind}{'' if kind.endswith('*') else ' '}value", *["size_t size"] * pieces]
        text = function(f"static inline bool {name}", (*arguments, *given), body)
        return Setter(
            field=place.step.name,
            name=name,
            indexed=len(arguments) > 1,
            value=value,
            type=kind,
            pieces=pieces,
            text="\n".join([*comment([doc]), text]),
        )

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


def _size_of(step: BytesStep) -> str:
    """What a caller has to know of the array that is given."""
    if isinstance(step.type, Text):
        return f" All {step.count.greatest} characters are read: NULs follow a shorter text."
    return f" All {step.count.greatest} bytes are read."


def _element(start: str, place: Place) -> str:
    """The address of an element."""
    is_wide = place.width > 1
    return f"{start} + {unsigned(place.width)} * index" if is_wide else f"{start} + index"
