"""Functions of C that take a struct's values from a driver's input, or write them to its output.

The bytes are those of `protogen.fuzzing.c_values`. One function does both, so that they can't
differ.
"""

from __future__ import annotations

from protogen.c_language.expressions import FormulaPrinter
from protogen.model.payload_plan import (
    AnyStep,
    BytesStep,
    ConstantStep,
    Formula,
    NumberStep,
    OptionalStep,
    PartStep,
    PayloadPlan,
    RepeatStep,
    RestStep,
)
from protogen.targets.c.lines import Lines, function
from protogen.targets.c.payload.helpers import Helpers
from protogen.targets.c.payload.walk import Walk
from protogen.targets.c.spelling import Names


def exchange_function(name: str, struct: str, plan: PayloadPlan, names: Names) -> str:
    """The function for a message's struct."""
    lines = Lines()
    lines.add("(void)message;")
    _Exchange(Helpers(names), lines).message(plan)
    return function(f"static void {name}", (f"{struct} *message",), lines)


class _Exchange(Walk):
    def step(self, step: AnyStep, place: str) -> None:
        """A step of any kind; in front of what has a member for its number goes that number."""
        if isinstance(step, OptionalStep) and step.presence.member:
            self._scalar(self._records[-1] + step.presence.member)
        if isinstance(step, BytesStep | RepeatStep) and step.count.member:
            self._scalar(self.filled(step.count))
        if step.holds_values:
            super().step(step, place)

    def printer(self, formula: Formula) -> FormulaPrinter:
        """Prints a formula without the functions of the module."""
        references = formula.references
        return FormulaPrinter(formula, lambda operand: self.referred(references[operand.name]))

    def _scalar(self, place: str) -> None:
        self.lines.add(f"scalar(&{place}, (uint8_t)sizeof {place});")

    def constant(self, step: ConstantStep) -> None:
        """Nothing, as no member holds it."""

    def number(self, step: NumberStep, place: str) -> None:
        """A number."""
        self._scalar(place)

    def part(self, step: PartStep, place: str) -> None:
        """A number of the frame."""
        self._scalar(place)

    def bytes(self, step: BytesStep | RestStep, place: str, count: int | str) -> None:
        """A text, or bytes."""
        self.lines.add(f"octets({place}, (size_t){count});")

    def repeat(self, step: RepeatStep, place: str, count: int | str) -> None:
        """Elements."""
        if step.element.holds_values:
            self.elements(step, place, count)

    def rest(self, step: RestStep, place: str) -> None:
        """The bytes of a value without a case."""
        self._scalar(f"{place}.{step.count.member}")
        super().rest(step, place)
