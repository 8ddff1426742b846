"""`diff`, `breaking` and `rules`, as commands: versions, formats, what counts, what goes wrong."""

from __future__ import annotations

import json
import shutil
from pathlib import Path

import pytest
from cli_support import start
from repositories import GONE, OLD, SECOND, answer, complaint, git, protogen
from tooling import require_tool

from protogen.evolution.rules import RULES, Rule

RESERVED = f"{GONE}reserved: {{identities: [{{from: board, id: 3}}]}}\n"
TURNED = OLD.replace("type: uint16, unit: mm", "type: uint16, byte_order: big, unit: cm")
DIALECT = """\
protocol: demo_two
extends: ../demo.yaml
messages:
  pong: {id: 4, from: board, fields: {number: uint8}}
"""


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    for name, text in {"old": OLD, "gone": GONE, "reserved": RESERVED, "turned": TURNED}.items():
        (tmp_path / f"{name}.yaml").write_text(text, encoding="utf-8")
    return tmp_path


def rules_in(output: str) -> list[str]:
    return [item["rule"] for report in json.loads(output) for item in report["findings"]]


# --- formats --------------------------------------------------------------------------------------


class TestDiff:
    def test_text_has_rule_place_frame_and_mend(self, folder: Path) -> None:
        lines = answer(folder, "diff", "old.yaml", "gone.yaml", code=1).splitlines()
        assert lines == [
            "gone.yaml: ping",
            "  WIRE [message-deleted] ping: a message is gone: identity 0x03 is free for another"
            " meaning",
            "    at old.yaml:14 (old)",
            "    affects new receiver of old frames: rejected",
            "    old board sends ping AA 03 00 68 2A; new finds no message in it: unknown",
            "    fix: reserve its identity",
        ]

    def test_nothing_changed(self, folder: Path) -> None:
        assert answer(folder, "diff", "old.yaml", "old.yaml", code=0) == "demo: no change\n"

    def test_comments_and_the_order_of_keys_are_no_change(self, folder: Path) -> None:
        text = OLD.replace("{id: 3, from: board", "{from: board, summary: A ping, id: 3")
        (folder / "same.yaml").write_text(f"# Seen.\n{text}", encoding="utf-8")
        answer(folder, "diff", "old.yaml", "same.yaml", code=0)

    def test_markdown_is_a_changelog_entry(self, folder: Path) -> None:
        output = answer(folder, "diff", "old.yaml", "gone.yaml", "--format", "markdown", code=1)
        assert output.splitlines() == [
            "### demo",
            "",
            "- **ping**",
            "  - ping: a message is gone: identity 0x03 is free for another meaning"
            " (WIRE, rejected)",
            "    - old board sends ping AA 03 00 68 2A; new finds no message in it: unknown",
            "",
        ]

    def test_markdown_without_changes(self, folder: Path) -> None:
        output = answer(folder, "diff", "old.yaml", "old.yaml", "--format", "markdown", code=0)
        assert "No change." in output

    def test_json_holds_everything(self, folder: Path) -> None:
        output = answer(folder, "diff", "old.yaml", "turned.yaml", "--format", "json", code=1)
        (report,) = json.loads(output)
        assert report["protocol"] == "demo"
        assert report["old"] != report["new"]
        order, unit = report["findings"]
        assert (order["rule"], order["category"]) == ("field-byte-order", "WIRE")
        assert (unit["rule"], unit["category"]) == ("field-unit", "VALUE")
        assert (order["message"], order["place"]) == ("reading", "reading.value")
        assert (order["affects"], order["harm"]) == ("both", "misread")
        old, new = order["witnesses"]
        assert (old["sends"], new["sends"]) == ("old", "new")
        payload = bytes.fromhex(old["frame"].replace("ab8a", "aa").replace("ab8b", "ab"))[2:4]
        assert old["sent"]["value"].startswith(f"{int.from_bytes(payload, 'little')} (")
        assert old["received"]["value"].startswith(f"{int.from_bytes(payload, 'big')} (")

    def test_json_without_changes(self, folder: Path) -> None:
        output = answer(folder, "diff", "old.yaml", "old.yaml", "--format", "json", code=0)
        assert rules_in(output) == []

    def test_what_hurts_nobody_is_a_change(self, folder: Path) -> None:
        output = answer(folder, "diff", "old.yaml", "reserved.yaml", code=1)
        assert "NONE [message-reserved] ping" in output
        assert "affects" not in output
        assert "fix" not in output


