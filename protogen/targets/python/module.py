"""A generated module as the template prints it."""

from __future__ import annotations

import msgspec

from protogen.model.messages import Message
from protogen.model.parts import ChoicePart, CounterPart, IdentityPart, ToldIdentity, ValuePart
from protogen.model.protocol import Protocol, Sender
from protogen.runtime.attributes import argument, attribute
from protogen.targets import descriptions
from protogen.targets.escape import paragraphs
from protogen.targets.python import classes, describing, frames, lines
from protogen.targets.python.classes import Attribute, Constructor, EnumClass, RecordClass, slots_of
from protogen.targets.python.formats import classes_of
from protogen.targets.python.literals import call, text, tuple_of
from protogen.targets.python.names import Names, frame_name, names_of
from protogen.targets.python.wrapping import docstring, method, one_of, remark, union, wrapped

_INDENT = 4
_ENGINE = 'engine: _rt.Engine = "fast"'
_ANY_SENDER = "Sender | None = None"
"""Type and default of an argument that may be left out: any endpoint may have sent it."""


class PartsClass(msgspec.Struct, frozen=True):
    """The class of the parts that events show."""

    name: str
    attributes: tuple[Attribute, ...]
    made: Constructor


class EndpointView(msgspec.Struct, frozen=True):
    """An endpoint that sends."""

    name: str
    union: str
    """Name of the type of its messages."""
    union_text: str
    parts: str
    """Type of the parts of its frames."""
    decode_head: str
    """Of the overload of `decode`."""


class SenderView(msgspec.Struct, frozen=True):
    """An endpoint as a sender, in one form of its frames."""

    name: str
    title: str
    upper: str
    parts: str
    frame: str
    """Name of the function that describes it."""
    frame_text: str
    """The declaration that it gives; empty where another sender has the same frame."""
    spec_text: str
    messages: tuple[RecordClass, ...]
    """Messages that no sender before it sends."""


class Module(msgspec.Struct, frozen=True):
    """Everything that the template prints."""

    name: str
    doc: str
    spec_hash: str
    version: str | None
    uses: frozenset[str]
    """Optional imports that are needed."""
    enums: tuple[EnumClass, ...]
    structs: tuple[RecordClass, ...]
    parts: tuple[PartsClass, ...]
    senders: tuple[SenderView, ...]
    endpoints: tuple[EndpointView, ...]
    has_forms: bool
    """True if an endpoint has several forms of frame, also where no message uses the others."""
    any_message: str
    any_parts: str
    literal: str
    protocol_text: str
    connect_heads: tuple[str, ...]
    """Of the overloads of `connect`."""
    connect_head: str
    arguments: dict[str, str]
    """Counters and values that `encode` takes: names of the parts, and of its arguments."""
    kinds: dict[str, str]
    """Types of these, by the names of the parts."""
    arguments_doc: str
    counts: bool
    formats: str
    """Expression for the frames as construct declarations."""
    registry: str
    decoder_heads: tuple[str, ...]
    decode_stub: str
    """Of the overload of `decode` for any sender."""
    decode_head: str
    is_told: bool
    """True if receivers are told identities that are not sent."""


