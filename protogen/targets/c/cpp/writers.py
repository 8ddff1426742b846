"""Classes of the header for C++ that write messages where they stand in their frames."""

from __future__ import annotations

from collections.abc import Iterator

import msgspec

from protogen.c_language.numbers import integer_type
from protogen.model.names import free_name
from protogen.model.payload_plan import BytesStep, FloatStep, IntegerStep, RecordStep
from protogen.model.types import Text
from protogen.targets import naming
from protogen.targets.c.cpp.calls import call_of
from protogen.targets.c.cpp.names import CppNames
from protogen.targets.c.frame.message_frames import MessageFrame
from protogen.targets.c.payload.in_place_view import Getter, Setter


class CppSetter(msgspec.Struct, frozen=True):
    """A function that writes a field, an element of one, or a piece of its bytes."""

    name: str
    parameters: str
    call: str


class CppGetter(msgspec.Struct, frozen=True):
    """A function that reads a field, or an element of one."""

    name: str
    type: str
    parameters: str
    condition: str
    """The condition that there is something to read."""
    call: str
    is_struct: bool
    """True if the call takes the place for the value."""


class CppWriter(msgspec.Struct, frozen=True):
    """The class for the frames of a message from senders of one kind of frame."""

    name: str
    message: str
    item: MessageFrame
    setters: tuple[CppSetter, ...]
    getters: tuple[CppGetter, ...]

    @property
    def begin(self) -> str:
        """The call of C's function that begins a frame."""
        known = {"frame": "frame.data()", "capacity": "frame.size()"}
        return call_of(self.item.called.begin, self.item.begin_arguments, known)

    @property
    def first(self) -> str:
        """Parameters of the constructor, in front of the buffer: numbers that are given first."""
        return "".join(f"{item}, " for item in self.item.begin_given)

    @property
    def given(self) -> str:
        """Parameters of `end`: numbers of elements, and parts of the frame."""
        return ", ".join(self.item.end_given)

    @property
    def end(self) -> str:
        """The call of C's function that ends it."""
        return call_of(self.item.called.end, self.item.end_arguments, {"frame": "frame_"})

    @property
    def is_begun(self) -> str:
        """The variable of `end` for whether there is a frame to end; no parameter is called so."""
        return free_name("is_begun", {item.split()[-1] for item in self.item.end_given})


def cpp_writers(
    frames: tuple[MessageFrame, ...], messages: dict[str, str], cpp: CppNames
) -> Iterator[CppWriter]:
    """The classes; `messages` are the names that messages have."""
    for item in frames:
        if item.in_place is not None:
            yield CppWriter(
                name=cpp.writer(item.message.name, item.called.suffix),
                message=messages[item.message.name],
                item=item,
                setters=tuple(_setter(setter, cpp) for setter in item.in_place.setters),
                getters=tuple(_getter(getter, cpp) for getter in item.in_place.getters),
            )


def _getter(getter: Getter, cpp: CppNames) -> CppGetter:
    condition, index = "payload_ != nullptr", ""
    if getter.most:
        condition, index = f"{condition} && index < {getter.most}", ", index"
    is_struct = isinstance(getter.value, RecordStep)
    match getter.value:
        case RecordStep() as step:
            name = cpp.of(naming.named_type(step.type.name), step.type.name)
            kind = f"::{cpp.space}::{name}"
        case IntegerStep() as step:
            kind = integer_type(step.type)
        case FloatStep() as step:
            kind = "float" if step.type.bits == 32 else "double"
        case _:
            raise AssertionError(getter)
    return CppGetter(
        name=f"get_{getter.field}",
        type=kind,
        parameters="size_t index" if getter.most else "",
        condition=condition,
        call=f"::{getter.name}(payload_{index}{', &value' if is_struct else ''})",
        is_struct=is_struct,
    )


def _setter(setter: Setter, cpp: CppNames) -> CppSetter:
    space = f"::{cpp.space}"
    parameters, arguments = ["size_t index"] * setter.indexed, ["index"] * setter.indexed
    match setter.value:
        case RecordStep() as step:
            name = cpp.of(naming.named_type(step.type.name), step.type.name)
            parameters.append(f"const {space}::{name} &value")
            arguments.append("&value")
        case BytesStep() as step if setter.pieces and isinstance(step.type, Text):
            parameters += ["const char *value", "size_t size"]
            arguments += ["value", "size"]
        case BytesStep() if setter.pieces:
            parameters.append(f"{space}::bytes value")
            arguments += ["value.data()", "value.size()"]
        case BytesStep() as step:
            kind = "char" if isinstance(step.type, Text) else "uint8_t"
            parameters.append(f"const {kind} (&value)[{step.count.greatest}]")
            arguments.append("value")
        case _:
            parameters.append(f"{setter.type} value")
            arguments.append("value")
    call = f"::{setter.name}({', '.join(['payload_', *arguments])})"
    return CppSetter(f"set_{setter.field}", ", ".join(parameters), call)
