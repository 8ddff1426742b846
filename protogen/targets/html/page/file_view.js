/** A recording on the bench: counts and rates of messages, damage, and a field over time. */
import { fractionOf, fraction, number } from "./fractions.js";
import { by, h, options, show } from "./dom.js";
import { piecesOf, InputError } from "./input.js";
import { hexOf } from "./octets.js";
import { Plot } from "./plot.js";
import { scaled } from "./readings.js";
import { endpointOf } from "./streams.js";
import { keyOf } from "./values.js";

const MOST_BYTES = 50 * 1024 * 1024;
const CHUNK = 1 << 17;
const MOST_SPANS = 100;
const MOST_POINTS = 200000;

export class FileView {
  constructor(explainer, endpoints, inspect) {
    this.explainer = explainer;
    this.endpoints = endpoints;
    this.inspect = inspect;
    this.run = 0;
    this.input = null;
    show(by("file-sender"), options(endpoints.map((name) => [name, name]), endpoints[0]));
    by("file-sender").addEventListener("change", () => this.count());
    by("chosen").addEventListener("change", () => this.read(by("chosen").files[0]));
    const drop = by("drop");
    const over = (isOver) => (event) => {
      event.preventDefault();
      drop.classList.toggle("over", isOver);
    };
    drop.addEventListener("dragover", over(true));
    drop.addEventListener("dragleave", over(false));
    drop.addEventListener("drop", (event) => {
      over(false)(event);
      this.read(event.dataTransfer.files[0]);
    });
  }

  async read(file) {
    if (!file) return;
    show(by("summary"));
    if (file.size > MOST_BYTES) {
      by("progress").textContent = `${file.name} has more than 50 MB.`;
      return;
    }
    by("progress").textContent = `Reading ${file.name}`;
    const bytes = new Uint8Array(await file.arrayBuffer());
    await new Promise((resolve) => setTimeout(resolve));
    try {
      this.input = piecesIn(bytes, this.endpoints);
    } catch (error) {
      if (!(error instanceof InputError)) throw error;
      by("progress").textContent = error.message;
      return;
    }
    await this.count();
  }

  /** Decode all of it, and call `take(event, time)` for each event. False: another run began. */
  async each(take) {
    const run = ++this.run;
    const { pieces } = this.input;
    const chosen = by("file-sender").value;
    const decoders = new Map();
    const size = pieces.reduce((sum, item) => sum + item.bytes.length, 0);
    let [done, since] = [0, 0];
    for (const item of pieces) {
      const { bytes, time } = item;
      const own = endpointOf(item, chosen, this.endpoints);
      if (!decoders.has(own)) decoders.set(own, new this.explainer.codec.Decoder(own));
      for (let at = 0; at < bytes.length; at += CHUNK) {
        for (const event of decoders.get(own).feed(bytes.subarray(at, at + CHUNK))) take(event, time);
        const taken = Math.min(CHUNK, bytes.length - at);
        [done, since] = [done + taken, since + taken];
        if (since < CHUNK) continue;
        since = 0;
        by("progress").textContent = `${Math.floor((100 * done) / size)} % of ${size} bytes`;
        await new Promise((resolve) => setTimeout(resolve));
        if (run !== this.run) return false;
      }
    }
    for (const decoder of decoders.values()) for (const event of decoder.flush()) take(event, null);
    by("progress").textContent = `${size} bytes of ${this.input.form}, decoded.`;
    return true;
  }

  async count() {
    if (!this.input) return;
    const [counts, spans] = [new Map(), []];
    let [invalid, lost] = [0, 0];
    let [first, last] = [null, null];
    const isWhole = await this.each((event, time) => {
      if (time !== null) [first, last] = [first ?? time, time];
      if (event.kind === "invalid") {
        [invalid, lost] = [invalid + 1, lost + event.size];
        // The bytes are copied, so that what they lie in can be forgotten.
        if (spans.length < MOST_SPANS) spans.push({ ...spanOf(event), raw: event.raw.slice(0, 64) });
        return;
      }
      const name = event.kind === "message" ? event.message.message : "unknown";
      const own = counts.get(name) ?? { count: 0, bytes: 0 };
      counts.set(name, { count: own.count + 1, bytes: own.bytes + event.size });
    });
    if (isWhole) this.show(counts, spans, { invalid, lost, seconds: first === last ? 0 : (last - first) / 1e9 });
  }

