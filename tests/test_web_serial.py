"""The page of the TypeScript package that speaks to devices, in Chromium with a port of the tests.

A browser lists devices, never a pseudo-terminal: `typescript/fake_serial.js` stands in for one.
"""

from __future__ import annotations

import re
import socket
from collections import Counter
from collections.abc import Callable, Iterator
from random import Random
from typing import Any

import pytest
import typescript_engine as engine
from browser_pages import AXE, SCHEMES, address_of, chromium, context_of, served
from compiled import ROOT, module_at, protocol_of
from corpus import material_of, portions, stream_of
from tooling import PATIENCE, unavailable

from protogen.link.device import SimulatedDevice
from protogen.targets.web_serial.emit import example

FAKE = ROOT / "tests" / "typescript" / "fake_serial.js"
PATHS = {
    "matty": ROOT / "schemas" / "matty.yaml",
    "rn1": ROOT / "schemas" / "rn1.yaml",
    "rflex": ROOT / "schemas" / "rflex.yaml",
    "modbus": ROOT / "protogen" / "library" / "modbus.yaml",
}
STATUS = bytes.fromhex("55 14 10 49 01 02 5C 1C 7B 00 00 00 00 00 65 00 17 00 DD 05 EA 00 56 AA")
"""Of matty's schema: the counter is 16, and the emergency stop is pressed."""
ACK = bytes.fromhex("55 02 01 41 BC")
BAD = bytes.fromhex("55 02 01 41 BD")
"""An `ack` with a wrong checksum."""


class Live:
    """The page with a port, and what it complained of."""

    def __init__(self, browser: Any, url: str, fake: str, **context: Any) -> None:
        self.context = context_of(browser, **context)
        self.page = self.context.new_page()
        self.complaints: list[str] = []
        self.page.on("console", lambda message: self.complaints.append(message.text))
        self.page.on("pageerror", lambda error: self.complaints.append(str(error)))
        self.page.add_init_script(fake)
        self.page.clock.install()
        self.page.goto(url)
        self.page.wait_for_selector("#made :first-child")
        self.stop_time()

    def run(self, code: str, value: object = None) -> Any:
        return self.page.evaluate(code, value)

    def pass_time(self, milliseconds: int) -> None:
        self.page.clock.run_for(milliseconds)

    def stop_time(self) -> None:
        """Time passes only as a test says, once the clock has run up to here."""
        # A minute ahead: until it stands still it goes on, and it never goes back.
        self.page.clock.pause_at(self.page.evaluate("() => Date.now() / 1000 + 60"))

    def connect(self) -> None:
        self.page.click("#connect")
        self.page.wait_for_selector("text=/^Connected/")

    def feed(self, data: bytes) -> None:
        """Bytes come in; then a fifth of a second passes, after which the page shows them."""
        self.run("async (bytes) => { fake.feed(bytes); await fake.taken(); }", list(data))
        self.pass_time(200)

    def send(self, key: str = "") -> bytes:
        """What is written when the button is clicked, or a key pressed."""
        self.run(
            """() => {
                fake.port.written.length = 0;
                document.getElementById("sent-note").textContent = "";
            }"""
        )
        self.page.press("#fields input", key) if key else self.page.click("#send")
        self.page.wait_for_selector("text=/^Sent /")
        return bytes(self.run("() => fake.port.written"))

    def text(self, selector: str) -> str:
        found: str = self.page.inner_text(selector)
        return found

    def rows(self, table: str) -> list[list[str]]:
        """The cells of a table."""
        code = """(id) => [...document.getElementById(id).rows]
            .map((row) => [...row.cells].map((cell) => cell.textContent))"""
        found: list[list[str]] = self.run(code, table)
        return found

    def values(self, name: str) -> dict[str, str]:
        """The values of a message."""
        code = """(name) => [...messages.rows].filter((row) => row.cells[0].textContent === name)
            .flatMap((row) => [...row.querySelectorAll("li")])
            .map((item) => [item.dataset.name, item.children[1].textContent])"""
        return dict(self.run(code, name))

    def changed(self) -> list[str]:
        code = '() => [...document.querySelectorAll(".changed")].map((item) => item.textContent)'
        found: list[str] = self.run(code)
        return found

    def log(self) -> list[Any]:
        found: list[Any] = self.run("() => fake.port.log.splice(0)")
        return found


@pytest.fixture(scope="module")
def browser() -> Iterator[Any]:
    with chromium() as found:
        yield found


@pytest.fixture(scope="module")
def server(tmp_path_factory: pytest.TempPathFactory) -> Iterator[str]:
    """The address of the package, which any server of files can be."""
    folder = tmp_path_factory.mktemp("package")
    engine.write_package([protocol_of(path) for path in PATHS.values()], folder)
    with served(folder) as address:
        yield f"{address}/examples/web-serial/"


