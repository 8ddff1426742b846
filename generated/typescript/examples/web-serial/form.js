/** A form for the fields of a message. It edits the values in place and says when they changed. */
import { h, options } from "./dom.js";
import { physical } from "./readings.js";
import {
  asBigInt, asNumber, boundsOf, chosen, firstCase, firstValue, isThere, keyOf, lookIn, rawIn, rawOfPhysical, rawText,
} from "./values.js";

const MOST_SINGLE = 24;
let next = 0;

export class Form {
  /** `onChange(isOther)`: a value changed; with `isOther` the form has to be made again. */
  constructor(plans, values, onChange) {
    this.enums = plans.enums;
    this.values = values;
    this.onChange = onChange;
  }

  /** The fields of the message. */
  fields(message) {
    return this.record(message.steps, this.values, "", () => undefined);
  }

  record(steps, values, prefix, around) {
    const look = lookIn(values, around);
    return steps.map((step) => {
      const key = keyOf(step);
      const place = { get: () => values[key], set: (value) => (values[key] = value) };
      return this.step(step, place, prefix + step.name, look);
    });
  }

  step(step, place, path, look) {
    if (step.computed) return line(path, h("span", { className: "hint" }, "worked out"));
    if (step.kind === "constant") return line(path, h("span", { className: "hint" }, "always the same"));
    if (step.kind === "record") {
      return group(path, this.record(step.steps ?? [], place.get(), `${path}.`, look));
    }
    if (step.kind === "repeat") return this.elements(step, place, path, look);
    if (step.kind === "optional") return this.optional(step, place, path, look);
    if (step.kind === "region") return this.step(step.step, place, path, look);
    if (step.kind === "choose") return this.choose(step, place, path, look);
    return this.scalar(step, place, path);
  }

  optional(step, place, path, look) {
    const isSaid = step.when !== undefined;
    if (isSaid) {
      const isDue = isThere(step, look);
      if (isDue && (place.get() ?? null) === null) place.set(firstValue(step.step, this.enums, look));
      if (!isDue) place.set(null);
      return isDue ? this.step(step.step, place, path, look) : null;
    }
    const is = (place.get() ?? null) !== null;
    const box = h("input", { type: "checkbox", checked: is, "data-key": `${path}?` });
    box.addEventListener("change", () => {
      place.set(box.checked ? firstValue(step.step, this.enums, look) : null);
      this.onChange(true);
    });
    const own = line(path, h("label", {}, box, " is there"));
    return is ? [own, this.step(step.step, place, path, look)] : own;
  }

  choose(step, place, path, look) {
    const found = chosen(step, look);
    const value = place.get();
    if (!fits(found, value)) place.set(firstCase(found, this.enums, look));
    if (!found) return this.scalar({ type: { kind: "octets", label: "bytes" }, count: {} }, place, path);
    if (place.get() === null) return line(path, h("span", { className: "hint" }, "empty"));
    return this.step(found, place, path, look);
  }

  elements(step, place, path, look) {
    const values = place.get();
    const isScalar = step.element.kind === "scalar" && step.element.type.kind !== "octets" && step.element.type.kind !== "text";
    if (isScalar && values.length > MOST_SINGLE) return this.list(step, place, path);
    const single = (index) => ({ get: () => values[index], set: (value) => (values[index] = value) });
    const own = values.map((_, index) => this.step(step.element, single(index), `${path}[${index}]`, look));
    if (step.count.known !== undefined) return group(path, own);
    const change = (edit) => () => {
      edit();
      this.onChange(true);
    };
    const add = () => values.push(firstValue(step.element, this.enums, look));
    const more = h("button", { type: "button", "data-key": `${path}+`, onclick: change(add) }, `Add to ${path}`);
    const remove = change(() => values.pop());
    const less = h("button", { type: "button", "data-key": `${path}-`, disabled: !values.length, onclick: remove }, "Remove the last");
    return group(path, [...own, h("p", { className: "row" }, more, less)]);
  }

  /** Many numbers in one text, as many as there are. */
  list(step, place, path) {
    const text = place.get().map((value) => rawText(step.element, value)).join(" ");
    const field = h("textarea", { rows: 4, value: text, spellcheck: false, "data-key": path });
    field.addEventListener("input", () => {
      const found = field.value.split(/[\s,]+/).filter(Boolean).map((item) => rawIn(step.element, item));
      const isWrong = found.includes(undefined);
      field.setAttribute("aria-invalid", String(isWrong));
      if (isWrong) return this.onChange(false, `${path}: not all of these are its numbers`);
      place.set(found);
      return this.onChange(false);
    });
    return labelled(path, field, `${place.get().length} raw values`, true);
  }

