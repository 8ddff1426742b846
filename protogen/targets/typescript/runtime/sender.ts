/** A sender: its frame, with what is looked up of it. */

import { NO_BYTES } from "./bytes.js";
import { EncodeError, Fault } from "./errors.js";
import type { JoinedParts, PartValues } from "./events.js";
import type { PartNumber, Value } from "./numbers.js";
import { areAmong, holds, NO_PARTS } from "./plan.js";
import type { Frame, Group, HeldParts, LengthNumber, MessagePlan } from "./plan.js";
import type { NamedMessage, NumberPart, Part, Runs, ValueNumber } from "./plan.js";
import { Reader } from "./reader.js";
import { Writer } from "./writer.js";

function only(runs: Runs): readonly Value[] | null {
  const isOne = runs.every((each) => each.length === 1 && each[0]![0] === each[0]![1]);
  return isOne ? runs.map((each) => each[0]![0]) : null;
}

/** Groups by the values of an identity, one after another. */
type Listed = Map<Value, Listed | Group>;

function isFirstLength(part: NumberPart): part is LengthNumber {
  return part.kind === "length" && !part.isFurther;
}

/** The numbers of parts, those that are bits of others among them. */
export function numbersOf(parts: readonly Part[]): readonly NumberPart[] {
  return parts.flatMap((part) => {
    if (part.kind === "number") return [part.part];
    return part.kind === "bits" ? part.members : [];
  });
}

function offsetsOf(parts: readonly Part[], isEmpty: boolean): readonly number[] {
  let offset = 0;
  const sizes = parts.map((part) => (isEmpty && part.isOptional ? 0 : part.size));
  return [0, ...sizes.map((size) => (offset += size))];
}

/** A part of the identity; without a number where it is not sent. */
export interface IdentityPart {
  readonly name: string;
  readonly slot: number;
  readonly number: PartNumber | null;
}

export class Sender {
  /** Those of which each identity has one value. */
  private listed: Listed | Group | undefined;
  private readonly wide: Group[] = [];
  private readonly messages = new Map<string, MessagePlan>();
  /** Parts of the identity, also those that are told. */
  readonly identityParts: readonly IdentityPart[];
  /** Values that callers give. */
  readonly valueParts: readonly ValueNumber[];
  /** How many values each part has that events show. */
  private readonly shownCounts: readonly number[];
  /** Where each part begins without the bytes of the payload, and where the last one ends. */
  readonly offsets: readonly number[];
  /** The same where the payload is empty. */
  readonly offsetsEmpty: readonly number[];
  private readonly slots = new Map<string, number>();
  /** Bytes that complete a start. None where the same literal ends frames. */
  readonly completesStart = new Uint8Array(256);
  /** A start and an end with nothing between them, which is never a frame. */
  readonly emptyFrame: Uint8Array;
  readonly startSize: number;
  readonly hasWireSum: boolean;
  readonly isFitted: boolean;
  /** The length that tells where a frame ends. */
  readonly length: LengthNumber | null;
  /** The same where it is not sent, and a receiver is told it. */
  readonly toldLength: LengthNumber | null;

