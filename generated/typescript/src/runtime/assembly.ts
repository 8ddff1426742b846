/** Frames from their parts. */

import { concatenated, equal } from "./bytes.js";
import { Cut, dueOf, verdictOn } from "./candidate.js";
import { mayBe } from "./content.js";
import { EncodeError } from "./errors.js";
import type { PartNumber, Value } from "./numbers.js";
import { areAmong, at } from "./plan.js";
import type { Bits, Covered, HeldParts, LengthNumber, MessagePlan } from "./plan.js";
import type { Part, ValueNumber } from "./plan.js";
import { numbersOf, payloadOf, type Sender } from "./sender.js";

/** Values of parts by their names, as callers give them. */
export type GivenParts = Readonly<Record<string, unknown>>;

type Values = (Value | undefined)[];

/** The frame of a message. Throws an EncodeError. */
export function frameOf(
  sender: Sender,
  message: MessagePlan,
  value: unknown,
  given: GivenParts,
  strict: boolean,
): Uint8Array {
  const made = payloadOf(message, value, strict);
  const payload = sender.trimmed(made.payload);
  const parts = withHeld(given, made.held);
  const values: Values = new Array<Value | undefined>(sender.frame.slots).fill(undefined);
  const names = identityOf(sender, message, parts, values);
  return encodeFrame(sender, payload, parts, names, values, strict);
}

/** The parts that callers give, and those that are fields. Throws an EncodeError if they differ. */
function withHeld(given: GivenParts, held: HeldParts): GivenParts {
  for (const [name, value] of Object.entries(held)) {
    const own = given[name] ?? null;
    // A number may be given for a bigint, and a bigint for a number.
    const isSame = (typeof own === "number" || typeof own === "bigint") && own == value;
    if (own !== null && !isSame) {
      throw new EncodeError(name, `is ${value}, as the message says, and not ${String(own)}`);
    }
  }
  return { ...given, ...held };
}

/** Set the identity of a message: what callers give, or the first one. */
function identityOf(
  sender: Sender,
  message: MessagePlan,
  given: GivenParts,
  values: Values,
): Set<string> {
  const names = new Set<string>();
  sender.frame.identity.forEach((slot, index) => {
    const { name, number } = identityPart(sender, slot);
    names.add(name);
    const runs = message.identities[index]!;
    const own = given[name];
    const chosen = own === undefined || own === null ? runs[0]![0] : givenTo(number, own, name);
    if (!areAmong([runs], [chosen])) {
      throw new EncodeError(name, `${chosen} is not an identity of ${message.name}`);
    }
    values[slot] = chosen;
  });
  return names;
}

/** The frame of an unknown message, whose identity is given. Throws an EncodeError. */
export function unknownFrameOf(
  sender: Sender,
  payload: Uint8Array,
  given: GivenParts,
): Uint8Array {
  const values: Values = new Array<Value | undefined>(sender.frame.slots).fill(undefined);
  const names = new Set<string>();
  for (const slot of sender.frame.identity) {
    const { name, number } = identityPart(sender, slot);
    names.add(name);
    values[slot] = givenTo(number, given[name], name);
  }
  return encodeFrame(sender, payload, given, names, values, false);
}

function identityPart(
  sender: Sender,
  slot: number,
): { readonly name: string; readonly number: PartNumber | null } {
  const told = sender.frame.told.find((part) => part.slot === slot);
  if (told) return { name: told.name, number: null };
  return numbersOf(sender.frame.parts).find((part) => part.slot === slot)!;
}

function givenTo(number: PartNumber | null, value: unknown, name: string): Value {
  if (!number) {
    if (typeof value === "number" && Number.isInteger(value)) return value;
    throw new EncodeError(name, `must be an integer, not ${String(value)}`);
  }
  try {
    return number.given(value);
  } catch (error) {
    throw inside(error, name);
  }
}

function inside(error: unknown, name: string): unknown {
  return error instanceof EncodeError ? new EncodeError(name, error.problem) : error;
}

/** The value parts of a sender. */
export function valueParts(sender: Sender): readonly ValueNumber[] {
  return numbersOf(sender.frame.parts).filter(
    (part): part is ValueNumber => part.kind === "value",
  );
}

