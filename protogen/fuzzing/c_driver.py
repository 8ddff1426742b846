"""A program in C that calls generated code: with values it is given, on whatever machine.

Requests and answers are bytes (see `c_calls`). How they come and go is up to the machine: a shared
library, the standard streams of a process, a register of a simulator.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache
from pathlib import Path

from jinja2 import Environment, PackageLoader, StrictUndefined, Template

from protogen.fuzzing.c_walk import walk_function
from protogen.model.messages import Message
from protogen.model.protocol import Protocol, Sender
from protogen.passes.selection import select
from protogen.targets.c.decoder import DecoderView
from protogen.targets.c.emit import emit
from protogen.targets.c.frames import MessageFrame
from protogen.targets.c.framing import FramingView, framing_view
from protogen.targets.c.handlers import Dispatch
from protogen.targets.c.module import Module, view
from protogen.targets.c.options import COptions

TEMPLATES = Path(__file__).with_name("templates")


@dataclass(frozen=True, slots=True)
class DrivenPart:
    """A part of a frame, as C has it."""

    name: str
    type: str

    @property
    def size(self) -> int:
        """Bytes of the type."""
        return int(self.type.removeprefix("uint").removesuffix("_t")) // 8


@dataclass(frozen=True, slots=True)
class DrivenMessage:
    """A message, and the functions of its payload."""

    model: Message
    struct: str
    walk: str
    encode: str
    decode: str


@dataclass(frozen=True, slots=True)
class DrivenFrame:
    """The functions that make the frame of a message."""

    index: int
    message: int
    function: str
    send: str
    """Empty where frames can't be sent byte by byte."""
    parts: tuple[DrivenPart, ...]
    room: int


@dataclass(frozen=True, slots=True)
class DrivenHandler:
    """The function that a decoder calls with a message."""

    function: str
    struct: str
    message: int


@dataclass(frozen=True, slots=True)
class DrivenDecoder:
    """The decoder of what one endpoint sends."""

    index: int
    name: str
    prefix: str
    all_events: bool
    polls: bool
    """Whether `push` returns which message is complete, instead of calling a handler."""
    parts: tuple[DrivenPart, ...]
    handlers: tuple[DrivenHandler, ...]


class Driver:
    """What a driver calls, and its sources."""

    def __init__(self, whole: Protocol, options: COptions = COptions()) -> None:  # noqa: B008
        self.protocol = select(whole, options.only, options.senders)
        self.options = options
        self._whole = whole
        module = view(self.protocol, options)
        framing = framing_view(self.protocol, module.messages, module.sinks, options)
        self.messages = tuple(self._messages(module))
        self.decoders = tuple(self._decoders(framing))
        self.frames = tuple(self._frames(framing))
        self._frame_of = self._frames_by_sender(framing)

    def message(self, name: str) -> int:
        """The index of a message."""
        return next(i for i, item in enumerate(self.messages) if item.model.name == name)

    def decoder(self, sender: str) -> DrivenDecoder:
        """The decoder of what an endpoint sends."""
        return next(item for item in self.decoders if item.name == sender)

    def frame(self, sender: str, message: str) -> DrivenFrame:
        """The functions for a message of a sender."""
        return self._frame_of[sender, message]

    def write(self, folder: Path) -> list[Path]:
        """Write the generated sources and the driver; returns what has to be compiled."""
        name = self.protocol.name
        for file in emit([self._whole], self.options):
            if file.path.name in (f"{name}.c", f"{name}.h"):
                (folder / file.path.name).write_bytes(file.bytes)
        sources = [folder / f"{name}.c", folder / "driver.c"]
        if self.options.style == "single":
            text = f'#define {name.upper()}_IMPLEMENTATION\n#include "{name}.h"\n'
            sources[0].write_text(text, encoding="utf-8")
        sources[1].write_text(self.text(), encoding="utf-8")
        header = TEMPLATES / "driver.h"
        (folder / header.name).write_bytes(header.read_bytes())
        return sources

    def text(self) -> str:
        """The driver's source."""
        return _template().render(
            name=self.protocol.name,
            upper=self.protocol.name.upper(),
            messages=self.messages,
            frames=self.frames,
            decoders=self.decoders,
            sends=any(frame.send for frame in self.frames),
            largest=max(
                [
                    32,
                    *(item.model.sizes.greatest + 16 for item in self.messages),
                    *(item.room + 8 for item in self.frames),
                ]
            ),
        )

    # --- what there is --------------------------------------------------------------------------

    def _messages(self, module: Module) -> list[DrivenMessage]:
        return [
            DrivenMessage(
                model := self.protocol.message(item.name),
                item.struct,
                walk_function(f"walk_{index}", item.struct, model.fields),
                item.encode,
                item.decode,
            )
            for index, item in enumerate(module.messages)
        ]

    def _frames(self, framing: FramingView) -> list[DrivenFrame]:
        return [
            DrivenFrame(
                index,
                self.message(item.name),
                item.function,
                item.send if item.sends else "",
                _frame_parts(item),
                item.room,
            )
            for index, item in enumerate(framing.messages)
        ]

    def _frames_by_sender(self, framing: FramingView) -> dict[tuple[str, str], DrivenFrame]:
        """Senders with the same frame share functions."""
        return {
            (sender.name, item.name): frame
            for frame, item in zip(self.frames, framing.messages, strict=True)
            for sender in self.protocol.senders
            if self._sends(sender, item.name) and sender.frame == item.frame.decoder.geometry.frame
        }

    @staticmethod
    def _sends(sender: Sender, message: str) -> bool:
        return any(item.name == message for item in sender.messages)

    def _decoders(self, framing: FramingView) -> list[DrivenDecoder]:
        return [
            self._decoder(index, decoder, dispatch)
            for index, (decoder, dispatch) in enumerate(
                zip(framing.decoders, framing.dispatches, strict=True)
            )
        ]

    def _decoder(self, index: int, decoder: DecoderView, dispatch: Dispatch) -> DrivenDecoder:
        return DrivenDecoder(
            index,
            decoder.name,
            decoder.prefix,
            decoder.all_events,
            decoder.flat,
            tuple(DrivenPart(part.name, part.type) for part in decoder.parts),
            tuple(
                DrivenHandler(item.function, item.message.struct, self.message(item.message.name))
                for item in dispatch.handlers
            ),
        )


def _frame_parts(item: MessageFrame) -> tuple[DrivenPart, ...]:
    """By their names in the schema; those of arguments may differ."""
    frame = item.frame
    return tuple(
        DrivenPart(part.name, argument.type)
        for part, argument in zip(frame.geometry.frame.caller_parts, frame.arguments, strict=True)
    )


@cache
def _template() -> Template:
    environment = Environment(
        loader=PackageLoader("protogen.fuzzing"),
        trim_blocks=True,
        lstrip_blocks=True,
        keep_trailing_newline=True,
        undefined=StrictUndefined,
        autoescape=False,  # noqa: S701 - the text is C
    )
    return environment.get_template("driver.c.j2")
