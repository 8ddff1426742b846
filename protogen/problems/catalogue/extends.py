"""Problems of a dialect: what it extends, and how it says what is different."""

from __future__ import annotations

from protogen.problems.catalogue.code import Code

EXTENDS_CODES: tuple[Code, ...] = (
    Code(
        "PG020",
        "circular-extends",
        "Schemas extend each other in a circle",
        """\
A dialect states what is different from its base, so there must be a schema that extends
nothing.
""",
        """\
# file: a.yaml
extends: b.yaml
# file: b.yaml
extends: a.yaml
""",
        """\
# file: a.yaml
extends: b.yaml
# file: b.yaml
protocol: b
""",
    ),
    Code(
        "PG021",
        "extends-outside",
        "A schema extends a file outside of the project",
        """\
What a schema means may not depend on files that do not travel with it. The project is the
nearest folder above the schema that holds `.git`, `pyproject.toml` or `protogen.toml`;
without one it is the current folder, if the schema is inside, or else the schema's own.
Symbolic links are followed before the comparison.
""",
        """\
# file: dialect.yaml
extends: ../../../../../../../../../../elsewhere/base.yaml
""",
        """\
# file: dialect.yaml
extends: base.yaml
# file: base.yaml
protocol: base
""",
    ),
    Code(
        "PG022",
        "unreadable-base",
        "The schema that is extended can't be read",
        """\
`extends` is a path from the folder of the file that it stands in, or `library:` and the name of a
schema that is installed with protogen.
""",
        """\
# file: dialect.yaml
extends: bsae.yaml
# file: base.yaml
protocol: base
""",
        """\
# file: dialect.yaml
extends: base.yaml
# file: base.yaml
protocol: base
""",
    ),
    Code(
        "PG023",
        "unknown-item",
        "`rename` or `remove` names nothing",
        """\
The name is not in the mapping of the base that stands in this place. `rename` comes first:
`remove` uses the new names.
""",
        """\
# file: dialect.yaml
extends: base.yaml
messages:
  remove: [gryo]
# file: base.yaml
messages:
  gyro: {id: 1}
  sonar: {id: 2}
""",
        """\
# file: dialect.yaml
extends: base.yaml
messages:
  remove: [gyro]
# file: base.yaml
messages:
  gyro: {id: 1}
  sonar: {id: 2}
""",
    ),
    Code(
        "PG024",
        "unknown-neighbour",
        "`after` or `before` names nothing",
        """\
An item is placed by a neighbour in the same mapping, under its name in the dialect.
""",
        """\
# file: dialect.yaml
extends: base.yaml
messages:
  compass: {id: 3, after: gryo}
# file: base.yaml
messages:
  gyro: {id: 1}
  sonar: {id: 2}
""",
        """\
# file: dialect.yaml
extends: base.yaml
messages:
  compass: {id: 3, after: gyro}
# file: base.yaml
messages:
  gyro: {id: 1}
  sonar: {id: 2}
""",
    ),
    Code(
        "PG025",
        "directive-misused",
        "A directive of a dialect is misused",
        """\
In a mapping that meets a mapping of the base, `rename: {old: new}` gives other names,
`remove: [name, ...]` takes items away and `replace: true` starts from nothing. `after:
name` or `before: name` in an item's own mapping gives it a place. An item that happens to
be called like a directive is written as a mapping.
""",
        """\
# file: dialect.yaml
extends: base.yaml
messages:
  remove: gyro
# file: base.yaml
messages:
  gyro: {id: 1}
  sonar: {id: 2}
""",
        """\
# file: dialect.yaml
extends: base.yaml
messages:
  remove: [gyro]
# file: base.yaml
messages:
  gyro: {id: 1}
  sonar: {id: 2}
""",
    ),
)