class TestBreaking:
    def test_refuses_with_a_frame(self, folder: Path) -> None:
        output = answer(folder, "breaking", "old.yaml", "gone.yaml", code=1)
        assert "WIRE [message-deleted] ping" in output
        assert "AA 03 00 68 2A" in output

    def test_passes_what_is_reserved(self, folder: Path) -> None:
        output = answer(folder, "breaking", "old.yaml", "reserved.yaml", code=0)
        assert output == "nothing is broken\ncompared 1 schema, 0 new, 0 gone\n"

    def test_json(self, folder: Path) -> None:
        command = ["breaking", "old.yaml", "gone.yaml", "--format", "json"]
        assert rules_in(answer(folder, *command, code=1)) == ["message-deleted"]
        command = ["breaking", "old.yaml", "reserved.yaml", "--format", "json"]
        assert rules_in(answer(folder, *command, code=0)) == []

    def test_github_names_the_line_in_new(self, folder: Path) -> None:
        command = ["breaking", "old.yaml", "turned.yaml", "--format", "github"]
        lines = answer(folder, *command, code=1).splitlines()
        assert len(lines) == 2
        begins = (
            "::error file=turned.yaml,line=13,title=field-byte-order::turned.yaml: reading.value: "
        )
        assert lines[0].startswith(begins)
        assert "%0Aold board sends reading AA 01 " in lines[0]
        assert "%0Anew board sends reading AA 01 " in lines[0]

    def test_github_of_a_message_that_is_gone(self, folder: Path) -> None:
        command = ["breaking", "old.yaml", "gone.yaml", "--format", "github"]
        (line,) = answer(folder, *command, code=1).splitlines()
        assert line.startswith("::error file=gone.yaml,title=message-deleted::gone.yaml: ping: ")

    def test_github_prints_nothing_without_findings(self, folder: Path) -> None:
        command = ["breaking", "old.yaml", "reserved.yaml", "--format", "github"]
        assert answer(folder, *command, code=0) == ""

    @pytest.mark.parametrize(
        ("options", "left"),
        [
            ([], ["field-byte-order", "field-unit"]),
            (["--use", "VALUE"], ["field-unit"]),
            (["--use", "field-byte-order"], ["field-byte-order"]),
            (["--use", "VALUE", "--use", "field-byte-order"], ["field-byte-order", "field-unit"]),
            (["--use", "SOURCE"], []),
            (["--except", "field-unit"], ["field-byte-order"]),
            (["--except", "field-unit", "--except", "field-byte-order"], []),
            (["--ignore", "reading.value"], []),
            (["--ignore", "reading.*"], []),
            (["--ignore", "ping.*"], ["field-byte-order", "field-unit"]),
            (["--ignore", "field-unit=reading.*"], ["field-byte-order"]),
            (["--ignore", "*=reading.value"], []),
            (["--ignore", "demo.reading.*"], []),
            (["--ignore", "demo"], []),
            (["--ignore", "field-unit=demo"], ["field-byte-order"]),
            (["--ignore", "dem"], ["field-byte-order", "field-unit"]),
            (["--ignore", "field-unit=demo.*"], ["field-byte-order"]),
            (["--ignore", "other.reading.*"], ["field-byte-order", "field-unit"]),
        ],
        ids=" ".join,
    )
    def test_what_counts(self, options: list[str], left: list[str], folder: Path) -> None:
        command = ["breaking", "old.yaml", "turned.yaml", "--format", "json", *options]
        output = answer(folder, *command, code=1 if left else 0)
        assert sorted(set(rules_in(output))) == left

    def test_an_ignore_that_matches_nothing_is_reported(self, folder: Path) -> None:
        ignored = ["--ignore", "reading.*", "--ignore", "field-unit=lamp.*"]
        done = protogen(folder, "breaking", "old.yaml", "turned.yaml", *ignored)
        assert done.exit_code == 0
        assert done.stderr == (
            "warning: `field-unit=lamp.*` is to be ignored and matches no change\n"
        )

    @pytest.mark.parametrize(
        ("versions", "words"),
        [
            (("1.2.0", "1.2.0"), "new.yaml: this needs a new major version; `version` is 1.2.0"),
            (("1.2.0", "1.3.0"), "this needs a new major version; `version` is 1.3.0, was 1.2.0"),
            (("1.2.0", "2.0.0"), ""),
            (("0.2", "0.3"), ""),
            (("0.2.1", "0.2.2"), "this needs a new major version"),
            (("red", "green"), "this needs a new major version; `version` is green, was red"),
        ],
    )
    def test_says_which_version_is_needed(
        self, versions: tuple[str, str], words: str, folder: Path
    ) -> None:
        for name, text, version in zip(("a", "new"), (OLD, TURNED), versions, strict=True):
            stated = f'{text}version: "{version}"\n'
            (folder / f"{name}.yaml").write_text(stated, encoding="utf-8")
        output = answer(folder, "breaking", "a.yaml", "new.yaml", code=1)
        assert words in output
        assert ("needs a new" in output) == bool(words)
        output = answer(folder, "breaking", "a.yaml", "new.yaml", "--format", "json", code=1)
        assert json.loads(output)[0]["needs"] == "major"

    def test_several_schemas_against_one(self, folder: Path) -> None:
        command = ["breaking", "reserved.yaml", "gone.yaml", "--against", "old.yaml"]
        output = answer(folder, *command, "--format", "json", code=1)
        assert [report["schema"] for report in json.loads(output)] == ["reserved.yaml", "gone.yaml"]
        assert rules_in(output) == ["message-deleted"]


