"""Functions that write a message where it stands in its frame, field by field.

So a large array needs no struct beside the frame. `written_places` says which messages have them.
"""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence

import msgspec

from protogen.c_language.numbers import (
    constant,
    counting_type,
    hexadecimal,
    integer_type,
    unsigned,
)
from protogen.model.constants import raw_bytes
from protogen.model.initial_payload import begins_refused, initial_bytes
from protogen.model.messages import Message
from protogen.model.names import free_name
from protogen.model.payload_builder import plan_of_struct
from protogen.model.payload_plan import (
    AnyStep,
    BytesStep,
    FloatStep,
    IntegerStep,
    RecordStep,
    RepeatStep,
)
from protogen.model.types import NumberType, Text, counting_bits
from protogen.targets import naming
from protogen.targets.c.comments import comment
from protogen.targets.c.lines import Lines, function, mentions
from protogen.targets.c.payload.accessors import claim_accessor, reader
from protogen.targets.c.payload.helpers import Helpers
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


class GivenAmount(msgspec.Struct, frozen=True):
    """A number of elements or bytes, as a parameter."""

    name: str
    type: str
    number: str
    """The expression of a `size_t`."""
    refused: str
    """The condition that no frame has so many; empty if there is none."""


class Segment(msgspec.Struct, frozen=True):
    """Bytes of the payload that stand behind each other however many elements there are."""

    at: int
    """Where they stand while it is written."""
    size: str


class Setter(msgspec.Struct, frozen=True):
    """An inline function that writes a field, an element of one, or a piece of its bytes."""

    field: str
    name: str
    indexed: bool
    """True if it takes the index of an element, or of the first of several bytes."""
    value: AnyStep
    """What its value is."""
    type: str
    """The type of that, or of the pointer to it."""
    pieces: bool
    """True if it takes the number of bytes, too."""
    text: str


class InPlace(msgspec.Struct, frozen=True):
    """What is printed for a message that can be written in its place."""

    getters: tuple[str, ...]
    """Inline functions that read what is no array."""
    setters: tuple[Setter, ...]
    begins: tuple[str, ...]
    """Statements that store the defaults at `at`, where all is 0."""
    unset: str
    """The name of the function that says whether a field still has to be set; empty: none has."""
    unset_function: str
    written: tuple[str, ...]
    """Functions for it that read what stands elsewhere in a frame that was ended."""
    room: int
    """Bytes of the payload, with the most elements that it can have."""
    amounts: tuple[GivenAmount, ...]
    """The numbers that are given when the frame is ended."""
    size: str
    """The bytes of the payload, worked out of them."""
    stores: tuple[str, ...]
    """Statements that put them into the payload at `written`."""
    segments: tuple[Segment, ...]

    @property
    def given(self) -> str:
        """The numbers as arguments behind others."""
        return "".join(f", {item.name}" for item in self.amounts)

    def closes_up(self, *, is_moved: bool) -> bool:
        """True if bytes have to move when the frame is ended."""
        return bool(self.amounts) and (is_moved or len(self.segments) > 1)

    def closing(self, place: str, *, is_moved: bool) -> tuple[str, ...]:
        """Statements that move the bytes to where the frame has them.

        None of them moves towards the end. `place` is the payload's, where all of it moves.
        """
        if not self.closes_up(is_moved=is_moved):
            return ()
        lines, segments = Lines(), self.segments
        if is_moved:
            lines.add(f"to = {place};")
        else:
            lines.add(f"to = &written[{segments[0].size}];")
            segments = segments[1:]
        for segment in segments:
            with lines.block(f"for (size_t i = 0; i < {segment.size}; i++)"):
                lines.add(f"to[i] = written[{_index(segment.at, 'i')}];")
            if segment is not segments[-1]:
                lines.add(f"to += {segment.size};")
        return lines.lines


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
    word = "set_at" if isinstance(step, RepeatStep) or place.amount else "set"
    return reader, names.claim(thing, record, step.name, word)


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


