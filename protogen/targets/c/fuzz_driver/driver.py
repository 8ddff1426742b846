"""Makes a driver of a protocol: the generated C, and the program that calls it."""

from __future__ import annotations

from collections.abc import Mapping

from protogen.fuzzing.c_driver import (
    DrivenDecoder,
    DrivenField,
    DrivenForm,
    DrivenFrame,
    DrivenHandler,
    DrivenMessage,
    DrivenPart,
    Driver,
)
from protogen.model.messages import given_parts
from protogen.model.parts import NumberPart, ToldIdentity
from protogen.model.protocol import Protocol
from protogen.targets.c.decoders.decoder import DecoderView
from protogen.targets.c.decoders.forms import FormsDecoder
from protogen.targets.c.emit import Unit, emit, unit_of
from protogen.targets.c.frame.handlers import Dispatch
from protogen.targets.c.frame.message_frames import MessageFrame
from protogen.targets.c.fuzz_driver.exchange import exchange_function
from protogen.targets.c.options import COptions
from protogen.targets.printing import environment


def driver_of(whole: Protocol, options: COptions = COptions()) -> Driver:  # noqa: B008
    """The driver of what the options choose of a protocol."""
    unit = unit_of(whole, options)
    protocol, name = unit.protocol, unit.names.file
    indices = {item.name: index for index, item in enumerate(unit.module.messages)}
    messages = _messages(unit)
    frames = _frames(unit, indices)
    decoders = tuple(
        _decoder(index, decoder, dispatch, indices)
        for index, (decoder, dispatch) in enumerate(
            zip(unit.framing.decoders, unit.framing.dispatches, strict=True)
        )
    )
    for item in unit.framing.together:
        decoders = (*decoders, _forms_decoder(len(decoders), item, decoders))
    files = {
        file.path.name: file.bytes
        for file in emit([whole], options)
        if file.path.name in (f"{name}.c", f"{name}.h")
    }
    if options.style == "single":
        text = f'#define {unit.module.upper}_IMPLEMENTATION\n#include "{name}.h"\n'
        files[f"{name}.c"] = text.encode()
    files["driver.c"] = _text(unit, messages, frames, decoders).encode()
    return Driver(
        protocol,
        messages,
        decoders,
        frames,
        _frame_of(unit, frames),
        files,
        (f"{name}.c", "driver.c"),
    )


def _text(
    unit: Unit,
    messages: tuple[DrivenMessage, ...],
    frames: tuple[DrivenFrame, ...],
    decoders: tuple[DrivenDecoder, ...],
) -> str:
    """The driver's source."""
    largest = [
        32,
        *(item.model.sizes.greatest + 16 for item in messages),
        *(item.room + 8 for item in frames),
    ]
    template = environment("protogen.targets.c.fuzz_driver").get_template("driver.c.j2")
    return template.render(
        file=unit.names.file,
        name=unit.module.name,
        upper=unit.module.upper,
        messages=messages,
        frames=frames,
        decoders=decoders,
        sends=any(frame.send for frame in frames),
        largest=max(largest),
    )


def _messages(unit: Unit) -> tuple[DrivenMessage, ...]:
    return tuple(
        DrivenMessage(
            model := unit.protocol.message(item.name),
            item.struct,
            exchange_function(f"exchange_{index}", item.struct, model.plan, unit.names)
            if item.struct
            else "",
            item.encode,
            item.decode,
            tuple(DrivenField(held.field, held.type) for held in item.held),
        )
        for index, item in enumerate(unit.module.messages)
    )


def _frames(unit: Unit, indices: Mapping[str, int]) -> tuple[DrivenFrame, ...]:
    return tuple(
        DrivenFrame(
            index,
            indices[item.message.name],
            bool(item.view.struct),
            item.called.function,
            item.called.send if item.sends else "",
            # By their names in the schema; those of arguments may differ.
            tuple(
                DrivenPart(part.name, argument.type, part)
                for part, argument in zip(_given(item), item.arguments, strict=True)
            ),
            item.room,
        )
        for index, item in enumerate(unit.framing.messages)
    )


def _given(item: MessageFrame) -> list[NumberPart]:
    """The parts that the caller of a message's functions gives: those that are sent."""
    held = {field.part for field in item.message.held}
    parts = given_parts(item.frame.plan.frame, item.message)
    return [it for it in parts if not isinstance(it, ToldIdentity) and it.name not in held]


def _frame_of(unit: Unit, frames: tuple[DrivenFrame, ...]) -> dict[tuple[str, str], DrivenFrame]:
    return {
        (sender.name, item.message.name): frame
        for frame, item in zip(frames, unit.framing.messages, strict=True)
        for sender in unit.protocol.senders
        if item.message in sender.messages and sender.frame == item.frame.plan.frame
    }


def _decoder(
    index: int, decoder: DecoderView, dispatch: Dispatch, indices: Mapping[str, int]
) -> DrivenDecoder:
    return DrivenDecoder(
        index,
        decoder.name,
        decoder.prefix,
        decoder.all_events,
        decoder.polled is not None,
        tuple(DrivenPart(part.name, part.type, part.part, part.member) for part in decoder.parts),
        tuple(
            DrivenHandler(item.function, item.message.struct, indices[item.message.name])
            for item in dispatch.handlers
        ),
        told=tuple((part.name, part.member, part.type) for part in decoder.told_parts),
    )


def _forms_decoder(
    index: int, item: FormsDecoder, decoders: tuple[DrivenDecoder, ...]
) -> DrivenDecoder:
    indices = {decoder.name: decoder.index for decoder in decoders}
    forms = tuple(
        DrivenForm(form.name, form.member, form.constant, indices[form.sender])
        for form in item.forms
    )
    told = tuple((told.part.name, told.part.member, told.part.type) for told in item.told)
    return DrivenDecoder(index, item.name, item.prefix, item.all_events, False, (), (), told, forms)
