"""Everything that is measured, of all contenders."""

from __future__ import annotations

import sys
from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path

from c_costs.cycles import (
    CORTEX_M0,
    Cycles,
    atmega328p,
    build_counter,
    cycles,
    cycles_apart,
)
from c_costs.memory import Memory, memory, spenders
from c_costs.nanopb import nanopb
from c_costs.protocols import (
    FED_KINDS,
    HAS_SSE2,
    KINDS,
    PROTOCOLS,
    SMALL_KINDS,
    TOGETHER,
    Protocol,
    takes_part,
)
from c_costs.speeds import Speed, speeds
from c_costs.streams import Recovery, recovery, same_bytes, same_messages
from c_costs.toolchains import ARM, AVR, BUILDS, HOST, LTO
from c_costs.workshop import Subject, Workshop

OPENED = ("messages", "expert")
"""Whose functions are listed one by one."""


@dataclass
class Results:
    """Measurements, by kind and protocol; on small machines by build in front of them."""

    avr: dict[tuple[str, str, str], Memory] = field(default_factory=dict)
    arm: dict[tuple[str, str, str], Memory] = field(default_factory=dict)
    avr_cycles: dict[tuple[str, str, str], list[Cycles]] = field(default_factory=dict)
    arm_cycles: dict[tuple[str, str, str], list[Cycles]] = field(default_factory=dict)
    speeds: dict[tuple[str, str], Speed] = field(default_factory=dict)
    """By kind, and protocol and message."""
    recovery: dict[tuple[str, str], Recovery] = field(default_factory=dict)
    spenders: dict[tuple[str, str], list[tuple[str, int]]] = field(default_factory=dict)
    cycle_spenders: dict[tuple[str, str], list[tuple[str, float]]] = field(default_factory=dict)


def measure(workshop: Workshop, rounds: int, seeds: int) -> Results:
    results = Results()
    parts: dict[str, list[Subject]] = {kind: [] for kind in _small_kinds(TOGETHER)}
    counter = build_counter(workshop)
    for protocol in PROTOCOLS:
        small = _small(workshop, protocol)
        same_bytes(workshop, small)
        for kind, subject in small.items():
            _measure_small(workshop, counter, subject, results)
            if kind in OPENED:
                results.spenders[kind, protocol.name] = spenders(workshop, subject)
                found = cycles_apart(workshop, counter, subject)
                results.cycle_spenders[kind, protocol.name] = found
            if protocol.has_peers:
                parts[kind].append(subject)
        _measure_here(workshop, protocol, small, rounds, seeds, results)
    for kind, items in parts.items():
        _measure_memory(workshop, workshop.together(kind, items), results)
    return results


def measure_small(workshop: Workshop, protocols: Sequence[Protocol]) -> Results:
    """Flash, RAM and cycles of protogen and of the expert alone, with the same frames."""
    results = Results()
    counter = build_counter(workshop)
    for protocol in protocols:
        small = _small(workshop, protocol)
        same_bytes(workshop, small)
        for kind in ("messages", "included", "expert", "inlined"):
            _measure_small(workshop, counter, small[kind], results)
    return results


def _small_kinds(protocol: Protocol) -> list[str]:
    kinds = [kind for kind in SMALL_KINDS if takes_part(kind, protocol)]
    return [kind for kind in kinds if kind != "nanopb" or nanopb() is not None]


def _small(workshop: Workshop, protocol: Protocol) -> dict[str, Subject]:
    return {kind: workshop.subject(kind, protocol) for kind in _small_kinds(protocol)}


def _builds(subject: Subject) -> Sequence[str]:
    """Builds that can change anything: a linker inlines what is inlined anyway."""
    in_one_source = subject.kind in ("inlined", "included")
    return [build for build in BUILDS if build != LTO or not in_one_source]


def _measure_small(workshop: Workshop, counter: Path, subject: Subject, results: Results) -> None:
    _measure_memory(workshop, subject, results)
    for build in _builds(subject):
        key = build, subject.kind, subject.protocol.name
        results.avr_cycles[key] = cycles(workshop, atmega328p(counter), build, subject)
        results.arm_cycles[key] = cycles(workshop, CORTEX_M0, build, subject)


def _measure_memory(workshop: Workshop, subject: Subject, results: Results) -> None:
    say(f"{subject.protocol.name}: {subject.kind}")
    for build in _builds(subject):
        key = build, subject.kind, subject.protocol.name
        results.avr[key] = memory(workshop, AVR[build], subject)
        results.arm[key] = memory(workshop, ARM[build], subject)


def _measure_here(
    workshop: Workshop,
    protocol: Protocol,
    small: dict[str, Subject],
    rounds: int,
    seeds: int,
    results: Results,
) -> None:
    """Speed and the messages of noisy streams, on this machine."""
    programs = _programs(workshop, protocol, small)
    say(f"{protocol.name}: the same messages")
    alike = {kind: program for kind, program in programs.items() if kind != "mavlink"}
    same_messages(alike, protocol, seeds)
    for which, message in enumerate(protocol.messages):
        say(f"{protocol.name} {message}: timing")
        for kind, speed in speeds(programs, protocol, which, rounds).items():
            results.speeds[kind, f"{protocol.label} {message}"] = speed
    for kind in KINDS:
        if takes_part(kind, protocol):
            results.recovery[kind, protocol.name] = recovery(programs[kind], small[kind], seeds)


def _programs(workshop: Workshop, protocol: Protocol, small: dict[str, Subject]) -> dict[str, Path]:
    subjects = {kind: small[kind] for kind in KINDS if takes_part(kind, protocol)}
    if HAS_SSE2 and takes_part("sse2", protocol):
        subjects["sse2"] = workshop.subject("sse2", protocol)
        own = small["messages"]
        vector = f"-D{protocol.name.upper()}_SSE2=1"
        subjects["vector"] = replace(own, kind="vector", flags=(*own.flags, vector))
    return {
        kind: workshop.build(HOST, "host", subjects[kind]) for kind in FED_KINDS if kind in subjects
    }


def say(text: str) -> None:
    print(text, file=sys.stderr)