  show(counts, spans, { invalid, lost, seconds }) {
    const size = this.input.pieces.reduce((sum, item) => sum + item.bytes.length, 0);
    // Without times, a second is so many bytes as the link carries.
    const { byteRate } = this.explainer.plans;
    const duration = seconds || (byteRate ? size / byteRate : 0);
    const rate = (count) => (duration ? (count / duration).toPrecision(4) : "");
    const head = ["message", "count", "bytes", duration ? `per second${seconds ? "" : ", at the link's rate"}` : null];
    const rows = [...counts].sort((a, b) => b[1].count - a[1].count).map(([name, own]) => [
      name, own.count, own.bytes, duration ? rate(own.count) : null,
    ]);
    show(
      by("summary"),
      h("h3", {}, "Messages"),
      tableOf(head, rows),
      h("h3", {}, `Invalid: ${invalid} spans, ${lost} bytes`),
      spans.length ? tableOf(["offset", "bytes", "reason", "first bytes"], spans.map((it) => this.span(it))) : null,
      invalid > spans.length ? h("p", {}, `${invalid - spans.length} more`) : null,
      this.plotForm([...counts.keys()]),
    );
  }

  span(item) {
    const look = () => this.inspect(hexOf(item.raw), by("file-sender").value);
    const button = h("button", { type: "button", onclick: look }, hexOf(item.raw.slice(0, 8)));
    return [item.offset, item.size, item.reason, button];
  }

  // --- a field over time -------------------------------------------------------------------------

  plotForm(names) {
    const { messages } = this.explainer.plans;
    const fields = names
      .filter((name) => name in messages)
      .flatMap((name) => numbersOf(messages[name].steps).map((item) => ({ ...item, message: name })));
    if (!fields.length) return null;
    const pairs = fields.map((item, index) => [String(index), `${item.message}.${item.path}`]);
    const menu = h("select", {}, options([["", "choose"], ...pairs], ""));
    const canvas = h("canvas", { role: "img", "aria-label": "No field is chosen" });
    const said = h("p", { role: "status", className: "hint" });
    menu.addEventListener("change", () => menu.value && this.plot(fields[Number(menu.value)], canvas, said));
    return h("div", {}, h("h3", {}, "A field over time"), h("label", {}, "Field ", menu), canvas, said);
  }

  async plot(field, canvas, said) {
    let points = [];
    let [step, seen] = [1, 0];
    const isWhole = await this.each((event, time) => {
      if (event.kind !== "message" || event.message.message !== field.message) return;
      const value = field.read(event.message);
      if (value === null || seen++ % step) return;
      points.push([time === null ? event.offset : time / 1e9, value]);
      if (points.length < MOST_POINTS) return;
      [points, step] = [points.filter((_, index) => index % 2 === 0), step * 2];
    });
    if (!isWhole) return;
    const isTimed = this.input.pieces.some((item) => item.time !== null);
    const words = new Plot(canvas, points, isTimed ? "s" : "offset in bytes", field.unit).draw();
    const text = `${field.message}.${field.path}: ${words}${step > 1 ? `, each ${step}th value` : ""}`;
    canvas.setAttribute("aria-label", text);
    said.textContent = text;
  }
}

const spanOf = ({ offset, size, reason }) => ({ offset, size, reason });

/** Bytes as pieces: text where it is text that stands for bytes, else as they are. */
function piecesIn(bytes, endpoints) {
  const isText = bytes.subarray(0, 4096).every((byte) => (byte >= 0x20 && byte < 0x7f) || [9, 10, 13].includes(byte));
  const raw = { form: "a raw recording", pieces: [{ bytes, time: null, name: "" }] };
  if (!isText || !bytes.length) return raw;
  try {
    return piecesOf(new TextDecoder().decode(bytes), endpoints);
  } catch (error) {
    // Protocols of printable bytes look like text, too.
    if (!(error instanceof InputError)) throw error;
    return raw;
  }
}

/** The numbers of a message that are always there, with what reads them as physical values. */
function numbersOf(steps, path = "", reach = (message) => message) {
  return steps.flatMap((step) => {
    const own = path + step.name;
    const inside = (message) => reach(message)?.[keyOf(step)];
    if (step.kind === "record") return numbersOf(step.steps ?? [], `${own}.`, inside);
    if (step.kind === "optional") return numbersOf([step.step], path, reach);
    const { type } = step;
    if (step.kind !== "scalar" || !["integer", "float"].includes(type.kind)) return [];
    const special = Object.values(step.special ?? {}).map(Number);
    const read = (message) => {
      const raw = inside(message);
      if (raw === null || raw === undefined || special.includes(Number(raw))) return null;
      if (type.kind === "float" && !Number.isFinite(raw)) return null;
      if (!step.scale) return Number(raw);
      return number(scaled(step, type.kind === "float" ? fractionOf(raw) : fraction(BigInt(raw))));
    };
    return [{ path: own, unit: step.unit ?? "", read }];
  });
}

function tableOf(heads, rows) {
  const keep = (cells) => cells.filter((cell) => cell !== null);
  const line = (cells) => h("tr", {}, keep(cells).map((cell) => h("td", {}, cell instanceof Node ? cell : String(cell))));
  const head = h("tr", {}, keep(heads).map((name) => h("th", { scope: "col" }, name)));
  const table = h("table", {}, h("thead", {}, head), h("tbody", {}, rows.map(line)));
  return h("div", { className: "wide", tabIndex: 0, role: "group", "aria-label": heads[0] }, table);
}
