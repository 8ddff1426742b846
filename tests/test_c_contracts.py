"""WP proves what EVA can't see in generated decoders, as it does not keep two numbers together.

An event has a message only with a payload of which `load` can read all that it reads, and what
takes frames whole out of a buffer stays in it. The contracts are put into the C as comments
(`c_proof/contracts.py`), and are proved one function at a time. EVA shows the rest
(`test_c_proof.py`): that the payload of each event is there, and that `dispatch` does nothing wrong
with any that a contract allows.
"""

from __future__ import annotations

from pathlib import Path

import pytest
from c_proof.contracts import Contracts, contracted
from c_proof.generated import Generated, generate
from c_proof.wp import Proof, prove_contracts
from compiled import DIALECTS, DOCUMENTS, ROOT, name_of, protocol_of

from protogen.targets.c.options import EVENTS, COptions, Events

VARIED = ("dagny", "rflex", "rn1", "dagny_library", "matty_v4", "rflex_drivers", "rn1_firmware")
"""Of whose events EVA does not see that they can be loaded."""
WHOLE = ("matty",)
"""Of which EVA sees that, but not that frames taken whole stay in the buffer."""
PROVED = [
    (path, events)
    for path in (*DOCUMENTS, *DIALECTS)
    for events in EVENTS
    if path.stem in (*VARIED, *WHOLE)
]


def contracts_of(made: Generated) -> Contracts:
    assert made.source is not None
    header, source = (path.read_text(encoding="utf-8") for path in made.files)
    return contracted(made.protocol, header, source)


def prove(made: Generated, contracts: Contracts, only: tuple[str, ...] = ()) -> Proof:
    assert made.source is not None
    made.header.write_text(contracts.header, encoding="utf-8")
    made.source.write_text(contracts.source, encoding="utf-8")
    functions = only or contracts.functions
    return prove_contracts(made.source, functions, made.folder, safe=contracts.safe)


@pytest.mark.parametrize(("path", "events"), PROVED, ids=name_of)
def test_events_can_be_loaded_and_whole_frames_stay_in_their_buffer(
    path: Path, events: Events, tmp_path: Path
) -> None:
    made = generate(protocol_of(path), tmp_path, COptions(events=events))
    contracts = contracts_of(made)
    feeds = [name for name in contracts.functions if name.endswith("_feed")]
    assert len(feeds) == len(made.protocol.senders)
    proof = prove(made, contracts)
    assert proof.failed == ()
    assert proof.goals > 100


# --- faults that have to be seen ------------------------------------------------------------------


@pytest.mark.parametrize(
    ("document", "events", "before", "after", "function"),
    [
        ("dagny", "all", "size > 128U", "size > 129U", "dagny_bump_check"),
        ("rflex", "all", "size - at > 246U", "size - at > 247U", "rflex_sonar_data_check"),
        ("rn1", "all", "size - at < 3U", "size - at < 2U", "rn1_maintenance_check"),
        ("rn1", "all", "size != 2U ? RN1_SIZE", "size > 2U ? RN1_SIZE", "rn1_host_identify"),
        (
            "rflex",
            "all",
            "event.payload_size = decoder->payload;",
            "event.payload_size = (uint16_t)(decoder->payload + 1U);",
            "rflex_flex_complete",
        ),
        ("rn1", "all", "size < 722U ||", "size < 721U ||", "rn1_brain_take_whole"),
        ("rn1", "all", "index < size; index++", "index <= size; index++", "rn1_is_high"),
        ("matty", "all", "size - from >= 8U", "size - from >= 7U", "matty_pc_unstuff_to"),
        ("matty", "all", "need - at >= 8U", "need - at >= 7U", "matty_pc_unstuff_to"),
        ("matty", "all", "if (from == size) {", "if (from > size) {", "matty_pc_unstuff_one"),
        ("matty", "all", "left > 121U", "left > 122U", "matty_pc_take_whole"),
        (
            "matty",
            "all",
            "while (index < size) {",
            "while (index <= size) {",
            "matty_pc_decoder_feed",
        ),
        ("rflex", "all", "size - wire < 2U", "size - wire < 1U", "rflex_flex_take_whole"),
    ],
)
def test_a_bound_that_is_wrong_by_one_is_found(
    document: str, events: Events, before: str, after: str, function: str, tmp_path: Path
) -> None:
    path = ROOT / "schemas" / f"{document}.yaml"
    made = generate(protocol_of(path), tmp_path, COptions(events=events))
    contracts = contracts_of(made)
    body = contracts.body(function)
    assert before in body if before != "left > 121U" else before in contracts.source
    if before in body:
        contracts.change(function, body.replace(before, after))
    else:
        contracts.source = contracts.source.replace(before, after)
    assert prove(made, contracts, (function,)).failed
