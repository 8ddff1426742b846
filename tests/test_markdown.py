"""The Markdown target: what else a reader finds, and that nothing spoils a page."""

from __future__ import annotations

import os
import re
import subprocess
import sys
from collections.abc import Iterator
from fractions import Fraction
from pathlib import Path
from typing import Any

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from markdown_it import MarkdownIt
from markdown_pages import diagrams, page, table_of, tables
from models import (
    SPAN,
    UINT8,
    UINT16,
    about,
    example,
    fields,
    flags_type,
    framing,
    message,
    protocol,
    robbus_frame,
    sender,
    switch_message,
    tiny_protocol,
)

from protogen.compiler import compile_file
from protogen.copying import defaults_of, replace
from protogen.model.frame import Frame
from protogen.model.meanings import Enum, NamedValue
from protogen.model.messages import Contradiction, Exchange, Overload, Step
from protogen.model.origin import About, Source
from protogen.model.parts import LiteralPart, PayloadPart
from protogen.model.protocol import (
    Decision,
    Endpoint,
    Link,
    Protocol,
    Reserved,
    ReservedIdentity,
    ReservedNames,
    ReservedValues,
)
from protogen.model.types import Array, Fill, Fixed, Integer, Octets, Struct, Text
from protogen.targets import TARGETS
from protogen.targets.banner import is_banner
from protogen.targets.markdown.emit import emit

SCHEMAS = sorted(Path(__file__).parent.parent.joinpath("schemas").rglob("*.yaml"))
GFM = MarkdownIt("commonmark", {"html": True}).enable("table")


def test_messages_are_listed_by_identity():
    high, low = message("high", 0x90, summary="Upper"), message("low", 0x10, ("f", UINT16))
    rows = table_of(protocol(high, low), "`id`")
    assert [tuple(row.values()) for row in rows] == [
        ("`0x10`", "[low](#message-low)", "6", "2", "1920", ""),
        ("`0x90`", "[high](#message-high)", "4", "0", "2880", "Upper"),
    ]
    text = page(protocol(high, low))
    assert text.index('id="message-low"') < text.index('id="message-high"')


def test_messages_without_identity_and_rate():
    frame = Frame(parts=(LiteralPart(name="start", bytes=b"\xaa"), PayloadPart(name="payload")))
    only = message("m", (), ("f", UINT8))
    sizes = framing([only], 1)
    unrated = replace(
        sizes, messages=tuple(replace(item, per_second=None) for item in sizes.messages)
    )
    senders = (sender("pc", frame, unrated, [only]),)
    text = page(protocol(only, senders=senders, link=Link(parity="even", stop_bits=2)))
    assert '### <a id="message-m"></a>m\n' in text
    assert "a second" not in text.split("## <a")[4]
    assert "No rate is given; 8 data bits, parity even, 2 stop bits." in text


def test_link_tells_times():
    link = Link(baud=115200, idle_timeout=Fraction(1, 50), about=about("Half duplex.", "4"))
    text = page(tiny_protocol(link=link))
    assert "115200 baud, 8 data bits, parity none, 1 stop bit." in text
    # 10 bits at 115200 baud: 86.8 microseconds.
    assert "A byte takes 86.8 µs, 11520 bytes a second." in text
    assert "After 20 ms of silence" in text
    assert "Half duplex. (line 4)" in text


def test_top_says_what_the_protocol_is():
    source = Source(
        document="a.txt", revision="r7", url="https://a.b/c", license="MIT", note="A note"
    )
    made = tiny_protocol(source=source, version="2", files=("tiny.yaml", "base.yaml"))
    text = page(made)
    assert text.startswith("\n# Tiny protocol\n\nA protocol for tests.\n")
    for line in (
        "Protocol:** `tiny`",
        "Version:** 2",
        "Extends:** base.yaml",
        "Document:** a.txt",
        "Revision:** r7",
        "Source:** <https://a.b/c>",
        "Licence:** MIT",
        "Note:** A note",
        f"Spec hash:** `{made.spec_hash}`",
    ):
        assert f"\n- **{line}\n" in text
    assert "Document" not in page(tiny_protocol(source=None)).split("## ")[0]