function encodeFrame(
  sender: Sender,
  payload: Uint8Array,
  given: GivenParts,
  identity: ReadonlySet<string>,
  values: Values,
  strict: boolean,
): Uint8Array {
  const parts = valueParts(sender);
  for (const name of Object.keys(given)) {
    const isKnown = identity.has(name) || parts.some((part) => part.name === name);
    if (!isKnown && given[name] !== undefined && given[name] !== null) {
      throw new EncodeError(name, "there is no such part");
    }
  }
  for (const part of parts) values[part.slot] = valueOf(part, given[part.name], strict);
  const wire = new Assembly(sender, values, payload).wire();
  const { frame } = sender;
  if (frame.isBounded && wire.length > frame.greatest) {
    const problem = `makes a frame of ${wire.length} bytes, at most ${frame.greatest} are allowed`;
    throw new EncodeError("payload", problem);
  }
  if (frame.cutAmbiguous || !sender.group(values)) checkCut(sender, wire, payload, values);
  return wire;
}

function valueOf(part: ValueNumber, given: unknown, strict: boolean): Value {
  const isGiven = given !== undefined && given !== null;
  if (!isGiven && part.default === null) {
    const advice = part.isCounter ? ", or use an Encoder, which counts" : "";
    throw new EncodeError(part.name, `the value is missing; give it as a part${advice}`);
  }
  const value = isGiven ? givenTo(part.number, given, part.name) : part.default!;
  if (!strict && !part.isHeld) return value;
  if (strict && typeof given === "string" && /[^\0-\x7f]/.test(given)) {
    throw new EncodeError(part.name, `"${given}" has a character that is not ASCII`);
  }
  if (!mayBe(part, value)) throw new EncodeError(part.name, `it can't be ${value}`);
  return value;
}

/** Throw an EncodeError unless a decoder takes exactly these bytes for the frame. */
function checkCut(sender: Sender, wire: Uint8Array, payload: Uint8Array, values: Values): void {
  const told = [...values];
  sender.tellSize(told, payload.length);
  const [verdict] = verdictOn(sender, wire, told);
  if (verdict.size < wire.length) {
    const problem = `a decoder would end the frame behind ${verdict.size} of its bytes`;
    throw new EncodeError("payload", problem);
  }
  if (!(verdict instanceof Cut) || !equal(verdict.payload, payload)) {
    throw new EncodeError("payload", "a decoder would not find it in the frame");
  }
}

/** The bytes of one frame's parts. A checksum or a length is worked out when it is needed. */
class Assembly {
  private readonly content: Uint8Array;
  /** Where each part lies; equal bounds where it is absent. */
  private readonly places: (readonly [number, number])[] = [];
  private readonly made = new Set<number>();

  constructor(
    private readonly sender: Sender,
    private readonly values: Values,
    private readonly payload: Uint8Array,
  ) {
    let place = 0;
    for (const part of sender.frame.parts) {
      const isAbsent = part.isOptional === true && !payload.length;
      const size = part.kind === "payload" ? payload.length : isAbsent ? 0 : part.size;
      this.places.push([place, place + size]);
      place += size;
    }
    this.content = new Uint8Array(place);
  }

  wire(): Uint8Array {
    const { frame } = this.sender;
    const isHeld = this.sender.length !== null || frame.isBounded;
    if (isHeld && this.payload.length > frame.greatestPayload) {
      const problem = `has ${this.payload.length} bytes, at most ${frame.greatestPayload} fit`;
      throw new EncodeError("payload", problem);
    }
    if (frame.sevenBit && this.payload.some((byte) => byte > 0x7f)) {
      throw new EncodeError("payload", "a byte has its most significant bit set");
    }
    if (this.sender.toldLength) this.length(this.sender.toldLength);
    const whole = this.bytes(0, this.content.length);
    const region = this.region();
    if (!region) return concatenated([whole, frame.end]);
    const [from, to] = region;
    const stuffed = frame.transparency!.encode(whole.slice(from, to));
    return concatenated([whole.subarray(0, from), stuffed, whole.subarray(to), frame.end]);
  }

