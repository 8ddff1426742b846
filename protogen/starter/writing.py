"""A name and a framing -> the text of a schema."""

from __future__ import annotations

from protogen.starter.framings import Framing


def starter_schema(name: str, framing: Framing, file: str) -> str:
    """Return a schema that compiles as it is; `file` is how its comments call it."""
    from protogen.targets.printing import environment

    title = name.replace("_", " ").capitalize()
    template = environment("protogen.starter").get_template("schema.yaml.j2")
    return template.render(name=name, title=title, file=file, framing=framing)
