/** Puts the page's parts to work: a protocol of the package, a port, what comes in and what is sent. */
import { by, h, options, show } from "./dom.js";
import { Line } from "./line.js";
import { LiveView } from "./live_view.js";
import { resolved } from "./plans.js";
import { SendView } from "./send_view.js";
import { Tally } from "./tally.js";

/** Milliseconds between two looks at what came in. */
const REFRESH = 200;
/**
 * Milliseconds without a byte that are taken for a silence. Adapters hand bytes on after 16 or so, and
 * a frame that has another end is not to be cut because the machine is busy.
 */
const SILENCE = { isEnd: 20, isNone: 200 };
const MOST_PROBLEMS = 20;
const STATES = {
  closed: "Not connected.",
  opening: "Opening the port.",
  open: "Connected.",
  closing: "Closing the port.",
  lost: "The device is gone. It can be opened again when it is back.",
};

const json = async (path) => (await fetch(path)).json();

class Page {
  constructor(plans, codec) {
    this.plans = plans;
    this.codec = codec;
    this.ports = [];
    this.last = null;
    this.line = new Line({
      bytes: (bytes) => this.bytes(bytes),
      state: (state) => this.state(state),
      error: (error) => problem(error),
    });
    this.live = new LiveView(plans, codec);
    this.send = new SendView(plans, codec, (bytes) => this.line.write(bytes));
    this.silence = 0;
    this.settings();
    this.clear();
  }

  // --- what the page is set to --------------------------------------------------------------------

  settings() {
    const { link, senders } = this.plans;
    const endpoints = [...new Set(senders.map((item) => item.endpoint))];
    const choices = endpoints.map((name) => [name, name]);
    if (endpoints.length > 1 && takesAll(this.codec)) choices.push(["", "any of them"]);
    const asked = new URL(location.href).searchParams.get("endpoint");
    const first = choices.some(([name]) => name === asked) ? asked : endpoints[endpoints.length - 1];
    show(by("endpoint"), options(choices, first));
    by("baud").value = link.baud ?? "";
    const settings = [["data-bits", link.dataBits, "8"], ["parity", link.parity, "none"], ["stop-bits", link.stopBits, "1"]];
    for (const [id, value, usual] of settings) choose(by(id), String(value), usual);
    this.send.offer(first);
  }

  listen() {
    const url = new URL(location.href);
    url.searchParams.set("endpoint", by("endpoint").value);
    history.replaceState(null, "", url);
    this.send.offer(by("endpoint").value);
    this.clear();
  }

  clear() {
    this.decoder = new this.codec.Decoder(by("endpoint").value || undefined);
    this.tally = new Tally(performance.now());
    this.live.clear();
    this.update();
  }

  update() {
    this.live.update(this.tally, performance.now());
  }

  // --- the port -----------------------------------------------------------------------------------

  async refreshPorts() {
    this.ports = await navigator.serial.getPorts();
    const names = this.ports.map((port, at) => [String(at), nameOf(port, at)]);
    const at = this.ports.indexOf(this.last);
    show(by("port"), options([["", "ask the browser"], ...names], at < 0 ? "" : String(at)));
  }

  async connect() {
    if (this.line.state === "open") return this.line.close();
    show(by("problems"));
    try {
      const chosen = this.ports[by("port").value] ?? (await navigator.serial.requestPort());
      await this.openPort(chosen);
    } catch (error) {
      problem(error);
    }
    return undefined;
  }

  async openPort(port) {
    this.last = port;
    await this.refreshPorts();
    const number = (id) => Number(by(id).value);
    const asked = {
      baudRate: number("baud"),
      dataBits: number("data-bits"),
      stopBits: number("stop-bits"),
      parity: by("parity").value,
    };
    const signals = { dataTerminalReady: by("dtr").checked, requestToSend: by("rts").checked };
    await this.line.open(port, asked, signals);
  }

