"""Names of topics: in MCAP files, and of a line that is served, so that one layout shows both."""

from __future__ import annotations


def topic_of(protocol: str, *path: str) -> str:
    """The name of what a sender's table is published on: `/rover/board/state`."""
    return "".join(f"/{step}" for step in (protocol, *path))