@pytest.mark.parametrize("rule", RULES, ids=lambda rule: rule.name)
def test_rules_explains_each_with_an_example(rule: Rule, folder: Path) -> None:
    output = answer(folder, "rules", rule.name, code=0)
    assert output.startswith(f"{rule.name} {rule.category.value}: {rule.about}\n")
    assert f"[{rule.name}]" in output
    assert "\n- " in output or "\n-" in output or "\n+" in output
    (entry,) = json.loads(answer(folder, "rules", rule.name, "--format", "json", code=0))
    assert entry["before"] != entry["after"]
    named = [item for item in entry["findings"] if item["rule"] == rule.name]
    assert named
    is_shown = rule.category.value in ("WIRE", "VALUE") and rule.by_frame
    assert all(bool(item["witnesses"]) == is_shown for item in named)


def test_rules_as_json(folder: Path) -> None:
    listed = json.loads(answer(folder, "rules", "--format", "json", code=0))
    assert [item["rule"] for item in listed] == [rule.name for rule in RULES]


def test_a_rule_that_is_not_there(folder: Path) -> None:
    words = complaint(folder, "rules", "field-scal")
    assert "there is no rule `field-scal`" in words
    assert "did you mean `field-scale`?" in words


def test_rules_lists_them_all(folder: Path) -> None:
    done = start("rules", cwd=folder, NO_COLOR="1", COLUMNS="240")
    assert done.returncode == 0
    output = done.stdout.decode()
    for rule in RULES:
        assert f"{rule.name} " in output
        assert rule.about in output


# --- versions -------------------------------------------------------------------------------------


class TestFolders:
    def test_schemas_are_compared_by_their_paths(self, folder: Path) -> None:
        for name, texts in {"was": (OLD, OLD), "is": (OLD, GONE)}.items():
            (folder / name / "inner").mkdir(parents=True)
            (folder / name / "same.yaml").write_text(texts[0], encoding="utf-8")
            (folder / name / "inner" / "edited.yaml").write_text(texts[1], encoding="utf-8")
        output = answer(folder, "breaking", "was", "is", "--format", "json", code=1)
        found = {report["schema"]: len(report["findings"]) for report in json.loads(output)}
        assert found == {"same.yaml": 0, "inner/edited.yaml": 1}

    def test_schemas_that_come_and_go(self, folder: Path) -> None:
        for name, text in {"was/first": OLD, "is/second": SECOND}.items():
            file = folder / f"{name}.yaml"
            file.parent.mkdir()
            file.write_text(text, encoding="utf-8")
        output = answer(folder, "diff", "was", "is", code=1)
        assert sorted(output.splitlines()) == ["first.yaml is gone", "second.yaml is new"]
        output = answer(folder, "diff", "was", "is", "--format", "json", code=1)
        texts = {report["schema"]: report["text"] for report in json.loads(output)}
        assert texts == {"first.yaml": "is gone", "second.yaml": "is new"}
        lines = answer(folder, "breaking", "was", "is", code=1).splitlines()
        assert lines == [
            "first.yaml: demo",
            "  WIRE [schema-deleted] first.yaml: a schema is gone: demo had reading, ping",
            "    affects new receiver of old frames: rejected",
            "    old board sends ping AA 03 00 68 2A; new finds no message in it: nobody listens",
            "    fix: keep it until nobody speaks it any more",
            "first.yaml: this needs a new major version",
            "compared 0 schemas, 1 new, 1 gone",
        ]
        output = answer(folder, "breaking", "was", "is", "--format", "github", code=1)
        assert output.startswith("::error title=schema-deleted::first.yaml: first.yaml: ")
        ignored = ["--ignore", "schema-deleted=first.yaml"]
        output = answer(folder, "breaking", "was", "is", *ignored, code=0)
        assert output == "nothing is broken\ncompared 0 schemas, 1 new, 1 gone\n"

    def test_a_schema_that_moved_is_the_same(self, folder: Path) -> None:
        for name, text in {"was/first": OLD, "is/inner/second": GONE}.items():
            file = folder / f"{name}.yaml"
            file.parent.mkdir(parents=True)
            file.write_text(text, encoding="utf-8")
        output = answer(folder, "breaking", "was", "is", "--format", "json", code=1)
        assert rules_in(output) == ["message-deleted"]

    def test_a_folder_without_schemas(self, folder: Path) -> None:
        (folder / "none").mkdir()
        words = complaint(folder, "breaking", "old.yaml", "none")
        assert "the folder `none` holds no schema" in words


