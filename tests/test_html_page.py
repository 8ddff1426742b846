"""Pages of the HTML target: what is in them, and what they do in a browser."""

from __future__ import annotations

import json
import re
from collections.abc import Iterator
from contextlib import suppress
from html.parser import HTMLParser
from pathlib import Path
from random import Random
from typing import Any

import pytest
from browser_pages import Opened, address_of, chromium, explained, titles, written
from test_markdown import HOSTILE

from protogen.cli.wire.codec import Codec, open_codec
from protogen.compiler import compile_file
from protogen.convert.inputs.hex_digits import HexError, parse_hex
from protogen.errors import UserError
from protogen.fuzzing.engine import Refused
from protogen.fuzzing.python_engine import PythonEngine
from protogen.fuzzing.samples import samples
from protogen.model.protocol import Protocol, Sender
from protogen.targets.html.emit import emit, page_text
from protogen.targets.html.script import bundled
from protogen.targets.markdown.emit import page_text as markdown_text

ROOT = Path(__file__).parents[1]
SCHEMAS = sorted([*ROOT.glob("schemas/*.yaml"), *ROOT.glob("schemas/dialects/*.yaml")])
LARGEST = 400 * 1024
"""Bytes that a page may have."""
_FRAMES = 24
"""Frames of each message that are tried."""
_VOID = {"meta", "input", "br", "img", "link"}
_OPEN = {"td", "th", "tr", "thead", "tbody", "li"}
"""Elements whose end may be left out."""


@pytest.fixture(scope="module")
def codecs() -> dict[str, Codec]:
    found = [open_codec(path) for path in SCHEMAS]
    return {codec.protocol.name: codec for codec in found}


@pytest.fixture(scope="module")
def folder(codecs, tmp_path_factory) -> Path:
    protocols = [codec.protocol for codec in codecs.values()]
    return written(protocols, tmp_path_factory.mktemp("pages"))


@pytest.fixture(scope="module")
def browser() -> Iterator[Any]:
    with chromium() as found:
        yield found


def schema_with(texts: list[str]) -> dict[str, Any]:
    """A schema that has each of the texts wherever a text can be."""
    fields = {
        "value": {"type": "uint8", "values": {"one": {"value": 1}}},
        "scaled": {"type": "sint16", "scale": 0.5},
        "bits": {"type": "uint8", "flags": {"low": 0}},
    }
    return {
        "protocol": "hostile",
        "title": " ".join(texts),
        "doc": " ".join(texts),
        "source": {"document": texts[0], "note": texts[1]},
        "endpoints": {"a": texts[2]},
        "byte_order": "little",
        "frame": {
            "start": {"literal": 0x55, "doc": " ".join(texts), "unprotected": "accepted"},
            "id": {"type": "uint8", "id": True, "doc": texts[3]},
            "payload": {},
        },
        "messages": {
            f"m{index}": {
                "id": index,
                "from": "a",
                "title": text,
                "summary": text,
                "doc": text,
                "fields": {
                    name: {**field, "doc": text, **({"unit": text} if "scale" in field else {})}
                    for name, field in fields.items()
                },
            }
            for index, text in enumerate(texts)
        },
        "decisions": {
            "accepted": dict(
                zip(("question", "document", "choice", "because"), texts, strict=False)
            )
        },
    }


def compiled(texts: list[str], path: Path) -> Protocol:
    path.write_text(json.dumps(schema_with(texts)), encoding="utf-8")
    compilation = compile_file(path)
    assert compilation.protocol is not None, [item.message for item in compilation.problems]
    return compilation.protocol


@pytest.fixture(scope="module")
def hostile(tmp_path_factory) -> Protocol:
    texts = [text.replace("\0", "") for text in HOSTILE]
    more = ["</script><script>alert(1)</script>", "<!--<script>", "<img src=x onerror=alert(1)>"]
    return compiled([*more, *texts], tmp_path_factory.mktemp("hostile") / "hostile.yaml")


@pytest.fixture(scope="module")
def plain(tmp_path_factory) -> Protocol:
    texts = ["plain"] * (len(HOSTILE) + 3)
    return compiled(texts, tmp_path_factory.mktemp("plain") / "hostile.yaml")


