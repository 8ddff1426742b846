"""Names that languages reserve, that generated code has itself, or that come to the same."""

from __future__ import annotations

import inspect
import keyword
import re
import subprocess
import sys
from pathlib import Path

import pytest
from compiled import protocol_of
from tooling import require_tool

from protogen.c_language.words import headers
from protogen.model.protocol import Protocol
from protogen.runtime.api import Encoder, Message
from protogen.runtime.attributes import ARGUMENTS, ATTRIBUTES, attribute, schema_name
from protogen.schema.syntax.base import NAME_PATTERN
from protogen.targets import TARGETS
from protogen.targets.c.emit import emit, unit_of
from protogen.targets.c.options import COptions
from protogen.targets.c.protocol_names import names_of
from protogen.targets.emitted import emitted_names
from protogen.targets.naming import PROTOCOL, NameTable, endpoint, inside, message
from protogen.targets.python.words import words_of_files

SCHEMA = """
protocol: {name}
endpoints: {{{endpoints}}}
frame: {{id: {{type: uint8, id: true}}, payload: {{}}, end: {{literal: 0xC0}}}}
transparency: slip
types: {{{types}}}
messages: {{{messages}}}
"""


def schema(
    folder: Path,
    *messages: str,
    name: str = "demo",
    endpoints: str = "host: Host",
    types: str = "",
) -> Protocol:
    """A schema with these messages, as `name: fields`; the first endpoint sends them."""
    listed = [
        f"{word}: {{id: {number}, from: {sender}, fields: {{{fields}}}}}"
        for number, item in enumerate(messages or ["ping:"])
        for word, _, fields in [item.partition(":")]
        for sender in [endpoints.partition(":")[0]]
    ]
    given = {"name": name, "endpoints": endpoints, "types": types, "messages": ", ".join(listed)}
    path = folder / f"{name}.yaml"
    path.write_text(SCHEMA.format(**given), encoding="utf-8")
    return protocol_of(path)


# --- the words ------------------------------------------------------------------------------------


def test_attributes_are_no_reserved_words_and_hide_no_method() -> None:
    lower = {word for word in keyword.kwlist if word.islower()}
    methods = {name for name in dir(Message) if name.islower() and not name.startswith("_")}
    assert ATTRIBUTES.keys() == lower | methods | {"self"}


def test_arguments_are_no_reserved_words_and_no_parameters_of_an_encoder(tmp_path: Path) -> None:
    lower = {word for word in keyword.kwlist if word.islower()}
    generated = inspect.signature(Encoder.encode_next).parameters.keys() - {"parts"}
    assert ARGUMENTS.keys() == lower | generated | {"sender", "engine", "form"}


def test_an_escaped_name_is_no_name_of_a_schema() -> None:
    for name, escaped in {**ATTRIBUTES, **ARGUMENTS}.items():
        assert re.fullmatch(NAME_PATTERN, name)
        assert not re.fullmatch(NAME_PATTERN, escaped)
        assert schema_name(escaped) == name
    assert attribute("angle") == schema_name("angle") == "angle"


def test_a_module_is_called_like_none_of_the_standard_library() -> None:
    named = {name for name in sys.stdlib_module_names if re.fullmatch(NAME_PATTERN, name)}
    assert named <= {*words_of_files()}


# --- tables ---------------------------------------------------------------------------------------


def test_the_second_thing_of_a_name_is_escaped() -> None:
    table = NameTable(["taken"])
    one, other = message("one"), message("other")
    assert table.add("taken", one) == "taken_"
    assert table.add("taken", other) == "taken__"
    assert table.add("taken", one) == "taken_"
    assert table.add("free", other) == "free"
    assert table.escaped == {one: ["taken_"], other: ["taken__"]}
    copied = table.copy()
    assert copied.add("free", one) == "free_"
    assert table.escaped[one] == ["taken_"]


def test_escapes_are_listed_by_thing_and_language(tmp_path: Path) -> None:
    made = schema(tmp_path, "gyro: class: uint8, long: uint8, lambda: uint8", "result:", "none:")
    assert emitted_names(made).escapes == {
        inside("gyro", "field", "class"): {"C": ("class_",), "Python": ("class_",)},
        inside("gyro", "field", "long"): {"C": ("long_",)},
        inside("gyro", "field", "lambda"): {"Python": ("lambda_",)},
        message("result"): {"C": ("demo_result_",), "C++": ("result_",)},
        message("none"): {"Python": ("None_",)},
    }


