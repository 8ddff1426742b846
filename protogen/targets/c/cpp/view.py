"""A protocol as the header for C++ prints it: names for what C has, and nothing worked out anew."""

from __future__ import annotations

from collections.abc import Iterator
from functools import reduce

import msgspec

from protogen.model.protocol import Protocol
from protogen.targets import naming
from protogen.targets.c.cpp.calls import call_of
from protogen.targets.c.cpp.enums import CppEnum, cpp_enums
from protogen.targets.c.cpp.names import CppNames, cpp_names
from protogen.targets.c.cpp.physical import CppPhysical, cpp_physical
from protogen.targets.c.cpp.writers import CppWriter, cpp_writers
from protogen.targets.c.decoders.decoder import DecoderView
from protogen.targets.c.decoders.forms import FormsDecoder
from protogen.targets.c.frame.framing import FramingView
from protogen.targets.c.frame.handlers import Dispatch
from protogen.targets.c.frame.message_frames import MessageFrame
from protogen.targets.c.frame.numbers import ToldView
from protogen.targets.c.module import Module
from protogen.targets.c.payload.messages import MessageView
from protogen.targets.c.spelling import Names
from protogen.targets.naming import endpoint, named_type


class CppStruct(msgspec.Struct, frozen=True):
    """Another name for a struct of C."""

    name: str
    struct: str


class CppMessage(msgspec.Struct, frozen=True):
    """A message: its struct, and its value of the enum of all messages."""

    name: str
    value: str
    view: MessageView
    rooms: tuple[str, ...]
    """Macros for the bytes that suffice for its frames, of each kind of frame that it has."""

    @property
    def struct(self) -> str:
        """Its struct in C, which is outside of all namespaces."""
        return f"struct ::{self.view.struct.removeprefix('struct ')}"

    @property
    def room(self) -> str:
        """The greatest of them, worked out by the compiler."""
        return reduce(lambda one, other: f"detail::greater({one}, {other})", self.rooms)


class CppFrame(msgspec.Struct, frozen=True):
    """Functions that make a message's frames."""

    frame: str
    send: str
    """Empty where frames can't be sent byte by byte."""
    message: CppMessage
    item: MessageFrame

    @property
    def parts(self) -> str:
        """The parts that the caller gives, as parameters behind the message."""
        return "".join(f", {item.type} {item.name}" for item in self.item.arguments)

    @property
    def frame_call(self) -> str:
        """The call of C's function for a buffer."""
        known = {"message": "&message", "frame": "frame.data()", "capacity": "frame.size()"}
        return call_of(self.item.called.function, self.item.frame_arguments, known)

    @property
    def send_call(self) -> str:
        """The call of C's function that sends."""
        known = {
            "message": "&message",
            "put": "&detail::put_byte<decltype(give_)>",
            "user": "&give_",
        }
        return call_of(self.item.called.send, self.item.send_arguments("put_type"), known)


class CppReceived(msgspec.Struct, frozen=True):
    """A message that a decoder finds, and how it comes out of an event."""

    message: CppMessage
    load: str
    """The call of C's function."""


class CppDecoder(msgspec.Struct, frozen=True):
    """The decoder of what an endpoint sends, in one form of frame."""

    name: str
    event: str
    parts: str
    view: DecoderView
    received: tuple[CppReceived, ...]

    @property
    def received_list(self) -> str:
        """The name for the list of these messages."""
        return f"messages_of_{self.name}"

    @property
    def polls(self) -> bool:
        """True if C's functions return which message is complete, instead of calling a handler."""
        return self.view.is_polled


class CppForm(msgspec.Struct, frozen=True):
    """One of several forms that a decoder finds."""

    name: str
    """Its value of the enum of these forms."""
    constant: str
    member: str
    decoder: CppDecoder


class CppForms(msgspec.Struct, frozen=True):
    """The decoder for all forms of an endpoint's frames."""

    name: str
    event: str
    form: str
    view: FormsDecoder
    forms: tuple[CppForm, ...]
    """In the order of the enum, whose last value says that there is none."""

    @property
    def polls(self) -> bool:
        """True if C's functions return which message is complete, instead of calling a handler."""
        return self.view.is_polled

    @property
    def received_list(self) -> str:
        """The name for the list of all their messages."""
        return f"messages_of_{self.name}"

    @property
    def told_parts(self) -> tuple[ToldView, ...]:
        """The parts that the decoder is told."""
        return tuple(item.part for item in self.view.told)