def test_overloads_say_how_messages_are_told_apart():
    first, second = message("a", 1, ("f", UINT8)), message("b", 1)
    by_size = Overload(name="o", sender="pc", identity=(1,), messages=("a", "b"), yields=None)
    sender = protocol(first, second).senders[0]
    text = page(protocol(first, second, senders=(replace(sender, overloads=(by_size,)),)))
    assert "- From `pc`: One identity for [a](#message-a) and [b](#message-b)." in text
    assert "Shares its identity with [b](#message-b). The payload's size tells them apart." in text
    never = replace(by_size, yields="b", decision="d", about=about("Sad."))
    text = page(protocol(first, second, senders=(replace(sender, overloads=(never,)),)))
    assert "a receiver yields [b](#message-b), see [d](#decision-d). Sad." in text
    unexplained = replace(never, decision=None)
    text = page(protocol(first, second, senders=(replace(sender, overloads=(unexplained,)),)))
    assert "a receiver yields [b](#message-b). Sad." in text


def test_exchanges_show_their_messages_and_bytes():
    shown = example("one", "AA 01 09 0D 0A")
    long = example("two", "00" * 30, covers=("payload",), sender="mcu")
    steps = (
        Step(message="m", example="one", about=about("First.")),
        Step(message="m", example="two"),
        Step(message="m", example=None),
    )
    exchange = Exchange(name="start", title="Start", steps=steps, about=about("How it starts."))
    made = protocol(message("m", 1, ("a", UINT8), examples=(shown,)), exchanges=(exchange,))
    first = made.senders[0]
    silent = replace(first.framing, messages=())
    sender = replace(first, name="mcu", messages=(), framing=silent)
    both = replace(made.messages[0], examples=(shown, long))
    made = replace(made, messages=(both,), senders=(*made.senders, sender))
    rows = [tuple(row.values()) for row in table_of(made, "Step")]
    link = "[m](#message-m)"
    assert rows == [
        ("1", "`pc`", link, "[one](#example-m-one)", "`AA 01 09 0D 0A`", "First."),
        ("2", "`mcu`", link, "[two](#example-m-two)", f"`{'00 ' * 24}...`", ""),
        ("3", "`pc`", link, "", "", ""),
    ]
    assert "### Start\n\nHow it starts.\n" in page(made)


def test_requests_show_what_answers_them_and_how_that_is_told():
    asked = Exchange(
        name="ask",
        title="Ask",
        requests=("m", "n"),
        replies=("n",),
        refusals=("m",),
        match=(("counter", "counter"), ("a", "of")),
        is_refusal_matched=False,
        timeout=Fraction(1, 20),
        retries=2,
    )
    plain = Exchange(name="b", title="B", requests=("m",), replies=("n",))
    made = protocol(message("m", 1), message("n", 2), exchanges=(asked, plain))
    m, n = "[m](#message-m)", "[n](#message-n)"
    assert [tuple(row.values()) for row in table_of(made, "What")] == [
        ("Request", f"{m} or {n}"),
        ("Reply", n),
        ("Refusal", m),
        (
            "Told by",
            "the same `counter` and `of`, equal to `a`; a refusal is of the request that waits",
        ),
        ("Timeout", "50 ms"),
        ("Retries", "2"),
    ]
    assert "| Told by | their order: one request waits at a time |" in page(made)


def test_decisions_are_told_and_linked():
    decision = Decision(
        name="newline",
        question="Is it escaped?",
        document="It asks",
        choice="No",
        because="See decision `newline`, decision newline and decision other.",
        source=Source(lines="3-4"),
    )
    text = page(tiny_protocol(decisions=(decision,)))
    assert '### <a id="decision-newline"></a>Is it escaped?\n' in text
    assert "- **Document:** It asks. (lines 3-4)\n- **Choice:** No.\n" in text
    link = "decision [newline](#decision-newline)"
    assert f"See {link}, {link} and decision other." in text
    assert "- **Decisions:** 1\n" in page(tiny_protocol(decisions=(decision,)), "fidelity.md")


