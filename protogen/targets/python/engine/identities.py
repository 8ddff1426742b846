"""Tables of identities: which function reads the payloads behind each."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from functools import partial

from protogen.model.frame_plan import EndRule
from protogen.model.identities import Identities, Runs
from protogen.model.part_plans import IdentityGroup
from protogen.model.parts import VirtualPart
from protogen.targets.python.engine.frames import EngineFrame
from protogen.targets.python.engine.lines import Constants, Lines
from protogen.targets.python.engine.numbers import FrameFunction
from protogen.targets.python.engine.place import Place
from protogen.targets.python.literals import octets_in_class, tuple_of


def header(frame: EngineFrame, constants: Constants) -> tuple[str, ...]:
    """The body of `_head_SENDER(head)`: what a cutter remembers by the bytes with all numbers.

    These are the numbers themselves, and the entry of their identity in the table of kinds.
    """
    return _Header(frame, Lines(constants)).body()


def kinds(frame: EngineFrame) -> str:
    """Table in which identities are looked up: readers, or with them the payload's size.

    Where that varies, it is negative: the complement of the greatest.
    """
    return _table(_entries(item.told_by, partial(_kind, frame, item)) for item in frame.plan.groups)


def virtual_bytes(frame: EngineFrame, part: VirtualPart) -> str:
    """Table of the bytes of a part that is not sent, by identity."""
    values = next(item.values for item in frame.plan.virtual if item.part == part)

    def octets(number: int, _: tuple[str, ...]) -> str:
        return octets_in_class(part.encode(number))

    return _table(_entries(key, partial(octets, number)) for key, number in values)


def _table(entries: Iterable[str]) -> str:
    return "\n".join(["{", *(f"    {entry}," for entry in entries), "}"])


def _entries(identities: Identities, value: Callable[[tuple[str, ...]], str]) -> str:
    """Entries of a table; `value` is what belongs to an identity, given as expressions."""
    if identities.count == 1:
        identity = tuple(map(str, identities.first))
        return f"{identity_key(identities.first)}: {value(identity)}"
    names = tuple(f"part{index}" for index in range(len(identities.runs)))
    key = names[0] if len(names) == 1 else tuple_of(names)
    loops = [
        f"        for {name} in {_values(runs)}"
        for name, runs in zip(names, identities.runs, strict=True)
    ]
    entry = f"        {key}: {value(names)}"
    return "\n".join(["**{", entry, *loops, "    }"])


def _values(runs: Runs) -> str:
    """The values of an identity part, as an expression."""
    if len(runs) == 1 and runs[0][0] < runs[0][1]:
        return f"range(0x{runs[0][0]:02X}, 0x{runs[0][1] + 1:02X})"
    values = (
        f"0x{first:02X}" if first == last else f"*range(0x{first:02X}, 0x{last + 1:02X})"
        for first, last in runs
    )
    return tuple_of(values)


def _kind(frame: EngineFrame, group: IdentityGroup, identity: tuple[str, ...]) -> str:
    reader = reader_of(frame, group)
    if frame.plan.is_fitted:
        return f"({group.own}, {reader})"
    if frame.plan.length is not None:
        return reader
    size = ~group.greatest if group.fixed is None else group.fixed
    if frame.lists_frame_sizes:
        size += frame.plan.head_size + frame.plan.tail_size + len(frame.plan.end_bytes)
    if frame.plan.end_rule is EndRule.IDENTITY and frame.shows_identity:
        return f"({size}, {reader}, {tuple_of(identity)})"
    return f"({size}, {reader})"


def entry(frame: EngineFrame, identity: list[str]) -> str:
    """The table's entry for these numbers: with a length, None for an identity that has none.

    With a payload that is filled up or cut it is the size that it gets, and what reads it then.
    """
    key = identity[0] if len(identity) == 1 else tuple_of(identity)
    kinds = f"_{frame.sender.name.upper()}_KINDS"
    if frame.plan.is_fitted:
        return f"{kinds}.get({key}, (0, None))"
    return f"{kinds}[{key}]" if frame.plan.length is None else f"{kinds}.get({key})"


def reader_of(frame: EngineFrame, group: IdentityGroup) -> str:
    """The name of the function that reads an identity's payloads."""
    if len(group.messages) == 1:
        return f"_read_{group.messages[0].name}"
    # Begun in another way than those of messages: one of them may be called `host_77`.
    return f"_choose_{frame.sender.name}_{'_'.join(map(str, group.identity))}"


def identity_key(identity: tuple[int, ...]) -> str:
    """An identity as a key: a number, or several."""
    if len(identity) == 1:
        return f"0x{identity[0]:02X}"
    return tuple_of(f"0x{value:02X}" for value in identity)


class _Header(FrameFunction):
    """Writes the body of the function that reads a head."""

    def body(self) -> tuple[str, ...]:
        frame = self.frame
        assert frame.remembered is not None
        first, _ = frame.remembered
        found = {
            part: self.number_at("head", part, Place("", frame.offset(part) - first))
            for part in frame.shown
        }
        identity = [found[part] for part in self.plan.identity]
        spread = "*" if self.plan.length is None or self.plan.is_fitted else ""
        self.lines.add(f"return {tuple_of(found.values())}, {spread}{entry(frame, identity)}")
        return self.lines.text
