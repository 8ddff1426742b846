/** An event: its bytes as runs of colour, and the rows that say what they mean. */
import { cellsOf } from "./api.js";
import { h } from "./dom.js";
import { titleOf } from "./explain.js";
import { hexOf } from "./octets.js";

const COLOURS = 6;
const HEADS = ["offset", "wire", "unstuffed", "name", "type", "raw", "meaning"];

/** The event as an article; `isOther(cells)` says of a row that another reading does not have it. */
export function eventView(explainer, event, time, isOther) {
  const rows = explainer.rows(event);
  const isStuffed = explainer.senderOf(event).isStuffed;
  const title = titleOf(event, rows);
  const lines = rows.map((item) => cellsOf(event, item));
  const others = isOther && lines.map(isOther);
  return h(
    "article",
    { className: `event ${event.kind}`, "aria-label": title },
    h("h3", {}, `${time === null ? "" : `${time / 1e9} s, `}${title}`),
    ...linked(runs(rows, isStuffed, others), table(rows, lines, isStuffed, others)),
  );
}

/** A run for each row that has bytes: what is on the wire and, where it differs, unstuffed. */
function runs(rows, isStuffed, others) {
  const found = rows.map((item, index) => {
    if (!item.wire.length) return null;
    const wire = hexOf(item.wire);
    const plain = hexOf(item.bytes);
    return h(
      "button",
      {
        type: "button",
        className: `run c${index % COLOURS}${item.fault ? " wrong" : ""}${others?.[index] ? " differs" : ""}`,
        "data-row": String(index),
        tabIndex: -1,
      },
      h("span", { className: "wire" }, wire),
      isStuffed && plain !== wire ? h("span", { className: "plain" }, plain || "no byte") : null,
      h("span", { className: "name" }, `${others?.[index] ? "≠ " : ""}${item.fault ? "! " : ""}${item.path || item.meaning || "?"}`),
    );
  });
  return h("div", { className: "runs", role: "group", "aria-label": "Bytes" }, found);
}

function table(rows, lines, isStuffed, others) {
  const keep = (cells) => (isStuffed ? cells : [...cells.slice(0, 2), ...cells.slice(3)]);
  const heads = [...keep(HEADS), ...(others ? ["other"] : [])].map((name) => h("th", { scope: "col" }, name));
  const body = lines.map((cells, index) => {
    const fault = cells[cells.length - 1];
    const own = keep(cells.slice(0, -1)).map((cell) => h("td", {}, cell));
    if (fault) own[own.length - 1].append(" ", h("span", { className: "fault" }, fault));
    if (others) own.push(h("td", {}, others[index] ? "differs" : ""));
    const className = others?.[index] ? "differs" : "";
    return h("tr", { className, "data-row": String(index), "data-inside": Boolean(rows[index].bits) }, own);
  });
  const found = h("table", { className: "cells" }, h("thead", {}, h("tr", {}, heads)), h("tbody", {}, body));
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
    // A field lights up with all of its bits, and one of them with its field.
    let end = index + 1;
    while (own === index && lines[end]?.dataset.inside !== undefined) end++;
    for (const item of [...runsOf, ...lines]) {
      const row = Number(item.dataset.row);
      item.classList.toggle("lit", row === own || (index <= row && row < end));
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