class _StoreAt(Store):
    """Stores values at a place behind a variable."""

    def __init__(self, helpers: Helpers, lines: Lines, start: str, at: int) -> None:
        super().__init__(helpers, lines)
        self._name, self._offset = start, at


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
        self._amounts: dict[str, GivenAmount] = {}
        for it in places.amounts:
            member = names.member(it.name)
            name = free_name(f"{member}_field" if member in taken else member, taken)
            taken.add(name)
            self._amounts[it.name] = self._given(it, name)

    def view(self) -> InPlace:
        """All of them."""
        counting = {it.name for it in self._places.amounts}
        placed = self._places.places
        held = [it for it in placed if it.step.holds_values]
        settable = [it for it in held if it.step.name not in counting]
        unset = [it for it in settable if begins_refused(it.step)]
        segments = tuple(self._segments())
        return InPlace(
            getters=tuple(text for it in held if not it.moves and (text := self._getter(it))),
            setters=tuple(map(self._setter, settable)),
            begins=tuple(line for it in placed for line in _begins(it)),
            unset=_claim_unset(self._names, self._item) if unset else "",
            unset_function=self._unset(unset) if unset else "",
            written=tuple(self._written(it) for it in unset if it.moves),
            room=self._places.size,
            amounts=tuple(self._amounts.values()),
            size=" + ".join(it.size for it in segments),
            stores=tuple(line for it in self._places.amounts for line in self._stored(it)),
            segments=segments,
        )

    def _names_of(self, place: Place) -> tuple[str, str]:
        return _claim(self._names, self._item.name, place)

    # --- numbers of elements ----------------------------------------------------------------------

    def _given(self, item: Amount, name: str) -> GivenAmount:
        """The parameter for a number of elements or bytes."""
        if item.step is None:
            fills = next(it for it in self._places.places if it.amount == item.name)
            assert fills.step.count is not None
            bits = counting_bits(fills.step.count.greatest)
            kind, spelled = counting_type(fills.step.count.greatest), unsigned
            least, greatest = 0, (1 << bits) - 1
        else:
            type_ = item.step.type
            kind, spelled = integer_type(type_), lambda value: constant(value, type_)
            least, greatest = type_.machine_bounds
        below = f"{name} < {spelled(item.least)}" if item.least > least else ""
        above = f"{name} > {spelled(item.greatest)}" if item.greatest < greatest else ""
        number = name if kind in ("uint8_t", "uint16_t") else f"(size_t){name}"
        return GivenAmount(name, kind, number, " || ".join(filter(None, (below, above))))

    def _stored(self, item: Amount) -> Sequence[str]:
        """Statements that store a number in the field that says it."""
        if item.step is None:
            return ()
        lines = Lines()
        store = _StoreAt(self._helpers, lines, "written", item.at)
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

    def _getter(self, place: Place) -> str | None:
        """The function that reads a field; arrays have one for their elements."""
        step = place.step
        if not isinstance(step, IntegerStep | FloatStep | RecordStep):
            return None
        name, at = self._names_of(place)[0], _sum("payload", place.at)
        doc = f"Reads {step.name} from a payload that was received, unchecked."
        return reader(name, (), at, doc, step, self._helpers, self._records)

    def _written(self, place: Place) -> str:
        """The function that reads what was written, and will move when the frame is ended."""
        step, at = place.step, _sum("payload", place.at)
        element, doc = step, f"Reads {step.name} from a frame that was begun."
        arguments: tuple[str, ...] = ()
        if isinstance(step, RepeatStep):
            element, arguments = step.element, ("size_t index",)
            at, doc = _element(at, place), f"Reads {step.name}[index] from a frame that was begun."
        name = self._names_of(place)[0]
        return reader(name, arguments, at, doc, element, self._helpers, self._records) or ""

    def _unset(self, places: Sequence[Place]) -> str:
        """The function that looks at fields whose default an encoder refuses."""
        lines = Lines()
        for number, place in enumerate(places):
            step, name = place.step, f"value_{number}"
            if isinstance(step, RepeatStep):
                given = self._amounts.get(place.amount)
                count = amount(place.most) if given is None else given.number
                with lines.block(f"for (size_t i = 0; i < {count}; i++)"):
                    self._look(lines, place, step.element, name)
            else:
                self._look(lines, place, step, name)
        lines.add("return false;")
        head = f"static bool {_claim_unset(self._names, self._item)}"
        text, amounts = "\n".join(lines.lines), self._amounts.values()
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
        if isinstance(step, BytesStep) and place.amount:
            return self._piece_setter(step, place)
        element, name = step, step.name
        arguments = ["uint8_t *payload"]
        body, at, refused = Lines(), _sum("payload", place.at), "the value is"
        if isinstance(step, RepeatStep):
            element, name = step.element, f"{name}[index]"
            arguments.append("size_t index")
            at, refused = _element(at, place), "the value or the index is"
            with body.block(f"if (index >= {amount(place.most)})"):
                body.add("return false;")
        is_record = isinstance(element, RecordStep)
        with self._helpers.public():
            accepts = _Accepts(self._helpers, body, lambda _: "false")
            accepts.value(element, "value->" if is_record else "value")
            body.add(f"uint8_t *at = {at};")
            _Put(self._helpers, body).value(element, "value")
        body.drop_unused_places()
        body.add("return true;")
        doc = (
            f"Writes {name} into a frame that was begun; false, and nothing, if {refused} refused."
        )
        if isinstance(element, BytesStep):
            doc += _size_of(element)
        return self._inline(place, doc, element, arguments, body)

    def _piece_setter(self, step: BytesStep, place: Place) -> Setter:
        """The function that writes bytes, or characters, from one on."""
        body = Lines()
        most = unsigned(place.most)
        with body.block(f"if (index > {most} || size > {most} - index)"):
            body.add("return false;")
        with self._helpers.public():
            accepts = _Accepts(self._helpers, body, lambda _: "false")
            accepts.bytes(step, "value", "size")
            copy = self._helpers.copy()
        body.add(f"{copy}({_element(_sum('payload', place.at), place)}, value, size);")
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
        pieces = isinstance(value, BytesStep) and bool(place.amount)
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


