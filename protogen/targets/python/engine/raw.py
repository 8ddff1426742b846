"""Raw values of the fields in front, which count, select and go into formulas."""

from __future__ import annotations

from protogen.model.expressions import Operand
from protogen.runtime.attributes import attribute


def member_of(record: str, operand: Operand) -> str:
    """The expression of a member of a record that an expression names, without bits."""
    return ".".join([record, *map(attribute, operand.path)])


class Raw:
    """Names of variables for raw values. A record's variable stands for its members, too."""

    def __init__(self) -> None:
        self.raw: dict[str, str] = {}
        """The variables, by the names of fields."""

    def raw_at(self, name: str) -> str:
        """The expression of a field, or of a member inside of one: `header.count`."""
        rest = ""
        while "." in name and name not in self.raw:
            name, _, last = name.rpartition(".")
            rest = f".{attribute(last)}{rest}"
        return self.raw[name] + rest

    def raw_of(self, operand: Operand) -> str:
        """The expression of a field that an expression names, without bits."""
        return self.raw_at(operand.name)