class Elements(HTMLParser):
    """The elements of a page, each with what it is in, and the text outside of scripts."""

    def __init__(self, text: str) -> None:
        super().__init__()
        self.names: list[str] = []
        self.attributes: list[tuple[str, str | None]] = []
        self.words = ""
        self._around: list[str] = []
        self.feed(text)
        assert [name for name in self._around if name not in _OPEN] == []

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        self.names.append(tag)
        self.attributes += attrs
        if tag not in _VOID and tag not in ("rect", "path"):
            self._around.append(tag)

    def handle_endtag(self, tag: str) -> None:
        if tag in ("rect", "path"):
            return
        while self._around[-1] != tag:
            assert self._around.pop() in _OPEN, tag
        self._around.pop()

    def handle_data(self, data: str) -> None:
        if not {"script", "style"} & set(self._around):
            self.words += data


class TestText:
    def test_each_page_is_one_file_of_at_most_400_kilobytes(self, folder):
        pages = [path for path in folder.glob("*.html") if path.name != "index.html"]
        assert len(pages) == len(SCHEMAS)
        assert max(path.stat().st_size for path in pages) <= LARGEST
        for path in pages:
            text = path.read_text(encoding="utf-8")
            assert not re.search(r'(?:src|href)="(?!#|index\.html)(?!https?:)', text)

    def test_every_anchor_of_markdown_is_there(self, codecs):
        for codec in codecs.values():
            text = markdown_text(codec.protocol)
            page = page_text(codec.protocol)
            anchors = re.findall(r'<a id="([^"]+)">', text)
            assert anchors
            for anchor in anchors:
                assert page.count(f' id="{anchor}"') == 1

    def test_every_link_inside_leads_somewhere(self, codecs):
        for codec in codecs.values():
            page = page_text(codec.protocol)
            links = set(re.findall(r'href="#([^"]+)"', page))
            assert links - set(re.findall(r' id="([^"]+)"', page)) == set()

    def test_a_drawing_stands_for_every_diagram(self, codecs):
        for codec in codecs.values():
            count = markdown_text(codec.protocol).count("```mermaid")
            assert count
            page = page_text(codec.protocol)
            assert page.count("<svg") == count
            assert "packet-beta" not in page

    def test_a_drawing_is_to_scale(self, codecs):
        """gyro of RN1: start and status have 1 byte, each of three integrals 2."""
        page = page_text(codecs["rn1"].protocol)
        drawing = re.search(r'aria-label="Frame of gyro">(.*?)</svg>', page)
        assert drawing is not None
        widths = [int(width) for width in re.findall(r'<rect x="\d+" width="(\d+)"', drawing[1])]
        assert widths == [44, 44, 88, 88, 88]

    def test_no_text_becomes_markup(self, hostile, plain):
        found, due = Elements(page_text(hostile)), Elements(page_text(plain))
        assert set(found.names) <= set(due.names) | {"a", "ul", "ol", "li"}
        assert found.names.count("script") == due.names.count("script") == 3
        assert not [name for name, _ in found.attributes if name.startswith("on")]
        links = [value or "" for name, value in found.attributes if name in ("href", "src")]
        assert not [value for value in links if value.startswith("javascript:")]
        assert found.words.count("alert(1)") > 5

    def test_the_index_names_every_protocol(self, folder, codecs):
        text = (folder / "index.html").read_text(encoding="utf-8")
        assert [*re.findall(r'<a href="(\w+)\.html">', text)] == sorted(codecs)

    def test_what_typescript_has_no_codec_for_can_be_read(self, monkeypatch, codecs):
        def refuse(_: object) -> None:
            raise UserError("no codec")

        monkeypatch.setattr("protogen.targets.html.bench.codecs", refuse)
        page = page_text(codecs["dagny"].protocol)
        assert "<script" not in page
        assert "script-src" not in page
        assert "<table>" in page

    def test_pages_are_the_same_each_time(self, codecs):
        protocol = codecs["dagny"].protocol
        assert emit([protocol]) == emit([protocol])


