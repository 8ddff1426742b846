"""The parts of a frame, checksums and transparency in words."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from functools import lru_cache

from protogen.model.checksums import ChecksumSpec
from protogen.model.frame import Frame
from protogen.model.identities import Runs
from protogen.model.messages import Message
from protogen.model.parts import (
    BitsPart,
    ChecksumPart,
    ChoicePart,
    CounterPart,
    FixedBits,
    IdentityPart,
    LengthPart,
    LiteralPart,
    MirrorBits,
    NumberPart,
    Part,
    PayloadPart,
    ToldIdentity,
    ToldLength,
    ToldPart,
    TypedPart,
    ValuePart,
    VirtualPart,
    place_mask,
)
from protogen.model.sizes import SizeSet
from protogen.model.transparency import (
    FULL_GROUP,
    Base16,
    Cobs,
    Encoding,
    Escape,
    Insertion,
    Substitution,
    Transparency,
)
from protogen.targets.emitted import EmittedNames
from protogen.targets.markdown.fields.types import number_text
from protogen.targets.markdown.fields.values import character, raw_text
from protogen.targets.markdown.frames.layout import CodePart, Slot, length_values, part_title, slots
from protogen.targets.markdown.text.anchors import decision_link
from protogen.targets.markdown.text.code_names import in_code
from protogen.targets.markdown.text.origin import about_line
from protogen.targets.markdown.text.table import Table, table
from protogen.targets.markdown.text.words import (
    code,
    hex_bytes,
    hex_number,
    listed,
    plural,
)

_HEADER = ("Frame byte", "Size", "Type", "Part", "Value", "Meaning")


def frame_table(frame: Frame, payload: SizeSet, names: EmittedNames) -> Table:
    """Return the table of a frame's parts."""
    found = slots(frame, payload)
    return table(_HEADER, (row for slot in found for row in _frame_rows(slot, names)))


def _frame_rows(slot: Slot, names: EmittedNames) -> Iterator[tuple[str, ...]]:
    for place, size, part in slot.rows:
        cells = (place, size, part_type(part), part_title(part), part_value(part))
        yield (*cells, meaning(part, names))


@lru_cache(maxsize=256)
def part_type(part: Part) -> str:
    """Return a part's type; empty for bytes."""
    return number_text(part.type) if isinstance(part, TypedPart) else ""


def part_value(part: Part) -> str:
    """Return what a part holds in any frame."""
    if isinstance(part, NumberPart) and not isinstance(part, ChoicePart) and part.type.is_text:
        count = plural(part.type.size, "character")
        if part.between is None:
            return count
        return f"{count}, {' to '.join(literal_text(bytes((end,))) for end in part.between)}"
    match part:
        case LiteralPart():
            return literal_text(part.bytes)
        case ChoicePart():
            return listed([literal_text(word) for word in part.words], "or")
        case NumberPart():
            return "..".join(_part_number(bound, part) for bound in (part.least, part.greatest))
        case _:
            return ""


def value_in(frame: Frame, part: Part, message: Message) -> str:
    """Return what a part holds in the frames of one message."""
    if isinstance(part, IdentityPart):
        return identity_values(part, message.told_by.runs[frame.identity.index(part)])
    if isinstance(part, VirtualPart):
        value = message.virtual_value(part)
        return "" if value is None else virtual_text(part, value)
    if isinstance(part, LengthPart):
        lengths = length_values(frame, part, frame.payload.sent(message.sizes))
        if lengths.fixed is not None:
            return code(hex_number(lengths.fixed, part.type.bits))
        return f"{max(lengths.least, part.least)}..{min(lengths.greatest, part.greatest)}"
    return part_value(part)


def virtual_text(part: VirtualPart, value: int) -> str:
    """Print the value of a part that is not sent."""
    return literal_text(part.encode(value)) if part.type.is_text else code(value)


def identity_values(part: IdentityPart, runs: Runs) -> str:
    """Print the values of an identity part that all mean one message."""
    texts = ("..".join(identity_value(part, value) for value in dict.fromkeys(run)) for run in runs)
    return ", ".join(texts)


