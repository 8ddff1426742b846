"""A name and a framing -> the text of a schema."""

from __future__ import annotations

from protogen.starter.framings import Framing, bytes_of, numbers_of


def starter_schema(name: str, framing: Framing, file: str) -> str:
    """Return a schema that compiles as it is; `file` is how its comments call it."""
    from protogen.targets.printing import environment

    return (
        environment("protogen.starter")
        .get_template("schema.yaml.j2")
        .render(
            name=name,
            title=name.replace("_", " ").capitalize(),
            file=file,
            framing=framing,
            numbers=numbers_of(framing),
            bytes=bytes_of(framing),
        )
    )