class TestScript:
    def test_modules_stand_behind_those_that_they_import(self):
        modules = {
            "main.js": (
                'import { two as b } from "./in/b.js";\nimport * as a from "./a.js";\nb(a);\n'
            ),
            "in/b.js": 'import { one } from "../a.js";\nexport function two() {\n  one();\n}\n',
            "a.js": "export const one = () => 1;\nconst hidden = 2;\n",
        }
        found = bundled(modules, "main.js", {"a.js": ("hidden",)})
        assert found == (
            '(() => {\n"use strict";\n'
            "let m0=(()=>{\nlet one=()=>1;let hidden=2;"
            "return{hidden,one};})();\n"
            "let m1=(()=>{\nlet{one}=m0;function two(){one()}"
            "return{two};})();\n"
            "let m2=(()=>{\nlet a=m0;let{two:b}=m1;b(a);"
            "return{};})();\n"
            "})();\n"
        )

    def test_what_nothing_needs_is_left_out(self):
        """`c.js` is only passed on, of `b.js` a member is taken, `a.js` does something."""
        modules = {
            "main.js": 'import * as b from "./b.js";\nimport { y } from "./b.js";\nb.x();\n',
            "b.js": (
                'import { a } from "./a.js";\nexport { c } from "./c.js";\n'
                "export const x = () => a;\nexport const y = () => z;\nclass z {\n}\n"
            ),
            "a.js": "/** Of use. */\nexport let a = 1;\nlet table = [];\ntable.push(2);\n",
            "c.js": "export const c = 1;\n",
        }
        found = bundled(modules, "main.js", {})
        assert found.split("\n")[3:-2:2] == [
            "let a=1;let table=[];table.push(2);return{a};})();",
            "let{a}=m0;let x=()=>a;return{x};})();",
            "let b=m1;b.x();return{};})();",
        ]

    @pytest.mark.parametrize(
        ("text", "due"),
        [
            ("const a = b / c / d;", "let a=b/c/d;"),
            ("const a = / \\/ b/.test(c);", "let a=/ \\/ b/.test(c);"),
            ("a = b + +c - -d;", "a=b+ +c- -d;"),
            ('a = " // no  remark"; // one', 'a=" // no  remark";'),
            ("a = `x  ${ b ? `y  ${c}` : '' }  z`;", "a=`x  ${ b ? `y  ${c}` : '' }  z`;"),
            ("return  typeof   x;", "return typeof x;"),
            ("/** doc */\nlet a\nlet b", "let a\nlet b"),
            ("if (a === undefined) {\n  b(true);\n}", "if(a===void 0){b(!0)}"),
            ("a = {\n  true: b.const,\n  c: d ? true : e,\n};", "a={true:b.const,c:d?!0:e};"),
            ("{ while (a(b)) ; }", "{while(a(b));}"),
            ("{ for (const a of b(c)) ; }", "{for(let a of b(c));}"),
            ("a = b.map((c) => c); return (d) => d;", "a=b.map(c=>c);return(d)=>d;"),
        ],
    )
    def test_blanks_go_where_they_mean_nothing(self, text, due):
        found = bundled({"main.js": text}, "main.js", {})
        inside = found.removeprefix('(() => {\n"use strict";\nlet m0=(()=>{\n')
        assert inside.split("return{};})();")[0].rstrip("\n") == due


Sample = tuple[str, dict[str, Any], dict[str, Any], bytes]
"""A message, its values, those of parts, and the frame."""


def samples_of(codec: Codec, sender: Sender, most: int = _FRAMES) -> Iterator[Sample]:
    """Frames of each message: boundaries first, then random ones."""
    random, engine = Random(sender.name), PythonEngine(codec.runtime)
    for message in sender.messages:
        drawn = samples(message, sender.frame, random)
        for _, (values, parts) in zip(range(most), drawn, strict=False):
            with suppress(Refused):
                data = engine.frame(sender.name, message.name, values, parts)
                yield message.name, values, parts, data


def damaged(data: bytes, random: Random) -> bytes:
    """The frame with a bit turned over, cut off, or with noise around it."""
    cut = random.randrange(len(data))
    turned = bytearray(data)
    turned[cut] ^= 1 << random.randrange(8)
    return random.choice((bytes(turned), data[:cut], random.randbytes(3) + data + data))


_EXPLAIN = "cases => cases.map(([sender, hex]) => protogen.explain(hex, sender))"


