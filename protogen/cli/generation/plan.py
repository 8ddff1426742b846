"""Plan of a run of `protogen generate`: the command line over the project's settings."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING

import msgspec

from protogen.cli.exits import UsageError
from protogen.cli.generation import c_options
from protogen.schema.files import schema_files, schema_path

if TYPE_CHECKING:
    from protogen.problems import Problems
    from protogen.project.read import Project
    from protogen.project.settings import CSettings
    from protogen.targets import Target

SCHEMAS = Path("schemas")
_PYTHON = "python"
_MARKDOWN = "markdown"


class Given(msgspec.Struct, frozen=True):
    """Request of the command line; None where it said nothing."""

    schemas: Sequence[Path] | None
    output: Path | None
    targets: Sequence[str] | None
    standalone: bool | None
    c: c_options.Choice


class Plan(msgspec.Struct, frozen=True):
    """Plan of what is to be generated from what."""

    schemas: tuple[Path, ...]
    output: Path
    targets: tuple[str, ...]
    standalone: bool
    c: c_options.Choice
    pages: tuple[Path, ...]
    """Hand-written files with marked blocks."""
    prune: bool
    """True if other files of ours in the output are stale: not if only some schemas were named."""

    @property
    def references(self) -> Path | None:
        """The folder of the reference pages, if there are any."""
        return self.output / _MARKDOWN if _MARKDOWN in self.targets else None

    @property
    def options(self) -> Mapping[str, object]:
        """Dependencies of the output other than files, for a record of the run."""
        return {
            "output": self.output.as_posix(),
            "targets": self.targets,
            "standalone": self.standalone,
            "c": msgspec.structs.asdict(self.c),
            "prune": self.prune,
        }

    def emitters(self) -> list[Target]:
        """Return the targets, each with its options."""
        from protogen.targets import STANDALONE, TARGETS

        targets = {name: TARGETS[name] for name in self.targets}
        if self.standalone and _PYTHON in targets:
            targets[_PYTHON] = STANDALONE
        if not self.c.is_default and c_options.NAME in targets:
            targets[c_options.NAME] = c_options.ChosenC(self.c)
        return list(targets.values())


def plan(given: Given, project: Project | None, problems: Problems) -> Plan:
    """Merge the command line with the settings. Paths that lead nowhere are reported.

    Marked blocks are part of a whole run only, where all schemas and targets are at hand.
    """
    from protogen.project.settings import Settings

    settings = Settings() if project is None else project.settings
    folder = Path() if project is None else project.folder
    is_whole = project is not None and not given.schemas and not given.targets
    by_default = settings.python.standalone
    return Plan(
        targets=_targets(given, settings.targets),
        schemas=_schemas(given, project, problems),
        output=given.output or folder / settings.output,
        standalone=by_default if given.standalone is None else given.standalone,
        c=_c(given.c, settings.c),
        pages=_pages(project, problems) if project is not None and is_whole else (),
        prune=_is_complete(given, project),
    )


# --- options --------------------------------------------------------------------------------------


def _targets(given: Given, configured: Sequence[str] | None) -> tuple[str, ...]:
    from protogen.problems import hint_for
    from protogen.targets import DEFAULT_TARGETS, TARGETS

    for name in given.targets or ():
        if name not in TARGETS:
            message = f"there is no target `{name}`; there are {', '.join(TARGETS)}"
            raise UsageError(message, hint_for(name, TARGETS))
    names = tuple(given.targets or (DEFAULT_TARGETS if configured is None else configured))
    if given.standalone and _PYTHON not in names:
        raise UsageError(f"--standalone is for the target {_PYTHON}")
    if not given.c.is_default and c_options.NAME not in names:
        raise UsageError("--c-style, --events, --only, --sender, --c-stubs and --c-hpp are for C")
    return names


def _c(given: c_options.Choice, settings: CSettings) -> c_options.Choice:
    return c_options.Choice(
        style=given.style or settings.style,
        events=given.events or settings.events,
        only=given.only or settings.only or None,
        senders=given.senders or settings.sender or None,
        stubs=settings.stubs if given.stubs is None else given.stubs,
        hpp=settings.hpp if given.hpp is None else given.hpp,
    )


# --- files ----------------------------------------------------------------------------------------


def _schemas(given: Given, project: Project | None, problems: Problems) -> tuple[Path, ...]:
    if given.schemas:
        return schema_files(map(schema_path, given.schemas))
    if project is not None:
        from protogen.project.schemas import named_paths

        return schema_files(named_paths(project, "schemas", project.settings.schemas, problems))
    if not SCHEMAS.is_dir():
        raise UsageError(
            f"no schema is named, and there is neither a protogen.toml nor a folder `{SCHEMAS}`",
            "name one: `protogen generate rover.yaml`; or write a protogen.toml with "
            '`schemas = ["rover.yaml"]`, which is then found from every folder below it',
        )
    return schema_files([SCHEMAS])


def _pages(project: Project, problems: Problems) -> tuple[Path, ...]:
    from protogen.project.schemas import named_paths

    found = named_paths(project, "blocks", project.settings.blocks, problems)
    return tuple(dict.fromkeys(path for path in found if not path.is_dir()))


def _is_complete(given: Given, project: Project | None) -> bool:
    if given.schemas:
        return project is None and all(path.is_dir() for path in given.schemas)
    return True
