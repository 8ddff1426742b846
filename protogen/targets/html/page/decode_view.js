/** The bench's side that decodes: bytes of any dress, and what each event says. */
import { by, h, later, options, show } from "./dom.js";
import { eventView } from "./event_view.js";
import { readText } from "./input.js";
import { fromHex, hexOf } from "./octets.js";
import { eventsOf, takesAll } from "./streams.js";
import { InputError } from "./tokens.js";

const PAGE = 50;

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

  /** Show these bytes of an endpoint; `told` has what they do not say. */
  set(text, endpoint, told = new Map()) {
    by("bytes").value = text;
    for (const [name, field] of this.told) field.value = told.get(`@${name}`) ?? field.value;
    if (endpoint) by("sender").value = endpoint;
    this.update();
  }

  update() {
    const text = by("bytes").value;
    const endpoint = by("sender").value;
    show(by("events"));
    by("note").textContent = "";
    try {
      const given = readText(text, this.endpoints);
      const found = eventsOf(this.explainer.codec, given, endpoint, this.endpoints, this.toldValues());
      if (given.size) by("note").textContent = [summary(found, given.size, given.form), ...given.notes].join(". ");
      this.showFrom(found, 0);
    } catch (error) {
      if (!(error instanceof InputError || error instanceof RangeError)) throw error;
      by("note").textContent = error.message;
    }
    this.onChange(text, endpoint, Object.fromEntries(this.told.map(([name, field]) => [`@${name}`, field.value])));
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
    return eventView(this.explainer, event, time);
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
