"""All that is printed around the payloads: frames, decoders, and what these share."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Iterator

import msgspec

from protogen.copying import replace
from protogen.model.frame_room import room_beside
from protogen.model.protocol import Protocol, Sender
from protogen.targets.c.decoders.decoder import DecoderView, decoder_view
from protogen.targets.c.decoders.forms import FormsDecoder, forms_decoders
from protogen.targets.c.frame.algorithms import Checksums
from protogen.targets.c.frame.frames import FrameView
from protogen.targets.c.frame.handlers import Dispatch, dispatches
from protogen.targets.c.frame.message_frames import MessageFrame, SenderFrames
from protogen.targets.c.frame.part_numbers import PartNumbers, claim_functions
from protogen.targets.c.frame.texts import TextView, texts_of
from protogen.targets.c.options import COptions
from protogen.targets.c.payload.helpers import Helpers
from protogen.targets.c.payload.message_names import claim_frame
from protogen.targets.c.payload.messages import MessageView
from protogen.targets.c.protocol_names import is_stateless
from protogen.targets.c.spelling import Names, from_sender


class FramingView(msgspec.Struct, frozen=True):
    """Everything that the templates print of frames and decoders."""

    decoders: tuple[DecoderView, ...]
    together: tuple[FormsDecoder, ...]
    """A decoder for each endpoint that has several forms of frame."""
    frames: tuple[FrameView, ...]
    """One of each kind: senders with the same frame share what builds it."""
    messages: tuple[MessageFrame, ...]
    checksums: Checksums
    sums: dict[str, str]
    """Types of the registers of checksums that are worked out while a frame is written."""
    sinks: tuple[str, ...]
    """Functions that the payloads share where they are written byte by byte."""
    dispatches: tuple[Dispatch, ...]
    streaming: tuple[str, ...]
    """The frames, by their sender, that some message can be sent in byte by byte."""
    writers: tuple[str, ...]
    """What the names of their functions begin with."""
    puts: tuple[str, ...]
    """The functions that hand payloads to a writer."""
    written: tuple[str, ...]
    """Functions for those below that read what was written in a frame."""
    unset: tuple[str, ...]
    """Functions that say whether a message that was begun in its frame can end."""
    stateless: bool
    """True if what is sent byte by byte goes out as it is."""
    writes: bool
    """True if any of these hands over a byte."""
    cut_checks: frozenset[str]
    """The frames, by their sender, some of which a decoder might end too early."""
    in_place: frozenset[str]
    """Those in which no group of COBS is ever full, so that no byte moves when they are stuffed."""
    around_bytes: frozenset[str]
    """Those in which the payloads of several messages are a byte, so that they share a function."""
    beside: dict[str, int]
    """What frames that are stuffed byte by byte need beside the most for each byte of content."""
    around_others: frozenset[str]
    """Those in which that of some message is anything else."""
    trims: frozenset[str]
    """Those in which zeros at the end of some payload may be left out."""
    cuts_sent: bool
    """True if of some message that is sent byte by byte only the first bytes may be."""
    idle_checks: frozenset[str]
    """Those some of which a decoder might take for an idle line."""
    texts: tuple[TextView, ...]
    """Sizes of the parts that are texts."""
    helpers: tuple[str, ...]
    """Functions for the digits of parts, but for those that payloads have as well."""

    @property
    def polled(self) -> tuple[str, ...]:
        """Prefixes of the decoders whose functions return what is complete."""
        alone = tuple(decoder.prefix for decoder in self.decoders if decoder.is_polled)
        return alone + tuple(item.prefix for item in self.together if item.is_polled)

    @property
    def stuffs_streams(self) -> bool:
        """True if some frame that is sent byte by byte is stuffed."""
        return any(
            frame.decoder.stuffing is not None
            for frame in self.frames
            if frame.decoder.name in self.streaming
        )

    @property
    def has_states(self) -> bool:
        """True if some decoder goes by states."""
        return bool(self.together) or any(decoder.lean is None for decoder in self.decoders)

    @property
    def stops_at_messages(self) -> bool:
        """True if some decoder with states stops at a message, until it is called again."""
        return any(d.polled is d.push for d in self.decoders) or any(
            item.is_polled for item in self.together
        )

    @property
    def tells_all(self) -> bool:
        """True if decoders yield all events, and not messages alone."""
        return any(decoder.all_events for decoder in self.decoders)

    @property
    def greatest_room(self) -> int:
        """Bytes of the greatest buffer that some frame needs."""
        return max((message.room for message in self.messages), default=0)

    @property
    def takes_whole(self) -> bool:
        """True if some decoder takes whole frames out of what it is fed."""
        return any(decoder.takes_whole for decoder in self.decoders)

    @property
    def unstuffs_whole(self) -> bool:
        """True if some of these frames are stuffed."""
        return any(decoder.whole and decoder.stuffing for decoder in self.decoders)

    @property
    def has_fast_ways(self) -> bool:
        """True if hosts do something in another way than small machines."""
        return self.takes_whole or self.checksums.have_blocks

    @property
    def finds_high(self) -> bool:
        """True if some of these frames have bytes that carry seven bits alone."""
        return any(d.whole and d.plan.seven_bit for d in self.decoders)


def framing_view(
    protocol: Protocol,
    messages: tuple[MessageView, ...],
    sinks: tuple[str, ...],
    options: COptions,
    names: Names,
    helpers: Helpers,
) -> FramingView:
    """The frames and decoders of the senders that were chosen."""
    views = {view.name: view for view in messages}
    senders = [item for item in protocol.senders if _is_chosen(item, views, options)]
    numbers, shared = PartNumbers(helpers), len(helpers.texts)
    decoders = tuple(
        decoder_view(names, sender, views, options.events, numbers) for sender in senders
    )
    for decoder in decoders:
        claim_functions(decoder.plan, {item.name for item in decoder.compared}, numbers)
    frames = _frames(senders, decoders)
    distinct = tuple({frame.decoder.name: frame for frame in frames.values()}.values())
    built = tuple(_message_frames(protocol, frames, decoders, views, names))
    around = _several(item.frame.decoder.name for item in built if item.byte)
    beside = _beside(built, around)
    message_frames = tuple(replace(m, beside=beside[m.frame.decoder.name]) for m in built)
    algorithms = [item.checksum for decoder in decoders for item in decoder.checksums]
    streaming = tuple(dict.fromkeys(m.frame.decoder.name for m in message_frames if m.streams))
    puts = tuple(dict.fromkeys(item.view.put_function for item in message_frames if item.streams))
    used = _used(sinks, list(puts))
    return FramingView(
        decoders=tuple(decoder.without_start for decoder in decoders),
        together=forms_decoders(names, senders, decoders, options.events),
        frames=distinct,
        messages=message_frames,
        checksums=Checksums(tuple({item.function: item for item in algorithms}.values())),
        sums={
            f"{frame.decoder.name}_{item.name}": item.checksum.type
            for frame in distinct
            if frame.decoder.name in streaming
            for item in frame.decoder.checksums
        },
        streaming=streaming,
        writers=tuple(names.senders[name] for name in streaming),
        puts=puts,
        written=tuple(
            dict.fromkeys(
                text for item in message_frames if item.in_place for text in item.in_place.written
            )
        ),
        unset=tuple(
            dict.fromkeys(
                place.unset_function
                for item in message_frames
                if (place := item.in_place) and place.unset
            )
        ),
        stateless=is_stateless(protocol),
        writes=any(f"{protocol.name}_write(" in text for text in (*puts, *used)),
        cut_checks=frozenset(
            item.frame.decoder.name for item in message_frames if item.needs_cut_check
        ),
        in_place=frozenset(frame.decoder.name for frame in distinct if frame.is_one_region)
        - {item.frame.decoder.name for item in message_frames if item.may_fill_group},
        around_bytes=around,
        beside=beside,
        around_others=frozenset(i.frame.decoder.name for i in message_frames if not i.byte),
        trims=frozenset(item.frame.decoder.name for item in message_frames if item.is_trimmed),
        cuts_sent=any(item.streams and item.is_trimmed for item in message_frames),
        idle_checks=frozenset(
            item.frame.decoder.name for item in message_frames if item.needs_idle_check
        ),
        dispatches=dispatches(decoders, messages, names),
        sinks=used,
        texts=texts_of(protocol),
        helpers=helpers.texts[shared:],
    )


def _beside(messages: Iterable[MessageFrame], around: frozenset[str]) -> dict[str, int]:
    """What frames need beside the most for each byte of content, by name of the frame.

    Several senders have one function that says it. What puts a frame around a byte takes any
    identity.
    """
    found: dict[str, int] = {}
    for message in messages:
        name = message.frame.decoder.name
        own = room_beside(message.decoder.plan, known=name not in around)
        found[name] = max(found.get(name, own), own)
    return found


def _several(names: Iterable[str]) -> frozenset[str]:
    """Those that come more than once."""
    return frozenset(name for name, count in Counter(names).items() if count > 1)


def _used(functions: tuple[str, ...], users: list[str]) -> tuple[str, ...]:
    """Those of the functions that some user, or a used one behind it, calls."""
    found: list[str] = []
    for text in reversed(functions):
        name = text.partition("(")[0].rpartition(" ")[2].lstrip("*")
        if any(f"{name}(" in user for user in (*users, *found)):
            found.insert(0, text)
    return tuple(found)


def _frames(senders: list[Sender], decoders: tuple[DecoderView, ...]) -> dict[str, FrameView]:
    """The frame of each sender; one for all that have the same."""
    frames: dict[str, FrameView] = {}
    for sender, decoder in zip(senders, decoders, strict=True):
        same = (view for view in frames.values() if view.plan.frame == sender.frame)
        frames[sender.name] = next(same, None) or FrameView(decoder)
    return frames


def _message_frames(
    protocol: Protocol,
    frames: dict[str, FrameView],
    decoders: tuple[DecoderView, ...],
    views: dict[str, MessageView],
    names: Names,
) -> Iterator[MessageFrame]:
    of_sender = {
        decoder.name: SenderFrames(frames[decoder.name], decoder, protocol.sender(decoder.name))
        for decoder in decoders
    }
    for message in protocol.messages:
        senders = [item.name for item in protocol.senders_of(message) if item.name in frames]
        own = {frames[name].decoder.name: name for name in senders}
        for frame_name, name in own.items() if message.name in views else ():
            suffix = from_sender(frame_name) if len(own) > 1 else ""
            called = claim_frame(names, message, suffix)
            yield of_sender[name].view(message, views[message.name], called)


def _is_chosen(sender: Sender, views: dict[str, MessageView], options: COptions) -> bool:
    return options.takes(sender) and any(item.name in views for item in sender.messages)
