"""A bounded model checker finds nothing that could go wrong in a decoder of all forms.

It keeps a candidate of each form, which reads the same bytes. Each step is looked at, from every
state in which something holds of each candidate, that also holds behind the step. Where a decoder
waits for a byte it has room for it.
"""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import pytest
from c_proof.bounded import Between, step_harness
from c_proof.esbmc import Verdict
from c_proof.generated import Generated
from test_c_bounded import changed, made_of, prove, texts

CANDIDATE = """
        {c}.buffer == decoder->buffer && {c}.wire <= decoder->next && {c}.wire <= {most}U &&
        {c}.behind <= {c}.wire &&
        ({c}.verdict == {upper}_NO_REASON
            ? {c}.wire == decoder->next && {c}.wire < {most}U && {c}.behind == 0U && {undecided}
            : {c}.verdict != {upper}_FRAME ||
              ({c}.behind == 0U && {frame} && reads_{form}(&{c})))"""
"""A candidate that needs more bytes has seen all that were read. A frame has those of its parts."""
TOLD = """
              {c}.content == {c}.wire && {c}.payload <= {most}U &&
              {c}.content < {c}.payload + {around}U"""
"""A length tells how much payload there is; until it has come there may be the most."""
ENDED = """
              {c}.payload <= {most}U &&
              ({c}.end_left == 0U
                  ? {c}.content == {c}.wire && {c}.content < {c}.payload + {around}U
                  : {c}.content == {c}.payload + {around}U && {c}.content == {c}.wire &&
                    {c}.end_left == 1U)"""
"""The same, where an end of a byte is due behind the last part."""
IDENTIFIED = """
              {c}.content == {c}.wire && {c}.content < {c}.limit &&
              ({c}.content >= 1U && {c}.flags == {upper}_KNOWN
                  ? {c}.limit == {around}U + {c}.payload && {c}.limit <= {most}U
                  : {c}.limit == {most}U &&
                    ({c}.content < 1U
                        ? {c}.flags == 0U
                        : {c}.flags == {upper}_MEASURING && {c}.due > {c}.content &&
                          {c}.group == 1U))"""
"""An identity tells it, or the fields of the payload, one after another."""
BOUNDED = """
              {c}.content <= {c}.wire && {c}.content <= {c}.limit && {c}.limit <= {most}U &&
              (({c}.flags & {upper}_KNOWN) == 0U ||
               ({c}.content > 0U && {c}.limit == {around}U + {c}.payload))"""
"""An identity tells it, or an end. There is no more content than was read, or than there may be."""
WHOLE = "{c}.payload + {around}U <= {c}.wire"
"""It is in the buffer."""
UNSTUFFED = "{c}.payload + {around}U == {c}.content && {c}.content <= {most}U"
"""It is in room of its own."""

AHEAD = "decoder->next == 0U || decoder->next < decoder->count"
"""Bytes that begin no frame are forgotten."""


@dataclass(frozen=True)
class Form:
    """A form of frame, and what holds of its candidate."""

    name: str
    most: int
    """Bytes at which a candidate is given up."""
    around: int
    """Bytes in front of the payload and behind it, without an end."""
    undecided: str = TOLD
    frame: str = WHOLE


@dataclass(frozen=True)
class Steps:
    """A decoder of all forms, and what holds between two of its steps."""

    path: str
    endpoint: str
    unwind: int
    forms: tuple[Form, ...]
    seeking: str = AHEAD
    lost: str = "false"


HELD = f"{{c}}.held <= 1U && {{c}}.content + {{c}}.held <= {{c}}.wire &&{BOUNDED}"
"""The first byte of an end of two waits for the second one."""
FLAGGED = f"{UNSTUFFED} && {{c}}.wire > 0U && decoder->buffer[{{c}}.wire - 1U] == 0x7EU"
"""Its end begins the next one."""
FIRST = "decoder->next == 0U"
"""Nothing marks a start, so that one is looked for in front of the first byte only."""
STEPS = [
    Steps(
        "bounded/two_forms",
        "station",
        10,
        (Form("plain", 7, 4), Form("ended", 9, 4, ENDED)),
    ),
    Steps(
        "bounded/forms_starts",
        "board",
        10,
        (Form("brief", 8, 4), Form("long", 7, 5)),
    ),
    Steps(
        "bounded/forms_anywhere",
        "board",
        8,
        (Form("brief", 6, 3), Form("alone", 6, 3, IDENTIFIED)),
        FIRST,
    ),
    Steps(
        "bounded/forms_silent",
        "board",
        8,
        (Form("short", 7, 2, BOUNDED), Form("long", 7, 4, BOUNDED)),
        FIRST,
    ),
    Steps(
        "bounded/forms_lines",
        "board",
        9,
        (
            Form("plain", 8, 2, HELD, UNSTUFFED),
            Form("bare", 6, 1, HELD, UNSTUFFED),
        ),
        FIRST,
        AHEAD,
    ),
    Steps(
        "bounded/forms_zeros",
        "board",
        7,
        (
            Form("short", 6, 2, BOUNDED, UNSTUFFED),
            Form("bare", 5, 1, BOUNDED, UNSTUFFED),
        ),
        FIRST,
        AHEAD,
    ),
    Steps(
        "bounded/forms_flags",
        "board",
        10,
        (
            Form("short", 9, 3, BOUNDED, FLAGGED),
            Form("bare", 8, 2, BOUNDED, FLAGGED),
        ),
    ),
]


