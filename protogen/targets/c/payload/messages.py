"""A message as the templates print it: its struct, its macros and the functions of its payload.

What the rest of the generated file uses of them is static: `validate`, `measure`, `store`, `put`,
`check` and `load`. A function that could only ever say yes is left out; see `validates` and
`checks`.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator

import msgspec

from protogen.model.messages import Message
from protogen.model.protocol import Protocol, Sender
from protogen.passes.framing.capacity import is_delimited
from protogen.targets import descriptions
from protogen.targets.c.lines import Lines, assertion, function, mentions, prototype
from protogen.targets.c.named import string
from protogen.targets.c.payload.accessors import accessor
from protogen.targets.c.payload.checking import Checker
from protogen.targets.c.payload.held import HeldNumber, from_parts, held_numbers
from protogen.targets.c.payload.helpers import Helpers
from protogen.targets.c.payload.images import copied, is_image, last_place
from protogen.targets.c.payload.in_place import in_place
from protogen.targets.c.payload.in_place_view import InPlace
from protogen.targets.c.payload.initial import initialiser
from protogen.targets.c.payload.loading import Load
from protogen.targets.c.payload.measuring import Measure
from protogen.targets.c.payload.message_names import claim_init, claim_message, constants_of
from protogen.targets.c.payload.one_byte import only_byte
from protogen.targets.c.payload.records import Records, StructView
from protogen.targets.c.payload.storing import Put, Store
from protogen.targets.c.payload.validating import Validate, can_be_refused, path_of
from protogen.targets.c.payload.walk import out_of_bounds
from protogen.targets.c.spelling import Names

_PARAMETERS = ("message", "payload", "size", "need", "writer", "put", "user")
"""Parameters that a function may have without using them."""


class MessageView(msgspec.Struct, frozen=True):
    """One message. The names of functions are set also where there is no such function."""

    name: str
    """The name in the schema."""
    struct: str
    """`struct rn1_gyro`; empty where no field has a value, and functions take no message."""
    constant: str
    """Its value of `enum rn1_message`."""
    fixed: int | None
    """Bytes of the payload, where they are the same for all values."""
    greatest: int
    """`RN1_GYRO_PAYLOAD_MAX`."""
    checks: bool
    """True if there is a function `check`; without it, only the fixed size matters."""
    checks_values: bool
    """True if anything but a byte of more than 7 bits can be wrong, beside the size."""
    needs: bool
    """True if `check` uses `need`, because the payload may tell its own size."""
    validates: bool
    """True if there is a function `validate`; without it, every struct can be sent."""
    held: tuple[HeldNumber, ...]
    """The numbers of the frame among its members, arguments of the functions that read it."""
    image: str
    """The assertion that its struct lies in memory as its payload does, where a little-endian
    machine can copy it as a whole; empty where none can."""
    check: str
    """(const uint8_t *payload, size_t size, size_t *need[, held]): enum rn1_result; `need` may be
    NULL."""
    load: str
    """(struct rn1_gyro *message, const uint8_t *payload[, size_t size][, held]); `size` if not
    fixed."""
    validate: str
    """(const struct rn1_gyro *message): RN1_OK or RN1_ERROR_RANGE."""
    measure: str
    """(const struct rn1_gyro *message): a size_t; only if not fixed."""
    store: str
    """(const struct rn1_gyro *message, uint8_t *payload)."""
    put: str
    """(const struct rn1_gyro *message, struct rn1_writer *writer)."""
    encode: str
    decode: str
    refused: str
    """(const struct rn1_gyro *message): name of the first member that `validate` refuses."""
    record: StructView
    """The struct; its macros are identity, sizes and the meaning of raw values."""
    initialiser: tuple[str, ...]
    """The lines of `RN1_GYRO_INIT`."""
    prototypes: tuple[str, ...]
    accessors: tuple[str, ...]
    in_place: InPlace | None
    """What writes it in its frame, field by field."""
    functions: tuple[str, ...]
    """All functions of the payload but `put`."""
    put_function: str
    refused_prototype: str
    """Empty, as the function is, if there is no function `validate`."""
    refused_function: str

    @property
    def parameter(self) -> tuple[str, ...]:
        """The parameter for a message that is sent or was received."""
        return (f"const {self.struct} *message",) if self.struct else ()

    def given(self, parts: str) -> str:
        """The numbers of the frame as arguments behind others; `parts` leads to an event's."""
        return from_parts(self.held, parts)

    def load_call(self, event: str) -> str:
        """The call that makes `message` of a payload; `event` leads to an event's members."""
        size = f", {event}payload_size" if self.fixed is None else ""
        return f"{self.load}(&message, {event}payload{size}{self.given(f'{event}parts.')})"


