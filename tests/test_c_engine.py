"""Generated C as an engine of the fuzzer: in a shared library, and in `protogen fuzz`."""

from __future__ import annotations

import io
from functools import cache
from pathlib import Path
from typing import Any

import pytest
from cli_support import run
from compiled import DOCUMENTS, ROOT, module_at, name_of, protocol_of
from tooling import require_tool

from protogen.fuzzing import c_library
from protogen.fuzzing.c_engine import CEngine
from protogen.fuzzing.c_library import CLibrary, CompileError, find_compiler
from protogen.fuzzing.c_values import Answers, Unfit, pack, unpack
from protogen.fuzzing.engine import Refused
from protogen.fuzzing.python_engine import PythonEngine
from protogen.fuzzing.trips import cases, same, same_events, smallest, try_case
from protogen.targets.c.fuzz_driver.driver import driver_of

SAMPLERS = sorted((ROOT / "tests" / "c_schemas").glob("*.yaml"))
MATTY = ROOT / "schemas" / "matty.yaml"
DAGNY = ROOT / "schemas" / "dagny.yaml"
SAMPLER = ROOT / "tests" / "c_schemas" / "sampler.yaml"


@cache
def engine_of(path: Path) -> CEngine:
    return CEngine(driver_of(protocol_of(path)), require_tool("cc"))


# --- the engine -----------------------------------------------------------------------------------


@pytest.mark.parametrize("path", [*DOCUMENTS, *SAMPLERS], ids=name_of)
def test_every_sample_comes_back_and_is_as_in_python(path: Path) -> None:
    protocol, python = protocol_of(path), PythonEngine(module_at(path).PROTOCOL)
    for case in cases(protocol, 30, 1):
        outcome = try_case(engine_of(path), protocol, case, python)
        assert not outcome.problem, outcome


def test_what_is_out_of_range_is_refused() -> None:
    engine = engine_of(MATTY)
    good = next(case for case in cases(protocol_of(MATTY), 1, 1) if case.message == "go")
    with pytest.raises(Refused, match="out of range"):
        engine.payload("go", good.values | {"speed": 1 << 40})
    with pytest.raises(Refused, match="out of range"):
        engine.frame("pc", "go", good.values, good.parts | {"counter": 256})
    with pytest.raises(ValueError, match="is refused: size"):
        engine.values("go", b"")


def test_a_frame_that_a_decoder_would_cut_elsewhere_is_refused() -> None:
    protocol, engine = protocol_of(DAGNY), engine_of(DAGNY)
    outcomes = [try_case(engine, protocol, case) for case in cases(protocol, 30, 1)]
    assert any(outcome.refused == "no frame can have it" for outcome in outcomes)


def test_events_of_noise() -> None:
    noise = [bytes(range(40)), b"", b"\x55\x02"]
    python = PythonEngine(module_at(MATTY).PROTOCOL)
    for sender in protocol_of(MATTY).senders:
        found = engine_of(MATTY).events(sender.name, noise)
        assert found
        assert same_events(found, python.events(sender.name, noise))


def test_answers_may_be_longer_than_there_is_room_for(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(c_library, "_ROOM", 8)
    engine = CEngine(driver_of(protocol_of(MATTY)), require_tool("cc"))
    assert engine.events("pc", [bytes(1000)]) == engine_of(MATTY).events("pc", [bytes(1000)])


def test_another_frame_than_the_reference_makes_is_a_failure() -> None:
    protocol, engine = protocol_of(MATTY), engine_of(MATTY)

    class Other(PythonEngine):
        def frame(self, sender: str, message: str, values: Any, parts: Any) -> bytes:
            return super().frame(sender, message, values, parts | {"counter": 0})

    other = Other(module_at(MATTY).PROTOCOL)
    (case, *_) = [c for c in cases(protocol, 3, 1, "go") if c.parts["counter"]]
    outcome = try_case(engine, protocol, case, other)
    assert outcome.problem.startswith("another engine, construct, ")
    assert smallest(engine, protocol, outcome, other).problem


def test_c_that_does_not_compile_is_an_error() -> None:
    driver = engine_of(MATTY)._library.driver
    with pytest.raises(CompileError, match="error"):
        CLibrary(driver, require_tool("cc"), ("-std=c99", "-shared", "-fPIC", "-include", "none.h"))


# --- values as bytes ------------------------------------------------------------------------------


@pytest.mark.parametrize("path", [*DOCUMENTS, *SAMPLERS], ids=name_of)
def test_values_survive_being_packed(path: Path) -> None:
    for case in cases(protocol_of(path), 10, 1):
        plan = protocol_of(path).message(case.message).plan
        data = io.BytesIO(pack(plan, case.values))
        found = unpack(plan, Answers(data))
        assert same(found, case.values)
        assert data.read() == b""


@pytest.mark.parametrize(
    ("message", "change"),
    [
        ("counted", {"text": "a" * 300}),
        ("counted", {"points": []}),
        ("counted", {"head": -1}),
        ("floats", {"f32": 1e60}),
        ("filled_bytes", {"data": "00" * 301}),
        ("unknown", {"data": "00" * 31}),
    ],
)
def test_what_no_struct_can_hold_does_not_fit(message: str, change: dict[str, Any]) -> None:
    case = next(case for case in cases(protocol_of(SAMPLER), 1, 1, message))
    with pytest.raises(Unfit):
        pack(protocol_of(SAMPLER).message(message).plan, case.values | change)


def test_an_answer_that_ends_early_is_an_error() -> None:
    with pytest.raises(EOFError, match="1 bytes are missing"):
        Answers(io.BytesIO(b"\0")).take(2)


# --- protogen fuzz --------------------------------------------------------------------------------


def test_all_engines_are_tried() -> None:
    require_tool("cc")
    result = run("fuzz", str(MATTY), "--message", "go", "--examples", "5", "--seed", "7")
    assert result.exit_code == 0
    construct, python, c = result.output.splitlines()
    assert python.startswith("python: ")
    assert construct == python.replace("python: ", "construct: ")
    assert c == python.replace("python: ", "c: ")


def test_without_a_compiler_c_is_not_tried(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(c_library, "_COMPILERS", ("no-such-compiler",))
    assert find_compiler() is None
    result = run("fuzz", str(MATTY), "--message", "go", "--examples", "5", "--seed", "7")
    assert result.exit_code == 0
    assert result.output.splitlines()[0] == (
        "c: there is no C compiler (cc, gcc or clang), so generated C is not tried"
    )


def test_c_that_does_not_compile_is_a_failure(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(c_library, "_FLAGS", ("-no-such-flag",))
    require_tool("cc")
    result = run("fuzz", str(MATTY), "--message", "go", "--examples", "5", "--seed", "7")
    assert result.exit_code == 1
    assert "refuses the generated C" in result.stderr
    assert "no-such-flag" in result.stderr
