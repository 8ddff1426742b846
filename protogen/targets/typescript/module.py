"""The module of a protocol: what it declares, in order."""

from __future__ import annotations

from collections.abc import Iterator

from protogen.model.messages import Message
from protogen.model.parts import NumberPart
from protogen.model.protocol import Protocol, Sender
from protogen.model.types import Struct
from protogen.targets import descriptions
from protogen.targets.typescript.declarations import (
    Declaration,
    alias,
    comment,
    constant,
    function,
    interface,
    union,
)
from protogen.targets.typescript.frames import FramePrinter, runs_of
from protogen.targets.typescript.literals import Code, call, given, is_big, key, literal
from protogen.targets.typescript.names import Names, names_of
from protogen.targets.typescript.payloads import PayloadFunction
from protogen.targets.typescript.scope import Constants, Scope
from protogen.targets.typescript.types import (
    constants_of,
    input_name,
    message_of,
    struct_of,
    views_of,
)


class Module:
    """Declarations of a module, but for the calls that every one has alike."""

    def __init__(self, protocol: Protocol) -> None:
        self._protocol = protocol
        self._names: Names = names_of(protocol)
        self._constants = Constants(self._names)

    def declarations(self) -> list[Declaration]:
        """All, with the constants that functions share in front of these."""
        types, functions = list(self._types()), list(self._functions())
        shared = [constant(*item) for item in self._constants]
        return [*types, *shared, *functions, *self._senders()]

    def doc(self) -> str:
        """The comment in front of it."""
        line = descriptions.of_link(self._protocol.link)
        lines = [f"{line}."] if line else []
        lines += [
            f"Frames of {sender.name} end after {sender.frame.silence.text} of silence: call "
            f"`Decoder.idle` then."
            for sender in self._protocol.senders
            if sender.frame.silence is not None
        ]
        return comment([*descriptions.of_protocol(self._protocol), *lines])

    # --- types ------------------------------------------------------------------------------------

    def _types(self) -> Iterator[Declaration]:
        protocol, names = self._protocol, self._names
        doc = comment(["Hash of the layout, framing and meaning; both ends can compare it."])
        yield constant("SPEC_HASH", "string", literal(protocol.spec_hash), doc, exported=True)
        for enum in protocol.enums:
            yield from constants_of(enum, names)
        for flags in protocol.flags:
            yield from constants_of(flags, names)
        for struct in protocol.structs:
            yield from struct_of(struct, names)
        for message in protocol.messages:
            yield from message_of(message, names)
        for sender in protocol.senders:
            yield self._parts(sender)
        yield from self._unions()

    def _parts(self, sender: Sender) -> Declaration:
        names = self._names
        members = [
            f"  readonly {key(names.shown(sender.name, item.name))}: {_part_type(item)};"
            for item in sender.frame.shown_parts
        ]
        doc = comment([f"Identity, counters and values of the frames of {sender.name}."])
        return interface(names.parts[sender.name], members, doc)

    def _unions(self) -> Iterator[Declaration]:
        protocol, names = self._protocol, self._names
        members = []
        for endpoint in protocol.sending:
            forms = protocol.forms(endpoint)
            sent = union([names.types[item.name] for form in forms for item in form.messages])
            yield alias(names.unions[endpoint], sent, comment([f"A message of {endpoint}."]))
            parts = " | ".join(names.parts[form.name] for form in forms)
            inside = f"readonly message: {names.unions[endpoint]}; readonly parts: {parts}"
            members.append(f"  readonly {key(endpoint)}: {{ {inside} }};")
        yield interface("Senders", members, comment(["What each endpoint sends."]))
        taken = union([input_name(item, names) for item in protocol.messages])
        yield alias("MessageInput", taken, comment(["What an encoder takes for a message."]))
        yield self._given_parts()

    def _given_parts(self) -> Declaration:
        found: dict[str, list[str]] = {}
        for sender in self._protocol.senders:
            for part in sender.given_parts:
                found.setdefault(part.name, []).append(_part_type(part))
        members = [
            f"  readonly {key(name)}?: {union(types)} | undefined;" for name, types in found.items()
        ]
        doc = comment(["Parts of frames whose values callers give."])
        return interface("GivenParts", members, doc)

    # --- functions --------------------------------------------------------------------------------

    def _functions(self) -> Iterator[Declaration]:
        protocol, names = self._protocol, self._names
        for message in protocol.messages:
            yield from self._codec(message)
        records: tuple[Struct | Message, ...] = (*protocol.structs, *protocol.messages)
        for record in records:
            yield from views_of(record, names)

    def _codec(self, message: Message) -> Iterator[Declaration]:
        names, type_ = self._names, self._names.types[message.name]
        read, write, plan = names.functions[message.name]
        yield function(read, {"r": "rt.Reader"}, type_, self._body(message, reads=True))
        taken = {"w": "rt.Writer", "m": input_name(message, names)}
        yield function(write, taken, "void", self._body(message, reads=False))
        doc = comment([f"Plan of {type_}, for `readPayload` and `writePayload` of the runtime."])
        value = f"/* @__PURE__ */ {self._plan(message, Code(read), Code(write))}"
        yield constant(plan, f"rt.MessagePlan<{type_}>", value, doc, exported=True)

    def _plan(self, message: Message, read: Code, write: Code) -> Code:
        forms, sizes = self._protocol.senders_of(message), message.sizes
        is_cut = any(form.plan.is_cut for form in forms)
        identities = runs_of(forms[0].frame.identity, message.told_by)
        is_fixed = sizes.fixed is not None
        size = [sizes.least] if is_fixed else [sizes.least, sizes.greatest, sizes.step]
        more = given(
            known=literal(message.cut_size) if message.cut_size != sizes.fixed else None,
            tellsItsEnd=(is_cut and message.tells_its_end) or None,
            held=[field.part for field in message.held] or None,
        )
        return call("rt.plan", message.name, identities, size, read, write, more or None)

    def _body(self, message: Message, *, reads: bool) -> tuple[str, ...]:
        return PayloadFunction(Scope(self._names, self._constants), reads=reads).body(message)

    def _senders(self) -> Iterator[Declaration]:
        protocol, frames = self._protocol, self._names.frames
        for sender in protocol.senders:
            text = FramePrinter(sender, self._names).text()
            yield function(frames[sender.name], {}, "rt.Frame", f"return {text};".split("\n"))
        made = call("new rt.Protocol", map(Code, frames.values()), protocol.alike)
        yield constant("protocol", "rt.Protocol", f"/* @__PURE__ */ {made}")


def _part_type(part: NumberPart) -> str:
    if part.type.is_text:
        return "string"
    return "bigint" if is_big(part.type.bits) else "number"