def view(protocol: Protocol) -> Module:
    """The module of a protocol."""
    names = names_of(protocol)
    parts = _parts_classes(protocol, names)
    senders = _senders(protocol, parts, names)
    endpoints = _endpoints(protocol, parts, names)
    any_message = one_of(endpoint.union for endpoint in endpoints)
    any_parts = one_of(sender.parts for sender in senders)
    arguments = _arguments(protocol)
    structs = tuple(classes.struct_class(item, names) for item in classes_of(protocol))
    return Module(
        name=names.file,
        doc=docstring(describing.module(protocol), 0),
        spec_hash=protocol.spec_hash,
        version=None if protocol.version is None else text(protocol.version),
        uses=_uses(structs, senders),
        enums=(
            *(classes.enum_class(item, names) for item in protocol.enums),
            *(classes.flags_class(item, names) for item in protocol.flags),
        ),
        structs=structs,
        parts=tuple(dict.fromkeys(parts.values())),
        senders=senders,
        endpoints=endpoints,
        has_forms=any(not sender.is_only_form for sender in protocol.senders),
        any_message=any_message,
        any_parts=any_parts,
        literal=f"_typing.Literal[{', '.join(text(item.name) for item in endpoints)}]",
        protocol_text=_protocol_text(protocol, senders, names, any_message, any_parts),
        connect_heads=lines.connect_heads(protocol, names, any_message),
        connect_head=lines.connect_head(protocol),
        arguments=arguments,
        kinds={name: _kind(protocol, name) for name in arguments},
        arguments_doc=_arguments_doc(protocol),
        counts=any(_counters(sender) for sender in protocol.senders),
        formats=_formats(senders),
        registry=_registry(protocol, names),
        decoder_heads=_decoder_heads(endpoints, any_message, any_parts),
        decode_stub=_decode_head(protocol, _ANY_SENDER, any_message, after=5),
        decode_head=_decode_head(protocol, _ANY_SENDER, any_message, after=1),
        is_told=protocol.is_told,
    )


def _uses(structs: tuple[RecordClass, ...], senders: tuple[SenderView, ...]) -> frozenset[str]:
    """Optional imports that are needed, read off the printed text."""
    records = [*structs, *(record for sender in senders for record in sender.messages)]
    texts = [record.rules for record in records]
    texts += [item.text for record in records for item in record.attributes]
    texts += [sender.frame_text for sender in senders]
    joined = "\n".join(texts)
    names = ("_builtins.", "_checksum.", "_transparency.")
    return frozenset(name.strip("(.") for name in names if name in joined)


# --- parts ------------------------------------------------------------------------------------


def _parts_classes(protocol: Protocol, names: Names) -> dict[str, PartsClass]:
    """The class of each sender's parts; one for all where they are alike."""
    attributes = {sender.name: _part_attributes(sender) for sender in protocol.senders}
    alike = len(set(attributes.values())) == 1
    return {
        name: PartsClass("Parts" if alike else names.parts[name], items, _made(items))
        for name, items in attributes.items()
    }


def _made(parts: tuple[Attribute, ...]) -> Constructor:
    """The constructor of parts, all of which are integers."""
    names = [part.text.partition(":")[0] for part in parts]
    head = method("def __init__(", ", ".join(["self", *(p.text for p in parts)]), ") -> None:", 4)
    return Constructor(slots_of(names), head, (f"self._set({', '.join(names)})",))


def _part_attributes(sender: Sender) -> tuple[Attribute, ...]:
    attributes = []
    for part in sender.frame.shown_parts:
        first = next(iter(paragraphs(part.about.doc)), _role(part))
        texts = describing.escaped([descriptions.sentence(first)])
        kind = "str" if part.type.is_text else "int"
        attributes.append(Attribute(f"{attribute(part.name)}: {kind}", remark(texts, _INDENT)))
    return tuple(attributes)


def _role(part: IdentityPart | CounterPart | ValuePart) -> str:
    match part:
        case ToldIdentity():
            return "Tells which message this is, and is not sent: a decoder is told it"
        case IdentityPart():
            return "Tells which message this is"
        case CounterPart():
            return "Counts what the sender sends"
        case ChoicePart():
            return "Which of several literals it is"
        case ValuePart():
            return "A number that the sender chooses"


def _counters(sender: Sender) -> list[CounterPart]:
    return [part for part in sender.frame.caller_parts if isinstance(part, CounterPart)]


def _arguments(protocol: Protocol) -> dict[str, str]:
    parts = [part.name for sender in protocol.senders for part in sender.given_parts]
    return {name: argument(name) for name in parts}


def _kind(protocol: Protocol, name: str) -> str:
    """Type of a part that callers give: parts of several senders may be called alike."""
    own = [part for sender in protocol.senders for part in sender.given_parts if part.name == name]
    return " | ".join(sorted({"str" if part.type.is_text else "int" for part in own}))


