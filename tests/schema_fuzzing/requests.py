"""Exchanges that say which message answers which."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from typing import Any

from hypothesis import strategies as st

from schema_fuzzing import forms
from schema_fuzzing.messages import MessagePlan

_INTEGER = re.compile(r"[us]int[0-9]+")
_TIMES = ("100 ms", "1.5 s", "500us")


@st.composite
def requests(
    draw: st.DrawFn, root: Mapping[str, Any], found: Sequence[MessagePlan]
) -> dict[str, Any] | None:
    """An exchange of one sender's message with those of another; None where there is none."""
    asking = [item for item in found if len(item.senders) == 1]
    request = draw(st.sampled_from(asking)) if asking else None
    answers = [item for item in asking if request and item.senders != request.senders]
    if request is None or not answers or draw(forms.one_in(4)):
        return None
    least = min(len(answers), draw(st.sampled_from((1, 2, 2, 2))))
    chosen = draw(st.lists(st.sampled_from(answers), min_size=least, max_size=3, unique_by=_name))
    replies, refusals = (chosen, []) if draw(forms.one_in(6)) else (chosen[:1], chosen[1:])
    exchange: dict[str, Any] = {
        **draw(forms.about()),
        "request": draw(_one_or_several([request])),
        "reply": draw(_one_or_several(replies)),
    }
    if refusals:
        exchange["refusal"] = draw(_one_or_several(refusals))
    match = draw(_match(root, request, chosen))
    if match is not None:
        exchange["match"] = match
        if refusals and not draw(forms.one_in(4)):
            exchange["unmatched_refusal"] = True
    if draw(st.booleans()):
        exchange["timeout"] = draw(st.sampled_from(_TIMES))
    if draw(st.booleans()):
        exchange["retries"] = draw(st.integers(0, 100))
    return exchange


@st.composite
def _match(
    draw: st.DrawFn, root: Mapping[str, Any], request: MessagePlan, answers: Sequence[MessagePlan]
) -> Any:
    asked, answered = (
        _numbers(root, request),
        set.intersection(*(set(_numbers(root, item)) for item in answers)),
    )
    if not asked or not answered or draw(forms.one_in(4)):
        return None
    both = sorted(answered & set(asked))
    if both and not draw(forms.one_in(4)):
        return draw(st.sampled_from(both))
    return {draw(st.sampled_from(sorted(asked))): draw(st.sampled_from(sorted(answered)))}


def _numbers(root: Mapping[str, Any], message: MessagePlan) -> list[str]:
    """Integer fields that are always there, and counters where all have the same frame."""
    fields = message.data.get("fields")
    listed = fields.items() if isinstance(fields, dict) else ()
    found = [name for name, field in listed if _is_number(field)]
    frame = root.get("frame", {})
    return found + [
        name
        for name, part in frame.items()
        if isinstance(part, dict) and part.get("counter") is True
    ]


def _is_number(field: Any) -> bool:
    if isinstance(field, str):
        return _INTEGER.fullmatch(field) is not None
    type_ = str(field.get("type", ""))
    others = ("count", "const", "until", "fields", "switch", "when")
    return _INTEGER.fullmatch(type_) is not None and not any(key in field for key in others)


def _name(item: MessagePlan) -> str:
    return item.name


def _one_or_several(items: Sequence[MessagePlan]) -> st.SearchStrategy[Any]:
    names = [item.name for item in items]
    return st.sampled_from([names, *(names if len(names) == 1 else ())])
