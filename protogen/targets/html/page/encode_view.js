/** The bench's side that encodes: a form, the bytes that come of it, and what they mean. */
import { by, copyButton, h, options, show } from "./dom.js";
import { Form, partField } from "./form.js";
import { hexDigits, hexOf } from "./octets.js";
import { asNumber, firstRecord, jsonOf, keyOf } from "./values.js";

export class EncodeView {
  /** `onChange(message, sender, bytes)` and `event(event)`, which shows one. */
  constructor(explainer, shown, onChange) {
    this.explainer = explainer;
    this.shown = shown;
    this.onChange = onChange;
    const names = Object.keys(explainer.plans.messages);
    show(by("message"), options(names.map((name) => [name, name]), names[0]));
    by("message").addEventListener("change", () => this.pick(by("message").value));
    by("from").addEventListener("change", () => this.pick(by("message").value, by("from").value));
    by("fields").addEventListener("submit", (event) => event.preventDefault());
    if (names.length) this.pick(names[0]);
  }

  /** The form of a side's frames; undefined where it has only one. */
  formOf({ endpoint, form }) {
    const forms = this.explainer.plans.senders.filter((item) => item.endpoint === endpoint);
    return forms.length > 1 ? form : undefined;
  }

  /** Who sends a message, in each form of frame that carries it. */
  sidesOf(name) {
    return this.explainer.plans.senders.filter((item) => item.messages.includes(name));
  }

  /** Show a message with the values of its first example, or with zeros. */
  pick(name, sender) {
    const message = this.explainer.plans.messages[name];
    const sides = this.sidesOf(name);
    if (!message || !sides.length) return;
    const asked = sides.filter((item) => item.name === sender || item.endpoint === sender);
    const open = asked.length ? asked : sides;
    for (const side of open) {
      const example = this.example(name, side);
      if (example) return this.take(name, side, example);
    }
    const first = { message: name, ...firstRecord(message.steps, this.explainer.plans.enums, () => undefined) };
    return this.take(name, open[0], { values: first, parts: {} });
  }

  /** Show the message of a frame; false: it is none. */
  load(name, sender, bytes) {
    const [event] = this.explainer.events(bytes, sender, this.toldOf(name, bytes.length));
    if (event?.kind !== "message" || event.message.message !== name) return false;
    this.take(name, this.explainer.senderOf(event), this.stateOf(event));
    return true;
  }

  example(name, side) {
    for (const item of this.explainer.plans.examples ?? []) {
      if (item.message !== name || item.sender !== side.endpoint) continue;
      const bytes = Uint8Array.from(item.hex.match(/../g) ?? [], (digits) => parseInt(digits, 16));
      const [event] = this.explainer.events(bytes, side.endpoint, this.toldOf(name, bytes.length));
      if (event?.kind !== "message" || event.message.message !== name) continue;
      if (this.explainer.senderOf(event) === side) return this.stateOf(event);
    }
    return null;
  }

  /** The values and the given parts of an event, to be edited. */
  stateOf(event) {
    const given = this.explainer.senderOf(event).given;
    const keys = Object.fromEntries(event.source.codec.frame.shown.map((part) => [part.name, part.key]));
    const parts = Object.fromEntries(given.map((part) => [part.name, event.parts[keys[part.name]]]));
    return { values: event.message, parts };
  }

  /** What a receiver of the message has to be told: identities and lengths that no byte says. */
  toldOf(name, size) {
    const found = {};
    for (const side of this.sidesOf(name)) {
      for (const { name: own, isLength } of side.parts.filter((part) => part.kind === "told")) {
        if (isLength) {
          const payload = size - side.around;
          found[own] = side.length.base + (payload ? payload + side.length.optional : 0);
          continue;
        }
        const runs = this.explainer.plans.messages[name].identities?.[side.identity.indexOf(own)];
        if (runs) [[found[own]]] = runs;
      }
    }
    return found;
  }

  /** Show values of a message that goes out in a form of frame. */
  take(name, side, { values, parts }) {
    const sides = this.sidesOf(name);
    const text = (item) => [item.endpoint, this.formOf(item)].filter(Boolean).join(", ");
    by("message").value = name;
    show(by("from"), options(sides.map((item) => [item.name, text(item)]), side.name));
    this.message = this.explainer.plans.messages[name];
    this.side = side;
    this.values = values;
    for (const step of this.message.steps) if (step.computed) delete values[keyOf(step)];
    this.given = side.given.filter((part) => this.isChosen(part));
    this.parts = {};
    for (const part of this.given) this.parts[part.name] = parts[part.name] ?? this.firstOf(part);
    this.draw();
  }

  /** What a part is at first; undefined for a text, which nobody knows. */
  firstOf(part) {
    if (part.default !== undefined || part.type.isText) return part.default;
    const runs = part.kind === "identity" ? this.message.identities[this.side.identity.indexOf(part.name)] : [[part.least]];
    return asNumber(part.type, BigInt(runs[0][0]));
  }

