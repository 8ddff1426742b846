"""The JSON Schema of schema files: complete, explained, and in step with the loader."""

from __future__ import annotations

import copy
import json
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import jsonschema
import pytest
from typer.testing import CliRunner

from protogen.schema.json_schema import json_schema

ROOT = Path(__file__).resolve().parent.parent
SCHEMAS = sorted((ROOT / "schemas").rglob("*.yaml"))

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
    from protogen.problems import Problems, SourceMap
    from protogen.schema.text.document import read_document
    from protogen.schema.text.nodes import to_data

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
        if name == "properties":
            yield from ((f"{place}.{key}", item) for key, item in inner.items())
        yield from properties(inner, f"{place}.{name}")


def test_every_key_is_described() -> None:
    undescribed = [
        place for place, item in properties(json_schema(), "") if not item.get("description")
    ]
    assert undescribed == []


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
        changed("frame", value={"pc": TINY["frame"]}),
        changed("transparency", value="slip"),
        changed("transparency", value={"substitute": {"27": [27, 0], "28": {"hex": "1B 01"}}}),
        changed("exchanges", value={"start": {"steps": ["gyro", {"message": "gyro"}]}}),
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
    ],
)
def test_mistakes_are_invalid(
    schema: dict[str, Any], validator: jsonschema.Draft7Validator
) -> None:
    assert list(validator.iter_errors(schema)) != []


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
