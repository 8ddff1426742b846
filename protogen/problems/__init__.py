"""Problems in what the user wrote: collecting, explaining and printing them."""

from __future__ import annotations

from protogen.problems.catalogue import CODES, Code
from protogen.problems.problem import Note, Problem, Problems
from protogen.problems.render import render_rich, render_text, to_github, to_json
from protogen.problems.severity import Severity
from protogen.problems.sources import SourceMap
from protogen.problems.span import Span
from protogen.problems.suggest import did_you_mean, hint_for

__all__ = [
    "CODES",
    "Code",
    "Note",
    "Problem",
    "Problems",
    "Severity",
    "SourceMap",
    "Span",
    "did_you_mean",
    "hint_for",
    "render_rich",
    "render_text",
    "to_github",
    "to_json",
]