def condition(form: Form, upper: str) -> str:
    """What holds of a candidate."""
    given = {"c": f"decoder->form_{form.name}", "upper": upper, "form": form.name}
    sizes = {"most": form.most, "around": form.around}
    parts = {"undecided": form.undecided, "frame": form.frame}
    texts = {name: text.format(**given, **sizes) for name, text in parts.items()}
    return CANDIDATE.format(**given, **sizes, **texts)


def prove_steps(made: Generated, steps: Steps) -> Verdict:
    """Follow each step of a decoder of all forms."""
    upper = made.protocol.name.upper()
    names = tuple(form.name for form in steps.forms)
    waits = (f"decoder->form_{name}.verdict == {upper}_NO_REASON" for name in names)
    conditions = (condition(form, upper) for form in steps.forms)
    taking = f"({' || '.join(waits)}) &&{' &&'.join(conditions)}"
    failed = f"decoder->failed <= {max(form.most for form in steps.forms)}U"
    between = Between(taking, steps.seeking, failed, steps.lost, names)
    harness = step_harness(made.protocol, texts(made), steps.endpoint, between, loads=True)
    return prove(made, harness, steps.unwind)


@pytest.mark.parametrize("steps", STEPS, ids=lambda steps: Path(steps.path).name)
def test_no_step_of_a_decoder_of_all_forms_harms_or_loses_what_holds(
    steps: Steps, tmp_path: Path
) -> None:
    verdict = prove_steps(made_of(steps.path, tmp_path), steps)
    assert verdict.found == ()
    assert verdict.claims > 50


# --- faults that have to be seen ------------------------------------------------------------------


@pytest.mark.parametrize(
    ("name", "in_header", "pattern", "fault", "found"),
    [
        pytest.param(
            *("forms_anywhere", True, r"buffer\[6\];", "buffer[5];", "bounds"),
            id="a buffer that is too small by a byte",
        ),
        pytest.param(
            *("forms_zeros", True, r"unstuffed\[6\];", "unstuffed[5];", "bounds"),
            id="room for content that is too small by a byte",
        ),
        pytest.param(
            *("forms_zeros", False, r"index >= decoder->limit", "index > decoder->limit", "holds"),
            id="content that is bounded a byte too late",
        ),
        pytest.param(
            *("forms_starts", False, r"from < count", "from <= count", "bounds"),
            id="bytes that are moved from behind the buffer",
        ),
        pytest.param(
            *("forms_starts", False, r"(found->payload_size = decoder->payload);", r"\1 + 4U;"),
            "bounds",
            id="an event with more payload than there is",
        ),
        pytest.param(
            *("forms_silent", False, r"decoder->content < 2U", "decoder->content < 1U", "bounds"),
            id="an end of input that takes too little for a frame",
        ),
        pytest.param(
            *("forms_anywhere", False, r"( +)decoder->verdict = \w+_FINE;\n", "", "holds"),
            id="a candidate that begins with the verdict of the one before",
        ),
        pytest.param(
            *("forms_anywhere", False, r"decoder->form_alone\.buffer = decoder->buffer;", ""),
            "holds",
            id="a candidate that does not know the bytes",
        ),
    ],
)
def test_a_step_that_goes_too_far_is_found(
    name: str, in_header: bool, pattern: str, fault: str, found: str, tmp_path: Path
) -> None:
    [steps] = [steps for steps in STEPS if Path(steps.path).name == name]
    made = made_of(steps.path, tmp_path)
    changed(made.header if in_header else made.source, pattern, fault)
    verdict = prove_steps(made, steps)
    assert any(found in text for text in verdict.found), verdict.found