class CppModule(msgspec.Struct, frozen=True):
    """Everything that the header for C++ prints."""

    space: str
    enums: tuple[CppEnum, ...]
    structs: tuple[CppStruct, ...]
    messages: tuple[CppMessage, ...]
    frames: tuple[CppFrame, ...]
    writers: tuple[CppWriter, ...]
    decoders: tuple[CppDecoder, ...]
    together: tuple[CppForms, ...]
    physical: tuple[CppPhysical, ...]

    @property
    def tells_all(self) -> bool:
        """True if decoders yield all events, and not messages alone."""
        return any(decoder.view.all_events for decoder in self.decoders)

    @property
    def sends(self) -> bool:
        """True if some message can be sent byte by byte."""
        return any(frame.send for frame in self.frames)


def cpp_module(
    whole: Protocol, chosen: Protocol, names: Names, module: Module, framing: FramingView
) -> CppModule:
    """The view of the chosen part of a protocol."""
    cpp = cpp_names(whole)
    models = [chosen.message(view.name) for view in module.messages]
    messages = tuple(_messages(whole, module, framing, cpp))
    by_name = {item.view.name: item for item in messages}
    decoders = tuple(_decoder(item, whole, by_name, cpp) for item in framing.dispatches)
    by_sender = {item.view.name: item for item in decoders}
    printed = {view.heading for view in module.structs}
    structs = [item for item in chosen.structs if item.name in printed]
    records = [*((it.name, it.fields) for it in structs), *((it.name, it.fields) for it in models)]
    return CppModule(
        space=cpp.space,
        enums=cpp_enums((*chosen.enums, *chosen.flags), models, names, cpp),
        structs=tuple(
            CppStruct(
                cpp.of(named_type(item.name), item.name),
                f"struct ::{names.claim_tag(named_type(item.name), item.name)}",
            )
            for item in structs
        ),
        messages=messages,
        frames=tuple(_frame(item, by_name) for item in framing.messages),
        writers=tuple(
            cpp_writers(framing.messages, {it.view.name: it.name for it in messages}, cpp)
        ),
        decoders=decoders,
        together=tuple(_forms(item, by_sender, cpp) for item in framing.together),
        physical=tuple(
            view for name, fields in records for view in cpp_physical(name, fields, cpp)
        ),
    )


def _messages(
    whole: Protocol, module: Module, framing: FramingView, cpp: CppNames
) -> Iterator[CppMessage]:
    every = [message.name for message in whole.messages]
    values = dict(zip(every, cpp.messages(every), strict=True))
    rooms: dict[str, list[str]] = {}
    for frame in framing.messages:
        rooms.setdefault(frame.message.name, []).append(frame.called.room)
    for view in module.messages:
        name = cpp.of(naming.message(view.name), view.name)
        yield CppMessage(name, values[view.name], view, tuple(rooms.get(view.name, ())))


def _frame(item: MessageFrame, messages: dict[str, CppMessage]) -> CppFrame:
    return CppFrame(
        frame=f"frame{item.called.suffix}",
        send=f"send{item.called.suffix}" if item.sends else "",
        message=messages[item.view.name],
        item=item,
    )


def _decoder(
    item: Dispatch, protocol: Protocol, messages: dict[str, CppMessage], cpp: CppNames
) -> CppDecoder:
    view = item.decoder
    thing = endpoint(protocol.sender(view.name).endpoint)
    return CppDecoder(
        name=cpp.of(thing, view.name, "decoder"),
        event=cpp.of(thing, view.name, "event"),
        parts=cpp.of(thing, view.name, "parts"),
        view=view,
        received=tuple(
            CppReceived(messages[it.message.name], f"::{it.message.load_call('event.')}")
            for it in item.handlers
        ),
    )


def _forms(item: FormsDecoder, decoders: dict[str, CppDecoder], cpp: CppNames) -> CppForms:
    thing = endpoint(item.name)
    values = cpp.forms(item.name, [form.name for form in item.forms])
    return CppForms(
        name=cpp.of(thing, item.name, "decoder"),
        event=cpp.of(thing, item.name, "event"),
        form=cpp.of(thing, item.name, "form"),
        view=item,
        forms=tuple(
            CppForm(name, it.constant, it.member, decoders[it.sender])
            for name, it in zip(values, item.forms, strict=True)
        ),
    )