@pytest.fixture
def repository(folder: Path) -> Path:
    """A repository whose only commit has `schemas/demo.yaml` and a dialect of it."""
    require_tool("git")
    (folder / "schemas" / "dialects").mkdir(parents=True)
    (folder / "schemas" / "demo.yaml").write_text(OLD, encoding="utf-8")
    (folder / "schemas" / "dialects" / "two.yaml").write_text(DIALECT, encoding="utf-8")
    git(folder, "init", "--quiet", "--initial-branch", "main")
    git(folder, "add", "schemas")
    git(folder, "commit", "--quiet", "--message", "First")
    return folder


class TestGit:
    def test_a_file_of_a_revision(self, repository: Path) -> None:
        new = "schemas/demo.yaml"
        old = f"git:main:{new}"
        answer(repository, "diff", old, new, code=0)
        (repository / new).write_text(GONE, encoding="utf-8")
        assert "[message-deleted] ping" in answer(repository, "diff", old, new, code=1)
        assert "[message-added] ping" in answer(repository, "diff", new, old, code=1)

    @pytest.mark.parametrize("new", ["schemas", "schemas/demo.yaml", "schemas/dialects/two.yaml"])
    def test_against_a_revision(self, new: str, repository: Path) -> None:
        command = ["breaking", new, "--against", "git:HEAD"]
        count = "2 schemas" if new == "schemas" else "1 schema"
        words = f"nothing is broken\ncompared {count}, 0 new, 0 gone\n"
        assert answer(repository, *command, code=0) == words
        # A dialect changes with what it extends.
        (repository / "schemas" / "demo.yaml").write_text(TURNED, encoding="utf-8")
        output = answer(repository, *command, "--format", "json", code=1)
        rules = rules_in(output)
        assert set(rules) == {"field-byte-order", "field-unit"}
        assert len(rules) == (4 if new == "schemas" else 2)

    def test_a_finding_that_a_dialect_shares_is_printed_once(self, repository: Path) -> None:
        (repository / "schemas" / "demo.yaml").write_text(GONE, encoding="utf-8")
        command = ["breaking", "schemas", "--against", "git:HEAD"]
        lines = answer(repository, *command, code=1).splitlines()
        assert lines.count("    fix: reserve its identity") == 1
        assert lines[0] == "demo.yaml: ping"
        assert "  the same in dialects/two.yaml" in lines
        assert len(answer(repository, *command, "--format", "github", code=1).splitlines()) == 1

    def test_github_has_paths_below_the_repository(self, repository: Path) -> None:
        (repository / "schemas" / "demo.yaml").write_text(TURNED, encoding="utf-8")
        command = ["breaking", "demo.yaml", "--against", "git:HEAD", "--format", "github"]
        output = answer(repository / "schemas", *command, code=1)
        assert output.startswith("::error file=schemas/demo.yaml,line=13,")

    def test_two_revisions(self, repository: Path) -> None:
        (repository / "schemas" / "demo.yaml").write_text(GONE, encoding="utf-8")
        git(repository, "commit", "--quiet", "--all", "--message", "Second")
        command = ["breaking", "git:HEAD~1:schemas/demo.yaml", "git:HEAD:schemas/demo.yaml"]
        assert "[message-deleted]" in answer(repository, *command, code=1)

    def test_from_a_folder_inside(self, repository: Path) -> None:
        inner = repository / "schemas"
        (inner / "demo.yaml").write_text(GONE, encoding="utf-8")
        # As git has them: paths below where one is, or below the top.
        for old in ("git:main:demo.yaml", "git:main:schemas/demo.yaml"):
            assert "[message-deleted]" in answer(inner, "breaking", old, "demo.yaml", code=1)
        command = ["breaking", "demo.yaml", "--against", "git:main"]
        assert "[message-deleted]" in answer(inner, *command, code=1)

    def test_leaves_the_working_tree_alone(self, repository: Path) -> None:
        (repository / "schemas" / "demo.yaml").write_text(GONE, encoding="utf-8")
        before = sorted(path for path in repository.rglob("*") if ".git" not in path.parts)
        answer(repository, "breaking", "schemas", "--against", "git:main", code=1)
        assert before == sorted(path for path in repository.rglob("*") if ".git" not in path.parts)
        assert (repository / "schemas" / "demo.yaml").read_text(encoding="utf-8") == GONE

    @pytest.mark.parametrize("new", ["schemas", "schemas/demo.yaml"])
    def test_a_schema_that_is_gone_since(self, new: str, repository: Path) -> None:
        for file in (repository / "schemas").rglob("*.yaml"):
            file.unlink()
        output = answer(
            repository, "breaking", new, "--against", "git:HEAD", "--format", "json", code=1
        )
        found = {report["schema"]: report["protocol"] for report in json.loads(output)}
        names = {"demo.yaml": "demo", "dialects/two.yaml": "demo_two"}
        assert found == (names if new == "schemas" else {new: "demo"})
        assert set(rules_in(output)) == {"schema-deleted"}

    def test_a_schema_that_is_new_since(self, repository: Path) -> None:
        (repository / "schemas" / "other.yaml").write_text(SECOND, encoding="utf-8")
        output = answer(repository, "breaking", "schemas", "--against", "git:HEAD", code=0)
        assert output == "nothing is broken\ncompared 2 schemas, 1 new, 0 gone\n"

    def test_a_schema_that_never_was(self, repository: Path) -> None:
        words = complaint(repository, "breaking", "nix.yaml", "--against", "git:HEAD")
        assert "there is no `HEAD:nix.yaml`" in words

    def test_no_such_revision(self, repository: Path) -> None:
        words = complaint(repository, "breaking", "schemas", "--against", "git:nowhere")
        assert "git has no revision `nowhere` here" in words

    def test_no_such_file_in_a_revision(self, repository: Path) -> None:
        words = complaint(repository, "diff", "git:main:other.yaml", "schemas/demo.yaml")
        assert "there is no `main:other.yaml`" in words

    def test_a_file_outside_of_the_repository(self, repository: Path) -> None:
        assert "git" in complaint(repository, "diff", "git:main:../other.yaml", "old.yaml")

    def test_a_revision_without_a_file(self, repository: Path) -> None:
        words = complaint(repository, "diff", "schemas/demo.yaml", "git:main")
        assert "`git:main` names no file: write `git:main:PATH`" in words


