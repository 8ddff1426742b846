"""`FORMAT` of generated messages beside construct's own: payloads to containers and back."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from peers import with_construct
from peers.cases import FEW, Case

OURS = "protogen, `FORMAT`"
OF_DICT = "protogen, `FORMAT`, of a `dict`"
Runs = dict[str, Callable[[], list[Any]]]


def parsing(case: Case) -> Runs:
    """Each parses a few payloads into containers. Raises ValueError where they differ."""
    payloads = _payloads(case)
    runs = {name: _each(parse, payloads) for name, (parse, _) in _formats(case).items()}
    wanted = case.rows[:FEW]
    for name, run in runs.items():
        if list(map(case.row, run())) != wanted:
            raise ValueError(f"{name}, {case.title}: other values than the reference's")
    return runs


def building(case: Case) -> Runs:
    """Each builds a few payloads of containers, and ours of dicts. Raises as `parsing` does."""
    payloads = _payloads(case)
    items = [case.kind.FORMAT.parse(payload) for payload in payloads]
    runs = {name: _each(build, items) for name, (_, build) in _formats(case).items()}
    runs[OF_DICT] = _each(case.kind.FORMAT.build, [dict(item) for item in items])
    for name, run in runs.items():
        if run() != payloads:
            raise ValueError(f"{name}, {case.title}: other bytes than the reference's")
    return runs


def _each(call: Callable[[Any], Any], items: list[Any]) -> Callable[[], list[Any]]:
    return lambda: [call(item) for item in items]


def _payloads(case: Case) -> list[bytes]:
    return [bytes(message.to_payload()) for message in case.messages[:FEW]]


def _formats(case: Case) -> dict[str, tuple[Callable[[bytes], Any], Callable[[Any], bytes]]]:
    ours, plain = case.kind.FORMAT, with_construct.STRUCTS[case.message]
    found: dict[str, Any] = {OURS: (ours.parse, ours.build)}
    for name, layout in (
        (with_construct.INTERPRETED, plain),
        (with_construct.COMPILED, plain.compile()),
    ):
        found[name] = (with_construct.parser(case, layout), with_construct.builder(case, layout))
    return found