  /** Bounds of what is stuffed; null where nothing is. */
  private region(): readonly [number, number] | null {
    const { parts, firstStuffed, lastStuffed, transparency } = this.sender.frame;
    if (!transparency) return null;
    const stuffed = parts.slice(firstStuffed, lastStuffed + 1);
    const isThere = stuffed.some((part) => part.isOptional !== true || this.payload.length > 0);
    if (!isThere) return null;
    return [this.places[firstStuffed]![0], this.places[lastStuffed]![1]];
  }

  /** Content, all of whose parts are made. */
  private bytes(from: number, to: number): Uint8Array {
    this.places.forEach(([start, end], index) => {
      if (start < to && end > from && !this.made.has(index)) {
        this.made.add(index);
        this.make(this.sender.frame.parts[index]!, start);
      }
    });
    return this.content.subarray(from, to);
  }

  private make(part: Part, place: number): void {
    if (part.kind === "literal") this.content.set(part.bytes, place);
    else if (part.kind === "payload") this.content.set(this.payload, place);
    else if (part.kind === "bits") this.makeBits(part, place);
    else if (part.kind === "sum") {
      const { number, name } = this.sender.frame.sums[part.sum]!;
      this.put(number, this.sum(part.sum), place, name);
    } else {
      const { part: item } = part;
      const value = item.kind === "length" ? this.length(item) : this.values[item.slot]!;
      this.put(item.number, value, place, item.name);
    }
  }

  private put(number: PartNumber, value: Value, place: number, name: string): void {
    try {
      number.encode(value, this.content, place);
    } catch (error) {
      throw inside(error, name);
    }
  }

  private makeBits(part: Bits, place: number): void {
    let joined = part.fixed;
    const scratch = new Uint8Array(part.size);
    const add = (number: PartNumber, value: Value, name: string): void => {
      try {
        number.encode(value, scratch, 0);
      } catch (error) {
        throw inside(error, name);
      }
      joined |= BigInt(part.number.decode(scratch, 0));
    };
    for (const item of part.members) {
      add(item.number, this.numberAt(item.slot), item.name);
    }
    for (const index of part.sums) {
      const item = this.sender.frame.sums[index]!;
      add(item.number, this.sum(index), item.name);
    }
    for (const item of part.mirrors) {
      const flipped = BigInt(this.numberAt(item.of)) ^ item.flips;
      add(item.number, Number(flipped), item.name);
    }
    this.put(part.number, joined, place, part.name);
  }

  /** The number of a slot: one that is given, or a length. */
  private numberAt(slot: number): Value {
    const found = this.values[slot];
    if (found !== undefined) return found;
    const lengths = numbersOf(this.sender.frame.parts).filter((item) => item.kind === "length");
    return this.length(lengths.find((item) => item.slot === slot) as LengthNumber);
  }

  private length(part: LengthNumber): number {
    const size = this.payload.length;
    let value = part.base + (size ? size + part.optional : 0);
    const region = part.overWire ? this.region() : null;
    if (region) {
      const plain = this.bytes(...region).slice();
      value += this.sender.frame.transparency!.encode(plain).length - plain.length;
    }
    if (value < part.least || value > part.greatest) {
      const problem = `makes ${part.name} ${value}, not in ${part.least}..${part.greatest}`;
      throw new EncodeError("payload", problem);
    }
    return value;
  }

  private sum(index: number): Value {
    const sum = this.sender.frame.sums[index]!;
    const pieces = sum.covers.map((covered) => this.covered(covered, sum.name));
    const joined = concatenated(pieces);
    return dueOf(sum, sum.algorithm.compute(joined, 0, joined.length));
  }

  private covered(covered: Covered, name: string): Uint8Array {
    if ("bytes" in covered) return covered.bytes;
    if ("virtual" in covered) {
      const bytes = this.sender.virtual(covered.virtual, this.values);
      if (bytes) return bytes;
      const part = this.sender.frame.virtual[covered.virtual]!;
      const problem = `has no value for an unknown identity, and ${name} covers it`;
      throw new EncodeError(part.name, problem);
    }
    const { headSize } = this.sender.frame;
    const size = this.payload.length;
    const from = at(covered.from, headSize, size);
    const plain = this.bytes(from, at(covered.to, headSize, size)).slice();
    return covered.stuffed ? this.sender.frame.transparency!.encode(plain) : plain;
  }
}
