/** Parts of frames whose values callers give, or an encoder counts. */

import { mayBe } from "./content.js";
import { EncodeError } from "./errors.js";
import { inside, put } from "./layout.js";
import type { PartNumber, Value } from "./numbers.js";
import { ownOf, type ValueNumber } from "./plan.js";

/** Values of parts by their names, as callers give them. */
export type GivenParts = Readonly<Record<string, unknown>>;

/** What most callers give. */
export const NONE_GIVEN: GivenParts = {};

/** The next values of counters, by their names. */
export type Counts = Map<string, Value>;

/** The number of what a caller gives. Throws an EncodeError. */
export function givenTo(number: PartNumber | null, value: unknown, name: string): Value {
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

/** A part whose value callers may give, or have to. */
export class GivenPart {
  readonly name: string;
  readonly slot: number;
  /** True if every object has something by its name. */
  private readonly isInherited: boolean;
  /** Bounds of the numbers that need no other check; there are none where it is no number. */
  private readonly least: number = Infinity;
  private readonly greatest: number = -Infinity;

  constructor(private readonly part: ValueNumber) {
    const { least, greatest, values, between } = part;
    this.name = part.name;
    this.slot = part.slot;
    this.isInherited = this.name in Object.prototype;
    if (typeof least !== "number" || typeof greatest !== "number") return;
    if (values === undefined && between === undefined) {
      this.least = least;
      this.greatest = greatest;
    }
  }

  /** What a caller gives for it. */
  own(given: GivenParts): unknown {
    return this.isInherited ? ownOf(given, this.name) : given[this.name];
  }

  /** True of a number that needs no other check. */
  private isPlain(own: unknown): own is number {
    const isIn = typeof own === "number" && own >= this.least && own <= this.greatest;
    return isIn && Number.isInteger(own);
  }

  /** The value of what a caller gives. Throws an EncodeError. */
  given(own: unknown, strict: boolean): Value {
    if (this.isPlain(own)) return own;
    const { part } = this;
    const value = givenTo(part.number, own, part.name);
    if (!strict && !part.isHeld) {
      // A layout takes bytes as they are, so what does not fit them is refused here.
      put(part.number, value, new Uint8Array(part.number.size), 0, part.name);
      return value;
    }
    if (strict && typeof own === "string" && /[^\0-\x7f]/.test(own)) {
      throw new EncodeError(part.name, `"${own}" has a character that is not ASCII`);
    }
    if (!mayBe(part, value)) throw new EncodeError(part.name, `it can't be ${value}`);
    return value;
  }

  /** The value where a caller gives none; null where there has to be one. */
  usual(counts: Counts | null): Value | null {
    const { name, isCounter, default: usual } = this.part;
    return (isCounter ? counts?.get(name) : null) ?? usual;
  }

  /** The error where there is no value. */
  error(): EncodeError {
    const advice = this.part.isCounter ? ", or use an Encoder, which counts" : "";
    return new EncodeError(this.name, `the value is missing; give it as a part${advice}`);
  }

  /** Go on counting, where the callers gave no value. */
  count(given: GivenParts, counts: Counts): void {
    const { name, isCounter, least, greatest } = this.part;
    if (!isCounter || (this.own(given) ?? null) !== null) return;
    const value = counts.get(name)!;
    counts.set(name, value >= greatest ? least : Number(value) + 1);
  }
}
