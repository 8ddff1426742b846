"""Findings as text, Markdown and JSON."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from itertools import groupby
from pathlib import Path
from typing import Any

from protogen.evolution.compare import Comparison
from protogen.evolution.findings import Finding
from protogen.evolution.places import places_of

_MOST_PLACES = 3
"""Other places of the same change that are named."""


def title(finding: Finding) -> str:
    """The finding in one line."""
    change = finding.change
    more = change.places[:_MOST_PLACES]
    others = f" (also {', '.join(more)}{' ...' if len(change.places) > len(more) else ''})"
    return f"{change.place}: {finding.rule.about}: {change.text}{others if more else ''}"


def place(comparison: Comparison, finding: Finding) -> str:
    """The lines in NEW and in OLD, as far as it is there."""
    old, new = places_of(comparison, finding.change)
    sides = {"new": new, "old": old}
    found = {side: span for side, span in sides.items() if span is not None}
    return ", ".join(f"{Path(s.file).name}:{s.line} ({side})" for side, s in found.items())


def shared(
    reports: Sequence[tuple[str, Comparison, Sequence[Finding]]],
) -> Iterator[tuple[str, Comparison, list[Finding], list[str]]]:
    """Findings of several schemas, each once, by the schema that is first to have it.

    A dialect has those of its base again. The last are the other schemas that share the findings.
    """
    owners: dict[object, list[int]] = {}
    for number, (_, comparison, found) in enumerate(reports):
        for item in found:
            owners.setdefault(_source(number, comparison, item), []).append(number)
    for number, (name, comparison, found) in enumerate(reports):
        groups: dict[tuple[int, ...], list[Finding]] = {}
        for item in found:
            first, *others = owners[_source(number, comparison, item)]
            if first == number:
                groups.setdefault(tuple(others), []).append(item)
        for numbers, items in groups.items():
            yield name, comparison, items, [reports[other][0] for other in numbers]


def _source(number: int, comparison: Comparison, item: Finding) -> object:
    """What makes two findings one: the change, and the lines that it comes from."""
    places = places_of(comparison, item.change)
    lines = tuple(None if s is None else (Path(s.file).name, s.line) for s in places)
    where = lines if any(lines) else number
    return item.rule.name, item.change.place, item.change.text, where


def by_subject(found: Sequence[Finding]) -> Iterator[tuple[str, list[Finding]]]:
    """The findings of each message; those of the whole come first."""
    ordered = sorted(found, key=lambda item: item.change.message or "")
    for subject, items in groupby(ordered, key=lambda item: item.change.message or ""):
        yield subject, list(items)


def markdown(comparison: Comparison, found: Sequence[Finding]) -> str:
    """A changelog entry."""
    lines = [f"### {comparison.new.name}", ""]
    for subject, items in by_subject(found):
        lines += [f"- **{subject or 'frame and protocol'}**"]
        for item in items:
            lines += [f"  - {title(item)} ({item.category}, {item.harm})"]
            lines += [f"    - {witness.words}" for witness in item.witnesses]
    if not found:
        lines += ["No change."]
    return "\n".join([*lines, ""])


def as_json(comparison: Comparison, found: Sequence[Finding]) -> dict[str, Any]:
    """The findings for programs."""
    return {
        "protocol": comparison.new.name,
        "old": comparison.old.spec_hash,
        "new": comparison.new.spec_hash,
        "findings": [_finding(comparison, item) for item in found],
    }


def _finding(comparison: Comparison, item: Finding) -> dict[str, Any]:
    change = item.change
    places = places_of(comparison, change)._asdict()
    return {
        "rule": item.rule.name,
        "category": item.category.value,
        "verdict": item.verdict.value,
        "place": change.place,
        "places": list(change.places),
        "lines": {side: None if s is None else s.line for side, s in places.items()},
        "message": change.message,
        "text": change.text,
        "affects": item.affected,
        "harm": item.harm,
        "fix": item.rule.fix,
        "witnesses": [
            {
                "sends": "old" if witness.old_sends else "new",
                "sender": witness.sender,
                "message": witness.message,
                "frame": witness.frame.hex(),
                "harm": witness.harm.value,
                "sent": dict(witness.sent.values),
                "received": dict(witness.received.values),
                "received_message": witness.received.message,
                "why": witness.received.why,
                "words": witness.words,
            }
            for witness in item.witnesses
        ],
    }
