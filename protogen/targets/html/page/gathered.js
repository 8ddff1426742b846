/** Bytes that were read in pieces, each with a time in nanoseconds or null, and a name in front of it. */

const NOTES = 3;
const DIGITS = new Int8Array(128).fill(-1);
for (const [value, digit] of [..."0123456789abcdef"].entries()) {
  DIGITS[digit.charCodeAt(0)] = DIGITS[digit.toUpperCase().charCodeAt(0)] = value;
}

export class Gathered {
  constructor() {
    this.data = new Uint8Array(64);
    /** Those of `TX` and `RX` that stood in front of bytes. */
    this.directions = new Set();
    /** What was left out: how many lines, and what is said of the first. */
    this.left = 0;
    this.notes = [];
    this.clear();
  }

  /** Forget the bytes; what was noted stays. */
  clear() {
    this.size = 0;
    [this.ends, this.times, this.names] = [[], [], []];
  }

  /** True if the directions of a log tell senders apart. */
  get isDirected() {
    return this.directions.size > 1;
  }

  byte(value) {
    if (this.size === this.data.length) this.reserve(1);
    this.data[this.size++] = value;
  }

  bytes(found) {
    this.reserve(found.length);
    this.data.set(found, this.size);
    this.size += found.length;
  }

  /** These bytes alone, as they are. */
  whole(bytes) {
    [this.data, this.size] = [bytes, bytes.length];
    this.piece();
  }

  /** The bytes of pairs of hex digits, whatever stands between pairs. */
  digits(text) {
    let high = -1;
    for (let at = 0; at < text.length; at++) {
      const digit = DIGITS[text.charCodeAt(at)];
      if (!(digit >= 0)) high = -1;
      else if (high < 0) high = digit;
      else {
        this.byte(high * 16 + digit);
        high = -1;
      }
    }
  }

  /** What came since the last piece is one. */
  piece(time = null, name = "") {
    this.ends.push(this.size);
    this.times.push(time);
    this.names.push(name);
    if (name === "TX" || name === "RX") this.directions.add(name);
  }

  leave(line, text) {
    if (this.left++ < NOTES) this.notes.push(`line ${line} is left out: ${text.slice(0, 40)}`);
  }

  /** The pieces with names of that kind, without these. */
  only(isOwn) {
    const found = new Gathered();
    this.names.forEach((name, at) => {
      if (!isOwn(name)) return;
      found.bytes(this.data.subarray(this.ends[at - 1] ?? 0, this.ends[at]));
      found.piece(this.times[at]);
    });
    return found;
  }

  reserve(more) {
    if (this.size + more <= this.data.length) return;
    const { data } = this;
    this.data = new Uint8Array(2 * (this.size + more));
    this.data.set(data);
  }
}