  constructor(readonly frame: Frame) {
    for (const group of frame.groups) {
      const values = only(group.identities);
      if (values) this.list(values, group);
      else this.wide.push(group);
    }
    const numbers = numbersOf(frame.parts);
    for (const part of [...frame.told, ...numbers]) this.slots.set(part.name, part.slot);
    const sent = frame.groups.flatMap((group) => group.messages);
    for (const message of [...sent, ...frame.encodeOnly]) {
      if (!this.messages.has(message.name)) this.messages.set(message.name, message);
    }
    const parts = [...frame.told.map((part) => ({ ...part, number: null })), ...numbers];
    this.identityParts = frame.identity.map((slot) => parts.find((part) => part.slot === slot)!);
    this.shownCounts = frame.shown.map(({ name }) => {
      const part = numbers.find((item) => item.name === name);
      return 256 ** (part?.number.size ?? 0);
    });
    this.offsets = offsetsOf(frame.parts, false);
    this.offsetsEmpty = offsetsOf(frame.parts, true);
    this.valueParts = numbers.filter((part): part is ValueNumber => part.kind === "value");
    this.startSize = frame.startWords[0]?.length ?? 0;
    const own = frame.sharesDelimiter ? [] : frame.startWords;
    for (const word of own) this.completesStart[word[word.length - 1]!] = 1;
    this.toldLength = frame.told.find((part) => part.length)?.length ?? null;
    this.length = this.toldLength ?? numbersOf(frame.parts).find(isFirstLength) ?? null;
    this.isFitted = frame.kept !== null || frame.isCut;
    this.hasWireSum = frame.sums.some((sum) => sum.overWire);
    this.emptyFrame = NO_BYTES;
    if (frame.start === "after_end") this.emptyFrame = frame.end;
    else if (frame.sharesDelimiter) {
      this.emptyFrame = Uint8Array.of(...frame.startBytes, ...frame.end);
    }
  }

  private list(values: readonly Value[], group: Group): void {
    const last = values.length - 1;
    if (last < 0) this.listed = group;
    let listed = (this.listed ??= new Map()) as Listed;
    values.forEach((value, index) => {
      if (index === last) listed.set(value, group);
      else {
        if (!listed.has(value)) listed.set(value, new Map());
        listed = listed.get(value) as Listed;
      }
    });
  }

  get key(): string {
    const { sender, form } = this.frame;
    return form ? `${sender}_${form}` : sender;
  }

  /** The identity among the values of a frame. */
  identity(values: readonly (Value | undefined)[]): Value[] {
    return this.frame.identity.map((slot) => values[slot]!);
  }

  /** The messages of an identity; undefined where it is unknown. */
  group(values: readonly (Value | undefined)[]): Group | undefined {
    const { identity: slots } = this.frame;
    let found = this.listed;
    for (let index = 0; found && index < slots.length; index++) {
      found = (found as Listed).get(values[slots[index]!]!);
    }
    if (found || !this.wide.length) return found as Group | undefined;
    const identity = this.identity(values);
    return this.wide.find((group) => areAmong(group.identities, identity));
  }

  /** The value of a part that is not sent; null where the identity gives it none. */
  virtual(index: number, values: readonly (Value | undefined)[]): Uint8Array | null {
    const part = this.frame.virtual[index]!;
    const identity = this.identity(values);
    const found = part.values.find((item) => areAmong(item.identities, identity));
    const value = found ? found.value : part.default;
    if (value === null) return null;
    const bytes = new Uint8Array(part.number.size);
    part.number.encode(value, bytes, 0);
    return bytes;
  }

  tailSize(payload: number): number {
    return payload ? this.frame.tailSize : this.frame.tailSizeEmpty;
  }

  /** The payload's size where the content has that size; -1 if there is none. */
  payloadSize(content: number): number {
    const extra = content - this.frame.headSize;
    if (extra === this.frame.tailSizeEmpty) return 0;
    const size = extra - this.frame.tailSize;
    return size > 0 ? size : -1;
  }

  /** What a receiver has to be told of the size of a frame, by its slot. */
  tellSize(values: (Value | undefined)[], payload: number): void {
    const { toldLength } = this;
    if (!toldLength || payload < 0) return;
    const { base, optional, slot } = toldLength;
    values[slot] = base + (payload ? payload + optional : 0);
  }

  /** The parts of a frame that are fields of the message, among the values of the frame. */
  held(message: MessagePlan, values: readonly (Value | undefined)[]): HeldParts {
    if (!message.held.length) return NO_PARTS;
    return Object.fromEntries(
      message.held.map((name) => [name, values[this.slots.get(name)!]!] as const),
    );
  }