def identity_value(part: IdentityPart, value: int) -> str:
    """Print the value of an identity part: in hex, characters also as such."""
    if part.type.is_text:
        return literal_text(part.encode(value))
    shown = character(value) if part.type.role == "char" else ""
    return f"{shown} {code(hex_number(value, part.type.bits))}".strip()


def literal_text(data: bytes) -> str:
    """Print fixed bytes, with their characters where all can be seen."""
    shown = "".join(character(byte)[1:-1] for byte in data)
    visible = all(character(byte) for byte in data)
    return f"{code(hex_bytes(data))} '{shown}'" if visible else code(hex_bytes(data))


def _part_number(value: int, part: NumberPart) -> str:
    """Print an identity in hex, other numbers in decimal."""
    return code(hex_number(value, part.type.bits)) if isinstance(part, IdentityPart) else str(value)


def meaning(part: Part, names: EmittedNames) -> str:
    """Say what a part is for, and where that is written down."""
    shown = isinstance(part, IdentityPart | CounterPart | ValuePart)
    return about_line(part.about, *_roles(part), in_code(names.part(part.name)) if shown else "")


@lru_cache(maxsize=256)
def role(part: Part) -> str:
    """Say in a word what a part is."""
    whole = part.whole if isinstance(part, BitsPart) else None
    return next(word for kind, word in _ROLE_WORDS if isinstance(whole or part, kind))


_ROLE_WORDS: tuple[tuple[type[Part], str], ...] = (
    (LiteralPart, "Fixed."),
    (ToldIdentity, "Identity, not sent."),
    (ToldLength, "Length, not sent."),
    (IdentityPart, "Identity."),
    (LengthPart, "Length."),
    (CounterPart, "Counter."),
    (ChoicePart, "One of several literals."),
    (ValuePart, "Given by the sender."),
    (ChecksumPart, "Checksum."),
    (PayloadPart, "Payload."),
    (MirrorBits, "Follows from another part."),
    (BitsPart, "Its bits are parts."),
    (VirtualPart, "Not sent, but summed."),
    (CodePart, "How far on the next zero is, or the end."),
)


def _roles(part: Part) -> tuple[str, ...]:
    match part:
        case LiteralPart(unprotected=str(decision)):
            return (_unprotected(decision),)
        case LiteralPart():
            return ("Fixed.",)
        case NumberPart():
            return _number_roles(part)
        case ChecksumPart():
            return _checksum_roles(part)
        case BitsPart() | MirrorBits():
            return _bits_roles(part)
        case CodePart():
            return (role(part),)
        case VirtualPart():
            return _virtual_roles(part)
        case _:
            return tuple(_payload_roles(part))


def _bits_roles(part: BitsPart | MirrorBits) -> tuple[str, ...]:
    mirror = part.whole if isinstance(part, BitsPart) else part
    if isinstance(part, BitsPart) and mirror is None:
        return (role(part), *map(_fixed_bits, part.constants), _other_bits(part))
    assert mirror is not None
    if mirror.inverted:
        return (f"The bits of {code(mirror.of.name)}, each of them inverted.",)
    return (f"The value of {code(mirror.of.name)} again.",)


def _fixed_bits(item: FixedBits) -> str:
    """Say what bits are that have a name and are always the same."""
    value = code(hex_number(item.value, item.type.bits))
    return about_line(item.about, f"{code(item.name)}, {item.type.label}: always {value}.")


def _other_bits(part: BitsPart) -> str:
    """Say that the bits of no name are 0, if there are some."""
    named = sum(place_mask(item.type) for item in part.constants)
    return "Its other bits are 0." if named != part.mask else ""


def _payload_roles(part: Part) -> Iterator[str]:
    yield "The fields of the message."
    if isinstance(part, PayloadPart) and part.kept is not None:
        kept = "the first one" if part.kept == 1 else f"the first {part.kept}"
        yield f"Zero bytes at its end are left out, but for {kept}; a receiver puts them there."
    if isinstance(part, PayloadPart) and part.longest is not None:
        yield "It may be longer than a receiver knows its message, which then leaves the rest."
    if part.unprotected is not None:
        yield _unmarked(part.unprotected)