def _arguments_doc(protocol: Protocol) -> str:
    sentences: dict[str, str] = {}
    for sender in protocol.senders:
        for part in sender.frame.caller_parts:
            bounds = f"`{argument(part.name)}` ({_allowed(part)})"
            default = f"is {_default(part)} if not given" if part.default is not None else None
            counted = isinstance(part, CounterPart)
            missing = "has to be given" + ("; an `Encoder` counts by itself" if counted else "")
            sentences.setdefault(part.name, f"{bounds} {default or missing}.")
        for item in sender.given_identity:
            words = f"`{item.name}` is the first of those that the message has if not given."
            sentences.setdefault(item.name, words)
    return " ".join(sentences.values())


def _default(part: CounterPart | ValuePart) -> str:
    if part.default is not None and part.type.is_text:
        return _readable(part.shown(part.default))
    return f"0x{part.default:02X}" if isinstance(part, ChoicePart) else str(part.default)


def _readable(value: int | str) -> str:
    """A value for readers: in hex, or a text of which each character can be seen."""
    if isinstance(value, int):
        return f"0x{value:02X}"
    return f"`{value.encode('unicode_escape').decode('ascii')}`"


def _allowed(part: CounterPart | ValuePart) -> str:
    if isinstance(part, ChoicePart):
        return ", ".join(_readable(part.shown(value)) for value in part.values)
    if part.between is not None:
        return part.allowed
    if part.type.is_text:
        return f"up to {part.type.size} characters"
    return f"{part.least}..{part.greatest}"


# --- senders ----------------------------------------------------------------------------------


def _senders(
    protocol: Protocol, parts: dict[str, PartsClass], names: Names
) -> tuple[SenderView, ...]:
    views: list[SenderView] = []
    frame_names: dict[str, str] = {}
    printed: set[str] = set()
    for sender in protocol.senders:
        frame_text = _frame(sender)
        known = frame_text in frame_names
        frame = frame_names.setdefault(frame_text, frame_name(sender.name))
        new = [message for message in sender.messages if message.name not in printed]
        printed.update(message.name for message in new)
        views.append(
            SenderView(
                name=sender.name,
                title=_title(sender),
                upper=sender.name.upper(),
                parts=parts[sender.name].name,
                frame=frame,
                frame_text="" if known else frame_text,
                spec_text=_sender_spec(sender, frame, parts[sender.name].name, names),
                messages=tuple(
                    classes.message_class(
                        message,
                        _identity_words(sender, message),
                        names,
                        is_cut=any(it.plan.is_cut for it in protocol.senders_of(message)),
                    )
                    for message in new
                ),
            )
        )
    return tuple(views)


def _title(sender: Sender) -> str:
    """Name of a sender in comments."""
    return sender.endpoint if sender.is_only_form else f"{sender.endpoint}, {sender.form}"


def _endpoints(
    protocol: Protocol, parts: dict[str, PartsClass], names: Names
) -> tuple[EndpointView, ...]:
    views: list[EndpointView] = []
    for name in protocol.sending:
        forms = protocol.forms(name)
        sent = {message.name: None for sender in forms for message in sender.messages}
        messages = names.unions[name]
        union_text = one_of(names.types[message] for message in sent)
        views.append(
            EndpointView(
                name=name,
                union=messages,
                union_text=union(f"{messages} = ", union_text, 0),
                parts=one_of(parts[sender.name].name for sender in forms),
                decode_head=_decode_head(
                    protocol, f"_typing.Literal[{text(name)}]", messages, after=5
                ),
            )
        )
    return tuple(views)


def _decoder_heads(
    endpoints: tuple[EndpointView, ...], message: str, parts: str
) -> tuple[str, ...]:
    """The heads of `Decoder.__init__`: overloads for each endpoint and for any, or the only one."""
    if len(endpoints) == 1:
        return (_decoder_head(message, parts, _ANY_SENDER, ") -> None:"),)
    heads = [(e.union, e.parts, f'_typing.Literal["{e.name}"]') for e in endpoints]
    return tuple(
        _decoder_head(*head, ") -> None: ...") for head in [*heads, (message, parts, _ANY_SENDER)]
    )


def _decode_head(protocol: Protocol, name: str, message: str, after: int) -> str:
    parameters = f"frame: _rt.BytesLike, sender: {name}, {_ENGINE}"
    if protocol.is_told:
        parameters = f"{parameters}, told: dict[str, int] | None = None"
    return method("def decode(", parameters, f") -> {message}", 0, after)


