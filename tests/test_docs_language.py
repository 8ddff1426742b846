"""The reference of the language lists every key with its description."""

from __future__ import annotations

import pytest
from doc_pages import text_of

from protogen.schema.json_schema import json_schema

PAGE = "docs/reference/language.md"


def described() -> dict[str, dict[str, tuple[str, bool]]]:
    """Keys of each mapping of the language, with description and whether they are needed."""
    definitions = {
        name: schema
        for name, schema in json_schema()["definitions"].items()
        if "properties" in schema and not name.startswith("Dialect")
    }
    return {
        schema["title"]: {
            key: (value["description"], key in schema.get("required", ()))
            for key, value in schema["properties"].items()
        }
        for schema in definitions.values()
    }


def expected_table(keys: dict[str, tuple[str, bool]]) -> str:
    rows = [f"| `{key}`{'*' if needed else ''} | {text} |" for key, (text, needed) in keys.items()]
    return "\n".join(["| Key | Meaning |", "| --- | --- |", *rows])


@pytest.mark.parametrize("name", sorted(described()))
def test_has_every_key_with_its_description(name: str) -> None:
    table = expected_table(described()[name])
    assert table in text_of(PAGE), f"{PAGE} lacks:\n\n{table}"


def test_has_no_other_keys() -> None:
    language = text_of(PAGE)
    for name in described():
        language = language.replace(expected_table(described()[name]), "")
    assert "| Key | Meaning |" not in language
