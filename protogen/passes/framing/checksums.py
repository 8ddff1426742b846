"""Checksums of a frame: parts, or bits of parts."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from typing import NamedTuple

from protogen.copying import replace
from protogen.model.checksums import (
    SIMPLE_ALGORITHMS,
    ChecksumKind,
    ChecksumSpec,
    algorithm_names,
    crc_catalogue,
    find_algorithm,
    variants,
)
from protogen.model.parts import ChecksumPart, Part, PartType
from protogen.model.types import ByteOrder
from protogen.passes.context import Context, Loc, about
from protogen.passes.framing.bit_names import are_whole, holders_of
from protogen.passes.framing.part_digits import no_byte_order, too_few_digits
from protogen.passes.framing.part_runs import written_out
from protogen.problems import hint_for
from protogen.schema.syntax.parts import (
    CrcParameters,
    PartBits,
    SumParameters,
    XorParameters,
)
from protogen.schema.syntax.parts import Part as PartSyntax

ORDER_HINT = "set `byte_order: little` or `big` on the part or the protocol"
_PAYLOAD = "payload"


class _Rule(NamedTuple):
    """What is summed up, and how."""

    algorithm: ChecksumSpec
    covers: tuple[str, ...]


class Checksums:
    """The checksums of one frame, whose parts are these."""

    def __init__(
        self,
        context: Context,
        loc: Loc,
        parts: Mapping[str, PartSyntax],
        byte_order: ByteOrder | None,
    ) -> None:
        self._context = context
        self._loc = loc
        self._syntax = parts
        self._names = list(parts)
        self._byte_order = byte_order
        self.replaced = 0
        """Errors of checksums that another one stands for."""

    def whole(self, name: str, item: PartSyntax, type_: PartType) -> Part:
        """The checksum; any other of its size serves where the rest of the frame is asked about."""
        before = self._context.tally.errors
        part = self._whole(name, item, type_)
        if part is not None and self._context.tally.errors == before:
            return part
        self.replaced += self._context.tally.errors - before
        plain = SIMPLE_ALGORITHMS[0]
        return ChecksumPart(name=name, type=type_, algorithm=plain, covers=(_PAYLOAD,))

    def _whole(self, name: str, item: PartSyntax, type_: PartType) -> ChecksumPart | None:
        loc = (*self._loc, name)
        rule = self._rule(loc, item)
        if rule is None:
            return None
        algorithm = rule.algorithm
        if algorithm.words is None:
            no_byte_order(self._context, loc, item, type_)
        else:
            own = type_.byte_order if type_.text is None else item.byte_order
            algorithm = replace(algorithm, words=self._word_order(loc, own))
        if algorithm.width != type_.bits:
            text = f"{algorithm.name} has {algorithm.width} bits, {item.type} has {type_.bits}"
            self._context.error("PG135", (*loc, "type"), text)
        elif algorithm.bounds[1] > type_.greatest:
            too_few_digits(self._context, loc, item, algorithm.name, algorithm.bounds[1])
        if item.when is not None and self._is_in_front(name):
            text = "in front of the payload, a receiver can't know yet whether it is empty"
            hint = "put the checksum behind the payload"
            self._context.error("PG131", (*loc, "when"), text, hint)
        return ChecksumPart(
            name=name,
            type=type_,
            algorithm=algorithm,
            covers=rule.covers,
            over_wire=item.over == "wire",
            when_payload=item.when is not None,
            about=about(item.doc, item.source, self._context.find_key(loc)),
        )

    def bits(self, loc: Loc, item: PartBits, type_: PartType) -> ChecksumPart | None:
        """The checksum, or some bits of one, that bits of a part are; None where it is none."""
        rule = self._rule(loc, item)
        if rule is None:
            return None
        algorithm = rule.algorithm
        if algorithm.words is not None:
            own = self._syntax[str(loc[len(self._loc)])].byte_order
            algorithm = replace(algorithm, words=self._word_order(loc, own))
        if not self._takes(loc, item, algorithm, type_):
            return None
        return ChecksumPart(
            name=str(loc[-1]),
            type=type_,
            algorithm=algorithm,
            covers=rule.covers,
            lowest=0 if item.takes is None else item.takes[0],
            about=about(item.doc, item.source, self._context.find_key(loc)),
        )

    def _takes(self, loc: Loc, item: PartBits, algorithm: ChecksumSpec, type_: PartType) -> bool:
        """True if as many bits of the result are meant as these bits are; else it is reported."""
        name, width, place = loc[-1], algorithm.width, (*loc, "takes")
        if item.takes is None:
            if width != type_.bits:
                text = f"{algorithm.name} has {_bits(width)}, and `{name}` has {type_.bits}"
                hint = f"say which of them stand here: `takes: 0..{type_.bits - 1}`"
                place, hint_ = (*loc, "algorithm"), hint if width > type_.bits else None
                self._context.error("PG135", place, text, hint_)
            return width == type_.bits
        low, high = item.takes
        if low > high:
            text = f"{low}..{high} is no run of bits"
            hint = f"write `{high}..{low}`: the lower bit stands first"
            self._context.error("PG293", place, text, hint)
            return False
        if high >= width:
            text = f"`takes` names bit {high}, and {algorithm.name} ends with {width - 1}"
            self._context.error("PG293", place, text)
            return False
        if high - low + 1 != type_.bits:
            text = f"`{name}` has {_bits(type_.bits)}, and `takes` names {high - low + 1}"
            self._context.error("PG293", place, text)
            return False
        return True

    def _word_order(self, loc: Loc, own: ByteOrder | None) -> ByteOrder:
        """The order of the bytes in the words of a sum: that of the part, unless it has none."""
        order = own or self._byte_order
        if order is None:
            text = "nothing says in which order the bytes of the words are that are added"
            self._context.error("PG109", (*loc, "algorithm"), text, ORDER_HINT)
        return order or "little"

    def _is_in_front(self, name: str) -> bool:
        names = self._names
        return _PAYLOAD in names and names.index(name) < names.index(_PAYLOAD)

    # --- what is summed up, and how ----------------------------------------------------------

    def _rule(self, loc: Loc, item: PartSyntax | PartBits) -> _Rule | None:
        algorithm = self._algorithm(loc, item)
        covers = self._covers(loc, item)
        return None if algorithm is None or covers is None else _Rule(algorithm, covers)

    def _algorithm(self, loc: Loc, item: PartSyntax | PartBits) -> ChecksumSpec | None:
        place = (*loc, "algorithm")
        if item.algorithm is not None and not isinstance(item.algorithm, str):
            return self._parameters(place, item.algorithm)
        found = find_algorithm(item.algorithm or "")
        if found is None:
            hint = _close_algorithm(item.algorithm or "") or _algorithms(item)
            text = f"there is no checksum algorithm `{item.algorithm}`"
            self._context.error("PG134", place, text, hint)
        elif others := variants(item.algorithm or ""):
            text = f"`{item.algorithm}` is taken for {found.name}, and others are called so, too"
            hint = f"write the whole name of the one that is meant: {', '.join(others)}"
            self._context.warning("PG126", place, text, hint)
        return found

    def _parameters(
        self, loc: Loc, given: CrcParameters | SumParameters | XorParameters
    ) -> ChecksumSpec | None:
        found = _spec_of(given)
        for key in ("poly", "init", "xorout", "mask", "add"):
            if (getattr(given, key, None) or 0) >> found.width:
                text = f"`{key}` has more than {found.width} bits"
                self._context.error("PG135", (*loc, key), text)
                return None
        if found.words is not None and found.width not in (16, 32):
            key = "words" if isinstance(given, SumParameters) else "xor"
            text = f"words have 16 or 32 bits, and {found.kind} has {found.width}"
            self._context.error("PG135", (*loc, key), text)
            return None
        return found

    def _summed(self, written: Sequence[str], place: Loc) -> tuple[str, ...]:
        """The parts of a run that go into a sum; one that names another part is reported."""
        told = {name for name, item in self._syntax.items() if item.told}
        named = (name for item in written for name in item.split(".."))
        for name in dict.fromkeys(name for name in named if name in told):
            text = f"`{name}` is told: it has no bytes on the wire, and a checksum sums up bytes"
            self._context.error("PG231", place, text, "name parts that are sent")
        found = written_out(self._context, self._names, written, place)
        return tuple(name for name in found if name not in told)

    def _covers(self, loc: Loc, item: PartSyntax | PartBits) -> tuple[str, ...] | None:
        name, holder = str(loc[-1]), str(loc[len(self._loc)])
        if item.covers is None:
            text = f"`{name}` does not say what it covers"
            self._context.error_at_key("PG131", loc, text, "add `covers: FIRST..LAST`")
            return None
        place = (*loc, "covers")
        if not are_whole(self._context, holders_of(self._syntax), item.covers, place):
            return None
        covers = self._summed(item.covers, place)
        if holder in covers:
            where = "itself" if holder == name else f"`{holder}`, which has its bits"
            self._context.error("PG136", place, f"the checksum `{name}` covers {where}")
        return covers


def _bits(count: int) -> str:
    return "1 bit" if count == 1 else f"{count} bits"


def _spec_of(given: CrcParameters | SumParameters | XorParameters) -> ChecksumSpec:
    """The algorithm of these parameters; the order of bytes in its words is the part's."""
    if isinstance(given, CrcParameters):
        return ChecksumSpec(name="CRC", kind="crc", **given.model_dump())
    kind: ChecksumKind = "sum" if isinstance(given, SumParameters) else "xor"
    parameters = given.model_dump()
    width = parameters.pop(kind)
    in_words = parameters.pop("words", width > 8)
    return ChecksumSpec(
        name=kind, kind=kind, width=width, words="little" if in_words else None, **parameters
    )


def _close_algorithm(name: str) -> str | None:
    """One name that was probably meant; where it may be several, all of them are listed."""
    if re.fullmatch(r"crc\W*\d*", name.casefold()):
        return None
    return hint_for(name, [known for known in algorithm_names() if not variants(known)])


def _algorithms(item: PartSyntax | PartBits) -> str:
    """The algorithms that there are, by name; of CRCs those of the width that is asked for."""
    width = re.search(r"crc\D*(\d+)", str(item.algorithm).casefold())
    folded = [spec.name for spec in SIMPLE_ALGORITHMS if spec.is_folded_byte]
    others = [spec.name for spec in SIMPLE_ALGORITHMS if spec.kind == "fletcher"]
    names = [*folded, "each of these with 16 or 32 bits", *others]
    family = "" if width is None else f"CRC-{width[1]}/"
    names += [spec.name for spec in crc_catalogue() if family and spec.name.startswith(family)]
    crcs = "each CRC by its name in the catalogue, such as CRC-16/KERMIT, or by parameters"
    return f"there are {', '.join(names)}, and {crcs}"