# --- a gate that compares nothing -----------------------------------------------------------------


class TestNothingCompared:
    """A gate that compared nothing must not pass."""

    def test_a_schema_alone_that_is_new(self, repository: Path) -> None:
        (repository / "schemas" / "other.yaml").write_text(SECOND, encoding="utf-8")
        command = ["breaking", "schemas/other.yaml", "--against", "git:HEAD"]
        words = complaint(repository, *command)
        assert "nothing was compared: git:HEAD holds none of these schemas" in words
        assert "it holds schemas/demo.yaml, schemas/dialects/two.yaml" in words.replace("\n", " ")

    @pytest.mark.parametrize("new", ["schemas/renamed.yaml", "protocols", "protocols/demo.yaml"])
    def test_a_schema_that_was_moved_is_compared_with_what_it_was(
        self, new: str, repository: Path
    ) -> None:
        where = repository / new
        if where.parent == repository:
            (repository / "schemas").rename(where)
            where /= "demo.yaml"
        else:
            where.parent.mkdir(exist_ok=True)
            (repository / "schemas" / "demo.yaml").rename(where)
        where.write_text(GONE, encoding="utf-8")
        output = answer(repository, "breaking", new, "--against", "git:HEAD", code=1)
        assert "WIRE [message-deleted] ping" in output
        assert output.endswith(
            ("compared 1 schema, 0 new, 0 gone\n", "compared 2 schemas, 0 new, 0 gone\n")
        )

    def test_a_schema_that_is_gone_where_the_others_were_moved(self, repository: Path) -> None:
        (repository / "schemas" / "second.yaml").write_text(SECOND, encoding="utf-8")
        git(repository, "add", "--all")
        git(repository, "commit", "--quiet", "--message", "Two beside each other")
        git(repository, "mv", "schemas", "protocols")
        (repository / "protocols" / "second.yaml").unlink()
        output = answer(repository, "breaking", "protocols", "--against", "git:HEAD", code=1)
        assert "WIRE [schema-deleted] schemas/second.yaml" in output
        assert output.endswith("compared 2 schemas, 0 new, 1 gone\n")

    def test_attributes_for_releases_take_no_schema_out(self, repository: Path) -> None:
        (repository / ".gitattributes").write_text("*.yaml export-ignore\n")
        git(repository, "add", "--all")
        git(repository, "commit", "--quiet", "--message", "Attributes")
        (repository / "schemas" / "demo.yaml").write_text(GONE, encoding="utf-8")
        output = answer(repository, "breaking", "schemas", "--against", "git:HEAD", code=1)
        assert "WIRE [message-deleted] ping" in output

    @pytest.mark.parametrize("is_absolute", [False, True])
    def test_links_lead_to_what_the_revision_has(self, is_absolute: bool, project: Path) -> None:
        real = project / "real"
        (project / "schemas").rename(real)
        (project / "schemas").mkdir()
        target = real if is_absolute else Path("../real")
        (project / "schemas" / "demo.yaml").symlink_to(target / "demo.yaml")
        (project / "schemas" / "loop").symlink_to("loop")
        git(project, "add", "--all")
        git(project, "commit", "--quiet", "--message", "Links")
        (real / "demo.yaml").write_text(GONE, encoding="utf-8")
        output = answer(project, "breaking", code=1)
        assert "WIRE [message-deleted] ping" in output
        assert output.endswith("compared 1 schema, 0 new, 0 gone\n")

    def test_a_link_out_of_the_repository(
        self, project: Path, tmp_path_factory: pytest.TempPathFactory
    ) -> None:
        outside = tmp_path_factory.mktemp("elsewhere") / "outside.yaml"
        (project / "schemas" / "demo.yaml").rename(outside)
        (project / "schemas" / "demo.yaml").symlink_to(outside)
        git(project, "add", "--all")
        git(project, "commit", "--quiet", "--message", "Link")
        assert "is not in the repository" in complaint(project, "breaking").replace("\n", " ")

    def test_a_lock_of_other_schemas(self, project: Path) -> None:
        other = project / "elsewhere" / "second.yaml"
        other.parent.mkdir()
        other.write_text(SECOND, encoding="utf-8")
        answer(project, "lock", "elsewhere", code=0)
        other.rename(project / "moved.yaml")
        words = complaint(project, "breaking", "moved.yaml", "--against-lock", "protogen.lock")
        assert "nothing was compared: lock:protogen.lock holds none of these schemas" in words

    def test_the_patterns_of_old_are_those_of_its_own_file(self, project: Path) -> None:
        git(project, "add", "protogen.toml")
        git(project, "commit", "--quiet", "--message", "Project")
        (project / "protogen.toml").write_text('schemas = ["schemas/dialects"]\n')
        output = answer(project, "breaking", code=1)
        assert "WIRE [schema-deleted] schemas/demo.yaml" in output
        assert output.endswith("compared 1 schema, 0 new, 1 gone\n")
        git(project, "mv", "schemas", "protocols")
        (project / "protogen.toml").write_text('schemas = ["protocols"]\n')
        (project / "protocols" / "demo.yaml").write_text(GONE, encoding="utf-8")
        output = answer(project, "breaking", code=1)
        assert "WIRE [message-deleted] ping" in output
        assert output.endswith("compared 2 schemas, 0 new, 0 gone\n")

    def test_a_project_file_of_old_with_a_mistake(self, project: Path) -> None:
        (project / "protogen.toml").write_text("schemas = 3\n")
        git(project, "add", "protogen.toml")
        git(project, "commit", "--quiet", "--message", "Project")
        (project / "protogen.toml").write_text('schemas = ["schemas"]\n')
        words = complaint(project, "breaking")
        assert "protogen.toml of git:HEAD can't be read" in words

    @pytest.mark.parametrize("pattern", ["library/schemas", "library", "*/schemas"])
    def test_schemas_in_a_submodule(self, pattern: str, project: Path, tmp_path: Path) -> None:
        outer = tmp_path / "outer"
        outer.mkdir()
        git(outer, "init", "--quiet")
        allowed = ["-c", "protocol.file.allow=always"]
        git(outer, *allowed, "submodule", "--quiet", "add", str(project), "library")
        (outer / "protogen.toml").write_text(f'schemas = ["{pattern}"]\n')
        git(outer, "add", "protogen.toml")
        git(outer, "commit", "--quiet", "--message", "First")
        words = complaint(outer, "breaking")
        assert "`library` is a submodule: HEAD keeps its commit, not its files" in words
        git(outer, "submodule", "--quiet", "deinit", "--all")
        words = complaint(outer, "breaking")
        assert "is a submodule" in words or "nothing was compared" in words
        # Its own repository has its files.
        git(outer, *allowed, "submodule", "--quiet", "update", "--init")
        output = answer(outer, "breaking", "library/schemas", "--against", "git:HEAD", code=0)
        assert output.endswith("compared 2 schemas, 0 new, 0 gone\n")

    def test_a_shallow_clone(self, project: Path, tmp_path: Path) -> None:
        (project / "schemas" / "demo.yaml").write_text(GONE, encoding="utf-8")
        git(project, "commit", "--quiet", "--all", "--message", "Second")
        clone = tmp_path / "clone"
        git(tmp_path, "clone", "--quiet", "--depth", "1", project.as_uri(), str(clone))
        words = complaint(clone, "breaking", "schemas", "--against", "git:origin/other")
        assert "git has no revision `origin/other` here" in words
        assert "git fetch origin other --unshallow" in words

    def test_a_revision_that_is_not_there(self, project: Path) -> None:
        words = complaint(project, "breaking", "--against", "git:origin/main")
        assert "git has no revision `origin/main` here" in words
        assert "git fetch" in words

    @pytest.mark.parametrize("arguments", [[], ["schemas"]], ids=str)
    def test_a_revision_without_git_before_it(self, arguments: list[str], project: Path) -> None:
        words = complaint(project, "breaking", *arguments, "--against", "main")
        assert "`main` is a revision: write git:main" in words

    def test_an_old_version_with_an_error_is_named_by_its_revision(self, project: Path) -> None:
        bad = OLD.replace("number: uint8", "number: unit8")
        (project / "schemas" / "demo.yaml").write_text(bad, encoding="utf-8")
        git(project, "commit", "--quiet", "--all", "--message", "Bad")
        (project / "schemas" / "demo.yaml").write_text(OLD, encoding="utf-8")
        words = complaint(project, "breaking", code=1)
        assert "HEAD:schemas/demo.yaml:14:47: error[PG104]: there is no type `unit8`" in words
        assert "OLD (HEAD) has errors, so nothing can be compared with it" in words
        assert "--against-lock" in words


