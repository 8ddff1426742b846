"""Descriptions, commands' parameters and notes of definitions -> docs of a schema."""

from __future__ import annotations

import re

from protogen.importing.mavlink.spec import Entry, Life, Param
from protogen.importing.schema_text import joined, paragraphs

LONGEST_SUMMARY = 120
"""Characters of a sentence that sums up a message."""

_END = re.compile(r"[.!](?=\s+[A-Z])")
_ABBREVIATION = re.compile(r"(?:\b(?:e\.g|i\.e|etc|vs|approx|incl|max|min|no)|\b[A-Z])\.$", re.I)
_NO_PARAMETER = frozenset({"", "empty", "reserved", "unused"})
_FACTS = (
    ("units", "in"),
    ("multiplier", "times"),
    ("enum", "of"),
    ("minValue", "from"),
    ("maxValue", "to"),
    ("increment", "in steps of"),
    ("default", "by default"),
)
"""Attributes of a parameter, and what stands in front of their values."""
_KINDS = {"deprecated": "Deprecated", "superseded": "Superseded", "wip": "Work in progress"}


def summary_and_doc(text: str) -> tuple[str, str]:
    """Return the first sentence of a description, and the rest of it."""
    text = paragraphs(text)
    for found in _END.finditer(text, 0, LONGEST_SUMMARY):
        first = text[: found.end()]
        if first.count("(") == first.count(")") and not _ABBREVIATION.search(first):
            return first, text[found.end() :].lstrip()
    if len(text) <= LONGEST_SUMMARY and "\n" not in text:
        return text, ""
    return "", text


def life_text(life: Life | None) -> str:
    """Return what a reader should know of the future of something."""
    if life is None:
        return ""
    since = f" since {life.since}" if life.since else ""
    replaced = f": replaced by {life.replaced_by.replace('`', '')}" if life.replaced_by else ""
    return joined([f"{_KINDS[life.kind]}{since}{replaced}.", paragraphs(life.text)])


def entry_text(entry: Entry) -> str:
    """Return the doc of an entry of an enum, with the parameters of a command."""
    doc = joined([paragraphs(entry.text), life_text(entry.life)])
    params = [line for param in entry.params if (line := _param(param))]
    if entry.has_location:
        params.append("Parameters 5 to 7 are a place.")
    return "\n\n".join(filter(None, [doc, *params]))


def _param(param: Param) -> str:
    """Return what a parameter is, or nothing if it is none: `Parameter 1, Hold (in s): Time.`"""
    text = " ".join(paragraphs(param.text).split())
    if text.rstrip(".").lower() in _NO_PARAMETER:
        return ""
    of = {key: value.strip() for key, value in param.attributes.items() if value.strip()}
    facts = ", ".join(f"{words} {of[key]}" for key, words in _FACTS if key in of)
    name = f"Parameter {param.index}" + (f", {of['label']}" if "label" in of else "")
    name += f" ({facts})" if facts else ""
    is_said = text.rstrip(".") == of.get("label", "")
    return f"{name}." if is_said else f"{name}: {text}"