class TestDecode:
    def test_rows_are_those_of_explain(self, browser, folder, codecs):
        """Every example, samples of every message, and damage of each."""
        for name, codec in codecs.items():
            cases = [
                (item.sender, item.bytes)
                for message in codec.protocol.messages
                for item in message.examples
                if item.covers is None
            ]
            random = Random(name)
            for sender in codec.protocol.senders:
                frames = [data for *_, data in samples_of(codec, sender)]
                cases += [(sender.endpoint, data) for data in frames]
                cases += [(sender.endpoint, damaged(data, random)) for data in frames]
            with Opened(browser, folder / f"{name}.html") as opened:
                given = [[sender, data.hex()] for sender, data in cases]
                found = opened.run_on_much(_EXPLAIN, given)
                assert opened.complaints == []
            for (sender, data), events in zip(cases, found, strict=True):
                rows = [event["rows"] for event in events]
                assert rows == explained(codec, sender, data), f"{name} {sender} {data.hex()}"

    def test_titles_of_examples_are_those_of_explain(self, browser, folder, codecs):
        codec = codecs["matty"]
        with Opened(browser, folder / "matty.html") as opened:
            for message in codec.protocol.messages:
                for item in message.examples:
                    found = opened.run(_EXPLAIN, [[item.sender, item.bytes.hex()]])
                    assert [event["title"] for event in found[0]] == titles(
                        codec, item.sender, item.bytes
                    )

    @pytest.mark.parametrize(
        "text",
        [
            "55 02 01 41 BC",
            "5502 0141bc",
            "0x55, 0x02, 0x1, 0x41, 0xBC",
            "55:02:01:41:bc # an acknowledgement",
            "uint8_t frame[] = {0x55, 2, 1, 'A', 0xBC}; // ack",
            "[0x55, 0x02, 0x01, 0x41, 0xbc]",
            'b"\\x55\\x02\\x01A\\xbc"',
            "(1700000000.123456) can0 123#55020141BC",
            "(1700000000.1)  can0  123   [3]  55 02 01\n(1700000000.2)  can0  123   [2]  41 BC",
            "  can0  123   [5]  55 02 01 41 BC",
            "12:00:01.5 RX: 55 02 01 41 BC",
            "[12:00:01.500] 55 02 01\n[12:00:01.501] 41 BC",
            "2024-05-01T12:00:01 esp 55 02 01 41 BC",
            "esp: 55 02 01 41 BC",
            "Time [s],Value,Parity Error,Framing Error\n0.1,0x55,,\n0.2,0x02,,\n0.3,0x01,,\n"
            "0.4,'A' (0x41),,\n0.5,0xBC,,",
            "name,type,start_time,duration,data\n"
            + "\n".join(f'"Serial","data",0.{i},0.01,0x{b}' for i, b in enumerate(
                ["55", "02", "01", "41", "BC"])),
            "uart-1: 55\nuart-1: 02\nuart-1: 01\nuart-1: 41\nuart-1: BC",
        ],
    )  # fmt: skip
    def test_bytes_are_read_in_any_dress(self, matty, text):
        matty.page.select_option("#sender", "esp")
        matty.page.fill("#bytes", text)
        matty.page.wait_for_selector("#events .message")
        assert matty.page.inner_text("#note").startswith("5 bytes of ")
        assert "message ack" in matty.page.inner_text("#events h3")
        assert matty.page.locator("#events article").count() == 1

    @pytest.mark.parametrize("text", ["55 0", "5G", "0x", "55 02\n1"])
    def test_a_mistake_in_hex_is_told_as_by_python(self, matty, text):
        matty.page.fill("#bytes", text)
        with pytest.raises(HexError) as raised:
            parse_hex(text)
        matty.page.wait_for_function(
            "due => document.querySelector('#note').textContent === due", arg=str(raised.value)
        )

    def test_both_directions_of_a_log_are_told_apart(self, matty):
        """The counter of a command comes back: `go` of the PC, and the ESP's `ack`."""
        matty.page.fill(
            "#bytes", "12:00:00 pc 55 06 01 47 00 00 00 00 B2\n12:00:01 esp 55 02 01 41 BC"
        )
        matty.page.wait_for_selector("#events article:nth-of-type(2)")
        heads = matty.page.locator("#events h3").all_inner_texts()
        assert [re.sub(r".*: message ", "", head) for head in heads] == ["go", "ack"]

    def test_a_byte_lights_up_its_row_and_the_reverse(self, matty):
        page = matty.page
        page.select_option("#sender", "esp")
        page.fill("#bytes", "55 02 01 41 BD")
        page.wait_for_selector("#events .invalid")
        page.hover("#events .run >> nth=3")
        assert "'A' ack" in page.inner_text("#events tr.lit")
        page.hover("#events tbody tr >> nth=5")
        assert "BD" in page.inner_text("#events .run.lit")
        assert "crc is bd, not bc" in page.inner_text("#events .lit .fault")
        assert "checksum, crc is bd, not bc" in page.inner_text("#events h3")

    def test_keys_go_from_byte_to_byte(self, matty):
        page = matty.page
        page.fill("#bytes", "55 02 01 41 BC")
        page.wait_for_selector("#events .message")
        page.focus("#events .run")
        page.keyboard.press("ArrowRight")
        assert page.evaluate("document.activeElement.innerText").startswith("02")
        assert "length" in page.inner_text("#events tr.lit")