def _sum(start: str, offset: int) -> str:
    return f"{start} + {unsigned(offset)}" if offset else start


def _index(offset: int, index: str) -> str:
    return f"{unsigned(offset)} + {index}" if offset else index


def _element(start: str, place: Place) -> str:
    """The address of an element."""
    is_wide = place.width > 1
    return f"{start} + {unsigned(place.width)} * index" if is_wide else f"{start} + index"


def _begins(place: Place) -> Iterator[str]:
    """Statements that store what is not 0 of a default."""
    step, at = place.step, place.at
    if isinstance(step, RepeatStep) and step.field.default is None:
        element = initial_bytes(step.element)
        assert element is not None
        places = [(index, byte) for index, byte in enumerate(element) if byte]
        if places:
            yield f"for (size_t i = 0; i < {amount(place.most)}; i++) {{"
            for index, byte in places:
                start = f"{len(element)}U * i" if len(element) > 1 else "i"
                yield f"    at[{_sum(start, at + index)}] = {hexadecimal(byte)};"
            yield "}"
        return
    for index, byte in enumerate(_default(place)):
        if byte:
            yield f"at[{at + index}] = {hexadecimal(byte)};"


def _default(place: Place) -> bytes:
    """The bytes that a field begins with."""
    step, given = place.step, place.step.field.default
    if place.amount and isinstance(given, str | bytes):
        return raw_bytes(step.type, given)
    return initial_bytes(step) or b""
