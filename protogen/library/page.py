"""Renders the library as a Markdown page, and its table in the README."""

from __future__ import annotations

import re
import sys
import tomllib
from collections.abc import Mapping, Sequence
from pathlib import Path

import msgspec

from protogen.api import load
from protogen.library import FOLDER, library_names
from protogen.model.protocol import Protocol

_HEAD = """\
# Library

<!-- Generated from protogen/library, do not edit. -->

Schemas of protocols in the wild, which are installed with protogen. `extends: library:NAME` takes
one and states what a device does differently; `protogen init --from library:NAME` writes such a
schema. A command that reads a schema takes one by that name, too: `protogen decode library:ubx`.

Each is compared with an implementation of the protocol that is not ours, at least 500
frames each way; what that one only makes, or only reads, is compared one way, as its section says.
Of a stream with one damaged byte in a hundred, no frame is lost that the other one finds, wherever
it begins to read. Where it is wrong, a decision of the schema says so. A protocol is said
completely where its frames and all layouts of its messages can be written; a message that a schema
does not list is an unknown one to a decoder, and is added by `extends`.

"""
_BEGIN = "<!-- library -->\n"
_END = "<!-- end of library -->"


class Proof(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """What a schema of the library is compared with, and how far."""

    peer: str
    """Package that it is compared with, and its version."""
    compared: str
    """What the comparison takes in."""
    unsaid: list[str]
    """What of the protocol the schema does not say; empty if it is complete."""


def proof_of(name: str) -> Proof:
    """The proof of a schema of the library. Raises msgspec.ValidationError."""
    text = (FOLDER / f"{name}.toml").read_text("utf-8")
    return msgspec.convert(tomllib.loads(text), Proof)


def render_page() -> str:
    """Return the page that lists the schemas."""
    protocols = {name: load(FOLDER / f"{name}.yaml") for name in library_names()}
    sections = (_section(name, protocol) for name, protocol in protocols.items())
    return "".join((_HEAD, _table(protocols), *sections))


def with_table(readme: str) -> str:
    """Return the README with the table of today between its two marks."""
    names = {False: list[str](), True: list[str]()}
    for name in library_names():
        names[proof_of(name).unsaid == []].append(f"`{name}`")
    said = ((True, "completely"), (False, "in part"))
    rows = [f"| {words} | {', '.join(names[whole])} |" for whole, words in said]
    count = (
        f"{len(names[True])} of {len(library_names())} are said completely: their frames, and all "
        "layouts that their messages have.\nA message that a schema does not list is added by "
        "`extends`."
    )
    text = "\n".join((count, "", "| Said | Schemas |", "| --- | --- |", *rows, "", ""))
    return re.sub(f"(?s)(?<={_BEGIN}).*(?={_END})", lambda _: text, readme)


def _table(protocols: Mapping[str, Protocol]) -> str:
    rows = [_row(name, protocol, proof_of(name)) for name, protocol in protocols.items()]
    return "\n".join(("| Schema | Protocol | Messages | Agrees with | Said |", _RULE, *rows, ""))


_RULE = "| --- | --- | --- | --- | --- |"


def _row(name: str, protocol: Protocol, proof: Proof) -> str:
    said = "in part" if proof.unsaid else "completely"
    cells = (f"`{name}`", protocol.title, len(protocol.messages), proof.peer, said)
    return f"| {' | '.join(map(str, cells))} |"


def _section(name: str, protocol: Protocol) -> str:
    proof = proof_of(name)
    decisions = [f"* {item.question} {item.choice}" for item in protocol.decisions]
    unsaid = [f"* {text}" for text in proof.unsaid]
    lists = [("Decided:", decisions), ("Not said:", unsaid)]
    blocks = ["\n".join((head, "", *items)) for head, items in lists if items]
    text = [f"## {name}", protocol.about.doc or protocol.title, f"Compared with {proof.peer}."]
    return "\n" + "\n\n".join((*text, proof.compared.strip(), *blocks)) + "\n"


def main(arguments: Sequence[str]) -> None:
    """Write the page to the first file, and the table into the second."""
    page, readme = map(Path, arguments)
    page.write_text(render_page(), encoding="utf-8", newline="\n")
    text = with_table(readme.read_text("utf-8"))
    readme.write_text(text, encoding="utf-8", newline="\n")


if __name__ == "__main__":
    main(sys.argv[1:])
