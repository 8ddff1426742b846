"""A message as the templates print it: its struct, its macros and the functions of its payload.

What the rest of the generated file uses of them is static: `validate`, `measure`, `store`, `put`,
`check` and `load`. A function that could only ever say yes is left out; see `validates` and
`checks`.
"""

from __future__ import annotations

import re
from collections.abc import Sequence

import msgspec

from protogen.model.frame import IdentityPart
from protogen.model.messages import Message
from protogen.model.protocol import Protocol, Sender
from protogen.passes.framing.capacity import is_delimited
from protogen.targets import descriptions
from protogen.targets.c.lines import Lines, function, prototype
from protogen.targets.c.named import BitsView, Macro, bits_views, meaning
from protogen.targets.c.payload.accessors import Accessors
from protogen.targets.c.payload.checking import Checker
from protogen.targets.c.payload.helpers import Helpers
from protogen.targets.c.payload.loading import Load
from protogen.targets.c.payload.measuring import Measure
from protogen.targets.c.payload.records import Records
from protogen.targets.c.payload.storing import Put, Store
from protogen.targets.c.payload.validating import Validate, can_be_refused
from protogen.targets.c.payload.walk import out_of_bounds
from protogen.targets.c.spelling import Names, hexadecimal

_PARAMETERS = ("message", "payload", "size", "need", "writer", "put", "user")
_FUNCTIONS = ("check", "load", "validate", "measure", "store", "put", "encode", "decode")
_OTHERS = ("frame", "send")
"""Other functions that are called after a message."""


class MessageView(msgspec.Struct, frozen=True):
    """One message. The names of functions are set also where there is no such function."""

    name: str
    """The name in the schema."""
    struct: str
    """`struct rn1_gyro`."""
    prefix: str
    """Prefix of its functions: `rn1_gyro`."""
    upper: str
    """Prefix of its macros: `RN1_GYRO`."""
    constant: str
    """Its value of `enum rn1_message`."""
    fixed: int | None
    """Bytes of the payload, where they are the same for all values."""
    least: int
    greatest: int
    """`RN1_GYRO_PAYLOAD_MIN` and `..._MAX` name these bounds."""
    checks: bool
    """True if there is a function `check`; without it, only the fixed size matters."""
    checks_values: bool
    """True if anything but a byte of more than 7 bits can be wrong, beside the size."""
    needs: bool
    """True if `check` uses `need`, because the payload may tell its own size."""
    validates: bool
    """True if there is a function `validate`; without it, every struct can be sent."""
    check: str
    """(const uint8_t *payload, size_t size, size_t *need): enum rn1_result; `need` may be NULL."""
    load: str
    """(struct rn1_gyro *message, const uint8_t *payload[, size_t size]); `size` if not fixed."""
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
    heading: str
    definition: str
    """The struct."""
    constants: tuple[Macro, ...]
    """Identity, sizes and the meaning of raw values."""
    bits: tuple[BitsView, ...]
    prototypes: tuple[str, ...]
    accessors: tuple[str, ...]
    functions: tuple[str, ...]
    """All functions of the payload but `put`."""
    put_function: str


class MessagePrinter:
    """Makes the views of a protocol's messages."""

    def __init__(
        self, protocol: Protocol, names: Names, helpers: Helpers, sinks: Helpers, records: Records
    ) -> None:
        self._protocol = protocol
        self._names = names
        self._helpers = helpers
        self._sinks = sinks
        self._records = records
        self._accessors = Accessors(names, helpers, records)
        self._error = f"{names.prefix.upper()}_ERROR_"
        self._ok = f"{names.prefix.upper()}_OK"
        self._result = f"enum {names.prefix}_result"

    def view(self, item: Message) -> MessageView:
        """The view of one message."""
        names = self._names
        tag = names.claim(item.name)
        called = {word: names.claim(item.name, word) for word in _FUNCTIONS}
        for word in _OTHERS:
            names.claim(item.name, word)
        for word in ("frame_max", "frame_room"):
            names.claim_macro(item.name, word)
        codec = _Codec(self, item, f"struct {tag}", called)
        return MessageView(
            name=item.name,
            struct=f"struct {tag}",
            prefix=tag,
            upper=tag.upper(),
            constant=names.claim_macro("message", item.name),
            fixed=codec.fixed,
            least=item.sizes.least,
            greatest=item.sizes.greatest,
            checks=codec.checks,
            checks_values=item.plan.has_wrong_values,
            needs=codec.needs,
            validates=codec.validates,
            heading=item.name,
            definition=self._records.definition(
                tag, descriptions.of_message(item), item.plan.steps
            ),
            constants=(
                *self._identity(item),
                *_sizes(item, names),
                Macro(names.claim_macro(item.name, "spec_hash"), f'"{item.spec_hash}"'),
                *self._meaning(item),
            ),
            bits=tuple(b for f in item.fields for b in bits_views(item.name, f, names)),
            prototypes=codec.prototypes(),
            accessors=tuple(
                text for step in item.plan.steps for text in self._accessors.of(item.name, step)
            ),
            functions=codec.functions(),
            put_function=codec.put(),
            **called,
        )

    def _meaning(self, item: Message) -> tuple[Macro, ...]:
        return meaning(item.name, item.fields, self._names)

    def _identity(self, item: Message) -> tuple[Macro, ...]:
        parts = self._senders_of(item)[0].frame.identity
        macros = []
        for part, value in zip(parts, item.identity, strict=True):
            words = ("id",) if len(parts) == 1 else ("id", part.name)
            name = self._names.claim_macro(item.name, *words)
            macros.append(Macro(name, _identity_value(part, value)))
        return tuple(macros)

    # --- what a codec needs -----------------------------------------------------------------------

    @property
    def helpers(self) -> Helpers:
        """The helpers of codecs."""
        return self._helpers

    @property
    def writer(self) -> str:
        """The parameters of what writes into a writer."""
        return self._names.writer

    @property
    def writing(self) -> str:
        """The arguments with which it hands a writer on."""
        return self._names.writing

    @property
    def sinks(self) -> Helpers:
        """The helpers of what writes into a writer."""
        return self._sinks

    @property
    def prefix(self) -> str:
        """Prefix of all names."""
        return self._names.prefix

    def delimited(self, item: Message) -> bool:
        """True if every frame of the message says where the payload ends."""
        return all(is_delimited(sender.frame) for sender in self._senders_of(item))

    def _senders_of(self, item: Message) -> list[Sender]:
        """Those of the message's senders that are printed."""
        return [sender for sender in self._protocol.senders if sender.name in item.senders]


