"""One of several steps, as branches of a function that reads or writes it."""

from __future__ import annotations

from collections.abc import Callable

from protogen.model.payload_plan import AnyStep, ChooseStep, RestStep
from protogen.targets.typescript.formulas import number
from protogen.targets.typescript.literals import text
from protogen.targets.typescript.scope import Scope


def choose(
    scope: Scope,
    step: ChooseStep,
    branch: Callable[[AnyStep | RestStep], None],
    by: str,
    at: str,
) -> None:
    """Print a branch for each case; the reader or writer `by` refuses a value without one."""
    if isinstance(step.selector, int) and (chosen := step.case(step.selector)) is not None:
        branch(chosen)
        return
    selector = scope.variable("selector")
    scope.line(f"const {selector} = {number(step.selector, scope.look)};")
    head = "if"
    for case in step.cases:
        if case.value is None:
            continue
        with scope.block(f"{head} ({selector} === {case.value})"):
            branch(case.step)
        head = "else if"
    with scope.block("else" if head != "if" else "if (true)"):
        if step.otherwise is not None:
            branch(step.otherwise.step)
        elif step.rest is not None:
            branch(step.rest)
        else:
            scope.line(f"throw {by}.noCase({selector}, {text(step.expression.text)}, {at});")
