"""The anchors of a page, and links to them."""

from __future__ import annotations


def message_anchor(name: str) -> str:
    """Return the anchor of a message's section."""
    return f"message-{name}"


def message_link(name: str) -> str:
    """Return a link to a message of the same page."""
    return f"[{name}](#{message_anchor(name)})"


def example_anchor(message: str, example: str) -> str:
    """Return the anchor of an example."""
    return f"example-{message}-{example}"


def decision_link(name: str) -> str:
    """Return a link to a decision of the same page."""
    return f"[{name}](#decision-{name})"
