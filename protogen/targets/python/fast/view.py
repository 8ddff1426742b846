"""The fast engine of a module as the template prints it."""

from __future__ import annotations

from dataclasses import dataclass

from protogen.model.protocol import Protocol
from protogen.targets.python.fast import cutting, framing
from protogen.targets.python.fast.frames import FastFrame, Kin
from protogen.targets.python.fast.layout import fixed_size, outer_names
from protogen.targets.python.fast.lines import Constants
from protogen.targets.python.fast.reading import message_reader, struct_reader
from protogen.targets.python.fast.writing import message_writer, struct_writer
from protogen.targets.python.formats import classes_of
from protogen.targets.python.spelling import class_name
from protogen.targets.python.wrapping import method


@dataclass(frozen=True, slots=True)
class Function:
    """A function: its head without the colon, and the lines of its body."""

    head: str
    body: tuple[str, ...]


def _function(name: str, parameters: str, gives: str, body: tuple[str, ...]) -> Function:
    return Function(method(f"def {name}(", parameters, f") -> {gives}", 0, after=1), body)


@dataclass(frozen=True, slots=True)
class FastSender:
    """What the fast engine has for one sender."""

    name: str
    upper: str
    cut: Function | None
    kinds: str
    frame: Function | None
    encoders: tuple[str, ...]


@dataclass(frozen=True, slots=True)
class Fast:
    """Everything that the template prints."""

    constants: tuple[str, ...]
    records: tuple[Function, ...]
    senders: tuple[FastSender, ...]
    modules: tuple[str, ...]
    """Modules of the standard library that the text names."""


def fast_view(protocol: Protocol, of_caller: tuple[str, ...]) -> Fast:
    """The fast engine of a protocol; `of_caller` are the parts that callers of `encode` give."""
    constants = Constants()
    frames = [FastFrame(sender) for sender in protocol.senders]
    records = _records(protocol, constants)
    overloads = [function for frame in frames for function in _overloads(frame)]
    senders = tuple(_sender(frame, of_caller, constants) for frame in frames)
    lines = [*constants.text, *(line for function in records for line in function.body)]
    for sender in senders:
        lines += [line for item in (sender.cut, sender.frame) if item for line in item.body]
    joined = "\n".join(lines)
    return Fast(
        constants=constants.text,
        records=(*records, *overloads),
        senders=senders,
        modules=tuple(name for name in ("re", "struct", "zlib") if _USES[name] in joined),
    )


_USES = {"re": "_re.", "struct": "_struct.", "zlib": "_adler32("}


def _records(protocol: Protocol, constants: Constants) -> tuple[Function, ...]:
    functions: list[Function] = []
    for struct in classes_of(protocol):
        name = class_name(struct.name)
        outer = "".join(f", {name}_: int" for name in outer_names(struct))
        given = name if fixed_size(struct) is not None else f"tuple[{name}, int]"
        body = struct_reader(struct, constants)
        functions.append(
            _function(f"_read_{struct.name}", f"data: bytes, at: int{outer}", given, body)
        )
        body = struct_writer(struct, constants)
        functions.append(_function(f"_write_{struct.name}", f"item: {name}{outer}", "bytes", body))
    for message in protocol.messages:
        name = class_name(message.name)
        body = message_reader(message, constants)
        functions.append(_function(f"_read_{message.name}", "data: bytes", name, body))
        body = message_writer(message, constants)
        functions.append(_function(f"_write_{message.name}", f"item: {name}", "bytes", body))
    return tuple(functions)


def _overloads(frame: FastFrame) -> list[Function]:
    """Readers of identities that several messages share."""
    if not frame.can_cut:
        return []
    return [_overload(frame, kin) for kin in frame.kins if len(kin.messages) > 1]


def _overload(frame: FastFrame, kin: Kin) -> Function:
    identity = "_".join(map(str, kin.identity))
    given = " | ".join(class_name(message.name) for message in kin.messages)
    body: list[str] = []
    for message in kin.messages:
        body.append(f"if len(data) in {class_name(message.name)}.SIZES:")
        body.append(f"    return _read_{message.name}(data)")
    body.append("raise _fast.Unclear")
    return _function(f"_read_{frame.sender.name}_{identity}", "data: bytes", given, tuple(body))


def _sender(frame: FastFrame, of_caller: tuple[str, ...], constants: Constants) -> FastSender:
    name = frame.sender.name
    cut = made = None
    if frame.can_cut:
        skipping = FastFrame(frame.sender, skips_start=True)
        body = cutting.cutter(skipping, constants)
        parameters = "data: bytes, at: int, base: int, events: list[_typing.Any]"
        cut = _function(f"_cut_{name}", parameters, "int", body)
    if frame.can_frame:
        given = framing.arguments(frame, of_caller)
        parameters = ", ".join(["payload: bytes", *(f"{name}: int | None" for name in given)])
        body = framing.framer(frame, of_caller, constants)
        made = _function(f"_frame_{name}", parameters, "bytes", body)
    return FastSender(
        name, name.upper(), cut, cutting.kinds(frame) if cut else "", made, _encoders(frame)
    )


def _encoders(frame: FastFrame) -> tuple[str, ...]:
    """The writers of a sender's messages by their classes."""
    if not frame.can_frame:
        return ()
    return tuple(
        f"{class_name(message.name)}: _write_{message.name}," for message in frame.sender.messages
    )