def _unprotected(decision: str) -> str:
    return f"Can also occur inside a frame: {decision_link(decision)}."


def _choice_roles(part: ChoicePart) -> tuple[str, ...]:
    words = dict(zip(part.values, part.words, strict=True))
    default = "" if part.default is None else f"{literal_text(words[part.default])} by default."
    accepted = "" if part.unprotected is None else _unprotected(part.unprotected)
    return ("One of these, which the sender chooses.", default, accepted)


def _number_roles(part: NumberPart) -> tuple[str, ...]:
    if isinstance(part, ChoicePart) or part.unprotected is None:
        return _jobs(part)
    return (*_jobs(part), _unmarked(part.unprotected))


def _unmarked(decision: str) -> str:
    return f"Nothing marks where a frame starts: {decision_link(decision)}."


def _jobs(part: NumberPart) -> tuple[str, ...]:
    match part:
        case ToldIdentity():
            text = "Tells which message it is, and is not sent: a receiver is told it."
            return (text, *_telling(part))
        case ToldLength():
            counted = part_names(part.counts)
            text = f"Number of bytes of {counted}, which is not sent: a receiver is told it."
            return (text, *_telling(part))
        case LengthPart():
            over = ", as they are on the wire" if part.over_wire else ""
            first = part.agrees_with
            agrees = "" if first is None else f"It has to agree with {code(first)}."
            return (f"Number of bytes of {part_names(part.counts)}{over}.", agrees)
        case CounterPart():
            return ("Counts frames and wraps.", _default(part))
        case ChoicePart():
            return _choice_roles(part)
        case ValuePart():
            return ("The sender gives it.", _default(part))
        case _:
            return ("Tells which message it is.",)


def _telling(part: ToldPart) -> tuple[str, ...]:
    """What tells a part that is not sent, for how long, and its value before."""
    telling = part.telling
    by = f"By {part_names([item.text for item in telling.set_by])}." if telling.set_by else ""
    lasts = "What it is told holds for one frame." if telling.once else ""
    return (by, lasts, _before(part))


def _before(part: ToldPart) -> str:
    if isinstance(part, ToldLength) and not part.holds(part.telling.default):
        return "No bytes are a frame before."
    return f"{raw_text(part.telling.default, part.type)} before."


def _default(part: CounterPart | ValuePart) -> str:
    if part.default is None:
        return ""
    if part.type.is_text:
        return f"{literal_text(part.encode(part.default))} by default."
    return f"{raw_text(part.default, part.type)} by default."


def _virtual_roles(part: VirtualPart) -> tuple[str, ...]:
    default = part.default
    text = "Not sent: it goes into the checksum, with a value that each message has."
    return (text, "" if default is None else f"{virtual_text(part, default)} by default.")


def _checksum_roles(part: ChecksumPart) -> tuple[str, ...]:
    over = ", as they are on the wire" if part.over_wire else ""
    what = f"{part.taken.capitalize()} of the checksum" if part.taken else "Checksum"
    return (
        f"{what} over {part_names(part.covers)}{over}: {algorithm_text(part.algorithm)}.",
        "Absent where the payload is empty." if part.when_payload else "",
    )


def part_names(names: Sequence[str]) -> str:
    """List some parts."""
    return listed([code(name) for name in names])


def algorithm_text(spec: ChecksumSpec) -> str:
    """Say how a checksum is computed."""
    match spec.kind:
        case "xor" | "sum":
            return _folded(spec)
        case "fletcher":
            return f"Fletcher-16, both sums modulo {spec.modulus}"
        case "crc":
            return f"{spec.name} ({_rocksoft(spec)})"


