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
from tooling import PROVE_ALL

from protogen.targets.c.options import EVENTS, COptions, Events

PROVED = (*DOCUMENTS, *DIALECTS)


def contracts_of(made: Generated) -> Contracts:
    assert made.source is not None
    header, source = (path.read_text(encoding="utf-8") for path in made.files)
    return contracted(made.protocol, header, source)


def prove(
    made: Generated,
    contracts: Contracts,
    only: tuple[str, ...] = (),
    *,
    patience: int = 60,
    named: str = "",
) -> Proof:
    """Prove the contracts of all functions, or of some; `patience` is for each goal, in seconds."""
    assert made.source is not None
    made.header.write_text(contracts.header, encoding="utf-8")
    made.source.write_text(contracts.source, encoding="utf-8")
    functions = only or contracts.functions
    return prove_contracts(
        made.source, functions, made.folder, safe=contracts.safe, patience=patience, named=named
    )


@pytest.mark.parametrize("events", EVENTS)
@pytest.mark.parametrize("path", PROVED, ids=name_of)
def test_events_can_be_loaded_and_whole_frames_stay_in_their_buffer(
    path: Path, events: Events, tmp_path: Path
) -> None:
    made = generate(protocol_of(path), tmp_path, COptions(events=events))
    contracts = contracts_of(made)
    feeds = [name for name in contracts.functions if name.endswith("_feed")]
    assert len(feeds) == len(made.protocol.senders)
    proof = prove(made, contracts)
    assert proof.failed == ()
    assert proof.goals >= 80


_TAKES_DECODER = re.compile(r"\b(\w+_decoder_\w+)\(\s*struct \w+_decoder \*")
_HAS_CONTRACT = re.compile(r"^\*/\n[^;{}()]*\b(\w+)\(", re.MULTILINE)
TAKEN_AS_GIVEN = {
    # It calls the application's handler, which gets the event.
    "messages": re.compile(r"_(?<!_decoder_)dispatch$"),
    # EVA follows it: it writes nothing but the decoder.
    "all": re.compile(r"_decoder_push$"),
}
"""Contracts that are relied upon, but not proved."""
BY_EVA = {
    "messages": re.compile(r"(?!)"),
    "all": re.compile(r"_decoder_(?:init|push|flush)$"),
}
"""What changes a decoder without a contract that is proved."""


@pytest.mark.parametrize("events", EVENTS)
@pytest.mark.parametrize("path", PROVED, ids=name_of)
def test_contracts_are_proved_of_all_that_changes_a_decoder(
    path: Path, events: Events, tmp_path: Path
) -> None:
    """So that no contract is relied upon unproved, and none is left out."""
    made = generate(protocol_of(path), tmp_path, COptions(events=events))
    contracts = contracts_of(made)
    text = contracts.header + contracts.source
    proved = set(contracts.functions)
    assert set(contracts.safe) <= proved
    given = set(_HAS_CONTRACT.findall(text)) - proved
    assert given == {name for name in given if TAKEN_AS_GIVEN[events].search(name)}
    assert len(given) == len(made.protocol.senders)
    changing = set(_TAKES_DECODER.findall(text))
    assert {name for name in changing - proved if not BY_EVA[events].search(name)} == set()
    assert len(changing) >= 4 * len(given)


@pytest.mark.parametrize("path", PROVED, ids=name_of)
def test_what_takes_payloads_is_the_same_for_all_events_and_for_messages(
    path: Path, tmp_path: Path
) -> None:
    """So that what EVA shows of `dispatch` and `load` with all events holds of messages alone."""
    takes = re.compile(r"_(?:load|check|dispatch)$")
    sources: list[dict[str, str]] = []
    for events in EVENTS:
        folder = tmp_path / events
        folder.mkdir()
        contracts = contracts_of(generate(protocol_of(path), folder, COptions(events=events)))
        names = re.findall(r"^[a-z][^;{}()\n]*\b(\w+)\([^;{}]*\{", contracts.source, re.MULTILINE)
        kept = [name for name in names if takes.search(name) and "_decoder_" not in name]
        sources.append({name: contracts.body(name) for name in kept})
    assert sources[0] == sources[1]
    assert {name.rpartition("_")[2] for name in sources[0]} >= {"load", "dispatch"}


@pytest.mark.parametrize("events", EVENTS)
@pytest.mark.parametrize("path", PROVED, ids=name_of)
def test_contracts_are_comments(path: Path, events: Events, tmp_path: Path) -> None:
    """Beside what is said of them: copies of words, a mask, and the call of the handler."""
    made = generate(protocol_of(path), tmp_path, COptions(events=events))
    assert made.source is not None
    contracts = contracts_of(made)
    added = (
        r"^ *//@ .*\n|^/\*@ .*\*/\n|^/\*@\n(?:.*\n)*?\*/\n"
        r"|^static \w+ (?:read_|write_|\w+_application).*;\n"
    )
    before = portable(made.source.read_text(encoding="utf-8"))
    header = made.header.read_text(encoding="utf-8")
    for annotated, text in ((contracts.source, before), (contracts.header, header)):
        plain = re.sub(added, "", annotated, flags=re.MULTILINE)
        plain = re.sub(r"\w+_application\(", "decoder->handler(", plain)
        assert [*filter(str.strip, plain.splitlines())] == [*filter(str.strip, text.splitlines())]


