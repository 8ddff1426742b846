"""The module of a protocol: what it declares, in order."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from protogen.model.messages import Message
from protogen.model.parts import NumberPart
from protogen.model.protocol import Protocol, Sender
from protogen.model.types import Struct
from protogen.targets import descriptions
from protogen.targets.typescript.declarations import (
    Declaration,
    Parameter,
    alias,
    comment,
    constant,
    function,
    interface,
    subclass,
    union,
)
from protogen.targets.typescript.frames import FramePrinter, runs_of, sizes_of
from protogen.targets.typescript.literals import boolean, is_big, key, listed, mapping, text
from protogen.targets.typescript.names import Names, names_of
from protogen.targets.typescript.reading import ReadFunction
from protogen.targets.typescript.scope import Constants, Scope
from protogen.targets.typescript.types import (
    enum_of,
    flags_of,
    input_name,
    message_of,
    struct_of,
    views_of,
)
from protogen.targets.typescript.writing import WriteFunction

_NAME = "<S extends SenderName = SenderName>"
_OPTIONAL_SENDER = Parameter("sender", "S", is_optional=True)


class Module:
    """Declarations of a module."""

    def __init__(self, protocol: Protocol) -> None:
        self._protocol = protocol
        self._names: Names = names_of(protocol)
        self._constants = Constants(self._names)

    def declarations(self) -> list[Declaration]:
        """All, with the constants that functions share in front of these."""
        types, functions = list(self._types()), list(self._functions())
        shared = [constant(*item) for item in self._constants]
        return [*types, *shared, *functions, *self._senders(), *self._interface()]

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
        yield constant("SPEC_HASH", "string", text(protocol.spec_hash), doc, exported=True)
        for enum in protocol.enums:
            yield from enum_of(enum, names)
        for flags in protocol.flags:
            yield from flags_of(flags, names)
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
            doc = comment([f"A message of {endpoint}."])
            yield alias(names.unions[endpoint], sent, doc)
            parts = " | ".join(names.parts[form.name] for form in forms)
            inside = f"readonly message: {names.unions[endpoint]}; readonly parts: {parts}"
            members.append(f"  readonly {key(endpoint)}: {{ {inside} }};")
        yield interface("Senders", members, comment(["What each endpoint sends."]))
        yield alias("SenderName", "keyof Senders", comment(["Name of an endpoint that sends."]))
        yield alias("Message", 'Senders[SenderName]["message"]', comment(["Any message."]))
        given = union([input_name(item, names) for item in protocol.messages])
        yield alias("MessageInput", given, comment(["What an encoder takes for a message."]))
        found = 'rt.Event<Senders[S]["message"], Senders[S]["parts"]>'
        yield alias(f"Event{_NAME}", found, comment(["What a decoder yields."]))
        yield self._given_parts()
        doc = comment(["Choices of an encoder."])
        yield alias("EncodeOptions", "rt.EncodeOptions<GivenParts, SenderName>", doc)
        doc = comment(["Choices of `decode`."])
        yield alias(f"DecodeOptions{_NAME}", "rt.DecodeOptions<S>", doc)

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
        first = [("message", text(message.name))]
        body = ReadFunction(Scope(names, self._constants)).body(
            message.plan.steps, message.name, first
        )
        yield function(read, [Parameter("r", "rt.Reader")], type_, body)
        scope = Scope(names, self._constants)
        body = WriteFunction(scope).body(message.plan.steps, message.name, message.fields)
        parameters = [Parameter("w", "rt.Writer"), Parameter("m", input_name(message, names))]
        yield function(write, parameters, "void", body)
        value = mapping(self._plan(message, read, write))
        doc = comment([f"Plan of {type_}, for `readPayload` and `writePayload` of the runtime."])
        yield constant(plan, f"rt.MessagePlan<{type_}>", value, doc, exported=True)

    def _plan(self, message: Message, read: str, write: str) -> dict[str, str]:
        frame = self._protocol.senders_of(message)[0].frame
        forms = self._protocol.senders_of(message)
        tells = any(form.plan.is_cut for form in forms) and message.tells_its_end
        known = message.cut_size
        return {
            "name": text(message.name),
            "identities": runs_of(frame.identity, message.told_by),
            "sizes": sizes_of(message.sizes),
            "known": "null" if known is None else str(known),
            "tellsItsEnd": boolean(tells),
            "held": listed(text(field.part) for field in message.held),
            "read": read,
            "write": write,
        }

    def _senders(self) -> Iterator[Declaration]:
        protocol, names = self._protocol, self._names
        for sender in protocol.senders:
            lines = FramePrinter(sender, names).text().split("\n")
            body = [f"return {lines[0]}", *lines[1:-1], f"{lines[-1]};"]
            yield function(names.frames[sender.name], [], "rt.Frame", body)
        frames = listed(names.frames[sender.name] for sender in protocol.senders)
        alike = listed(listed(map(text, group)) for group in protocol.alike)
        made = f"/* @__PURE__ */ new rt.Protocol({frames}, {alike})"
        yield constant("protocol", "rt.Protocol", made)

    # --- what users call --------------------------------------------------------------------------

    def _interface(self) -> Iterator[Declaration]:
        yield subclass(
            "Decoder",
            _NAME,
            'rt.Decoder<Senders[S]["message"], Senders[S]["parts"]>',
            _OPTIONAL_SENDER,
            "protocol.senders(sender)",
            comment(
                ["Cuts what an endpoint sends into events. Without a name: what all of them send."]
            ),
        )
        yield subclass(
            "Encoder",
            "",
            "rt.Encoder<MessageInput, GivenParts>",
            Parameter("sender", "SenderName"),
            "protocol, sender",
            comment(["Makes the frames of an endpoint, and advances their counters."]),
        )
        yield from _calls()


def _calls() -> Sequence[Declaration]:
    chunks = Parameter("chunks", "AsyncIterable<Uint8Array> | Iterable<Uint8Array>")
    given = [
        Parameter("frame", "Uint8Array"),
        Parameter("options", "DecodeOptions<S>", "{}"),
    ]
    taken = [Parameter("message", "MessageInput"), Parameter("options", "EncodeOptions", "{}")]
    return (
        function(
            "decode",
            given,
            'Senders[S]["message"]',
            ["return protocol.decode(frame, options);"],
            comment(["The message of exactly one frame. Throws a DecodeError."]),
            exported=True,
            generic=_NAME,
        ),
        function(
            "encode",
            taken,
            "Uint8Array",
            ["return protocol.encode(message, options);"],
            comment(["The frame of a message. Throws an EncodeError."]),
            exported=True,
        ),
        function(
            "decoderStream",
            [_OPTIONAL_SENDER],
            "TransformStream<Uint8Array, Event<S>>",
            ["return rt.streamOf(new Decoder(sender));"],
            comment(["A stream of bytes into one of events."]),
            exported=True,
            generic=_NAME,
        ),
        function(
            "events",
            [chunks, _OPTIONAL_SENDER],
            "AsyncGenerator<Event<S>, void, undefined>",
            ["return rt.eventsOf(new Decoder(sender), chunks);"],
            comment(["The events of chunks, as they come in."]),
            exported=True,
            generic=_NAME,
        ),
    )


def _part_type(part: NumberPart) -> str:
    if part.type.is_text:
        return "string"
    return "bigint" if is_big(part.type.bits) else "number"