# --- what goes wrong ------------------------------------------------------------------------------


class TestMistakes:
    def test_not_a_git_repository(self, folder: Path) -> None:
        words = complaint(folder, "breaking", "old.yaml", "--against", "git:main")
        assert "not a git repository" in words

    @pytest.mark.parametrize("command", ["diff", "breaking"])
    @pytest.mark.parametrize("files", [("old.yaml", "nix.yaml"), ("nix.yaml", "old.yaml")])
    def test_missing_file(self, command: str, files: tuple[str, str], folder: Path) -> None:
        assert "there is no `nix.yaml`" in complaint(folder, command, *files)

    @pytest.mark.parametrize("options", [["--use"], ["--except"], ["--ignore"]], ids=str)
    def test_unknown_rule(self, options: list[str], folder: Path) -> None:
        name = "message-delete=ping" if options == ["--ignore"] else "message-delete"
        words = complaint(folder, "breaking", "old.yaml", "gone.yaml", *options, name)
        assert "there is no rule `message-delete`" in words
        assert "did you mean `message-deleted`?" in words

    def test_a_rule_like_no_other(self, folder: Path) -> None:
        words = complaint(folder, "breaking", "old.yaml", "gone.yaml", "--use", "zzzzzzzz")
        assert "protogen rules lists them" in words

    @pytest.mark.parametrize("command", ["diff", "breaking"])
    def test_a_schema_with_an_error(self, command: str, folder: Path) -> None:
        (folder / "bad.yaml").write_text(OLD.replace("number: uint8", "number: unit8"))
        for files in (("old.yaml", "bad.yaml"), ("bad.yaml", "old.yaml")):
            done = protogen(folder, command, *files)
            words = done.stdout + done.stderr
            assert done.exit_code == 1
            assert "bad.yaml:14:47: error[PG104]: there is no type `unit8`" in words
            assert "did you mean `uint8`?" in words
            assert "Traceback" not in words

    def test_one_version_is_too_few(self, folder: Path) -> None:
        words = complaint(folder, "breaking", "old.yaml")
        assert "give OLD and NEW, or NEW with --against" in words

    def test_three_versions_are_too_many(self, folder: Path) -> None:
        complaint(folder, "breaking", "old.yaml", "gone.yaml", "turned.yaml")


