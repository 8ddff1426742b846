"""Whatever definitions say, the schema that is imported of them has no problems."""

from __future__ import annotations

from pathlib import Path
from random import Random
from typing import Any

import msgspec
import pytest
from cli_support import run

from protogen.compiler import compile_file
from protogen.layout.formatting import format_text

NUMBERS = ("u8", "u16", "u32", "u64", "s8", "s16", "s32", "s64", "float", "double")
COUNTING = ("u8", "u16", "s8", "s32")
WORDS = (
    "Off", "on", "Reserved", "not", "fill", "byte", "before", "remove", "message", "class", "-1",
    "2 x", "°", "#", "a: b", "[x]", "null", "yes", "0x10", "1e3", "'", '"', "\\", "*", "&a", "%",
    "A long description of what it is, with all that a reader may want to know about it, and so on",
)  # fmt: skip
NAMES = (
    "tow", "Flags", "fill", "and", "before", "replace", "int", "class", "value", "rest", "N2", "_",
    "x" * 70, "satId", "P", "p", "type", "from", "bytes", "device", "payload", "sbp", "None",
)  # fmt: skip
UNITS = ("", "ms", "2 cm", "deg * 2", "m*10", "N/A", "0 m", "°", '"', "1/0", "s / 2^40", "2^-31")
ENCODINGS = ("null_terminated", "unterminated", "multipart", "unknown", None)


class Definitions:
    """Random definitions, of which each one before may be used by those behind."""

    def __init__(self, seed: int) -> None:
        self._dice = Random(seed)
        self._structs: list[str] = []

    def file(self) -> dict[str, Any]:
        """A file of definitions."""
        definitions: dict[str, Any] = {}
        for number in range(12):
            name = f"{self._dice.choice(NAMES)}{self._dice.choice(('', number))}"
            is_message = self._dice.random() < 0.5
            if name in definitions or f"MSG_{name}" in definitions:
                continue
            body: dict[str, Any] = {"desc": self._text(), "fields": self._fields()}
            if is_message:
                body |= {"id": self._dice.choice((number, 1, 0x10000)), "short_desc": self._text()}
            definitions[f"MSG_{name}" if is_message else name] = body
            if not is_message:
                self._structs.append(name)
        definitions["MSG_LAST"] = {"id": 0x7777}
        return {
            "package": self._dice.choice(("a.b.sbp", "last", "x.Y-z")),
            "description": self._text(),
            "definitions": [{name: body} for name, body in definitions.items()],
        }

    def _text(self) -> str:
        count = self._dice.choice((0, 1, 2, 9))
        words = [self._dice.choice(WORDS) for _ in range(count)]
        return self._dice.choice((" ", "\n\n", "\n")).join(words)

    def _fields(self) -> list[dict[str, Any]]:
        names = self._dice.sample(NAMES, self._dice.randint(0, 5))
        fields: list[dict[str, Any]] = []
        for index, name in enumerate(names):
            counters = [other for other in names[:index] if self._counts(fields, other)]
            fields.append({name: self._field(counters)})
        return fields

    def _counts(self, fields: list[dict[str, Any]], name: str) -> bool:
        return any(field[name]["type"] in COUNTING for field in fields if name in field)

    def _field(self, counters: list[str]) -> dict[str, Any]:
        field: dict[str, Any] = {"desc": self._text(), "units": self._dice.choice(UNITS)}
        kind = self._dice.choice((*NUMBERS, *NUMBERS, "array", "string", *self._structs[-3:]))
        field["type"] = kind
        if kind == "array":
            field["fill"] = self._dice.choice((*NUMBERS, *self._structs[-3:]))
        if kind in ("array", "string"):
            field |= self._dice.choice(({}, {"size": self._dice.choice((1, 3, 300))}))
            if counters and self._dice.random() < 0.5:
                field["size_fn"] = self._dice.choice(counters)
        if kind == "string" and (encoding := self._dice.choice(ENCODINGS)):
            field["encoding"] = encoding
        if self._dice.random() < 0.4:
            field["fields"] = [self._bits() for _ in range(self._dice.randint(1, 4))]
        return field

    def _bits(self) -> dict[str, Any]:
        low, high = sorted(self._dice.choices((0, 0, 1, 3, 7, 8, 15, 31), k=2))
        name = str(low) if low == high else f"{low}-{high}"
        body: dict[str, Any] = {"desc": self._text()}
        if self._dice.random() < 0.6:
            numbers = self._dice.choices((-1, 0, 1, 2, 3, 127, 200, 256, 2**40), k=4)
            body["values"] = [{number: self._text()} for number in numbers]
        return {name: body}


@pytest.mark.parametrize("options", [(), ("--split",)], ids=["whole", "split"])
@pytest.mark.parametrize("seed", range(10))
def test_random_definitions_become_schemas(
    seed: int, options: tuple[str, ...], tmp_path: Path
) -> None:
    file = tmp_path / "definitions.yaml"
    file.write_bytes(msgspec.json.encode(Definitions(seed).file()))
    done = run("import", "sbp", str(file), "-o", str(tmp_path / "out"), *options)
    assert done.exit_code == 0, done.output
    (schema,) = (tmp_path / "out").iterdir()
    text = schema.read_text(encoding="utf-8")
    assert format_text(text) == text
    assert [str(problem) for problem in compile_file(schema).problems] == []
