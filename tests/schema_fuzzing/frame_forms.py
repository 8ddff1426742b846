"""Several forms of frame on one line, out of frames that were drawn."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from hypothesis import strategies as st

from schema_fuzzing import forms
from schema_fuzzing.frames import FramePlan

NAMES = (
    "short_form", "wide_form", "signed_form", "old_form", "second_form", "jumbo", "v2", "for",
    "plain",
)  # fmt: skip
_EVERY_BYTE = frozenset(range(256))
_HELD = ("literal", "choice", "length")
"""Roles of parts of which a receiver takes no other values than the schema allows."""


@dataclass(frozen=True, slots=True)
class Drawn:
    """A frame that was drawn, and whose it is: a sender's, or that of all."""

    sender: str
    plan: FramePlan


@dataclass(frozen=True, slots=True)
class Form:
    """A form of frame, with its name."""

    name: str
    drawn: Drawn
    is_behind: bool
    """True if nothing tells its frames from those of a form above."""


def named(frames: Sequence[Drawn]) -> list[Form]:
    """The frames as forms, without those that do not go together with one above."""
    kept: list[Form] = []
    for drawn in frames:
        above = [form.drawn.plan for form in kept if form.drawn.sender == drawn.sender]
        if not all(_kind_of_start(plan) == _kind_of_start(drawn.plan) for plan in above):
            continue
        if above and _kind_of_start(drawn.plan) is None:
            continue
        told = [_are_told_apart(plan, drawn.plan) for plan in above]
        if None not in told:
            kept.append(Form(NAMES[len(kept)], drawn, False in told))
    return kept


def _kind_of_start(plan: FramePlan) -> object:
    """What has to be the same in all forms; None goes with no other."""
    is_idle = plan.silence is not None
    closing = b"".join(plan.parts[index].literal for index in plan.closing)
    accepted = any("unprotected" in plan.parts[index].data for index in plan.closing)
    if plan.opening:
        return None if closing in plan.words_at(plan.opening) else ("marked", is_idle)
    if plan.starts_with_set and len(plan.parts[0].values[0]) == len(_EVERY_BYTE):
        return None  # The range leaves none out.
    if plan.starts_with_set:
        return None if closing else ("marked", is_idle)  # The end may tell more.
    return ("behind", closing, accepted) if closing else ("anywhere", is_idle)


def _are_told_apart(one: FramePlan, other: FramePlan) -> bool | None:
    """True if some byte at the beginning is never the same; None if that was not worked out."""
    pairs = list(zip(_beginning(one), _beginning(other), strict=False))
    known = [(first, second) for first, second in pairs if first and second]
    if any(first.isdisjoint(second) for first, second in known):
        return True
    return False if len(known) == len(pairs) else None


def _beginning(plan: FramePlan) -> Iterator[frozenset[int]]:
    """Values of each byte in front of stuffing and payload; none of what was not worked out."""
    for index, part in enumerate(plan.parts):
        if part.role == "payload" or (plan.region is not None and index >= plan.region.first):
            return
        if "bits" in part.data or part.role == "mirror":
            yield from (frozenset[int](),) * part.size
        elif part.role in _HELD or (index == 0 and plan.starts_with_set):
            yield from part.values
        else:
            yield from (_EVERY_BYTE,) * part.size


# --- as they are written ------------------------------------------------------------------------


def written(
    draw: st.DrawFn, found: Sequence[Form], senders: Sequence[str], decision: str
) -> dict[str, Any]:
    """The forms in the schema language."""
    result: dict[str, Any] = {}
    for form in found:
        plan, data = form.drawn.plan, dict[str, Any]()
        if form.drawn.sender:
            data["from"] = draw(st.sampled_from([form.drawn.sender, [form.drawn.sender]]))
        elif draw(st.booleans()):
            data["from"] = list(senders)
        if draw(forms.one_in(4)):
            data["title"] = draw(forms.a_text)
        data.update(draw(forms.about()))
        data["frame"] = plan.data()
        if (stuffing := plan.transparency()) is not None:
            data["transparency"] = stuffing
        if plan.limit is not None:
            data["max_frame"] = plan.limit
        if form.is_behind:
            data["behind"] = decision
        result[form.name] = data
    return result


def restrict(
    draw: st.DrawFn,
    found: Sequence[Form],
    messages: dict[str, Any],
    free: Sequence[str],
    senders: Sequence[str],
) -> None:
    """Name the forms that carry some of the messages, where not all do; none is left without."""
    before = {name: dict(message) for name, message in messages.items()}
    for name in free:
        message = messages[name]
        own_senders = [message["from"]] if isinstance(message["from"], str) else message["from"]
        chosen: list[str] = []
        for sender in own_senders:
            own = [form.name for form in found if form.drawn.sender in ("", sender)]
            chosen += draw(st.lists(st.sampled_from(own), min_size=1, unique=True))
        if draw(forms.one_in(3)):
            listed = list(dict.fromkeys(chosen))
            message["forms"] = listed[0] if len(listed) == 1 and draw(st.booleans()) else listed
    if any(_is_unused(form, sender, messages) for form in found for sender in senders):
        messages.update(before)


def _is_unused(form: Form, sender: str, messages: Mapping[str, Any]) -> bool:
    """True if the sender has the form, and sends no message in it."""
    return form.drawn.sender in ("", sender) and not any(
        sender in ([item["from"]] if isinstance(item["from"], str) else item["from"])
        and form.name in item.get("forms", form.name)
        for item in messages.values()
    )
