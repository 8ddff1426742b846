"""Changes with what they mean: a rule, who is affected, how, and a frame that shows it."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from enum import StrEnum
from fnmatch import fnmatchcase

import msgspec

from protogen.copying import replace
from protogen.evolution.change import Change
from protogen.evolution.compare import Comparison, compare
from protogen.evolution.rules import BY_NAME, ORDER, RULES, Category, Rule
from protogen.evolution.witness import Witness, Witnesses
from protogen.model.protocol import Protocol

SHOWN_BY_FRAMES = (Category.WIRE, Category.VALUE)
"""The categories whose findings have a witness."""


_MOST_MESSAGES = 3
"""Messages of a protocol that is gone that are named."""


class Verdict(StrEnum):
    """Ground of a finding's category."""

    PROVED = "proved"
    """A frame shows it, or it follows from the schemas alone."""
    BOUNDED = "bounded"
    """No frame shows it with each value at each of its bounds, which proves no safety."""
    SEARCHED = "searched"
    """No frame shows it among samples, which proves no safety."""


class Finding(msgspec.Struct, frozen=True):
    """A change and its consequences."""

    change: Change
    rule: Rule
    verdict: Verdict
    witnesses: tuple[Witness, ...] = ()

    @property
    def category(self) -> Category:
        """The rule's: that no frame was found that shows a change does not make it harmless."""
        return self.rule.category

    @property
    def affected(self) -> str:
        """Sides that are affected."""
        if self.category is Category.NONE:
            return "nobody"
        if self.category in SHOWN_BY_FRAMES and not self.witnesses:
            return "both" if self.verdict is Verdict.PROVED else "unknown"
        old_sends = any(item.old_sends for item in self.witnesses)
        new_sends = any(not item.old_sends for item in self.witnesses)
        if old_sends and new_sends:
            return "both"
        if old_sends:
            return "new receiver of old frames"
        return "old receiver of new frames" if new_sends else "code"

    @property
    def harm(self) -> str:
        """Harm that is done, the worst first."""
        if self.category is Category.NONE:
            return "nothing"
        if self.category in SHOWN_BY_FRAMES and not self.witnesses:
            return "misread" if self.verdict is Verdict.PROVED else "not shown"
        order = ["misread", "rejected", "lost"]
        found = sorted({item.harm.value for item in self.witnesses}, key=order.index)
        return ", ".join(found) or "recompile"


class Gate(msgspec.Struct, frozen=True):
    """Selection of rules: names or categories to use, rules to except, places to ignore."""

    use: tuple[str, ...] = ("WIRE", "VALUE")
    except_: tuple[str, ...] = ()
    ignore: Mapping[str, Sequence[str]] = msgspec.field(default_factory=dict)
    """Rules, or `*`, with patterns of places."""

    def unknown(self) -> list[str]:
        """Names that are neither a rule nor a category."""
        known = {rule.name for rule in RULES} | {category.value for category in Category} | {"*"}
        return [name for name in (*self.use, *self.except_, *self.ignore) if name not in known]

    def stops(self, change: Change, protocol: str) -> bool:
        """True if a change of a protocol may not pass."""
        rule = BY_NAME[change.rule]
        if rule.category is Category.NONE or rule.name in self.except_:
            return False
        if not ({rule.name, rule.category.value} & set(self.use)):
            return False
        patterns = [*self.ignore.get("*", ()), *self.ignore.get(rule.name, ())]
        places = (change.place, *change.places)
        return not all(
            any(_matches(place, protocol, pattern) for pattern in patterns) for place in places
        )

    def unused(self, comparisons: Sequence[Comparison]) -> list[str]:
        """What is to be ignored and is in none of the comparisons, as it is written."""
        return [
            pattern if rule == "*" else f"{rule}={pattern}"
            for rule, patterns in self.ignore.items()
            for pattern in patterns
            if not any(
                rule in ("*", change.rule) and _matches(place, comparison.old.name, pattern)
                for comparison in comparisons
                for change in comparison.changes
                for place in (change.place, *change.places)
            )
        ]


def _matches(place: str, protocol: str, pattern: str) -> bool:
    """True if a pattern is the protocol's name, or fits a place, alone or behind that name."""
    names = (place, f"{protocol}.{place}")
    return pattern == protocol or any(fnmatchcase(name, pattern) for name in names)


def findings(
    old: Protocol, new: Protocol, gate: Gate | None = None
) -> tuple[Comparison, list[Finding]]:
    """Compare two versions; the worst comes first.

    With a gate, only what it stops. Findings of the categories WIRE and VALUE have a witness, or a
    verdict that says that none was found.
    """
    comparison = compare(old, new)
    witnesses = Witnesses(comparison)
    kept = [item for item in comparison.changes if gate is None or gate.stops(item, old.name)]
    found = [_finding(change, witnesses) for change in kept]
    found.sort(key=lambda item: ORDER[item.category])
    return comparison, found


def gone(old: Protocol, place: str, gate: Gate | None = None) -> tuple[Comparison, list[Finding]]:
    """Changes of a protocol whose schema is gone: nobody reads its frames any more.

    `place` is the path of the schema.
    """
    nothing = replace(old, senders=(), messages=(), files=(), spec_hash="")
    names = [message.name for message in old.messages[:_MOST_MESSAGES]]
    more = " ..." if len(names) < len(old.messages) else ""
    words = f"{old.name} had {', '.join(names)}{more}"
    change = Change(rule="schema-deleted", place=place, text=words)
    comparison = Comparison(old, nothing, {}, {}, (change,))
    if gate is not None and not gate.stops(change, old.name):
        return comparison, []
    return comparison, [_finding(change, Witnesses(comparison))]


def _finding(change: Change, witnesses: Witnesses) -> Finding:
    rule = BY_NAME[change.rule]
    if rule.category not in SHOWN_BY_FRAMES or not rule.by_frame:
        return Finding(change, rule, Verdict.PROVED)
    found = tuple(witnesses.of(change))
    if found:
        return Finding(change, rule, Verdict.PROVED, found)
    is_bounded = witnesses.tries_all_bounds(change)
    return Finding(change, rule, Verdict.BOUNDED if is_bounded else Verdict.SEARCHED)


def worst(found: Iterable[Finding]) -> Category:
    """The gravest category among findings."""
    return min((item.category for item in found), key=ORDER.__getitem__, default=Category.NONE)
