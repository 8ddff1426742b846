"""The fast engine of a module as the template prints it."""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping

import msgspec

from protogen.model.frame_plan import EndRule
from protogen.model.messages import Message
from protogen.model.part_plans import IdentityGroup
from protogen.model.protocol import Protocol
from protogen.targets.python.engine import cutting, framing, identities
from protogen.targets.python.engine.frames import EngineFrame
from protogen.targets.python.engine.layout import outer_parameters
from protogen.targets.python.engine.lines import Constants
from protogen.targets.python.engine.reading import message_reader, struct_reader
from protogen.targets.python.engine.writing import struct_writer
from protogen.targets.python.formats import classes_of
from protogen.targets.python.literals import call, mapping, text, tuple_of
from protogen.targets.python.literals import octets_in_class as literal
from protogen.targets.python.names import names_of
from protogen.targets.python.wrapping import method, one_of, wrapped


class Function(msgspec.Struct, frozen=True):
    """A function: its head without the colon, and the lines of its body."""

    head: str
    body: tuple[str, ...]


def _function(name: str, parameters: str, gives: str, body: tuple[str, ...]) -> Function:
    return Function(method(f"def {name}(", parameters, f") -> {gives}", 0, after=1), body)


class EngineSender(msgspec.Struct, frozen=True):
    """Functions and tables of one sender."""

    name: str
    upper: str
    cut: Function | None
    head: Function | None
    kinds: str
    frame: Function | None
    decodes: str
    """Name of the endpoint whose frames are read one by one; empty where it has other forms."""
    shared: str
    """The delimiter that both ends and starts frames; empty where none does."""


class EngineModule(msgspec.Struct, frozen=True):
    """Everything that the template prints."""

    constants: tuple[str, ...]
    records: tuple[Function, ...]
    senders: tuple[EngineSender, ...]
    encoders: tuple[Function, ...]
    table: tuple[str, ...]
    """Entries of the table of encoders by the message's class."""
    readers: tuple[str, ...]
    """Arguments that say which function reads which message's payload."""
    writers: str
    """Arguments that say how payloads come out of frames."""
    modules: tuple[str, ...]
    """Modules that the text names: the standard library's, and the runtime's optional ones."""
    names: tuple[str, ...]
    """Names that the text takes from the other module: its classes, senders and tables."""
    tables: bool
    """True if readers look values up in tables that have to be filled first."""
    codes: bool
    """True if writers do."""


def engine_view(protocol: Protocol, of_caller: Mapping[str, str]) -> EngineModule:
    """The fast engine of a protocol.

    `of_caller` are the parts that callers of `encode` give, with their types.
    """
    constants = Constants(names_of(protocol))
    classes = constants.classes
    frames = [EngineFrame(sender) for sender in protocol.senders]
    around = _around(frames)
    for frame in frames:
        frame.gives_content = around is not None
    records = _records(protocol, around or (0, 0), constants)
    overloads = [function for frame in frames for function in _overloads(frame, constants)]
    senders = tuple(_sender(frame, of_caller, constants) for frame in frames)
    made = {m.name: _encoder(m, frames, of_caller, constants) for m in protocol.messages}
    encoders = {name: encoder for name, encoder in made.items() if encoder is not None}
    functions = [*records, *encoders.values()]
    lines = [*constants.text, *(line for function in functions for line in function.body)]
    for sender in senders:
        lines += [
            line for item in (sender.cut, sender.head, sender.frame) if item for line in item.body
        ]
    lines += [function.head for function in functions]
    joined = "\n".join(lines)
    tables, codes = constants.use("_TABLES."), constants.use("_CODES.")
    return EngineModule(
        constants=constants.text,
        records=(*records, *overloads),
        senders=senders,
        encoders=tuple(encoders.values()),
        table=tuple(f"{classes[name]}: _encode_{name}," for name in encoders),
        readers=_readers(protocol, around or (0, 0), constants),
        writers=_writers(protocol, of_caller, codes),
        modules=tuple(name for name, used in _USES.items() if used in joined),
        names=_names(protocol, joined, constants),
        tables=tables,
        codes=codes,
    )


_USES = {
    "re": "_re.",
    "struct": "_struct.",
    "zlib": "_adler32(",
    "checksum": "_checksum.",
    "transparency": "_transparency.",
}


def _names(protocol: Protocol, used: str, constants: Constants) -> tuple[str, ...]:
    """Names that the text uses of the other module, sorted as imports are."""
    kept = {"_DECODERS", "_ENCODERS"}
    kept |= {name for name in ("_TABLES", "_CODES") if constants.use(f"{name}.")}
    kept |= {f"{sender.name.upper()}_SENDER" for sender in protocol.senders}
    kept |= {constants.classes[message.name] for message in protocol.messages}
    kept |= set(_CLASS.findall(used)) & set(constants.classes.values())
    return tuple(sorted(kept))


_CLASS = re.compile(r"\b[A-Z]\w*")
"""Words that may be names of classes."""


def _around(frames: list[EngineFrame]) -> tuple[int, int] | None:
    """Sizes around payloads, where they are the same in all frames that are cut; else None."""
    found = {frame.around for frame in frames if frame.takes_whole}
    return found.pop() if len(found) == 1 else None