def _folded(spec: ChecksumSpec) -> str:
    """Say how a sum or an exclusive or is computed."""
    units = "all bytes"
    if spec.words is not None:
        first = "lowest" if spec.words == "little" else "highest"
        units = f"all words of {spec.width} bits ({first} byte first, zeros behind the last)"
    text = f"the XOR of {units}"
    if spec.kind == "sum":
        modulus = 256 if spec.width == 8 else f"2^{spec.width}"
        text = f"the sum of {units} modulo {modulus}"
        if spec.negated:
            text = f"what brings the sum of {units} to 0 modulo {modulus}"
    if spec.init:
        text += f", starting from {hex_number(spec.init, spec.width)}"
    if spec.xorout == spec.greatest:
        text += ", with all bits inverted"
    elif spec.xorout:
        text += f", XORed with {hex_number(spec.xorout, spec.width)}"
    if spec.mask is not None:
        text += f", of which the bits {hex_number(spec.mask, spec.width)} are kept"
    return text + (f", plus {hex_number(spec.add, spec.width)}" if spec.add else "")


def _rocksoft(spec: ChecksumSpec) -> str:
    numbers = (("poly", spec.poly), ("init", spec.init), ("xorout", spec.xorout))
    switches = (("refin", spec.refin), ("refout", spec.refout))
    texts = [f"{name} {hex_number(value, spec.width)}" for name, value in numbers]
    texts += [f"{name} {str(value).lower()}" for name, value in switches]
    return f"width {spec.width}, {', '.join(texts)}"


# --- transparency -------------------------------------------------------------------------------


def transparency_text(transparency: Transparency) -> tuple[str, ...]:
    """Say in paragraphs what keeps delimiters out of the frame."""
    first, last = code(transparency.first), code(transparency.last)
    region = first if first == last else f"{first} to {last}"
    stuffs = isinstance(transparency.encoding, Substitution | Escape)
    preset = f" ({transparency.preset.upper()})" if transparency.preset and stuffs else ""
    strict = (
        "Receivers also accept what a sender would have written otherwise."
        if transparency.lenient
        else ""
    )
    text = f"{_rule(transparency.encoding, region)}{preset}. {strict}".rstrip()
    return tuple(filter(None, (text, about_line(transparency.about))))


def _rule(encoding: Encoding, region: str) -> str:
    match encoding:
        case Substitution():
            return f"In {region}, these bytes are replaced on the wire"
        case Insertion():
            more = code(hex_bytes(bytes([encoding.byte])))
            return f"In {region}, {more} is put in wherever these bytes follow each other"
        case Escape():
            return f"In {region}, {_escape_rule(encoding)}"
        case Base16():
            return f"Each byte of {region} travels as two upper-case hex digits, the high one first"
        case Cobs():
            return f"{region} is COBS-encoded as a whole, so that it holds no zero byte. {_COBS}"


_COBS = (
    "The code byte in front says how many bytes on the first zero is, and each zero is replaced by "
    "how many bytes on the next one is; the last says where the region ends. "
    f"Where {FULL_GROUP} bytes hold no zero, the code is `FF`, and another one follows them"
)


def _escape_rule(escape: Escape) -> str:
    byte = code(hex_bytes(bytes([escape.byte])))
    changed = {0xFF: " with all its bits inverted", 0: " as it is"}
    how = changed.get(escape.xor, f" XOR {code(hex_number(escape.xor, 8))}")
    return f"these bytes are sent as {byte} followed by the byte{how}"


def transparency_table(transparency: Transparency) -> Table | None:
    """Return the table of the bytes that something else stands for, where there are some."""
    rows = _replacements(transparency.encoding)
    if not rows:
        return None
    cells = ((code(hex_bytes(data)), code(hex_bytes(wire))) for data, wire in rows)
    return table(("Data", "On the wire"), cells)


def _replacements(encoding: Encoding) -> tuple[tuple[bytes, bytes], ...]:
    match encoding:
        case Substitution():
            return tuple((bytes([byte]), wire) for byte, wire in encoding.table)
        case Insertion():
            word = encoding.sequence
            return ((word, word + bytes([encoding.byte])),)
        case Escape():
            return tuple(
                (bytes([byte]), bytes([encoding.byte, byte ^ encoding.xor])) for byte in encoding.of
            )
        case _:
            return ()
