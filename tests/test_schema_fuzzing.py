"""Random schemas through the whole compiler, and random values and damage through its codecs."""

from __future__ import annotations

import dataclasses
import os
from collections import Counter
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import pytest
from hypothesis import HealthCheck, Phase, event, given, seed, settings
from hypothesis import strategies as st
from schema_fuzzing import Schema, codec, schemas
from schema_fuzzing.edits import edited, mangled
from schema_fuzzing.shapes import COMMON, PAIRS
from schema_fuzzing.streams import lost, portions, streams
from schema_fuzzing.text import to_styled_yaml, to_yaml
from schema_fuzzing.values import all_parts, parts_of, values_of

from protogen.compiler import Compilation, compile_file
from protogen.model.protocol import Protocol
from protogen.problems import Problems, Severity
from protogen.problems.render import render_text
from protogen.problems.span import Span
from protogen.schema.document import parse_document
from protogen.schema.nodes import to_data
from protogen.targets.python.live import module_of

pytestmark = pytest.mark.usefixtures("schema_folder")