class TestEncode:
    def test_a_value_out_of_range_is_told_beside_its_field(self, matty):
        page = matty.page
        page.click("#tab-encode")
        page.select_option("#message", "go")
        page.fill('[data-key="speed"]', "40000")
        assert "32767" in page.inner_text('[data-path="speed"] .wrong')
        assert page.get_attribute('[data-key="speed"]', "aria-invalid") == "true"
        assert page.inner_text("#made") == "No bytes."
        page.fill('[data-key="speed"]', "500")
        assert page.inner_text("#fault") == ""

    def test_raw_and_physical_values_follow_each_other(self, matty):
        """`steer` is in hundredths of a degree: -2.5 degrees are -250, 06 FF little-endian."""
        page = matty.page
        page.click("#tab-encode")
        page.select_option("#message", "go")
        page.fill('[data-key="steer~"]', "-2.5")
        assert page.input_value('[data-key="steer"]') == "-250"
        page.fill('[data-key="steer"]', "100")
        assert page.input_value('[data-key="steer~"]') == "1"
        assert "64 00" in page.inner_text("#made code >> nth=0")

    def test_texts_to_copy(self, matty):
        page = matty.page
        page.click("#tab-encode")
        page.select_option("#message", "go")
        page.fill('[data-key="speed"]', "500")
        page.fill('[data-key="steer"]', "-250")
        made = page.locator("#made .copies code").all_inner_texts()
        wire = bytes.fromhex("55 06 01 47 F4 01 06 FF B8")
        assert made[0] == wire.hex(" ").upper()
        assert (
            made[1]
            == "static const uint8_t frame[] = {"
            + ", ".join(f"0x{byte:02X}" for byte in wire)
            + "};"
        )
        assert eval(made[2], {}) == wire
        assert made[3] == "protogen encode matty.yaml go speed=500 steer=-250 @counter=1"

    def test_names_of_values_are_a_menu(self, matty):
        page = matty.page
        page.click("#tab-encode")
        page.select_option("#message", "mode")
        named = page.locator("#fields select option").all_inner_texts()
        assert "idle" in named
        page.select_option("#fields select", label="idle")
        assert page.input_value('#fields input[type="text"]') == "0"


