"""Decisions of a schema, and the references to them."""

from __future__ import annotations

from protogen.model.protocol import Decision
from protogen.passes.context import Context, Loc, source_of
from protogen.passes.draft import Draft
from protogen.problems import hint_for


def resolve_decisions(context: Context, draft: Draft) -> None:
    """The decisions, in the order of the schema."""
    decisions = context.syntax.decisions
    draft.decisions = tuple(
        Decision(
            name=name,
            question=item.question.strip(),
            document=item.document.strip(),
            choice=item.choice.strip(),
            because=item.because.strip(),
            source=source_of(item.source),
        )
        for name, item in decisions.items()
    )
    for name, overload in context.syntax.overloads.items():
        if overload.decision is not None and not _is_known(context, overload.decision):
            loc: Loc = ("overloads", name, "decision")
            text = f"there is no decision `{overload.decision}`"
            context.error("PG165", loc, text, hint_for(overload.decision, decisions))
    for sender, frame in context.syntax.frame.items():
        for part, written in frame.items():
            if written.unprotected is not None and not _is_known(context, written.unprotected):
                loc = ("frame", sender, part, "unprotected")
                text = f"there is no decision `{written.unprotected}`"
                context.error("PG143", loc, text, hint_for(written.unprotected, decisions))


def _is_known(context: Context, name: str) -> bool:
    return name in context.syntax.decisions or context.is_lost("decisions", name)