Opener = Callable[..., Live]


@pytest.fixture
def opened(browser: Any, server: str) -> Iterator[Opener]:
    """Opens the page of a protocol; at the end, nothing may have complained."""
    pages: list[Live] = []

    def open_page(protocol: str, endpoint: str, **context: Any) -> Live:
        url = f"{server}?protocol={protocol}&endpoint={endpoint}"
        pages.append(Live(browser, url, FAKE.read_text(encoding="utf-8"), **context))
        return pages[-1]

    yield open_page
    for page in pages:
        assert page.complaints == []
        page.context.close()


class TestFiles:
    def test_hold_every_module_that_is_imported(self) -> None:
        made = {file.path.name: file.text for file in example([protocol_of(PATHS["matty"])])}
        for text in (text for name, text in made.items() if name.endswith(".js")):
            assert set(re.findall(r'from "\./([^"]+)"', text)) <= set(made)


class TestLive:
    @pytest.mark.parametrize(
        ("name", "sender"), [("matty", "esp"), ("rn1", "brain"), ("rflex", "flex")]
    )
    def test_counts_what_python_finds_in_damaged_bytes(
        self, opened: Opener, name: str, sender: str
    ) -> None:
        path, dice = PATHS[name], Random(name)
        data = stream_of(material_of(path, sender), dice, 40).data
        decoder = module_at(path).Decoder(sender=sender)
        events = [*decoder.feed(data), *decoder.flush()]
        page = opened(name, sender)
        page.connect()
        for portion in portions(data, dice):
            page.run("async (bytes) => { fake.feed(bytes); await fake.taken(); }", list(portion))
        page.pass_time(400)  # A silence, after which nothing is pending.
        found = {row[0]: int(row[2]) for row in page.rows("messages")}
        kinds = Counter(
            event.message.NAME if event.kind == "message" else event.kind for event in events
        )
        invalid, unknown = kinds.pop("invalid", 0), kinds.pop("unknown", 0)
        assert found.pop("no message has this identity", 0) == unknown
        assert found == kinds
        spans = Counter(event.reason for event in events if event.kind == "invalid")
        assert {row[0]: int(row[2]) for row in page.rows("invalid")} == spans
        assert spans.total() == invalid > 0
        assert page.text("#totals").startswith(
            f"{len(data)} bytes, {kinds.total() + unknown} frame"
        )

    def test_shows_values_with_names_and_units_and_marks_changes(self, opened: Opener) -> None:
        page = opened("matty", "esp")
        page.connect()
        page.feed(b"\x01\x02" + STATUS + BAD)
        assert page.values("status") == {
            "counter": "16",
            "status": "emergency_stop (1)",
            "mode": "autonomous (2)",
            "voltage": "7260 mV",
            "current": "123 mA",
            "speed": "0 mm/s",
            "angle": "0 deg",
            **{f"encoder{index}": f"{mm} mm" for index, mm in enumerate((101, 23, 1501, 234))},
        }
        assert page.changed() == []
        wrong = "offset 26: 55 02 01 41 BD, crc is not that of the bytes"
        assert page.rows("invalid") == [
            ["noise", "esp", "1", "2", "offset 0: 01 02"],
            ["checksum", "esp", "1", "5", wrong],
        ]
        module = module_at(PATHS["matty"])
        values = {**module.decode(STATUS, sender="esp").to_dict(), "angle": -250}
        frame = module.encode(module.Status.from_dict(values), counter=17)
        page.feed(frame)
        assert page.changed() == ["counter 17*", "angle -2.5 deg*"]
        page.pass_time(1200)
        assert page.changed() == []

    def test_takes_rates_over_five_seconds(self, opened: Opener) -> None:
        page = opened("matty", "esp")
        page.connect()
        for _ in range(10):  # Ten seconds with five frames each.
            page.pass_time(800)
            page.feed(ACK * 5)
        assert page.rows("messages")[0][2:4] == ["50", "5.0/s"]
        page.pass_time(5200)
        count, rate, since = page.rows("messages")[0][2:5]
        assert (count, rate) == ("50", "0.0/s")
        assert 5.0 <= float(since.removesuffix(" s")) <= 5.4

    def test_a_silence_ends_frames(self, opened: Opener) -> None:
        page = opened("modbus", "client")
        page.connect()
        # Read holding registers of device 17: 3 of them from 107 on, as in the specification.
        page.run("(bytes) => fake.feed(bytes)", list(bytes.fromhex("11 03 00 6B 00 03 76 87")))
        page.pass_time(400)
        assert [row[2] for row in page.rows("messages")] == ["1"]

    def test_another_endpoint_begins_anew_and_stays_in_the_address(self, opened: Opener) -> None:
        page = opened("matty", "esp")
        page.connect()
        page.feed(ACK)
        page.page.select_option("#endpoint", "pc")
        assert page.rows("messages") == []
        assert address_of(page.page).endswith("?protocol=matty&endpoint=pc")
        page.feed(bytes.fromhex("55 02 01 53 AA"))
        assert page.rows("messages")[0][:3] == ["stop", "pc", "1"]


