"""Examples for a schema that was drawn, made of frames that its codec and the reference make."""

from __future__ import annotations

import copy
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

from hypothesis import strategies as st

from protogen.model.messages import Message
from protogen.model.protocol import Sender
from schema_fuzzing import forms

Data = dict[str, Any]


@dataclass(frozen=True, slots=True)
class Sent:
    """A frame of a message, with the values that it was made of, and its payload."""

    sender: Sender
    message: Message
    values: Data
    parts: Data
    frame: bytes
    payload: bytes
    wrong: str
    """Why a decoder takes no frame with a byte more; empty if it takes one."""


@st.composite
def with_examples(draw: st.DrawFn, data: Data, sent: Sequence[Sent]) -> Data:
    """The data with an example of each frame."""
    found = copy.deepcopy(data)
    is_said_once = draw(st.booleans())
    if is_said_once:
        found["content_covers"] = draw(st.sampled_from(["payload", ["payload"]]))
    for number, item in enumerate(sent):
        message = found["messages"][item.message.name]
        example = draw(_example(item, is_said_once=is_said_once))
        message.setdefault("examples", {})[f"example_{number}"] = example
    steps = [
        {"message": item.message.name, "example": f"example_{number}"}
        for number, item in enumerate(sent)
    ]
    found["exchanges"] = {**found.get("exchanges", {}), "exampled": {"steps": steps}}
    return found


@st.composite
def _example(draw: st.DrawFn, item: Sent, *, is_said_once: bool) -> Data:
    example: Data = {**draw(forms.about()), "values": item.values}
    if item.parts:
        sizes = {part.name: part.type.size for part in item.sender.given_parts}
        # In a schema, a text has all of its characters.
        example["parts"] = {
            name: value.ljust(sizes[name], "\0") if isinstance(value, str) else value
            for name, value in item.parts.items()
        }
    if len(item.message.senders) > 1 or draw(forms.one_in(4)):
        example["sender"] = item.sender.endpoint
    if item.sender.form:
        example["form"] = item.sender.form
    # Zeros that are left out are no part of what a document prints.
    if item.sender.frame.payload.kept is None and item.payload and draw(forms.one_in(3)):
        example["content"] = draw(forms.octets(item.payload))
        if not is_said_once or draw(st.booleans()):
            example["covers"] = draw(st.sampled_from(["payload", ["payload"]]))
        return example
    if item.wrong and draw(forms.one_in(4)):
        example["contradicts"] = {"fails": item.wrong, "why": draw(forms.a_text)}
        return {**example, "frame": draw(forms.octets(item.frame + MORE))}
    return {**example, "frame": draw(forms.octets(item.frame))}


MORE = b"\x00"
"""The byte that is too many in a wrong example."""
