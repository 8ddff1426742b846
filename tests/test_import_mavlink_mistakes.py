"""Mistakes in definitions of MAVLink: each is told with its place, and nothing is written."""

from __future__ import annotations

from pathlib import Path

import pytest
from cli_support import run

HEAD = "<mavlink>\n"


def enum(*lines: str) -> str:
    """A file with an enum, whose first entry is in line 4."""
    return "\n".join([HEAD + '<enums>\n<enum name="E">', *lines, "</enum>\n</enums>\n</mavlink>"])


def message(*fields: str, head: str = 'id="1" name="A"') -> str:
    """A file with a message, whose first field is in line 4."""
    lines = [HEAD + f"<messages>\n<message {head}>", *fields]
    return "\n".join([*lines, "</message>\n</messages>\n</mavlink>"])


def field(kind: str, more: str = "") -> str:
    return f'<field type="{kind}" name="a" {more}/>'


def includes(file: str) -> str:
    return HEAD + f"  <include>{file}</include>\n</mavlink>"


MISTAKES = {
    "no_xml": ("protocol: x\n", ":1:1: this is no XML: syntax error"),
    "an_empty_file": ("", ":1:1: this is no XML: no element found"),
    "an_open_element": (
        HEAD + "<messages>\n</mavlink>",
        ":3:3: this is no XML: mismatched tag\n  hint: `messages` of line 2 is open here",
    ),
    "half_a_file": (HEAD + "<messages>\n", ":3:1: this is no XML: no element found"),
    "a_bare_ampersand": (
        message('<field type="char" name="a">R&D</field>'),
        ":4:32: this is no XML: not well-formed (invalid token)\n  hint: in a text, & is &amp;",
    ),
    "an_unknown_entity": (message("&nbsp;"), ":4:1: this is no XML: undefined entity"),
    "an_unknown_encoding": (
        '<?xml version="1.0" encoding="klingon"?>\n<mavlink/>',
        ":1:31: this can't be read: unknown encoding: klingon",
    ),
    "bytes_of_another_encoding": (
        message('<field type="char" name="a">\xe4\xf6</field>'),
        "this is no XML: not well-formed",
    ),
    "entities_of_its_own": (
        '<!DOCTYPE mavlink [<!ENTITY a "aa"><!ENTITY b "&a;&a;">]>\n<mavlink>&b;</mavlink>',
        ":1:19: a document type is not read\n  hint: take out <!DOCTYPE ...>",
    ),
    "entities_of_other_files": (
        '<!DOCTYPE mavlink [<!ENTITY a SYSTEM "file:///etc/passwd">]>\n<mavlink>&a;</mavlink>',
        ":1:19: a document type is not read",
    ),
    "deep_nests": ("<a>" * 40, "more than 32 elements lie in each other here"),
    "another_format": ("<svg/>", ":1:1: these are no definitions of MAVLink, but `svg`"),
    "a_version_as_text": (
        HEAD + "<version>three</version></mavlink>",
        ":2:1: `three` of this `version` is no whole number",
    ),
    "no_name": (message(head='id="1"'), ":3:1: this `message` has no `name`"),
    "no_id": (message(head='name="A"'), ':3:1: this `message` has no `id`\n  hint: <message id="'),
    "an_id_as_text": (message(head='id="one" name="A"'), ":3:1: `one` of this `message`"),
    "an_id_below_zero": (message(head='id="-1" name="A"'), ":3:1: the id -1 is none"),
    "an_id_of_four_bytes": (
        message(head='id="0x1000000" name="A"'),
        "the id 16777216 is none: it has three bytes\n  hint: from 0 to 16777215",
    ),
    "no_type": (message('<field name="a"/>'), ":4:1: this `field` has no `type`"),
    "an_unknown_type": (message(field("uint24_t")), ":4:1: there is no type `uint24_t`"),
    "a_slip_in_a_type": (message(field("unit8_t")), "did you mean `uint8_t`?"),
    "an_open_array": (message(field("uint8_t[]")), ":4:1: there is no type `uint8_t[]`"),
    "an_array_of_none": (message(field("char[0]")), ":4:1: an array of 0 elements"),
    "a_large_array": (message(field("char[256]")), "256 elements\n  hint: it has 1 to 255"),
    "a_field_that_is_there": (
        message(field("char"), field("uint8_t")),
        ":5:1: the field `a` is there already, in line 4",
    ),
    "a_message_that_is_there": (
        HEAD + '<messages>\n<message id="1" name="A"/>\n<message id="2" name="A"/></messages>'
        "</mavlink>",
        ":4:1: the message `A` is there already, in line 3",
    ),
    "an_id_that_is_there": (
        HEAD + '<messages>\n<message id="1" name="A"/>\n<message id="1" name="B"/></messages>'
        "</mavlink>",
        ":4:1: the message A has the id 1, in one.xml:3\n  hint: ids and names stand once",
    ),
    "an_unknown_enum": (
        message(field("uint8_t", 'enum="E"')),
        ":4:1: there is no enum `E`\n  hint: define it here, or in an included file",
    ),
    "an_entry_without_name": (enum('<entry value="1"/>'), ":4:1: this `entry` has no `name`"),
    "a_value_as_text": (enum('<entry name="A" value="x"/>'), ":4:1: `x` of this `entry` is no"),
    "a_value_to_evaluate": (
        enum('<entry name="A" value="__import__(1)"/>'),
        "`__import__(1)` of this `entry` is no whole number",
    ),
    "a_huge_value": (enum('<entry name="A" value="9**99999"/>'), "is no whole number"),
    "an_entry_that_is_there": (
        enum('<entry name="A" value="1"/>', '<entry name="A" value="2"/>'),
        ":5:1: the entry `A` is there already, in line 4",
    ),
    "a_value_that_is_there": (
        enum('<entry name="A" value="1"/>', '<entry name="B" value="0x01"/>'),
        ":5:1: E has `A`, 1, in one.xml:4\n  hint: names and values stand once",
    ),
    "a_missing_include": (
        includes("tow.xml"),
        ":2:3: there is no file `tow.xml` beside this one\n  hint: did you mean `two.xml`?",
    ),
    "an_include_of_nothing": (includes(""), ":2:3: there is no file `` beside this one"),
    "an_include_of_itself": (
        includes("one.xml"),
        ":2:3: this include closes a circle: one.xml -> one.xml",
    ),
    "a_circle": (includes("two.xml"), "two.xml:1:10: this include closes a circle: one.xml -> two"),
    "no_message": (enum('<entry name="A" value="1"/>'), "one.xml` defines no message"),
}
TWO = "<mavlink><include>one.xml</include></mavlink>"


