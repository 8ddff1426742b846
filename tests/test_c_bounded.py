"""A bounded model checker finds nothing that could go wrong where EVA does not see enough.

`decode` is given each payload of up to some bytes more than the greatest. Of a decoder, each step
is looked at, from every state in which something holds that also holds behind the step: so any
number of bytes is safe.
"""

from __future__ import annotations

import re
from dataclasses import dataclass
from pathlib import Path

import pytest
from c_proof.bounded import Between, Harness, decode_harness, step_harness, whole_harness
from c_proof.esbmc import Verdict, check
from c_proof.generated import Generated, generate
from compiled import ROOT, protocol_of
from tooling import PROVE_ALL

SMALL = ROOT / "tests" / "c_proof"
DECODES = [
    ("bounded/chosen", "entries", 6),
    ("bounded/chosen", "lines", 8),
    ("bounded/chosen", "fixed", 6),
    ("bounded/last_bits", "hops", 5),
    ("bounded/last_bits", "notes", 12),
]
"""Schema, message, and a pass more than any loop needs."""

ALONE = """
        decoder->wire == decoder->next && decoder->content == decoder->wire &&
        decoder->behind == 0U && decoder->content < decoder->limit &&
        (decoder->content >= {head}U && decoder->flags == {upper}_KNOWN
            ? decoder->limit == {around}U + decoder->payload && decoder->limit <= {most}U
            : decoder->limit == {most}U &&
              (decoder->content < {head}U
                  ? decoder->flags == 0U
                  : decoder->flags == {upper}_MEASURING && decoder->due > decoder->content &&
                    decoder->group < {groups}U))"""
"""A candidate whose payload alone tells how long it is, between an identity and a sum."""
TOLD = """
        decoder->wire == decoder->next && decoder->content == decoder->wire &&
        decoder->behind == 0U && decoder->payload <= {most}U - 4U &&
        decoder->content < decoder->payload + 4U"""
"""A candidate behind a start, with a length, an identity and a sum of a byte."""
ENDS = " && ".join(
    f"(decoder->content <= {i} || (decoder->ends[{max(i - 1, 0)}] <= decoder->ends[{i}]"
    f" && decoder->ends[{i}] <= decoder->passed))"
    for i in range(13)
)
COUNTED = f"""
        decoder->wire == decoder->next && decoder->passed == decoder->wire &&
        decoder->behind == 0U && decoder->wire < {{most}}U && decoder->content <= decoder->wire &&
        decoder->limit == {{most}}U && (decoder->flags & {{upper}}_KNOWN) == 0U &&
        {ENDS}"""
"""A candidate whose length counts what is sent: bytes of content end one behind the other."""


@dataclass(frozen=True)
class Steps:
    """A decoder, and what holds of a candidate for a frame between two of its steps."""

    path: str
    sender: str
    unwind: int
    taking: str = ALONE
    seeking: str = "decoder->next == 0U"
    """Nothing marks a start, so that one is looked for in front of the first byte only."""
    loads: bool = False
    """Whether messages of events are loaded."""
    around: tuple[int, int] = (1, 1)
    """Bytes in front of the payload, and behind it."""


STEPS = [
    Steps("schemas/terminated", "device", 10),
    Steps("schemas/last_elements", "device", 10),
    Steps("bounded/last_bits", "device", 12),
    Steps("bounded/digits_around", "device", 11, around=(2, 2)),
    Steps("bounded/greatest", "device", 11),
    Steps("bounded/trimmed", "device", 11, TOLD, "true", loads=True),
    Steps("bounded/counted_wire", "device", 15, COUNTED, "decoder->match <= decoder->next"),
]

WHOLE = [("bounded/trimmed", 13), *[("bounded/escaped", 15)] * PROVE_ALL]
"""Frames taken whole: of payloads that are filled up, and stuffed ones: these take long."""


def made_of(path: str, folder: Path) -> Generated:
    """The C of a schema of this folder."""
    return generate(protocol_of(SMALL / f"{path}.yaml"), folder)


def texts(made: Generated) -> tuple[str, str]:
    """Header and source, as they are now."""
    assert made.source is not None
    return made.header.read_text(encoding="utf-8"), made.source.read_text(encoding="utf-8")


def prove(made: Generated, harness: Harness, unwind: int) -> Verdict:
    """Look at a program for the C of a schema."""
    made.header.write_text(harness.header, encoding="utf-8")
    source = made.folder / "harness.c"
    source.write_text(harness.text, encoding="utf-8")
    return check(source, made.folder, unwind)