  // --- single values -----------------------------------------------------------------------------

  scalar(step, place, path) {
    const controls = [];
    const refresh = (but) => controls.forEach(({ field, show }) => field !== but && show());
    const take = (field, value) => {
      field.setAttribute("aria-invalid", String(value === undefined));
      if (value === undefined) return this.onChange(false, `${path}: can't be "${field.value}"`);
      place.set(value);
      refresh(field);
      // What others choose and count by may have changed with it.
      return this.onChange(step.type.kind === "integer");
    };
    const control = (field, show, value, event = "input") => {
      controls.push({ field, show });
      field.addEventListener(event, () => take(field, value()));
      show();
      return field;
    };
    const raw = h("input", { type: "text", size: 14, spellcheck: false, "data-key": path });
    control(raw, () => (raw.value = rawText(step, place.get())), () => rawIn(step, raw.value));
    const more = this.others(step, place, path, control);
    return labelled(path, raw, hintOf(step), false, more);
  }

  /** Ways to edit a number besides its raw value. */
  others(step, place, path, control) {
    const { type } = step;
    const raw = () => asBigInt(place.get() ?? 0);
    const named = { ...this.enums[type.enum]?.values, ...step.special };
    if (type.kind === "float" && step.scale) return [this.physical(step, place, path, control)];
    if (type.kind !== "integer") return [];
    if (type.role === "bool") {
      const box = h("input", { type: "checkbox", "data-key": `${path}=` });
      control(box, () => (box.checked = Boolean(place.get())), () => box.checked, "change");
      return [h("label", {}, box, " true")];
    }
    const found = [];
    if (Object.keys(named).length) {
      const pairs = Object.entries(named).map(([name, value]) => [String(value), name]);
      const menu = h("select", { "aria-label": `${path}, by name`, "data-key": `${path}=` }, options([["", "no name"], ...pairs]));
      const show = () => {
        const own = pairs.find(([value]) => BigInt(value) === raw());
        menu.value = own ? own[0] : "";
      };
      control(menu, show, () => (menu.value === "" ? place.get() : asNumber(type, BigInt(menu.value))), "change");
      found.push(menu);
    }
    for (const [name, bit] of Object.entries(type.flags ?? {})) found.push(bitBox(name, bit, type, raw, control, path));
    for (const run of type.runs ?? []) found.push(this.run(run, type, raw, control, path));
    if (step.scale) found.push(this.physical(step, place, path, control));
    return found;
  }

  physical(step, place, path, control) {
    const field = h("input", { type: "text", size: 12, "aria-label": `${path}, physical`, "data-key": `${path}~` });
    const show = () => (field.value = physical({ ...step, unit: "" }, asRaw(step, place.get())));
    control(field, show, () => rawOfPhysical(step, field.value));
    return h("span", {}, field, ` ${step.unit ?? ""}`);
  }

  run(run, type, raw, control, path) {
    const [mask, low] = [BigInt(run.mask), BigInt(run.low)];
    const value = () => (BigInt.asUintN(type.bits, raw()) & mask) >> low;
    const put = (number) => {
      const whole = (BigInt.asUintN(type.bits, raw()) & ~mask) | ((number << low) & mask);
      return asNumber(type, type.signed ? BigInt.asIntN(type.bits, whole) : whole);
    };
    const named = Object.entries(this.enums[run.enum]?.values ?? {});
    if (!named.length && mask >> low === 1n) return bitBox(run.name, run.low, type, raw, control, path);
    const key = `${path}/${run.name}`;
    if (named.length) {
      const menu = h("select", { "data-key": key }, options([["", "no name"], ...named.map(([name, own]) => [String(own), name])]));
      const show = () => (menu.value = named.some(([, own]) => BigInt(own) === value()) ? String(value()) : "");
      control(menu, show, () => put(menu.value === "" ? value() : BigInt(menu.value)), "change");
      return h("label", {}, `${run.name} `, menu);
    }
    const field = h("input", { type: "text", size: 5, "data-key": key });
    const show = () => (field.value = String(value()));
    control(field, show, () => {
      const found = /^\d+$/.test(field.value) ? BigInt(field.value) : null;
      return found === null || found > mask >> low ? undefined : put(found);
    });
    return h("label", {}, `${run.name} `, field);
  }
}