def test_reserved_things_are_listed():
    made = tiny_protocol()
    sender = made.senders[0].name
    reserved = Reserved(
        identities=(ReservedIdentity(sender=sender, identity=(7,), doc="Once a reset"),),
        fields=(ReservedNames(message="m", names=("speed", "mode")),),
        values=(ReservedValues(path="m.state", values=(3, 4)),),
    )
    text = page(replace(made, reserved=reserved))
    assert "[reserved](#reserved)" in text
    part = made.senders[0].frame.identity[0].name
    assert f"| identity, from `{sender}` | `{part} 0x07` | Once a reset. |\n" in text
    assert "| field names of `m` | `speed`, `mode` |" in text
    assert "| values of `m.state` | 3, 4 |" in text
    assert "reserved" not in page(made)


def test_unknowns_are_listed():
    mystery = ("x", UINT16, {"unknown": True, "about": about("Always 2.", "9")})
    bare = message("raw", 2, ("data", Octets(extent=Fill(greatest=8))), unspecified=True)
    made = protocol(message("m", 1, mystery), bare)
    rows = [tuple(row.values()) for row in table_of(made, "Message")]
    assert rows == [
        ("[m](#message-m)", "`x`", "2 bytes. Always 2.", "line 9"),
        ("[raw](#message-raw)", "all", "0 to 8 bytes of payload", ""),
    ]
    assert counts(made) == [
        "- **Document:** tiny.txt",
        "- **Messages:** 2, 1 unspecified",
        "- **Fields:** 1, 1 unknown",
        "- **Examples:** 0 verified, 0 contradict",
        "- **Decisions:** 0",
    ]


def counts(made: Protocol) -> list[str]:
    """What the page of counts says of a protocol called tiny."""
    section = page(made, "fidelity.md").split("## [tiny](tiny.md)\n\n")[1]
    return section.split("\n\n")[0].splitlines()


def test_why_a_schema_has_no_examples_stands_beside_their_count():
    source = Source(document="tiny.txt", note="It prints no bytes")
    made = replace(protocol(message("m", 1, ("x", UINT8))), source=source)
    assert counts(made)[3:5] == [
        "- **Examples:** 0 verified, 0 contradict",
        "- **Why no examples:** It prints no bytes.",
    ]
    shown = protocol(message("m", 1, ("x", UINT8), examples=(example("e", "AA 01 09 0D 0A"),)))
    assert "It prints no bytes" not in page(replace(shown, source=source), "fidelity.md")


def test_fields_inside_structs_arrays_and_cases_are_counted():
    point = Struct(name="p", fields=fields(("x", UINT8), ("y", UINT8)))
    array = Array(element=point, extent=Fixed(count=3))
    made = protocol(message("m", 1, ("points", array)), switch_message())
    # points, x, y; op, argument, rate.
    assert "- **Fields:** 6, 0 unknown" in counts(made)


def test_index_lists_protocols_and_dialects():
    base = tiny_protocol()
    dialect = replace(base, name="a_dialect", files=("a_dialect.yaml", "tiny.yaml"), source=None)
    files = {str(file.path): file for file in emit([base, dialect])}
    assert list(files) == ["a_dialect.md", "tiny.md", "index.md", "fidelity.md"]
    assert files["index.md"].text.endswith(
        "## [a_dialect](a_dialect.md)\n\nTiny protocol.\n\n"
        "- **Extends:** tiny.yaml\n- **Senders:** `pc`\n- **Messages:** 1\n\n"
        "## [tiny](tiny.md)\n\nTiny protocol.\n\n"
        "- **Document:** tiny.txt\n- **Senders:** `pc`\n- **Messages:** 1\n"
    )
    assert "\n<!-- from a_dialect.yaml -->\n<!-- spec sha256 " in (files["index.md"].banner or "")


def test_no_protocol_gives_no_file():
    assert emit([]) == ()


def test_order_of_the_protocols_does_not_matter():
    made = [tiny_protocol(), tiny_protocol(name="other", files=("other.yaml",))]
    assert emit(made) == emit(made[::-1])