class TestSend:
    def test_writes_the_bytes_of_python(self, opened: Opener) -> None:
        module = module_at(PATHS["matty"])
        page = opened("matty", "esp")
        page.connect()
        page.page.select_option("#message", "go")
        page.page.fill('[data-key="speed"]', "-1000")
        page.page.fill('[data-key="steer~"]', "12.5")
        page.page.fill('[data-key="@counter"]', "255")
        go = module.Go(speed=-1000, steer=1250)
        assert page.send() == module.encode(go, counter=255)
        # The counter goes on by itself, also in another message.
        assert page.send("Enter") == module.encode(go, counter=0)
        page.page.select_option("#message", "mode")
        page.page.select_option('[data-key="mode="]', "1")
        assert page.send() == module.encode(module.Mode(mode=1), counter=1)
        assert len(page.page.query_selector_all("#sent li")) == 3

    @pytest.mark.parametrize(("name", "other"), [("rn1", "brain"), ("rflex", "flex")])
    def test_every_message_as_it_is_at_first(self, opened: Opener, name: str, other: str) -> None:
        """What the page writes is a frame that Python reads as that message."""
        module, protocol = module_at(PATHS[name]), protocol_of(PATHS[name])
        (sender,) = (item for item in protocol.senders if item.name != other)
        page = opened(name, other)
        page.connect()
        offered = page.run("() => [...message.options].map((item) => item.value)")
        assert offered == [item.name for item in sender.messages]
        for item in sender.messages:
            page.page.select_option("#message", item.name)
            if page.text("#fault"):
                continue  # Its first values are not allowed, and the page says so.
            data = page.send()
            assert item.name == module.decode(data, sender=sender.name).NAME

    def test_tells_what_is_wrong_beside_the_field(self, opened: Opener) -> None:
        page = opened("matty", "esp")
        page.connect()
        page.page.select_option("#message", "go")
        page.page.fill('[data-key="speed"]', "40000")
        wrong = '[data-path="speed"] .wrong'
        assert page.text(wrong) == "40000 is not in -32768..32767"
        page.page.press('[data-key="speed"]', "Enter")
        assert page.run("() => fake.port.written") == []
        page.page.fill('[data-key="speed"]', "4")
        assert page.text(wrong) == ""


class TestSimulator:
    def test_sends_to_the_page_and_answers_it(self, opened: Opener) -> None:
        """A simulated robot, whose bytes the test carries to the page and back."""
        page = opened("matty", "esp")
        page.connect()
        robot = SimulatedDevice(PATHS["matty"], "esp", address="listen://127.0.0.1:0")
        robot.on("go", lambda event: [(robot.messages["ack"](), {"counter": event.parts.counter})])
        with robot:
            host, number = robot.port.rpartition("//")[2].split(":")
            with socket.create_connection((host, int(number)), timeout=PATIENCE) as line:
                values = module_at(PATHS["matty"]).decode(STATUS, sender="esp").to_dict()
                status = robot.messages["status"].from_dict(values)
                page.page.select_option("#message", "go")
                line.sendall(page.send())  # What it sends before it has taken the line is lost.
                page.feed(line.recv(100))
                for counter in range(3):
                    robot.send(status, counter=counter)
                    page.feed(line.recv(100))
        assert [row[:3] for row in page.rows("messages")] == [
            ["ack", "esp", "1"],
            ["status", "esp", "3"],
        ]
        assert page.rows("invalid") == []
        assert robot.counts.received == {"go": 1}