def _decoder_head(messages: str, parts: str, name: str, end: str) -> str:
    return method(
        "def __init__(",
        f"self: Decoder[{messages}, {parts}], sender: {name}, {_ENGINE}",
        end,
        _INDENT,
    )


def _identity_words(sender: Sender, message: Message) -> str:
    """The identity as characters, where it is made of such."""
    words = [
        f"{part.name} {text(shown)}"
        for part, value in zip(sender.frame.identity, message.identity, strict=True)
        if (shown := _characters(part, value)).isprintable() and shown
    ]
    return ", ".join(words)


def _characters(part: IdentityPart, value: int) -> str:
    """The characters of an identity; none where it is no text."""
    if part.type.role == "char":
        return chr(value)
    return str(part.shown(value)) if part.type.is_text else ""


def _frame(sender: Sender) -> str:
    framing = sender.framing
    expression = call(
        "_rt.FrameSpec",
        parts=tuple_of(frames.part(part) for part in sender.frame.parts),
        start=frames.start(framing.start),
        end=frames.end(framing.end),
        least=str(framing.least),
        greatest=str(framing.greatest),
        greatest_payload=str(framing.payload.greatest),
        transparency=_unless(frames.transparency(sender.frame.transparency), "None"),
        stuffed=_unless(frames.stuffed(sender), "()"),
        seven_bit="True" if framing.seven_bit else None,
        rescans="True" if sender.plan.rescans else None,
        ambiguous_cut="True" if framing.cut_ambiguous else None,
        is_bounded="True" if sender.frame.limit is not None else None,
        virtual=_unless(tuple_of(map(frames.virtual_part, sender.plan.virtual)), "()"),
        told=_unless(tuple_of(map(frames.told_part, sender.frame.told)), "()"),
        silence=frames.silence(sender.frame.silence),
    )
    return wrapped(expression, _INDENT + len("return "), _INDENT, after=0)


def _unless(expression: str, default: str) -> str | None:
    return None if expression == default else expression


def _sender_spec(sender: Sender, frame: str, parts: str, names: Names) -> str:
    messages = names.unions[sender.endpoint]
    name = f"{sender.name.upper()}_SENDER: _rt.SenderSpec[{messages}, {parts}] = "
    shown = {m.name: names.types[m.name] for m in sender.received}
    encode_only = [names.types[m.name] for m in sender.encode_only]
    expression = call(
        "_rt.SenderSpec",
        text(sender.endpoint),
        frame,
        parts,
        messages=tuple_of(shown.values()),
        encode_only=tuple_of(encode_only) if encode_only else None,
        form=None if sender.is_only_form else text(sender.form),
    )
    return name + wrapped(expression, len(name), 0, after=0)


def _protocol_text(
    protocol: Protocol,
    senders: tuple[SenderView, ...],
    names: Names,
    message: str,
    parts: str,
) -> str:
    name = f"PROTOCOL: _rt.Protocol[{message}, {parts}] = "
    specs = [f"{sender.upper}_SENDER" for sender in senders]
    asked = [lines.exchange(item, protocol, names) for item in lines.requests_of(protocol)]
    expression = call(
        "_rt.Protocol",
        text(protocol.name),
        *specs,
        spec_hash="SPEC_HASH",
        line=lines.line(protocol),
        exchanges=tuple_of(asked) if asked else None,
    )
    return name + wrapped(expression, len(name), 0, after=0)


def _formats(senders: tuple[SenderView, ...]) -> str:
    named = [f"{item.upper}_FORMAT={item.upper}_SENDER" for item in senders]
    expression = call("_fast.frame_formats", "globals()", *named)
    return wrapped(expression, _INDENT + len("__getattr__ = "), _INDENT, after=0)


def _registry(protocol: Protocol, names: Names) -> str:
    """Message classes by name."""
    lines = [f"    {text(m.name)}: {names.types[m.name]}," for m in protocol.messages]
    return "\n".join(["{", *lines, "}"])
