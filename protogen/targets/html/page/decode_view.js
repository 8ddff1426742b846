/** The bench's side that decodes: bytes as runs of colour, and the rows of each event. */
import { cellsOf } from "./api.js";
import { by, h, later, options, show } from "./dom.js";
import { titleOf } from "./explain.js";
import { InputError, piecesOf } from "./input.js";
import { fromHex, hexOf } from "./octets.js";
import { eventsOf, takesAll } from "./streams.js";

const COLOURS = 6;
const PAGE = 50;
const HEADS = ["offset", "wire", "unstuffed", "name", "type", "raw", "meaning"];

export class DecodeView {
  constructor(explainer, onChange) {
    this.explainer = explainer;
    this.onChange = onChange;
    const { plans, codec } = explainer;
    this.endpoints = [...new Set(plans.senders.map((item) => item.endpoint))];
    const choices = this.endpoints.map((name) => [name, name]);
    if (choices.length > 1 && takesAll(codec)) choices.unshift(["", "either side"]);
    show(by("sender"), options(choices, choices[0]?.[0]));
    const examples = plans.examples ?? [];
    show(by("example"), options([["", "none"], ...examples.map(({ message, name }, at) => [String(at), `${message}: ${name}`])], ""));
    const told = plans.senders.flatMap((item) => item.parts.filter((part) => part.kind === "told"));
    this.told = [...new Set(told.map((part) => part.name))].map((name) => {
      const field = h("input", { type: "text", size: 8, "data-told": name });
      field.addEventListener("input", later(() => this.update()));
      by("sender").closest("p").append(h("label", {}, `${name}, told `, field));
      return [name, field];
    });
    by("example").addEventListener("change", () => this.example());
    by("sender").addEventListener("change", () => this.update());
    by("bytes").addEventListener("input", later(() => this.update()));
  }

  example() {
    const chosen = this.explainer.plans.examples[Number(by("example").value || "-1")];
    if (chosen) this.set(hexOf(fromHex(chosen.hex)), chosen.sender);
  }

  /** Show these bytes of an endpoint. */
  set(text, endpoint) {
    by("bytes").value = text;
    if (endpoint) by("sender").value = endpoint;
    this.update();
  }

  update() {
    const text = by("bytes").value;
    const endpoint = by("sender").value;
    show(by("events"));
    by("note").textContent = "";
    try {
      const { form, pieces, notes } = piecesOf(text, this.endpoints);
      const found = eventsOf(this.explainer.codec, pieces, endpoint, this.endpoints, this.toldValues());
      const size = pieces.reduce((sum, item) => sum + item.bytes.length, 0);
      if (size) by("note").textContent = [summary(found, size, form), ...notes.slice(0, 3)].join(". ");
      this.showFrom(found, 0);
    } catch (error) {
      if (!(error instanceof InputError || error instanceof RangeError)) throw error;
      by("note").textContent = error.message;
    }
    this.onChange(text, endpoint);
  }

  /** Identities that the bytes do not say: numbers, or several for frames that follow each other. */
  toldValues() {
    const given = this.told.filter(([, field]) => field.value.trim());
    return Object.fromEntries(given.map(([name, field]) => [name, field.value.trim().split(/[\s,]+/).map(Number)]));
  }

  /** Show a page of events, and a button for the next. */
  showFrom(found, start) {
    const shown = found.slice(start, start + PAGE).map(({ event, time }) => this.event(event, time));
    by("events").append(...shown);
    const left = found.length - start - PAGE;
    if (left <= 0) return;
    const button = h("button", { type: "button" }, `Show more: ${left} are left`);
    button.addEventListener("click", () => {
      button.remove();
      this.showFrom(found, start + PAGE);
    });
    by("events").append(button);
  }

