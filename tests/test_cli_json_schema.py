"""The JSON Schema of schema files: complete, explained, and in step with the loader."""

from __future__ import annotations

import copy
import json
import re
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import jsonschema
import pytest
from typer.testing import CliRunner

from protogen.compiler import compile_file
from protogen.problems import Problems, SourceMap
from protogen.schema.json_schema import json_schema
from protogen.schema.text.document import read_document
from protogen.schema.text.nodes import to_data

ROOT = Path(__file__).resolve().parent.parent
SCHEMAS = sorted((ROOT / "schemas").rglob("*.yaml"))
GOOD = sorted(path for path in (ROOT / "tests").rglob("*.yaml") if "errors" not in path.parts)
RULES = ("allOf", "if", "then", "else")
"""Keys of rules, which restrict keys that are described elsewhere."""

TINY: dict[str, Any] = {
    "protocol": "tiny",
    "endpoints": {"pc": "Computer"},
    "frame": {
        "sync": {"literal": 0x55},
        "id": {"type": "uint8", "id": True},
        "payload": {},
        "crc": {"type": "uint16", "algorithm": "CRC-16/KERMIT", "covers": "id..payload"},
    },
    "messages": {"gyro": {"id": 1, "from": "pc", "fields": {"x": "sint16"}}},
}


@pytest.fixture(scope="module")
def validator() -> jsonschema.Draft7Validator:
    schema = json_schema()
    jsonschema.Draft7Validator.check_schema(schema)
    return jsonschema.Draft7Validator(schema)


def as_editors_read(path: Path) -> Any:
    """Return a schema as JSON data: an editor takes every key for a text."""
    document = read_document(path, Problems(), SourceMap())
    assert document is not None
    return json.loads(json.dumps(to_data(document.root)))


def changed(*path: str, value: Any) -> dict[str, Any]:
    """Return the tiny schema with one value changed or added."""
    schema = copy.deepcopy(TINY)
    place = schema
    for step in path[:-1]:
        place = place[step]
    place[path[-1]] = value
    return schema


@pytest.mark.parametrize("path", SCHEMAS, ids=lambda path: path.stem)
def test_every_schema_is_valid(path: Path, validator: jsonschema.Draft7Validator) -> None:
    assert [error.message for error in validator.iter_errors(as_editors_read(path))] == []


def properties(schema: Any, place: str) -> Iterator[tuple[str, Any]]:
    if isinstance(schema, list):
        for item in schema:
            yield from properties(item, place)
    if not isinstance(schema, dict):
        return
    for name, inner in schema.items():
        if name in RULES:
            continue
        if name == "properties":
            yield from ((f"{place}.{key}", item) for key, item in inner.items())
        yield from properties(inner, f"{place}.{name}")


def test_every_key_is_described() -> None:
    undescribed = [
        place for place, item in properties(json_schema(), "") if not item.get("description")
    ]
    assert undescribed == []
    rules = [
        rule for item in json_schema()["definitions"].values() for rule in item.get("allOf", ())
    ]
    assert [rule for rule in rules if not rule.get("$comment")] == []


def test_it_is_identified() -> None:
    schema = json_schema()
    assert schema["$id"] == "urn:protogen:schema"
    assert schema["title"] == "protogen schema"
    assert all(item.get("title") for item in schema["definitions"].values() if "enum" not in item)


@pytest.mark.parametrize(
    "schema",
    [
        TINY,
        changed("messages", "gyro", "fields", "x", value={"type": "sint16", "unit": "deg"}),
        changed("messages", "gyro", "fields", value="unspecified"),
        changed("messages", "gyro", "from", value=["pc"]),
        changed("messages", "gyro", "source", value="61-65"),
        changed("messages", "gyro", "source", value=61),
        changed("messages", "gyro", "id", value="M"),
        changed("messages", "gyro", "fields", "x", value={"type": "uint8", "count": "fill"}),
        changed("messages", "gyro", "fields", "x", value={"type": "uint8", "const": [1, 2]}),
        changed("messages", "gyro", "fields", "x", value={"type": "uint8", "values": {"on": 1}}),
        changed("messages", "gyro", "fields", "x", value={"type": "uint8", "bits": {"a": "0..3"}}),
        changed("frame", "sync", "literal", value={"hex": "1B 02"}),
        changed("frame", "sync", "literal", value=[0x1B, 2]),
        changed("frame", "id", value={"type": "ascii", "size": 3, "id": True}),
        changed("frame", value={"pc": TINY["frame"]}),
        changed("transparency", value="slip"),
        changed("transparency", value={"substitute": {"27": [27, 0], "28": {"hex": "1B 01"}}}),
        changed("exchanges", value={"start": {"steps": ["gyro", {"message": "gyro"}]}}),
        changed("exchanges", value={"ask": {"request": "gyro", "reply": ["gyro"], "match": "x"}}),
        changed("byte_order", value={"pc": "big"}),
    ],
)
def test_short_and_long_forms_are_valid(
    schema: dict[str, Any], validator: jsonschema.Draft7Validator
) -> None:
    assert [error.message for error in validator.iter_errors(schema)] == []


