/** The tables of what comes in. Rows stay where they are; their cells follow. */
import { by, h, show } from "./dom.js";
import { Explainer, valueText } from "./explain.js";
import { hexOf } from "./octets.js";

const MOST_VALUES = 32;
const MOST_BYTES = 24;
/** Milliseconds for which a change is marked. */
const MARKED = 1000;

/** Explains frames that a decoder found, which know their own codec. */
class FrameExplainer extends Explainer {
  rows(event) {
    this.frame = event.source.codec.frame;
    return super.rows(event);
  }

  frameOf() {
    return this.frame;
  }
}

export class LiveView {
  constructor(plans, codec) {
    this.explainer = new FrameExplainer(plans, codec);
    this.clear();
  }

  clear() {
    this.lines = new Map();
    show(by("messages"));
    show(by("invalid"));
    by("nothing").hidden = false;
    by("no-invalid").hidden = false;
  }

  /** Show what there is now. */
  update(tally, now) {
    for (const [key, item] of tally.frames) this.frame(key, item, now, tally.start);
    for (const [key, item] of tally.invalid) this.span(key, item);
    by("nothing").hidden = tally.frames.size > 0;
    by("no-invalid").hidden = tally.invalid.size > 0;
    const counts = [[tally.bytes, "byte"], [tally.messages, "frame"], [tally.invalidBytes, "byte"]];
    const [bytes, frames, wrong] = counts.map(([count, word]) => `${count} ${word}${count === 1 ? "" : "s"}`);
    by("totals").textContent = `${bytes}, ${frames}, ${wrong} that are no frame`;
  }

  frame(key, item, now, start) {
    const line = this.line(`frame ${key}`, "messages", item.name || "no message has this identity", item.sender, 4);
    const [count, rate, since, values] = line.cells;
    set(count, String(item.count));
    set(rate, `${item.rate(now, start).toFixed(1)}/s`);
    set(since, `${((now - item.time) / 1000).toFixed(1)} s`);
    if (line.event !== item.event) this.values(line, values, item.event, now);
    for (const value of line.values.values()) mark(value, now - value.changed < MARKED);
  }

  span(key, item) {
    const line = this.line(`span ${key}`, "invalid", item.name, item.sender || "any", 3);
    if (line.event === item.event) return;
    line.event = item.event;
    const [count, size, last] = line.cells;
    const { raw, offset, problem } = item.event;
    const more = raw.length > MOST_BYTES ? ` and ${raw.length - MOST_BYTES} more` : "";
    set(count, String(item.count));
    set(size, String(item.size));
    show(last, `offset ${offset}: `, h("code", {}, hexOf(raw.subarray(0, MOST_BYTES))), more, problem ? `, ${problem}` : "");
  }

  /** The line of a table for a key, which begins with two names. */
  line(key, table, name, from, count) {
    if (!this.lines.has(key)) {
      const cells = Array.from({ length: count }, () => h("td", {}));
      const row = h("tr", {}, h("th", { scope: "row" }, name), h("td", {}, from), cells);
      by(table).append(row);
      this.lines.set(key, { cells, values: new Map(), event: null });
    }
    return this.lines.get(key);
  }

  /** The last values of a message; those that differ from what was shown are marked for a while. */
  values(line, cell, event, now) {
    const isFirst = line.event === null;
    line.event = event;
    const found = this.readings(event);
    const names = found.map(([name]) => name).join("\n");
    if (names !== line.names) {
      line.names = names;
      line.values = new Map(found.map(([name]) => [name, valueOf(name)]));
      const shown = [...line.values.values()].map((value) => value.item);
      show(cell, h("ul", { className: "values" }, shown));
    }
    for (const [name, text] of found) {
      const value = line.values.get(name);
      if (value.text === text) continue;
      value.changed = isFirst ? -Infinity : now;
      value.text = text;
      set(value.shown, text);
    }
  }

  /** Names and readings: the parts that its sender chose, and the fields. */
  readings(event) {
    const sender = this.explainer.senderOf(event);
    const chosen = new Set(sender.given.map((part) => part.name));
    const unsent = new Set(sender.parts.filter((part) => ["told", "virtual"].includes(part.kind)).map((part) => part.name));
    const rows = this.explainer.rows(event).filter((row) => {
      if (row.part) return chosen.has(row.part.name);
      return row.path && row.type !== "literal" && row.type !== "" && !unsent.has(row.path);
    });
    const found = new Map();
    for (const row of rows.slice(0, MOST_VALUES)) {
      found.set(row.path, reading(row));
    }
    if (rows.length > MOST_VALUES) found.set("more", `${rows.length - MOST_VALUES} values`);
    return [...found];
  }
}

/** What a row means; a name has its number behind it. */
function reading({ meaning, value, bytes, fault }) {
  const text = valueText(value);
  const isNamed = typeof value === "bigint" && meaning && !/^[-\d]/.test(meaning);
  return [isNamed ? `${meaning} (${text})` : meaning || text || hexOf(bytes), fault].filter(Boolean).join(" ");
}

function valueOf(name) {
  const shown = h("span", {});
  const sign = h("span", { className: "sign" });
  const item = h("li", { "data-name": name }, h("span", { className: "of" }, name), " ", shown, sign);
  return { item, shown, sign, text: null, changed: -Infinity };
}

function mark(value, isMarked) {
  set(value.sign, isMarked ? "*" : "");
  value.item.classList.toggle("changed", isMarked);
}

/** Put a text in place, if it is another. */
function set(element, text) {
  if (element.textContent !== text) element.textContent = text;
}