def never_ends(contracts: Contracts) -> list[str]:
    """Add to each contract that asks for something: it never returns. Callers do not rely on it."""
    asking = []
    for name in contracts.functions:
        head = re.compile(
            rf"^(/\*@\n(?:(?!\*/).*\n)*?)\*/\n(?=[^;{{}}()]*\b{name}\()", re.MULTILINE
        )
        for part in ("header", "source"):
            text = getattr(contracts, part)
            found = head.search(text)
            if found and " requires " in found[1]:
                claim = f"{found[1]}    check ensures never: \\false;\n*/\n"
                setattr(contracts, part, text[: found.start()] + claim + text[found.end() :])
                asking.append(name)
    return asking


CONTRADICTIONS = [
    (path, events)
    for path in DOCUMENTS
    for events in EVENTS
    if PROVE_ALL or (path.stem == "rn1" or (path.stem == "matty" and events == "messages"))
]
"""Where they are looked for: a prover has to give up on each goal, which takes half a minute."""


@pytest.mark.slow
@pytest.mark.parametrize(("path", "events"), CONTRADICTIONS, ids=name_of)
def test_contracts_do_not_contradict_themselves(path: Path, events: Events, tmp_path: Path) -> None:
    """Where a contract, or one of a function that is called, cannot hold, all would be proved."""
    made = generate(protocol_of(path), tmp_path, COptions(events=events))
    contracts = contracts_of(made)
    asking = never_ends(contracts)
    assert sum(name.endswith("_decoder_feed") for name in asking) == len(made.protocol.senders)
    proof = prove(made, contracts, tuple(asking), patience=1, named="never")
    assert proof.goals == len(proof.failed) == len(asking)


def test_a_contract_that_contradicts_itself_is_found(tmp_path: Path) -> None:
    path = ROOT / "schemas" / "rn1.yaml"
    made = generate(protocol_of(path), tmp_path, COptions(events="messages"))
    contracts = contracts_of(made)
    feed = "rn1_brain_decoder_feed"
    never_ends(contracts)
    before = contracts.source
    contracts.source = before.replace("index <= size &&", "index < size && index > size &&")
    assert contracts.source != before
    proof = prove(made, contracts, (feed,), patience=10, named="never")
    assert (proof.goals, proof.failed) == (1, ())


# --- faults that have to be seen ------------------------------------------------------------------


OF_ALL = [
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
]
OF_MESSAGES = [
    ("dagny", "size != 1U ? DAGNY_SIZE", "size > 1U ? DAGNY_SIZE", "dagny_host_identify"),
    ("dagny", "decoder->limit = 514U;", "decoder->limit = 516U;", "dagny_host_find_size"),
    ("dagny", "(uint16_t)(decoder->content - 1U)", "decoder->content", "dagny_host_close_open"),
    ("matty", "(uint8_t)(decoder->limit - 5U)", "decoder->limit", "matty_pc_decoder_event"),
    ("matty", "if (payload == 4U) {", "if (payload >= 4U) {", "matty_pc_complete"),
    ("matty", "if (size > 4U) {", "if (size > 5U) {", "matty_pc_decoder_push"),
    ("rflex", "content[3] != payload", "content[3] > payload", "rflex_linux_head_fits"),
    ("rflex", "size - wire < 2U", "size - wire < 1U", "rflex_linux_take_whole"),
    ("rn1", "limit = 722U;", "limit = 721U;", "rn1_brain_decoder_push"),
    ("rn1", "*payload = 721;", "*payload = 722;", "rn1_brain_measure_head"),
    ("rn1", "if (at >= limit) {", "if (at > limit) {", "rn1_brain_decoder_push"),
    ("rn1", "decoder->payload = payload;", "decoder->payload = at;", "rn1_host_decoder_push"),
    ("rn1", "size - taken,", "size,", "rn1_brain_decoder_dispatch"),
]
FAULTS = [
    *(("all", *fault) for fault in OF_ALL),
    *(("messages", *fault) for fault in OF_MESSAGES),
]


@pytest.mark.parametrize(("events", "document", "before", "after", "function"), FAULTS)
def test_a_bound_that_is_wrong_by_one_is_found(
    events: Events, document: str, before: str, after: str, function: str, tmp_path: Path
) -> None:
    path = ROOT / "schemas" / f"{document}.yaml"
    made = generate(protocol_of(path), tmp_path, COptions(events=events))
    contracts = contracts_of(made)
    assert before in contracts.body(function)
    contracts.change(function, contracts.body(function).replace(before, after))
    assert prove(made, contracts, (function,), patience=2).failed
