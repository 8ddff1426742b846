"""Transparency of a sender's frame: what keeps delimiters out, and where."""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping
from itertools import pairwise

from protogen.model.transparency import (
    Base16,
    Cobs,
    Encoding,
    Escape,
    Insertion,
    Substitution,
    Transparency,
)
from protogen.passes.context import Context, Loc, about
from protogen.passes.draft import Draft
from protogen.passes.framing.virtual_parts import sent_names, sent_run
from protogen.passes.framing.written_frames import WrittenFrame
from protogen.passes.proofs.codewords import ambiguity, prefix_clash
from protogen.passes.proofs.wire_code import code_of
from protogen.schema.syntax.parts import EscapeSyntax, LiteralChoice, TransparencySyntax
from protogen.schema.syntax.parts import Part as PartSyntax

SLIP = Substitution(table=((0xC0, b"\xdb\xdc"), (0xDB, b"\xdb\xdd")))
"""RFC 1055: END and ESC, each behind ESC with a byte of its own."""

HDLC = Escape(byte=0x7D, of=(0x7D, 0x7E), xor=0x20)
"""RFC 1662: flag and control escape, with bit 5 inverted."""

_KINDS = ("substitute", "escape", "encoding", "preset")


def transparency_of(context: Context, written: WrittenFrame) -> Transparency | None:
    """The transparency of a frame."""
    item = written.transparency
    if item is None:
        return None
    return _Reader(context, written.transparency_loc, item).read(written.parts)


class _Reader:
    """One transparency on its way into the model."""

    def __init__(self, context: Context, loc: Loc, item: TransparencySyntax) -> None:
        self._context = context
        self._loc = loc
        self._item = item

    def read(self, parts: Mapping[str, PartSyntax]) -> Transparency | None:
        """The transparency, or None where it is not clear."""
        item = self._item
        covered = self._region(parts)
        encoding = self._encoding()
        if encoding is None or not covered:
            return None
        return Transparency(
            first=covered[0],
            last=covered[-1],
            encoding=encoding,
            preset=item.preset or item.encoding,
            lenient=item.lenient,
            about=about(item.doc, item.source, self._context.find_key(self._loc)),
        )

    def _region(self, parts: Mapping[str, PartSyntax]) -> tuple[str, ...]:
        if self._item.covers is None:
            return _between_literals(parts)
        loc = (*self._loc, "covers")
        names = sent_names(parts)
        what = "only bytes on the wire are stuffed"
        covered = sent_run(self._context, parts, self._item.covers, loc, what)
        places = [names.index(name) for name in covered]
        if any(behind - place != 1 for place, behind in pairwise(places)):
            self._context.error("PG138", loc, "the parts under transparency are one run")
        return covered

    def _encoding(self) -> Encoding | None:
        item = self._item
        chosen = [key for key in _KINDS if getattr(item, key) is not None]
        if len(chosen) != 1:
            text = f"a transparency is exactly one of {', '.join(_KINDS)}"
            self._context.error_at_key("PG138", self._loc, text)
            return None
        if item.substitute is not None:
            return self._substitution(item.substitute)
        if item.escape is not None:
            return self._escape(item.escape)
        if item.preset is not None:
            return SLIP if item.preset == "slip" else HDLC
        return Base16() if item.encoding == "base16-upper" else Cobs()

    def _substitution(self, table: tuple[tuple[int | bytes, bytes], ...]) -> Encoding | None:
        single = tuple((byte, word) for byte, word in table if isinstance(byte, int))
        several = [(run, word) for run, word in table if isinstance(run, bytes)]
        if several:
            return self._insertion(*several[0], is_alone=len(table) == 1)
        for byte, count in Counter(byte for byte, _ in single).items():
            if count > 1:
                text = f"the byte {byte:02X} stands in the table twice"
                self._context.error_at_key("PG138", (*self._loc, "substitute"), text)
        return Substitution(table=single)

    def _insertion(self, run: bytes, word: bytes, *, is_alone: bool) -> Insertion | None:
        """What puts a byte in behind some others, if that can be undone."""
        code, hint = "PG247", f"write `{_hex(run)}: {_hex(run)} XX`, with one byte behind it"
        if not is_alone:
            text, hint = "a sequence of several bytes stands in a table alone", "keep that one"
        elif len(word) != len(run) + 1 or not word.startswith(run):
            text = f"{_hex(word)} is not {_hex(run)} and one byte more"
        elif self._item.lenient:
            text = "a receiver that takes a sequence alone could not tell it from a stuffed one"
            hint = "remove `lenient`"
        elif ending := beginning_in(run, run[1:]):
            code, text = "PG248", f"{_hex(run)} begins and ends with {_hex(ending)}"
            hint = "choose a sequence that can't overlap itself"
        elif ending := beginning_in(run, word[1:]):
            code, text = "PG248", f"{_hex(word)} ends with {_hex(ending)}, which begins the next"
            hint = "choose another byte to put in"
        else:
            return Insertion(sequence=run, byte=word[-1])
        self._context.error_at_key(code, (*self._loc, "substitute"), text, hint)
        return None

    def _escape(self, item: EscapeSyntax) -> Escape:
        if item.byte not in item.of:
            self._context.error(
                "PG139",
                (*self._loc, "escape", "of"),
                f"the escape byte 0x{item.byte:02X} is not escaped itself",
                "add it to `of`, or a receiver takes it in the data for an escape",
            )
        match item.transform:
            case "invert":
                xor = 0xFF
            case "none":
                xor = 0
            case _:
                xor = item.transform.xor
        return Escape(byte=item.byte, of=tuple(sorted(set(item.of))), xor=xor)