def test_target_is_registered():
    target = TARGETS["markdown"]
    files = target.emit([tiny_protocol()])
    assert [str(file.path) for file in files] == ["fidelity.md", "index.md", "tiny.md"]
    assert all(is_banner(file.banner or "") for file in files)


def broken_links(text: str) -> set[str]:
    return set(re.findall(r"\]\(#([^)]*)\)", text)) - set(re.findall(r'<a id="([^"]*)"></a>', text))


def assert_sound(text: str) -> None:
    """A page's tables are whole, its links lead somewhere, its only HTML is anchors."""
    anchors = re.findall(r'<a id="([^"]*)"></a>', text)
    assert len(anchors) == len(set(anchors))
    assert broken_links(text) == set()
    tokens = GFM.parse(text)
    assert "html_block" not in {token.type for token in tokens}
    inline = [child for token in tokens for child in token.children or []]
    html = {child.content for child in inline if child.type == "html_inline"}
    assert all(re.fullmatch(r'<a id="[a-z0-9_-]+">|</a>', item) for item in html)
    assert sum(token.type == "table_open" for token in tokens) == len(tables(text))
    for rows in tables(text):
        assert {len(row) for row in rows} == {len(rows[0])}
    for lines in diagrams(text):
        assert_contiguous(lines)


def assert_contiguous(lines: list[str]) -> None:
    """Mermaid refuses a packet with holes, and labels that end early."""
    following = 0
    for line in lines:
        match = re.fullmatch(r'(\d+)(?:-(\d+))?: "[^"\n]+"', line)
        assert match, line
        assert int(match[1]) == following
        following = int(match[2] or match[1]) + 1


def rich_protocol() -> Protocol:
    """Something of everything that has a text."""
    values = (NamedValue(name="x", value=1, about=about("t", "t")),)
    special = (NamedValue(name="s", value=9, about=about("t", "t")),)
    kind = Integer(bits=8, enum=Enum(name="e", values=values))
    shown = example(
        "e1",
        "AA 01 09 41 0D 0A",
        about=about("t", "t"),
        contradicts=Contradiction(fails="values", why="t", reads={"a": "t"}),
    )
    source = Source(
        document="t", revision="t", lines="t", section="t", url="t", license="t", note="t"
    )
    first = message(
        "m",
        1,
        ("a", UINT8, {"unit": "t", "special": special, "unknown": True, "about": about("t", "t")}),
        ("b", Text(extent=Fixed(count=1)), {"const": "t"}),
        ("c", kind, {"about": About(doc="t", source=source)}),
        ("d", flags_type()),
        title="t",
        summary="t",
        about=about("t", "t"),
        examples=(shown,),
    )
    second = message("n", 1)
    overload = Overload(
        name="o",
        sender="pc",
        identity=(1,),
        messages=("m", "n"),
        yields="n",
        decision="d",
        about=about("t", "t"),
    )
    made = protocol(first, second)
    frame = replace(
        robbus_frame(),
        parts=tuple(replace(part, about=about("t", "t")) for part in robbus_frame().parts),
    )
    assert frame.transparency is not None
    frame = replace(frame, transparency=replace(frame.transparency, about=about("t", "t")))
    texts = {"finds_start": "t", "finds_end": "t", "why_synchronising": "t", "undetected": ("t",)}
    sender = replace(
        made.senders[0],
        frame=frame,
        framing=replace(made.senders[0].framing, **texts),
        overloads=(overload,),
    )
    step = Step(message="m", example="e1", about=about("t", "t"))
    return replace(
        made,
        title="t",
        version="t",
        source=source,
        about=about("t", "t"),
        files=("tiny.yaml", "t"),
        link=Link(about=about("t", "t")),
        endpoints=(Endpoint(name="pc", title="t", doc="t"),),
        senders=(sender,),
        exchanges=(Exchange(name="x", title="t", steps=(step,), about=about("t", "t")),),
        decisions=(
            Decision(name="d", question="t", document="t", choice="t", because="t", source=source),
        ),
    )