def _records(
    protocol: Protocol, around: tuple[int, int], constants: Constants
) -> tuple[Function, ...]:
    functions: list[Function] = []
    ascii_messages = _seen_to_be_ascii(protocol)
    for struct in classes_of(protocol):
        name = constants.classes[struct.name]
        outer = "".join(f", {name}: int" for name in outer_parameters(struct).values())
        given = name if struct.sizes.fixed is not None else f"tuple[{name}, int]"
        body = struct_reader(struct, constants)
        functions.append(
            _function(f"_read_{struct.name}", f"data: bytes, at: int{outer}", given, body)
        )
        body = struct_writer(struct, constants)
        functions.append(_function(f"_write_{struct.name}", f"item: {name}{outer}", "bytes", body))
    for message in protocol.messages:
        if message.held:
            continue
        name = constants.classes[message.name]
        is_ascii = message.name in ascii_messages
        body = message_reader(message, constants, around, is_ascii=is_ascii)
        functions.append(_function(f"_read_{message.name}", "data: bytes", name, body))
    return tuple(functions)


def _readers(protocol: Protocol, around: tuple[int, int], constants: Constants) -> tuple[str, ...]:
    """The arguments of each call of `add_readers`."""
    ascii_messages = _seen_to_be_ascii(protocol)
    alike: dict[bool, dict[str, str]] = {}
    for message in protocol.messages:
        if message.held:
            continue
        names = alike.setdefault(message.name in ascii_messages, {})
        names[constants.classes[message.name]] = f"_read_{message.name}"
    return tuple(
        _arguments(
            mapping(names),
            *(["_TABLES"] if constants.use("_TABLES.") else []),
            around=str(around) if any(around) else None,
            seven_bit="True" if is_ascii else None,
        )
        for is_ascii, names in alike.items()
    )


def _arguments(*given: str, **named: str | None) -> str:
    """The inside of a call's brackets, broken where the longer of the functions needs it."""
    return wrapped(call("", *given, **named), len("_fast.add_readers"), 0)[1:-1]


def _writers(protocol: Protocol, of_caller: Iterable[str], codes: bool) -> str:
    """The arguments of `add_writers`: of one form of frame it is known where the payload lies."""
    alone = [sender for sender in protocol.senders if sender.is_only_form]
    return _arguments(
        tuple_of(f"{sender.name.upper()}_SENDER" for sender in alone),
        "_ENCODERS",
        tuple_of(map(text, of_caller)),
        *(["_CODES"] if codes else []),
    )


def _seen_to_be_ascii(protocol: Protocol) -> set[str]:
    """The messages of whose payloads all cutters see that no byte has its top bit set."""
    seen = {m.name for s in protocol.senders if s.framing.seven_bit for m in s.messages}
    return seen - {m.name for s in protocol.senders if not s.framing.seven_bit for m in s.messages}


def _encoder(
    message: Message, frames: list[EngineFrame], of_caller: Mapping[str, str], constants: Constants
) -> Function | None:
    """The function that makes a message's frames; None where only the reference does."""
    own = [frame for frame in frames if frame.sender.sends(message)]
    if not all(frame.can_frame for frame in own):
        return None
    given = "".join(
        f", {name}: {kind} | None"
        for name, kind in zip(
            framing.encoder_arguments(tuple(of_caller)), of_caller.values(), strict=True
        )
    )
    parameters = (
        f"item: {constants.classes[message.name]}, module: object, sender: str | None{given}"
    )
    body = framing.encoder(message, own, tuple(of_caller), constants)
    return _function(f"_encode_{message.name}", parameters, "bytes", body)


def _overloads(frame: EngineFrame, constants: Constants) -> list[Function]:
    """Readers of identities that several messages share."""
    if not frame.takes_whole:
        return []
    return [
        _overload(frame, group, constants.classes)
        for group in frame.plan.groups
        if len(group.messages) > 1
    ]


def _overload(frame: EngineFrame, group: IdentityGroup, classes: Mapping[str, str]) -> Function:
    given = one_of(classes[message.name] for message in group.messages)
    body: list[str] = []
    around = sum(frame.around or ()) if frame.gives_content else 0
    size = f"len(data) - {around}" if around else "len(data)"
    for message in group.messages:
        body.append(f"if {size} in {classes[message.name]}.SIZES:")
        body.append(f"    return _read_{message.name}(data)")
    body.append("raise _fast.NeedsReference")
    return _function(identities.reader_of(frame, group), "data: bytes", given, tuple(body))


def _sender(frame: EngineFrame, of_caller: Mapping[str, str], constants: Constants) -> EngineSender:
    name = frame.sender.name
    cut = head = made = None
    if frame.takes_whole:
        body = cutting.cutter(frame, constants)
        parameters = "data: bytes, at: int, base: int, events: list[_typing.Any]"
        cut = _function(f"_cut_{name}", parameters, "int", body)
    if (
        frame.takes_whole
        and frame.plan.end_rule is not EndRule.IDENTITY
        and frame.remembered is not None
    ):
        body = identities.header(frame, constants)
        head = _function(f"_head_{name}", "head: bytes", "tuple[_typing.Any, ...]", body)
    if frame.can_frame:
        given = framing.arguments(frame, tuple(of_caller))
        kinds = (*("int" for _ in frame.plan.identity), *of_caller.values())
        typed = (f"{name}: {kind} | None" for name, kind in zip(given, kinds, strict=True))
        parameters = ", ".join(["payload: bytes", *typed])
        body = framing.framer(frame, tuple(of_caller), constants)
        made = _function(f"_frame_{name}", parameters, "bytes", body)
    table = identities.kinds(frame) if cut else ""
    return EngineSender(
        name,
        name.upper(),
        cut,
        head,
        table,
        made,
        frame.sender.endpoint if frame.sender.is_only_form else "",
        literal(frame.plan.end_bytes) if frame.plan.shares_delimiter else "",
    )
