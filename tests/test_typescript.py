"""The package of TypeScript: what its tools say of it, and what its users call."""

from __future__ import annotations

import json
import shutil
import subprocess
from functools import cache
from pathlib import Path
from typing import Any

import pytest
import typescript_engine as engine
from compiled import DIALECTS, DOCUMENTS, ROOT, protocol_of
from tooling import require_tool

from protogen.compiler import compile_file

RUNTIME = ROOT / "protogen" / "targets" / "typescript" / "runtime"
FILES = ROOT / "tests" / "typescript"
TYPES = ("sampler", "sampler7", "bounded", "else_cases", "presence", "regions", "tagged", "digits")
"""Schemas in `tests/c_schemas` that have all types of fields between them."""
LONGEST = 500


@pytest.fixture(scope="module")
def package(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The package of the documents, where the tools find each other."""
    folder = tmp_path_factory.mktemp("package")
    engine.write_package([protocol_of(path) for path in (*DOCUMENTS, *DIALECTS)], folder)
    shutil.copy(FILES / "package.test-d.ts", folder)
    (folder / "node_modules").symlink_to(engine.TOOLS)
    return folder


class TestPackage:
    def test_has_nothing_that_publint_finds(self, package: Path) -> None:
        output = engine.run_tool("publint", "run", ".", "--strict", folder=package)
        assert "All good!" in output

    def test_resolves_for_every_user_of_modules(self, package: Path) -> None:
        engine.run_tool("attw", "--pack", ".", "--profile", "esm-only", folder=package)

    def test_has_the_types_that_its_users_expect(self, package: Path) -> None:
        engine.run_tool(
            "tsd", "--typings", "dist/matty.d.ts", "--files", "package.test-d.ts", folder=package
        )

    def test_holds_only_what_a_bundler_needs_of_it(self, package: Path) -> None:
        """A user who reads one field of one message gets nothing else of the package."""
        program = (
            'import { goSteerDeg } from "./dist/matty.js"; console.log(goSteerDeg({steer: 5}));'
        )
        (package / "one.js").write_text(program, encoding="utf-8")
        given = ("one.js", "--bundle", "--format=esm", "--minify", "--tree-shaking=true")
        made = engine.run_tool("esbuild", *given, folder=package)
        assert "status" not in made
        assert len(made) < 1500


class TestSources:
    def test_compile_strictly_to_what_is_printed(self, tmp_path: Path) -> None:
        """The compiler makes of the sources what the target prints, but for layout."""
        schemas = [ROOT / "tests" / "c_schemas" / f"{name}.yaml" for name in TYPES]
        protocols = [protocol_of(path) for path in (*DOCUMENTS, *schemas)]
        engine.write_package(protocols, tmp_path)
        compile_strictly(tmp_path / "src", tmp_path / "compiled")
        names = [f"{protocol.name}{end}" for protocol in protocols for end in (".js", ".d.ts")]
        for printed, compiled in zip(
            normalised([tmp_path / "dist" / name for name in names]),
            normalised([tmp_path / "compiled" / name for name in names]),
            strict=True,
        ):
            assert printed == compiled

    def test_of_the_runtime_are_compiled(self, tmp_path: Path) -> None:
        """`npx tsc -p protogen/targets/typescript/runtime` was run after the last change."""
        folder = RUNTIME / "dist"
        engine.run_tool("tsc", "-p", RUNTIME, "--outDir", tmp_path, folder=tmp_path)
        assert texts_in(tmp_path) == texts_in(folder)

    def test_of_the_runtime_are_short(self) -> None:
        sizes = {path.name: len(path.read_text().splitlines()) for path in RUNTIME.glob("*.ts")}
        assert {name for name, size in sizes.items() if size > LONGEST} == set()


def texts_in(folder: Path) -> dict[Path, str]:
    """The files of a folder, by their paths in it."""
    paths = (path for path in folder.rglob("*") if path.is_file())
    return {path.relative_to(folder): path.read_text(encoding="utf-8") for path in paths}


def compile_strictly(sources: Path, target: Path) -> None:
    """Compile with all that a careful user asks of the compiler."""
    options = json.loads((RUNTIME / "tsconfig.json").read_text(encoding="utf-8"))
    unused = {"noUnusedLocals": False, "rootDir": str(sources), "outDir": str(target)}
    options = {"compilerOptions": {**options["compilerOptions"], **unused}}
    path = sources / "tsconfig.json"
    path.write_text(json.dumps({**options, "include": ["**/*.ts"]}), encoding="utf-8")
    engine.run_tool("tsc", "-p", sources, folder=sources)


def normalised(paths: list[Path]) -> list[str]:
    """The files as the compiler lays them out."""
    engine.require_npm("tsc")
    script = engine.TOOLS.parent / "normalise.mjs"
    shutil.copy(FILES / "normalise.mjs", script)  # It finds the compiler beside itself.
    command = [require_tool("node"), script, *paths]
    done = subprocess.run(command, capture_output=True, text=True, check=True)
    found: list[str] = json.loads(done.stdout)
    return found


# --- what users call ------------------------------------------------------------------------------


@cache
def installed() -> Path:
    """The package as it is."""
    folder = engine.module_at(ROOT / "schemas" / "matty.yaml").parent.parent
    engine.module_at(ROOT / "schemas" / "rn1.yaml")
    return folder


def run_program(text: str) -> Any:
    """What a program prints as JSON; it has the module of matty."""
    head = 'import * as matty from "./dist/matty.js";\n'
    path = installed() / "program.mjs"
    path.write_text(head + text, encoding="utf-8")
    found = [engine.run_node(program, path) for program in engine.programs()]
    assert found[1:] == found[:1], "versions of node differ"
    return json.loads(found[0])


GO = "55 06 56 AA 47 64 00 AB FF 50"
"""`go` with counter 0x55, speed 100 and steer -85: the counter is escaped as 56 AA."""


INHERITED = """
protocol: odd
endpoints: {a: {title: A}, b: {title: B}}
byte_order: little
frame:
  a:
    id: {type: uint8, id: true}
    constructor: {type: uint8, counter: true}
    payload: {}
    sum: {type: uint8, algorithm: sum-8, covers: id..constructor}
    end: {literal: 0xC0}
  b:
    id: {type: uint8, id: true}
    constructor: {type: uint8, default: 7}
    payload: {}
    sum: {type: uint8, algorithm: sum-8, covers: id..constructor}
    end: {literal: 0xC0}
transparency: slip
messages:
  ping: {id: 1, from: a}
  pong: {id: 1, from: b}
"""


class TestNode:
    def test_of_npm_is_the_oldest_that_is_maintained(self) -> None:
        """All that is tried in node is tried in this one as well as in the system's."""
        version = engine.run_node(engine.require_npm("node"), "--version")
        assert version.startswith("v22.")
        package = json.loads((installed() / "package.json").read_text(encoding="utf-8"))
        assert package["engines"] == {"node": ">=20"}


class TestCalls:
    def test_encode_and_decode_a_frame(self) -> None:
        found = run_program("""
            const message = { message: "go", speed: 100, steer: -85 };
            const frame = matty.encode(message, { parts: { counter: 0x55 } });
            console.log(JSON.stringify([Array.from(frame), matty.decode(frame)]));
        """)
        assert bytes(found[0]) == bytes.fromhex(GO)
        assert found[1] == {"message": "go", "speed": 100, "steer": -85}

    def test_errors_of_encoding_name_the_field_and_what_is_allowed(self) -> None:
        found = run_program("""
            const tried = [
                [{ message: "go", speed: 40000, steer: 0 }, { counter: 1 }],
                [{ message: "go", speed: "1", steer: 0 }, { counter: 1 }],
                [{ message: "stop" }, {}],
                [{ message: "stop" }, { number: 1 }],
                [{ message: "fly" }, {}],
            ].map(([message, parts]) => {
                try { matty.encode(message, { parts }); } catch (error) {
                    return [error instanceof matty.EncodeError, error.path, error.problem];
                }
            });
            console.log(JSON.stringify(tried));
        """)
        assert [item[0] for item in found] == [True] * 5
        assert [item[1] for item in found] == ["speed", "speed", "counter", "number", "message"]
        assert found[0][2] == "40000 is not in -32768..32767"

    def test_errors_of_decoding_say_where_and_why(self) -> None:
        found = run_program("""
            const frame = Uint8Array.from([0x55, 0x06, 0x00, 0x47, 100, 0, 0, 0, 0x00]);
            const tried = [frame, frame.subarray(0, 5), frame.subarray(1)].map((bytes) => {
                try { matty.decode(bytes, { sender: "pc" }); } catch (error) {
                    return [error instanceof matty.DecodeError, error.reason, error.offset];
                }
            });
            console.log(JSON.stringify(tried));
        """)
        # The sum of all bytes but the first has to be 0: it is 0xB1.
        assert found == [[True, "checksum", 8], [True, "truncated", 5], [True, "noise", 0]]

    def test_an_encoder_counts_frames(self) -> None:
        found = run_program("""
            const encoder = new matty.Encoder("pc");
            const counter = (...given) => matty.decode && (() => {
                const frame = encoder.encode({ message: "stop" }, ...given);
                return new matty.Decoder("pc").feed(frame)[0].parts.counter;
            })();
            console.log(JSON.stringify([counter(), counter({ parts: { counter: 9 } }), counter()]));
        """)
        assert found == [0, 9, 1]

    def test_a_part_is_given_only_if_the_caller_gives_it(self) -> None:
        """Every object inherits a `constructor`, which is no value of the part of that name."""
        protocol = compile_file("odd.yaml", text=INHERITED).protocol
        assert protocol is not None
        found = run_program(
            f"""
            import * as odd from "{engine.module_of(protocol)}";
            const told = new odd.Encoder("a");
            const frames = [
                () => odd.encode({{ message: "ping" }}),
                () => odd.encode({{ message: "ping" }}, {{ parts: {{ constructor: 3 }} }}),
                () => told.encode({{ message: "ping" }}),
                () => odd.encode({{ message: "pong" }}),
            ].map((make) => {{
                try {{ return Array.from(make()); }} catch (error) {{ return error.path; }}
            }});
            console.log(JSON.stringify(frames));
            """
        )
        # The identity, the part, the sum of both and the end. In ping the part is a counter, and in
        # pong a value with a default.
        counted = [[1, 3, 4, 0xC0], [1, 0, 1, 0xC0]]
        assert found == ["constructor", *counted, [1, 7, 8, 0xC0]]

    def test_streams_and_iterators_give_the_events_of_a_decoder(self) -> None:
        found = run_program(f"""
            const bytes = Uint8Array.from(Buffer.from("00{GO.replace(" ", "")}", "hex"));
            const parts = [bytes.subarray(0, 3), bytes.subarray(3)];
            const stream = new ReadableStream({{
                start(controller) {{
                    parts.forEach((part) => controller.enqueue(part));
                    controller.close();
                }},
            }}).pipeThrough(matty.decoderStream("pc"));
            const one = [], other = [];
            for await (const event of stream) one.push(matty.jsonLine(event));
            for await (const event of matty.events(parts, "pc")) other.push(matty.jsonLine(event));
            console.log(JSON.stringify([one, other]));
        """)
        assert found[0] == found[1]
        assert [json.loads(line)["event"] for line in found[0]] == ["invalid", "message"]

    def test_events_keep_their_bytes_when_the_caller_uses_the_chunk_again(self) -> None:
        found = run_program(f"""
            const chunk = Uint8Array.from(Buffer.from("{GO.replace(" ", "")}", "hex"));
            const [event] = new matty.Decoder("pc").feed(chunk);
            chunk.fill(0);
            console.log(JSON.stringify(Array.from(event.raw)));
        """)
        assert bytes(found) == bytes.fromhex(GO)

    def test_physical_values_are_those_of_python(self) -> None:
        found = run_program("""
            console.log(JSON.stringify([
                matty.goSteerDeg({ steer: -85 }),
                matty.goSteerFromDeg(-0.85),
                matty.goSteerFromDeg(0.005),
                matty.goSteerFromDeg(0.015),
            ]));
        """)
        # 0.005 is a little more than 1/200, and 0.015 a little less than 3/200.
        assert found == [-0.85, -85, 1, 1]

    def test_memory_of_a_decoder_is_bounded(self) -> None:
        found = run_program("""
            const decoder = new matty.Decoder("pc");
            const noise = new Uint8Array(1000).fill(7);
            let most = 0, events = 0;
            for (let turn = 0; turn < 200; turn++) {
                events += decoder.feed(noise).length;
                most = Math.max(most, decoder.pending);
            }
            console.log(JSON.stringify([most, events]));
        """)
        assert found[0] <= 250  # The greatest frame.
        assert found[1] == 800


ACK = "55 02 01 41 BC"
"""An `ack` of the ESP."""
SOURCE = f"""
    const ack = Uint8Array.from(Buffer.from("{ACK.replace(" ", "")}", "hex"));
    const three = Uint8Array.from([...ack, ...ack, ...ack]);
    const seen = [];
    let pulls = 0;
    const stream = (last) => new ReadableStream({{
        pull(controller) {{
            pulls += 1;
            if (pulls <= 3) controller.enqueue(three);
            else if (last === "error") controller.error(new Error("the device is gone"));
            else controller.enqueue(three);
        }},
        cancel(reason) {{ seen.push(`cancelled: ${{reason}}`); }},
    }}, {{ highWaterMark: 0 }});
    const turn = () => new Promise((done) => setTimeout(done, 5));
"""
"""Chunks of three frames each, without an end or up to an error."""


class TestStreams:
    def test_take_no_more_than_is_read(self) -> None:
        found = run_program(f"""{SOURCE}
            const reader = stream("").pipeThrough(matty.decoderStream("esp")).getReader();
            const counts = [];
            for (let turns = 0; turns < 8; turns++) {{
                await turn();
                counts.push(pulls);
                await reader.read();
            }}
            console.log(JSON.stringify(counts));
        """)
        # A chunk waits in front of the decoder, and the events of one behind it.
        assert all(count <= 2 + number // 3 for number, count in enumerate(found))

    def test_that_are_cancelled_cancel_their_source(self) -> None:
        found = run_program(f"""{SOURCE}
            const reader = stream("").pipeThrough(matty.decoderStream("esp")).getReader();
            await reader.read();
            await reader.cancel("enough");
            await turn();
            async function* chunks() {{
                try {{
                    for (;;) yield three;
                }} finally {{
                    seen.push("closed");
                }}
            }}
            for await (const event of matty.events(chunks(), "esp")) {{
                seen.push(event.message.message);
                break;
            }}
            console.log(JSON.stringify(seen));
        """)
        assert found == ["cancelled: enough", "ack", "closed"]

    def test_hand_on_what_their_source_says_is_wrong(self) -> None:
        """An iterator gives all events in front of the error; streams may drop some."""
        found = run_program(f"""{SOURCE}
            const told = async (events) => {{
                let count = 0;
                try {{
                    for await (const event of events) count += event.kind === "message";
                }} catch (error) {{
                    return [count, error.message];
                }}
            }};
            seen.push(await told(matty.events(stream("error"), "esp")));
            pulls = 0;
            const reader = stream("error").pipeThrough(matty.decoderStream("esp"));
            seen.push((await told(reader))[1]);
            console.log(JSON.stringify(seen));
        """)
        assert found == [[9, "the device is gone"], "the device is gone"]