# --- a project ------------------------------------------------------------------------------------


@pytest.fixture
def project(repository: Path) -> Path:
    """The repository as a project whose file names the schemas by a glob."""
    text = 'schemas = ["schemas/*.yaml", "schemas/dialects"]\n'
    (repository / "protogen.toml").write_text(text, encoding="utf-8")
    return repository


class TestProject:
    def test_its_schemas_against_the_last_commit(self, project: Path) -> None:
        words = "nothing is broken since git:HEAD\ncompared 2 schemas, 0 new, 0 gone\n"
        assert answer(project, "breaking", code=0) == words
        (project / "schemas" / "demo.yaml").write_text(GONE, encoding="utf-8")
        for where in (project, project / "schemas" / "dialects"):
            output = answer(where, "breaking", "--format", "json", code=1)
            found = {report["schema"]: len(report["findings"]) for report in json.loads(output)}
            assert found == {"schemas/demo.yaml": 1, "schemas/dialects/two.yaml": 1}
            assert "message-deleted" in answer(where, "diff", code=1)

    def test_a_glob_finds_what_is_gone(self, project: Path) -> None:
        (project / "schemas" / "demo.yaml").unlink()
        (project / "schemas" / "dialects" / "two.yaml").unlink()
        output = answer(project, "breaking", code=1)
        assert "WIRE [schema-deleted] schemas/demo.yaml" in output
        assert "schemas/demo.yaml is gone" in answer(project, "diff", code=1)

    def test_against_a_branch_a_lock_or_a_folder(self, project: Path, tmp_path: Path) -> None:
        answer(project, "lock", "schemas", code=0)
        was = tmp_path / "was"
        shutil.copytree(project / "schemas", was / "schemas")
        (was / ".git").touch()
        versions = (["--against", "git:main"], ["--against-lock", "protogen.lock"])
        for options in (*versions, ["--against", str(was)]):
            since = options[-1] if options[0] == "--against" else "lock:protogen.lock"
            output = answer(project, "breaking", *options, code=0)
            words = f"nothing is broken since {since}\ncompared 2 schemas, 0 new, 0 gone\n"
            assert output == words
        (project / "schemas" / "demo.yaml").write_text(GONE, encoding="utf-8")
        for options in (*versions, ["--against", str(was)]):
            assert "[message-deleted]" in answer(project, "breaking", *options, code=1)

    def test_no_such_folder(self, project: Path) -> None:
        words = complaint(project, "breaking", "--against", "nix")
        assert "there is no folder `nix`" in words

    def test_before_the_first_commit(self, folder: Path) -> None:
        git(folder, "init", "--quiet", "--initial-branch", "main")
        (folder / "protogen.toml").write_text('schemas = ["old.yaml"]\n', encoding="utf-8")
        words = "nothing is broken since git:HEAD\ncompared 0 schemas, 1 new, 0 gone\n"
        assert answer(folder, "breaking", code=0) == words
        assert answer(folder, "diff", code=1) == "old.yaml is new\n"

    @pytest.mark.parametrize("command", ["diff", "breaking"])
    def test_without_a_project_nothing_is_meant(self, command: str, folder: Path) -> None:
        words = complaint(folder, command)
        assert "give OLD and NEW, or NEW with --against" in words