def refused(folder: Path, path: Path) -> str:
    """The error of an import, which writes nothing."""
    done = run("import", "mavlink", str(path), "-o", str(folder / "out"))
    assert done.exit_code == 2, done.output
    assert "Traceback" not in done.output and "bug" not in done.output
    assert not (folder / "out").exists()
    return done.output


@pytest.mark.parametrize("name", MISTAKES)
def test_a_mistake_is_told_with_its_place(name: str, tmp_path: Path) -> None:
    text, expected = MISTAKES[name]
    (tmp_path / "one.xml").write_bytes(text.encode("latin-1"))
    (tmp_path / "two.xml").write_text(TWO)
    assert expected in refused(tmp_path, tmp_path / "one.xml")


def test_messages_of_two_files_have_ids_of_their_own(tmp_path: Path) -> None:
    (tmp_path / "one.xml").write_text(message())
    (tmp_path / "two.xml").write_text(message(head='id="1" name="B"'))
    lines = [HEAD + "<include>one.xml</include>", "<include>two.xml</include>", "</mavlink>"]
    (tmp_path / "both.xml").write_text("\n".join(lines))
    assert "two.xml:3:1: the message A has the id 1, in one.xml:3" in refused(
        tmp_path, tmp_path / "both.xml"
    )


def test_a_file_that_is_too_large_is_not_read(tmp_path: Path) -> None:
    with (tmp_path / "one.xml").open("wb") as file:
        file.truncate(17 * 1024 * 1024)
    assert "one.xml:1:1: the file has more than 16 MiB" in refused(tmp_path, tmp_path / "one.xml")


def test_a_folder_without_definitions_is_told(tmp_path: Path) -> None:
    (tmp_path / "empty").mkdir()
    assert "holds no .xml file" in refused(tmp_path, tmp_path / "empty")
    assert "there is no file or folder" in refused(tmp_path, tmp_path / "missing")


def test_what_nobody_knows_is_passed_over(tmp_path: Path) -> None:
    text = message(field("uint8_t", 'colour="red"'), "<sound>beep</sound>", "<extensions/>")
    (tmp_path / "one.xml").write_text(text.replace("<messages>", "<later/><messages>"))
    done = run("import", "mavlink", str(tmp_path / "one.xml"), "-o", str(tmp_path / "out"))
    assert done.exit_code == 0, done.output
