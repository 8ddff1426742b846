"""Declarations of a module, each in TypeScript, in JavaScript and as a declaration of types.

The three files are made of the same pieces: what has no types in it is printed once.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import msgspec

from protogen.targets.escape import tsdoc
from protogen.targets.folding import block_comment

_WIDTH = 100


class Declaration(msgspec.Struct, frozen=True):
    """Something that a module declares."""

    typed: str
    """TypeScript."""
    plain: str
    """JavaScript; empty of what is a type alone."""
    types: str
    """What a `.d.ts` file has; empty of what is not exported."""


def comment(paragraphs: Sequence[str], indent: str = "") -> str:
    """A comment in front of a declaration, with the line break behind it."""
    texts = [tsdoc(item) for item in paragraphs if item]
    lines = block_comment(texts, _WIDTH - len(indent)) if texts else ()
    return "".join(f"{indent}{line}\n" for line in lines)


def interface(name: str, members: Sequence[str], doc: str) -> Declaration:
    """An exported interface; members are indented and end with a semicolon."""
    found = doc + "\n".join([f"export interface {name} {{", *members, "}"])
    return Declaration(found, "", found)


def alias(name: str, type_: str, doc: str = "") -> Declaration:
    """An exported name of a type."""
    found = f"{doc}export type {name} = {type_};"
    return Declaration(found, "", found)


def union(members: Sequence[str]) -> str:
    """One of several types."""
    distinct = list(dict.fromkeys(members))
    if sum(map(len, distinct)) < _WIDTH - 30:
        return " | ".join(distinct) or "never"
    return "".join(f"\n  | {item}" for item in distinct)


def constants(name: str, values: Sequence[tuple[str, str, str]], doc: str) -> Declaration:
    """An object of constants: the name of each, its value, and a comment in front of it."""
    plain = "\n".join(f"{doc}  {key}: {value}," for key, value, doc in values)
    types = "\n".join(f"{doc}  readonly {key}: {value};" for key, value, doc in values)
    return Declaration(
        f"{doc}export const {name} = {{\n{plain}\n}} as const;",
        f"{doc}export const {name} = {{\n{plain}\n}};",
        f"{doc}export declare const {name}: {{\n{types}\n}};",
    )


def constant(
    name: str, type_: str, value: str, doc: str = "", *, exported: bool = False
) -> Declaration:
    """A constant."""
    export = "export " if exported else ""
    return Declaration(
        f"{doc}{export}const {name}: {type_} = {value};",
        f"{doc}{export}const {name} = {value};",
        f"{doc}export declare const {name}: {type_};" if exported else "",
    )


def function(
    name: str,
    parameters: Mapping[str, str],
    result: str,
    body: Sequence[str],
    doc: str = "",
    *,
    exported: bool = False,
) -> Declaration:
    """A function of parameters with their types; lines of its body have no types in them."""
    export = "export " if exported else ""
    typed = ", ".join(f"{key}: {type_}" for key, type_ in parameters.items())
    lines = "\n".join(f"  {line}" for line in body)
    block = f"{{\n{lines}\n}}" if lines else "{}"
    return Declaration(
        f"{doc}{export}function {name}({typed}): {result} {block}",
        f"{doc}{export}function {name}({', '.join(parameters)}) {block}",
        f"{doc}export declare function {name}({typed}): {result};" if exported else "",
    )
