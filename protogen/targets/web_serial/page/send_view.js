/** The form that sends messages: the bench's, with a button. */
import { by, h, options, show } from "./dom.js";
import { EncodeView } from "./encode_view.js";
import { Explainer } from "./explain.js";
import { hexOf } from "./octets.js";
import { asBigInt, asNumber } from "./values.js";

const MOST_SENT = 20;

export class SendView extends EncodeView {
  /** `write(bytes)` writes to the port; it rejects with what is wrong. */
  constructor(plans, codec, write) {
    super(new Explainer(plans, codec), null, () => undefined);
    this.write = write;
    this.next = new Map();
    by("fields").addEventListener("submit", () => this.send());
  }

  /** Offer the messages that others than an endpoint send; all where nobody else sends any. */
  offer(listened) {
    const names = Object.keys(this.explainer.plans.messages);
    const others = names.filter((name) => this.others(name, listened).length);
    const found = others.length ? others : names;
    const name = found.includes(by("message").value) ? by("message").value : found[0];
    show(by("message"), options(found.map((item) => [item, item]), name));
    if (name !== undefined) this.pick(name, this.others(name, listened)[0]);
  }

  others(name, listened) {
    const all = this.explainer.plans.senders.filter((item) => item.messages.includes(name));
    const endpoints = new Set(all.map((item) => item.endpoint));
    return [...endpoints].filter((endpoint) => endpoint !== listened);
  }

  result(bytes) {
    show(by("made"), h("code", {}, hexOf(bytes)));
  }

  async send() {
    const { bytes } = this;
    if (!bytes) return;
    const name = this.values.message;
    try {
      await this.write(bytes);
    } catch (error) {
      by("sent-note").textContent = `Not sent: ${error.message}`;
      return;
    }
    by("sent-note").textContent = `Sent ${name}: ${bytes.length} byte${bytes.length === 1 ? "" : "s"}.`;
    const time = new Date().toLocaleTimeString();
    by("sent").prepend(h("li", {}, `${time} ${name} `, h("code", {}, hexOf(bytes))));
    while (by("sent").children.length > MOST_SENT) by("sent").lastChild.remove();
    this.count();
  }

  /** Take values into the form; counters go on where the last frame of the sender left them. */
  take(name, side, { values, parts }) {
    const counted = side.given.filter(isCounter).map((part) => {
      const first = part.default ?? asNumber(part.type, BigInt(part.least ?? 0));
      return [part.name, this.next?.get(`${side.endpoint} ${part.name}`) ?? first];
    });
    super.take(name, side, { values, parts: { ...parts, ...Object.fromEntries(counted) } });
  }

  /** Advance the frame's counters. */
  count() {
    const counters = this.given.filter(isCounter);
    for (const part of counters) {
      const value = asBigInt(this.parts[part.name]);
      const next = value >= BigInt(part.greatest) ? BigInt(part.least ?? 0) : value + 1n;
      this.parts[part.name] = asNumber(part.type, next);
      this.next.set(`${this.side.endpoint} ${part.name}`, this.parts[part.name]);
    }
    if (counters.length) this.draw();
  }
}

const isCounter = (part) => part.kind === "counter";
