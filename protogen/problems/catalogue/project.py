"""Problems of a project: its `protogen.toml`, and marked blocks in hand-written Markdown."""

from __future__ import annotations

from protogen.problems.catalogue.code import Code

PROJECT_CODES: tuple[Code, ...] = (
    Code(
        "PG030",
        "unreadable-project",
        "The project's file can't be read",
        """\
`protogen.toml`, or `pyproject.toml` with a table `[tool.protogen]`, is TOML in UTF-8.
""",
        """\
schemas = [rover.yaml]
""",
        """\
schemas = ["rover.yaml"]
""",
        compiles=False,
    ),
    Code(
        "PG031",
        "unknown-setting",
        "The project's file has a key that means nothing",
        """\
Keys are `schemas`, `output`, `targets` and `blocks`, and the tables `python`, `c` and
`breaking`.
""",
        """\
schmas = ["rover.yaml"]
""",
        """\
schemas = ["rover.yaml"]
""",
        compiles=False,
    ),
    Code(
        "PG032",
        "wrong-setting",
        "A setting of the project has a value that it can't have",
        """\
`schemas`, `targets`, `blocks` and the names in `[c]` are lists of texts, `output` is a text,
and switches are true or false.
""",
        """\
targets = ["pyton"]
""",
        """\
targets = ["python"]
""",
        compiles=False,
    ),
    Code(
        "PG033",
        "nothing-at-path",
        "A path in the project's file leads nowhere",
        """\
Paths are relative to the folder of the file. They name files, folders of schemas, or globs
such as `boards/**/*.yaml`, of which each has to find something.
""",
        """\
blocks = ["raedme.md"]
""",
        """\
blocks = ["readme.md"]
""",
        compiles=False,
    ),
    Code(
        "PG034",
        "unknown-block",
        "A marked block names nothing of the schemas",
        """\
`<!-- protogen:rover.drive -->` is the reference of a message, `<!-- protogen:rover#frames -->` a
part of the protocol's page, by its anchor.
""",
        """\
<!-- protogen:rover.drvie -->
<!-- /protogen -->
""",
        """\
<!-- protogen:rover.drive -->
<!-- /protogen -->
""",
        compiles=False,
    ),
    Code(
        "PG035",
        "open-block",
        "A marked block has no end, or an end has no block",
        """\
Both marks stand on lines of their own. Marks inside fenced code are text.
""",
        """\
<!-- protogen:rover.drive -->
""",
        """\
<!-- protogen:rover.drive -->
<!-- /protogen -->
""",
        compiles=False,
    ),
)