class TestPage:
    def test_nothing_is_loaded_and_nothing_complained_of(self, browser, folder, codecs):
        for name in codecs:
            with Opened(browser, folder / f"{name}.html") as opened:
                assert opened.complaints == []
                assert opened.requests == [opened.url]

    def test_a_hostile_schema_stays_text(self, browser, hostile, tmp_path):
        with Opened(browser, written([hostile], tmp_path) / "hostile.html") as opened:
            opened.page.fill("#query", "a")
            opened.page.fill("#bytes", "55 01 02 03")
            opened.page.click("#tab-encode")
            for name in (message.name for message in hostile.messages):
                opened.page.select_option("#message", name)
            assert opened.run("document.scripts.length") == 3
            assert opened.requests == [opened.url]
            assert opened.complaints == []

    def test_without_javascript_the_reference_can_be_read(self, browser, folder):
        path = folder / "rn1.html"
        with Opened(browser, path, java_script_enabled=False) as opened:
            # What is far below is not laid out before somebody goes there; it is text all the same.
            assert "Integral of gyro X" in opened.page.text_content("#reference")
            assert opened.page.is_visible("svg >> nth=0")
            assert not opened.page.is_visible("#bench")
            assert not opened.page.is_visible("#query")

    @pytest.mark.parametrize(
        ("query", "first", "anchor"),
        [
            ("02 21", "read_motor", "message-read_motor"),
            ("read_motor", "read_motor", "message-read_motor"),
            ("mm", None, None),
            ("motor_units", "motor_units", "decision-motor_units"),
        ],
    )
    def test_search(self, browser, folder, query, first, anchor):
        with Opened(browser, folder / "rflex_drivers.html") as opened:
            opened.page.fill("#query", query)
            links = opened.page.locator("#found a")
            assert opened.page.inner_text("#count").endswith("found")
            if first is not None:
                assert links.first.inner_text() == first
                assert links.first.get_attribute("href") == f"#{anchor}"

    def test_a_link_carries_a_message_and_its_bytes(self, browser, folder, matty):
        page = matty.page
        page.click("#tab-encode")
        page.select_option("#message", "go")
        page.fill('[data-key="speed"]', "-7")
        url = address_of(page)
        with Opened(browser, folder / "matty.html") as opened:
            opened.page.goto(url)
            # The form is there already; the address is read behind that.
            opened.page.wait_for_function(
                """() => document.querySelector('#fields [data-key="speed"]').value === '-7'"""
            )

    def test_a_link_carries_bytes_to_decode(self, browser, folder):
        with Opened(browser, folder / "matty.html") as opened:
            opened.page.goto(f"{opened.url}#d=esp&hex=55 02 01 41 BC")
            assert "message ack" in opened.page.inner_text("#events h3")

    def test_tabs_by_keys(self, matty):
        page = matty.page
        page.focus("#tab-decode")
        page.keyboard.press("ArrowRight")
        assert page.is_visible("#encode")
        page.keyboard.press("ArrowRight")
        assert page.is_visible("#file")
        assert page.evaluate("document.activeElement.id") == "tab-file"


class TestFile:
    def test_a_recording_is_counted_and_plotted(self, matty):
        """1000 statuses of the ESP, of which the third is damaged."""
        status = bytes.fromhex("55 02 01 41 BC")
        data = status * 2 + b"\x55\x02\x01\x41\xbd" + status * 997
        matty.page.click("#tab-file")
        matty.page.select_option("#file-sender", "esp")
        matty.page.set_input_files(
            "#chosen", {"name": "a.bin", "mimeType": "application/octet-stream", "buffer": data}
        )
        matty.page.wait_for_selector("#summary table")
        cells = matty.page.locator("#summary td").all_inner_texts()
        assert cells[:3] == ["ack", "999", "4995"]
        assert "Invalid: 1 spans, 5 bytes" in matty.page.inner_text("#summary")

    def test_a_field_over_time(self, browser, folder, codecs):
        """The times are those of a log: a gyro message each tenth of a second."""
        codec = codecs["rn1"]
        engine = PythonEngine(codec.runtime)
        lines = []
        for index in range(20):
            values = {"status": 1, "int_x": 10 * index, "int_y": 0, "int_z": -5}
            data = engine.frame("brain", "gyro", values, {})
            lines.append(f"({1700000000 + index / 10:.1f}) {data.hex(' ')}")
        with Opened(browser, folder / "rn1.html") as opened:
            page = opened.page
            page.click("#tab-file")
            page.select_option("#file-sender", "brain")
            page.set_input_files(
                "#chosen",
                {"name": "a.log", "mimeType": "text/plain", "buffer": "\n".join(lines).encode()},
            )
            page.wait_for_selector("#summary canvas")
            page.select_option("#summary select", label="gyro.int_x")
            page.wait_for_function(
                "() => document.querySelector('canvas').ariaLabel.includes('values')"
            )
            said = page.get_attribute("canvas", "aria-label")
            assert "20 values from 0 to 190" in said or "19 values from 0 to 180" in said
            assert opened.complaints == []


@pytest.fixture
def matty(browser, folder) -> Iterator[Opened]:
    with Opened(browser, folder / "matty.html") as opened:
        yield opened
        assert opened.complaints == []