@pytest.mark.parametrize(
    "schema",
    [
        {key: value for key, value in TINY.items() if key != "messages"},
        changed("colour", value="red"),
        changed("messages", "gyro", "colour", value="red"),
        changed("messages", "Gyro", value=TINY["messages"]["gyro"]),
        changed("messages", "remove", value=["gyro"]),
        changed("messages", "gyro", "fields", "x", value={"type": "uint8", "after": "y"}),
        changed("messages", "gyro", "doc", value=None),
        changed("byte_bits", value=9),
        changed("link", value={"baud": "fast"}),
        changed("link", value={"idle_timeout": 20}),
        changed("link", value={"idle_timeout": "20 min"}),
        changed("exchanges", value={"ask": {"request": "gyro"}}),
        changed("exchanges", value={"ask": {"steps": [], "request": "gyro", "reply": "gyro"}}),
        changed("exchanges", value={"ask": {"request": [], "reply": "gyro"}}),
        changed("exchanges", value={"ask": {"request": "gyro", "reply": "gyro", "timeout": 3}}),
        changed("exchanges", value={"ask": {"steps": ["gyro"], "retries": 1}}),
        changed("messages", value={}),
        changed("messages", "gyro", "id", value="0x10000000"),
        changed("messages", "gyro", "id", value=""),
        changed("messages", "gyro", "from", value="Computer"),
        changed("messages", "gyro", "from", value=[]),
        changed("messages", "gyro", "max_size", value=8),
        changed("messages", "gyro", "examples", value={"a": {"values": {"x": 1}}}),
        changed("messages", "gyro", "examples", value={"a": {"frame": {"hex": "5"}}}),
        changed("frame", "sync", "literal", value=0x1B02),
        changed("frame", "sync", "literal", value={"hex": "1B", "text": "b"}),
        changed("frame", "sync", "type", value="uint8"),
        changed("frame", "id", "type", value="sint8"),
        changed("frame", "id", "type", value="uint8_t"),
        changed("frame", "id", "counter", value=True),
        changed("frame", "id", value={"id": True}),
        changed("frame", "crc", "algorithm", value="CRC-16/MODBSU"),
        changed("frame", "crc", "algorithm", value="CRC16"),
        changed("frame", "crc", "covers", value="id...payload"),
        changed("frame", value={"id": TINY["frame"]["id"]}),
        changed("transparency", value="ppp"),
        changed("transparency", value={"preset": "slip", "encoding": "cobs"}),
        changed("transparency", value={"substitute": {"27": [27, 256]}}),
        changed("types", value={"uint8": "uint16"}),
        changed("overloads", value={"a": {"messages": ["gyro"], "by": "undecidable"}}),
    ],
)
def test_mistakes_are_invalid(
    schema: dict[str, Any], validator: jsonschema.Draft7Validator
) -> None:
    assert list(validator.iter_errors(schema)) != []


@pytest.mark.parametrize(
    "field",
    [
        "int16",
        "u8",
        "uint16[4]",
        "uint65",
        "enum",
        "double",
        "ascii",
        {"doc": "What is it?"},
        {"type": "uint8", "fields": {"y": "uint8"}},
        {"type": "ascii"},
        {"type": "bytes", "count": 4},
        {"type": "uint16", "size": 4, "count": 2},
        {"type": "uint8", "scale": "0,1"},
        {"type": "uint8", "scale": 0},
        {"type": "uint8", "unit": ["m"]},
        {"type": "uint16", "range": [0, 6553.5]},
        {"type": "uint16", "range": [0, 1, 2]},
        {"type": "uint16", "range": "0..10"},
        {"type": "uint16", "min": 0},
        {"type": "uint16", "endian": "little"},
        {"type": "uint8", "range": [0, 256]},
        {"type": "uint8", "const": 256},
        {"type": "sint8", "default": -129},
        {"type": "uint8", "values": ["a", "b"]},
        {"type": "uint8", "values": {"0": "idle"}},
        {"type": "uint8", "values": {"idle": 256}},
        {"type": "uint8", "values": {"idle": 0}, "flags": {"ready": 0}},
        {"type": "float32", "flags": {"ready": 0}},
        {"type": "sint8", "bits": {"low": "0..3"}},
        {"type": "uint8", "bits": {"low": "0-3"}},
        {"type": "uint8", "flags": {"ready": 8}},
        {"type": "bool", "scale": 2},
        {"switch": "kind"},
    ],
)
def test_mistakes_in_fields_are_invalid(field: Any, validator: jsonschema.Draft7Validator) -> None:
    assert list(validator.iter_errors(changed("messages", "gyro", "fields", "x", value=field)))


