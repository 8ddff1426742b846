"""Every field of a message with its path, also those inside structs, arrays and cases."""

from __future__ import annotations

from collections.abc import Iterable, Iterator

import msgspec

from protogen.model.payload_plan import (
    AnyStep,
    ChooseStep,
    NumberStep,
    OptionalStep,
    RecordStep,
    RegionStep,
    RepeatStep,
)
from protogen.model.types import Field


class Path(msgspec.Struct, frozen=True):
    """The names that lead to a field, as people write them and as an anchor."""

    shown: str = ""
    anchor: str = ""
    """Unlike `shown` it tells the cases of a switch apart, which may have fields of one name."""

    def field(self, name: str) -> Path:
        """Return the path of a field."""
        return Path(f"{self.shown}.{name}" if self.shown else name, f"{self.anchor}-{name}")

    def element(self) -> Path:
        """Return the path of an element of an array."""
        return Path(f"{self.shown}[i]", self.anchor)

    def case(self, name: str) -> Path:
        """Return the path of one case of a switch."""
        return Path(self.shown, f"{self.anchor}-{name}")


ROOT = Path()
"""The path of the message itself."""


def named_fields(steps: Iterable[AnyStep], path: Path = ROOT) -> Iterator[tuple[Path, Field]]:
    """Yield each field with its path, such as `points[i].range`, in wire order."""
    for step in steps:
        inner = path.field(step.name)
        yield inner, step.field
        yield from _inside(step, inner)


def fields_inside(steps: Iterable[AnyStep]) -> Iterator[Field]:
    """Yield the same fields without their paths."""
    for step in steps:
        yield step.field
        if not isinstance(step, NumberStep):
            yield from (field for _, field in _inside(step, ROOT))


def _inside(step: AnyStep, path: Path) -> Iterator[tuple[Path, Field]]:
    match step:
        case RecordStep():
            yield from named_fields(step.steps, path)
        case RepeatStep():
            yield from _inside(step.element, path.element())
        case OptionalStep() | RegionStep():
            yield from _inside(step.step, path)
        case ChooseStep():
            for case in step.cases:
                yield from _inside(case.step, path.case(case.name))
