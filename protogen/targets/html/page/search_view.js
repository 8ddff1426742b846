/** Search as one types: all words have to occur, names that begin with them come first. */
import { by, h, show } from "./dom.js";

const MOST = 60;

/** The entries that have all words of a text, the best ones first. */
export function found(entries, text) {
  const query = text.trim().toLowerCase();
  const words = query.split(/\s+/).filter(Boolean);
  if (!words.length) return [];
  const ranked = [];
  entries.forEach((entry, index) => {
    const name = entry[1].toLowerCase();
    const all = `${name} ${entry[2].toLowerCase()}`;
    if (!words.every((word) => all.includes(word))) return;
    ranked.push([rank(name, all, query), index, entry]);
  });
  return ranked.sort((a, b) => a[0] - b[0] || a[1] - b[1]).map(([, , entry]) => entry);
}

function rank(name, all, query) {
  const last = name.slice(name.lastIndexOf(".") + 1);
  if (name === query || last === query) return 0;
  if (name.startsWith(query) || last.startsWith(query)) return 1;
  if (all.includes(query)) return 2;
  return 3;
}

/** The entries of an index: kind, name, more words, and the anchor that it leads to. */
export function entriesOf(index) {
  const entries = [];
  for (const [name, words, fields] of index.messages) {
    const anchor = `message-${name}`;
    entries.push(["message", name, words, anchor]);
    for (const [path, own, values] of fields) {
      entries.push(["field", `${name}.${path}`, own, anchor]);
      for (const [value, raw] of Object.entries(values)) {
        entries.push(["value", value, `${raw} ${name}.${path}`, anchor]);
      }
    }
  }
  for (const [name, words] of Object.entries(index.parts)) entries.push(["part", name, words, "frames"]);
  for (const [name, words] of Object.entries(index.decisions)) {
    entries.push(["decision", name, words, `decision-${name}`]);
  }
  return entries;
}

export function startSearch(index) {
  const entries = entriesOf(index);
  const query = by("query");
  by("search").hidden = false;
  const update = () => {
    const matches = found(entries, query.value);
    const count = matches.length;
    by("count").textContent = query.value.trim() ? `${count || "nothing"} found` : "";
    by("outline").hidden = Boolean(query.value.trim());
    show(by("found"), matches.slice(0, MOST).map(item));
  };
  query.addEventListener("input", update);
  by("search").addEventListener("keydown", (event) => {
    const links = [query, ...by("found").querySelectorAll("a")];
    const step = { ArrowDown: 1, ArrowUp: -1 }[event.key];
    const at = links.indexOf(document.activeElement);
    if (event.key === "Escape") {
      query.value = "";
      update();
      query.focus();
    } else if (step && at >= 0) {
      event.preventDefault();
      links[Math.min(links.length - 1, Math.max(0, at + step))].focus();
    }
  });
  document.addEventListener("keydown", (event) => {
    const isTyping = /^(INPUT|TEXTAREA|SELECT)$/.test(document.activeElement?.tagName ?? "");
    if (event.key !== "/" || isTyping || event.ctrlKey || event.metaKey) return;
    event.preventDefault();
    query.focus();
  });
}

function item([kind, name, words, anchor]) {
  const shown = words.length > 90 ? `${words.slice(0, 89)}…` : words;
  return h("li", {}, h("a", { href: `#${anchor}` }, name), ` ${kind}`, h("small", {}, shown));
}
