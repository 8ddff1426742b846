/** The plans of the page, with what they refer to put in place. */
import { fromHex } from "./octets.js";

/** Put types in the places of their numbers, and bytes in those of their digits. */
export function resolved(plans) {
  const { types } = plans;
  const number = (holder) => {
    if (typeof holder.type === "number") holder.type = types[holder.type];
    return holder;
  };
  const part = (item) => {
    number(item);
    if (item.bytes !== undefined) item.bytes = [...fromHex(item.bytes)];
    if (item.whole) part(item.whole);
    for (const inner of item.bits ?? []) part(inner);
    return item;
  };
  const step = (item) => {
    number(item);
    if (item.const?.hex !== undefined) item.const = fromHex(item.const.hex);
    if (item.default?.hex !== undefined) item.default = fromHex(item.default.hex);
    for (const inner of item.packing?.numbers ?? []) number(inner);
    for (const inner of item.steps ?? []) step(inner);
    for (const inner of item.cases ?? []) step(inner.step);
    if (item.element) step(item.element);
    if (item.step) step(item.step);
  };
  for (const sender of plans.senders) {
    for (const item of sender.parts ?? []) part(item);
    for (const item of sender.given ?? []) number(item);
    sender.start = [...fromHex(sender.start ?? "")];
    if (sender.last !== undefined) sender.last = [...fromHex(sender.last)];
    for (const name of ["virtual", "messages", "given", "identity", "sums"]) sender[name] ??= [];
    for (const name of ["hidden", "further"]) sender[name] ??= {};
  }
  for (const item of plans.examples ?? []) {
    // An example of one form of frame names that; decoders are those of endpoints.
    item.sender = plans.senders.find((it) => it.name === item.sender)?.endpoint ?? item.sender;
  }
  for (const message of Object.values(plans.messages)) {
    message.steps ??= [];
    for (const item of message.steps) step(item);
  }
  return plans;
}

/** True if a size is one of `[least, greatest, step]`. */
export function holdsSize([least, greatest, step], size) {
  if (size < least || size > greatest) return false;
  return step === 0 ? size === least : (size - least) % step === 0;
}

/** True if a message has this identity. */
export const isToldBy = (message, identity) =>
  (message.identities ?? []).every((runs, index) =>
    runs.some(([first, last]) => BigInt(first) <= identity[index] && identity[index] <= BigInt(last)),
  );
