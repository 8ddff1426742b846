"""A function that is printed and then compiled."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

from protogen.runtime.constructs import Container
from protogen.runtime.fused_parts import Steps
from protogen.runtime.pairs import Unclear


@dataclass(slots=True)
class Function:
    """Its first line, and the constants that its text uses.

    Nothing of a schema gets into the text but names of fields, which are Python's identifiers.
    """

    head: str
    lines: list[str] = field(default_factory=list)
    constants: dict[str, Any] = field(default_factory=dict)
    names: dict[int, str] = field(default_factory=dict)
    variables: int = 0

    def name(self, constant: Any) -> str:
        """What a constant is called in the text."""
        key = id(constant)  # No other one gets it: the constant is kept.
        if key not in self.names:
            name = self.names[key] = f"c{len(self.names)}"
            self.constants[name] = constant
        return self.names[key]

    def variable(self) -> str:
        """A new one."""
        self.variables += 1
        return f"v{self.variables - 1}"

    def through(self, steps: Steps, text: str) -> str:
        """The expression for a value that goes through conversions."""
        for step in steps:
            uses = {name: self.name(value) for name, value in step.uses.items()}
            text = step.text.format(v=text, **uses)
        return text

    def refuse_if(self, condition: str) -> None:
        """Let construct decide where this holds."""
        self.lines.append(f"if {condition}: raise Unclear")

    def compiled(self) -> Any:
        """The function."""
        text = "\n    ".join([f"def {self.head}:", *self.lines])
        names = {**self.constants, "Container": Container, "Unclear": Unclear}
        exec(compile(text, "<fused>", "exec"), names)  # noqa: S102 - our own text
        return names[self.head.partition("(")[0]]
