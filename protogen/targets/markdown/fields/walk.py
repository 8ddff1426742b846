"""Every field of a message, also those inside structs, arrays and cases."""

from __future__ import annotations

from collections.abc import Iterable, Iterator

from protogen.model.payload_plan import AnyStep, ChooseStep, RecordStep, RepeatStep
from protogen.model.types import Field
from protogen.targets.markdown.text.path import ROOT, Path


def named_fields(steps: Iterable[AnyStep], path: Path = ROOT) -> Iterator[tuple[Path, Field]]:
    """Yield each field with its path, such as `points[i].range`, in wire order."""
    for step in steps:
        inner = path.field(step.name)
        yield inner, step.field
        yield from _inside(step, inner)


def _inside(step: AnyStep, path: Path) -> Iterator[tuple[Path, Field]]:
    match step:
        case RecordStep():
            yield from named_fields(step.steps, path)
        case RepeatStep():
            yield from _inside(step.element, path.element())
        case ChooseStep():
            for case in step.cases:
                yield from _inside(case.step, path.case(case.name))
