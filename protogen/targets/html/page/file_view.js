/** A recording on the bench: counts and rates of messages, damage, and a field over time. */
import { fractionOf, fraction, number } from "./fractions.js";
import { by, h, options, show } from "./dom.js";
import { hexOf } from "./octets.js";
import { Plot, Series } from "./plot.js";
import { scaled } from "./readings.js";
import { Recording, Tally } from "./recording.js";
import { keyOf } from "./values.js";

const MOST_BYTES = 50 * 1024 * 1024;

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
    this.input = null;
    const run = ++this.run;
    by("cancel").hidden = true;
    if (file.size > MOST_BYTES) {
      by("progress").textContent = `${file.name} has more than 50 MB.`;
      return;
    }
    by("progress").textContent = `Reading ${file.name}`;
    const input = await Recording.of(file, this.endpoints);
    if (run !== this.run) return;
    this.input = input;
    await this.count();
  }

  /** Decode all of it into what `begin()` gives, or up to where that is cancelled. Null: another run began. */
  async each(begin) {
    const { input } = this;
    const run = ++this.run;
    const [cancel, said] = [by("cancel"), by("progress")];
    let [isCancelled, told] = [false, ""];
    cancel.onclick = () => (isCancelled = true);
    cancel.hidden = false;
    const goesOn = (place) => {
      if (run !== this.run || isCancelled) return false;
      const now = `${Math.floor((100 * place) / input.file.size)} % of ${input.file.size} bytes`;
      // What is read aloud changes seldom.
      if (now !== told) said.textContent = told = now;
      return true;
    };
    const taker = await input.read(this.explainer.codec, by("file-sender").value, begin, goesOn);
    if (run !== this.run) return null;
    if (document.activeElement === cancel) by("chosen").focus();
    cancel.hidden = true;
    const { size, out } = taker;
    said.textContent = [
      `${size} bytes of ${input.form}, decoded${isCancelled ? ", then cancelled" : ""}`,
      ...(out.left ? [`${out.left} lines are left out`, ...out.notes] : []),
    ].join(". ");
    return taker;
  }

  async count() {
    if (!this.input) return;
    const tally = await this.each(() => new Tally());
    if (tally) this.show(tally);
  }

  show({ counts, spans, invalid, lost, size, first, last }) {
    const seconds = Math.max(0, last - first) / 1e9;
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
    let isTimed = false;
    const series = await this.each(() =>
      Object.assign(new Series(), {
        take(event, time) {
          isTimed ||= time !== null;
          if (event.kind !== "message" || event.message.message !== field.message) return;
          const value = field.read(event.message);
          if (value !== null) this.add(time === null ? event.offset : time / 1e9, value);
        },
      }),
    );
    if (!series) return;
    const words = new Plot(canvas, series.scaled(field.physical), isTimed ? "s" : "offset in bytes", field.unit).draw();
    const text = `${field.message}.${field.path}: ${words}`;
    canvas.setAttribute("aria-label", text);
    said.textContent = text;
  }
}

/** The numbers of a message that are always there, with what reads them and makes them physical. */
function numbersOf(steps, path = "", reach = (message) => message) {
  return steps.flatMap((step) => {
    const own = path + step.name;
    const inside = (message) => reach(message)?.[keyOf(step)];
    if (step.kind === "record") return numbersOf(step.steps ?? [], `${own}.`, inside);
    if (step.kind === "optional") return numbersOf([step.step], path, reach);
    const { type } = step;
    if (step.kind !== "scalar" || !["integer", "float"].includes(type.kind)) return [];
    const isFloat = type.kind === "float";
    const special = new Set(Object.values(step.special ?? {}).map(Number));
    const read = (message) => {
      const raw = Number(inside(message) ?? NaN);
      return special.has(raw) || !Number.isFinite(raw) ? null : raw;
    };
    const physical = (raw) =>
      step.scale ? number(scaled(step, isFloat ? fractionOf(raw) : fraction(BigInt(raw)))) : raw;
    return [{ path: own, unit: step.unit ?? "", read, physical }];
  });
}

function tableOf(heads, rows) {
  const keep = (cells) => cells.filter((cell) => cell !== null);
  const line = (cells) => h("tr", {}, keep(cells).map((cell) => h("td", {}, cell instanceof Node ? cell : String(cell))));
  const head = h("tr", {}, keep(heads).map((name) => h("th", { scope: "col" }, name)));
  const table = h("table", {}, h("thead", {}, head), h("tbody", {}, rows.map(line)));
  return h("div", { className: "wide", tabIndex: 0, role: "group", "aria-label": heads[0] }, table);
}
