"""Tables of flash, RAM and cycles on small machines: each figure with its ratio to the expert's."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from math import isnan
from typing import TypeVar

from c_costs.cycles import Cycles
from c_costs.measure import Results
from c_costs.memory import Memory
from c_costs.protocols import PROTOCOLS, SMALL_KINDS, TOGETHER, Protocol
from c_costs.toolchains import BUILDS, LTO, ORDINARY

TARGET = 1.15
"""The most that generated C may cost, by the expert's."""
AIMS = {ORDINARY: TARGET, LTO: 1.0}
"""The same of each build: a linker that optimises takes away what an interface costs."""
BYTE = 160
"""Cycles that 1 Mbaud leaves for each byte at 16 MHz: ten bits of 16 cycles."""
NOTHING = "-"
"""Mark for what was not measured."""
TITLES = {ORDINARY: "ordinary", LTO: "`-flto`"}
Figure = TypeVar("Figure")


@dataclass(frozen=True)
class Ratio:
    """A figure of protogen's messages by the expert's."""

    name: str
    value: float
    aim: float = TARGET

    @property
    def is_missed(self) -> bool:
        """True if it is above the aim as it is printed, to two places, or not there."""
        return not round(self.value, 2) <= self.aim


def row(cells: Iterable[object]) -> str:
    return f"| {' | '.join(map(str, cells))} |"


def header(*cells: str, texts: int = 1) -> list[str]:
    """The head of a table whose first columns are texts, and the others numbers."""
    rules = ("---" if index < texts else "---:" for index in range(len(cells)))
    return [row(cells), row(rules)]


def ratio(own: float, other: float) -> str:
    return f"{own / other:.2f}" if other else NOTHING


def messages(protocols: Sequence[Protocol] = PROTOCOLS) -> Iterator[tuple[Protocol, int, str]]:
    for protocol in protocols:
        for which, message in enumerate(protocol.messages):
            yield protocol, which, message


def memory_table(found: Mapping[tuple[str, str, str], Memory]) -> str:
    lines = header("flash / RAM", "build", *SMALL_KINDS.values(), texts=2)
    for protocol in (*PROTOCOLS, TOGETHER):
        for build in BUILDS:
            items = _kinds_of(found, build, protocol)
            if items:
                expert = items["expert"]
                cells = [_memory(items.get(kind), expert) for kind in SMALL_KINDS]
                lines.append(row([protocol.title, TITLES[build], *cells]))
    return "\n".join(lines)


def _kinds_of(
    found: Mapping[tuple[str, str, str], Figure], build: str, protocol: Protocol
) -> dict[str, Figure]:
    keys = {kind: (build, kind, protocol.name) for kind in SMALL_KINDS}
    return {kind: found[key] for kind, key in keys.items() if key in found}


def _memory(item: Memory | None, expert: Memory) -> str:
    if item is None:
        return NOTHING
    text = f"{item.flash:,} / {item.ram:,}"
    if item is expert:
        return text
    return f"{text} ({ratio(item.flash, expert.flash)} / {ratio(item.ram, expert.ram)})"


def cycles_table(found: Mapping[tuple[str, str, str], list[Cycles]]) -> str:
    lines = header("decode / encode", "build", "bytes", *SMALL_KINDS.values(), texts=2)
    for protocol, which, message in messages():
        for build in BUILDS:
            items = _kinds_of(found, build, protocol)
            if items:
                expert = items["expert"][which]
                cells = [
                    _cycles(items[kind][which], expert) if kind in items else NOTHING
                    for kind in SMALL_KINDS
                ]
                title = f"{protocol.label} {message}"
                lines.append(row([title, TITLES[build], f"{expert.bytes:.0f}", *cells]))
    return "\n".join(lines)


def _cycles(item: Cycles, expert: Cycles) -> str:
    text = f"{whole(item.decode)} / {whole(item.encode)}"
    if item is expert:
        return text
    decode = NOTHING if isnan(item.decode) else ratio(item.decode, expert.decode)
    return f"{text} ({decode} / {ratio(item.encode, expert.encode)})"


def whole(value: float) -> str:
    return "fails" if isnan(value) else f"{value:,.0f}"


def bytes_table(results: Results, protocols: Sequence[Protocol] = PROTOCOLS) -> str:
    """Cycles of decoding for each byte of a frame."""
    kinds = ("messages", "expert")
    heads = [f"{SMALL_KINDS[kind]}, {TITLES[build]}" for build in BUILDS for kind in kinds]
    lines = header("cycles a byte", *heads)
    for protocol, which, message in messages(protocols):
        cells: list[str] = []
        for build in BUILDS:
            items = _kinds_of(results.avr_cycles, build, protocol)
            if not items:
                cells += [NOTHING for _ in kinds]
                continue
            own, expert = (items[kind][which] for kind in kinds)
            cells += [
                f"{_per_byte(own)} ({ratio(own.decode, expert.decode)})",
                _per_byte(expert),
            ]
        lines.append(row([f"{protocol.label} {message}", *cells]))
    return "\n".join(lines)


def _per_byte(item: Cycles) -> str:
    return whole(item.decode / item.bytes)


def rover_line(results: Results) -> str:
    """What README.md says of its own protocol."""
    ordinary, linked = (results.avr_cycles[build, "messages", "rover"][0] for build in BUILDS)
    return (
        f"An ATmega328P decodes rover's `state` in {_per_byte(ordinary)} cycles a byte, "
        f"{_per_byte(linked)} with `-flto`; 1 Mbaud at 16 MHz leaves {BYTE}."
    )


def slow_bytes(results: Results) -> str:
    """Messages whose bytes take longer than 1 Mbaud leaves."""
    slow = [
        f"* {protocol.label} {message}, {TITLES[build]}: {_per_byte(item)}"
        for protocol, which, message in messages()
        for build in BUILDS
        for item in [results.avr_cycles[build, "messages", protocol.name][which]]
        if not item.decode / item.bytes <= BYTE
    ]
    return "\n".join(["Above that are:", "", *slow]) if slow else "None is above that."


def ratios(results: Results) -> Iterator[Ratio]:
    """Every figure of protogen's messages on small machines, by the expert's of the same build."""
    for title, found in (("ATmega328P", results.avr), ("Cortex-M0", results.arm)):
        for protocol in (*PROTOCOLS, TOGETHER):
            for build in BUILDS:
                items = _kinds_of(found, build, protocol)
                if items:
                    own, expert = items["messages"], items["expert"]
                    name = f"{title}, {protocol.title}, {TITLES[build]}"
                    yield Ratio(f"{name}: flash", own.flash / expert.flash, AIMS[build])
                    yield Ratio(f"{name}: RAM", own.ram / expert.ram, AIMS[build])
    for title, cycles in (("ATmega328P", results.avr_cycles), ("Cortex-M0", results.arm_cycles)):
        yield from _cycle_ratios(title, cycles)


def _cycle_ratios(
    title: str, found: Mapping[tuple[str, str, str], list[Cycles]]
) -> Iterator[Ratio]:
    for protocol, which, message in messages():
        for build in BUILDS:
            counted = _kinds_of(found, build, protocol)
            if counted:
                mine, other = counted["messages"][which], counted["expert"][which]
                name = f"{title}, {protocol.label} {message}, {TITLES[build]}"
                for what in ("decode", "encode"):
                    value = getattr(mine, what) / getattr(other, what)
                    yield Ratio(f"{name}: cycles to {what}", value, AIMS[build])
