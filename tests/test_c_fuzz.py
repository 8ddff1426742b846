"""Decoders of generated C under libFuzzer, AddressSanitizer and UndefinedBehaviorSanitizer.

A short run for each document, of the same inputs each time; benchmarks/c_fuzzing.md records a long
one.
"""

from __future__ import annotations

import re
from pathlib import Path

import pytest
from c_proof.generated import generate
from compiled import DOCUMENTS, ROOT, name_of, protocol_of
from fuzz.harness import build, build_from, executions

from protogen.targets.c.options import EVENTS, Events

MATTY = ROOT / "schemas" / "matty.yaml"
RUNS = 10_000


@pytest.mark.parametrize("events", EVENTS)
@pytest.mark.parametrize("path", DOCUMENTS, ids=name_of)
def test_no_input_breaks_a_decoder(path: Path, events: Events, tmp_path: Path) -> None:
    fuzzer = build(protocol_of(path), path, tmp_path, events=events)
    said = fuzzer.run(f"-runs={RUNS}", "-seed=1")
    assert executions(said) >= RUNS


def test_a_seeded_fault_is_found(tmp_path: Path) -> None:
    made = generate(protocol_of(MATTY), tmp_path)
    text = made.header.read_text(encoding="utf-8")
    faulty, count = re.subn(r"uint8_t buffer\[126\];", "uint8_t buffer[100];", text)
    assert count
    made.header.write_text(faulty, encoding="utf-8")
    fuzzer = build_from(made.header, made.protocol, MATTY)
    with pytest.raises(AssertionError, match=r"runtime error|AddressSanitizer"):
        fuzzer.run("-runs=200000", "-seed=1")
