"""Settings in `protogen.toml`, or in `[tool.protogen]` of `pyproject.toml`."""

from __future__ import annotations

from typing import Literal

from pydantic import BaseModel, ConfigDict, Field, StrictBool, StrictStr

Words = tuple[StrictStr, ...]


class _Table(BaseModel):
    model_config = ConfigDict(extra="forbid", frozen=True)


class PythonSettings(_Table):
    """`[python]`: how Python is printed."""

    standalone: StrictBool = Field(False, description="Python that carries its runtime along.")


class CSettings(_Table):
    """`[c]`: how C is printed, and what of the schemas."""

    style: Literal["split", "single"] | None = Field(None, description="Two files, or one header.")
    events: Literal["all", "messages"] | None = Field(None, description="What decoders report.")
    only: Words = Field((), description="The messages to print. Empty: all.")
    sender: Words = Field((), description="The endpoints whose messages are printed. Empty: all.")
    stubs: StrictBool = Field(False, description="A source with empty handlers, made once.")
    hpp: StrictBool = Field(False, description="A header for C++ over that of C.")


class BreakingSettings(_Table):
    """`[breaking]`: which changes of a schema count as breaking."""

    use: Words = Field((), description="The rules, or groups of them, that are looked at.")
    except_: Words = Field((), alias="except", description="Rules among them that are not.")
    ignore: dict[StrictStr, Words] = Field({}, description="Places where a rule does not count.")


class Settings(_Table):
    """The whole file. Paths are relative to the folder that it stands in."""

    schemas: Words = Field(("schemas",), description="Schema files, folders of them, and globs.")
    output: StrictStr = Field("generated", description="The folder for all targets.")
    targets: Words | None = Field(None, description="The targets. Absent: all. Empty: none.")
    blocks: Words = Field((), description="Markdown files, or globs, with marked blocks to fill.")
    python: PythonSettings = PythonSettings()
    c: CSettings = CSettings()
    breaking: BreakingSettings = BreakingSettings()
