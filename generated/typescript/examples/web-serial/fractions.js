/** Exact fractions, and numbers as Python prints them. */

const MOST_DIGITS = 12;

function divisor(one, other) {
  let [a, b] = [one < 0n ? -one : one, other];
  while (b) [a, b] = [b, a % b];
  return a || 1n;
}

export function fraction(numerator, denominator = 1n) {
  const common = divisor(numerator, denominator);
  return { n: numerator / common, d: denominator / common };
}

/** The fraction in a text, `1/16`; without one, a whole number. */
export function fractionIn(text, missing) {
  if (text === undefined || text === null) return fraction(missing);
  const [numerator, denominator] = text.split("/");
  return { n: BigInt(numerator), d: BigInt(denominator) };
}

export const times = (a, b) => fraction(a.n * b.n, a.d * b.d);
export const plus = (a, b) => fraction(a.n * b.d + b.n * a.d, a.d * b.d);
export const minus = (a, b) => plus(a, { n: -b.n, d: b.d });
export const over = (a, b) =>
  b.n < 0n ? fraction(-a.n * b.d, a.d * -b.n) : fraction(a.n * b.d, a.d * b.n);

/** The exact fraction that a finite float is. */
export function fractionOf(float) {
  const view = new DataView(new ArrayBuffer(8));
  view.setFloat64(0, float);
  const bits = view.getBigUint64(0);
  const exponent = Number((bits >> 52n) & 0x7ffn);
  const own = (bits & 0xfffffffffffffn) | (exponent ? 1n << 52n : 0n);
  const power = (exponent || 1) - 1075;
  const sign = bits >> 63n ? -1n : 1n;
  return power < 0
    ? fraction(sign * own, 1n << BigInt(-power))
    : fraction((sign * own) << BigInt(power));
}

/** The fraction in a decimal numeral that a person wrote; null: it is none. */
export function decimalIn(text) {
  const found = /^([+-]?)(\d*)(?:\.(\d*))?(?:[eE]([+-]?\d{1,3}))?$/.exec(text.trim());
  if (!found || !(found[2] || found[3])) return null;
  const behind = found[3] ?? "";
  const power = Number(found[4] ?? 0) - behind.length;
  const digits = BigInt(`${found[2]}${behind}`) * (found[1] === "-" ? -1n : 1n);
  return power < 0 ? fraction(digits, 10n ** BigInt(-power)) : fraction(digits * 10n ** BigInt(power));
}

/** The nearest integer; of two that are as near, the even one. */
export function rounded({ n, d }) {
  const floor = n / d - (n < 0n && n % d ? 1n : 0n);
  const twice = 2n * (n - floor * d);
  if (twice === d) return floor % 2n ? floor + 1n : floor;
  return twice > d ? floor + 1n : floor;
}

/** The number with as many decimals as it has; six digits where they would be too many. */
export function decimal(value) {
  if (value.d === 1n) return String(value.n);
  for (let digits = 1; digits <= MOST_DIGITS; digits++) {
    const scale = 10n ** BigInt(digits);
    if (scale % value.d === 0n) return shifted(value.n * (scale / value.d), digits);
  }
  return sixDigits(number(value));
}

function shifted(whole, digits) {
  const text = String(whole < 0n ? -whole : whole).padStart(digits + 1, "0");
  return `${whole < 0n ? "-" : ""}${text.slice(0, -digits)}.${text.slice(-digits)}`;
}

/** The nearest float. */
export function number({ n, d }) {
  const bits = (value) => (value < 0n ? -value : value).toString(2).length;
  const shift = BigInt(Math.max(0, 66 - (bits(n) - bits(d))));
  const scaled = (n << shift) / d;
  const rest = (n << shift) % d ? (n < 0n ? -1n : 1n) : 0n; // So that halves are none that are not.
  return Number(scaled * 2n + rest) / 2 ** (Number(shift) + 1);
}

/** As `format(value, ".6g")` in Python. */
function sixDigits(value) {
  if (value === 0) return "0";
  const [digits, power] = value.toExponential(5).split("e");
  const exponent = Number(power);
  if (exponent < -4 || exponent >= 6) {
    const short = digits.includes(".") ? digits.replace(/\.?0+$/, "") : digits;
    return `${short}e${exponentText(exponent)}`;
  }
  const plain = value.toFixed(Math.max(0, 5 - exponent));
  return plain.includes(".") ? plain.replace(/\.?0+$/, "") : plain;
}

const exponentText = (exponent) =>
  `${exponent < 0 ? "-" : "+"}${String(Math.abs(exponent)).padStart(2, "0")}`;

/** A float as Python shows it. */
export function pythonFloat(value) {
  if (Number.isNaN(value)) return "nan";
  if (!Number.isFinite(value)) return value > 0 ? "inf" : "-inf";
  if (Object.is(value, -0)) return "-0.0";
  const [digits, power] = value.toExponential().split("e");
  const exponent = Number(power);
  if (value !== 0 && (exponent < -4 || exponent >= 16)) return `${digits}e${exponentText(exponent)}`;
  const plain = exponent < 0 ? value.toFixed(digits.replace(/[-.]/g, "").length - exponent - 1) : String(value);
  return plain.includes(".") ? plain : `${plain}.0`;
}
