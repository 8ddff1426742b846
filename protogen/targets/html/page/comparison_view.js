/** Bytes as both versions of a protocol read them, side by side. */
import { cellsOf } from "./api.js";
import { h, later, options, show } from "./dom.js";
import { eventView } from "./event_view.js";
import { readText } from "./input.js";
import { eventsOf } from "./streams.js";
import { InputError } from "./tokens.js";

const MOST = 50;
const HEADS = ["Old", "New"];
let next = 0;

/** What both versions read in what one endpoint sent, in groups that end at the same byte. */
function readingsOf(explainers, names, given) {
  const found = names.map((name, side) =>
    name === null ? [] : eventsOf(explainers[side].codec, given, name, [name]),
  );
  return groupsOf(found).map((group) => ({ names, group }));
}

/** The events of both versions, cut wherever both have come to the same byte. */
function groupsOf(both) {
  const end = ({ event }) => event.offset + event.size;
  const known = new Set(both[1].map(end));
  const cuts = [...both[0].map(end).filter((at) => known.has(at)), Infinity];
  const taken = [0, 0];
  const upTo = (cut) => (events, side) => {
    const first = taken[side];
    while (taken[side] < events.length && end(events[taken[side]]) <= cut) taken[side]++;
    return events.slice(first, taken[side]);
  };
  return cuts.map((cut) => both.map(upTo(cut))).filter((group) => group.some((events) => events.length));
}

function sides(explainers, { names, group }, heads = HEADS) {
  const rowsOf = (side) =>
    group[side].flatMap(({ event }) => explainers[side].rows(event).map((item) => cellsOf(event, item).join("\t")));
  const known = [0, 1].map((side) => new Set(rowsOf(side)));
  const columns = [0, 1].map((side) => {
    const isOther = (cells) => !known[1 - side].has(cells.join("\t"));
    const events = group[side].map(({ event, time }) => eventView(explainers[side], event, time, isOther));
    const nothing = names[side] === null ? "has no such endpoint" : "reads nothing that ends here";
    return h("div", {}, h("p", { className: "side" }, heads[side]), events.length ? events : h("p", {}, nothing));
  });
  return h("div", { className: "sides" }, columns);
}

/** A box for bytes, and both readings of them. */
export class ComparisonBench {
  /** `endpoints` are pairs of names: in OLD and in NEW, null where there is none. */
  constructor(holder, explainers, endpoints) {
    this.explainers = explainers;
    this.endpoints = endpoints;
    const id = `bytes${next++}`;
    const shown = endpoints.map(([old, other]) => [...new Set([old ?? other, other ?? old])].join(", now "));
    this.bytes = h("textarea", { id, rows: 3, spellcheck: false, autocomplete: "off" });
    this.from = h("select", {}, options(shown.map((name, at) => [String(at), name]), "0"));
    this.note = h("p", { role: "status" });
    this.events = h("div");
    this.bytes.addEventListener("input", later(() => this.update()));
    this.from.addEventListener("change", () => this.update());
    show(
      holder,
      h("p", {}, h("label", { htmlFor: id }, "Bytes that both versions decode: hex in any dress, a C array, a log")),
      this.bytes,
      h("p", { className: "row" }, h("label", {}, "From ", this.from)),
      this.note,
      this.events,
    );
  }

  update() {
    show(this.events);
    this.note.textContent = "";
    try {
      const given = readText(this.bytes.value, this.endpoints.flat().filter(Boolean));
      const { form, size, notes } = given;
      const found = this.readings(given);
      const left = found.length > MOST ? [`${found.length - MOST} more are not shown`] : [];
      if (size) this.note.textContent = [`${size} bytes of ${form}`, ...notes, ...left].join(". ");
      show(this.events, found.slice(0, MOST).map((item) => sides(this.explainers, item)));
    } catch (error) {
      if (!(error instanceof InputError || error instanceof RangeError)) throw error;
      this.note.textContent = error.message;
    }
  }

  /** Of each endpoint what it sent: lines that name one are its own, others of the one chosen. */
  readings(given) {
    const chosen = Number(this.from.value);
    const place = (name) => {
      const own = this.endpoints.findIndex((names) => names.includes(name));
      return name && own >= 0 ? own : chosen;
    };
    return this.endpoints.flatMap((names, at) => {
      const own = given.only((name) => place(name) === at);
      return own.size ? readingsOf(this.explainers, names, own) : [];
    });
  }
}

/** Show a frame that the page has as digits in place of its table. */
export function showWitness(holder, explainers) {
  const { hex, old, now } = holder.dataset;
  const heads = [...holder.querySelectorAll(".side")].map((item) => item.textContent);
  const found = readingsOf(explainers, [old ?? null, now ?? null], readText(hex, []));
  holder.replaceWith(...found.map((item) => sides(explainers, item, heads)));
}