  /** Bytes that are known of a payload; null where its fields take all of it. */
  private knownOf(message: MessagePlan, payload: Uint8Array, held: HeldParts): number | null {
    return message.tellsItsEnd ? prefixSize(message, payload, held) : message.known;
  }

  /** What a frame has of a payload, cut or filled up to its size; null: that varies. */
  fitted(payload: Uint8Array, size: number | null): Uint8Array {
    if (size === null) return payload;
    const cut = this.frame.isCut ? payload.subarray(0, size) : payload;
    if (this.frame.kept === null || cut.length >= size) return cut;
    const filled = new Uint8Array(size);
    filled.set(cut);
    return filled;
  }

  private leaves(message: MessagePlan, size: number): boolean {
    return this.frame.isCut && message.tellsItsEnd && size > message.sizes.least;
  }

  /** The message of a frame's payload and values. Throws a Fault. */
  read(
    group: Group,
    payload: Uint8Array,
    values: readonly (Value | undefined)[],
  ): NamedMessage {
    const [first] = group.messages as readonly [MessagePlan];
    let known = payload;
    if (this.leaves(first, payload.length)) {
      known = this.fitted(payload, this.knownOf(first, payload, this.held(first, values)));
    } else if (this.isFitted) {
      const sizes = new Set(group.messages.map((message) => message.known));
      known = this.fitted(payload, sizes.size === 1 ? first.known : null);
    }
    const fitting = group.messages.find((message) => holds(message.sizes, known.length)) ?? first;
    return readPayload(fitting, known, this.held(fitting, values));
  }

  /** The parts that events show, out of one number. */
  separated(joined: JoinedParts): PartValues {
    const { shownCounts } = this;
    const values = shownCounts.map(() => 0);
    let rest = joined;
    for (let index = shownCounts.length - 1; index >= 0; index--) {
      const count = shownCounts[index]!;
      values[index] = rest % count;
      rest = Math.floor(rest / count);
    }
    return this.frame.partsOf(values);
  }

  /** The message called `name`, if the endpoint sends one. */
  named(name: string): MessagePlan | undefined {
    return this.messages.get(name);
  }
}

/** The message of a payload's bytes; `held` has the parts that are fields. Throws a Fault. */
export function readPayload<M>(
  message: MessagePlan<M>,
  payload: Uint8Array,
  held: HeldParts = NO_PARTS,
): M {
  const size = payload.length;
  if (!holds(message.sizes, size)) {
    const problem = `${message.name} does not have ${size} bytes of payload`;
    throw new Fault("size", problem, "", Math.min(size, message.sizes.greatest));
  }
  const reader = new Reader(payload, held);
  const found = message.read(reader);
  reader.finish();
  return found;
}

/** The payload of a message. Throws an EncodeError. */
export function writePayload(message: MessagePlan, value: unknown, strict: boolean): Uint8Array {
  const writer = writerOf(strict, 0);
  message.write(writer, value as never);
  checkSize(message, writer.size);
  return writer.taken();
}

const WRITER = /* @__PURE__ */ new Writer();

/**
 * What writes a payload behind so many bytes. It is that of all frames, one after another.
 *
 * With a size, it writes into an array of so many bytes, which are all that it has to write.
 */
export function writerOf(strict: boolean, from: number, size = 0): Writer {
  return WRITER.restart(strict, from, size);
}

/** Throw an EncodeError unless a message can have a payload of so many bytes. */
export function checkSize(message: MessagePlan, size: number): void {
  if (!holds(message.sizes, size)) {
    const problem = `makes ${size} bytes of payload, which ${message.name} can't have`;
    throw new EncodeError("", problem);
  }
}

/** Bytes at the start of `data` that the message takes. Throws a Fault. */
export function prefixSize(message: MessagePlan, data: Uint8Array, held: HeldParts): number {
  const reader = new Reader(data, held);
  message.read(reader);
  return reader.at;
}