def with_text(value: Any, text: str) -> Any:
    """The same object with each text that is only `t` replaced."""
    if isinstance(value, str):
        return text if value == "t" else value
    if isinstance(value, tuple):
        return tuple(with_text(item, text) for item in value)
    if isinstance(value, dict):
        return {key: with_text(item, text) for key, item in value.items()}
    names = defaults_of(type(value))
    if names and value is not SPAN:
        changes = {name: with_text(getattr(value, name), text) for name in names}
        return type(value)(**changes)
    return value


HOSTILE = [
    "| a | b |",
    "</td><script>alert(1)</script>",
    "<!-- --> -->",
    "```\n# heading\n```",
    "[x](javascript:alert(1)) ![y](z) [z]: w",
    "a\n\n- list\n\n    code\n***",
    "`` ` `b` `",
    "\\",
    "\\|",
    "*a* _b_ **c** ~~d~~ $e$",
    "&lt;b&gt; &#60;",
    '" onload="x',
    '</a><a id="link">',
    "\u202egnp.exe\u2028\u0000",
    "{{ view }} {% raw %}",
    "decision d",
]


@pytest.mark.parametrize("text", HOSTILE)
def test_no_text_spoils_a_page(text):
    for file in emit([with_text(rich_protocol(), text)]):
        assert_sound(file.content.split("\n", 1)[1])
        assert is_banner(file.content.splitlines()[0])


@settings(max_examples=25, deadline=None)
@given(st.text(max_size=40).filter(str.strip))
def test_no_text_whatever_spoils_a_page(text):
    for file in emit([with_text(rich_protocol(), text)]):
        assert_sound(file.content.split("\n", 1)[1])


def test_rich_protocol_holds_every_text_of_the_model():
    """A text that the hostile pages leave out would be one that nobody tests."""
    assert page(with_text(rich_protocol(), "Zebra")).count("Zebra") >= 40


def test_output_is_the_same_under_any_hash_seed(tmp_path):
    code = (
        "from test_markdown import rich_protocol; from protogen.targets.markdown.emit import emit;"
        "import sys; sys.stdout.buffer.write(b''.join(f.bytes for f in emit([rich_protocol()])))"
    )
    here = Path(__file__).parent
    outputs = set()
    for seed in ("1", "2"):
        environment = os.environ | {
            "PYTHONHASHSEED": seed,
            "PYTHONPATH": f"{here}{os.pathsep}{here.parent}",
            "LC_ALL": "C",
        }
        done = subprocess.run(
            [sys.executable, "-c", code],
            capture_output=True,
            env=environment,
            cwd=tmp_path,
            check=True,
        )
        outputs.add(done.stdout)
    assert len(outputs) == 1


@pytest.fixture(scope="module")
def real() -> dict[str, Protocol]:
    compiled = [compile_file(path).protocol for path in SCHEMAS]
    return {item.name: item for item in compiled if item is not None}


def real_pages(real: dict[str, Protocol]) -> Iterator[tuple[str, str]]:
    for file in emit(list(real.values())):
        yield str(file.path), file.text


def test_pages_of_all_schemas_are_sound(real):
    assert len(real) == len(SCHEMAS)
    for _, text in real_pages(real):
        assert_sound(text)


def test_pages_of_all_schemas_annotate_every_example(real):
    pages = dict(real_pages(real))
    for name, made in real.items():
        examples = [item for one in made.messages for item in one.examples]
        shown = [rows for rows in tables(pages[f"{name}.md"]) if rows[0][0] == "Byte"]
        assert len(shown) == len(examples)
        cells = [cell for rows in shown for row in rows for cell in row]
        assert not [cell for cell in cells if "**" in cell]


def test_byte_7_of_a_gyro_message(real):
    """Line 61-65 of the document: start, status, then three 14-bit numbers."""
    text = dict(real_pages(real))["rn1.md"]
    section = text.split('<a id="message-gyro"></a>')[1].split("###")[0]
    rows = {row[0]: row for row in tables(section)[0]}
    assert rows["6..7"][4] == "`int_z`"
