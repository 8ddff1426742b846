"""Single wrong bytes that go unnoticed.

A byte is checked if a checksum covers it that any change of one byte changes, or if it is fixed.
What is left is said in one sentence each.
"""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Sequence
from functools import reduce
from itertools import combinations
from operator import or_

from protogen.model.checksums import ChecksumSpec
from protogen.model.frame import Frame
from protogen.model.framing import Anywhere, End, Start, StartLiteral, StartSet
from protogen.model.identities import Identities
from protogen.model.messages import Message
from protogen.model.parts import (
    BitsPart,
    ChecksumPart,
    ChoicePart,
    IdentityPart,
    LengthPart,
    LiteralPart,
    NumberPart,
    Part,
    PayloadPart,
    TypedPart,
    VirtualPart,
    place_of,
)
from protogen.model.sizes import SizeSet
from protogen.model.transparency import Base16, Cobs
from protogen.passes.framing.capacity import payload_range
from protogen.passes.framing.framing_words import span
from protogen.passes.proofs.contents import has_virtual
from protogen.passes.proofs.damaged_ends import joined_frames
from protogen.passes.proofs.wire_code import SEVEN_BITS, ByteSet

_BY_CHANCE = "where the bytes there happen to check"
"""Once in 2^w, for a checksum of w bits."""


def undetected_errors(
    frame: Frame, start: Start, end: End | None, messages: list[Message], payload: ByteSet
) -> tuple[str, ...]:
    """One sentence for each kind of wrong byte that a receiver takes for right."""
    sentences = [_part(frame, part, end, messages, payload) for part in frame.numbers]
    sentences.append(_misread_size(frame, end, messages))
    sentences.append(_misread_absence(frame, messages))
    sentences.append(_false_start(frame, start))
    sentences.append(_other_size(frame, start, messages))
    sentences.append(_early_end(frame, start, end, messages))
    sentences.append(joined_frames(frame, start, end, messages, payload))
    sentences.append(_weak_checksum(frame))
    sentences.append(_stuffing(frame))
    return tuple(sentence for sentence in sentences if sentence)


def _part(
    frame: Frame, part: Part, end: End | None, messages: list[Message], payload: ByteSet
) -> str:
    if isinstance(part, LiteralPart | ChecksumPart | BitsPart) or _is_seen(frame, part):
        return ""
    holder = frame.holder(part.name).name
    covering = [checksum for checksum in frame.checksums if holder in checksum.covers]
    if covering:
        made_up = _made_up_for(frame, part, covering, messages)
        return made_up or _sometimes(part, covering, messages)
    if isinstance(part, LengthPart):
        return ""  # What comes of a wrong size is asked for the frame as a whole.
    if isinstance(part, IdentityPart):
        return _identity(frame, part, end, messages)
    if isinstance(part, PayloadPart):
        if messages and not any(message.sizes.greatest for message in messages):
            return ""  # It has no bytes.
        return f"a wrong byte in the payload{_inside(frame, payload)}: nothing checks it"
    if isinstance(part, ChoicePart):
        return _other_literal(part)
    return f"a wrong `{part.name}`: no checksum covers it"


def _is_seen(frame: Frame, part: Part) -> bool:
    """True if a wrong byte of a number is seen by bits of other bytes, which follow from it.

    So is one of a length by another length that surely stands where it is looked for.
    """
    if not isinstance(part, NumberPart):
        return False
    own = _bytes_of_bits(frame, part)
    mirrors = [mirror for mirror in frame.mirrors if mirror.of.name == part.name]
    copies = (_bytes_of_bits(frame, mirror) for mirror in mirrors)
    if any(not any(map(tuple.__eq__, own, copy)) for copy in copies):
        return True
    if not isinstance(part, LengthPart):
        return False
    others = (other for other in frame.lengths if frame.holder(other.name) in frame.head)
    return any(set(own).isdisjoint(_bytes_of_bits(frame, other)) for other in others)


