"""Generated C with ACSL contracts: where they are put, and of which functions."""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass, field

_ORDER = ("requires", "assigns", "ensures")
_LOOP = re.compile(r"^( +)(?:for|while) \((?:(?:size_t|int) (\w+) = )?.*\{.*\n", re.MULTILINE)
_LOCAL = re.compile(
    r"^( +)(?!return|__m128i)(?:enum |struct )?\w+ (\w+)(?: = [^;]*)?;\n", re.MULTILINE
)
_PARAMETER = re.compile(r"(\w+)[,)]")


@dataclass
class Contracts:
    """Generated C with contracts, and the functions that have them."""

    header: str
    source: str
    functions: list[str] = field(default_factory=list)
    safe: list[str] = field(default_factory=list)
    """Of which it is proved, too, that they access nothing out of bounds."""

    def has(self, name: str) -> bool:
        return _definition(name).search(self.source) is not None

    def body(self, name: str) -> str:
        text = self.source if self.has(name) else self.header
        found = _definition(name).search(text)
        assert found, name
        return text[found.start() : text.index("\n}\n", found.start()) + 3]

    def put(self, name: str, *clauses: str) -> None:
        """Put a contract in front of a function, which is to be proved."""
        ordered = sorted(clauses, key=lambda clause: _ORDER.index(clause.split()[0]))
        contract = "/*@\n" + "".join(f"    {clause};\n" for clause in ordered) + "*/\n"
        self.change(name, contract + self.body(name))
        self.functions.append(name)

    def put_safe(self, name: str, *clauses: str) -> None:
        """The same, for a function that is to access nothing out of bounds either."""
        self.put(name, *clauses)
        self.safe.append(name)

    def change(self, name: str, body: str) -> None:
        """Put another text where that of a function is."""
        before = self.body(name)
        self.header = self.header.replace(before, body)
        self.source = self.source.replace(before, body)

    def loops(self, name: str, *clauses: str, assigns: Sequence[str] = ()) -> None:
        """Put the same clauses in front of each loop of a function, beside the names it changes."""
        body = self.body(name)

        def annotated(loop: re.Match[str]) -> str:
            own, before = loop[2], body[: loop.start()]
            given = _PARAMETER.findall(body[: body.index("{")])
            names = [own] if own else []
            names += [
                local[2]
                for local in _LOCAL.finditer(before)
                if _is_open(before[local.end() :], local)
            ]
            names += [
                name for name in given if re.search(rf"\b{name}(?: [-+|&^]?= |\+\+|--)", body)
            ]
            text = " ".join(f"loop {clause};" for clause in clauses)
            text += f" loop assigns {', '.join(dict.fromkeys([*names, *assigns]))};"
            return f"{loop[1]}//@ {text}\n{loop.group()}"

        self.change(name, _LOOP.sub(annotated, body))

    def keep(self, name: str, invariant: str) -> None:
        """Put an invariant in front of each loop of a function, which may change anything."""
        self.change(
            name,
            _LOOP.sub(
                lambda loop: f"{loop[1]}//@ loop invariant {invariant};\n{loop[0]}",
                self.body(name),
            ),
        )

    def define(self, text: str) -> None:
        """Put text behind the enum of all messages."""
        found = re.search(r"^enum \w+_message \{[^}]*\}[^;]*;\n", self.header, re.M)
        assert found
        self.header = self.header[: found.end()] + text + self.header[found.end() :]

    def declare(self, text: str) -> None:
        """Put text behind the header's inclusion."""
        found = re.search(r'#include "\w+\.h"\n', self.source)
        assert found
        self.source = self.source[: found.end()] + text + self.source[found.end() :]


def identifies(made: Contracts, prefix: str, upper: str, *promises: str) -> None:
    """What names the message of a frame: only where the payload fits it."""
    made.put(
        f"{prefix}_identify",
        r"requires \valid(message) && \separated(message, parts, payload + (0 .. size - 1))",
        "assigns *message",
        rf"ensures \result == {upper}_FINE ==> holds(*message, payload, size)",
        *promises,
    )


def room_of(made: Contracts, prefix: str) -> int:
    """Bytes in a decoder's buffer."""
    found = re.search(
        rf"struct {prefix}_decoder \{{\n(?:(?!\}};).*\n)*? +uint8_t buffer\[(\d+)\];", made.header
    )
    assert found
    return int(found[1])


def _is_open(behind: str, local: re.Match[str]) -> bool:
    """Whether the block of a local variable goes on."""
    return not re.search(rf"^ {{0,{len(local[1]) - 1}}}\}}", behind, re.MULTILINE)


def _definition(name: str) -> re.Pattern[str]:
    return re.compile(rf"^(?=[a-zA-Z][^;{{}}()\n]*\b{name}\([^;{{}}]*\{{)", re.MULTILINE)