# --- places ---------------------------------------------------------------------------------------

PLACES = """\
protocol: demo
endpoints: {board: Sensor board}
byte_order: little
frame:
  start:   {literal: 0xAA}
  kind:    {type: uint8, id: true}
  payload: {}
  crc:     {type: uint16, algorithm: CRC-16/KERMIT, covers: [kind, payload]}
transparency:
  covers: kind..crc
  escape: {byte: 0xAB, of: [0xAA, 0xAB], transform: {xor: 0x20}}
messages:
  reading:
    id: 1
    from: board
    fields:
      mode:
        type: uint8
        values:
          idle: 0
          run: 1
          stop: 2
      state:
        type: uint8
        flags:
          hot: 0
          wet: 1
      packed:
        type: uint8
        bits:
          gear:
            bits: 0..3
            values: {low: 0, high: 1}
          light: {bits: 4..4}
      inner:
        count: 2
        fields:
          x: uint8
          y: {type: uint8, special: {absent: 255}}
"""


@pytest.mark.parametrize(
    ("old", "new", "rule", "place"),
    [
        ("          stop: 2\n", "", "enum-value-deleted", "new.yaml:17 (new), old.yaml:22 (old)"),
        ("run: 1", "run: 7", "enum-value", "new.yaml:21 (new), old.yaml:21 (old)"),
        ("wet: 1", "wet: 3", "flag-moved", "new.yaml:27 (new), old.yaml:27 (old)"),
        ("high: 1", "high: 2", "enum-value", "new.yaml:33 (new), old.yaml:33 (old)"),
        ("4..4", "4..5", "bits", "new.yaml:28 (new), old.yaml:28 (old)"),
        ("absent: 255", "absent: 0", "field-special", "new.yaml:39 (new), old.yaml:39 (old)"),
        ("x: uint8", "x: sint8", "field-sign", "new.yaml:38 (new), old.yaml:38 (old)"),
        ("x: uint8", "z: sint8", "field-added", "new.yaml:38 (new), old.yaml:35 (old)"),
        (
            "protocol: demo\n",
            "protocol: demo\n\nlink: {baud: 1200}\n",
            "link-stated",
            "",
        ),
        (
            "type: uint16, alg",
            "type: uint16, byte_order: big, alg",
            "frame-checksum-algorithm",
            "new.yaml:8 (new), old.yaml:8 (old)",
        ),
        ("xor: 0x20", "xor: 0x40", "frame-transparency", "new.yaml:9 (new), old.yaml:9 (old)"),
    ],
    ids=lambda value: value.strip() if len(value) < 30 else "",
)
def test_places_are_those_of_what_changed(
    old: str, new: str, rule: str, place: str, tmp_path: Path
) -> None:
    assert PLACES.count(old) == 1
    (tmp_path / "old.yaml").write_text(PLACES, encoding="utf-8")
    (tmp_path / "new.yaml").write_text(PLACES.replace(old, new), encoding="utf-8")
    lines = answer(tmp_path, "diff", "old.yaml", "new.yaml", code=1).splitlines()
    at = next(number for number, line in enumerate(lines) if f"[{rule}]" in line)
    assert lines[at + 1].startswith(f"    at {place}" if place else "    fix: "), lines