def _bytes_of_bits(frame: Frame, part: TypedPart) -> list[tuple[str, int]]:
    """The byte that has each bit of a number, from the lowest bit on."""
    holder, low = frame.holder(part.name).name, place_of(part.type)
    return [(holder, (low + bit) // part.type.byte_bits) for bit in range(part.type.bits)]


def _other_literal(part: ChoicePart) -> str:
    """Sentence on a byte that makes another literal of one."""
    pairs = combinations(part.words, 2)
    differences = (sum(map(int.__ne__, one, other)) for one, other in pairs)
    if 1 not in differences:
        return ""
    return f"a wrong `{part.name}` that makes it another of its literals: no checksum covers it"


def _sometimes(part: Part, covering: list[ChecksumPart], messages: list[Message]) -> str:
    """Sentence on frames without a payload, where each checksum is absent from them."""
    empty = any(message.sizes.least == 0 for message in messages)
    always = any(not checksum.when_payload for checksum in covering)
    if always or not empty or isinstance(part, PayloadPart):
        return ""
    return f"a wrong `{part.name}` in a frame without payload: it has no checksum"


def _made_up_for(
    frame: Frame, part: Part, covering: list[ChecksumPart], messages: list[Message]
) -> str:
    """Sentence on another identity, with which other bytes that are not sent are summed."""
    if not isinstance(part, IdentityPart):
        return ""
    if not all(has_virtual(frame, item) or item.when_payload for item in covering):
        return ""
    covered = {name for item in covering for name in item.covers}
    varying = [
        virtual.name
        for virtual in frame.virtual
        if virtual.name in covered and _has_several_values(virtual, messages)
    ]
    if not varying:
        return ""
    names = " and ".join(f"`{name}`" for name in varying)
    verb = "happens" if len(varying) == 1 else "happen"
    text = f"a wrong `{part.name}` that makes it another message, whose {names} {verb}"
    return f"{text} to make up for it"


def _has_several_values(part: VirtualPart, messages: list[Message]) -> bool:
    values = {message.virtual_value(part) for message in messages} | {part.default}
    return len(values - {None}) > 1


def _identity(frame: Frame, part: IdentityPart, end: End | None, messages: list[Message]) -> str:
    """Messages that differ in this part only are confusable where they can have one size.

    Where nothing but the identity tells the size, a shorter message is one as well.
    """
    index = frame.identity.index(part)
    groups = _groups_without(messages, index)
    wrong, found = f"a wrong `{part.name}` that makes it", ""
    if frame.length is None and frame.silence is None and end is None:
        if any(len({message.told_by for message in group}) > 1 for group in groups):
            found = f"{wrong} another message of the same size, or a shorter one"
    elif any(_share_a_size(group) for group in groups):
        found = f"{wrong} another message of the same size"
    if any(message.chooses(index) for message in messages):
        own = "another identity of its message"
        return f"{found}, or {own}" if found else f"{wrong} {own}"
    return found


def _groups_without(messages: list[Message], index: int) -> list[list[Message]]:
    """The messages that differ in this identity part only, in groups."""
    others = [
        (Identities(message.told_by.runs[:index] + message.told_by.runs[index + 1 :]), message)
        for message in messages
    ]
    if all(message.identities is None for message in messages):
        alike: dict[Identities, list[Message]] = defaultdict(list)
        for rest, message in others:
            alike[rest].append(message)
        return list(alike.values())
    return [
        [message for other, message in others if other.meet(rest) is not None] for rest, _ in others
    ]


def _false_start(frame: Frame, start: Start) -> str:
    """Inside of a frame that nothing checks, a start makes a message of what follows."""
    if any(not part.when_payload for part in frame.checksums):
        return ""
    match start:
        case StartLiteral():
            what = f"makes {start.bytes.hex(' ').upper()}, the start"
        case StartSet():
            what = f"makes a start, {span(start)}"
        case _:
            return ""
    return f"a wrong byte that {what}, where the bytes behind it happen to be a whole frame"


def _other_size(frame: Frame, start: Start, messages: list[Message]) -> str:
    """Without a mark, a frame that is read too long or too short moves all that follow."""
    sizes = {message.sizes for message in messages}
    told = frame.told_length is not None
    alike = frame.length is None and len(sizes) == 1 and sizes.pop().fixed is not None
    if not isinstance(start, Anywhere) or start.checked or alike or told:
        return ""
    if frame.silence is not None:
        return ""
    return "a wrong byte that makes another size of a frame: those behind it are cut elsewhere"


def _early_end(frame: Frame, start: Start, end: End | None, messages: list[Message]) -> str:
    """A wrong byte can end a frame early, or join two, where nothing else tells the size."""
    if end is None or frame.length is not None:
        return ""
    if all(message.sizes.fixed is not None for message in messages):
        return ""
    # Where the end is broken, a start that occurs nowhere else shows it.
    shown = isinstance(start, StartLiteral | StartSet) and start.protected
    verb = "makes" if shown else "makes or breaks"
    what = f"a wrong byte that {verb} {end.bytes.hex(' ').upper()}, the end"
    return f"{what}, where what is read happens to check" if frame.checksums else what


def _share_a_size(messages: list[Message]) -> bool:
    """True if two of the messages, which differ in identity, can have the same size."""
    distinct = {message.told_by: message.sizes for message in messages}
    by_least = sorted(distinct.values(), key=lambda sizes: sizes.least)
    fixed = {sizes.least for sizes in by_least if sizes.step == 0}
    varying = [sizes for sizes in by_least if sizes.step]
    if len(fixed) + len(varying) < len(by_least):
        return True
    return any(one.meets(other) for one in varying for other in by_least if one is not other)


def _inside(frame: Frame, payload: ByteSet) -> str:
    """Sentence on what still shows some wrong bytes: an encoding, or a highest bit of 0."""
    if isinstance(frame.encoding, Base16):
        return " that is still a hex digit"
    return " whose highest bit is still 0" if payload == SEVEN_BITS else ""


def _weak_checksum(frame: Frame) -> str:
    weak = [
        part
        for part in frame.checksums
        if _misses_single_bytes(part.algorithm) or not _has_all_bits(frame, part)
    ]
    if not weak:
        return ""
    names = ", ".join(f"`{part.name}`" for part in weak)
    first = weak[0]
    sees = f"{first.taken} of {first.algorithm.name} do not see them"
    if first.takes_all or _misses_single_bytes(first.algorithm):
        sees = f"{first.algorithm.name} does not see them"
    return f"some wrong bytes that {names} covers: {sees}"


def _has_all_bits(frame: Frame, part: ChecksumPart) -> bool:
    """True if a checksum has all bits of its result, alone or with others that have the rest."""
    if part.takes_all:
        return True
    same = [it for it in frame.checksums if (it.algorithm, it.covers) == _summed(part)]
    found = reduce(or_, (it.type.greatest << it.lowest for it in same))
    return found == part.algorithm.greatest


def _summed(part: ChecksumPart) -> tuple[ChecksumSpec, tuple[str, ...]]:
    return part.algorithm, part.covers


def _misses_single_bytes(algorithm: ChecksumSpec) -> bool:
    """Sums modulo 255 take 00 for FF; a CRC sees bursts of its width if its polynomial is odd.

    Other sums, and exclusive ors, see all bits of a byte that their mask leaves.
    """
    match algorithm.kind:
        case "fletcher":
            return algorithm.modulus == 255
        case "crc":
            return algorithm.width < 8 or algorithm.poly % 2 == 0
        case _:
            seen = algorithm.greatest if algorithm.mask is None else algorithm.mask
            every = algorithm.greatest if algorithm.words else 0xFF
            return seen & every != every


def _stuffing(frame: Frame) -> str:
    """One wrong byte on the wire can become several behind the stuffing."""
    if not frame.checksums or isinstance(frame.encoding, Base16 | None):
        return ""
    if isinstance(frame.encoding, Cobs):
        return "a wrong COBS code byte moves zeros, which the checksum misses in rare cases"
    return (
        "a wrong byte that makes or breaks a stuffed sequence changes several bytes and the size, "
        "which length and checksum miss in rare cases"
    )


# --- wrong sizes, with which a receiver looks for the checksum in another place -------------------


def _misread_size(frame: Frame, end: End | None, messages: list[Message]) -> str:
    """The sentence about wrong sizes; empty where none goes unnoticed."""
    if frame.told_length is not None:
        return ""  # Its size is not read.
    if frame.silence is not None or (end is not None and end.protected):
        return ""  # It then stands in the wrong place.
    if frame.length is not None:
        seen = _is_seen(frame, frame.length)
        return "" if seen else _wrong_length(frame, frame.length, messages)
    return _wrong_field(frame, messages) if end is None else ""


def _misread_absence(frame: Frame, messages: list[Message]) -> str:
    """The sentence about lengths that claim that there is no payload, and so no checksum."""
    length = frame.length
    optional = any(part.when_payload for part in frame.checksums)
    always = any(not part.when_payload for part in frame.checksums)
    if length is None or not optional or always or frame.silence is not None:
        return ""
    if frame.told_length is not None:
        return ""
    if _is_seen(frame, length) or _lengths_behind(frame):
        return ""
    if not any(0 in sizes and sizes.fixed is None for sizes in _acceptable(frame, messages)):
        return ""
    return f"a wrong `{length.name}` that says that there is no payload: then nothing is checked"


def _wrong_length(frame: Frame, length: LengthPart, messages: list[Message]) -> str:
    if all(sizes.fixed is not None for sizes in _acceptable(frame, messages)):
        return ""  # Its message can't have that size.
    if _settled_early(frame, length):
        return ""
    behind: list[ChecksumPart | LengthPart] = [*frame.checksums, *_lengths_behind(frame)]
    behind = [part for part in behind if frame.holder(part.name) in frame.tail]
    if not frame.checksums and not behind:
        return f"a wrong `{length.name}`: nothing checks it"
    if not behind:
        return f"a wrong `{length.name}`, where so many bytes happen to check"
    return f"a wrong `{length.name}`, which moves where {_names(behind)} is read, {_BY_CHANCE}"


def _wrong_field(frame: Frame, messages: list[Message]) -> str:
    """Identity and fields tell the size here, and a wrong one another size."""
    behind = [part for part in frame.checksums if frame.holder(part.name) in frame.tail]
    sizes = {message.sizes for message in messages}
    one_size = len(sizes) < 2 and all(item.fixed is not None for item in sizes)
    if not behind or one_size:
        return ""
    return f"a wrong byte that moves where {_names(behind)} is read, {_BY_CHANCE}"


def _acceptable(frame: Frame, messages: list[Message]) -> list[SizeSet]:
    """The payload sizes that a receiver takes from a sender, for each identity that it has read.

    Behind the payload, another size makes another identity of it.
    """
    first = frame.identity_is_early
    groups: dict[Identities | None, SizeSet] = {}
    for message in messages:
        key = message.told_by if first else None
        groups[key] = groups[key] | message.sizes if key in groups else message.sizes
    stated = payload_range(frame)
    bounded = (
        sizes if stated is None else sizes.within(stated.least, stated.greatest) or sizes
        for sizes in groups.values()
    )
    return list(bounded)


def _lengths_behind(frame: Frame) -> list[LengthPart]:
    """The lengths behind the payload."""
    return [part for part in frame.lengths if frame.holder(part.name) in frame.tail]


def _settled_early(frame: Frame, length: LengthPart) -> bool:
    """True if a checksum of the header alone covers the length."""
    holder = frame.holder(length.name).name
    return any(
        holder in part.covers
        and not part.when_payload
        and frame.holder(part.name) in frame.head
        and frame.payload.name not in part.covers
        for part in frame.checksums
    )


def _names(parts: Sequence[ChecksumPart | LengthPart]) -> str:
    return " and ".join(f"`{part.name}`" for part in parts)