def _identity_value(part: IdentityPart, value: int) -> str:
    """The number, or the character that it is."""
    is_text = part.type.role == "char" and 0x20 < value < 0x7F and chr(value) not in "'\\?"
    return f"'{chr(value)}'" if is_text else hexadecimal(value)


def _sizes(item: Message, names: Names) -> tuple[Macro, ...]:
    sizes = item.sizes
    macros = [("payload_min", sizes.least), ("payload_max", sizes.greatest)]
    if sizes.fixed is not None:
        macros.insert(0, ("payload_size", sizes.fixed))
    return tuple(Macro(names.claim_macro(item.name, word), f"{size}U") for word, size in macros)


class _Codec:
    """The functions of one message."""

    def __init__(
        self, printer: MessagePrinter, item: Message, struct: str, names: dict[str, str]
    ) -> None:
        self._printer = printer
        self._item = item
        self._struct = struct
        self._names = names
        self._prefix = printer.prefix
        self._upper = printer.prefix.upper()
        self.fixed = self._fixed = item.plan.sizes.fixed
        """The payload's size, where every value has it. A frame may also allow just one size."""
        self.checks = self._fixed is None or bool(item.plan.checks)
        self.needs = self._fixed is None and not printer.delimited(item)
        self.validates = can_be_refused(item.plan, item.sizes)

    def functions(self) -> tuple[str, ...]:
        """All but `put`."""
        found = [self._measure()] if self._fixed is None else []
        if self.validates:
            found.append(self._validate())
        found += [self._store(), self._encode()]
        if self.checks:
            found.append(self._check())
        return (*found, self._load(), self._decode())

    # --- sending --------------------------------------------------------------------------------

    @property
    def _message(self) -> str:
        return f"const {self._struct} *message"

    def _static(self, word: str, result: str, arguments: Sequence[str], lines: Lines) -> str:
        lines.drop_unused_places()
        lines = _with_unused(lines, _PARAMETERS, arguments)
        return function(f"static {result} {self._names[word]}", tuple(arguments), lines)

    def _measure(self) -> str:
        lines = Lines()
        measure = Measure(self._printer.helpers, lines)
        measure.message(self._item.plan)
        known = measure.known
        body = Lines()
        body.add(f"size_t size = {known}U;", *(line[4:] for line in lines.lines), "return size;")
        return self._static("measure", "size_t", [self._message], body)

    def _validate(self) -> str:
        lines = Lines()
        Validate(self._printer.helpers, lines, self._prefix).message(self._item.plan)
        self._validate_size(lines)
        lines.add(f"return {self._upper}_OK;")
        return self._static("validate", f"enum {self._prefix}_result", [self._message], lines)

    def _validate_size(self, lines: Lines) -> None:
        unfit = _unfit(self._item)
        if unfit:
            lines.add(f"const size_t size = {self._names['measure']}(message);")
            with lines.block(f"if ({unfit})"):
                lines.add(f"return {self._upper}_ERROR_RANGE;")

    def _store(self) -> str:
        lines = Lines()
        Store(self._printer.helpers, lines).message(self._item.plan)
        return self._static("store", "void", [self._message, "uint8_t *payload"], lines)

    def put(self) -> str:
        """The function that hands the payload to a writer."""
        lines = Lines()
        writer, writing = self._printer.writer, self._printer.writing
        Put(self._printer.sinks, lines, self._prefix, writing).message(self._item.plan)
        return self._static("put", "void", [self._message, writer], lines)

    def _encode(self) -> str:
        lines = Lines()
        if self.validates:
            result = f"const enum {self._prefix}_result result"
            lines.add(f"{result} = {self._names['validate']}(message);")
            with lines.block(f"if (result != {self._upper}_OK)"):
                lines.add("return result;")
        size = f"{self._fixed}U"
        if self._fixed is None:
            size = "needed"
            lines.add(f"const size_t needed = {self._names['measure']}(message);")
        if self._fixed == 0:
            lines.add("(void)capacity;")
        else:
            with lines.block(f"if (capacity < {size})"):
                lines.add(f"return {self._upper}_ERROR_SPACE;")
        lines.add(f"{self._names['store']}(message, payload);", f"*size = {size};")
        lines.add(f"return {self._upper}_OK;")
        return function(*self._encode_head, lines)

    @property
    def _encode_head(self) -> tuple[str, tuple[str, ...]]:
        arguments = (self._message, "uint8_t *payload", "size_t capacity", "size_t *size")
        return f"enum {self._prefix}_result {self._names['encode']}", arguments

    # --- receiving ------------------------------------------------------------------------------

    def _check(self) -> str:
        lines = Lines()
        if self.needs:
            with lines.block("if (need != NULL)"):
                lines.add("*need = 0U;")
        if self._item.sizes.fixed is not None:
            with lines.block(f"if (size != {self._item.sizes.fixed}U)"):
                lines.add(f"return {self._upper}_ERROR_SIZE;")
        check = Checker(
            self._printer.helpers,
            lines,
            self._prefix,
            fixed=self._fixed is not None,
            needs=self.needs,
        )
        check.message(self._item.plan)
        check.finish(_unfit(self._item))
        lines.add(f"return {self._upper}_OK;")
        arguments = ["const uint8_t *payload", "size_t size", "size_t *need"]
        return self._static("check", f"enum {self._prefix}_result", arguments, lines)

    def _load(self) -> str:
        lines = Lines()
        Load(self._printer.helpers, lines).message(self._item.plan)
        if not self._item.plan.holds_values:
            lines.add("message->unused = 0U;")
        head, arguments = self._load_head
        lines.drop_unused_places()
        return function(head, arguments, _with_unused(lines, _PARAMETERS, arguments))

    @property
    def _load_head(self) -> tuple[str, tuple[str, ...]]:
        arguments = [f"{self._struct} *message", "const uint8_t *payload"]
        arguments += ["size_t size"] if self._fixed is None else []
        return f"void {self._names['load']}", tuple(arguments)

    def _decode(self) -> str:
        lines = Lines()
        if self.checks:
            self._checked(lines)
        else:
            with lines.block(f"if (size != {self._fixed}U)"):
                lines.add(f"return {self._upper}_ERROR_SIZE;")
        size = ", size" if self._fixed is None else ""
        lines.add(f"{self._names['load']}(message, payload{size});", f"return {self._upper}_OK;")
        return function(*self._decode_head, lines)

    def _checked(self, lines: Lines) -> None:
        call = f"{self._names['check']}(payload, size, NULL)"
        lines.add(f"const enum {self._prefix}_result result = {call};")
        with lines.block(f"if (result != {self._upper}_OK)"):
            lines.add("return result;")

    @property
    def _decode_head(self) -> tuple[str, tuple[str, ...]]:
        arguments = (f"{self._struct} *message", "const uint8_t *payload", "size_t size")
        return f"enum {self._prefix}_result {self._names['decode']}", arguments

    def prototypes(self) -> tuple[str, ...]:
        """Declarations for the header."""
        heads = (self._encode_head, self._decode_head, self._load_head)
        return tuple(prototype(*head) for head in heads)


def _unfit(item: Message) -> str:
    """The condition that a payload's `size`, which its fields allow, is unfit for a frame."""
    sizes, fields = item.sizes, item.plan.sizes
    least = sizes.least if fields.least < sizes.least else 0
    return out_of_bounds("size", least, sizes.greatest, fields.greatest)


def _with_unused(lines: Lines, names: Sequence[str], arguments: Sequence[str]) -> Lines:
    """Say of parameters that are not used that they need not be."""
    text = "\n".join(lines.lines)
    each = ", ".join(arguments).split(", ")
    parameters = {argument.replace("*", " ").split()[-1] for argument in each}
    found = Lines()
    for name in names:
        if name in parameters and not _is_used(name, text):
            found.add(f"(void){name};")
    found.add(*(line[4:] for line in lines.lines))
    return found


def _is_used(name: str, text: str) -> bool:
    return re.search(rf"(?<![\w.>]){name}\b", text) is not None