def beginning_in(run: bytes, data: bytes) -> bytes:
    """The longest beginning of a sequence that the data ends with; empty if there is none."""
    sizes = range(min(len(run), len(data)), 0, -1)
    return next((run[:size] for size in sizes if data.endswith(run[:size])), b"")


def _between_literals(parts: Mapping[str, PartSyntax]) -> tuple[str, ...]:
    """Everything between the literals that open and those that close the frame.

    A choice of literals opens a frame, if it is its first part.
    """
    names = sent_names(parts)
    if names and isinstance(parts[names[0]].literal, LiteralChoice):
        del names[0]
    else:
        while names and isinstance(parts[names[0]].literal, bytes):
            names.pop(0)
    while names and isinstance(parts[names[-1]].literal, bytes):
        names.pop()
    return tuple(names)


def check_codes(context: Context, draft: Draft) -> None:
    """Two inputs never give one output, and a receiver can decode at once."""
    checked: set[Loc] = set()
    for sender, frame in draft.frames.items():
        loc = context.frames[sender].transparency_loc
        if frame.transparency is None or loc in checked:
            continue
        checked.add(loc)
        code = code_of(frame.transparency.encoding)
        if code is not None:
            is_table = isinstance(frame.transparency.encoding, Substitution)
            _check(context, code, (*loc, "substitute" if is_table else "escape"))


def _check(context: Context, code: Mapping[int, bytes], loc: Loc) -> None:
    witness = ambiguity(code)
    if witness is not None:
        one, other, output = witness
        context.error(
            "PG140",
            loc,
            f"this can't be undone: {_hex(one)} and {_hex(other)} both become {_hex(output)}",
            "list every byte that begins a sequence, or choose sequences that differ",
        )
        return
    clash = prefix_clash(code)
    if clash is not None:
        short, long = sorted(clash, key=lambda byte: len(code[byte]))
        text = f"what stands for {short:02X} begins what stands for {long:02X}"
        context.error("PG141", loc, f"{text}, so a receiver can't decode at once")


def _hex(data: bytes) -> str:
    return data.hex(" ").upper() or "nothing"
