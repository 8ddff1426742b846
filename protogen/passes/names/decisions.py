"""Decisions of a schema."""

from __future__ import annotations

from protogen.model.protocol import Decision
from protogen.passes.context import Context, source_of
from protogen.passes.draft import Draft


def resolve_decisions(context: Context, draft: Draft) -> None:
    """The decisions, in the order of the schema."""
    draft.decisions = tuple(
        Decision(
            name=name,
            question=item.question.strip(),
            document=item.document.strip(),
            choice=item.choice.strip(),
            because=item.because.strip(),
            source=source_of(item.source),
        )
        for name, item in context.syntax.decisions.items()
    )
