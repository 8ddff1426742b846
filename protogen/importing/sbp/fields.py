"""Fields of a message or struct -> fields of a schema."""

from __future__ import annotations

from typing import Any

from protogen.importing.names import snake_case, unique
from protogen.importing.remarks import DefinitionError, Kind, Remark
from protogen.importing.sbp.bits import meaning
from protogen.importing.sbp.spec import Definition, FieldSpec
from protogen.importing.sbp.structs import (
    NUMBERS,
    OPEN_ELEMENTS,
    SERIES,
    Structs,
    element_type,
    width,
)
from protogen.importing.sbp.texts import end_of_text, is_known_encoding, text_data
from protogen.importing.schema_text import joined, paragraphs
from protogen.importing.units import read_unit
from protogen.problems.span import Span

REST = "rest"
_NO_INTEGER = "bits of what is no integer"
_WORDS = frozenset({"fill", "and", "or", "not", "in"})
"""Names that mean something else where a schema says what counts an array."""


def fields_of(
    definition: Definition, file: str, structs: Structs, remarks: list[Remark]
) -> dict[str, Any]:
    """Return the fields of a message or struct.

    From the first one on that a schema can't say, they are bytes, which a remark tells.
    """
    return _Fields(definition, file, structs, remarks).read()


class _Fields:
    def __init__(
        self, definition: Definition, file: str, structs: Structs, remarks: list[Remark]
    ) -> None:
        self._definition = definition
        self._specs = definition.fields
        self._file = file
        self._structs = structs
        self._remarks = remarks
        self._names: dict[str, str] = {}
        """Names in the schema of the fields so far, by their names in the definition."""

    def read(self) -> dict[str, Any]:
        fields: dict[str, Any] = {}
        for index, spec in enumerate(self._specs):
            if spec.name in self._names:
                raise DefinitionError(spec.span, f"there is a field `{spec.name}` already")
            obstacle = self._obstacle(index)
            if obstacle is not None:
                self._remark(spec, Kind.CHANGED, f"{obstacle}; bytes from here on", spec.span)
                fields[unique(REST, fields)] = self._rest(index)
                break
            name = unique(self._name(spec), fields)
            fields[name] = self._field(spec, is_last=index == len(self._specs) - 1)
            self._names[spec.name] = name
        return fields

    def _name(self, spec: FieldSpec) -> str:
        name = snake_case(spec.name)
        return f"{name}_count" if self._counts(spec) and name in _WORDS else name

    def _counts(self, spec: FieldSpec) -> bool:
        return any(other.size_fn == spec.name for other in self._specs)

    def _remark(self, spec: FieldSpec, kind: Kind, reason: str, span: Span) -> None:
        name = f"{self._definition.name}.{spec.name}"
        self._remarks.append(Remark(kind, name, reason, span))

    # --- what a schema can't say --------------------------------------------------------------

    def _obstacle(self, index: int) -> str | None:
        """Return why a field can't be said in a schema, or None."""
        spec = self._specs[index]
        is_last = index == len(self._specs) - 1
        extent = self._structs.extent_of(self._file, spec, is_last=is_last)
        if spec.size_fn is not None:
            return self._structs.uncountable(self._file, self._definition, spec)
        if self._structs.has_open_elements(self._file, spec):
            return OPEN_ELEMENTS
        if not extent.is_open or is_last:
            return None
        return "no size tells where it ends, and it is not the last field"

    def _rest(self, index: int) -> dict[str, Any]:
        """Return the field that takes the bytes of all fields from one on."""
        others = self._specs[index:]
        parts = [" ".join(filter(None, (spec.name, _kind(spec)))) for spec in others]
        doc = f"In it, one behind the other: {', '.join(parts)}."
        return {"type": "bytes", "size": {"fill": True}, "doc": doc}

    # --- what it can --------------------------------------------------------------------------

    def _field(self, spec: FieldSpec, *, is_last: bool) -> Any:
        if spec.size is not None and spec.size < 1:
            raise DefinitionError(spec.span, f"the size of `{spec.name}` is 1 or more")
        data = self._type(spec, is_last=is_last)
        docs = [paragraphs(spec.desc)]
        element = element_type(spec)
        if spec.type == "string":
            docs.append(end_of_text(spec, is_last=is_last))
            self._check_encoding(spec)
        elif element in NUMBERS and spec.type != "bytes":
            data |= self._meaning(spec, element, docs)
            data |= self._unit(spec, docs)
        else:
            docs.append(f"In {spec.units}." if spec.units else "")
            if spec.bits:
                self._remark(spec, Kind.LEFT_OUT, _NO_INTEGER, spec.span)
        doc = joined(docs)
        data |= {"doc": doc} if doc else {}
        return data["type"] if set(data) == {"type"} else data

    def _type(self, spec: FieldSpec, *, is_last: bool) -> dict[str, Any]:
        if spec.type not in SERIES:
            return {"type": self._structs.name_of(self._file, spec.type, spec)}
        key = "count" if spec.type == "array" else "size"
        kind = {"string": "ascii", "bytes": "bytes"}.get(spec.type)
        if kind is None:
            kind = self._structs.name_of(self._file, element_type(spec), spec)
        if spec.size_fn is not None:
            return {"type": kind, key: self._names[spec.size_fn]}
        if spec.type == "string":
            return text_data(spec, is_last=is_last) or {}
        return {"type": kind, key: {"fill": True} if spec.size is None else spec.size}

    def _check_encoding(self, spec: FieldSpec) -> None:
        if not is_known_encoding(spec):
            reason = f"the encoding `{spec.encoding}` is unknown; it is a text as it is"
            self._remark(spec, Kind.CHANGED, reason, spec.span)

    def _meaning(self, spec: FieldSpec, element: str, docs: list[str]) -> dict[str, Any]:
        """Return names of values or bits; what they say of the whole field goes to its docs."""
        if not spec.bits:
            return {}
        if element in ("float", "double"):
            self._remark(spec, Kind.LEFT_OUT, _NO_INTEGER, spec.span)
            return {}

        def report(kind: Kind, reason: str, span: Span) -> None:
            self._remark(spec, kind, reason, span)

        is_signed = element.startswith("s")
        data = meaning(spec.bits, width(element), report, is_signed=is_signed)
        if self._counts(spec) and not data.keys() <= {"values"}:
            self._remark(spec, Kind.LEFT_OUT, "bits of a number that counts", spec.span)
            return {}
        if "bits" not in data and "flags" not in data:
            whole = [paragraphs(item.desc) for item in spec.bits if item.low == 0]
            docs += [text for text in whole if not docs[0]]
        return data

    def _unit(self, spec: FieldSpec, docs: list[str]) -> dict[str, Any]:
        unit = read_unit(spec.units)
        docs.append(unit.remark)
        return unit.keys


def _kind(spec: FieldSpec) -> str:
    if spec.type == "string":
        return "(text up to a NUL)" if spec.encoding == "null_terminated" else "(text)"
    return f"({element_type(spec)}[])" if spec.type in SERIES else f"({spec.type})"