  event(event, time) {
    const rows = this.explainer.rows(event);
    const isStuffed = this.explainer.senderOf(event).isStuffed;
    const title = titleOf(event, rows);
    return h(
      "article",
      { className: `event ${event.kind}`, "aria-label": title },
      h("h3", {}, `${time === null ? "" : `${time / 1e9} s, `}${title}`),
      ...linked(runs(rows, isStuffed), table(event, rows, isStuffed)),
    );
  }
}

function summary(found, size, form) {
  const count = (kind) => found.filter(({ event }) => event.kind === kind).length;
  const kinds = [
    [count("message"), "message"],
    [count("unknown"), "unknown frame"],
    [count("invalid"), "invalid span"],
  ];
  const said = kinds.filter(([number]) => number).map(([number, word]) => `${number} ${word}${number === 1 ? "" : "s"}`);
  return `${size} byte${size === 1 ? "" : "s"} of ${form}: ${said.join(", ")}`;
}

/** A run for each row that has bytes: what is on the wire and, where it differs, unstuffed. */
function runs(rows, isStuffed) {
  const found = rows.map((item, index) => {
    if (!item.wire.length) return null;
    const wire = hexOf(item.wire);
    const plain = hexOf(item.bytes);
    return h(
      "button",
      {
        type: "button",
        className: `run c${index % COLOURS}${item.fault ? " wrong" : ""}`,
        "data-row": String(index),
        tabIndex: -1,
      },
      h("span", { className: "wire" }, wire),
      isStuffed && plain !== wire ? h("span", { className: "plain" }, plain || "no byte") : null,
      h("span", { className: "name" }, `${item.fault ? "! " : ""}${item.path || item.meaning || "?"}`),
    );
  });
  return h("div", { className: "runs", role: "group", "aria-label": "Bytes" }, found);
}

function table(event, rows, isStuffed) {
  const keep = (cells) => (isStuffed ? cells : [...cells.slice(0, 2), ...cells.slice(3)]);
  const heads = keep(HEADS).map((name) => h("th", { scope: "col" }, name));
  const lines = rows.map((item, index) => {
    const cells = cellsOf(event, item);
    const fault = cells.pop();
    const own = keep(cells).map((cell) => h("td", {}, cell));
    if (fault) own[own.length - 1].append(" ", h("span", { className: "fault" }, fault));
    return h("tr", { "data-row": String(index), "data-inside": Boolean(item.bits) }, own);
  });
  const found = h("table", { className: "cells" }, h("thead", {}, h("tr", {}, heads)), h("tbody", {}, lines));
  return h("div", { className: "wide", tabIndex: 0, role: "group", "aria-label": "Rows" }, found);
}

/** Light up the row of a run and the run of a row; arrows go from run to run. */
function linked(bytes, rows) {
  const runsOf = [...bytes.children];
  if (runsOf[0]) runsOf[0].tabIndex = 0;
  const lines = [...rows.querySelectorAll("tbody tr")];
  const light = (index) => {
    // What is some bits has no bytes of its own: they are those of the run in front of it.
    let own = index;
    while (lines[own]?.dataset.inside !== undefined) own--;
    for (const item of [...runsOf, ...lines]) {
      const { row } = item.dataset;
      if (row !== undefined) item.classList.toggle("lit", row === String(index) || row === String(own));
    }
  };
  const onPoint = (event) => {
    const { row } = event.target.closest("[data-row]")?.dataset ?? {};
    if (row !== undefined) light(Number(row));
  };
  for (const holder of [bytes, rows]) {
    holder.addEventListener("pointerover", onPoint);
    holder.addEventListener("focusin", onPoint);
    holder.addEventListener("click", onPoint);
  }
  bytes.addEventListener("keydown", (event) => {
    const step = { ArrowRight: 1, ArrowLeft: -1, ArrowDown: 1, ArrowUp: -1 }[event.key];
    const at = runsOf.indexOf(document.activeElement);
    const next = runsOf[at + (step ?? 0)];
    if (!step || at < 0 || !next) return;
    event.preventDefault();
    runsOf[at].tabIndex = -1;
    next.tabIndex = 0;
    next.focus();
  });
  return [bytes, rows];
}
