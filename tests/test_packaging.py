"""The distribution: what a user gets, and what must not be in the repository."""

from __future__ import annotations

import re
import subprocess
import sys
import zipfile
from collections.abc import Callable
from email.message import Message
from email.parser import Parser
from pathlib import Path

import pytest
from tooling import require_module

from protogen.version import VERSION


@pytest.fixture(scope="module")
def wheel(project_root: Path, tmp_path_factory: pytest.TempPathFactory) -> zipfile.ZipFile:
    require_module("hatchling")
    folder = tmp_path_factory.mktemp("wheel")
    command = [sys.executable, "-m", "pip", "wheel", "--quiet", "--disable-pip-version-check"]
    options = ["--no-deps", "--no-build-isolation", "--wheel-dir", str(folder), str(project_root)]
    subprocess.run([*command, *options], check=True)
    (path,) = folder.glob("*.whl")
    return zipfile.ZipFile(path)


def metadata_of(wheel: zipfile.ZipFile) -> Message:
    name = f"protogen_serial-{VERSION}.dist-info/METADATA"
    return Parser().parsestr(wheel.read(name).decode("utf-8"))


class TestWheel:
    def test_holds_every_module_every_template_the_library_and_the_marker_of_types(
        self, wheel: zipfile.ZipFile, project_root: Path
    ) -> None:
        package = project_root / "protogen"
        library = [*package.glob("library/*.yaml"), *package.glob("library/*.toml")]
        modules = [*package.rglob("*.py"), *package.rglob("*.j2"), package / "py.typed"]
        needed = [*modules, *library]
        names = {path.relative_to(project_root).as_posix() for path in needed}
        assert any(name.endswith(".j2") for name in names)
        assert names <= set(wheel.namelist())

    def test_holds_nothing_else(self, wheel: zipfile.ZipFile) -> None:
        tops = {name.split("/")[0] for name in wheel.namelist()}
        assert tops == {"protogen", f"protogen_serial-{VERSION}.dist-info"}
        assert not [name for name in wheel.namelist() if "__pycache__" in name]

    def test_says_what_it_needs(self, wheel: zipfile.ZipFile) -> None:
        metadata = metadata_of(wheel)
        assert metadata["Requires-Python"] == ">=3.11"
        assert metadata["License-Expression"] == "Apache-2.0"
        needed = [text for text in metadata.get_all("Requires-Dist", []) if "extra ==" not in text]
        names = {re.split(r"[<>=]", text)[0].lower() for text in needed}
        assert {"construct", "jinja2", "pydantic", "pyyaml", "rich", "typer"} <= names
        assert all(">=" in text for text in needed)

    def test_has_the_command_and_the_licence(self, wheel: zipfile.ZipFile) -> None:
        folder = f"protogen_serial-{VERSION}.dist-info"
        scripts = wheel.read(f"{folder}/entry_points.txt").decode("utf-8")
        assert "protogen = protogen.cli:main" in scripts
        licence = wheel.read(f"{folder}/licenses/LICENSE").decode("utf-8")
        assert "Apache License" in licence
        assert "END OF TERMS AND CONDITIONS" in licence


# Written in two halves each, so that this file passes its own test.
WORDS_OF_ONE_MACHINE = [
    "/wo" + "rk/",
    "/ro" + "ot/",
    "/fa" + "rm/",
    "py" + "pi.org",
    "python" + "hosted",
    "registry.np" + "mjs",
    "registry.ya" + "rnpkg",
    "deb.deb" + "ian.org",
    "proxy.go" + "lang.org",
]


def test_no_file_names_a_registry_or_a_path_of_one_machine(
    project_root: Path, require_tool: Callable[[str], str]
) -> None:
    git = require_tool("git")
    # Also files that are not committed yet, but not those that are ignored.
    command = [git, "ls-files", "-z", "--cached", "--others", "--exclude-standard"]
    listing = subprocess.run(command, cwd=project_root, capture_output=True, check=False)
    if listing.returncode:
        pytest.skip("this is no git checkout")
    names = listing.stdout.decode("utf-8").rstrip("\0").split("\0")
    texts = {name: read(project_root / name) for name in names}
    named = [
        f"{name}: {word}"
        for name, text in texts.items()
        for word in WORDS_OF_ONE_MACHINE
        if word in text
    ]
    assert named == []


def read(path: Path) -> str:
    return path.read_text(encoding="utf-8", errors="replace") if path.is_file() else ""


def test_an_editable_install_does_not_show_the_folder_of_examples(tmp_path: Path) -> None:
    """Else `import generated.python.rover` of a project could find protogen's own modules."""
    program = "import protogen, generated"
    done = subprocess.run(
        [sys.executable, "-c", program], cwd=tmp_path, capture_output=True, text=True, check=False
    )
    assert "No module named 'generated'" in done.stderr