def prove_decode(made: Generated, message: str, unwind: int) -> Verdict:
    """Give `decode` each small payload."""
    return prove(made, decode_harness(made.protocol, *texts(made), message), unwind)


def prove_whole(made: Generated, unwind: int) -> Verdict:
    """Feed any bytes to what takes frames whole."""
    return prove(made, whole_harness(made.protocol, *texts(made), "device"), unwind)


def prove_steps(made: Generated, steps: Steps) -> Verdict:
    """Follow each step of a decoder."""
    header, source = texts(made)
    upper = made.protocol.name.upper()
    most = re.search(rf"#define {upper}_{steps.sender.upper()}_FRAME_MAX (\d+)U", header)
    assert most is not None
    head, tail = steps.around
    given = {"upper": upper, "most": most[1], "head": head, "around": head + tail}
    given["groups"] = len(set(re.findall(r"decoder->group = (\d+);", source)))
    taking = steps.taking.format(**given)
    between = Between(taking, steps.seeking)
    harness = step_harness(
        made.protocol, (header, source), steps.sender, between, loads=steps.loads
    )
    return prove(made, harness, steps.unwind)


@pytest.mark.parametrize(("path", "message", "unwind"), DECODES)
def test_no_small_payload_harms_decode(
    path: str, message: str, unwind: int, tmp_path: Path
) -> None:
    verdict = prove_decode(made_of(path, tmp_path), message, unwind)
    assert verdict.found == ()
    assert verdict.claims > 10


@pytest.mark.parametrize("steps", STEPS, ids=lambda steps: Path(steps.path).name)
def test_no_step_of_a_decoder_harms_or_loses_what_holds(steps: Steps, tmp_path: Path) -> None:
    verdict = prove_steps(made_of(steps.path, tmp_path), steps)
    assert verdict.found == ()
    assert verdict.claims > 50


@pytest.mark.parametrize(("path", "unwind"), WHOLE)
def test_no_bytes_harm_what_takes_frames_whole(path: str, unwind: int, tmp_path: Path) -> None:
    verdict = prove_whole(made_of(path, tmp_path), unwind)
    assert verdict.found == ()
    assert verdict.claims > 50


# --- faults that have to be seen ------------------------------------------------------------------


def changed(path: Path | None, pattern: str, replacement: str) -> None:
    """Change a generated file."""
    assert path is not None
    after, count = re.subn(pattern, replacement, path.read_text(encoding="utf-8"))
    assert count, f"{path.name} has no {pattern}"
    path.write_text(after, encoding="utf-8")


@pytest.mark.parametrize(
    ("path", "message", "unwind", "pattern", "fault"),
    [
        ("bounded/chosen", "lines", 8, r"n_2 > 2U", "n_2 > 3U"),
        ("bounded/chosen", "fixed", 6, r"size != 6U", "size != 5U"),
        ("bounded/last_bits", "hops", 5, r"count == 3U", "count == 4U"),
    ],
)
def test_a_check_that_is_wrong_by_one_is_found(
    path: str, message: str, unwind: int, pattern: str, fault: str, tmp_path: Path
) -> None:
    made = made_of(path, tmp_path)
    changed(made.source, pattern, fault)
    verdict = prove_decode(made, message, unwind)
    assert any("bounds" in found for found in verdict.found), verdict.found


@pytest.mark.parametrize(
    ("path", "message", "unwind", "member", "room"),
    [
        ("bounded/chosen", "lines", 8, "lines", 3),
        ("bounded/last_bits", "hops", 5, "hops", 3),
    ],
)
def test_an_array_that_is_too_small_by_an_element_is_found(
    path: str, message: str, unwind: int, member: str, room: int, tmp_path: Path
) -> None:
    made = made_of(path, tmp_path)
    changed(made.header, rf"\b{member}\[{room}\];", f"{member}[{room - 1}];")
    verdict = prove_decode(made, message, unwind)
    assert any("bounds" in found for found in verdict.found), verdict.found


@pytest.mark.parametrize(
    ("name", "in_header", "pattern", "fault", "found"),
    [
        ("last_elements", True, r"buffer\[9\];", "buffer[8];", "bounds"),
        ("last_elements", False, r"(payload_size = decoder->payload);", r"\1 + 2U;", "bounds"),
        ("trimmed", False, r"filled\[6\] = ", "filled[5] = ", "bounds"),
        ("trimmed", False, r"length > 6U\)", "length > 7U)", "holds"),
        ("counted_wire", False, r"(event.payload_size = decoder->payload);", r"\1 + 9U;", "bounds"),
        ("digits_around", False, r"\(uint8_t\)\(2U \+ need\)", "(uint8_t)(1U + need)", "holds"),
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