class MessagePrinter(msgspec.Struct, frozen=True):
    """Makes the views of a protocol's messages."""

    protocol: Protocol
    names: Names
    helpers: Helpers
    sinks: Helpers
    """The helpers of what writes into a writer."""
    records: Records

    def view(self, item: Message) -> MessageView:
        """The view of one message."""
        names = self.names
        called = claim_message(names, item)
        tag, constant = called.pop("tag"), called.pop("constant")
        macros = constants_of(item, self.senders_of(item)[0], names)
        doc = descriptions.of_message(item)
        record = self.records.view(item.name, tag, doc, item.fields, item.plan.steps, macros)
        read = (
            accessor(item.name, step, names, self.helpers, self.records) for step in item.plan.steps
        )
        parts = [part.name for it in self.senders_of(item) for part in it.frame.declared]
        place = in_place(item, names, self.helpers, self.records, list(map(names.member, parts)))
        accessors = tuple(text for text in read if text)
        if place is not None:
            accessors += (*place.reading, *(setter.text for setter in place.setters))
        zeros = f"{names.prefix.upper()}_ZEROS"
        struct = f"struct {tag}" if has_struct(item) else ""
        codec = _Codec(self, item, struct, called)
        return MessageView(
            name=item.name,
            struct=struct,
            constant=constant,
            fixed=codec.fixed,
            greatest=item.sizes.greatest,
            checks=codec.checks,
            checks_values=item.plan.has_wrong_values,
            needs=codec.needs,
            validates=codec.validates,
            held=codec.held,
            image=codec.image(),
            record=record,
            initialiser=initialiser(claim_init(names, item), zeros, item.plan.steps)
            if struct
            else (),
            prototypes=codec.prototypes(),
            accessors=accessors,
            in_place=place,
            functions=codec.functions(),
            put_function=codec.put(),
            refused_prototype=codec.prototype("refused") if codec.validates else "",
            refused_function=codec.refused() if codec.validates else "",
            **called,
        )

    def senders_of(self, item: Message) -> list[Sender]:
        """Those of the message's senders that are printed."""
        return list(self.protocol.senders_of(item))


