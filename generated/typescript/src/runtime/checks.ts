/** What values of a payload have to be, and errors that say where they are not. */

import { EncodeError, joined } from "./errors.js";
import { same, shown, type Step } from "./reader.js";

const GREATEST_FLOAT32 = (2 - 2 ** -23) * 2 ** 127;

/** Checks values, and knows the path of the record or list that they are in. */
export class Checks {
  /** With it, values that the schema forbids are refused, even where they fit the wire. */
  strict = true;
  protected readonly path: Step[] = [];

  /** The error of a field. */
  error(step: Step, problem: string): EncodeError {
    return new EncodeError(joined([...this.path, step]), problem);
  }

  enter(step: Step): void {
    this.path.push(step);
  }

  leave(): void {
    this.path.pop();
  }

  /** An integer that the wire can hold. */
  int(value: unknown, low: number, high: number, step: Step): number {
    if (typeof value === "number" && value >= low && value <= high && Number.isInteger(value)) {
      return value;
    }
    throw this.noInteger(value, low, high, step);
  }

  protected noInteger(value: unknown, low: number, high: number, step: Step): EncodeError {
    if (typeof value === "number" && Number.isInteger(value)) {
      return this.error(step, `${value} is not in ${low}..${high}`);
    }
    return this.error(step, `must be an integer, not ${shown(value)}`);
  }

  /** An integer of more than 53 bits that the wire can hold. */
  big(value: unknown, low: bigint, high: bigint, step: Step): bigint {
    if (typeof value !== "bigint") {
      throw this.error(step, `must be a bigint, not ${shown(value)}`);
    }
    if (value < low || value > high) throw this.error(step, `${value} is not in ${low}..${high}`);
    return value;
  }

  /** A value in the range of the schema, or a special one. */
  ranged<T extends number | bigint>(
    value: T,
    least: NoInfer<T> | null,
    greatest: NoInfer<T> | null,
    special: readonly NoInfer<T>[],
    step: Step,
  ): T {
    // Not-a-number is in no range that has a bound.
    const isIn = (least === null || value >= least) && (greatest === null || value <= greatest);
    if (isIn || !this.strict || special.includes(value)) return value;
    throw this.error(step, `${value} is not in ${least ?? ""}..${greatest ?? ""}`);
  }

  /** A value out of a closed enum. */
  one<T extends number | bigint>(value: number | bigint, values: readonly T[], step: Step): T {
    if (!values.includes(value as T)) {
      throw this.error(step, `${value} has no name; there are ${values.join(", ")}`);
    }
    return value as T;
  }

  /** A truth value; 0 and 1 are taken as well. */
  truth(value: unknown, step: Step): number {
    if (value === true || value === 1) return 1;
    if (value === false || value === 0) return 0;
    throw this.error(step, `must be false or true, not ${shown(value)}`);
  }

  /** A float that its bits can hold. */
  real(value: unknown, bits: 32 | 64, step: Step): number {
    if (typeof value !== "number") throw this.error(step, `must be a number, not ${shown(value)}`);
    if (bits === 32 && Number.isFinite(value) && Math.abs(value) > GREATEST_FLOAT32) {
      throw this.error(step, `${value} is too large for 32 bits`);
    }
    return value;
  }

  /** A constant, which needs not be given. */
  constant<const T>(value: unknown, due: T, step: Step): T {
    if (value !== undefined && value !== null && !same(value, due)) {
      throw this.error(step, `must be ${shown(due)}, not ${shown(value)}`);
    }
    return due;
  }

  /** A struct. */
  // Any: its members are checked one by one.
  record(value: unknown, step: Step): any {
    if (typeof value !== "object" || value === null) {
      throw this.error(step, `must be an object, not ${shown(value)}`);
    }
    return value;
  }

  /** A list of `least` to `greatest` elements. */
  // Any: they are checked one by one.
  list(value: unknown, least: number, greatest: number, step: Step): readonly any[] {
    if (!Array.isArray(value) && !ArrayBuffer.isView(value)) {
      throw this.error(step, `must be a list, not ${shown(value)}`);
    }
    const items = value as unknown as readonly unknown[];
    this.count(items.length, least, greatest, "elements", step);
    return items;
  }

  /** A number of elements or bytes. */
  count(count: number, least: number, greatest: number, what: string, step: Step): void {
    if (count >= least && count <= greatest) return;
    const due = least === greatest ? `exactly ${least}` : `${least} to ${greatest}`;
    throw this.error(step, `needs ${due} ${what}, not ${count}`);
  }

  /** Nothing: the value of what is not there, or has no bytes. */
  nothing(value: unknown, step: Step): void {
    if (value !== null && value !== undefined) {
      throw this.error(step, `must be null, not ${shown(value)}`);
    }
  }

  /** Refuse a value behind one that is left out. */
  behind(front: unknown, name: string, step: Step): void {
    if (front === null || front === undefined) {
      throw this.error(step, `must be null, as ${name} in front of it is left out`);
    }
  }

  /** Refuse an element that says that it is the last where it is not, or the reverse. */
  last(isLast: boolean, items: readonly unknown[], index: number, by: string): void {
    if (isLast !== (index === items.length - 1)) {
      throw this.error(index, `the last element, and no other, is the last by ${by}`);
    }
  }

  /** The error of a selector without a case. */
  noCase(value: number | bigint, by: string, step: Step): EncodeError {
    return this.error(step, `there is no case for ${by} = ${value}`);
  }
}
