/** Runs of as many packed numbers as their bytes hold. */

import type { Reader, Step } from "./reader.js";
import type { Writer } from "./writer.js";

/** The bits of each number of what is left of a payload. */
export function readRun(
  reader: Reader,
  width: number,
  little: boolean,
  least: number,
  greatest: number,
  step: Step,
): bigint[] {
  const size = reader.left;
  const count = Math.floor((8 * size) / width);
  if (Math.ceil((count * width) / 8) !== size) {
    throw reader.fault(step, "size", "a part of a number is left over");
  }
  reader.count(count, least, greatest, "fill", step);
  const run = reader.run(size, little, step);
  const bits = 8 * size;
  const unused = bits - count * width;
  const mask = (1n << BigInt(unused)) - 1n;
  const found = Array.from({ length: count }, (_, index) => {
    const shift = little ? index * width : bits - (index + 1) * width;
    return BigInt.asUintN(width, run >> BigInt(shift));
  });
  reader.unused(little ? run >> BigInt(count * width) : run, mask, step);
  return found;
}

/** Write numbers of `width` bits one behind another; the last byte is filled up with zeros. */
export function writeRun(
  writer: Writer,
  values: readonly bigint[],
  width: number,
  little: boolean,
): void {
  const size = Math.ceil((values.length * width) / 8);
  let run = 0n;
  values.forEach((value, index) => {
    const shift = little ? index * width : 8 * size - (index + 1) * width;
    run |= BigInt.asUintN(width, value) << BigInt(shift);
  });
  writer.ubig(run, size, 8 * size, little, 256);
}
