"""Declarations of a module, each in TypeScript, in JavaScript and as a declaration of types.

The three files are made of the same pieces: what has no types in it is printed once.
"""

from __future__ import annotations

from collections.abc import Sequence

import msgspec

from protogen.targets.escape import tsdoc
from protogen.targets.folding import folded

_WIDTH = 100


class Declaration(msgspec.Struct, frozen=True):
    """Something that a module declares."""

    typed: str
    """TypeScript."""
    plain: str
    """JavaScript; empty of what is a type alone."""
    types: str
    """What a `.d.ts` file has; empty of what is not exported."""


class Parameter(msgspec.Struct, frozen=True):
    """Parameter of a function."""

    name: str
    type: str
    default: str = ""
    is_optional: bool = False


def comment(paragraphs: Sequence[str], indent: str = "") -> str:
    """A comment in front of a declaration, with the line break behind it."""
    texts = [tsdoc(item) for item in paragraphs if item]
    if not texts:
        return ""
    if len(texts) == 1 and len(indent) + len(texts[0]) + 7 <= _WIDTH:
        return f"{indent}/** {texts[0]} */\n"
    lines: list[str] = []
    for item in texts:
        lines += [*([""] if lines else []), *folded(item, _WIDTH - len(indent) - 3)]
    body = "\n".join(f"{indent} * {line}".rstrip() for line in lines)
    return f"{indent}/**\n{body}\n{indent} */\n"


def interface(name: str, members: Sequence[str], doc: str, extends: str = "") -> Declaration:
    """An exported interface; members are indented and end with a semicolon."""
    head = f"export interface {name}{f' extends {extends}' if extends else ''} {{"
    found = doc + "\n".join([head, *members, "}"])
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
    parameters: Sequence[Parameter],
    result: str,
    body: Sequence[str],
    doc: str = "",
    *,
    exported: bool = False,
    generic: str = "",
) -> Declaration:
    """A function; lines of its body have no types in them, and the indent inside of it."""
    export = "export " if exported else ""
    typed = ", ".join(_typed(item) for item in parameters)
    plain = ", ".join(_plain(item) for item in parameters)
    optional = ", ".join(_declared(item) for item in parameters)
    lines = "\n".join(f"  {line}" if line else "" for line in body)
    block = f"{{\n{lines}\n}}" if lines else "{}"
    return Declaration(
        f"{doc}{export}function {name}{generic}({typed}): {result} {block}",
        f"{doc}{export}function {name}({plain}) {block}",
        f"{doc}export declare function {name}{generic}({optional}): {result};" if exported else "",
    )


def subclass(
    name: str, generic: str, base: str, parameter: Parameter, hands_on: str, doc: str
) -> Declaration:
    """An exported class whose constructor hands on some arguments; `base` has its own types."""
    plain_base, body = base.partition("<")[0], "  constructor({}) {{\n    super({});\n  }}"
    head = f"class {name}{generic} extends {base} {{"
    return Declaration(
        f"{doc}export {head}\n{body.format(_typed(parameter), hands_on)}\n}}",
        f"{doc}export class {name} extends {plain_base} {{\n"
        f"{body.format(_plain(parameter), hands_on)}\n}}",
        f"{doc}export declare {head}\n  constructor({_declared(parameter)});\n}}",
    )


def _typed(item: Parameter) -> str:
    mark = "?" if item.is_optional else ""
    return f"{item.name}{mark}: {item.type}" + (f" = {item.default}" if item.default else "")


def _plain(item: Parameter) -> str:
    return f"{item.name} = {item.default}" if item.default else item.name


def _declared(item: Parameter) -> str:
    mark = "?" if item.default or item.is_optional else ""
    return f"{item.name}{mark}: {item.type}"
