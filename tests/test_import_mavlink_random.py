"""Whatever definitions of MAVLink say, the schemas that are imported of them have no problems."""

from __future__ import annotations

from pathlib import Path
from random import Random
from xml.sax.saxutils import escape, quoteattr

import pytest
from cli_support import run

from protogen.compiler import compile_file
from protogen.layout.formatting import format_text

INTEGERS = tuple(f"{sign}int{bits}_t" for sign in ("u", "") for bits in (8, 16, 32, 64))
TYPES = (*INTEGERS, *INTEGERS, "float", "double", "char", "uint8_t_mavlink_version", "array[3]")
WORDS = (
    "Off.", "on", "Reserved", "not", "before", "remove", "class", "-1", "°", "#", "a: b", "[x]",
    "null", "yes", "0x10", "'", '"', "\\", "*", "&", "<", "%", "{", "*/", "(e.g.", "|", "`", "\t",
    "A long description of what it is, with all that a reader may want to know about it. And so on",
)  # fmt: skip
NAMES = (
    "tow", "Flags", "fill", "and", "before", "replace", "rename", "int", "CLASS", "value", "N2",
    "_", "x" * 70, "satId", "P", "p", "type", "from", "component", "len", "payload", "True",
    "uint8", "9",
)  # fmt: skip
NUMBERS = ("0", "1", "-1", "0xFF", "255", "300", "NaN", "UINT16_MAX", "INT8_MIN", "1.5", "E", "")
INVALID = (*NUMBERS, "[0]", "[NaN:]", "[UINT8_MAX]", "[INT16_MAX:]", "[NaN]", "x")
VALUES = ("0", "1", "2", "4", "0x10", "255", "256", "-1", "-129", "2**40", "1<<63", "65535", None)
UNITS = ("", "m", "degE7", "cdeg", "m/s*5", "°", "%", '"', "c%", "hJ")
LIFE = ("", "<wip/>", '<deprecated since="2020-01" replaced_by="X">So</deprecated>')


class Definitions:
    """Random definitions: files of which each may include those before."""

    def __init__(self, seed: int) -> None:
        self._dice = Random(seed)
        self._ids = iter(self._dice.sample(range(400), 200))
        self._names: set[str] = set()
        self._enums: dict[str, tuple[set[str | None], set[str]]] = {}

    def write(self, folder: Path) -> None:
        """Write files; the last one includes all of them."""
        files: list[str] = []
        for name in ("one", "Two", "threeFour"):
            count = self._dice.randint(0, len(files))
            self._write(folder / f"{name}.xml", self._dice.sample(files, count))
            files.append(f"{name}.xml")
        self._write(folder / "last.xml", files)

    def _write(self, file: Path, included: list[str]) -> None:
        lines = [f"<include>{name}</include>" for name in included]
        # All enums that a file uses are its own or of the first file, which some do not include.
        enums = [self._enum(self._dice.choice(NAMES)) for _ in range(3)]
        known = [name for name, _ in enums]
        lines += ["<enums>", *(text for _, text in enums), "</enums>", "<messages>"]
        lines += [self._message(known) for _ in range(4)]
        file.write_text("\n".join(["<mavlink>", *lines, "</messages>", "</mavlink>"]))

    def _text(self) -> str:
        count = self._dice.choice((0, 1, 2, 9))
        words = [self._dice.choice(WORDS) for _ in range(count)]
        return escape(self._dice.choice((" ", "\n\n", "\n")).join(words))

    def _enum(self, name: str) -> tuple[str, str]:
        values, names = self._enums.setdefault(name, (set(), set()))
        lines: list[str] = []
        for entry in self._dice.sample(NAMES, self._dice.randint(0, 5)):
            value = self._dice.choice(VALUES)
            if value in values or entry in names:
                continue
            values.add(value)
            names.add(entry)
            lines.append(self._entry(f"{name}_{entry}", value))
        bitmask = self._dice.choice(("", ' bitmask="true"'))
        head = f'<enum name="{name}"{bitmask}>{self._dice.choice(LIFE)}'
        return name, "\n".join(
            [f"{head}<description>{self._text()}</description>", *lines, "</enum>"]
        )

    def _entry(self, name: str, value: str | None) -> str:
        # Without a value, an entry might get that of another one.
        attribute = f" value={quoteattr(value)}" if value is not None else ' value="77"'
        params = "".join(
            f'<param index="{index}" label={quoteattr(self._dice.choice(WORDS))}>{self._text()}'
            "</param>"
            for index in range(1, self._dice.choice((1, 4)))
        )
        return f'<entry name="{name}"{attribute}>{self._dice.choice(LIFE)}{params}</entry>'

    def _message(self, enums: list[str]) -> str:
        number = next(self._ids)
        name = self._dice.choice(NAMES)
        if name in self._names:
            name += str(number)
        self._names.add(name)
        names = self._dice.sample(NAMES, self._dice.randint(0, 8))
        fields = [self._field(item, enums) for item in names]
        if self._dice.random() < 0.4:
            fields.insert(self._dice.randint(0, len(fields)), "<extensions/>")
        head = f'<message id="{number}" name="{name}"><description>{self._text()}</description>'
        return "\n".join([head, *fields, "</message>"])

    def _field(self, name: str, enums: list[str]) -> str:
        kind = self._dice.choice(TYPES)
        if kind in INTEGERS or kind in ("float", "double", "char"):
            kind += self._dice.choice(("", "", "[1]", "[4]", "[60]"))
        given = {
            "type": kind,
            "name": name,
            "units": self._dice.choice(UNITS),
            "invalid": self._some(INVALID),
            "enum": self._some(enums),
            "multiplier": self._some(("1E-2", "360/255", "0", "x", "1/0")),
            "minValue": self._some(NUMBERS),
            "maxValue": self._some(NUMBERS),
            "default": self._some(NUMBERS),
            "instance": self._some(("true",)),
        }
        written = " ".join(f"{key}={quoteattr(value)}" for key, value in given.items() if value)
        return f"<field {written}>{self._text()}</field>"

    def _some(self, choices: tuple[str, ...] | list[str]) -> str:
        return self._dice.choice(choices) if self._dice.random() < 0.3 else ""


@pytest.mark.parametrize("wire", ["1", "2"])
@pytest.mark.parametrize("seed", range(10))
def test_random_definitions_become_schemas(seed: int, wire: str, tmp_path: Path) -> None:
    Definitions(seed).write(tmp_path)
    done = run("import", "mavlink", str(tmp_path), "-o", str(tmp_path / "out"), "--wire", wire)
    assert done.exit_code == 0, done.output
    schemas = list((tmp_path / "out").iterdir())
    assert schemas
    for schema in schemas:
        text = schema.read_text(encoding="utf-8")
        assert format_text(text) == text
        assert [str(problem) for problem in compile_file(schema).problems] == []