class _Codec:
    """The functions of one message."""

    def __init__(
        self, printer: MessagePrinter, item: Message, struct: str, names: dict[str, str]
    ) -> None:
        self._printer = printer
        self._item = item
        self._names = names
        self._prefix = printer.names.prefix
        self._upper = self._prefix.upper()
        self.fixed = item.plan.sizes.fixed
        """The payload's size, where every value has it. A frame may also allow just one size."""
        delimited = all(is_delimited(sender.frame) for sender in printer.senders_of(item))
        self.checks = self.fixed is None or bool(item.plan.checks)
        self.needs = self.fixed is None and not delimited
        is_cut = any(sender.plan.is_cut for sender in printer.senders_of(item))
        self.leaves = is_cut and item.tells_its_end
        """True if a check may leave what is behind the fields, and tells where they end."""
        self.validates = can_be_refused(item.plan, item.sizes)
        self.is_image = is_image(item.plan)
        """True if a struct can be copied as a whole; see `NAME_AS_IN_MEMORY`."""
        self.loads_inline = bool(only_byte(item.plan))
        """True if the header has `load`: a call takes more than what it does."""
        self.held = held_numbers(item, printer.names)
        held = tuple(f"{number.type} {number.name}" for number in self.held)
        result = f"enum {self._prefix}_result"
        self._struct = struct
        message = (f"{struct} *message",) if struct else ()
        given = (f"const {struct} *message",) if struct else ()
        payload = "const uint8_t *payload"
        size = ("size_t size",) if self.fixed is None else ()
        inline = f"{self._upper}_INLINE"
        self._signatures: dict[str, tuple[str, tuple[str, ...]]] = {
            "measure": ("static size_t", given),
            "validate": (f"{inline} {result}", given),
            "refused": ("const char *", given),
            "store": (f"{inline} void", (*given, "uint8_t *payload")),
            "put": (f"{inline} void", (*given, printer.names.writer)),
            "encode": (result, (*given, "uint8_t *payload", "size_t capacity", "size_t *size")),
            "check": (f"static {result}", (payload, "size_t size", "size_t *need", *held)),
            "load": (
                "static inline void" if self.loads_inline else "void",
                (*message, payload, *size, *held),
            ),
            "decode": (result, (*message, payload, "size_t size", *held)),
        }
        """Result and arguments of each function."""

    def _head(self, word: str) -> tuple[str, tuple[str, ...]]:
        result, arguments = self._signatures[word]
        return f"{result}{'' if result.endswith('*') else ' '}{self._names[word]}", arguments

    def prototypes(self) -> tuple[str, ...]:
        """Declarations for the header, and what is defined there."""
        found = list(map(self.prototype, ("encode", "decode")))
        if self._struct:
            found.append(self._load() if self.loads_inline else self.prototype("load"))
        return tuple(found)

    def prototype(self, word: str) -> str:
        """The declaration of a function for the header."""
        head, arguments = self._head(word)
        return prototype(f"{self._upper}_API {head}", arguments)

    def functions(self) -> tuple[str, ...]:
        """All but `put`."""
        found = [self._measure()] if self.fixed is None else []
        if self.validates:
            found.append(self._validate())
        found += [self._store(), self._encode()]
        if self.checks:
            found.append(self._check())
        found += [self._load()] if self._struct and not self.loads_inline else []
        return (*found, self._decode())

    def _function(self, word: str, lines: Lines) -> str:
        head, arguments = self._head(word)
        lines.drop_unused_places()
        may_be_unused = (*_PARAMETERS, *(number.name for number in self.held))
        lines.put_first(*(f"(void){name};" for name in _unused(lines, arguments, may_be_unused)))
        return function(head, arguments, lines)

    def _refuse(self, lines: Lines, condition: str, error: str) -> None:
        if condition:
            with lines.block(f"if ({condition})"):
                lines.add(f"return {self._upper}_ERROR_{error};")

    def _ask(self, lines: Lines, call: str) -> None:
        """Return the result of a function unless it is good."""
        lines.add(f"const enum {self._prefix}_result result = {call};")
        with lines.block(f"if (result != {self._upper}_OK)"):
            lines.add("return result;")

    # --- sending --------------------------------------------------------------------------------

    def _measure(self) -> str:
        lines = Lines()
        measure = Measure(self._printer.helpers, lines)
        measure.message(self._item.plan)
        lines.put_first(f"size_t size = {measure.known}U;")
        lines.add("return size;")
        return self._function("measure", lines)

    def _validate(self) -> str:
        error = f"{self._upper}_ERROR_RANGE"
        return self._told("validate", lambda _: error, error, f"{self._upper}_OK")

    def refused(self) -> str:
        """The function that names the first member that `validate` refuses."""
        return self._told("refused", lambda place: string(path_of(place)), '"?"', "NULL")

    def _told(self, word: str, error: Callable[[str], str], size_error: str, good: str) -> str:
        """A function that looks at each member, and at the size of the payload."""
        lines, unfit, by_member = Lines(), _unfit(self._item), word == "refused"
        validate = Validate(self._printer.helpers, lines, error, by_member=by_member)
        validate.message(self._item.plan)
        if unfit:
            lines.add(f"const size_t size = {self._names['measure']}(message);")
            with lines.block(f"if ({unfit})"):
                lines.add(f"return {size_error};")
        lines.add(f"return {good};")
        return self._function(word, lines)

    def _store(self) -> str:
        lines, helpers = Lines(), self._printer.helpers
        with helpers.left_out(self.is_image):
            Store(helpers, lines).message(self._item.plan)
        self._or_copy(lines, "payload", "message")
        return self._function("store", lines)

    def image(self) -> str:
        """The assertion that the last member lies where it does in the payload."""
        if not self.is_image:
            return ""
        last, place = last_place(self._item.plan)
        names = self._printer.names
        name = names.claim_helper(self._item.name, "layout")
        return assertion(name, f"offsetof({self._struct}, {names.member(last)}) == {place}U")

    def _or_copy(self, lines: Lines, to: str, source: str) -> None:
        """Print in front of statements what does the same where a struct is as on the wire."""
        if self.is_image:
            assert self.fixed is not None
            lines.put_first(
                f"#if {self._upper}_AS_IN_MEMORY",
                *copied(self._prefix, to, source, self.fixed),
                "#else",
            )
            lines.add("#endif")

    def put(self) -> str:
        """The function that hands the payload to a writer."""
        lines, writing = Lines(), self._printer.names.writing
        Put(self._printer.sinks, lines, self._prefix, writing).message(self._item.plan)
        return self._function("put", lines)

    def _encode(self) -> str:
        lines = Lines()
        if self.validates:
            self._ask(lines, f"{self._names['validate']}(message)")
        size = f"{self.fixed}U"
        if self.fixed is None:
            size = "needed"
            lines.add(f"const size_t needed = {self._names['measure']}(message);")
        if self.fixed == 0:
            lines.add("(void)capacity;")
        else:
            self._refuse(lines, f"capacity < {size}", "SPACE")
        message = "message, " if self._struct else ""
        lines.add(f"{self._names['store']}({message}payload);", f"*size = {size};")
        lines.add(f"return {self._upper}_OK;")
        return self._function("encode", lines)

    # --- receiving ------------------------------------------------------------------------------

    def _check(self) -> str:
        lines, size, fixed = Lines(), self._item.sizes.fixed, self.fixed is not None
        if self.needs or self.leaves:
            with lines.block("if (need != NULL)"):
                lines.add("*need = 0U;")
        self._refuse(lines, "" if size is None else f"size != {size}U", "SIZE")
        helpers = self._printer.helpers
        check = Checker(helpers, lines, self._prefix, fixed=fixed, needs=self.needs)
        check.message(self._item.plan)
        check.finish(_unfit(self._item), leaves=self.leaves)
        lines.add(f"return {self._upper}_OK;")
        return self._function("check", lines)

    def _load(self) -> str:
        lines, helpers = Lines(), self._printer.helpers
        load = Load(helpers, lines)
        with helpers.left_out(self.is_image):
            load.message(self._item.plan)
        if self.fixed is not None and load.reads_size:
            kind = "size_t" if load.moves_size else "const size_t"
            lines.put_first(f"{kind} size = {self.fixed}U;")
        self._or_copy(lines, "message", "payload")
        return self._function("load", lines)

    def _decode(self) -> str:
        lines, held = Lines(), "".join(f", {number.name}" for number in self.held)
        if self.checks:
            self._ask(lines, f"{self._names['check']}(payload, size, NULL{held})")
        else:
            self._refuse(lines, f"size != {self.fixed}U", "SIZE")
        size = ", size" if self.fixed is None else ""
        if self._struct:
            lines.add(f"{self._names['load']}(message, payload{size}{held});")
        lines.add(f"return {self._upper}_OK;")
        return self._function("decode", lines)


def has_struct(item: Message) -> bool:
    """True if a message has a struct: some field has a value."""
    return item.plan.holds_values


def _unfit(item: Message) -> str:
    """The condition that a payload's `size`, which its fields allow, is unfit for a frame."""
    sizes, fields = item.sizes, item.plan.sizes
    least = sizes.least if fields.least < sizes.least else 0
    return out_of_bounds("size", least, sizes.greatest, fields.greatest)


def _unused(
    lines: Lines, arguments: tuple[str, ...], may_be_unused: Iterable[str]
) -> Iterator[str]:
    """The parameters that need not be used and are not."""
    text = "\n".join(lines.lines)
    each = ", ".join(arguments).split(", ")
    parameters = {argument.rpartition(" ")[2].lstrip("*") for argument in each}
    for name in may_be_unused:
        if name in parameters and not mentions(text, name):
            yield name
