"""Every problem that protogen can report, by its code.

Codes are stable: one that was published is never given to another problem.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping

from protogen.problems.catalogue.code import Code, files_of
from protogen.problems.catalogue.document import DOCUMENT_CODES
from protogen.problems.catalogue.extends import EXTENDS_CODES
from protogen.problems.catalogue.project import PROJECT_CODES
from protogen.problems.catalogue.schema import SCHEMA_CODES

__all__ = ["CODES", "Code", "files_of", "register"]


def register(codes: Iterable[Code]) -> Mapping[str, Code]:
    """Return the codes by code, in ascending order.

    Raises ValueError if a code or a name is given twice.
    """
    by_code: dict[str, Code] = {}
    names: set[str] = set()
    for code in sorted(codes, key=lambda code: code.code):
        if code.code in by_code or code.name in names:
            raise ValueError(f"problem {code.code} ({code.name}) is registered twice")
        by_code[code.code] = code
        names.add(code.name)
    return by_code


CODES: Mapping[str, Code] = register(
    (*DOCUMENT_CODES, *EXTENDS_CODES, *PROJECT_CODES, *SCHEMA_CODES)
)
"""Every problem code that exists, in ascending order."""