@pytest.mark.parametrize(
    "field",
    [
        "int16",
        {"type": "int16", "scale": 2, "values": {"none": 300}, "closed": True},
        {"type": "label", "size": 4},
    ],
)
def test_types_of_a_schema_are_valid(field: Any, validator: jsonschema.Draft7Validator) -> None:
    schema = changed("messages", "gyro", "fields", "x", value=field)
    schema["types"] = {"int16": "sint16", "label": "ascii"}
    assert [error.message for error in validator.iter_errors(schema)] == []


@pytest.mark.parametrize("path", GOOD, ids=lambda path: path.relative_to(ROOT).as_posix())
def test_what_check_takes_is_valid(path: Path, validator: jsonschema.Draft7Validator) -> None:
    data = as_editors_read(path)
    if isinstance(data, dict) and "protocol" in data and not list(validator.iter_errors(data)):
        return
    assert compile_file(path).protocol is None


OF_SHAPE = re.compile(r"PG(10[0-5]|110|123|13[0145])")
"""Codes of mistakes that one mapping shows, without the rest of the schema."""
MISTAKE = re.compile(r"^# expect: (\d+):\d+ (PG\d+) (.+)$", re.MULTILINE)
LEAST_SHARE = 60 / 99


def places(error: jsonschema.ValidationError) -> Iterator[list[Any]]:
    """Yield the places that a validation error is about, those of its innermost causes."""
    for cause in error.context or ():
        yield from places(cause)
    if error.context:
        return
    place = list(error.absolute_path)
    yield place
    if error.validator == "additionalProperties":
        allowed = error.schema.get("properties", {})
        patterns = error.schema.get("patternProperties", ())
        for name in error.instance:
            if name not in allowed and not any(re.search(one, name) for one in patterns):
                yield [*place, name]


def underlined(path: Path, validator: jsonschema.Draft7Validator) -> set[int]:
    """Return the lines of a schema in which an editor underlines something."""
    document = read_document(path, Problems(), SourceMap())
    if document is None:
        return set()
    errors = validator.iter_errors(as_editors_read(path))
    found = (place for error in errors for place in places(error))
    return {document.find(place, key=True).line for place in found}


def test_most_mistakes_of_shape_are_underlined(validator: jsonschema.Draft7Validator) -> None:
    mistakes, missed = 0, []
    for path in sorted((ROOT / "tests" / "errors").glob("*.yaml")):
        text = path.read_text(encoding="utf-8")
        lines = underlined(path, validator)
        for line, code, words in MISTAKE.findall(text):
            if OF_SHAPE.fullmatch(code):
                mistakes += 1
                missed += [] if int(line) in lines else [f"{path.name}:{line}: {words}"]
    assert mistakes > 99
    assert len(missed) <= mistakes * (1 - LEAST_SHARE), "\n".join(missed)


@pytest.mark.parametrize(
    "change",
    [
        {},
        {"messages": {"remove": ["gyro"]}},
        {"messages": {"rename": {"gyro": "gyroscope"}}},
        {"messages": {"gyro": {"fields": {"y": {"type": "sint16", "after": "x"}}}}},
        {"frame": {"sync": {"replace": True, "literal": 0x56}}},
    ],
)
def test_dialects_state_only_what_differs(
    change: dict[str, Any], validator: jsonschema.Draft7Validator
) -> None:
    dialect = {"protocol": "tiny_too", "extends": "tiny.yaml", **change}
    assert [error.message for error in validator.iter_errors(dialect)] == []


@pytest.mark.parametrize(
    "change",
    [{"messages": {"remove": "gyro"}}, {"messages": {"gyro": {"colour": "red"}}}, {"colour": 1}],
)
def test_mistakes_in_dialects_are_invalid(
    change: dict[str, Any], validator: jsonschema.Draft7Validator
) -> None:
    dialect = {"protocol": "tiny_too", "extends": "tiny.yaml", **change}
    assert list(validator.iter_errors(dialect)) != []


# --- the command ----------------------------------------------------------------------------------


def run(*arguments: str) -> tuple[int, str]:
    from protogen.cli import app

    result = CliRunner().invoke(app, ["schema-json", *arguments])
    return result.exit_code, result.output


def test_checked_in_file_is_current() -> None:
    assert run("--check", "-o", str(ROOT / "schemas" / "protogen.schema.json")) == (0, "")


def test_it_is_printed() -> None:
    code, output = run()
    assert code == 0
    assert json.loads(output) == json_schema()


def test_it_is_written_once(tmp_path: Path) -> None:
    file = tmp_path / "a.json"
    assert run("-o", str(file)) == (0, "")
    before = file.stat().st_mtime_ns
    assert run("-o", str(file)) == (0, "")
    assert file.stat().st_mtime_ns == before
    assert run("--check", "-o", str(file)) == (0, "")


def test_stale_and_missing_files_are_found(tmp_path: Path) -> None:
    file = tmp_path / "a.json"
    assert run("--check", "-o", str(file))[0] == 1
    file.write_text("{}")
    code, output = run("--check", "-o", str(file))
    assert code == 1
    assert "is not current; fix it with: protogen schema-json -o" in output