class TestPort:
    def test_is_opened_as_the_schema_says(self, opened: Opener) -> None:
        page = opened("modbus", "server")
        page.connect()
        line = {"baudRate": 19200, "dataBits": 8, "stopBits": 1, "parity": "even"}
        quiet = {"dataTerminalReady": False, "requestToSend": False}
        assert page.log() == [["open", line], ["signals", quiet]]

    def test_is_opened_as_its_user_says(self, opened: Opener) -> None:
        page = opened("matty", "esp")
        page.page.fill("#baud", "9600")
        page.page.select_option("#parity", "odd")
        page.page.check("#dtr")
        page.connect()
        line = {"baudRate": 9600, "dataBits": 8, "stopBits": 1, "parity": "odd"}
        asserted = {"dataTerminalReady": True, "requestToSend": False}
        assert page.log() == [["open", line], ["signals", asserted]]

    def test_is_closed_and_opened_again(self, opened: Opener) -> None:
        page = opened("matty", "esp")
        page.connect()
        page.feed(ACK)
        page.page.click("#connect")
        page.page.wait_for_selector("text=Not connected.")
        assert page.log()[-1] == ["close"]
        assert page.page.is_disabled("#send")
        page.run("() => fake.isChosen = false")  # The browser does not have to ask again.
        page.connect()
        assert page.rows("messages") == []
        page.feed(ACK + ACK)
        assert page.rows("messages")[0][2] == "2"

    def test_that_is_lost_is_opened_when_it_is_back(self, opened: Opener) -> None:
        page = opened("matty", "esp")
        page.connect()
        page.feed(ACK + STATUS[:5])
        page.run("() => fake.unplug()")
        page.page.wait_for_selector("text=/^The device is gone/")
        assert page.rows("messages")[0][2] == "1"
        assert [row[0] for row in page.rows("invalid")] == ["truncated"]
        assert "NetworkError: The device has been lost." in page.text("#problems")
        page.run("() => fake.plug()")
        page.page.wait_for_selector("text=/^Connected/")
        page.feed(ACK)
        assert page.rows("messages")[0][2] == "1"

    def test_that_is_lost_waits_for_its_user_if_asked(self, opened: Opener) -> None:
        page = opened("matty", "esp")
        page.connect()
        page.page.uncheck("#again")
        page.run("() => fake.unplug()")
        page.page.wait_for_selector("text=Open again")
        page.page.click("#connect")  # It is not there yet.
        page.page.wait_for_selector("text=Failed to open serial port.")
        page.run("() => fake.plug()")
        page.connect()
        page.feed(ACK)
        assert page.rows("messages")[0][2] == "1"

    def test_goes_on_behind_a_character_that_was_wrong(self, opened: Opener) -> None:
        page = opened("matty", "esp")
        page.connect()
        page.feed(ACK)
        page.run("() => fake.disturb('ParityError')")
        page.page.wait_for_selector("text=/^ParityError/")
        page.feed(ACK)
        assert page.rows("messages")[0][2] == "2"
        assert page.text("#state") == "Connected."

    def test_that_nobody_chose_is_no_problem(self, opened: Opener) -> None:
        page = opened("matty", "esp")
        page.run("() => fake.isChosen = false")
        page.page.click("#connect")
        page.pass_time(100)
        assert (page.text("#state"), page.rows("messages")) == ("Not connected.", [])
        assert page.run("() => problems.children.length") == 0

    def test_is_missing_in_some_browsers(self, browser: Any, server: str) -> None:
        page = Live(browser, server, "delete Navigator.prototype.serial;")
        assert page.text("#state").startswith("This browser has no Web Serial")
        assert page.page.is_disabled("#connect")
        page.context.close()


class TestAccess:
    @pytest.mark.parametrize("scheme", SCHEMES)
    def test_axe_finds_nothing(self, opened: Opener, scheme: str) -> None:
        if not AXE.is_file():
            unavailable("axe-core is not installed in .cache/axe")
        page = opened("matty", "esp", color_scheme=scheme)
        page.connect()
        page.send()
        page.page.select_option("#message", "go")
        page.page.fill('[data-key="speed"]', "40000")
        page.feed(STATUS + BAD + ACK)
        page.feed(bytes.fromhex("55 02 02 41 BB"))
        assert page.changed() == ["counter 2*"]
        page.run("(bytes) => fake.disturb('ParityError')")
        page.page.wait_for_selector("text=/^ParityError/")
        page.run(AXE.read_text(encoding="utf-8"))
        page.page.clock.resume()
        found = page.run("options => axe.run(options)", SCHEMES[scheme])["violations"]
        told = [(item["id"], [node["html"][:200] for node in item["nodes"]]) for item in found]
        assert told == []

    def test_keys_suffice(self, opened: Opener) -> None:
        page = opened("matty", "esp")
        page.page.focus("#connect")
        page.page.keyboard.press("Enter")
        page.page.wait_for_selector("text=/^Connected/")
        page.page.focus("#message")
        page.page.keyboard.type("go")
        for _ in range(20):
            page.page.keyboard.press("Tab")
            if page.run("() => document.activeElement.id") == "send":
                break
        page.run("() => fake.port.written.length = 0")
        page.page.keyboard.press("Space")
        page.page.wait_for_selector("text=/^Sent go/")
        module = module_at(PATHS["matty"])
        go = module.Go(speed=0, steer=0)
        assert bytes(page.run("() => fake.port.written")) == module.encode(go, counter=0)
