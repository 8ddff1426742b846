"""Reads a project's file."""

from __future__ import annotations

import re
import tomllib
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import msgspec
from pydantic import BaseModel, ValidationError
from pydantic_core import ErrorDetails

from protogen.problems import Problems, SourceMap, Span, hint_for
from protogen.project.find import section, table_of
from protogen.project.places import place_of
from protogen.project.settings import Settings
from protogen.targets import TARGETS

_TOML_PLACE = re.compile(r" \(at (?:line (\d+), column (\d+)|end of document)\)$")


class Project(msgspec.Struct, frozen=True):
    """A project's settings, and the file that they stand in, as seen from the working directory."""

    file: Path
    settings: Settings
    text: str

    @property
    def folder(self) -> Path:
        """The folder that the paths in the file are relative to."""
        return self.file.parent

    def place(self, *loc: str, value: object = None) -> Span:
        """Return the place of a key in the file, or of a text in its value."""
        return place_of(self.text, str(self.file), (*table_of(self.file), *loc), value)


def read_project(file: Path, problems: Problems, sources: SourceMap) -> Project | None:
    """Read the settings. Whatever is wrong with them is reported; then there are none."""
    name = str(file)
    try:
        text = file.read_bytes().decode("utf-8")
    except (OSError, UnicodeDecodeError) as error:
        problems.add("PG030", Span.of_file(name), f"the file can't be read: {error}")
        return None
    sources.add(name, text)
    data = _parsed(text, name, problems)
    return None if data is None else _checked(data, text, file, problems)


def _parsed(text: str, name: str, problems: Problems) -> dict[str, Any] | None:
    try:
        return tomllib.loads(text)
    except tomllib.TOMLDecodeError as error:
        found = _TOML_PLACE.search(str(error))
        lines = text.count("\n") + 1
        line, column = (int(found[1]), int(found[2])) if found and found[1] else (lines, 1)
        words = _TOML_PLACE.sub("", str(error))
        problems.add("PG030", Span.at(name, line, column), f"this is no TOML: {words}")
        return None


def _checked(data: Any, text: str, file: Path, problems: Problems) -> Project | None:
    before = len(problems)
    try:
        project = Project(file, Settings.model_validate(section(data, file)), text)
    except ValidationError as error:
        for detail in error.errors(include_url=False):
            _report(detail, text, file, problems)
        return None
    if not project.settings.schemas:
        problems.add("PG032", project.place("schemas"), "`schemas`: there is nothing in it")
    for target in project.settings.targets or ():
        if target not in TARGETS:
            words = f"there is no target `{target}`; there are {', '.join(TARGETS)}"
            place = project.place("targets", value=target)
            problems.add("PG032", place, words, hint_for(target, TARGETS))
    return project if len(problems) == before else None


def _report(detail: ErrorDetails, text: str, file: Path, problems: Problems) -> None:
    loc = detail["loc"]
    whole = (*table_of(file), *loc)
    if detail["type"] == "extra_forbidden":
        known = _keys_at(Settings, loc[:-1])
        close = hint_for(str(loc[-1]), known) or f"keys are {', '.join(known)}"
        place = place_of(text, str(file), whole)
        problems.add("PG031", place, f"`{loc[-1]}` is no key here", close)
        return
    written = detail["input"]
    value = written if isinstance(written, str) else None
    hint = hint_for(value, _choices(detail)) if value else None
    words = f"`{_dotted(loc)}`: {_plain(detail)}"
    problems.add("PG032", place_of(text, str(file), whole, value), words, hint)


def _keys_at(model: type[BaseModel], loc: Sequence[str | int]) -> list[str]:
    """The keys of the table that `loc` leads to."""
    for step in loc:
        annotation = model.model_fields[str(step)].annotation
        assert isinstance(annotation, type)
        assert issubclass(annotation, BaseModel)
        model = annotation
    return [field.alias or name for name, field in model.model_fields.items()]


def _dotted(loc: Sequence[str | int]) -> str:
    return ".".join(str(step) for step in loc if isinstance(step, str))


def _choices(detail: ErrorDetails) -> list[str]:
    return re.findall(r"'([^']*)'", str(detail.get("ctx", {}).get("expected", "")))


_WORDS = {
    "tuple_type": 'this is a list of texts, such as ["a", "b"]',
    "string_type": 'this is a text, such as "a"',
    "bool_type": "this is true or false",
    "dict_type": "this is a table",
    "model_type": "this is a table",
}


def _plain(detail: ErrorDetails) -> str:
    """Complaint about a value, in the words of TOML."""
    choices = _choices(detail)
    if choices:
        return f"this is {' or '.join(choices)}"
    return _WORDS.get(detail["type"], detail["msg"])