  state(state) {
    by("state").textContent = STATES[state];
    by("connect").textContent = { open: "Disconnect", lost: "Open again" }[state] ?? "Connect";
    by("connect").disabled = state === "opening" || state === "closing";
    for (const field of by("line").querySelectorAll("input, select")) field.disabled = state === "open";
    by("send").disabled = state !== "open";
    if (state === "open") this.clear();
    else if (state === "closed" || state === "lost") this.quiet();
  }

  /** Open a lost device again as soon as it is back. */
  async back(port) {
    const isBack = this.line.state === "lost" && (port === this.last || isLike(port, this.last));
    if (isBack && by("again").checked) await this.openPort(port).catch(problem);
    else await this.refreshPorts();
  }

  // --- what comes in ------------------------------------------------------------------------------

  bytes(bytes) {
    clearTimeout(this.silence);
    this.tally.add(bytes.length, this.decoder.feed(bytes), performance.now());
    const { idle, endsFrames } = this.plans.link;
    const least = endsFrames ? SILENCE.isEnd : SILENCE.isNone;
    this.silence = setTimeout(() => this.quiet(), Math.max(least, (idle ?? 0) * 1000));
  }

  /** The line is silent: what has come in is complete, or will never be. */
  quiet() {
    clearTimeout(this.silence);
    this.tally.add(0, this.decoder.idle(), performance.now());
    this.update();
  }
}

/** Choose a value of a menu; one that Web Serial does not have is told. */
function choose(menu, value, usual) {
  menu.value = value;
  if (menu.value === value) return;
  problem(new RangeError(`the schema says ${menu.id} ${value}, which Web Serial does not have`));
  menu.value = usual;
}

function takesAll(codec) {
  try {
    return Boolean(new codec.Decoder(undefined));
  } catch {
    return false;
  }
}

const hex = (number) => number.toString(16).padStart(4, "0");

function nameOf(port, at) {
  const { usbVendorId, usbProductId } = port.getInfo();
  return usbVendorId === undefined ? `port ${at + 1}` : `USB ${hex(usbVendorId)}:${hex(usbProductId)}, port ${at + 1}`;
}

function isLike(port, other) {
  const [one, two] = [port.getInfo(), other.getInfo()];
  const isUsb = one.usbVendorId !== undefined;
  return isUsb && one.usbVendorId === two.usbVendorId && one.usbProductId === two.usbProductId;
}

function problem(error) {
  // Whoever closes the browser's list without a choice knows.
  if (error.name === "NotFoundError") return;
  by("problems").prepend(h("li", {}, `${error.name}: ${error.message}`));
  while (by("problems").children.length > MOST_PROBLEMS) by("problems").lastChild.remove();
}

async function start() {
  const names = await json("./protocols.json");
  const asked = new URL(location.href).searchParams.get("protocol");
  const name = names.includes(asked) ? asked : names[0];
  show(by("protocol"), options(names.map((item) => [item, item]), name));
  by("protocol").addEventListener("change", () => location.assign(`?protocol=${by("protocol").value}`));
  const [plans, codec] = await Promise.all([json(`./plans/${name}.json`), import(`../../dist/${name}.js`)]);
  document.title = `${plans.title}: Web Serial`;
  by("title").textContent = plans.title;
  const page = new Page(resolved(plans), codec);
  by("endpoint").addEventListener("change", () => page.listen());
  by("clear").addEventListener("click", () => page.clear());
  setInterval(() => page.update(), REFRESH);
  if (!("serial" in navigator)) {
    by("state").textContent = globalThis.isSecureContext
      ? "This browser has no Web Serial: Chrome, Edge and other browsers on Chromium have it, on a desktop."
      : "Web Serial needs a secure context: open the page by https, or from localhost.";
    by("connect").disabled = true;
    return;
  }
  by("connect").addEventListener("click", () => page.connect());
  navigator.serial.addEventListener("connect", (event) => page.back(event.target));
  navigator.serial.addEventListener("disconnect", () => page.refreshPorts());
  await page.refreshPorts();
}

start().catch(problem);
