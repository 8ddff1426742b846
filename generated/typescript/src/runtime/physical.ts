/** Physical values: raw x factor + term, all divided by a divisor, exact as far as floats are. */

/** What raw values become: each number one of `N`, also in arrays; what is not there stays null. */
export type Physical<T, N> = T extends readonly unknown[] ? N[] : T extends null ? null : N;

/** The physical value of a raw one, or of each in an array; null for a special value. */
export function physical<T>(
  raw: T,
  factor: bigint,
  term: bigint,
  divisor: bigint,
): Physical<T, number>;
export function physical<T>(
  raw: T,
  factor: bigint,
  term: bigint,
  divisor: bigint,
  special: readonly (number | bigint)[],
): Physical<T, number | null>;
export function physical(
  raw: unknown,
  factor: bigint,
  term: bigint,
  divisor: bigint,
  some: readonly (number | bigint)[] = [],
): unknown {
  if (Array.isArray(raw)) return raw.map((item) => physical(item, factor, term, divisor, some));
  if (raw === null || some.includes(raw as number)) return null;
  return scaled(raw as number | bigint, factor, term, divisor);
}

function scaled(raw: number | bigint, factor: bigint, term: bigint, divisor: bigint): number {
  if (typeof raw === "number") {
    const over = raw * Number(factor) + Number(term);
    if (Number.isSafeInteger(over) && divisor <= BigInt(Number.MAX_SAFE_INTEGER)) {
      return over / Number(divisor);
    }
    if (!Number.isInteger(raw)) return (raw * Number(factor) + Number(term)) / Number(divisor);
  }
  return ratio(BigInt(raw) * factor + term, divisor);
}

/** The float nearest to a fraction, ties to even. */
function ratio(over: bigint, under: bigint): number {
  if (over < 0n) return -ratio(-over, under);
  if (over === 0n) return 0;
  // So many bits that those behind the last one only tell on which side of a tie it lies.
  const shift = 66 - (over.toString(2).length - under.toString(2).length);
  const moved = shift > 0 ? over << BigInt(shift) : over;
  const divisor = shift > 0 ? under : under << BigInt(-shift);
  const quotient = moved / divisor;
  const sticky = moved % divisor ? 1n : 0n;
  return Number((quotient << 1n) | sticky) * 2 ** -(shift + 1);
}

/** The fraction that a float is. */
function exact(value: number): readonly [bigint, bigint] {
  let divisor = 1n;
  let over = value;
  while (!Number.isInteger(over)) {
    over *= 2;
    divisor *= 2n;
  }
  return [BigInt(over), divisor];
}

/** The whole number nearest to a fraction, ties to even. */
function rounded(over: bigint, under: bigint): bigint {
  const [top, bottom] = under < 0n ? [-over, -under] : [over, under];
  let quotient = top / bottom;
  let left = top % bottom;
  if (left < 0n) {
    quotient -= 1n;
    left += bottom;
  }
  const twice = 2n * left;
  return twice > bottom || (twice === bottom && quotient & 1n) ? quotient + 1n : quotient;
}

/**
 * The raw integer nearest to a physical value, ties to even.
 *
 * Throws a RangeError where the wire can't hold it, or it is a special value: that would be read back
 * as no reading at all.
 */
export function nearest(
  value: number,
  factor: bigint,
  term: bigint,
  divisor: bigint,
  low: bigint,
  high: bigint,
  special: readonly (number | bigint)[],
): bigint {
  if (!Number.isFinite(value)) throw new RangeError(`${value} is no physical value`);
  const [over, under] = exact(value);
  const raw = rounded(over * divisor - term * under, factor * under);
  if (raw < low || raw > high) throw new RangeError(`${value} does not fit the wire`);
  if (special.some((item) => BigInt(item) === raw)) {
    throw new RangeError(`${value} would be sent as ${raw}, which means no reading`);
  }
  return raw;
}
