"""Step of a schema's version that its changes need, in the words of semantic versioning."""

from __future__ import annotations

from collections.abc import Iterable
from enum import StrEnum

from protogen.evolution.change import Change
from protogen.evolution.compare import Comparison
from protogen.evolution.rules import BY_NAME, Category


class Step(StrEnum):
    """Part of a version that has to be raised."""

    MAJOR = "major"
    """The other end of the wire misreads or loses something."""
    MINOR = "minor"
    """Both ends go on; code or documents change."""
    NONE = "none"


def step_of(changes: Iterable[Change]) -> Step:
    """The step that changes need."""
    categories = {BY_NAME[change.rule].category for change in changes}
    if categories & {Category.WIRE, Category.VALUE}:
        return Step.MAJOR
    return Step.MINOR if categories else Step.NONE


def advice(comparison: Comparison) -> str | None:
    """The step that a schema needs, in words; None where it is taken, or nothing changed."""
    step = step_of(comparison.changes)
    old, new = comparison.old.version, comparison.new.version
    is_unsaid = step is Step.MINOR and new is None
    if step is Step.NONE or is_unsaid or _is_taken(step, old, new):
        return None
    stated = "" if new is None else f"; `version` is {new}" + ("" if new == old else f", was {old}")
    return f"this needs a new {step} version{stated}"


def _is_taken(step: Step, old: str | None, new: str | None) -> bool:
    """True if one version is so much greater than the other; below 1.0 a minor one may break."""
    before, after = _numbers(old), _numbers(new)
    if before is None or after is None:
        return False
    is_major = after[0] > before[0] or (before[0] == after[0] == 0 and after[1] > before[1])
    return is_major if step is Step.MAJOR else after > before


def _numbers(version: str | None) -> tuple[int, ...] | None:
    """Major, minor and patch; None where the version is none of semantic versioning."""
    words = (version or "").removeprefix("v").split(".")
    if not all(word.isdecimal() for word in words):
        return None
    return (*map(int, words), 0, 0)[:3]