# --- files ----------------------------------------------------------------------------------------


@pytest.mark.parametrize("name", ["string", "class", "struct", "threading", "construct"])
def test_a_protocol_may_be_called_like_a_module_or_a_header(name: str, tmp_path: Path) -> None:
    made = schema(tmp_path, "gyro: if: uint8", name=name)
    for target in ("python", "c"):
        for file in TARGETS[target].emit([made]):
            path = tmp_path / target / file.path
            path.parent.mkdir(parents=True, exist_ok=True)
            path.write_bytes(file.bytes)
    # A folder of which the modules are found first, as those beside a script are.
    text = f"import {name}_ as made; print(made.decode(made.encode(made.Gyro(if_=7)), 'host'))"
    command = [sys.executable, "-c", text]
    done = subprocess.run(
        command, cwd=tmp_path / "python", capture_output=True, text=True, check=False
    )
    assert done.stdout == "Gyro(if_=7)\n", done.stderr
    stem = f"{name}_" if f"{name}.h" in {f"{header}.h" for header in headers()} else name
    assert {path.name for path in (tmp_path / "c").glob("*.[ch]")} == {f"{stem}.c", f"{stem}.h"}
    command = [require_tool("cc"), "-I.", "-std=c99", "-Werror", "-c", f"{stem}.c", "-o", "x.o"]
    subprocess.run(command, cwd=tmp_path / "c", check=True)


def test_the_names_of_files_are_listed(tmp_path: Path) -> None:
    escaped = {"C": ("string_",), "C++": ("string_",), "Python": ("string_",)}
    assert emitted_names(schema(tmp_path, name="string")).escapes == {PROTOCOL: escaped}


# --- C --------------------------------------------------------------------------------------------


def test_an_endpoint_is_escaped_as_a_whole(tmp_path: Path) -> None:
    made = schema(tmp_path, endpoints="close: One, close_set: Other")
    text = Path(tmp_path / "demo.yaml").read_text(encoding="utf-8")
    both = text.replace("from: close,", "from: [close, close_set],")
    (tmp_path / "both.yaml").write_text(both, encoding="utf-8")
    made = protocol_of(tmp_path / "both.yaml")
    # Both would have a function `demo_close_set_payload`.
    names = names_of(made)
    assert names.senders == {"close": "demo_close", "close_set": "demo_close_set_"}
    escaped = {"C": ("demo_close_set__decoder",)}
    assert emitted_names(made).escapes == {endpoint("close_set"): escaped}
    header = next(file.text for file in emit([made]) if file.path.name == "demo.h")
    assert "\nstruct demo_close_set__decoder {\n" in header


def test_a_name_does_not_depend_on_what_else_is_printed(tmp_path: Path) -> None:
    made = schema(tmp_path, "m_frame:", "on_m:")
    whole = unit_of(made, COptions()).framing.messages
    assert whole[1].called.function == "demo_on_m_frame_"
    alone = unit_of(made, COptions(only=("on_m",))).framing.messages
    assert [item.called for item in alone] == [whole[1].called]


# --- types that fields hold -----------------------------------------------------------------------


def test_what_fields_hold_is_called_like_nothing_else(tmp_path: Path) -> None:
    mode = "{type: uint8, values: {on: 1}}"
    made = schema(
        tmp_path,
        f"gyro: mode: {mode}, state: {mode}, kind: gyro_state",
        "gyro_mode:",
        "a: b_c: {type: uint8, values: {on: 2}}",
        "a_b: c: {type: uint8, values: {on: 3}}",
        types="gyro_state: {type: uint8, values: {off: 0}}",
    )
    assert [(item.name, item.values[0].value) for item in made.enums] == [
        ("gyro_mode_", 1),
        ("gyro_state_", 1),
        ("gyro_state", 0),
        ("a_b_c", 2),
        ("a_b_c_", 3),
    ]
