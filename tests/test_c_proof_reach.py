"""Each function of generated C is reached by a proof, but for those that are named here."""

from __future__ import annotations

import re
from pathlib import Path

import pytest
from c_proof.drivers import push_driver
from c_proof.generated import Generated, generate
from c_proof.others import others_driver
from c_proof.reached import functions_of, reached
from c_proof.sending import send_driver
from compiled import DIALECTS, DOCUMENTS, name_of, protocol_of
from test_c_contracts import contracts_of
from test_c_proof import decode_driver_of

from protogen.targets.c.options import EVENTS, COptions, Events

LEFT = {
    "writers of frames, which are proved of other schemas": re.compile(
        r"_(?:begin|end|get|set|set_at)$"
    ),
}
"""What is proved of some protocols, but not of each."""


def proved_in(made: Generated) -> set[str]:
    """Functions that programs for EVA reach, and those whose contracts say that they are safe."""
    assert made.source is not None
    header, source = (path.read_text(encoding="utf-8") for path in (made.header, made.source))
    drivers = (
        decode_driver_of(made),
        send_driver(made.protocol, header, source, stuffs_great=True),
        push_driver(made.protocol, header, feeds=True, loads=True),
        others_driver(made.protocol, header, source),
    )
    found = set().union(*(reached(made, driver.text) for driver in drivers))
    return found | set(contracts_of(made).safe)


@pytest.mark.parametrize("events", EVENTS)
@pytest.mark.parametrize("path", [*DOCUMENTS, *DIALECTS], ids=name_of)
def test_each_function_is_reached_by_a_proof(path: Path, events: Events, tmp_path: Path) -> None:
    made = generate(protocol_of(path), tmp_path, COptions(events=events))
    functions = {name for name in functions_of(made) if name.startswith(f"{made.protocol.name}_")}
    missed = functions - proved_in(made)
    left = {name for name in missed for ends in LEFT.values() if ends.search(name)}
    assert sorted(missed - left) == []
    assert len(functions) > 50


@pytest.mark.parametrize("path", DOCUMENTS, ids=name_of)
def test_a_function_that_nothing_calls_is_missed(path: Path, tmp_path: Path) -> None:
    made = generate(protocol_of(path), tmp_path)
    assert made.source is not None
    name = made.protocol.name
    with made.source.open("a", encoding="utf-8") as file:
        file.write(f"\nint {name}_alone(void) {{\n    return 0;\n}}\n")
    assert functions_of(made).keys() - proved_in(made) >= {f"{name}_alone"}