  /** True for a part that callers give in frames of the message: of identities, one of several. */
  isChosen(part) {
    const runs = this.message.identities?.[this.side.identity.indexOf(part.name)];
    return part.kind !== "identity" || runs.length > 1 || runs[0][0] !== runs[0][1];
  }

  /** Make the form, and leave the focus where it is. */
  draw() {
    const active = document.activeElement;
    const key = by("fields").contains(active) ? active.dataset.key : undefined;
    const selection = key && active.type === "text" ? [active.selectionStart, active.selectionEnd, active.value] : null;
    const changed = (isOther, problem) => this.changed(isOther, problem);
    const form = new Form(this.explainer.plans, this.values, changed);
    const given = this.given.map((part) => partField(part, this.parts, changed));
    const fields = form.fields(this.message).flat();
    if (!fields.length && !given.length) fields.push(h("p", { className: "hint" }, "no fields"));
    show(by("fields"), fields, given);
    const again = key && [...by("fields").querySelectorAll("[data-key]")].find((item) => item.dataset.key === key);
    if (again) {
      if (selection) [again.value] = [selection[2]];
      again.focus();
      if (selection) again.setSelectionRange(selection[0], selection[1]);
    }
    this.make();
  }

  changed(isOther, problem = "") {
    if (problem) this.fail("", problem);
    else if (isOther) this.draw();
    else this.make();
  }

  /** The bytes of the values, or what is wrong beside the field. */
  make() {
    const { codec } = this.explainer;
    for (const item of by("fields").querySelectorAll(".wrong")) item.textContent = "";
    for (const item of by("fields").querySelectorAll('[aria-invalid="true"]')) item.removeAttribute("aria-invalid");
    by("fault").textContent = "";
    try {
      const bytes = codec.encode(this.values, {
        sender: this.side.endpoint,
        form: this.formOf(this.side),
        parts: this.parts,
      });
      this.bytes = bytes;
      this.result(bytes);
      this.onChange(this.values.message, this.side.name, hexOf(bytes));
    } catch (error) {
      if (!(error instanceof codec.EncodeError || error instanceof RangeError || error instanceof TypeError)) throw error;
      this.fail(error.path ?? "", error.problem ?? error.message);
    }
  }

  fail(path, problem) {
    this.bytes = null;
    show(by("made"), h("p", { className: "hint" }, "No bytes."));
    const fields = [...by("fields").querySelectorAll("[data-path]")];
    let own = fields.find((item) => item.dataset.path === path);
    if (!own && path) own = fields.find((item) => path.startsWith(item.dataset.path) && item.querySelector(".wrong"));
    const place = own?.querySelector(".wrong");
    if (place) {
      show(place, h("span", { className: "fault" }, problem));
      own.querySelector("input, select, textarea")?.setAttribute("aria-invalid", "true");
    }
    by("fault").textContent = path ? `${path}: ${problem}` : problem;
  }

  result(bytes) {
    const texts = {
      hex: hexOf(bytes),
      C: `static const uint8_t frame[] = {${Array.from(bytes, (byte) => `0x${hexDigits(byte)}`).join(", ")}};`,
      Python: `bytes.fromhex("${hexOf(bytes)}")`,
      command: this.command(),
    };
    const copies = Object.entries(texts).flatMap(([name, text]) => [
      copyButton(name, () => text),
      h("code", {}, text),
    ]);
    const [event] = this.explainer.events(bytes, this.side.endpoint, this.toldOf(this.values.message, bytes.length));
    show(by("made"), h("div", { className: "copies" }, copies), event ? this.shown(event, null) : "");
  }

  /** The command that makes the same frame. */
  command() {
    const { plans } = this.explainer;
    const fields = this.message.steps
      .filter((step) => step.kind !== "constant" && !step.computed)
      .map((step) => [step.name, this.values[keyOf(step)]])
      .filter(([, value]) => value !== null && value !== undefined)
      .map(([name, value]) => shell(`${name}=${commandValue(value)}`));
    const parts = this.given
      .filter((part) => this.parts[part.name] !== undefined)
      .map((part) => shell(`@${part.name}=${commandValue(this.parts[part.name])}`));
    const sides = this.sidesOf(this.values.message);
    const { endpoint, form } = this.side;
    const several = sides.some((item) => item.endpoint !== endpoint) ? ["--sender", endpoint] : [];
    if (sides.filter((item) => item.endpoint === endpoint).length > 1) several.push("--form", form);
    return ["protogen encode", plans.schema, this.values.message, ...fields, ...parts, ...several].join(" ");
  }
}

function commandValue(value) {
  if (value instanceof Uint8Array) return `hex:${hexOf(value).replace(/ /g, "")}`;
  return typeof value === "boolean" ? String(value) : jsonOf(value);
}

const shell = (text) => (/^[\w@=.:,+-]+$/.test(text) ? text : `'${text.replace(/'/g, "'\\''")}'`);
