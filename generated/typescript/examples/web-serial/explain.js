/** Events of a decoder with the rows of their bytes. */
import { annotate } from "./annotate.js";
import { row } from "./cursor.js";
import { pythonFloat } from "./fractions.js";
import { quoted } from "./octets.js";

/** Takes bytes apart as `protogen explain` does. */
export class Explainer {
  constructor(plans, codec) {
    this.plans = plans;
    this.codec = codec;
  }

  /** The events of bytes that an endpoint sent; without a name, all of them may have. */
  events(bytes, endpoint, told = {}) {
    const decoder = new this.codec.Decoder(endpoint || undefined);
    decoder.tell(told);
    return [...decoder.feed(bytes), ...decoder.flush()];
  }

  /** The plan of an event's sender; of bytes that are no frame, one whose frames begin so. */
  senderOf(event) {
    const { senders } = this.plans;
    const forms = event.sender ? senders.filter((it) => it.endpoint === event.sender) : senders;
    if (event.kind !== "invalid") return forms.find((it) => it.form === event.form) ?? forms[0];
    return forms.find((it) => it.start.every((byte, at) => event.raw[at] === byte)) ?? forms[0];
  }

  /** The codec's frame of a sender: both have the forms of an endpoint in the same order. */
  frameOf(sender) {
    const forms = this.plans.senders.filter((it) => it.endpoint === sender.endpoint);
    return this.codec.protocol.senders(sender.endpoint)[forms.indexOf(sender)].frame;
  }

  rows(event) {
    const raw = [...event.raw];
    if (event.kind === "invalid" && event.reason === "noise") return [row({ wire: raw, meaning: "noise" })];
    const sender = this.senderOf(event);
    const told = event.kind === "invalid" ? {} : event.parts;
    const rows = annotate(this.plans, sender, this.frameOf(sender), raw, told);
    if (event.kind !== "invalid" || event.reason === "truncated" || !rows.length) return rows;
    return [...rows.slice(0, -1), notLookedAt(rows[rows.length - 1])];
  }
}

/** A decoder gives a frame up at the byte that decides; those behind it begin something else. */
function notLookedAt(last) {
  if (!last.cut || (last.wire.length && last.type === "literal")) return last;
  return { ...last, fault: "", meaning: last.wire.length ? "the rest was not looked at" : "not looked at" };
}

/** What was found of a checksum and what is due, which the rows have; else the decoder's words. */
function problemOf(event, rows) {
  const wrong = rows.find((item) => item.part?.kind === "sum" && item.fault);
  return event.reason === "checksum" && wrong ? wrong.fault : event.problem;
}

/** The title of an event that has these rows. */
export function titleOf(event, rows) {
  let size = `${event.size} byte${event.size === 1 ? "" : "s"}`;
  if (event.sender) size += ` from ${event.sender}${event.form ? `, ${event.form}` : ""}`;
  const problem = event.kind === "invalid" && problemOf(event, rows);
  const what = {
    message: () => `message ${event.message.message}`,
    unknown: () => "a valid frame, but no message has its identity",
    invalid: () => `no frame: ${event.reason}${problem ? `, ${problem}` : ""}`,
  };
  return `offset ${event.offset}, ${size}: ${what[event.kind]()}`;
}

/** The raw value of a row as text. */
export function valueText(value) {
  if (value === null) return "";
  if (typeof value === "string") return quoted(value);
  return typeof value === "number" ? pythonFloat(value) : String(value);
}
