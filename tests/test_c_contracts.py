"""WP proves what EVA can't see in generated decoders, as it does not keep two numbers together.

An event has a message only with a payload of which `load` can read all that it reads, and what
takes frames whole out of a buffer stays in it. The contracts are put into the C as comments
(`c_proof/contracted.py`), and are proved one function at a time. EVA shows the rest
(`test_c_proof.py`): that the payload of each event is there, and that `dispatch` does nothing wrong
with any that a contract allows.
"""

from __future__ import annotations

import re
from pathlib import Path

import pytest
from c_proof.contracted import contracted
from c_proof.contracts import Contracts
from c_proof.generated import Generated, generate
from c_proof.portable import portable
from c_proof.wp import Proof, prove_contracts
from compiled import DIALECTS, DOCUMENTS, ROOT, name_of, protocol_of

PROVED = [path for path in (*DOCUMENTS, *DIALECTS) if not path.stem.startswith("uherobot")]
"""Those of which EVA does not see all. Of uherobot it does: no array has a size of its own, and its
decoders take frames byte by byte."""


def contracts_of(made: Generated) -> Contracts:
    assert made.source is not None
    header, source = (path.read_text(encoding="utf-8") for path in made.files)
    return contracted(made.protocol, header, source)


def prove(
    made: Generated, contracts: Contracts, only: tuple[str, ...] = (), *, patience: int = 60
) -> Proof:
    """Prove the contracts of all functions, or of some; `patience` is for each goal, in seconds."""
    assert made.source is not None
    made.header.write_text(contracts.header, encoding="utf-8")
    made.source.write_text(contracts.source, encoding="utf-8")
    functions = only or contracts.functions
    return prove_contracts(
        made.source, functions, made.folder, safe=contracts.safe, patience=patience
    )


@pytest.mark.parametrize("path", PROVED, ids=name_of)
def test_events_can_be_loaded_and_whole_frames_stay_in_their_buffer(
    path: Path, tmp_path: Path
) -> None:
    made = generate(protocol_of(path), tmp_path)
    contracts = contracts_of(made)
    feeds = [name for name in contracts.functions if name.endswith("_feed")]
    assert len(feeds) == len(made.protocol.senders)
    proof = prove(made, contracts)
    assert proof.failed == ()
    assert proof.goals > 100


@pytest.mark.parametrize("path", PROVED, ids=name_of)
def test_contracts_are_comments(path: Path, tmp_path: Path) -> None:
    """Beside what is said of them: copies of words, a mask, and the call of the handler."""
    made = generate(protocol_of(path), tmp_path)
    assert made.source is not None
    contracts = contracts_of(made)
    added = (
        r"^ *//@ .*\n|^/\*@ .*\*/\n|^/\*@\n(?:.*\n)*?\*/\n"
        r"|^static \w+ (?:read_|write_|\w+_application).*;\n"
    )
    plain = re.sub(added, "", contracts.source, flags=re.MULTILINE)
    plain = re.sub(r"\w+_application\(", "decoder->handler(", plain)
    before = portable(made.source.read_text(encoding="utf-8"))
    assert [*filter(str.strip, plain.splitlines())] == [*filter(str.strip, before.splitlines())]
    assert contracts.header == made.header.read_text(encoding="utf-8")


# --- faults that have to be seen ------------------------------------------------------------------


@pytest.mark.parametrize(
    ("document", "before", "after", "function"),
    [
        ("dagny", "size > 128U", "size > 129U", "dagny_bump_check"),
        ("rflex", "size - at > 246U", "size - at > 249U", "rflex_sonar_data_check"),
        ("rn1", "if (size != at)", "if (size < at)", "rn1_maintenance_check"),
        ("rn1", "size != 2U ? RN1_SIZE", "size > 2U ? RN1_SIZE", "rn1_host_identify"),
        (
            "rflex",
            "event.payload_size = decoder->payload;",
            "event.payload_size = (uint16_t)(decoder->payload + 1U);",
            "rflex_flex_complete",
        ),
        ("rn1", "size < 722U ||", "size < 721U ||", "rn1_brain_take_whole"),
        ("rn1", "index < size; index++", "index <= size; index++", "rn1_is_high"),
        ("matty", "size - from >= 8U", "size - from >= 7U", "matty_pc_unstuff_to"),
        ("matty", "need - at >= 8U", "need - at >= 7U", "matty_pc_unstuff_to"),
        ("matty", "if (from == size) {", "if (from > size) {", "matty_pc_unstuff_one"),
        ("matty", "left > 121U", "left > 122U", "matty_pc_measure_head"),
        (
            "matty",
            "while (index < size) {",
            "while (index <= size) {",
            "matty_pc_decoder_feed",
        ),
        ("rflex", "size - wire < 2U", "size - wire < 1U", "rflex_flex_take_whole"),
    ],
)
def test_a_bound_that_is_wrong_by_one_is_found(
    document: str, before: str, after: str, function: str, tmp_path: Path
) -> None:
    path = ROOT / "schemas" / f"{document}.yaml"
    made = generate(protocol_of(path), tmp_path)
    contracts = contracts_of(made)
    assert before in contracts.body(function)
    contracts.change(function, contracts.body(function).replace(before, after))
    assert prove(made, contracts, (function,), patience=2).failed