const asRaw = (step, value) => (step.type.kind === "float" ? value : asBigInt(value ?? 0));

/** True if a value is one of the case's form: a record for a record, a list for a list. */
function fits(step, value) {
  if (value === undefined) return false;
  if (!step) return value instanceof Uint8Array;
  switch (step.kind) {
    case "record":
      if (!step.steps?.length) return value === null;
      return value !== null && typeof value === "object" && hasMembers(step.steps, value);
    case "repeat":
      return Array.isArray(value) && value.every((item) => fits(step.element, item));
    case "optional":
      return value === null || fits(step.step, value);
    case "region":
    case "constant":
      return fits(step.step, value);
    case "choose":
      return true; // Its own case is looked at when it is shown.
    default:
      return isOf(step.type, value);
  }
}

/** True if an object has the members of a record, and no others. */
function hasMembers(steps, value) {
  const keys = steps.map(keyOf);
  if (!Object.keys(value).every((key) => keys.includes(key))) return false;
  return steps.every((step) => step.computed || fits(step, value[keyOf(step)]));
}

/** True if a value is as the codec has those of a type. */
function isOf(type, value) {
  if (type.kind === "octets") return value instanceof Uint8Array;
  if (type.kind === "text") return typeof value === "string";
  if (type.kind === "integer" && type.role === "bool") return typeof value === "boolean";
  return typeof value === (type.isBig ? "bigint" : "number");
}

function bitBox(name, bit, type, raw, control, path) {
  const mask = 1n << BigInt(bit);
  const box = h("input", { type: "checkbox", "data-key": `${path}/${name}` });
  const put = () => {
    const whole = BigInt.asUintN(type.bits, raw());
    const own = box.checked ? whole | mask : whole & ~mask;
    return asNumber(type, type.signed ? BigInt.asIntN(type.bits, own) : own);
  };
  control(box, () => (box.checked = Boolean(BigInt.asUintN(type.bits, raw()) & mask)), put, "change");
  return h("label", {}, box, ` ${name}`);
}

function hintOf(step) {
  const { type, count } = step;
  if (type.kind === "text") return count?.greatest === undefined ? "text" : `text, up to ${count.greatest} characters`;
  if (type.kind === "octets") return count?.greatest === undefined ? "hex" : `hex, up to ${count.greatest} bytes`;
  if (type.kind === "float") return type.label;
  return `${type.label}, ${boundsOf(step).join(" to ")}`;
}

const group = (path, children) => h("fieldset", { "data-path": path }, h("legend", {}, path), children.flat());

const line = (path, ...children) => h("div", { className: "field" }, h("span", { className: "of" }, path), children);

/** A field with its name, what it takes, other ways to edit it, and room for what is wrong. */
function labelled(path, field, hint, isWide, more = []) {
  const id = `f${next++}`;
  field.id = id;
  field.setAttribute("aria-describedby", `${id}h ${id}f`);
  return h(
    "div",
    { className: `field${isWide ? " wide" : ""}`, "data-path": path },
    h("label", { className: "of", htmlFor: id }, path),
    field,
    more,
    h("span", { className: "hint", id: `${id}h` }, hint),
    h("span", { className: "wrong", id: `${id}f` }),
  );
}

/** A field for a part of the frame whose value callers give. */
export function partField(part, values, onChange) {
  const { type } = part;
  if (part.choices) {
    const names = Object.entries(part.choices).map(([word, value]) => [String(value), word]);
    const menu = h("select", { "data-key": `@${part.name}` }, options(names, String(values[part.name] ?? "")));
    menu.addEventListener("change", () => {
      values[part.name] = type.isText ? menu.value : asNumber(type, BigInt(menu.value));
      onChange(false);
    });
    return labelled(part.name, menu, "one of several literals", false);
  }
  const shown = values[part.name] === undefined ? "" : String(values[part.name]);
  const field = h("input", { type: "text", size: 14, value: shown, "data-key": `@${part.name}` });
  field.addEventListener("input", () => {
    const value = type.isText ? field.value : rawIn({ type }, field.value);
    field.setAttribute("aria-invalid", String(value === undefined && field.value !== ""));
    if (field.value === "") delete values[part.name];
    else if (value !== undefined) values[part.name] = value;
    onChange(false);
  });
  const hint = type.isText ? "text" : `${part.least} to ${part.greatest}`;
  return labelled(part.name, field, `${part.kind} of the frame, ${hint}`, false);
}
